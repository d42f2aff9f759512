//! Sweeps: a scenario at every point of its `[sweep]`.

use papilio_diagnostics::{Diagnostic, Remedy};
use papilio_display::scene::{Method, MetricSource};
use papilio_formats::{SweepHead, SweepHeadAxis, sweep_place};
use serde_json::json;

use crate::describe::limits::MetricName;
use crate::describe::sweep::{Axis, MOST_POINTS, Sweep as Described, Swept};
use crate::error::{Errors, ScenarioErrors};
use crate::library::sha256;
use crate::mistake;
use crate::nearest::no_such_metric;
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::read::{Read, Spanned};
use crate::scenario::Scenario;
use crate::set::Change;
use crate::source::AXIS;
use crate::tolerance::{ReportedMetric, of_all_views};
use crate::tree::{Node, Value};
use crate::varied::{ParameterisedScenario, ParsedScenario, VariedKey, read_of_scenarios};

/// A scenario at every combination of the axes of its `[sweep]`; the last axis varies fastest.
#[derive(Debug, Clone)]
pub struct Sweep {
    base: ParsedScenario,
    axes: Vec<Axis>,
    figures: Vec<Spanned<String>>,
    metrics: Option<Vec<Spanned<MetricName>>>,
    title: Option<String>,
    notes: Vec<String>,
}

// Mistakes in the scenario itself are reported at the points of the sweep.
read_of_scenarios!(Sweep: "a `[sweep]`", Self::new);

impl Sweep {
    fn new(base: ParsedScenario) -> Result<Self, ScenarioErrors> {
        let assembled = base.assembled()?;
        let mut errors = Errors::default();
        let node = assembled.get("sweep");
        let figures_alone = |node: &&Node| match &node.value {
            Value::Table(entries) => entries.iter().all(|entry| entry.key == "figures"),
            _ => false,
        };
        let read = match node.filter(|node| !figures_alone(node)) {
            Some(node) => Described::read(node, &mut errors),
            None => {
                let wrong =
                    Diagnostic::new("there is nothing to sweep: the scenario has no `[[sweep.axes]]`")
                        .expected("`[[sweep.axes]]`, a table of keys with a list of values each")
                        .hint("write [[sweep.axes]], and below it display.diffuser.haze = [0.5, 0.7]")
                        .remedy(Remedy::OnCommandLine(
                            "papilio sweep FILE --axis display.diffuser.haze=0.5:0.7:0.1 needs none"
                                .to_owned(),
                        ));
                errors.push(node.map_or(assembled.origin, |node| node.origin), wrong);
                None
            }
        };
        let title = assembled.get("title").and_then(|title| String::read(title, &mut Errors::default()));
        let sound = read.filter(|read| is_sound(read, &mut errors));
        let read = errors.finish(sound, &base.sources)?;
        let axes: Vec<Axis> = read.axes.value.into_iter().map(|axis| axis.value).collect();
        let mut notes = base.notes()?;
        notes.extend(axes.iter().flat_map(|axis| &axis.0).filter_map(|swept| swept.note.clone()));
        Ok(Self { notes, base, axes, figures: read.figures.value, metrics: read.metrics.value, title })
    }

    /// The override that sets an axis, `KEY=VALUES`: `FROM:TO:STEP`, or values with commas between them. All
    /// of them together replace the axes of the file.
    pub fn axis_override(axis: &str) -> String {
        format!("{AXIS}{axis}")
    }

    /// Returns one note for each old name of a key or a value, and for each range whose steps end before its end.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Returns the number of points, at least 1.
    #[allow(clippy::len_without_is_empty, reason = "it is never empty")]
    pub fn len(&self) -> usize {
        self.axes.iter().map(Axis::len).product()
    }

    /// Returns the head of a journal by this version of the program; `name` is the title of a scenario
    /// without one.
    pub fn head(&self, papilio: &str, name: &str) -> SweepHead {
        let axis = |axis: &Axis| {
            let at = |at: usize| axis.0.iter().map(|swept| swept.values[at].to_json()).collect();
            SweepHeadAxis {
                keys: axis.0.iter().map(|swept| swept.path.text().to_owned()).collect(),
                values: (0..axis.len()).map(at).collect(),
            }
        };
        SweepHead {
            papilio: papilio.to_owned(),
            title: Some(self.title.clone().unwrap_or_else(|| name.to_owned())),
            axes: self.axes.iter().map(axis).collect(),
            figures: self.figures.iter().map(|name| name.value.clone()).collect(),
            light: None,
        }
    }

    /// Returns the compact sweep, if this is one. Without `figures` all its metrics are drawn.
    ///
    /// # Errors
    /// Mistakes in its metrics, or in the scenario at a point of [`samples`](Self::samples).
    pub fn light(&mut self) -> Result<Option<LightSweep>, ScenarioErrors> {
        let Some(named) = self.metrics.clone() else { return Ok(None) };
        // The content of a picture belongs to the hash.
        let of_picture = |name: &Spanned<MetricName>| name.metric.source() == MetricSource::Image;
        let with_picture = named.iter().any(of_picture);
        let resolved = |scenario: Scenario| {
            if with_picture { scenario.resolve_with_picture() } else { scenario.resolve() }
        };
        let first = resolved(self.scenario(0)?)?;
        let mut errors = Errors::default();
        let metrics = of_all_views(&named, &first.scene, &mut errors);
        let known: Vec<String> = named.iter().map(|name| name.text()).collect();
        let viewer = &first.scene.viewer;
        let of_phi = |phi: &f64| viewer.theta_deg.iter().map(|theta| [*theta, *phi]).collect::<Vec<_>>();
        let views = viewer.phi_deg.iter().flat_map(of_phi);
        let moved = self.axes.iter().flat_map(|axis| &axis.0).any(|swept| is_of_viewer(&swept.path));
        let views = if moved { Vec::new() } else { views.collect() };
        if !self.figures.is_empty() && self.figures.iter().all(|name| name.origin == Origin::FILE) {
            self.figures = known.iter().cloned().map(Spanned::without_span).collect();
        }
        let is_metric = |name: &str| MetricName::named(name).is_some();
        for name in self.figures.iter().filter(|name| !known.contains(name) && is_metric(name)) {
            let (figure, kept) = (&name.value, known.join(", "));
            let wrong = Diagnostic::new(format!("this sweep does not compute `{figure}`, only {kept}"))
                .hint(format!("add \"{figure}\" to sweep.metrics, or remove it from sweep.figures"));
            errors.push(name.origin, wrong);
        }
        errors.check(&self.base.sources)?;
        self.check_figures(&known)?;
        // A value that is not a number may name a file, whose content belongs to the hash.
        let mut means = vec![first.hash];
        for point in self.samples().into_iter().skip(1) {
            if self.at(point).iter().any(|change| change.value.number().is_none()) {
                means.push(resolved(self.scenario(point)?)?.hash);
            }
        }
        let head = self.head("", "");
        let means = serde_json::json!([means, head.axes, known]);
        let keys = self.axes.iter().flat_map(|axis| &axis.0);
        let places = keys.clone().map(|swept| VariedKey::at(swept.path.text(), swept.origin)).collect();
        Ok(Some(LightSweep {
            varied: ParameterisedScenario::new(self.base.clone(), Vec::new(), places),
            keys: keys.map(|swept| swept.values.iter().map(Node::to_json).collect()).collect(),
            axes: self.axes.iter().map(|axis| (axis.len(), axis.0.len())).collect(),
            metrics,
            views,
            method: first.scene.solver.method,
            hash: sha256(means.to_string().as_bytes()),
        }))
    }

    /// Checks that all metrics to draw are among the `known` metrics of the results.
    ///
    /// # Errors
    /// Each metric that the results do not have, with its place.
    pub fn check_figures(&self, known: &[String]) -> Result<(), ScenarioErrors> {
        let mut errors = Errors::default();
        for name in self.figures.iter().filter(|name| !known.contains(name)) {
            let named = MetricName::named(&name.value).map(|named| named.metric.source().command());
            let wrong = match named.filter(|_| self.metrics.is_none()).flatten() {
                Some(command) => Diagnostic::new(format!(
                    "`{}` is a metric of `papilio {command}`, not of a run",
                    name.value
                ))
                .hint(format!("store it in every point: sweep.metrics = [\"{}\"]", name.value)),
                None => no_such_metric(&name.value, known),
            };
            errors.push(name.origin, wrong);
        }
        errors.check(&self.base.sources)
    }

    /// Reads the scenario at a point.
    ///
    /// # Errors
    /// As [`Scenario::load`]; the place of a value is that in `[sweep]`.
    pub fn scenario(&self, point: usize) -> Result<Scenario, ScenarioErrors> {
        self.base.scenario(&self.at(point))
    }

    /// Returns one point for every value of every axis, with the first values of the other axes. They are
    /// enough to find mistakes in single values before the computation.
    pub fn samples(&self) -> Vec<usize> {
        let mut samples = vec![0];
        let mut stride = self.len();
        for axis in &self.axes {
            stride /= axis.len();
            samples.extend((1..axis.len()).map(|at| at * stride));
        }
        samples
    }

    fn at(&self, point: usize) -> Vec<Change> {
        let lengths: Vec<usize> = self.axes.iter().map(Axis::len).collect();
        let place = sweep_place(&lengths, point);
        let swept = self.axes.iter().zip(place);
        let change = |swept: &Swept, at: usize| Change {
            path: swept.path.clone(),
            origin: swept.origin,
            value: swept.values[at].clone(),
        };
        swept.flat_map(|(axis, at)| axis.0.iter().map(move |swept| change(swept, at))).collect()
    }
}

/// A sweep that stores only some metrics.
#[derive(Debug, Clone)]
pub struct LightSweep {
    /// The scenario: its paths are those of all keys, in order.
    pub varied: ParameterisedScenario,
    /// The values of each key.
    pub keys: Vec<Vec<serde_json::Value>>,
    /// Metrics that are stored for every point: of the first view, then of the others.
    pub metrics: Vec<ReportedMetric>,
    /// Angles theta and phi of the views, degrees; empty if the swept keys may change them.
    pub views: Vec<[f64; 2]>,
    /// Solver of the first point.
    pub method: Method,
    /// SHA-256 of everything that determines the results, except the index of the point.
    pub hash: String,
    /// Length and number of keys of each axis.
    axes: Vec<(usize, usize)>,
}

impl LightSweep {
    /// Returns the index of the value of each key at a point.
    pub fn at(&self, point: usize) -> Vec<usize> {
        let lengths: Vec<usize> = self.axes.iter().map(|(length, _)| *length).collect();
        let place = sweep_place(&lengths, point);
        place.iter().zip(&self.axes).flat_map(|(at, (_, keys))| std::iter::repeat_n(*at, *keys)).collect()
    }
}

/// True if a key may change the views.
fn is_of_viewer(path: &KeyPath) -> bool {
    let keys: Vec<&str> = path.keys().collect();
    // A preset sets the viewer too.
    matches!(
        keys[..],
        ["viewer"] | ["viewer", "theta_deg" | "phi_deg", ..] | ["lighting"] | ["lighting", "preset"]
    )
}

/// Checks the axes together: there is at least one, no key is swept twice, and there are not too many points.
fn is_sound(sweep: &Described, errors: &mut Errors) -> bool {
    if let Some(metrics) = &sweep.metrics.value
        && metrics.is_empty()
    {
        errors.push(sweep.metrics.origin, mistake::empty_list());
        return false;
    }
    let metrics = sweep.metrics.value.iter().flatten().map(|name| (name.text(), name.origin));
    mistake::each_once(metrics, errors);
    // --metrics sets both lists.
    if !errors.is_empty() {
        return false;
    }
    mistake::each_once(sweep.figures.iter().map(|name| (name.value.clone(), name.origin)), errors);
    if sweep.axes.is_empty() {
        errors.push(sweep.axes.origin, mistake::empty_list());
        return false;
    }
    let all: Vec<&Swept> = sweep.axes.iter().flat_map(|axis| &axis.0).collect();
    for (i, swept) in all.iter().enumerate() {
        if all[..i].iter().any(|other| other.path == swept.path) {
            let wrong = Diagnostic::new(format!("`{}` is swept twice", swept.path));
            let hint = "give all of its values in one list, or remove one of the two";
            errors.push(swept.origin, wrong.expected("a key that no other axis has").hint(hint));
            return false;
        }
    }
    for axis in sweep.axes.iter() {
        if let Some((origin, values)) = axis.repeated() {
            errors.push(origin, mistake::listed_twice(&values));
            return false;
        }
    }
    let points = sweep.axes.iter().try_fold(1_usize, |points, axis| points.checked_mul(axis.len()));
    match points.filter(|points| *points <= MOST_POINTS) {
        Some(_) => true,
        None => {
            let count: f64 = sweep.axes.iter().map(|axis| axis.len() as f64).product();
            errors.push(sweep.axes.origin, mistake::too_many("points", count, MOST_POINTS));
            false
        }
    }
}

impl Node {
    /// Converts the value to JSON.
    pub(crate) fn to_json(&self) -> serde_json::Value {
        use crate::tree::Value as Toml;
        match &self.value {
            Toml::Bool(value) => json!(value),
            Toml::Integer(value) => json!(value),
            Toml::Float(value) => json!(value),
            Toml::Text(text) => json!(text),
            Toml::DateTime => serde_json::Value::Null,
            Toml::Array(items) => items.iter().map(Self::to_json).collect(),
            Toml::Table(entries) => {
                entries.iter().map(|entry| (entry.key.clone(), entry.node.to_json())).collect()
            }
        }
    }
}
