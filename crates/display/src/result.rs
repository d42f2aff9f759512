//! The answer: what a meter would report, with its errors. Serialises to `result.json`.
//!
//! Arrays run over `wavelength_nm`. SI units and nm; X, Y, Z are relative
//! (Y = 1 for a perfect white in the same light). A `None` is a number that is
//! not defined here (a metric whose states are missing, a peak at an edge).

use schemars::JsonSchema;
use serde::Serialize;

pub use crate::metrics::{Cam16, StateMetrics, ViewMetrics};

/// Everything that a run reports, but for the scenario itself.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RunResult {
    /// How it was computed, and how well.
    pub solver: SolverReport,
    /// The wavelengths of every array, nm.
    pub wavelength_nm: Vec<f64>,
    /// The reference white.
    pub illuminant: Illuminant,
    /// One entry for each view, theta fastest.
    pub views: Vec<View>,
    /// Remarks that the reader should see.
    pub warnings: Vec<String>,
}

/// How the numbers were computed.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct SolverReport {
    /// `adding` or `walk`.
    pub method: String,
    /// Paths traced, over all views (walk).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paths: Option<u64>,
    /// Directions at which light was followed, over all views, at the level that is reported (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<u64>,
    /// Independent replicates less one: the degrees of freedom of every standard error; 0 without noise.
    pub degrees_of_freedom: u64,
    /// The largest relative error of Y over states and views (and wavelengths, with `every_bin`):
    /// the standard error of the walk, the discretisation error of adding.
    pub relative_error_reached: f64,
    /// How the target of one metric was met, if there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<TargetReport>,
    /// True if the run was stopped before it reached its target.
    pub interrupted: bool,
}

/// How a target of one metric was met.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct TargetReport {
    /// The largest standard error over its tolerance, of all views; null if the display has no such metric.
    pub error_over_tolerance: Option<f64>,
    /// Paths that a tenth of the error would take, all views together: as the error fell in this run,
    /// and at the worst, as one over the root of the paths.
    pub paths_for_a_tenth: [f64; 2],
}

/// A perfect white under the scene's ambient light; under the front light where that is all the light.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Illuminant {
    /// Its spectral radiance, W/(m2 sr nm).
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

/// What is seen from one direction.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct View {
    /// Inclination, degrees.
    pub theta_deg: f64,
    /// Azimuth, degrees.
    pub phi_deg: f64,
    /// The drive states, in the order of the scenario.
    pub states: Named<State>,
    /// Metrics of the states together.
    #[serde(flatten)]
    pub metrics: ViewMetrics,
    /// One sigma of each metric (0 where there is no noise).
    pub standard_error: ViewMetrics,
    /// Discretisation errors of the same (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<ViewMetrics>,
    /// Where a unit beam that enters from the view direction ends.
    pub ledger: Named<Ledger>,
}

/// A drive state as seen from one direction.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct State {
    /// The values.
    #[serde(flatten)]
    pub value: StateValues,
    /// One sigma of each of them, from independent replicates (0 where there is no noise).
    pub standard_error: StateValues,
    /// How far each of them is from that of the next coarser discretisation (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<StateValues>,
}

/// The numbers of a state, or their errors.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as result.json spells them")]
pub struct StateValues {
    /// Spectral radiance, W/(m2 sr nm).
    pub radiance: Vec<f64>,
    /// Radiance over that of the perfect white; where the light is dark, by the sources' shares of illuminance. Null where the
    /// front light is all the light: no light falls on the display that it could reflect.
    pub reflectance_factor: Option<Vec<f64>>,
    /// Relative tristimulus value.
    pub X: f64,
    /// Relative tristimulus value: the luminous reflectance factor.
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
    /// CIELAB lightness, against the illuminant's white (null in a light without X, Y or Z); against the screen's own white
    /// state, seen from the same direction, where the front light is all the light. So are all colours and differences that need a white.
    pub L_star: Option<f64>,
    /// CIELAB a*.
    pub a_star: Option<f64>,
    /// CIELAB b*.
    pub b_star: Option<f64>,
    /// Luminance, cd/m2.
    pub luminance_cd_m2: f64,
    /// Y over that of black.
    pub contrast: Option<f64>,
    /// Wavelength of the largest reflectance factor between 400 and 700 nm (null at an edge, and
    /// where the spectrum is flat within its errors).
    pub peak_nm: Option<f64>,
    /// u'v' distance from the white of the scene's light.
    pub distance_from_white_uv: Option<f64>,
    /// u'v' distance from D65 (Feng 2012's dR).
    pub distance_from_d65_uv: Option<f64>,
    /// 255 times linear sRGB of (x, y, z), clipped, without gamma: hue without lightness (the
    /// RGB rows of Feng 2012, table 5.1).
    pub hue_rgb: Option<[f64; 3]>,
    /// What the colour is to other colours.
    #[serde(flatten)]
    pub metrics: StateMetrics,
    /// What it looks like, where `metrics.appearance` asks for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cam16: Option<Cam16>,
    /// Luminous reflectance factor under the diffuse light alone, front reflection included (Feng 2012,
    /// eq. 3-1); null where there is none.
    pub R_hemi: Option<f64>,
    /// The same under each directed source alone.
    pub R_dir: Vec<Option<f64>>,
    /// The same in each environment alone.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub R_environment: Vec<Option<f64>>,
    /// Reflectance factors under each light alone, where `metrics.spectra_by_light` asks for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub by_light: Option<SpectraByLight>,
    /// The parts of Y by light; they sum to Y.
    pub terms: Terms,
    /// Luminance of each directed source's mirror image over that of the source, wherever it is seen.
    pub specular: Vec<f64>,
}

/// Reflectance factors under each light alone, front reflection included (Feng 2012, eq. 3-1); null where
/// there is none of it.
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

/// The parts of Y by light (Feng 2012, eq. 3-1).
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Terms {
    /// From the diffuse light, by way of the pixel.
    pub diffuse: f64,
    /// From each directed source, by way of the pixel.
    pub directed: Vec<f64>,
    /// From each environment, by way of the pixel.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub environment: Vec<f64>,
    /// From the front light, all that is seen of it, what leaks upwards included.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub front_light: Option<f64>,
    /// From any light, mirrored before it met the pixel.
    pub front_reflection: f64,
}

/// Luminous shares of a unit beam of the light's spectrum that enters from the view direction; they sum to 1.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Ledger {
    /// Back out into the room.
    pub returned: f64,
    /// Absorbed, by layer.
    pub absorbed: Absorbed,
    /// What was not followed to its end.
    pub unaccounted: f64,
    /// One sigma of the above (0 where there is no noise).
    pub standard_error: LedgerError,
    /// Discretisation errors of the above (adding).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discretisation_error: Option<LedgerError>,
}

/// Errors of a ledger's shares.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct LedgerError {
    /// Of `returned`.
    pub returned: f64,
    /// Of `absorbed`.
    pub absorbed: Absorbed,
    /// Of `unaccounted`.
    pub unaccounted: f64,
}

/// Shares absorbed by layer.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Absorbed {
    /// Front of screen.
    pub front: f64,
    /// Diffuser, what its lobe sends beyond the medium's disc included.
    pub diffuser: f64,
    /// Glass.
    pub glass: f64,
    /// The active pixel.
    pub pixel: f64,
    /// The inactive share of the panel.
    pub inactive: f64,
}

/// Named items in a fixed order; serialises as a JSON object in that order.
#[derive(Debug, Clone, PartialEq)]
pub struct Named<T>(pub Vec<(String, T)>);

impl<T> Named<T> {
    /// The item of that name.
    pub fn get(&self, name: &str) -> Option<&T> {
        self.0.iter().find(|(n, _)| n == name).map(|(_, item)| item)
    }

    /// Names and items, in order.
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
