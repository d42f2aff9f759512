//! Results of a run, with their errors. Serialised as `result.json`.
//!
//! Arrays run over `wavelength_nm`. SI units and nm; X, Y, Z are relative
//! (Y = 1 for a perfect white in the same light). `None` marks a value that is
//! not defined (a metric whose states are missing, a peak at an edge).

use schemars::JsonSchema;
use serde::Serialize;

pub use crate::metrics::{Cam16, StateMetrics, ViewMetrics};

/// Result of a run; it does not contain the scenario.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RunResult {
    /// Solver, and the accuracy that was reached.
    pub solver: SolverReport,
    /// Wavelengths of all spectra, nm.
    pub wavelength_nm: Vec<f64>,
    /// Reference white.
    pub illuminant: Illuminant,
    /// White of L*, a*, b*, u*, v*, the colour differences and the gamut volume.
    pub reference_white: ReferenceWhite,
    /// States that drive one sub-pixel, in the order of the states: those whose peak wavelength is printed and drawn.
    pub primaries: Vec<String>,
    /// One entry for each view, with theta varying fastest.
    pub views: Vec<View>,
    /// Reader of black text, for `visibility_level` and `contrast_margin`.
    pub reader: Reader,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// Explanations of numbers that may surprise; written with the notes on the scenario.
    #[serde(skip)]
    pub notes: Vec<String>,
}

/// Reader of black text, and the size of the text; keys that the scenario leaves out have their defaults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Reader {
    /// Age, years.
    pub age_years: f64,
    /// Height of the lower-case x, mm.
    pub text_height_mm: f64,
    /// Distance of the eye, mm.
    pub distance_mm: f64,
    /// Size of a detail, a fifth of the height, minutes of arc.
    pub detail_arcmin: f64,
    /// Spatial frequency of the strokes, 2.5 cycles per height, cycles per degree.
    pub cycles_per_degree: f64,
    /// Whether the scenario specifies the reader's age or the size of the text.
    pub is_described: bool,
}

/// Solver of a run, and the accuracy that was reached.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SolverReport {
    /// `adding` or `monte-carlo`.
    pub method: String,
    /// Why `method = "auto"` has chosen this solver.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chosen_because: Option<String>,
    /// Number of paths over all views (Monte Carlo).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paths: Option<u64>,
    /// Number of nodes (directions) over all views at the reported level (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<u64>,
    /// Finest level of discretisation over all views (adding), for further runs at the same one.
    #[serde(skip)]
    pub level: Option<u32>,
    /// Degrees of freedom of the standard errors: the number of independent replicates minus one; 0 without noise.
    pub degrees_of_freedom: u64,
    /// Largest relative error of Y over states and views (and wavelengths, with `per_wavelength`):
    /// the standard error of the Monte Carlo solver, or the discretisation error of adding.
    pub relative_error_reached: f64,
    /// Report on the target of one metric, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// False for the first answer of a prepared display: its error is as stated, but may exceed the target.
    pub is_final: bool,
    /// True if the run was stopped before it met its target.
    pub interrupted: bool,
}

/// Report on the target of one metric.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TargetReport {
    /// Largest ratio of standard error to tolerance over all views; null if the metric is not defined for this display.
    pub error_over_tolerance: Option<f64>,
    /// Estimated number of paths over all views for a tenth of the error: from the decrease of the error in this run,
    /// and in the worst case, in which the error is inversely proportional to the square root of the number.
    pub paths_for_a_tenth: [f64; 2],
}

/// White to which CIELAB, CIELUV and the colour differences are relative.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ReferenceWhite {
    /// A perfect white diffuser in the same light.
    Perfect,
    /// The state `white` of the same view and light.
    Display,
}

/// Perfect white under the scene's ambient light, or under the front light if that is the only light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Illuminant {
    /// Spectral radiance of the perfect white, W/(m2 sr nm).
    pub radiance_of_white: Vec<f64>,
    /// CIE 1931 x.
    pub x: f64,
    /// CIE 1931 y.
    pub y: f64,
    /// CIE 1976 u'.
    pub u_prime: f64,
    /// CIE 1976 v'.
    pub v_prime: f64,
}

/// Result of one view.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct View {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// The drive states, in the order of the scenario.
    pub states: Named<State>,
    /// Metrics that combine the states.
    #[serde(flatten)]
    pub metrics: ViewMetrics,
    /// Whether text and reader are within the range of the model of `visibility_level` (0.1 to 1e4 cd/m2, details of 0.3 to
    /// 60 minutes of arc, 23 to 75 years); null without white and black.
    pub visibility_level_in_range: Option<bool>,
    /// Whether text and reader are within the range of the model of `contrast_margin` (0.1 to 1e4 cd/m2, 23 to 75 years);
    /// null without white and black.
    pub contrast_margin_in_range: Option<bool>,
    /// Standard error of each metric (0 without noise).
    pub standard_error: ViewMetrics,
    /// Discretisation error of each metric (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<ViewMetrics>,
    /// Energy balance of a unit beam from the view direction.
    pub ledger: Named<Ledger>,
}

/// Result of a drive state in one view.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct State {
    /// Values.
    #[serde(flatten)]
    pub value: StateValues,
    /// Standard error of each value, from independent replicates (0 without noise).
    pub standard_error: StateValues,
    /// Discretisation error of each value, from the difference to the next coarser level (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<StateValues>,
    /// Estimated errors of X, Y and Z because lights and reflectances are known only at the wavelengths of the grid; only if
    /// its step is above 1 nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation_error: Option<XyzError>,
}

/// Errors of X, Y and Z.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as result.json spells them")]
pub struct XyzError {
    /// Of X.
    pub X: f64,
    /// Of Y.
    pub Y: f64,
    /// Of Z.
    pub Z: f64,
}

/// Values of a drive state, or their errors.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as result.json spells them")]
pub struct StateValues {
    /// Spectral radiance, W/(m2 sr nm).
    pub radiance: Vec<f64>,
    /// Radiance over that of the perfect white; at wavelengths without light, the mean of the reflectance factors under each
    /// source, weighted by illuminance. Null if the front light is the only light: there is no ambient light to reflect.
    pub reflectance_factor: Option<Vec<f64>>,
    /// Relative tristimulus value.
    pub X: f64,
    /// Relative tristimulus value: the luminance factor.
    pub Y: f64,
    /// Relative tristimulus value.
    pub Z: f64,
    /// CIE 1931 chromaticity.
    pub x: Option<f64>,
    /// CIE 1931 chromaticity.
    pub y: Option<f64>,
    /// CIE 1931 chromaticity, 1 - x - y.
    pub z: Option<f64>,
    /// CIE 1976 u'.
    pub u_prime: Option<f64>,
    /// CIE 1976 v'.
    pub v_prime: Option<f64>,
    /// CIELAB lightness L* relative to the illuminant's white (null in light without X, Y or Z), or relative to the display's
    /// white state in the same view if the front light is the only light. The same white applies to all colours and differences.
    pub L_star: Option<f64>,
    /// CIELAB a*.
    pub a_star: Option<f64>,
    /// CIELAB b*.
    pub b_star: Option<f64>,
    /// Luminance, cd/m2.
    pub luminance_cd_m2: f64,
    /// Y over that of black.
    pub contrast: Option<f64>,
    /// Wavelength of the largest reflectance factor between 400 and 700 nm, nm (null at an edge, and
    /// if the spectrum is flat within its errors).
    pub peak_nm: Option<f64>,
    /// u'v' distance from the white of the scene's light.
    pub distance_from_white_uv: Option<f64>,
    /// u'v' distance from D65 (Feng 2012's dR).
    pub distance_from_d65_uv: Option<f64>,
    /// 255 times linear sRGB of (x, y, z), clipped, without gamma: hue without lightness (the
    /// RGB rows of Feng 2012, table 5.1).
    pub hue_rgb: Option<[f64; 3]>,
    /// Comparisons with other colours.
    #[serde(flatten)]
    pub metrics: StateMetrics,
    /// Colour appearance, if `metrics.appearance` is specified.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam16: Option<Cam16>,
    /// Luminance factor under the diffuse light alone, including front reflection (Feng 2012,
    /// eq. 3-1); null without diffuse light.
    pub R_hemi: Option<f64>,
    /// Luminance factor under each directed source alone.
    pub R_dir: Vec<Option<f64>>,
    /// Luminance factor under each environment alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub R_environment: Vec<Option<f64>>,
    /// Reflectance factors under each light alone, if `metrics.spectra_by_light` is set.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_light: Option<SpectraByLight>,
    /// Contributions to Y by light; they sum to Y.
    pub terms: Terms,
    /// Image luminance ratio of each directed source: luminance of its mirror image over that of the source, whether or not it
    /// is in the field of view.
    pub specular: Vec<f64>,
}

/// Reflectance factors under each light alone, including front reflection (Feng 2012, eq. 3-1); null without
/// this light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the letters of the equation")]
pub struct SpectraByLight {
    /// Under the diffuse light.
    pub R_hemi: Option<Vec<f64>>,
    /// Under each directed source.
    pub R_dir: Vec<Option<Vec<f64>>>,
    /// Under each environment.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub R_environment: Vec<Option<Vec<f64>>>,
}

/// Contributions to Y by light (Feng 2012, eq. 3-1).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Terms {
    /// Diffuse light, reflected by the pixel.
    pub diffuse: f64,
    /// Each directed source, reflected by the pixel.
    pub directed: Vec<f64>,
    /// Each environment, reflected by the pixel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub environment: Vec<f64>,
    /// Front light, including its upward leak.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_light: Option<f64>,
    /// Front reflection: light of all ambient sources that is reflected before it meets the pixel.
    pub front_reflection: f64,
}

/// Energy balance: luminous fractions of a unit beam of the light's spectrum that enters from the view direction; they sum to 1.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Ledger {
    /// Returned to the air.
    pub returned: f64,
    /// Absorbed by each part of the display.
    pub absorbed: Absorbed,
    /// Not attributed by the solver.
    pub unaccounted: f64,
    /// Standard errors of the fractions (0 without noise).
    pub standard_error: LedgerError,
    /// Discretisation errors of the fractions (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<LedgerError>,
}

impl Ledger {
    /// Returns the fractions without their errors.
    pub fn values(&self) -> LedgerError {
        LedgerError {
            returned: self.returned,
            absorbed: self.absorbed.clone(),
            unaccounted: self.unaccounted,
        }
    }
}

/// Errors of an energy balance.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LedgerError {
    /// Error of `returned`.
    pub returned: f64,
    /// Error of `absorbed`.
    pub absorbed: Absorbed,
    /// Error of `unaccounted`.
    pub unaccounted: f64,
}

impl LedgerError {
    /// Returns the name and the value of each fraction.
    pub fn named(&self) -> [(&'static str, f64); 7] {
        [
            ("returned", self.returned),
            ("front", self.absorbed.front),
            ("diffuser", self.absorbed.diffuser),
            ("glass", self.absorbed.glass),
            ("pixel", self.absorbed.pixel),
            ("inactive", self.absorbed.inactive),
            ("unaccounted", self.unaccounted),
        ]
    }
}

/// Fractions that are absorbed by each part of the display.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Absorbed {
    /// Front of screen.
    pub front: f64,
    /// Diffuser, including the part of its lobe outside the medium's disc.
    pub diffuser: f64,
    /// Glass.
    pub glass: f64,
    /// Active pixel area.
    pub pixel: f64,
    /// Inactive area of the panel.
    pub inactive: f64,
}

/// Named items in a fixed order; serialises as a JSON object in that order.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<T>(pub Vec<(String, T)>);

impl<T> Named<T> {
    /// Returns the item with this name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(n, _)| n == name).map(|(_, item)| item)
    }

    /// Iterates over names and items, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &T)> {
        self.0.iter().map(|(name, item)| (name.as_str(), item))
    }
}

impl<T: Serialize> Serialize for Named<T> {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.0.iter().map(|(name, item)| (name, item)))
    }
}

impl<T: JsonSchema> JsonSchema for Named<T> {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        format!("Named_{}", T::schema_name()).into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        <std::collections::BTreeMap<String, T>>::json_schema(generator)
    }
}
