//! Result of [`mtf`](super::mtf()), serialised as `mtf.json`.

use schemars::JsonSchema;
use serde::Serialize;

use super::PatternMean;
pub use crate::metrics::{LineContrast, SharpnessMetrics, SpatialScalars};
use crate::result::Named;

/// How sharp the white of a display is: Barten's square-root integral along x and y, just noticeable differences.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Sharpness {
    /// With the modulation transfer of the layers.
    pub sqri_jnd: [f64; 2],
    /// With perfect transfer up to the Nyquist frequency of the pixels, at the same luminance.
    pub sqri_ideal_jnd: [f64; 2],
}

/// How sharp a display is; it does not contain the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MtfResult {
    /// Spatial frequencies in the plane of the panel, cycles per mm.
    pub frequency_per_mm: Vec<f64>,
    /// `frequency_per_mm` for the eye at `viewer.distance_mm`, cycles per degree.
    pub cycles_per_degree: Vec<f64>,
    /// Period of a pixel along x and y, um; null without a matrix.
    pub pitch_um: Option<[f64; 2]>,
    /// Nyquist frequency of the pixels along x and y, cycles per mm; null without a matrix.
    pub nyquist_per_mm: Option<[f64; 2]>,
    /// Highest spatial frequency that the eye sees at full contrast (Barten 1999), cycles per mm.
    pub eye_limit_per_mm: Option<f64>,
    /// Largest error of a modulation transfer: the difference of two levels of discretisation.
    pub error_reached: f64,
    /// One entry for each view, with theta varying fastest.
    pub views: Vec<MtfView>,
    /// Patterns of all views.
    pub patterns: Vec<PatternMean>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Sharpness in one view.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct MtfView {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// The drive states, in the order of the scenario.
    pub states: Named<MtfState>,
    /// Contrast of the middle of a line with its surround far away, (L_white - L_black)/(L_white + L_black); null without a matrix, white
    /// or black.
    pub line_contrast: LineContrast,
    /// The same without the images of the room in flat faces.
    pub line_contrast_via_pixel: LineContrast,
    /// Errors of `line_contrast`.
    pub line_contrast_error: LineContrast,
    /// Errors of `line_contrast_via_pixel`.
    pub line_contrast_via_pixel_error: LineContrast,
    /// Smallest contrast of the middles of strokes of black text with the white page, (L_white - L)/(L_white + L); null without a matrix,
    /// white or black, and if the font has no such letters.
    pub text_contrast_min: Option<f64>,
    /// Median of the contrasts of the middles of strokes.
    pub text_contrast_median: Option<f64>,
    /// The smallest without the images of the room in flat faces.
    pub text_contrast_min_via_pixel: Option<f64>,
    /// The median without them.
    pub text_contrast_median_via_pixel: Option<f64>,
    /// Errors of `text_contrast_min` and `text_contrast_median`.
    pub text_contrast_error: Option<[f64; 2]>,
    /// Errors of `text_contrast_min_via_pixel` and `text_contrast_median_via_pixel`.
    pub text_contrast_via_pixel_error: Option<[f64; 2]>,
    /// Exponent n of Yule and Nielsen that has the mean of fine patterns, half white and half black, via the pixel; 1 without
    /// recycled light. A report only: it is no model.
    pub yule_nielsen_n: Option<f64>,
    /// Patterns of `[pattern]` in this view.
    pub patterns: Vec<PatternMean>,
}

impl MtfView {
    /// Returns the metrics of the view, for sweeps and searches.
    pub fn metrics(&self) -> SharpnessMetrics {
        let text = [self.text_contrast_min, self.text_contrast_median];
        let metrics = Self::of(&self.line_contrast, text, self.yule_nielsen_n);
        SharpnessMetrics { pattern_mean_Y: self.patterns.first().map(|pattern| pattern.mean_Y), ..metrics }
    }

    /// Returns the errors of the metrics, where they are known.
    pub fn errors(&self) -> SharpnessMetrics {
        let text = [0, 1].map(|k| self.text_contrast_error.map(|errors| errors[k]));
        let metrics = Self::of(&self.line_contrast_error, text, None);
        SharpnessMetrics { pattern_mean_Y: self.patterns.first().map(|pattern| pattern.error), ..metrics }
    }

    /// The contrasts of lines are the first metrics, in the same order.
    fn of(lines: &LineContrast, text: [Option<f64>; 2], yule_nielsen_n: Option<f64>) -> SharpnessMetrics {
        let mut metrics = SharpnessMetrics::default();
        metrics.all_mut().zip(lines.named()).for_each(|(metric, (_, value))| *metric = value);
        let [text_contrast_min, text_contrast_median] = text;
        SharpnessMetrics { text_contrast_min, text_contrast_median, yule_nielsen_n, ..metrics }
    }
}

/// Sharpness of a state in one view, in all light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the letters of the field's own symbols")]
pub struct MtfState {
    /// Y via the pixel.
    pub Y_via_pixel: f64,
    /// Its error.
    pub Y_via_pixel_error: f64,
    /// The metrics.
    #[serde(flatten)]
    pub scalars: SpatialScalars,
    /// Errors of the metrics.
    pub error: SpatialScalars,
    /// Light by frequency, in all light.
    pub otf: Curves,
    /// Curves of each light: `diffuse`, `directed.0`, `environment.0`, ...
    pub by_light: Named<Curves>,
    /// Line and edge along x and y, by light, as `spread.csv`.
    #[serde(skip)]
    pub spread: Vec<SpreadTable>,
    /// Light by cell, as `kernel-STATE.npy`.
    pub kernel: Kernel,
}

/// Optical transfer along x and y.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Curves {
    /// Fraction of the light of the state via the pixel.
    pub fraction: f64,
    /// Real and imaginary part at each frequency along x.
    pub otf_x: Vec<[f64; 2]>,
    /// The same along y.
    pub otf_y: Vec<[f64; 2]>,
    /// Errors of the modulus along x.
    pub error_x: Vec<f64>,
    /// The same along y.
    pub error_y: Vec<f64>,
}

/// Line and edge spread along an axis.
#[derive(Debug, Clone, PartialEq)]
pub struct SpreadTable {
    /// Name of the light, or `all`.
    pub light: String,
    /// 0 for x, 1 for y.
    pub axis: usize,
    /// Places relative to that of the view's own ray, um.
    pub position_um: Vec<f64>,
    /// Line spread, the mean between the neighbouring places, per mm.
    pub line_spread_per_mm: Vec<f64>,
    /// Edge spread: fraction of the light from places below.
    pub edge_spread: Vec<f64>,
    /// Error of the edge spread.
    pub error: Vec<f64>,
}

/// Point spread as a picture.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Kernel {
    /// Side of a cell, um.
    pub cell_um: f64,
    /// Number of cells along x and y.
    pub cells: usize,
    /// Fraction of the light outside of the picture.
    pub outside: f64,
    /// Fraction of the light in each cell, rows from the bottom; written to `kernel-STATE.npy`.
    #[serde(skip)]
    pub fractions: Vec<f64>,
}

/// Replaces an error by a larger one; one that is not known stays.
fn widen(error: &mut f64, other: f64) {
    *error = error.max(other);
}

fn widen_all<'a>(errors: impl IntoIterator<Item = &'a mut f64>, others: &[f64]) {
    errors.into_iter().zip(others).for_each(|(error, other)| widen(error, *other));
}

impl MtfView {
    /// Takes the larger of the errors of two views of the same numbers.
    pub(super) fn widen_errors(&mut self, other: &Self) {
        for (errors, others) in [
            (&mut self.line_contrast_error, &other.line_contrast_error),
            (&mut self.line_contrast_via_pixel_error, &other.line_contrast_via_pixel_error),
        ] {
            for (error, (_, other)) in errors.all_mut().zip(others.named()) {
                *error = error.zip(other).map(|(error, other)| error.max(other)).or(*error);
            }
        }
        for (errors, others) in [
            (&mut self.text_contrast_error, &other.text_contrast_error),
            (&mut self.text_contrast_via_pixel_error, &other.text_contrast_via_pixel_error),
        ] {
            if let (Some(errors), Some(others)) = (errors, others) {
                widen_all(errors, others);
            }
        }
        self.patterns
            .iter_mut()
            .zip(&other.patterns)
            .for_each(|(one, other)| widen(&mut one.error, other.error));
        for ((_, one), (_, other)) in self.states.0.iter_mut().zip(&other.states.0) {
            one.widen_errors(other);
        }
    }
}

impl MtfState {
    fn widen_errors(&mut self, other: &Self) {
        widen(&mut self.Y_via_pixel_error, other.Y_via_pixel_error);
        for (error, (_, other)) in self.error.all_mut().zip(other.error.named()) {
            *error = error.zip(other).map(|(error, other)| error.max(other)).or(*error);
        }
        self.otf.widen_errors(&other.otf);
        self.by_light
            .0
            .iter_mut()
            .zip(&other.by_light.0)
            .for_each(|((_, one), (_, other))| one.widen_errors(other));
        self.spread
            .iter_mut()
            .zip(&other.spread)
            .for_each(|(one, other)| widen_all(&mut one.error, &other.error));
    }
}

impl Curves {
    fn widen_errors(&mut self, other: &Self) {
        widen_all(&mut self.error_x, &other.error_x);
        widen_all(&mut self.error_y, &other.error_y);
    }
}
