//! Tolerance analyses: a scenario with the distributions of its `[tolerance]`.

use papilio_diagnostics::{Diagnostic, suggestion};
use papilio_display::scene::{Metric, MetricSource, Scene};
use papilio_sampling::{Coefficient, Correlation, Distribution};
use serde_json::{Value, json};

use crate::describe::limits::{Limit, MetricName};
use crate::describe::tolerance::{Correlated, Deviation, Scattered, Tolerance as Described};
use crate::error::{Errors, ScenarioError, ScenarioErrors};
use crate::library::sha256;
use crate::mistake;
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::read::{Read, Spanned};
use crate::scattered::scattered;
use crate::scenario::Scenario;
use crate::varied::{ParameterisedScenario, ParsedScenario, VariedKey, read_of_scenarios};

/// Metrics that are reported if the scenario does not specify any.
const REPORTED: [&str; 7] = [
    "contrast_ratio",
    "gamut_percent_srgb",
    "white.Y",
    "black.Y",
    "white.L_star",
    "white.a_star",
    "white.b_star",
];

/// A scenario whose keys have distributions, with limits of good displays.
#[derive(Debug, Clone)]
pub struct Tolerance {
    /// The scenario; its paths are those of all keys, in order.
    pub varied: ParameterisedScenario,
    /// Title of the scenario.
    pub title: Option<String>,
    /// Number of displays.
    pub samples: usize,
    /// Number of displays for sensitivities, at most `samples`.
    pub sensitivity_samples: usize,
    /// Seed of the displays.
    pub seed: u64,
    /// Keys with their distributions.
    pub keys: Vec<ScatteredKey>,
    /// Correlation of the keys.
    pub correlation: Correlation,
    /// Metrics to report, those with limits first.
    pub metrics: Vec<ReportedMetric>,
    /// Limits of a good display.
    pub limits: Vec<ToleranceLimit>,
    /// SHA-256 of everything that determines the results of a display, except its index: the scenario, the
    /// keys, the seed, the metrics.
    pub hash: String,
    /// Warnings of the scenario.
    pub warnings: Vec<String>,
    /// One note for each old name of a key or a value.
    pub notes: Vec<String>,
}

/// Keys with the same deviation, and their distribution.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatteredKey {
    /// Name in tables and figures.
    pub name: String,
    /// Each path with slope and offset: its value is `slope * x + offset` for a number x of the distribution.
    pub paths: Vec<(String, f64, f64)>,
    /// Distribution of the keys.
    pub distribution: Distribution,
    /// The possible values of [`Distribution::Choices`].
    pub choices: Vec<Value>,
}

/// A metric of a view, or of a state in a view.
#[derive(Debug, Clone, PartialEq)]
pub struct ReportedMetric {
    /// Name in tables and figures: "white.Y", "white.Y, view 1".
    pub name: String,
    /// Index of the view, from 0.
    pub view: usize,
    /// The state; `None` for a metric of a view.
    pub state: Option<String>,
    /// The metric.
    pub metric: Metric,
}

/// Limits of a metric.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ToleranceLimit {
    /// Index in [`Tolerance::metrics`].
    pub metric: usize,
    /// Lower limit.
    pub at_least: Option<f64>,
    /// Upper limit.
    pub at_most: Option<f64>,
}

read_of_scenarios!(Tolerance: "a `[tolerance]`", Self::new);

impl Tolerance {
    fn new(base: ParsedScenario) -> Result<Self, ScenarioErrors> {
        let assembled = base.assembled()?;
        let mut errors = Errors::default();
        let read = match assembled.get("tolerance") {
            Some(node) => Described::read(node, &mut errors),
            None => {
                let wrong =
                    Diagnostic::new("there is no tolerance analysis: the scenario has no `[tolerance]`")
                        .expected("[tolerance] with [[tolerance.keys]], each with a key and its distribution")
                        .hint("scenarios/tolerance.toml is an example; docs/tolerance.md has all keys");
                errors.push(assembled.origin, wrong);
                None
            }
        };
        let read = errors.finish(read, &base.sources)?;
        let scenario = base.scenario(&[])?;
        let resolved = scenario.resolve()?;
        let mut errors = Errors::default();
        let found = Self::found(&read, &base, &scenario, &resolved.scene, &mut errors);
        let (keys, correlation, metrics, limits) = errors.finish(found, &base.sources)?;
        let samples = read.samples.0 as usize;
        let sensitivity = read.sensitivity_samples.value.map_or(samples / 4, |count| count.0 as usize);
        let names: Vec<&str> = metrics.iter().map(|one| one.name.as_str()).collect();
        // The content of a picture belongs to the hash.
        let of_picture = metrics.iter().any(|one| one.metric.source() == MetricSource::Image);
        let hash = if of_picture { scenario.resolve_with_picture()?.hash } else { resolved.hash };
        let means = json!([hash, read.keys, read.correlations, read.seed, names]);
        let varied = |key: &Spanned<Scattered>| {
            let values = key.spread_origin().unwrap_or(key.origin);
            let paths = key.paths().into_iter();
            paths
                .map(move |(path, origin)| VariedKey { path: KeyPath::new(&path), origin, values })
                .collect::<Vec<_>>()
        };
        let places = read.keys.iter().flat_map(varied).collect();
        Ok(Self {
            title: resolved.title,
            samples,
            sensitivity_samples: sensitivity.min(samples),
            seed: read.seed.0,
            keys,
            correlation,
            metrics,
            limits,
            hash: sha256(means.to_string().as_bytes()),
            warnings: resolved.warnings,
            notes: base.notes()?,
            varied: ParameterisedScenario::new(base, Vec::new(), places),
        })
    }

    #[allow(clippy::type_complexity, reason = "the parts of one result")]
    fn found(
        read: &Described,
        base: &ParsedScenario,
        scenario: &Scenario,
        scene: &Scene,
        errors: &mut Errors,
    ) -> Option<(Vec<ScatteredKey>, Correlation, Vec<ReportedMetric>, Vec<ToleranceLimit>)> {
        let filled = serde_json::to_value(scenario.filled()).unwrap_or_default();
        let keys: Vec<_> = read.keys.iter().map(|key| scattered(key, base, &filled, errors)).collect();
        if read.keys.is_empty() {
            errors.push(read.keys.origin, mistake::empty_list());
        }
        let keys: Vec<ScatteredKey> = keys.into_iter().collect::<Option<_>>()?;
        check_distinct(&read.keys, &keys, errors);
        let correlation = correlation(&read.correlations, &keys, errors);
        let (metrics, limits) = columns(read, scene, errors);
        errors.is_empty().then_some((keys, correlation?, metrics, limits))
    }

    /// Checks that a display with these values of its paths is possible.
    ///
    /// # Errors
    /// Mistakes in the values, at the place of the key in `[tolerance]`.
    pub fn check(&self, values: &[Value]) -> Result<(), ScenarioErrors> {
        let made = self.varied.scenario(values).and_then(|scenario| scenario.resolve());
        made.map(|_| ()).map_err(|errors| errors.noted(|error| self.drawn(error)))
    }

    /// Returns a note on a value that was drawn from a distribution.
    fn drawn(&self, error: &ScenarioError) -> Option<String> {
        let keys = self.keys.iter().flat_map(|key| key.paths.iter().map(move |_| key));
        let (key, _) = keys.zip(self.varied.places()).find(|(_, place)| *place == error.place)?;
        let note = "a display of this production has this value";
        match key.distribution {
            Distribution::Normal { .. } | Distribution::LogNormal { .. } => {
                Some(format!("{note}: `from` and `to` exclude such displays"))
            }
            Distribution::Choices { .. } => None,
            _ => Some(note.to_owned()),
        }
    }
}

impl ReportedMetric {
    fn of(name: &MetricName, view: usize) -> Self {
        let text = if view == 0 { name.text() } else { format!("{}, view {view}", name.text()) };
        Self { name: text, view, state: name.state.clone(), metric: name.metric }
    }
}

impl Scattered {
    /// Returns the paths, each with its place.
    fn paths(&self) -> Vec<(String, Origin)> {
        let several = self.keys.iter().flatten().map(|path| (path.value.clone(), path.origin));
        self.key.iter().map(|path| (path.clone(), self.key.origin)).chain(several).collect()
    }
}

impl Scattered {
    /// Returns the place of the width of the distribution.
    fn spread_origin(&self) -> Option<Origin> {
        let or_all = |spread: &Spanned<Option<Deviation>>, all: Origin| {
            if spread.is_some() { spread.origin } else { all }
        };
        let normal = self.normal.as_ref().map(|one| one.sigma.origin);
        let lognormal = self.lognormal.as_ref().map(|one| one.sigma.origin);
        let uniform = self.uniform.as_ref().map(|one| or_all(&one.plus_minus, self.uniform.origin));
        let triangular = self.triangular.as_ref().map(|one| or_all(&one.plus_minus, self.triangular.origin));
        let choices = self.choices.as_ref().map(|one| one.values.origin);
        normal.or(lognormal).or(uniform).or(triangular).or(choices)
    }
}

/// Error: a key, or two keys with the same name, have more than one distribution.
fn two_distributions(name: &str) -> Diagnostic {
    Diagnostic::new(format!("`{name}` has more than one distribution"))
        .expected("each key and each name in one item of `tolerance.keys`")
        .hint("remove one of them, or give the items different names with `name`")
}

/// Checks that each key and each name occurs once.
fn check_distinct(read: &[Spanned<Scattered>], keys: &[ScatteredKey], errors: &mut Errors) {
    let (mut paths, mut names): (Vec<KeyPath>, Vec<&str>) = (Vec::new(), Vec::new());
    for (one, key) in read.iter().zip(keys) {
        for (path, origin) in one.paths() {
            let key = KeyPath::new(&path);
            if paths.contains(&key) {
                errors.push(origin, two_distributions(&path));
            } else if let Some(other) = paths.iter().find(|other| other.overlaps(&key)) {
                errors.push(origin, mistake::overlapping(&path, &other.present()));
            }
            paths.push(key);
        }
        if names.contains(&key.name.as_str()) && errors.is_empty() {
            errors.push(one.name.origin, two_distributions(&key.name));
        }
        names.push(&key.name);
    }
}

fn correlation(
    read: &[Spanned<Correlated>],
    keys: &[ScatteredKey],
    errors: &mut Errors,
) -> Option<Correlation> {
    let (mut coefficients, mut places) = (Vec::<Coefficient>::new(), Vec::new());
    for one in read {
        let place = |name: &Spanned<String>| {
            let place = keys.iter().position(|key| key.name == name.value);
            if place.is_none() {
                let hint = suggestion(name, keys.iter().map(|key| key.name.as_str()), "names");
                let wrong = Diagnostic::new(format!("no key with a distribution is named `{}`", name.value));
                errors.push(name.origin, wrong.hint(hint));
            }
            place
        };
        let found: Vec<usize> = one.keys.iter().map(place).collect::<Option<_>>()?;
        if found.len() < 2 {
            errors.push(one.keys.origin, mistake::no_such_count(found.len() as f64, "two keys or more"));
        }
        for (i, &second) in found.iter().enumerate() {
            if found[..i].contains(&second) {
                let name = &one.keys[i];
                errors.push(name.origin, mistake::listed_twice(&format!("`{}`", name.value)));
                continue;
            }
            for &first in &found[..i] {
                let value = one.coefficient.0;
                let is_pair = |known: &&Coefficient| {
                    known.between == [first, second] || known.between == [second, first]
                };
                if let Some(known) = coefficients.iter().find(is_pair) {
                    if known.value != value {
                        let [a, b] = [first, second].map(|at| &keys[at].name);
                        errors.push(one.coefficient.origin, two_coefficients([a, b], [known.value, value]));
                    }
                    continue;
                }
                coefficients.push(Coefficient { between: [first, second], value });
                places.push(one.origin);
            }
        }
    }
    match Correlation::new(keys.len(), &coefficients) {
        Ok(correlation) => Some(correlation),
        Err(at) => {
            let wrong = Diagnostic::new("the correlation matrix is not positive definite with this coefficient")
                .expected("coefficients that fit those above")
                .hint(
                    "two numbers that are closely correlated with a third one are closely correlated with each other; keys that \
                     always move together are one item with `keys`",
                );
            errors.push(places.get(at).copied().unwrap_or(Origin::FILE), wrong);
            None
        }
    }
}

/// Error: a pair of keys has two coefficients.
fn two_coefficients([a, b]: [&str; 2], [before, now]: [f64; 2]) -> Diagnostic {
    Diagnostic::new(format!("the correlation of `{a}` and `{b}` is {before} above, and {now} here"))
        .expected("one coefficient for each pair of keys")
        .hint("a list of more than two keys gives every pair of them the coefficient; remove this pair from one of the lists")
}

/// Returns the metrics with limits, then the other metrics to report; and the limits.
fn columns(
    read: &Described,
    scene: &Scene,
    errors: &mut Errors,
) -> (Vec<ReportedMetric>, Vec<ToleranceLimit>) {
    let states = scene.display.state_names();
    let mut metrics: Vec<ReportedMetric> = Vec::new();
    let mut column = |name: &MetricName, view: usize| {
        let asked = ReportedMetric::of(name, view);
        let at = metrics.iter().position(|known| known.name == asked.name);
        at.unwrap_or_else(|| {
            metrics.push(asked);
            metrics.len() - 1
        })
    };
    let limits = read.limits.iter().map(|limit| {
        checked(limit, scene, &states, errors);
        let (at_least, at_most) = (limit.at_least.map(|one| one.0), limit.at_most.map(|one| one.0));
        ToleranceLimit { metric: column(&limit.metric, limit.view.0 as usize), at_least, at_most }
    });
    let limits = limits.collect();
    match &read.metrics.value {
        Some(named) => {
            named.iter().for_each(|name| {
                has_state(name, &states, errors);
                column(name, 0);
            });
            mistake::each_once(named.iter().map(|name| (name.text(), name.origin)), errors);
        }
        None => REPORTED.iter().filter_map(|text| MetricName::named(text)).for_each(|name| {
            if name.state.as_ref().is_none_or(|state| states.contains(state)) {
                column(&name, 0);
            }
        }),
    }
    (metrics, limits)
}

fn checked(limit: &Spanned<Limit>, scene: &Scene, states: &[String], errors: &mut Errors) {
    has_state(&limit.metric, states, errors);
    if let Some(wrong) = mistake::lacks_states(&limit.metric.text(), limit.metric.metric, states) {
        errors.push(limit.metric.origin, wrong);
    }
    let views = views(scene);
    if limit.view.0 as usize >= views {
        let expected = format!("the number of a view, 0 to {}", views - 1);
        errors.push(limit.view.origin, mistake::no_such_count(limit.view.0 as f64, expected));
    }
    match (limit.at_least.value, limit.at_most.value) {
        (None, None) => {
            let wrong = Diagnostic::new("this limit has neither `at_least` nor `at_most`");
            errors.push(limit.origin, wrong.expected("one of them, or both"));
        }
        (Some(from), Some(to)) if from.0 >= to.0 => {
            errors.push(limit.at_most.origin, mistake::empty_range(from.0, to.0));
        }
        _ => {}
    }
}

/// Returns the metrics of every view of a scene. Those of the first view have no view in their names.
pub(crate) fn of_all_views(
    named: &[Spanned<MetricName>],
    scene: &Scene,
    errors: &mut Errors,
) -> Vec<ReportedMetric> {
    let states = scene.display.state_names();
    named.iter().for_each(|name| has_state(name, &states, errors));
    let of_view = |view: usize| named.iter().map(move |name| ReportedMetric::of(name, view));
    (0..views(scene)).flat_map(of_view).collect()
}

fn views(scene: &Scene) -> usize {
    scene.viewer.theta_deg.len() * scene.viewer.phi_deg.len()
}

fn has_state(name: &Spanned<MetricName>, states: &[String], errors: &mut Errors) {
    if let Some(state) = name.state.as_ref().filter(|state| !states.contains(state)) {
        errors.push(name.origin, mistake::no_such_state(state, states));
    }
}
