//! Number of interference fringes of the layers of a film.
//!
//! A layer of index n and thickness d delays light that crosses it back and forth by `2 n d cos(theta)`
//! wavelengths: between its normal and its horizon there are as many fringes, and over wavelength there is
//! one in every `lambda^2/(2 n d)`.

use num_complex::Complex64;

/// Fraction of the light after a round trip below which a layer has no fringes.
const OPAQUE: f64 = 1e-9;

/// The layer of a film with the most fringes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerFringes {
    /// Its number, from 0.
    pub layer: usize,
    /// Number of fringes from its normal to its horizon.
    pub fringes: f64,
}

/// Returns the number of fringes of a layer of this index and thickness (nm) at a wavelength (nm); 0 if it
/// is opaque.
pub(super) fn fringes(index: Complex64, thickness_nm: f64, nm: f64) -> f64 {
    let left = (-8.0 * std::f64::consts::PI * index.im * thickness_nm / nm).exp();
    if left > OPAQUE { 2.0 * index.re * thickness_nm / nm } else { 0.0 }
}

/// Returns the distance in wavelength (nm) between the fringes of all layers together near a wavelength
/// (nm), along the normal; each layer is an index and a thickness (nm). Infinite if there are no transparent
/// layers.
pub fn fringe_spacing_nm(layers: impl IntoIterator<Item = (Complex64, f64)>, nm: f64) -> f64 {
    let all: f64 = layers.into_iter().map(|(index, thickness_nm)| fringes(index, thickness_nm, nm)).sum();
    nm / all
}

/// Returns the layer, each given by an index and a thickness (nm), with the most fringes at a wavelength
/// (nm).
///
/// ```
/// use papilio_optics::film::most_fringes;
/// let glass = (1.5.into(), 5500.0);
/// let metal = (num_complex::Complex64::new(1.0, 6.0), 1e6);
/// let most = most_fringes([(1.0.into(), 100.0), glass, metal], 550.0);
/// assert_eq!((most.layer, most.fringes), (1, 30.0));
/// ```
pub fn most_fringes(layers: impl IntoIterator<Item = (Complex64, f64)>, nm: f64) -> LayerFringes {
    let of_layers = layers.into_iter().enumerate();
    let of_layers = of_layers.map(|(layer, (index, thickness_nm))| LayerFringes {
        layer,
        fringes: fringes(index, thickness_nm, nm),
    });
    let none = LayerFringes { layer: 0, fringes: 0.0 };
    of_layers.fold(none, |most, one| if one.fringes > most.fringes { one } else { most })
}
