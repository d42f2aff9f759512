//! `[solver]`: how to compute, and how well.

use papilio_display::scene;

use super::numbers::{Count, Paths, RelativeError, Seed, Tolerance};
use crate::error::Errors;
use crate::grammar::{choice, table};
use crate::read::{At, Read, unknown_word};
use crate::tree::{Node, Value};

table! {
    /// How to compute, and how well.
    Solver {
        /// The solver.
        method: Method = Method::Adding,
        /// Stop at this relative error of Y, the largest over states and views: the standard error of the walk, the
        /// discretisation error of adding. Default: `0.001`.
        relative_error: Option<RelativeError>,
        /// For the walk only: stop after this many paths for each view instead; rounded up to a multiple of 32. Default:
        /// none, `relative_error` is used.
        paths: Option<Paths>,
        /// For the walk only: stop when a metric is known to within a tolerance.
        target: Option<Target>,
        /// Apply `relative_error` at every wavelength too, relative to the maximum of the spectrum; without effect beside
        /// `paths`.
        per_wavelength: bool = false,
        /// Where the numbers of the walk come from (docs/sampling.md); adding needs none.
        sampler: Sampler = Sampler::Sobol,
        /// How the walk samples directions at a diffuser (docs/sampling.md).
        scattering: Scattering = Scattering::Kernel,
        /// Which orders of reflection are computed.
        approximation: Approximation = Approximation::None,
        /// The medium of the angles of viewer, lights and pixel.csv.
        angle_medium: AngleMedium = AngleMedium::Air,
        /// Seed of the walk's random numbers.
        seed: Seed = Count(0),
    }
}

table! {
    /// A metric, and how well it is to be known: one standard error at every view.
    Target {
        /// Name of the metric in result.json.
        metric: Metric,
        /// The state; metrics of all states together have none. Default: all states that have the metric.
        state: Option<String>,
        /// Standard error in the metric's own unit. Either `error` or `relative_error`.
        error: Option<Tolerance>,
        /// Standard error as a fraction of the value. Either `error` or `relative_error`.
        relative_error: Option<RelativeError>,
    }
}

/// A metric that may be a target, by its name in result.json.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Metric(pub(crate) scene::Metric);

fn metric_names() -> Vec<&'static str> {
    scene::Metric::ALL.iter().map(|metric| metric.name()).collect()
}

impl Read for Metric {
    fn in_words() -> String {
        "the name of a metric".to_owned()
    }

    fn read(node: &Node, errors: &mut Errors) -> Option<Self> {
        let Value::Text(word) = &node.value else { return node.wrong_type(Self::in_words(), errors) };
        match scene::Metric::named(word) {
            Some(metric) => Some(Self(metric)),
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
    /// The default accuracy, where neither it nor a number of paths nor a target is given.
    pub(super) fn complete(&mut self) {
        if self.paths.is_none() && self.target.is_none() {
            self.relative_error.value.get_or_insert(RelativeError(0.001));
        }
    }
}

choice! {
    /// The solvers.
    Method {
        /// Deterministic: the layers as operators on direction cosines.
        Adding = "adding",
        /// Unbiased Monte Carlo path tracing.
        MonteCarlo = "monte-carlo",
    }
}

choice! {
    /// Where the walk's numbers come from.
    Sampler {
        /// Owen-scrambled Sobol points.
        Sobol = "sobol",
        /// Independent random numbers.
        Random = "random",
        /// Jittered points on pairs of coordinates.
        Stratified = "stratified",
        /// Points that are far from each other on pairs of coordinates, in sets of at most 4096.
        BestCandidate = "best-candidate",
    }
}

choice! {
    /// How directions are drawn.
    Scattering {
        /// From the lobe itself, towards lamps from both ends of the path.
        Kernel = "kernel",
        /// Uniformly over the hemisphere.
        Uniform = "uniform",
        /// Proportionally to the cosine.
        Cosine = "cosine",
        /// From Ward's lobe, fitted to the diffuser's.
        Ward = "ward",
        /// From the product of lobe, light and pixel.
        Guided = "guided",
    }
}

choice! {
    /// How completely light is followed.
    Approximation {
        /// All orders.
        None = "none",
        /// One pass through the panel, with the front of screen to first order (Feng 2012, eq. 3-2, 3-3 and 3-5).
        SinglePass = "single-pass",
    }
}

choice! {
    /// The medium of a scenario's angles.
    AngleMedium {
        /// In air; light is refracted by Snell's law.
        Air = "air",
        /// In glass, for a bare panel.
        Glass = "glass",
        /// In air, the pixel looked up at the air angle as if it were the angle in glass; a diffuser's
        /// lobe, too, is cut at |beta| = 1 below.
        Unrefracted = "unrefracted",
    }
}
