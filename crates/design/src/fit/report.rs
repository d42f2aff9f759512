//! Result of a fit.

use schemars::JsonSchema;
use serde::Serialize;

/// Result of a fit: `fit.json`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FitReport {
    /// Title of the scenario.
    pub title: Option<String>,
    /// SHA-256 of the fit, of its scenario, of the scenario's files, and of the measured numbers.
    pub hash: String,
    /// Variables, in the order of the scenario.
    pub variables: Vec<FittedVariable>,
    /// Correlations of the variables, row by row; null for those whose effects on the data are none or proportional.
    pub correlations: Vec<Vec<Option<f64>>>,
    /// Groups of variables that the data cannot tell apart; of a group of one, all values fit.
    pub undetermined: Vec<Vec<String>>,
    /// Sum of the squares of residuals over standard deviations, those of priors included.
    pub chi_square: f64,
    /// Number of residuals minus that of the variables.
    pub degrees_of_freedom: i64,
    /// Number of measured numbers.
    pub observations: usize,
    /// Root mean square of predicted minus measured reflectance factors, X, Y and Z; of L\*, a\*, b\* if there are
    /// only these; null if there are only metrics.
    pub residual_rms: Option<f64>,
    /// Standard deviations that the measurement does not state, from the residuals.
    pub estimated_deviation: Estimated,
    /// Runs of residuals of one sign.
    pub runs: Option<Runs>,
    /// Bayesian information criterion: -2 ln L + variables * ln(observations), without constants of the data.
    pub bic: f64,
    /// Starting points.
    pub starts: Starts,
    /// Warnings of the scenario, of its own display, and of weights that are not known.
    pub warnings: Vec<String>,
    /// Notes on what was not used, and on the result.
    pub notes: Vec<String>,
    /// Measured and predicted numbers: `fit.csv`.
    #[serde(skip)]
    pub residuals: Vec<Residual>,
}

/// Fitted variable.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FittedVariable {
    /// Its first path.
    pub key: String,
    /// All paths that get the value.
    pub keys: Vec<String>,
    /// Path that changes by the opposite amount.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub compensated_by: Option<String>,
    /// Fitted value; null if the data do not determine it.
    pub value: Option<f64>,
    /// Value of the best fit, even if others fit as well: the scenario's own where that fits as well.
    pub best: f64,
    /// Standard error, from the curvature of chi-square; null if the data do not determine the variable.
    pub standard_error: Option<f64>,
    /// Interval of 68.3 % confidence, by profile likelihood.
    pub interval_68: Option<[f64; 2]>,
    /// Interval of 95 % confidence, by profile likelihood.
    pub interval_95: Option<[f64; 2]>,
    /// Whether the value is at one of its bounds.
    pub at_bound: bool,
    /// First paths of the variables, this one among them, at whose bounds the intervals end; the data alone give wider ones.
    pub cut_by: Vec<String>,
    /// Bounds.
    pub bounds: [f64; 2],
    /// Value of the scenario; null if it is not a number.
    pub start: Option<f64>,
    /// Mean and standard deviation of the prior.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prior: Option<[f64; 2]>,
}

/// Standard deviations from the residuals; null where all are stated.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, JsonSchema)]
pub struct Estimated {
    /// Of reflectance factors, X, Y and Z.
    pub reflectance_factor: Option<f64>,
    /// Of L\*, a\*, b\*.
    pub lab: Option<f64>,
}

/// Runs of residuals of one sign: fewer than expected where the model differs systematically.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Runs {
    /// Number of runs.
    pub count: usize,
    /// Number that independent errors have on average.
    pub expected: f64,
    /// Difference over its standard deviation.
    pub z: f64,
}

/// Starting points of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Starts {
    /// Number of starting points.
    pub count: usize,
    /// How many of them led to a minimum.
    pub converged: usize,
    /// How many of them led to the best one.
    pub best: usize,
}

/// A measured number with its prediction.
#[derive(Debug, Clone, PartialEq)]
pub struct Residual {
    /// State, or name of the metric.
    pub name: String,
    /// Direction of the view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the view, degrees.
    pub phi_deg: f64,
    /// What was measured.
    pub quantity: &'static str,
    /// Wavelength, nm.
    pub wavelength_nm: Option<f64>,
    /// Measured value.
    pub measured: f64,
    /// Its standard deviation, stated or estimated.
    pub standard_deviation: f64,
    /// Predicted value.
    pub predicted: f64,
    /// Number of the spectrum, the colour or the metric to which it belongs, from 0.
    pub series: usize,
}
