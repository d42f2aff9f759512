//! Pictures on displays with a colour filter above the pixels.
//!
//! Each pixel has the colour of a page of its state, in which light of the filter's other parts is contained.
//! Light that the face returns to neighbours in other states is not: it is the largest where states are mixed
//! finely, and this difference is a part of the error.

use papilio_spectra::Spectrum;

use super::ImageSettings;
use super::held::Lit;
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::{Filter, FilterState, Pixel, Scene, UniformKind};
use crate::setup::Setup;

/// The largest difference, in X, Y and Z relative to a perfect white, between a fine mixture of states by the
/// fractions `shown` and the mean of their pages, whose X, Y, Z are given. 0 without a filter.
pub(super) fn error_of_mixture(
    setup: &Setup,
    pages: &[[f64; 3]],
    shown: &[f64],
    control: &Control<'_>,
) -> Result<f64, DisplayError> {
    let Some(mixed) = mixed(&setup.scene, shown)? else { return Ok(0.0) };
    let mut prepared = Prepared::of(setup.clone());
    let lit = Lit::new(&mixed, &ImageSettings::default(), &mut prepared, control)?;
    let fine = lit.palette.pages()[0];
    let mean = |k: usize| pages.iter().zip(shown).map(|(page, share)| share * page[k]).sum::<f64>();
    Ok((0..3).map(|k| (fine[k] - mean(k)).abs()).fold(0.0, f64::max))
}

/// The display with a single state: below each part of the filter, the mean reflectance of the states'
/// pixels. `None` without a filter.
fn mixed(scene: &Scene, shown: &[f64]) -> Result<Option<Scene>, DisplayError> {
    let mut mixed = scene.clone();
    let Some(Filter { states, transmittance, .. }) =
        mixed.display.matrix.as_mut().and_then(|matrix| matrix.filter.as_mut())
    else {
        return Ok(None);
    };
    let refused = |what: &str, key: &str| {
        Err(DisplayError::PlacesNotComputed { what: what.to_owned(), key: key.to_owned() })
    };
    let Pixel::Uniform(pixel) = &mut mixed.display.pixel else {
        return refused("a picture below a colour filter, except above uniform pixels", "display.pixel");
    };
    if pixel.kind == UniformKind::Mirror && !scene.lighting.directed.is_empty() {
        return refused(
            "a picture of lamps in mirror-like pixels below a colour filter",
            "lighting.directed",
        );
    }
    let below = |part: usize| {
        let nothing = Spectrum::constant(&scene.grid, 0.0);
        states.iter().zip(shown).fold(nothing, |sum, (state, share)| {
            sum.zip_map(&pixel.states[state.pixel_states[part]].1, |sum, one| sum + share * one)
        })
    };
    let reflectances: Vec<Spectrum> = (0..transmittance.len()).map(below).collect();
    let parts = reflectances.into_iter().enumerate();
    pixel.states = parts.map(|(part, mean)| (format!("below part {part}"), mean)).collect();
    *states =
        vec![FilterState { name: "mixture".to_owned(), pixel_states: (0..pixel.states.len()).collect() }];
    Ok(Some(mixed))
}
