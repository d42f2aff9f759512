//! Prediction of a BRDF at listed pairs of directions: that of the scenario's pixel.

use std::path::Path;

use papilio_display::compare::{Agreement, Comparison};
use papilio_display::scene::{Pixel, Scene};
use papilio_figures::{Chart, ChartCurve, Hue, chart};
use papilio_formats::{DataFile, read_bsdf_file};
use papilio_goniometry::{Audit, Channel, Geometry, MeasuredPart, ScatterMode};
use papilio_optics::Scatterer;
use papilio_scenario::Scenario;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Case, CasePrediction, Sample};
use crate::ReproductionError;

/// Wavelength for a list that states none, nm.
const LUMINOUS_NM: f64 = 555.0;

/// Comparison of a predicted and a measured BRDF: differences are predicted minus measured, relative to the measured value.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct BrdfComparison {
    /// State of the pixel.
    pub state: String,
    /// Number of pairs of directions.
    pub pairs: usize,
    /// Mean difference.
    pub mean: f64,
    /// Root mean square of the differences.
    pub rms: f64,
    /// Difference that 95 % of the pairs do not exceed.
    pub within_95: f64,
    /// Largest difference.
    pub largest: f64,
    /// Root mean square of the differences of a Lambertian reflector with the mean of the measured values.
    pub lambertian_rms: f64,
    /// Relative standard deviation of the measured values.
    pub measured_deviation: f64,
    /// Relative standard deviation of the predicted values: the error of the interpolation between the given ones.
    pub predicted_deviation: f64,
    /// Inclinations of light and viewer, degrees, and the difference.
    #[serde(skip)]
    pub differences: Vec<[f64; 3]>,
}

/// Predicts the BRDF of a sample's pixel, and compares it.
pub(super) fn predict_case(
    sample: &Sample,
    case: &Case,
    folder: &Path,
) -> Result<CasePrediction, ReproductionError> {
    let set: Vec<String> = case.set.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let resolved = Scenario::load(&folder.join(&sample.scenario), &set)?.resolve()?;
    let measured = reflection(folder, &sample.measured)?;
    let wrong = |what: &str| ReproductionError::List(format!("{}: {what}", sample.scenario));
    let Pixel::Scattering(pixel) = &resolved.scene.display.pixel else {
        return Err(wrong(
            "quantity = \"brdf\" needs a pixel with a BRDF: display.pixel.model = \"measured\"",
        ));
    };
    let (state, kernel) = pixel.states.first().ok_or_else(|| wrong("the pixel has no state"))?;
    let level = level(&resolved.scene, &kernel.factor, measured.channels.first());
    // Reflections are used as the mean of both senses.
    let scatter = kernel.scatter.reciprocal();
    let values = measured.channel(0);
    let known = (0..values.len()).filter(|cell| values[*cell] > 0.0);
    let differences: Vec<[f64; 3]> = known
        .filter_map(|cell| {
            let [light, viewer] = measured.geometry.directions(cell)?;
            let predicted = level * scatter.evaluate(light.arriving(), viewer.leaving());
            Some([light.theta_deg, viewer.theta_deg, predicted / values[cell] - 1.0])
        })
        .collect();
    if differences.is_empty() {
        return Err(ReproductionError::List(format!("{}: no value is above 0", sample.measured)));
    }
    let brdf = BrdfComparison::new(
        state,
        differences,
        values,
        [sample.relative_standard_deviation.unwrap_or(0.0), interpolation_error(sample, folder)],
    );
    Ok(CasePrediction { name: case.name.clone(), comparison: brdf.agreement(), brdf: Some(brdf) })
}

impl BrdfComparison {
    fn new(state: &str, differences: Vec<[f64; 3]>, values: &[f64], [measured, predicted]: [f64; 2]) -> Self {
        let count = differences.len() as f64;
        let mean = differences.iter().map(|[_, _, off]| off).sum::<f64>() / count;
        let rms = (differences.iter().map(|[_, _, off]| off * off).sum::<f64>() / count).sqrt();
        let mut sizes: Vec<f64> = differences.iter().map(|[_, _, off]| off.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let lit = || values.iter().filter(|value| **value > 0.0);
        let level = lit().sum::<f64>() / count;
        let lambertian_rms = (lit().map(|value| (level / value - 1.0).powi(2)).sum::<f64>() / count).sqrt();
        Self {
            state: state.to_owned(),
            pairs: differences.len(),
            mean,
            rms,
            within_95: sizes[(0.95 * count) as usize],
            largest: sizes[sizes.len() - 1],
            lambertian_rms,
            measured_deviation: measured,
            predicted_deviation: predicted,
            differences,
        }
    }

    /// The comparison as that of a display: without the standard deviation of the measurement there is no agreement to state.
    fn agreement(&self) -> Comparison {
        let deviation = self.measured_deviation.hypot(self.predicted_deviation);
        let z = self.differences.iter().map(|[_, _, off]| off / deviation);
        let agreement = if self.measured_deviation > 0.0 { Agreement::of(z) } else { None };
        Comparison {
            states: Vec::new(),
            views: Vec::new(),
            metrics: Vec::new(),
            agreement,
            left_out: Vec::new(),
        }
    }

    /// Draws the differences against the inclination of the viewer.
    pub(super) fn figure(&self, title: &str) -> String {
        let curve = |name: &str, hue: usize, inclined: bool| ChartCurve {
            name: name.to_owned(),
            hue: Hue::Group(hue),
            dashed: false,
            marks: true,
            points: (self.differences.iter())
                .filter(|[light, _, _]| (*light > 45.0) == inclined)
                .map(|[_, viewer, off]| (*viewer, 100.0 * off))
                .collect(),
        };
        let figure = Chart {
            x: "Inclination of the viewer (deg)".to_owned(),
            y: "BRDF, predicted minus measured (%)".to_owned(),
            logarithmic: false,
            at_least: vec![0.0],
            curves: vec![curve("light to 45 deg", 2, false), curve("light beyond", 0, true)],
        };
        chart(&figure, title)
    }
}

/// The front reflection of a file in the folder of the list.
fn reflection(folder: &Path, name: &str) -> Result<MeasuredPart, ReproductionError> {
    let file = DataFile::open(&folder.join(name), name)?;
    let parts = read_bsdf_file(&file, None)?.measurement.parts;
    let part = parts.into_iter().find(|part| part.way == ScatterMode::FrontReflection);
    part.ok_or_else(|| ReproductionError::List(format!("{name}: this file has no front reflection")))
}

/// Factor of the kernel at the wavelength of the list.
fn level(scene: &Scene, factor: &papilio_spectra::Spectrum, channel: Option<&Channel>) -> f64 {
    let nm = if let Some(Channel::Wavelength(nm)) = channel { *nm } else { LUMINOUS_NM };
    let off = |k: &usize| (scene.grid.wavelengths_nm()[*k] - nm).abs();
    (0..factor.len())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .and_then(|k| factor.get(k).copied())
        .unwrap_or(1.0)
}

/// Error of the interpolation between the pairs of the lists that the scenario names: 0 without a list.
fn interpolation_error(sample: &Sample, folder: &Path) -> f64 {
    let lists = sample.files.iter().filter_map(|name| reflection(folder, name).ok());
    let errors = lists
        .filter(|part| matches!(part.geometry, Geometry::Pairs(_)))
        .filter_map(|part| Audit::of(&part, 0)?.pairs);
    errors.map(|pairs| pairs.errors.one_left_out.rms).fold(0.0, f64::max)
}
