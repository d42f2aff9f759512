//! The two-instrument method: a spectral BTDF from an imaging sphere and a spectroradiometer (Feng
//! 2012, eq. 3-8 to 3-11).
//!
//! An imaging sphere gives the angular shape f(i, o) and, at each incidence, the total integrated
//! scatter TIS(i), both in a few broad channels. A spectroradiometer gives the transmission spectrum
//! S(lambda) at normal incidence. If the spectrum has the same shape at all angles, the combination is
//!
//! `f(i, o, lambda) = k(i) f(i, o) S(lambda)`, `k(i) = TIS(i) / (rho(i) mean S)`,
//!
//! where rho(i) is the integral of f cos over the hemisphere and the mean is over the wavelengths of the
//! grid. The integral of the combined BTDF, averaged over wavelength, is then TIS(i). Without a TIS, or if
//! the level of the values is to be retained, `k = 1 / mean S`. Without a spectrum, S is 1.

use crate::Shape;

/// Returns k of each incidence. `tis` is by incidence; `None` retains the level of the values. `spectrum`
/// holds S at uniformly spaced wavelengths; if it is empty, S = 1.
pub fn incidence_scale(shape: &Shape, tis: Option<&[f64]>, spectrum: &[f64]) -> Vec<f64> {
    let mean = match spectrum.len() {
        0 => 1.0,
        bins => spectrum.iter().sum::<f64>() / bins as f64,
    };
    let one = |k: usize| match tis.and_then(|tis| tis.get(k)) {
        Some(tis) => tis / (shape.total(k) * mean),
        None => 1.0 / mean,
    };
    (0..shape.incidences_deg().count()).map(one).collect()
}
