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
    /// The pairs of directions.
    #[serde(skip)]
    pub each: Vec<BrdfPair>,
}

/// A pair of directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BrdfPair {
    /// Inclination of the light, degrees.
    pub light_deg: f64,
    /// Predicted BRDF, 1/sr.
    pub predicted: f64,
    /// Measured BRDF, 1/sr.
    pub measured: f64,
}

impl BrdfPair {
    /// Predicted minus measured, relative to the measured value.
    fn difference(self) -> f64 {
        self.predicted / self.measured - 1.0
    }
}

/// Most pairs of a figure; of more, equally spaced ones are drawn.
const DRAWN: usize = 450;

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
    let pairs: Vec<BrdfPair> = known
        .filter_map(|cell| {
            let [light, viewer] = measured.geometry.directions(cell)?;
            let predicted = level * scatter.evaluate(light.arriving(), viewer.leaving());
            Some(BrdfPair { light_deg: light.theta_deg, predicted, measured: values[cell] })
        })
        .collect();
    if pairs.is_empty() {
        return Err(ReproductionError::List(format!("{}: no value is above 0", sample.measured)));
    }
    let brdf = BrdfComparison::new(
        state,
        pairs,
        [sample.relative_standard_deviation.unwrap_or(0.0), interpolation_error(sample, folder)],
    );
    Ok(CasePrediction { name: case.name.clone(), comparison: brdf.agreement(), brdf: Some(brdf) })
}

impl BrdfComparison {
    fn new(state: &str, each: Vec<BrdfPair>, [measured, predicted]: [f64; 2]) -> Self {
        let count = each.len() as f64;
        let mean_of = |value: &dyn Fn(&BrdfPair) -> f64| each.iter().map(value).sum::<f64>() / count;
        let mut sizes: Vec<f64> = each.iter().map(|pair| pair.difference().abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let level = mean_of(&|pair| pair.measured);
        let lambertian_rms = mean_of(&|pair| (level / pair.measured - 1.0).powi(2)).sqrt();
        Self {
            state: state.to_owned(),
            pairs: each.len(),
            mean: mean_of(&|pair| pair.difference()),
            rms: mean_of(&|pair| pair.difference().powi(2)).sqrt(),
            within_95: sizes[(0.95 * count) as usize],
            largest: sizes[sizes.len() - 1],
            lambertian_rms,
            measured_deviation: measured,
            predicted_deviation: predicted,
            each,
        }
    }

    /// The comparison as that of a display: without the standard deviation of the measurement there is no agreement to state.
    fn agreement(&self) -> Comparison {
        let deviation = self.measured_deviation.hypot(self.predicted_deviation);
        let z = self.each.iter().map(|pair| pair.difference() / deviation);
        let agreement = if self.measured_deviation > 0.0 { Agreement::of(z) } else { None };
        Comparison {
            states: Vec::new(),
            views: Vec::new(),
            metrics: Vec::new(),
            agreement,
            left_out: Vec::new(),
        }
    }

    /// Draws predicted against measured values.
    pub(super) fn figure(&self, title: &str) -> String {
        let every = self.each.len().div_ceil(DRAWN).max(1);
        let drawn = || self.each.iter().step_by(every);
        let curve = |name: &str, hue: usize, inclined: bool| ChartCurve {
            name: name.to_owned(),
            hue: Hue::Group(hue),
            dashed: false,
            marks: true,
            points: drawn()
                .filter(|pair| (pair.light_deg > 45.0) == inclined)
                .map(|pair| (pair.measured, pair.predicted))
                .collect(),
        };
        let measured = || drawn().map(|pair| pair.measured);
        let ends = [measured().fold(f64::INFINITY, f64::min), measured().fold(0.0, f64::max)];
        let equal = ChartCurve {
            name: "equal".to_owned(),
            hue: Hue::Grey,
            dashed: true,
            marks: false,
            points: ends.map(|end| (end, end)).to_vec(),
        };
        let figure = Chart {
            x: "Measured BRDF (1/sr)".to_owned(),
            y: "Predicted BRDF (1/sr)".to_owned(),
            logarithmic: false,
            at_least: Vec::new(),
            curves: vec![curve("light < 45\u{b0}", 2, false), curve("light > 45\u{b0}", 0, true), equal],
        };
        let which = match every {
            1 => String::new(),
            2 => format!(", every second of {} pairs", self.pairs),
            3 => format!(", every third of {} pairs", self.pairs),
            _ => format!(", every {every}th of {} pairs", self.pairs),
        };
        chart(&figure, &format!("{title}{which}"))
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
