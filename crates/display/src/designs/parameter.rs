//! Parameters of film pixels for differentiation.

use papilio_optics::film::Variable;

use crate::DisplayError;
use crate::pixel::film::{Mixture, Owner, Part};
use crate::scene::{Drive, FilmPixel, Thickness};

/// Parameter of a film pixel. A derivative keeps all other parameters fixed, including the other areas: the
/// sum of the areas then changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Thickness of a layer other than the gap, nm.
    Thickness {
        /// Number of the layer, 0 next to the glass.
        layer: usize,
    },
    /// Gap of a sub-pixel that shows its colour, nm.
    Gap {
        /// Number of the sub-pixel, from 0.
        sub_pixel: usize,
    },
    /// Gap of dark sub-pixels, nm.
    DarkGap,
    /// Gap of a sub-pixel in a state that specifies it, nm.
    StateGap {
        /// Number of the state, from 0.
        state: usize,
        /// Number of the sub-pixel, from 0.
        sub_pixel: usize,
    },
    /// Fraction of the active area of a sub-pixel.
    Area {
        /// Number of the sub-pixel, from 0.
        sub_pixel: usize,
    },
    /// Fill factor: active fraction of the panel.
    FillFactor,
    /// n of a layer, shifted by the same amount at all wavelengths.
    Index {
        /// Number of the layer, 0 next to the glass, including the gap.
        layer: usize,
    },
    /// k of a layer, shifted by the same amount at all wavelengths.
    Extinction {
        /// Number of the layer, 0 next to the glass, including the gap.
        layer: usize,
    },
    /// n of the substrate, shifted by the same amount at all wavelengths.
    SubstrateIndex,
    /// k of the substrate, shifted by the same amount at all wavelengths.
    SubstrateExtinction,
}

/// Part of the table that depends on a parameter.
pub(super) enum Change {
    /// Reflectances of the film, at one gap or at all gaps.
    Film { variable: Variable, gap: Option<usize> },
    /// Area fractions of the gaps in the states.
    Shares {
        /// Derivatives of the fractions, `[state][gap]`.
        mixture: Vec<f64>,
        /// Derivative of the inactive fraction.
        inactive: f64,
    },
    /// None.
    Nothing,
}

impl Parameter {
    /// Returns the part of the table of this film that depends on the parameter.
    pub(super) fn change(self, film: &FilmPixel, mixture: &Mixture) -> Result<Change, DisplayError> {
        let layers = film.layers.len();
        let missing = |what, number| DisplayError::NoSuchParameter { what, number };
        let of_film = |variable| Ok(Change::Film { variable, gap: None });
        let there = |layer: usize| if layer < layers { Ok(layer) } else { Err(missing("layer", layer)) };
        match self {
            Self::Thickness { layer } => match film.layers.get(layer).map(|layer| layer.thickness) {
                Some(Thickness::Fixed(_)) => of_film(Variable::Thickness(layer)),
                _ => Err(missing("layer of fixed thickness", layer)),
            },
            Self::Index { layer } => of_film(Variable::Index(there(layer)?)),
            Self::Extinction { layer } => of_film(Variable::Extinction(there(layer)?)),
            Self::SubstrateIndex => of_film(Variable::SubstrateIndex),
            Self::SubstrateExtinction => of_film(Variable::SubstrateExtinction),
            Self::Gap { sub_pixel } if sub_pixel >= film.sub_pixels.len() => {
                Err(missing("sub-pixel", sub_pixel))
            }
            Self::Gap { sub_pixel } => Ok(gap_of(Owner::SubPixel(sub_pixel), film, mixture)),
            Self::DarkGap if film.dark_gap_nm.is_none() => Err(missing("dark gap", 0)),
            Self::DarkGap => Ok(gap_of(Owner::Dark, film, mixture)),
            Self::StateGap { state, sub_pixel } => {
                let drive = film.states.get(state).and_then(|state| state.drives.get(sub_pixel));
                match drive {
                    Some(Drive::Gap(_)) => Ok(gap_of(Owner::State { state, sub_pixel }, film, mixture)),
                    _ => Err(missing("state that sets the gap of this sub-pixel", state)),
                }
            }
            Self::Area { sub_pixel } if sub_pixel >= film.sub_pixels.len() => {
                Err(missing("sub-pixel", sub_pixel))
            }
            Self::Area { sub_pixel } => {
                let of_part = |part: &Part| {
                    if part.sub_pixel == sub_pixel { film.fill_factor * part.on } else { 0.0 }
                };
                Ok(Change::Shares { mixture: summed(film, mixture, of_part), inactive: 0.0 })
            }
            Self::FillFactor => {
                let of_part = |part: &Part| film.sub_pixels[part.sub_pixel].area * part.on;
                Ok(Change::Shares { mixture: summed(film, mixture, of_part), inactive: -1.0 })
            }
        }
    }
}

/// Dependence on the gap of an owner; none if no state shows it, or the film has no gap.
fn gap_of(owner: Owner, film: &FilmPixel, mixture: &Mixture) -> Change {
    let layer = film.layers.iter().position(|layer| layer.thickness == Thickness::Gap);
    let gap = mixture.owners.iter().position(|one| *one == owner);
    match (layer, gap) {
        (Some(layer), Some(_)) => Change::Film { variable: Variable::Thickness(layer), gap },
        _ => Change::Nothing,
    }
}

/// Sums a value of the parts for each state and gap.
fn summed(film: &FilmPixel, mixture: &Mixture, of_part: impl Fn(&Part) -> f64) -> Vec<f64> {
    let gaps = mixture.gaps_nm.len();
    let mut sum = vec![0.0; film.states.len() * gaps];
    mixture.parts.iter().for_each(|part| sum[part.state * gaps + part.gap] += of_part(part));
    sum
}
