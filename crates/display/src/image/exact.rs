//! A picture without halftone: each pixel has the mapped colour itself, which no single state shows.

use papilio_colour::Xyz;
use papilio_colour::states::LeastVariance;

use super::colour;
use super::held::{Brought, Factors, LightPicture, Lit};
use super::lamps::drawn_lamps;
use super::rendering::Rendering;
use super::{ImageSettings, SourceImage};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::Scene;

/// Name of the light of a picture whose lights are not computed one by one.
const ALL: &str = "all";

/// Computes the colours that a halftone would show, in all light at once: they follow the white and the black
/// of the display, so that other light needs other colours. `settings.halftone` is not looked at. Returns the
/// names of the states and the picture.
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
        prepared_for: Vec::new(),
        ..settings.clone()
    };
    let lit = Lit::new(scene, &settings, prepared, control)?;
    let brought = Brought::new(&lit, source, &settings, control)?;
    let white = lit.white.to_array();
    let coverage = mean_coverage(&brought.rendering, &brought.rendered.mapped)?;
    let all = LightPicture { light: ALL.to_owned(), white, pixels: brought.rendered.mapped };
    let names = lit.palette.names();
    let factors = Factors {
        size,
        lights: vec![all],
        pages: lit.palette.pages(),
        error: lit.palette.error(),
        neighbours_light: false,
        lamps: drawn_lamps(&lit.setup, &names, control)?,
        coverage,
    };
    Ok((names, factors))
}

/// Fraction of a panel in each state whose mean colour is that of a picture.
fn mean_coverage(rendering: &Rendering, pixels: &[[f32; 3]]) -> Result<Vec<f64>, DisplayError> {
    let points: Vec<Xyz> = rendering.states.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z }).collect();
    let sum = pixels.iter().fold(Xyz { x: 0.0, y: 0.0, z: 0.0 }, |sum, pixel| sum + colour(*pixel));
    let mean = sum * (1.0 / pixels.len().max(1) as f64);
    let solver = LeastVariance::new(&points)?;
    let found = solver.coverages(mean).or_else(|| solver.coverages(rendering.nearest(mean)));
    let mut coverage = vec![0.0; points.len()];
    match &found {
        Some(found) => found.iter().for_each(|(state, part)| coverage[state] = part),
        None => coverage.fill(1.0 / points.len() as f64),
    }
    Ok(coverage)
}
