//! The fast implementation compared with the reference one, on random stacks and at every SIMD level.

use num_complex::Complex64;
use papilio_optics::film::{
    Along, Film, FilmRow, GapFilm, IndexAlong, Layer, LayerAlong, Polarisation, SimdLevel, SpectralLayer,
    Thickness, coherent,
};
use papilio_testing::{Dice, laws};

/// Glass, air, a weak absorber, a metal.
fn medium(dice: &mut Dice) -> Complex64 {
    match dice.below(4) {
        0 => Complex64::new(dice.between(0.7, 3.0), 0.0),
        1 => Complex64::new(1.0, 0.0),
        2 => Complex64::new(dice.between(0.7, 3.0), dice.log_between(1e-14, 0.1)),
        _ => Complex64::new(dice.between(0.04, 4.0), dice.between(0.1, 8.0)),
    }
}

/// A film, the gaps to try in it, and a direction.
#[derive(Debug)]
struct Case {
    above: Vec<Layer>,
    gap: Complex64,
    below: Vec<Layer>,
    substrate: Complex64,
    n0: f64,
    beta: f64,
    gaps_nm: Vec<f64>,
}

fn case(dice: &mut Dice, share: fn(&mut Dice) -> f64, thickness_nm: fn(&mut Dice) -> f64) -> Case {
    let layer = |dice: &mut Dice| Layer { index: medium(dice), thickness_nm: thickness_nm(dice) };
    let (above, gap, below) = (dice.several(0..=4, layer), medium(dice), dice.several(0..=4, layer));
    let (substrate, n0, share) = (medium(dice), dice.between(1.0, 2.0), share(dice));
    // Random directions never happen to be grazing in the gap.
    let beta = if dice.one_in(10) { gap.re } else { share * n0 };
    Case { above, gap, below, substrate, n0, beta, gaps_nm: dice.several(1..=3, thickness_nm) }
}

/// Returns 0 as often as a number below this.
fn nought_or(dice: &mut Dice, most: f64) -> f64 {
    if dice.one_in(2) { 0.0 } else { dice.between(0.0, most) }
}

/// The mean of s and p, and each of them.
const LIGHTS: [Option<Polarisation>; 3] = [None, Some(Polarisation::S), Some(Polarisation::P)];

/// Returns the reflectance by the reference implementation; 0 if the light does not exist.
fn plain(film: &Film, light: Option<Polarisation>, nm: f64, beta: f64) -> f64 {
    let of = |polarisation| coherent(film, nm, beta, polarisation).map_or(0.0, |c| c.reflectance);
    light.map_or_else(|| 0.5 * (of(Polarisation::S) + of(Polarisation::P)), of)
}

/// Returns the largest difference between the implementations, over 11 wavelengths (more than a register
/// holds, and not a multiple), all gaps and SIMD levels.
fn largest_difference(case: &Case) -> f64 {
    let wavelengths: Vec<f64> = (0..11).map(|i| 380.0 + 40.0 * f64::from(i)).collect();
    let count = wavelengths.len();
    let spectral = |index, thickness| SpectralLayer { index: vec![index; count], thickness };
    let fixed = |layer: &Layer| spectral(layer.index, Thickness::Fixed(layer.thickness_nm));
    let mut stack: Vec<SpectralLayer> = case.above.iter().map(fixed).collect();
    stack.push(spectral(case.gap, Thickness::Gap));
    stack.extend(case.below.iter().map(fixed));
    let fast =
        GapFilm::new(&wavelengths, &vec![case.n0; count], &stack, &vec![case.substrate; count]).unwrap();

    let mut largest = 0.0_f64;
    for (level, light) in
        SimdLevel::available().into_iter().flat_map(|level| LIGHTS.map(|light| (level, light)))
    {
        let mut out = vec![f64::NAN; case.gaps_nm.len() * count];
        let film = fast.clone().with_simd_level(level);
        film.reflectance_of(light, &[case.beta], &case.gaps_nm, &mut out).unwrap();
        for (&gap_nm, out) in case.gaps_nm.iter().zip(out.chunks_exact(count)) {
            let mut layers = case.above.clone();
            layers.push(Layer { index: case.gap, thickness_nm: gap_nm });
            layers.extend(&case.below);
            let film = Film { incidence: case.n0, layers, substrate: case.substrate };
            for (&fast, &nm) in out.iter().zip(&wavelengths) {
                let difference = (fast - plain(&film, light, nm, case.beta)).abs();
                assert!(!difference.is_nan(), "{level:?}, {light:?}, {gap_nm} nm, {nm} nm: {fast}");
                largest = largest.max(difference);
            }
        }
    }
    largest
}

/// Layers of typical thickness, up to 88 deg in the incidence medium. All but about one in a hundred
/// thousand agree to 1e-12. That one lies next to a guided mode behind an evanescent barrier: the fast
/// implementation carries the amplitudes of the incidence medium down through the barrier, where they nearly
/// cancel against the mode, and retains 1e-16 over the relative distance to it (the case below). The bound
/// is that of the comparison with `tmm`.
#[test]
fn implementations_agree() {
    let draw = |dice: &mut Dice| case(dice, |dice| nought_or(dice, 0.999), |dice| nought_or(dice, 500.0));
    laws(1000, draw, |case| {
        let difference = largest_difference(case);
        assert!(difference < 1e-10, "{difference:e}");
    });
}

/// Extreme cases: 100 um of glass, grazing incidence, no light at all. Between grazing incidence and a thick
/// waveguide the finesse reaches 1e5, so that the last bits of the phase (1e3 rad) count 1e-16 * 1e3 * 1e5.
#[test]
fn implementations_agree_in_resonators() {
    let share = |dice: &mut Dice| if dice.one_in(2) { 1.0 - 1e-9 } else { dice.between(0.0, 1.1) };
    let thickness_nm =
        |dice: &mut Dice| if dice.one_in(2) { dice.between(1e3, 1e5) } else { dice.between(0.0, 1000.0) };
    laws(
        1000,
        |dice| case(dice, share, thickness_nm),
        |case| {
            let difference = largest_difference(case);
            assert!(difference < 1e-8, "{difference:e}");
        },
    );
}

/// A waveguide 1e-5 from a mode behind an evanescent barrier: one of the hardest of many random films.
#[test]
fn implementations_agree_next_to_guided_mode() {
    let layer = |n: f64, thickness_nm| Layer { index: Complex64::new(n, 0.0), thickness_nm };
    let case = Case {
        above: vec![layer(0.7, 409.86431620061734), layer(1.0, 248.54892670531905)],
        gap: Complex64::new(1.561994369324698, 5.5039783694005076e-14),
        below: vec![layer(1.0, 292.9970170411427)],
        substrate: Complex64::new(0.7, 0.0),
        n0: 1.6423258363121807,
        beta: 1.506256826439489,
        gaps_nm: vec![356.5346759164047],
    };
    let difference = largest_difference(&case);
    assert!(difference < 1e-11, "{difference:e}");
}

/// Points of a row, each with its own stack: indices and thicknesses `[layer][point]`.
#[derive(Debug)]
struct Row {
    wavelengths_nm: Vec<f64>,
    beta: Vec<f64>,
    incidence: Vec<f64>,
    layers: Vec<Vec<Layer>>,
    substrate: Vec<Complex64>,
}

/// More than a register holds, and not a multiple.
const POINTS: usize = 11;

fn row(dice: &mut Dice, share: f64, thickness_nm: fn(&mut Dice) -> f64) -> Row {
    let layer = |dice: &mut Dice| Layer { index: medium(dice), thickness_nm: thickness_nm(dice) };
    let incidence = dice.several(POINTS..=POINTS, |dice| dice.between(1.0, 2.0));
    Row {
        wavelengths_nm: dice.several(POINTS..=POINTS, |dice| dice.between(380.0, 780.0)),
        beta: incidence.iter().map(|n0| n0 * dice.between(0.0, share)).collect(),
        incidence,
        layers: dice.several(0..=4, |dice| dice.several(POINTS..=POINTS, layer)),
        substrate: dice.several(POINTS..=POINTS, medium),
    }
}

impl Row {
    /// Returns the largest absolute differences of reflectance and of transmittance, and the largest
    /// relative one of the latter.
    fn differences(&self) -> [f64; 3] {
        let index = |indices: Vec<Complex64>| -> [Vec<f64>; 2] {
            [indices.iter().map(|n| n.re).collect(), indices.iter().map(|n| n.im).collect()]
        };
        let parts: Vec<([Vec<f64>; 2], Vec<f64>)> = (self.layers.iter())
            .map(|layer| {
                let nm = layer.iter().map(|one| one.thickness_nm).collect();
                (index(layer.iter().map(|one| one.index).collect()), nm)
            })
            .collect();
        let layers: Vec<LayerAlong<'_>> = parts.iter().map(|(index, nm)| layer_along(index, nm)).collect();
        let substrate = index(self.substrate.clone());
        let row = FilmRow {
            wavelength_nm: Along::Each(&self.wavelengths_nm),
            beta: Along::Each(&self.beta),
            incidence: Along::Each(&self.incidence),
            layers: &layers,
            substrate: index_along(&substrate),
        };
        row.check().unwrap();
        let mut largest = [0.0_f64; 3];
        for level in SimdLevel::available() {
            for of in [Some(Polarisation::S), Some(Polarisation::P), None] {
                let (mut r, mut t) = ([f64::NAN; POINTS], [f64::NAN; POINTS]);
                row.powers(level, of, &mut r, Some(&mut t)).unwrap();
                let mut alone = [f64::NAN; POINTS];
                row.powers(level, of, &mut alone, None).unwrap();
                assert_eq!(alone, r, "{level:?}");
                for at in 0..POINTS {
                    let [plain_r, plain_t] = self.plain(at, of);
                    let of_t = (t[at] - plain_t).abs();
                    let of_itself = if plain_t > 1e-290 { of_t / plain_t } else { 0.0 };
                    assert!(!(r[at] + t[at]).is_nan(), "{level:?} {of:?} {at}: {} {}", r[at], t[at]);
                    let found = [(r[at] - plain_r).abs(), of_t, of_itself];
                    largest.iter_mut().zip(found).for_each(|(most, one)| *most = most.max(one));
                }
            }
        }
        largest
    }

    /// Returns reflectance and transmittance of a point by the reference implementation.
    fn plain(&self, at: usize, of: Option<Polarisation>) -> [f64; 2] {
        let layers = self.layers.iter().map(|layer| layer[at]).collect();
        let film = Film { incidence: self.incidence[at], layers, substrate: self.substrate[at] };
        let both = of.map_or(vec![Polarisation::S, Polarisation::P], |of| vec![of]);
        let found =
            both.iter().map(|of| coherent(&film, self.wavelengths_nm[at], self.beta[at], *of).unwrap());
        let (r, t): (Vec<f64>, Vec<f64>) = found.map(|one| (one.reflectance, one.transmittance)).unzip();
        [r, t].map(|values| values.iter().sum::<f64>() / values.len() as f64)
    }
}

fn index_along([n, k]: &[Vec<f64>; 2]) -> IndexAlong<'_> {
    IndexAlong { n: Along::Each(n), k: Along::Each(k) }
}

fn layer_along<'a>(index: &'a [Vec<f64>; 2], nm: &'a [f64]) -> LayerAlong<'a> {
    LayerAlong { index: index_along(index), nm: Along::Each(nm) }
}

/// Every point with a stack of its own, up to 88 deg.
#[test]
fn rows_of_points_equal_reference() {
    laws(
        300,
        |dice| row(dice, 0.999, |dice| nought_or(dice, 500.0)),
        |row| {
            let [r, t, of_itself] = row.differences();
            assert!(r < 1e-10 && t < 1e-10 && of_itself < 1e-9, "{r:e} {t:e} {of_itself:e}");
        },
    );
}

/// Micrometres of metal, which transmit 1e-100 or less: to the same relative accuracy.
#[test]
fn rows_of_opaque_points_equal_reference() {
    laws(
        300,
        |dice| row(dice, 0.9, |dice| dice.between(100.0, 2000.0)),
        |row| {
            let [r, t, of_itself] = row.differences();
            assert!(r < 1e-10 && t < 1e-10 && of_itself < 1e-8, "{r:e} {t:e} {of_itself:e}");
        },
    );
}

/// A parameter given as one number for a whole row equals the same number at every point.
#[test]
fn rows_of_broadcast_numbers_equal_rows_of_points() {
    let nm: Vec<f64> = (0..POINTS).map(|at| 400.0 + 30.0 * at as f64).collect();
    let [n, k, thick] = [vec![2.1; POINTS], vec![0.3; POINTS], vec![70.0; POINTS]];
    let written =
        LayerAlong { index: IndexAlong { n: Along::Each(&n), k: Along::Each(&k) }, nm: Along::Each(&thick) };
    let said =
        LayerAlong { index: IndexAlong { n: Along::Same(2.1), k: Along::Same(0.3) }, nm: Along::Same(70.0) };
    let of = |layers: &[LayerAlong<'_>]| {
        let index = IndexAlong { n: Along::Same(1.5), k: Along::Same(0.0) };
        let row = FilmRow {
            wavelength_nm: Along::Each(&nm),
            beta: Along::Same(0.5),
            incidence: Along::Same(1.0),
            layers,
            substrate: index,
        };
        let (mut r, mut t) = ([0.0; POINTS], [0.0; POINTS]);
        row.powers(SimdLevel::best(), None, &mut r, Some(&mut t)).unwrap();
        assert!(row.powers(SimdLevel::best(), None, &mut r[1..], None).is_err());
        (r, t)
    };
    assert_eq!(of(&[written]), of(&[said]));
}
