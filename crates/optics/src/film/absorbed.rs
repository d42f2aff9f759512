//! Absorptance of each layer of a film for unpolarised light.

use super::{Film, Layer, Polarisation, coherent};
use crate::OpticsError;

/// Where unpolarised light goes in a film: fractions of the incident power, which sum to 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Absorbed {
    /// Reflected fraction.
    pub reflectance: f64,
    /// Fraction that each layer absorbs, in the order of the layers.
    pub layers: Vec<f64>,
    /// Fraction that enters the substrate: absorbed there if the substrate is opaque, otherwise transmitted.
    pub substrate: f64,
}

/// Computes the absorptance of each layer of `film` and of its substrate, mean of s and p, at one wavelength
/// and beta.
///
/// They are differences of the Poynting flux between the two faces of a layer ([`coherent`]), exact also
/// where the layer or the substrate absorbs and where the field is evanescent.
///
/// ```
/// use num_complex::Complex64;
/// use papilio_optics::film::{Film, Layer, absorbed};
/// // 10 nm of chromium on glass: what is neither reflected nor transmitted is absorbed there.
/// let chromium = Layer { index: Complex64::new(3.18, 3.31), thickness_nm: 10.0 };
/// let film = Film { incidence: 1.0, layers: vec![chromium], substrate: 1.5.into() };
/// let light = absorbed(&film, 550.0, 0.0)?;
/// assert!((light.reflectance + light.layers[0] + light.substrate - 1.0).abs() < 1e-12);
/// assert!((light.layers[0] - 0.403808).abs() < 1e-6); // the same as the Python package tmm
/// # Ok::<(), papilio_optics::OpticsError>(())
/// ```
///
/// # Errors
/// As [`coherent`].
pub fn absorbed(film: &Film, wavelength_nm: f64, beta: f64) -> Result<Absorbed, OpticsError> {
    let [s, p] = [Polarisation::S, Polarisation::P].map(|one| coherent(film, wavelength_nm, beta, one));
    let (s, p) = (s?, p?);
    let mean = |s: f64, p: f64| 0.5 * (s + p);
    let of_both = s.absorptance.iter().zip(&p.absorptance).zip(&film.layers);
    // A clear layer absorbs nothing; its difference is a rounding error.
    let of_layer = |((s, p), layer): ((&f64, &f64), &Layer)| {
        if layer.index.im == 0.0 { 0.0 } else { mean(*s, *p) }
    };
    Ok(Absorbed {
        reflectance: mean(s.reflectance, p.reflectance),
        layers: of_both.map(of_layer).collect(),
        substrate: mean(s.transmittance, p.transmittance),
    })
}
