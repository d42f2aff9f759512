//! `[solver]`: the solver, its accuracy and its approximations.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{self, AngleMedium, Method, Sampler, Strategy};

use super::numbers::{Count, Paths, RelativeError, Seed, Tolerance};
use crate::error::Errors;
use crate::grammar::{choice, table};
use crate::read::{Read, Spanned, unknown_word};
use crate::tree::{Node, Value};
use crate::word::Word;

table! {
    /// The solver, its accuracy and its approximations.
    Solver {
        /// Solver; by default `auto` for a liquid crystal, or a table with azimuths, below a scatterer.
        method: Word<Method> = Word(Method::Adding),
        /// Stop at this relative error of Y, the largest over states and views. Default: `0.001`.
        relative_error: Option<RelativeError>,
        /// For Monte Carlo, instead of `relative_error`: paths of each view, rounded up to a multiple of 32.
        /// Default: none, `relative_error` is used.
        paths: Option<Paths>,
        /// For Monte Carlo: stop at this error of a metric.
        target: Option<Target>,
        /// `true`: `relative_error` also applies at every wavelength, relative to the maximum of the
        /// spectrum; without effect, with a warning, with `paths`.
        per_wavelength: bool = false,
        /// For Monte Carlo: source of the random numbers (docs/sampling.md).
        sampler: Word<Sampler> = Word(Sampler::Sobol),
        /// For Monte Carlo: sampling of directions at a diffuser (docs/sampling.md).
        scattering: Word<Strategy> = Word(Strategy::Kernel),
        /// Approximations of the transport, for ordinary panels.
        approximation: Approximation = Approximation::None,
        /// Medium of the angles of viewer, sources and pixel.csv.
        angle_medium: Word<AngleMedium> = Word(AngleMedium::Air),
        /// For Monte Carlo: seed of the random numbers.
        seed: Seed = Count(0),
    }
}

table! {
    /// A metric and its largest standard error, at every view.
    Target {
        /// Metric of result.json.
        metric: Metric,
        /// Name of the state, for a metric of a state. Default: all states that have the metric.
        state: Option<String>,
        /// Standard error in the unit of the metric; or `relative_error`.
        error: Option<Tolerance>,
        /// Standard error relative to the value; or `error`.
        relative_error: Option<RelativeError>,
    }
}

/// A metric by its name in result.json.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Metric(pub(crate) scene::Metric);

/// Targets are of colours: other metrics have no standard error of a run.
fn is_of_colours(metric: scene::Metric) -> bool {
    metric.source() == scene::MetricSource::Colours
}

/// Error: the metric is that of a command with its own accuracy.
fn not_of_colours(metric: scene::Metric) -> Diagnostic {
    let accuracy = match metric.source() {
        scene::MetricSource::Sparkle => "sparkle.replicates sets its accuracy",
        scene::MetricSource::Crosstalk => "its error is the difference of two levels of discretisation",
        scene::MetricSource::Image => "image.json has the error of the colours that are seen",
        scene::MetricSource::Mtf | scene::MetricSource::Gloss | scene::MetricSource::Colours => {
            "solver.relative_error or solver.paths sets its accuracy"
        }
    };
    let (name, command) = (metric.name(), metric.source().command().unwrap_or("run"));
    Diagnostic::new(format!("`{name}` cannot be a target: it is a metric of `papilio {command}`"))
        .expected("a metric of a run, such as \"contrast_ratio\" or \"Y\"")
        .hint(accuracy)
}

fn metric_names() -> Vec<&'static str> {
    scene::Metric::ALL.iter().filter(|metric| is_of_colours(**metric)).map(|metric| metric.name()).collect()
}

impl Read for Metric {
    fn in_words() -> String {
        "the name of a metric".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Text(word) = &node.value else { return node.wrong_type(Self::in_words(), errors) };
        match scene::Metric::named(word) {
            Some(metric) if is_of_colours(metric) => Some(Self(metric)),
            Some(metric) => {
                errors.push(node.origin, not_of_colours(metric));
                None
            }
            None => unknown_word(node, word, &metric_names(), &[], errors),
        }
    }
}

impl serde::Serialize for Metric {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.0.name())
    }
}

impl schemars::JsonSchema for Metric {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Metric".into()
    }
    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "enum": metric_names() })
    }
    fn inline_schema() -> bool {
        true
    }
}

impl Solver {
    /// Fills in the default accuracy if neither an accuracy nor a number of paths nor a target is given.
    pub(super) fn complete(&mut self) {
        if self.paths.is_none() && self.target.is_none() {
            self.relative_error.value.get_or_insert(RelativeError(0.001));
        }
    }
}

choice! {
    for Method {
        /// Deterministic, without noise.
        Adding = "adding",
        /// Unbiased paths, with standard errors.
        MonteCarlo = "monte-carlo",
        /// The one that meets the target with less work (docs/adding.md).
        Auto = "auto",
    }
}

choice! {
    for Sampler {
        /// Owen-scrambled Sobol points.
        Sobol = "sobol",
        /// Independent random numbers.
        Random = "random",
        /// Jittered points on pairs of coordinates.
        Stratified = "stratified",
        /// Points far from each other on pairs of coordinates.
        BestCandidate = "best-candidate",
    }
}

choice! {
    for Strategy {
        /// From the lobe itself, and towards sources from both ends of the path.
        Kernel = "kernel",
        /// Uniformly over the hemisphere.
        Uniform = "uniform",
        /// Proportionally to the cosine.
        Cosine = "cosine",
        /// From a Ward lobe, fitted to that of the diffuser.
        Ward = "ward",
        /// From the product of lobe, light and pixel.
        Guided = "guided",
    }
}

choice! {
    /// Approximations of the transport, for ordinary panels.
    Approximation {
        /// All orders of reflection, with refraction.
        None = "none",
        /// One pass through the panel, with the front of screen to first order (Feng 2012, eq. 3-2, 3-3 and
        /// 3-5).
        SinglePass = "single-pass",
        /// Glass without refraction: the pixel is evaluated at the angle in air; the lobe of a diffuser is
        /// also cut off at |beta| = 1 below it.
        Unrefracted = "unrefracted",
        /// The mean of s and p at each face or film, instead of s and p through all orders
        /// (docs/theory/faces.md).
        Unpolarised = "unpolarised",
    }
}

choice! {
    for AngleMedium {
        /// In air, and refracted by Snell's law.
        Air = "air",
        /// In glass; for a bare panel.
        Glass = "glass",
        /// As `approximation = "unrefracted"`.
        Unrefracted = "unrefracted",
    }
}
