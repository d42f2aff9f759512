//! What a film pixel is differentiated by.

use papilio_optics::film::Variable;

use crate::DisplayError;
use crate::pixel::film::{Mixture, Owner, Part};
use crate::scene::{Drive, FilmPixel, Thickness};

/// A number of a film pixel. All others stay when one is changed: areas, too, whose sum then changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// The thickness of a layer that is not the gap, nm.
    Thickness {
        /// Its number, 0 next to the glass.
        layer: usize,
    },
    /// The gap of a sub-pixel at its own colour, nm.
    Gap {
        /// Its number, from 0.
        sub_pixel: usize,
    },
    /// The gap of dark sub-pixels, nm.
    DarkGap,
    /// The gap that one state sets for a sub-pixel, nm.
    StateGap {
        /// Number of the state, from 0.
        state: usize,
        /// Number of the sub-pixel, from 0.
        sub_pixel: usize,
    },
    /// A sub-pixel's share of the active area.
    Area {
        /// Its number, from 0.
        sub_pixel: usize,
    },
    /// The active share of the panel.
    FillFactor,
    /// n of a layer, shifted alike at all wavelengths.
    Index {
        /// Its number, 0 next to the glass, the gap counted.
        layer: usize,
    },
    /// k of a layer, likewise.
    Extinction {
        /// Its number, 0 next to the glass, the gap counted.
        layer: usize,
    },
    /// n of the substrate, likewise.
    SubstrateIndex,
    /// k of the substrate, likewise.
    SubstrateExtinction,
}

/// What of the table a parameter changes.
pub(super) enum Change {
    /// The film's reflectances: at one gap, or at all.
    Film { variable: Variable, gap: Option<usize> },
    /// The shares of the gaps in the states.
    Shares {
        /// `[state][gap]`.
        mixture: Vec<f64>,
        /// Of the inactive reflectance.
        inactive: f64,
    },
    /// Nothing.
    Nothing,
}

impl Parameter {
    /// What it changes of this film.
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

/// That of an owner's gap; nothing if no state shows it, or the film has no gap.
fn gap_of(owner: Owner, film: &FilmPixel, mixture: &Mixture) -> Change {
    let layer = film.layers.iter().position(|layer| layer.thickness == Thickness::Gap);
    let gap = mixture.owners.iter().position(|one| *one == owner);
    match (layer, gap) {
        (Some(layer), Some(_)) => Change::Film { variable: Variable::Thickness(layer), gap },
        _ => Change::Nothing,
    }
}

/// What the parts of each state and gap sum to.
fn summed(film: &FilmPixel, mixture: &Mixture, of_part: impl Fn(&Part) -> f64) -> Vec<f64> {
    let gaps = mixture.gaps_nm.len();
    let mut sum = vec![0.0; film.states.len() * gaps];
    mixture.parts.iter().for_each(|part| sum[part.state * gaps + part.gap] += of_part(part));
    sum
}
