//! Result of [`crosstalk`](super::crosstalk()), serialised as `crosstalk.json`.

use schemars::JsonSchema;
use serde::Serialize;

use crate::metrics::CrosstalkMetrics;
use crate::result::Named;

/// Who lights whom; it does not contain the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CrosstalkResult {
    /// Names of the sub-pixels, in the order of all shares.
    pub subpixels: Vec<String>,
    /// Period of a pixel along x and y, um.
    pub pitch_um: [f64; 2],
    /// State of the uniform page of `out` and of the ground of patterns.
    pub page: String,
    /// Largest error of a share: the difference of two levels of discretisation, or a standard error (Monte Carlo).
    pub error_reached: f64,
    /// One entry for each view, with theta varying fastest.
    pub views: Vec<CrosstalkView>,
    /// Warnings for the user.
    pub warnings: Vec<String>,
}

/// Crosstalk in one view.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CrosstalkView {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// Shares in all light.
    #[serde(flatten)]
    pub shares: Shares,
    /// The shares in each light: `diffuse`, `directed.0`, `environment.0`, ...
    pub by_light: Named<Shares>,
    /// Colours of uniform pages, stripes, a line and text.
    pub patterns: Vec<PatternColours>,
}

impl CrosstalkView {
    /// Returns the metrics of the view, for sweeps and searches.
    pub fn metrics(&self) -> CrosstalkMetrics {
        let others = |own: Option<f64>| own.map(|own| 1.0 - own);
        let [out, entered] = [self.shares.own_share_out, self.shares.own_share_in];
        self.numbers([out, others(out), entered, others(entered)], |pattern| pattern.values)
    }

    /// Returns the errors of the metrics.
    pub fn errors(&self) -> CrosstalkMetrics {
        let [out, entered] = self.shares.own_share_errors;
        self.numbers([out, out, entered, entered], |pattern| pattern.error)
    }

    fn numbers(
        &self,
        shares: [Option<f64>; 4],
        of: impl Fn(&PatternColours) -> PatternValues,
    ) -> CrosstalkMetrics {
        let [patch, stripe, line, text] = Figure::ALL.map(|figure| {
            self.patterns.iter().find(|pattern| pattern.name == figure).map(&of).unwrap_or_default()
        });
        CrosstalkMetrics {
            own_share_out: shares[0],
            neighbours_share_out: shares[1],
            own_share_in: shares[2],
            neighbours_share_in: shares[3],
            patch_gamut_percent_srgb: patch.gamut_percent_srgb,
            patch_contrast_ratio: patch.contrast_ratio,
            patch_contrast_ratio_via_pixel: patch.contrast_ratio_via_pixel,
            stripe_1_gamut_percent_srgb: stripe.gamut_percent_srgb,
            stripe_1_contrast_ratio: stripe.contrast_ratio,
            stripe_1_contrast_ratio_via_pixel: stripe.contrast_ratio_via_pixel,
            line_1_gamut_percent_srgb: line.gamut_percent_srgb,
            line_1_contrast_ratio: line.contrast_ratio,
            line_1_contrast_ratio_via_pixel: line.contrast_ratio_via_pixel,
            text_gamut_percent_srgb: text.gamut_percent_srgb,
            text_contrast_ratio: text.contrast_ratio,
            text_contrast_ratio_via_pixel: text.contrast_ratio_via_pixel,
        }
    }
}

impl CrosstalkView {
    /// Takes the errors of the same numbers by another estimate where they are larger.
    pub(super) fn widen_errors(&mut self, other: &Self) {
        self.shares.widen_errors(&other.shares);
        for ((_, own), (_, other)) in self.by_light.0.iter_mut().zip(&other.by_light.0) {
            own.widen_errors(other);
        }
        for (own, other) in self.patterns.iter_mut().zip(&other.patterns) {
            own.error = PatternValues {
                gamut_percent_srgb: larger(own.error.gamut_percent_srgb, other.error.gamut_percent_srgb),
                contrast_ratio: larger(own.error.contrast_ratio, other.error.contrast_ratio),
                contrast_ratio_via_pixel: larger(
                    own.error.contrast_ratio_via_pixel,
                    other.error.contrast_ratio_via_pixel,
                ),
            };
        }
    }
}

impl Shares {
    fn widen_errors(&mut self, other: &Self) {
        self.error = self.error.max(other.error);
        let pairs = self.own_share_errors.iter_mut().zip(other.own_share_errors);
        pairs.for_each(|(own, other)| *own = larger(*own, other));
    }
}

fn larger(own: Option<f64>, other: Option<f64>) -> Option<f64> {
    own.zip(other).map(|(own, other)| own.max(other))
}

/// Who lights whom in one light or all. Shares are of luminous light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Shares {
    /// `out[i][j]`: of the light that is seen through window i of a uniform page, the fraction that left sub-pixel j. Rows sum to 1,
    /// or are 0 where no light is seen.
    pub out: Vec<Vec<f64>>,
    /// Of the light that is seen through each window, the fraction that left the inactive area; it is not in `out`.
    pub inactive_out: Vec<f64>,
    /// Mean of the diagonal of `out`, each window with its light.
    pub own_share_out: Option<f64>,
    /// `in[j][i]`: of the light that reaches sub-pixel j for the first time, the fraction that entered through window i of the filter. Rows sum to
    /// 1. Null without a filter.
    #[serde(rename = "in")]
    pub in_: Option<Vec<Vec<f64>>>,
    /// Of the light that reaches each sub-pixel, the fraction that entered between the windows; it is not in `in`.
    pub between_in: Option<Vec<f64>>,
    /// Mean of the diagonal of `in`, each sub-pixel with its light; null without a filter.
    pub own_share_in: Option<f64>,
    /// Largest error of these shares.
    pub error: f64,
    /// Errors of `own_share_out` and `own_share_in`.
    #[serde(skip)]
    pub own_share_errors: [Option<f64>; 2],
}

/// Colours and contrast of a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct PatternColours {
    /// The pattern.
    pub name: Figure,
    /// Its numbers.
    #[serde(flatten)]
    pub values: PatternValues,
    /// Errors of the numbers.
    pub error: PatternValues,
    /// Why all numbers are null; absent if they are not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why_null: Option<&'static str>,
}

/// Numbers of a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
pub struct PatternValues {
    /// Area of the triangle of its colours in red, green and blue in the u'v' diagram, % of that of sRGB; null without these states.
    pub gamut_percent_srgb: Option<f64>,
    /// Y of the page over that of the black figure; null without the states white and black.
    pub contrast_ratio: Option<f64>,
    /// The same without the images of the room in flat faces.
    pub contrast_ratio_via_pixel: Option<f64>,
}

/// A figure in one state on a page of another.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Figure {
    /// A uniform page.
    Patch,
    /// Every second column of pixels; they repeat along x.
    #[serde(rename = "stripe_1")]
    Stripe,
    /// One column of pixels.
    #[serde(rename = "line_1")]
    Line,
    /// The middles of the strokes of text.
    Text,
}

impl Figure {
    /// All figures, in the order of results.
    pub const ALL: [Self; 4] = [Self::Patch, Self::Stripe, Self::Line, Self::Text];

    /// Returns the name in results.
    pub fn name(self) -> &'static str {
        match self {
            Self::Patch => "patch",
            Self::Stripe => "stripe_1",
            Self::Line => "line_1",
            Self::Text => "text",
        }
    }
}
