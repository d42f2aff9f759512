//! Derivatives of a film's reflectance, compared with those of its amplitude, which is analytic in every
//! thickness and index: means over a circle in the complex plane (Cauchy) give them to rounding, without a
//! step size.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::OpticsError;
use papilio_optics::film::{GapFilm, Polarisation, SimdLevel, SpectralLayer, Thickness, Variable};
use papilio_testing::{Dice, laws};

/// A stack at one wavelength, of complex thicknesses and indices.
#[derive(Debug, Clone)]
struct Stack {
    n0: f64,
    layers: Vec<(Complex64, Complex64)>,
    substrate: Complex64,
}

impl Stack {
    /// Returns the amplitude reflectance; `root` is the substrate's q for unshifted parameters.
    fn r(&self, nm: f64, beta: f64, is_p: bool, root: Complex64) -> Complex64 {
        let k0 = 2.0 * PI / nm;
        let g = |n: Complex64| if is_p { n * n } else { Complex64::ONE };
        let q = |n: Complex64| ((n - beta) * (n + beta)).sqrt();
        let nearest = |q: Complex64| if (q - root).norm() <= (q + root).norm() { q } else { -q };
        let (mut u, mut v) = (Complex64::ONE, nearest(q(self.substrate)) / g(self.substrate));
        for (n, depth) in self.layers.iter().rev() {
            let (q, g) = (q(*n), g(*n));
            let delta = q * depth * k0;
            let s = if q.norm() < 1e-9 { depth * k0 } else { delta.sin() / q };
            let c = delta.cos();
            (u, v) = (c * u - Complex64::I * g * s * v, c * v - Complex64::I * q * q / g * s * u);
        }
        let eta0 = q(self.n0.into()) / g(self.n0.into());
        (eta0 * u - v) / (eta0 * u + v)
    }

    fn root(&self, beta: f64) -> Complex64 {
        let q = ((self.substrate - beta) * (self.substrate + beta)).sqrt();
        if q.im < 0.0 { -q } else { q }
    }

    /// Returns the reflectance, the mean of s and p or that of one, and its derivative by the parameter that
    /// `shifted` shifts by a complex number.
    fn derivative(
        &self,
        light: Option<Polarisation>,
        nm: f64,
        beta: f64,
        radius: f64,
        shifted: impl Fn(&mut Self, Complex64),
    ) -> (f64, f64) {
        const POINTS: usize = 12;
        let root = self.root(beta);
        let (mut mean, mut derivative) = (0.0, 0.0);
        let weights = match light {
            None => [0.5, 0.5],
            Some(Polarisation::S) => [1.0, 0.0],
            Some(Polarisation::P) => [0.0, 1.0],
        };
        for (is_p, weight) in [false, true].into_iter().zip(weights) {
            let r = self.r(nm, beta, is_p, root);
            let on_circle = (0..POINTS).map(|k| {
                let turn = Complex64::from_polar(1.0, 2.0 * PI * k as f64 / POINTS as f64);
                let mut other = self.clone();
                shifted(&mut other, turn * radius);
                other.r(nm, beta, is_p, root) / turn
            });
            let dr = on_circle.sum::<Complex64>() / (POINTS as f64 * radius);
            mean += weight * r.norm_sqr();
            derivative += 2.0 * weight * (r.conj() * dr).re;
        }
        (mean, derivative)
    }
}

#[derive(Debug)]
struct Case {
    n0: f64,
    beta: f64,
    layers: Vec<(Complex64, f64)>,
    gap: Option<usize>,
    substrate: Complex64,
}

impl Case {
    fn stack(&self) -> Stack {
        let layers = self.layers.iter().map(|(n, nm)| (*n, Complex64::from(*nm))).collect();
        Stack { n0: self.n0, layers, substrate: self.substrate }
    }

    fn variables(&self) -> Vec<Variable> {
        let of = |k| [Variable::Thickness(k), Variable::Index(k), Variable::Extinction(k)];
        let substrate = [Variable::SubstrateIndex, Variable::SubstrateExtinction];
        (0..self.layers.len()).flat_map(of).chain(substrate).collect()
    }

    /// Circles are small, so that no pole of a sharp resonance lies inside; rounding is 1e-16 over their
    /// radius.
    fn truth(&self, variable: Variable, light: Option<Polarisation>, nm: f64) -> (f64, f64) {
        let by = |radius, shift: &dyn Fn(&mut Stack, Complex64)| {
            self.stack().derivative(light, nm, self.beta, radius, shift)
        };
        let i = Complex64::I;
        match variable {
            Variable::Thickness(k) => by(1e-3, &|stack, x| stack.layers[k].1 += x),
            Variable::Index(k) => by(1e-5, &|stack, x| stack.layers[k].0 += x),
            Variable::Extinction(k) => by(1e-5, &|stack, x| stack.layers[k].0 += i * x),
            Variable::SubstrateIndex => by(1e-5, &|stack, x| stack.substrate += x),
            Variable::SubstrateExtinction => by(1e-5, &|stack, x| stack.substrate += i * x),
        }
    }

    /// Returns the largest differences of reflectances and of derivatives, the latter over 1 + the true
    /// value.
    fn largest_differences(&self) -> (f64, f64) {
        let wavelengths: Vec<f64> = (0..11).map(|i| 380.0 + 40.0 * f64::from(i)).collect();
        let count = wavelengths.len();
        let layer = |(k, (n, nm)): (usize, &(Complex64, f64))| SpectralLayer {
            index: vec![*n; count],
            thickness: if self.gap == Some(k) { Thickness::Gap } else { Thickness::Fixed(*nm) },
        };
        let layers: Vec<SpectralLayer> = self.layers.iter().enumerate().map(layer).collect();
        let (glass, metal) = (vec![self.n0; count], vec![self.substrate; count]);
        let film = GapFilm::new(&wavelengths, &glass, &layers, &metal).unwrap();
        let gap_nm = self.gap.map_or(0.0, |k| self.layers[k].1);
        let (gaps, variables) = ([7.0, gap_nm], self.variables());
        let mut worst = (0.0_f64, 0.0_f64);
        let lights = [None, Some(Polarisation::S), Some(Polarisation::P)];
        for (level, light) in
            SimdLevel::available().into_iter().flat_map(|level| lights.map(|light| (level, light)))
        {
            let mut found = vec![f64::NAN; 2 * count];
            let mut out = vec![f64::NAN; variables.len() * 2 * count];
            let film = film.clone().with_simd_level(level);
            film.derivatives_of(light, &[self.beta], &gaps, &variables, &mut found, &mut out).unwrap();
            for (k, variable) in variables.iter().enumerate() {
                for (bin, nm) in wavelengths.iter().enumerate() {
                    let (reflectance, derivative) = self.truth(*variable, light, *nm);
                    let found = (found[count + bin] - reflectance).abs();
                    let off =
                        (out[k * 2 * count + count + bin] - derivative).abs() / (1.0 + derivative.abs());
                    assert!(!off.is_nan(), "{level:?} {variable:?} {nm} nm");
                    worst = (worst.0.max(found), worst.1.max(off));
                }
            }
        }
        worst
    }
}

fn medium(dice: &mut Dice) -> Complex64 {
    match dice.below(4) {
        0 => Complex64::new(dice.between(0.7, 3.0), 0.0),
        1 => Complex64::new(1.0, 0.0),
        2 => Complex64::new(dice.between(0.7, 3.0), dice.log_between(1e-8, 0.1)),
        _ => Complex64::new(dice.between(0.04, 4.0), dice.between(0.1, 8.0)),
    }
}

/// Films of typical thickness on metal, up to 85 deg in the incidence medium.
fn case(dice: &mut Dice) -> Case {
    let nought_or = |dice: &mut Dice, most| if dice.one_in(2) { 0.0 } else { dice.between(0.0, most) };
    let layers = dice.several(0..=5, |dice| (medium(dice), nought_or(dice, 400.0)));
    let substrate = Complex64::new(dice.between(0.1, 4.0), dice.between(0.5, 8.0));
    let n0 = dice.between(1.0, 2.0);
    let beta = nought_or(dice, 0.996) * n0;
    let gap = Some(dice.below(7)).filter(|gap| *gap < layers.len());
    Case { n0, beta, layers, gap, substrate }
}

#[test]
fn derivatives_equal_those_of_analytic_amplitude() {
    laws(300, case, |case| {
        let (reflectance, derivative) = case.largest_differences();
        assert!(reflectance < 1e-10 && derivative < 1e-8, "{reflectance:e} {derivative:e}");
    });
}

/// Total reflection, with and without an absorber; a layer in which light is grazing; a bare substrate.
#[test]
fn derivatives_of_special_films_are_finite_and_correct() {
    let (glass, air, metal) = (Complex64::from(1.5), Complex64::from(1.0), Complex64::new(0.97, 6.46));
    let case = |beta, layers: &[(Complex64, f64)], gap, substrate| Case {
        n0: 1.5,
        beta,
        layers: layers.to_vec(),
        gap,
        substrate,
    };
    let cases = [
        case(1.2, &[(air, 300.0)], Some(0), metal),
        case(1.2, &[(glass, 50.0), (air, 100.0)], Some(1), glass),
        case(1.2, &[(glass, 50.0)], None, air),
        case(1.0, &[(glass, 50.0), (air, 120.0)], Some(1), metal),
        case(0.0, &[], None, metal),
        case(0.3, &[(metal, 1500.0), (air, 100.0)], Some(1), metal),
    ];
    for case in cases {
        let (reflectance, derivative) = case.largest_differences();
        assert!(reflectance < 1e-12 && derivative < 1e-9, "{case:?}: {reflectance:e} {derivative:e}");
    }
}

#[test]
fn derivative_by_missing_layer_is_refused() {
    let film = GapFilm::new(&[500.0], &[1.5], &[], &[1.0.into()]).unwrap();
    let found = film.derivatives(&[0.0], &[1.0], &[Variable::Index(0)], &mut [0.0], &mut [0.0]);
    assert_eq!(found, Err(OpticsError::NoLayer { layer: 0, layers: 0 }));
    let found = film.derivatives(&[0.0], &[1.0], &[Variable::SubstrateIndex], &mut [0.0], &mut []);
    assert_eq!(found, Err(OpticsError::Length { what: "derivatives", expected: 1, found: 0 }));
}
