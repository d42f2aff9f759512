//! How many interference fringes the layers of a film make.
//!
//! A layer of index n and thickness d delays what crosses it to and fro by `2 n d cos(theta)` wavelengths: so many
//! fringes lie between its normal and its horizon, and over wavelength one in every `lambda^2/(2 n d)`.

use num_complex::Complex64;

/// A layer that leaves less of the light, to and fro, has no fringes.
const OPAQUE: f64 = 1e-9;

/// Of a film the layer whose fringes are the most.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LayerFringes {
    /// Its number, from 0.
    pub layer: usize,
    /// The fringes from its normal to its horizon.
    pub fringes: f64,
}

/// The fringes of a layer of this index and thickness (nm) at a wavelength (nm); 0 if it is opaque.
pub(super) fn fringes(index: Complex64, thickness_nm: f64, nm: f64) -> f64 {
    let left = (-8.0 * std::f64::consts::PI * index.im * thickness_nm / nm).exp();
    if left > OPAQUE { 2.0 * index.re * thickness_nm / nm } else { 0.0 }
}

/// How far apart in wavelength (nm) the fringes of all layers together are near a wavelength (nm), along the normal; each
/// layer is an index and a thickness (nm). Infinite without layers that light gets through.
pub fn fringe_spacing_nm(layers: impl IntoIterator<Item = (Complex64, f64)>, nm: f64) -> f64 {
    let all: f64 = layers.into_iter().map(|(index, thickness_nm)| fringes(index, thickness_nm, nm)).sum();
    nm / all
}

/// Of layers, each an index and a thickness (nm), the one that makes the most fringes at a wavelength (nm).
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
