//! What lies on every facet of a surface: nothing, a mirror, a metal, or thin films.
//!
//! **Model.** A facet is flat for the light that meets it: its reflectance R, transmittance T and absorptance
//! 1 - R - T are those of a flat face at the angle between the light and its normal, for unpolarised light of
//! one wavelength.
//!
//! **Validity.** Layers that are thin beside the features of the surface and have the same thickness
//! everywhere along its normal.
//!
//! Source: M. Born, E. Wolf, "Principles of Optics", 7th ed., sections 1.5.2, 1.6 and 14.2.

use num_complex::Complex64;
use papilio_optics::film::{Coating as FilmTable, Layer, SpectralLayer, Thickness};
use papilio_optics::interface::fresnel_reflectance;

use crate::{MicrogeometryError, Side};

/// |beta| at grazing incidence, relative to the index: a film has no wave along itself.
const GRAZING: f64 = 1.0 - 1e-12;

/// What lies on every facet of a surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Coating {
    /// Nothing: Fresnel's reflectance between the two media.
    #[default]
    None,
    /// A mirror with the same reflectance, 0 to 1, at all angles and from both sides. It absorbs all other
    /// light.
    Mirror {
        /// The reflectance.
        reflectance: f64,
    },
    /// An opaque metal of this index n + ik: from both sides, light is reflected or absorbed.
    Metal {
        /// The index.
        index: Complex64,
    },
    /// Coherent thin films; see [`Coating::films`].
    Films(Films),
}

/// Thin films between the two media of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Films(FilmTable);

/// What a facet does with light, as fractions. The rest is absorbed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Split {
    pub(crate) reflectance: f64,
    pub(crate) transmittance: f64,
}

impl Coating {
    /// Coherent films, from top to bottom, between media of these indices above and below, for light of one
    /// wavelength.
    ///
    /// # Errors
    /// Those of the films: indices, thicknesses or a wavelength out of range, and films too thick to be
    /// coherent.
    pub fn films(index: [f64; 2], layers: &[Layer], wavelength_nm: f64) -> Result<Self, MicrogeometryError> {
        let layer = |layer: &Layer| SpectralLayer {
            index: vec![layer.index],
            thickness: Thickness::Fixed(layer.thickness_nm),
        };
        let layers: Vec<SpectralLayer> = layers.iter().map(layer).collect();
        let [above, below] = index;
        let table = FilmTable::new(&[wavelength_nm], &[above], &layers, &[below]);
        table
            .map(|table| Self::Films(Films(table)))
            .map_err(|wrong| MicrogeometryError::Coating { wrong: wrong.to_string() })
    }

    /// What a facet does with light from a side with `beta = n sin θ` between media of these indices, those
    /// of the light first.
    pub(crate) fn split(&self, [from, to]: [f64; 2], side: Side, beta: f64) -> Split {
        match self {
            Self::None => {
                let reflectance = fresnel_reflectance(from, to, beta);
                Split { reflectance, transmittance: 1.0 - reflectance }
            }
            Self::Mirror { reflectance } => Split { reflectance: *reflectance, transmittance: 0.0 },
            Self::Metal { index } => {
                Split { reflectance: metal_reflectance(from, *index, beta), transmittance: 0.0 }
            }
            Self::Films(Films(table)) => {
                let part = table.part(beta.min(GRAZING * from).powi(2), 0);
                let reflectance = if side == Side::Above { part.above } else { part.below };
                // The errors of the table are 1e-9.
                let reflectance = reflectance.clamp(0.0, 1.0);
                Split { reflectance, transmittance: part.transmittance.clamp(0.0, 1.0 - reflectance) }
            }
        }
    }

    /// Whether light can be absorbed.
    pub(crate) fn absorbs(&self) -> bool {
        !matches!(self, Self::None)
    }

    /// Fails for quantities out of range.
    pub(crate) fn check(&self) -> Result<(), MicrogeometryError> {
        let not_a_number = |what, value, wanted| {
            Err(MicrogeometryError::NotANumber { of: "the coating of a surface", what, value, wanted })
        };
        match self {
            Self::Mirror { reflectance } if !(0.0..=1.0).contains(reflectance) => {
                not_a_number("reflectance", *reflectance, "number from 0 to 1, a finite")
            }
            Self::Metal { index } if !(index.is_finite() && index.re >= 0.0 && index.im > 0.0) => {
                not_a_number("extinction coefficient k", index.im, "positive")
            }
            _ => Ok(()),
        }
    }
}

/// Reflectance of a metal in a medium of index n for unpolarised light, `beta = n sin θ` (Born and Wolf,
/// section 14.2).
fn metal_reflectance(n: f64, metal: Complex64, beta: f64) -> f64 {
    let beta = beta.min(n);
    let inside = Complex64::from(((n - beta) * (n + beta)).sqrt());
    // The root with a positive imaginary part: the wave decays in the metal.
    let behind = (metal * metal - beta * beta).sqrt();
    let of = |a: Complex64, b: Complex64| ((a - b) / (a + b)).norm_sqr();
    0.5 * (of(inside, behind) + of(metal * metal * inside, n * n * behind))
}

#[cfg(test)]
mod tests {
    use papilio_optics::film::{Film, Polarisation, coherent};

    use super::*;

    /// The mean of s and p by the reference of films: reflectance and transmittance.
    pub(crate) fn by_reference(film: &Film, nm: f64, beta: f64) -> [f64; 2] {
        let of = |polarisation| coherent(film, nm, beta, polarisation).unwrap();
        let [s, p] = [Polarisation::S, Polarisation::P].map(of);
        [0.5 * (s.reflectance + p.reflectance), 0.5 * (s.transmittance + p.transmittance)]
    }

    #[test]
    fn metals_and_films_are_those_of_the_reference() {
        let metal = Complex64::new(0.06, 3.6);
        let layers = [
            Layer { index: Complex64::new(2.3, 0.0), thickness_nm: 60.0 },
            Layer { index: Complex64::new(0.9, 6.4), thickness_nm: 8.0 },
        ];
        let index = [1.0, 1.5];
        let films = Coating::films(index, &layers, 550.0).unwrap();
        for side in Side::ALL {
            let (media, order) = match side {
                Side::Above => (index, layers.to_vec()),
                Side::Below => ([1.5, 1.0], layers.iter().rev().copied().collect()),
            };
            for sine in [0.0, 0.3, 0.6, 0.7, 0.95, 0.9999] {
                let beta = sine * media[0];
                let bulk = Film { incidence: media[0], layers: Vec::new(), substrate: metal };
                let found = Coating::Metal { index: metal }.split(media, side, beta);
                assert!((found.reflectance - by_reference(&bulk, 550.0, beta)[0]).abs() < 1e-12);
                assert_eq!(found.transmittance, 0.0);
                let film = Film { incidence: media[0], layers: order.clone(), substrate: media[1].into() };
                let [reflectance, transmittance] = by_reference(&film, 550.0, beta);
                let found = films.split(media, side, beta);
                assert!((found.reflectance - reflectance).abs() < 1e-8, "{side:?} {sine}: {found:?}");
                assert!((found.transmittance - transmittance).abs() < 1e-8, "{side:?} {sine}: {found:?}");
            }
        }
        // Silver-like metal along the normal: ((1 - n)^2 + k^2)/((1 + n)^2 + k^2).
        let normal = (0.94_f64.powi(2) + 3.6 * 3.6) / (1.06_f64.powi(2) + 3.6 * 3.6);
        let found = Coating::Metal { index: metal }.split([1.0, 1.5], Side::Above, 0.0);
        assert!((found.reflectance - normal).abs() < 1e-12);
    }
}
