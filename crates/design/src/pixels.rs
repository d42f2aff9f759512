//! Quantities of designs that no run computes: sharpness, crosstalk, sparkle, gloss, and those of pictures.

use papilio_display::gloss::gloss_of;
use papilio_display::image::{Screen, image};
use papilio_display::scene::MetricSource;
use papilio_display::spatial::{Antiglare, Face, crosstalk, mtf, sparkle};
use papilio_display::{Control, Quantity};
use papilio_scenario::Resolved;

use crate::DesignError;

/// Computes value and error of each quantity of a display.
///
/// # Errors
/// Those of [`mtf`], [`crosstalk`], [`sparkle`], [`gloss_of`] and [`image`], for a display or a light that they do not
/// cover; metrics of sparkle without an antiglare face.
pub(crate) fn quantities(
    resolved: &Resolved,
    quantities: &[&Quantity],
    control: &Control<'_>,
) -> Result<Vec<[Option<f64>; 2]>, DesignError> {
    let scene = &resolved.scene;
    let is_wanted = |source| quantities.iter().any(|quantity| quantity.source() == source);
    let sharpness =
        is_wanted(MetricSource::Mtf).then(|| mtf(scene, &resolved.patterns, control)).transpose()?;
    let shares = is_wanted(MetricSource::Crosstalk)
        .then(|| crosstalk(scene, &resolved.patterns.text, control))
        .transpose()?;
    let of_sparkle = quantities.iter().find(|quantity| quantity.source() == MetricSource::Sparkle);
    let sparkle = match (of_sparkle, &resolved.sparkle) {
        (None, _) => None,
        (Some(quantity), Some(face)) => {
            of_one_face(quantity, face)?;
            Some(sparkle(scene, face, control)?)
        }
        (Some(quantity), None) => return Err(DesignError::NoFace { metric: quantity.name().to_owned() }),
    };
    let picture = match &resolved.image {
        Some(request) if is_wanted(MetricSource::Image) => {
            let found = image(scene, &request.source, &request.settings, Screen::default(), control)?;
            Some(found.numbers.metrics())
        }
        _ => None,
    };
    let is_metric = |name: &str| quantities.iter().any(|quantity| quantity.name().ends_with(name));
    let of_gloss =
        is_wanted(MetricSource::Gloss).then(|| gloss_of(scene, &is_metric, control)).transpose()?;
    let views = scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len();
    let of = |quantity: &&Quantity| match quantity.source() {
        MetricSource::Colours => [None; 2],
        MetricSource::Mtf => sharpness.as_ref().map(|found| quantity.of_sharpness(found)).unwrap_or_default(),
        MetricSource::Crosstalk => {
            shares.as_ref().map(|found| quantity.of_crosstalk(found)).unwrap_or_default()
        }
        MetricSource::Sparkle => {
            sparkle.as_ref().map(|found| quantity.of_sparkle(&found.rows, views)).unwrap_or_default()
        }
        MetricSource::Gloss => of_gloss.as_ref().map(|found| quantity.of_gloss(found)).unwrap_or_default(),
        MetricSource::Image => picture.as_ref().map(|found| quantity.of_image(found)).unwrap_or_default(),
    };
    Ok(quantities.iter().map(of).collect())
}

/// Refuses a metric of sparkle of several faces or gaps: it would be that of the first.
fn of_one_face(quantity: &Quantity, antiglare: &Antiglare) -> Result<(), DesignError> {
    let error = |key, count, first| {
        Err(DesignError::SeveralFaces { metric: quantity.name().to_owned(), count, key, first })
    };
    match (&antiglare.faces[..], &antiglare.gap_mm[..]) {
        ([Face::Gaussian(first), _, ..], _) => {
            error("correlation_um", antiglare.faces.len(), 1e3 * first.correlation_mm)
        }
        (_, [first, _, ..]) => error("gap_mm", antiglare.gap_mm.len(), *first),
        _ => Ok(()),
    }
}
