//! A picture without halftone: each pixel has the mapped colour itself, which no single state shows.

use super::held::{Brought, Factors, LightPicture, Lit};
use super::lamps::lamp_images;
use super::{ImageSettings, SourceImage};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::Scene;

/// Name of the light of a picture whose lights are not computed one by one.
const ALL: &str = "all";

/// Computes the colours that a halftone would show, in all light at once: they follow the white and the black of the display, so that other
/// light needs other colours. `settings.halftone` is not looked at. Returns the names of the states and the picture.
///
/// # Errors
/// As [`image`](super::image()).
pub fn exact(
    scene: &Scene,
    source: &SourceImage,
    settings: &ImageSettings,
    prepared: &mut Prepared,
    control: &Control<'_>,
) -> Result<(Vec<String>, Factors), DisplayError> {
    let size = source.size_on(scene)?;
    let settings = ImageSettings {
        halftone: super::Halftone::None,
        given: None,
        prepared_for: None,
        ..settings.clone()
    };
    let lit = Lit::new(scene, &settings, prepared, control)?;
    let brought = Brought::new(&lit, scene, source, &settings, control)?;
    let white = lit.white.to_array();
    let all = LightPicture { light: ALL.to_owned(), white, pixels: brought.rendered.mapped };
    let names = lit.palette.names();
    let factors = Factors {
        size,
        lights: vec![all],
        pages: lit.palette.pages(),
        error: lit.palette.error(),
        neighbours_light: false,
        lamps: lamp_images(scene, &names)?,
    };
    Ok((names, factors))
}
