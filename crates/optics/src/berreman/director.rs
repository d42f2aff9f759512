//! Directors that change with depth, cut into slices.

use num_complex::Complex64;

use super::{AnisotropicLayer, Dielectric, direction};
use crate::OpticsError;

/// Direction of the molecules at one depth, degrees: see the frame of the panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Director {
    /// Azimuth, counter-clockwise as seen by the viewer.
    pub azimuth_deg: f64,
    /// Tilt out of the panel.
    pub tilt_deg: f64,
}

/// Returns `count` coherent slices of equal thickness of a uniaxial layer, from the top down. `director` is evaluated in
/// the middle of each, at a fraction of the depth between 0 (top) and 1.
///
/// # Errors
/// Impossible indices.
pub fn slices(
    [ordinary, extraordinary]: [Complex64; 2],
    thickness_nm: f64,
    count: usize,
    director: impl Fn(f64) -> Director,
) -> Result<Vec<AnisotropicLayer>, OpticsError> {
    let slice = |k: usize| {
        let Director { azimuth_deg, tilt_deg } = director((k as f64 + 0.5) / count as f64);
        let dielectric = Dielectric::uniaxial(ordinary, extraordinary, direction(azimuth_deg, tilt_deg))?;
        Ok(AnisotropicLayer { dielectric, thickness_nm: thickness_nm / count as f64, coherent: true })
    };
    (0..count).map(slice).collect()
}
