//! Stacks of anisotropic layers: amplitudes, and Mueller matrices.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::Dielectric;
use super::matrix::{Matrix, Scattering};
use super::modes::{Modes, vertical};
use super::slab::slab;
use crate::OpticsError;
use crate::film::{checked_incidence, checked_index, checked_thickness, checked_wavelength};

/// Layer at one wavelength.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AnisotropicLayer {
    /// Its dielectric tensor.
    pub dielectric: Dielectric,
    /// Thickness, nm.
    pub thickness_nm: f64,
    /// False for a thick slab: light that crosses it a different number of times does not interfere.
    pub coherent: bool,
}

/// Layers at one wavelength, from the top down.
#[derive(Debug, Clone, PartialEq)]
pub struct Stack {
    /// Index of the transparent medium above.
    pub front: f64,
    /// The layers.
    pub layers: Vec<AnisotropicLayer>,
    /// n + ik of the semi-infinite medium below.
    pub back: Complex64,
}

/// Plane wave that arrives from above.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Wave {
    /// Vacuum wavelength, nm.
    pub wavelength_nm: f64,
    /// n sin(theta) in the medium above, 0 or more, and less than its index.
    pub beta: f64,
    /// Azimuth of its travel along the panel, degrees.
    pub azimuth_deg: f64,
}

/// Matrix of amplitudes of E: rows p, s of the light that leaves, columns p, s of the light that arrives.
pub type Jones = [[Complex64; 2]; 2];

/// Matrix of Stokes parameters I, Q, U, V.
pub type Mueller = [[f64; 4]; 4];

/// Reflection and transmission from both sides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response<T> {
    /// Reflection of light from above.
    pub r: T,
    /// Transmission into the medium below.
    pub t: T,
    /// Reflection of light from below; for a wave of the same tangential direction. Meaningful where the medium below is transparent.
    pub r_below: T,
    /// Transmission of light from below.
    pub t_up: T,
}

/// Amplitudes of a coherent stack, relative to a wave of unit E.
///
/// ```
/// use papilio_optics::berreman::{AnisotropicLayer, Dielectric, Stack, Wave, direction, jones};
/// // Crossed axes: a half-wave plate at 45 deg between glass turns p into s.
/// let [n_o, n_e] = [1.5_f64, 1.501];
/// let dielectric = Dielectric::uniaxial(n_o.into(), n_e.into(), direction(45.0, 0.0))?;
/// let plate = AnisotropicLayer { dielectric, thickness_nm: 550.0 / 2.0 / 0.001, coherent: true };
/// let stack = Stack { front: 1.5, layers: vec![plate], back: 1.5.into() };
/// let wave = Wave { wavelength_nm: 550.0, beta: 0.0, azimuth_deg: 0.0 };
/// let t = jones(&stack, wave)?.t;
/// assert!(t[0][0].norm_sqr() < 1e-6 && (t[1][0].norm_sqr() - 1.0).abs() < 1e-6);
/// # Ok::<(), papilio_optics::OpticsError>(())
/// ```
///
/// # Errors
/// Impossible indices, thicknesses or wavelengths, and beta outside 0 <= beta < n of the medium above.
/// Layers with `coherent = false` count as coherent.
pub fn jones(stack: &Stack, wave: Wave) -> Result<Response<Jones>, OpticsError> {
    let checked = Checked::new(stack, wave)?;
    let all = checked.group(&stack.layers, &checked.front, &checked.back)?;
    Ok(Response { r: all.r.0, t: all.t.0, r_below: all.r_below.0, t_up: all.t_up.0 })
}

/// Mueller matrices of reflection and transmission for power: the first row and column of `r` is the
/// reflectance for unpolarised light. Where the medium below absorbs, those from below have no meaning.
///
/// # Errors
/// As of [`jones`].
pub fn mueller(stack: &Stack, wave: Wave) -> Result<Response<Mueller>, OpticsError> {
    let checked = Checked::new(stack, wave)?;
    let mut all = Scattering::<4>::nothing();
    let mut above = checked.front;
    let mut rest = &stack.layers[..];
    while let Some(thick) = rest.iter().position(|layer| !layer.coherent) {
        let (modes, propagation) = checked.thick(&rest[thick])?;
        all = all.over(&checked.group(&rest[..thick], &above, &modes)?.on_coherency()).over(&propagation);
        (above, rest) = (modes, &rest[thick + 1..]);
    }
    all = all.over(&checked.group(rest, &above, &checked.back)?.on_coherency());
    // |E|^2 to power along the normal: q of a real index; n Re(q*/n*) for p and Re q for s in a metal.
    let front = vertical(stack.front.into(), wave.beta).re;
    let back = checked.power_below(stack.back);
    let down = Matrix::diagonal(back.map(|power| (power / front).into()));
    let up = Matrix::diagonal(
        back.map(|power| if power == 0.0 { Complex64::ZERO } else { (front / power).into() }),
    );
    Ok(Response {
        r: of_stokes(all.r),
        t: of_stokes(down * all.t),
        r_below: of_stokes(all.r_below),
        t_up: of_stokes(all.t_up * up),
    })
}

/// A wave in a stack, checked, and the waves above and below the layers.
struct Checked {
    k0: f64,
    beta: f64,
    azimuth_deg: f64,
    front: Modes,
    back: Modes,
}

impl Checked {
    fn new(stack: &Stack, wave: Wave) -> Result<Self, OpticsError> {
        let front = checked_incidence(stack.front)?;
        let Wave { wavelength_nm, beta, azimuth_deg } = wave;
        if !(0.0..front).contains(&beta) {
            return Err(OpticsError::Beta { beta, limit: front });
        }
        let k0 = 2.0 * PI / checked_wavelength(wavelength_nm)?;
        let back = Modes::isotropic(checked_index(stack.back)?, beta);
        Ok(Self { k0, beta, azimuth_deg, front: Modes::isotropic(front.into(), beta), back })
    }

    /// Returns the scattering matrix of coherent layers between two media.
    fn group(
        &self,
        layers: &[AnisotropicLayer],
        above: &Modes,
        below: &Modes,
    ) -> Result<Scattering<2>, OpticsError> {
        let reference = Modes::reference(self.beta);
        let mut all = above.face(&reference);
        for layer in layers {
            let depth = self.k0 * checked_thickness(layer.thickness_nm)?;
            all = all.over(&slab(&layer.dielectric.for_wave(self.azimuth_deg), self.beta, depth));
        }
        Ok(all.over(&reference.face(below)))
    }

    /// Returns the waves of a thick slab and their propagation through it.
    fn thick(&self, layer: &AnisotropicLayer) -> Result<(Modes, Scattering<4>), OpticsError> {
        let depth = self.k0 * checked_thickness(layer.thickness_nm)?;
        let (modes, [down, up]) = Modes::anisotropic(&layer.dielectric, self.azimuth_deg, self.beta, depth);
        let none = Matrix::ZERO;
        Ok((modes, Scattering { r: none, t: down.on_coherency(), r_below: none, t_up: up.on_coherency() }))
    }

    /// Returns the power along the normal of the elements pp, ps, sp, ss of the coherency matrix below; the two
    /// in the middle only matter between transparent media, where both powers are equal.
    fn power_below(&self, index: Complex64) -> [f64; 4] {
        let q = vertical(index, self.beta);
        let (p, s) = ((q / index * index.conj()).re, q.re);
        [p, (p * s).max(0.0).sqrt(), (p * s).max(0.0).sqrt(), s]
    }
}

/// Returns the Mueller matrix of an action on the coherency matrix.
fn of_stokes(action: Matrix<4>) -> Mueller {
    let (one, i, zero) = (Complex64::ONE, Complex64::I, Complex64::ZERO);
    // Rows: I, Q, U, V of the elements pp, ps, sp, ss of <E_i E_k*>.
    let stokes = Matrix([
        [one, zero, zero, one],
        [one, zero, zero, -one],
        [zero, one, one, zero],
        [zero, -i, i, zero],
    ]);
    let all = stokes * action * stokes.inverse();
    all.0.map(|row| row.map(|value| value.re))
}
