//! Reference implementation: one wavelength, one direction, all quantities.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::{checked_incidence, checked_index, checked_thickness, checked_wavelength};
use crate::OpticsError;

/// The two states of linear polarisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Polarisation {
    /// Electric field perpendicular to the plane of incidence.
    S,
    /// Electric field in the plane of incidence.
    P,
}

/// One layer at one wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Layer {
    /// n + ik, k >= 0.
    pub index: Complex64,
    /// Thickness, nm.
    pub thickness_nm: f64,
}

/// A stack at one wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Index of the transparent medium of the incident light.
    pub incidence: f64,
    /// Layers in the order in which the light meets them.
    pub layers: Vec<Layer>,
    /// n + ik of the semi-infinite medium behind.
    pub substrate: Complex64,
}

/// Tangential fields in one plane, relative to the incident wave's U.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// E for s, H for p.
    pub u: Complex64,
    /// The other field: eta U for a wave that propagates down, -eta U for one that propagates up.
    pub v: Complex64,
}

impl Field {
    /// Returns the power that flows down through this plane, in units where the incident wave carries
    /// `eta0`.
    pub fn flux(self) -> f64 {
        (self.u.conj() * self.v).re
    }
}

/// Response of a film to light of one wavelength, direction and polarisation.
#[derive(Debug, Clone, PartialEq)]
pub struct Coherent {
    /// Amplitude of the reflected wave over the incident one: of E for s, of H for p.
    /// So r_p = -r_s at normal incidence.
    pub r: Complex64,
    /// Amplitude of the electric field transmitted into the substrate, over the incident one.
    pub t: Complex64,
    /// Fraction of the power that is reflected, |r|^2.
    pub reflectance: f64,
    /// Fraction of the power that enters the substrate; 0 where that is evanescent.
    pub transmittance: f64,
    /// Fraction of the power that each layer absorbs.
    pub absorptance: Vec<f64>,
    /// Fields at the top of each layer and, last, of the substrate.
    pub fields: Vec<Field>,
}

/// Reflection, transmission and absorption of `film` at one wavelength, beta and polarisation.
///
/// ```
/// use papilio_optics::film::{coherent, Film, Layer, Polarisation};
/// // A quarter wave of sqrt(1.5) on n = 1.5 is a perfect antireflection coating.
/// let n = 1.5_f64.sqrt();
/// let layer = Layer { index: n.into(), thickness_nm: 550.0 / (4.0 * n) };
/// let film = Film { incidence: 1.0, layers: vec![layer], substrate: 1.5.into() };
/// let green = coherent(&film, 550.0, 0.0, Polarisation::S)?;
/// assert!(green.reflectance < 1e-30);
/// assert!((green.transmittance - 1.0).abs() < 1e-15);
/// # Ok::<(), papilio_optics::OpticsError>(())
/// ```
///
/// # Errors
/// Indices with n or k below 0 (or both 0), a negative thickness, a wavelength
/// that is not positive, or beta outside 0 <= beta < n of the incidence medium.
pub fn coherent(
    film: &Film,
    wavelength_nm: f64,
    beta: f64,
    polarisation: Polarisation,
) -> Result<Coherent, OpticsError> {
    let n0 = checked_incidence(film.incidence)?;
    let k0 = 2.0 * PI / checked_wavelength(wavelength_nm)?;
    if !(0.0..n0).contains(&beta) {
        return Err(OpticsError::Beta { beta, limit: n0 });
    }
    let substrate = Medium::new(film.substrate, beta, polarisation)?;
    let incidence = Medium::new(n0.into(), beta, polarisation)?;
    between(film, k0, beta, polarisation, incidence, substrate)
}

/// Does the same for a direction close to the horizon of a medium, where `q = sqrt(n^2 - beta^2)` loses its
/// digits: `q` of the medium of incidence, above 0, and of the substrate are given.
pub(super) fn coherent_at(
    film: &Film,
    wavelength_nm: f64,
    beta: f64,
    [q_incidence, q_substrate]: [Complex64; 2],
    polarisation: Polarisation,
) -> Result<Coherent, OpticsError> {
    let k0 = 2.0 * PI / checked_wavelength(wavelength_nm)?;
    let medium =
        |index, q| Medium::new(index, beta, polarisation).map(|medium: Medium| Medium { q, g: medium.g });
    let substrate = medium(film.substrate, q_substrate)?;
    let incidence = medium(checked_incidence(film.incidence)?.into(), q_incidence)?;
    between(film, k0, beta, polarisation, incidence, substrate)
}

fn between(
    film: &Film,
    k0: f64,
    beta: f64,
    polarisation: Polarisation,
    incidence: Medium,
    substrate: Medium,
) -> Result<Coherent, OpticsError> {
    let eta0 = incidence.admittance().re;
    // Upwards from the substrate; each step is divided by its growth, which is stored.
    let mut fields = vec![Field { u: Complex64::ONE, v: substrate.admittance() }];
    let mut shrinks = Vec::with_capacity(film.layers.len());
    for layer in film.layers.iter().rev() {
        let medium = Medium::new(layer.index, beta, polarisation)?;
        let depth = k0 * checked_thickness(layer.thickness_nm)?;
        let (field, shrink) = medium.through(depth, fields[fields.len() - 1]);
        fields.push(field);
        shrinks.push(shrink);
    }
    fields.reverse();
    shrinks.reverse();

    let top = fields[0];
    let incident = (top.u + top.v / eta0) / 2.0;
    let r = (top.u - top.v / eta0) / (2.0 * incident);
    // Downwards again: the incident wave becomes 1, and the growths are undone.
    let mut scale = incident.inv();
    let mut powers = Vec::with_capacity(fields.len());
    for (j, field) in fields.iter_mut().enumerate() {
        if j > 0 {
            scale *= shrinks[j - 1];
        }
        // Before scaling: an evanescent substrate then carries exactly nothing.
        powers.push(field.flux() * scale.norm_sqr() / eta0);
        *field = Field { u: field.u * scale, v: field.v * scale };
    }

    let last = film.layers.len();
    let electric = match polarisation {
        Polarisation::S => Complex64::ONE,
        Polarisation::P => film.incidence / film.substrate,
    };
    Ok(Coherent {
        r,
        t: fields[last].u * electric,
        reflectance: r.norm_sqr(),
        transmittance: powers[last],
        absorptance: powers.windows(2).map(|pair| pair[0] - pair[1]).collect(),
        fields,
    })
}

/// A medium for waves of one beta and polarisation.
struct Medium {
    /// sqrt(n^2 - beta^2), Im >= 0.
    q: Complex64,
    /// 1 for s, n^2 for p.
    g: Complex64,
}

impl Medium {
    fn new(index: Complex64, beta: f64, polarisation: Polarisation) -> Result<Self, OpticsError> {
        let index = checked_index(index)?;
        // (n - beta)(n + beta) keeps its digits where beta is close to n. The
        // imaginary part is +0 or more, where the principal root is the decaying one.
        let q2 = Complex64::new(
            (index.re - beta) * (index.re + beta) - index.im * index.im,
            2.0 * index.re * index.im,
        );
        let g = match polarisation {
            Polarisation::S => Complex64::ONE,
            Polarisation::P => index * index,
        };
        Ok(Self { q: root(q2), g })
    }

    fn admittance(&self) -> Complex64 {
        self.q / self.g
    }

    /// Returns the fields above a layer of k0 d = `depth` from those below it, both divided so that they
    /// remain of order 1, and the factor.
    fn through(&self, depth: f64, below: Field) -> (Field, f64) {
        let delta = self.q * depth;
        let (sin, cos) = delta.re.sin_cos();
        // cosh and sinh of Im delta, times exp(-Im delta).
        let sinh = -0.5 * (-2.0 * delta.im).exp_m1();
        let cosh = 1.0 - sinh;
        let c = Complex64::new(cos * cosh, -sin * sinh);
        let s = Complex64::new(sin * cosh, cos * sinh);
        let s_over_q = if self.q == Complex64::ZERO { depth.into() } else { s / self.q };

        let u = c * below.u - Complex64::I * self.g * s_over_q * below.v;
        let v = c * below.v - Complex64::I * self.q / self.g * s * below.u;
        let norm = u.norm().max(v.norm());
        (Field { u: u / norm, v: v / norm }, (-delta.im).exp() / norm)
    }
}

/// Returns the square root with both parts >= 0 of a number with Im >= 0, accurate in both parts.
fn root(z: Complex64) -> Complex64 {
    let large = ((z.norm() + z.re.abs()) / 2.0).sqrt();
    if large == 0.0 {
        return Complex64::ZERO;
    }
    let small = z.im / (2.0 * large);
    if z.re >= 0.0 { Complex64::new(large, small) } else { Complex64::new(small, large) }
}
