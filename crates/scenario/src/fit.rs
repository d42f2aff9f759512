//! Fits: a scenario with the variables of its `[fit]`, which measured data are to determine.

use papilio_diagnostics::{Diagnostic, suggestion};
use serde_json::json;

use crate::describe::fit as describe;
use crate::describe::optimize::Variable as Searched;
use crate::error::{Errors, ScenarioErrors};
use crate::library::sha256;
use crate::mistake;
use crate::optimise::read::numeric_variables;
use crate::optimise::{Key, SearchRange, SearchVariable};
use crate::path::{KeyPath, index};
use crate::read::{Read, Spanned};
use crate::tree::{Node, Value};
use crate::varied::{ParameterisedScenario, ParsedScenario, no_quantity, read_of_scenarios};

/// Variables of the measurement, with their ranges and the values of a perfect meter.
const OF_METER: [(&str, FitTarget, [f64; 2], f64); 2] = [
    ("meter.wavelength_offset_nm", FitTarget::WavelengthOffset, [-100.0, 100.0], 0.0),
    ("meter.scale", FitTarget::Scale, [1e-3, 1e3], 1.0),
];

/// A fit, read and checked: every bound gives a valid scenario.
#[derive(Debug, Clone)]
pub struct Fit {
    /// The scenario; its paths are those of all variables of the display, in order.
    pub varied: ParameterisedScenario,
    /// Variables.
    pub variables: Vec<FitVariable>,
    /// Number of starting points, the scenario's own values included.
    pub starts: usize,
    /// Standard deviations of the measured numbers.
    pub deviations: FitDeviations,
    /// Seed of the starting points.
    pub seed: u64,
    /// Title of the scenario.
    pub title: Option<String>,
    /// SHA-256 of the fit, of its scenario, and of the scenario's files.
    pub hash: String,
    /// One note for each old name of a key or a value.
    pub notes: Vec<String>,
}

impl Fit {
    /// SHA-256 of the fit together with what it is fitted to.
    pub fn hash_with(&self, measured: &str) -> String {
        sha256(json!([self.hash, measured]).to_string().as_bytes())
    }
}

/// Standard deviations of the measured numbers of a fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FitDeviations {
    /// Those of the measurement; from the residuals where it states none.
    Stated,
    /// From the residuals.
    Residuals,
}

/// A number that the data are to determine.
#[derive(Debug, Clone, PartialEq)]
pub struct FitVariable {
    /// Name: the first path.
    pub name: String,
    /// What it sets.
    pub target: FitTarget,
    /// Smallest and largest value.
    pub bounds: [f64; 2],
    /// Value of the scenario, or the centre of the bounds if the scenario's value is not within them.
    pub start: f64,
    /// Value of the scenario, also outside the bounds; that of a perfect meter for a number of the measurement. `None` if the
    /// scenario has no number there.
    pub own: Option<f64>,
    /// Mean and standard deviation of what is known from elsewhere.
    pub prior: Option<[f64; 2]>,
}

impl FitVariable {
    /// Paths that get the value; the name of a number of the measurement.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        let keys = match &self.target {
            FitTarget::Keys(keys) => keys.as_slice(),
            FitTarget::WavelengthOffset | FitTarget::Scale => &[],
        };
        let of_meter = keys.is_empty().then_some(self.name.as_str());
        keys.iter().filter(|key| key.slope > 0.0).map(|key| key.path.as_str()).chain(of_meter)
    }

    /// Path that changes by the opposite amount.
    pub fn compensated_by(&self) -> Option<&str> {
        let FitTarget::Keys(keys) = &self.target else { return None };
        keys.iter().find(|key| key.slope < 0.0).map(|key| key.path.as_str())
    }
}

/// What a variable of a fit sets.
#[derive(Debug, Clone, PartialEq)]
pub enum FitTarget {
    /// Keys of the scenario.
    Keys(Vec<Key>),
    /// Wavelength that is to be added to the measured ones, nm.
    WavelengthOffset,
    /// Factor on the predicted reflectance factors, X, Y, Z.
    Scale,
}

read_of_scenarios!(Fit: "a `[fit]`", Self::new);

impl Fit {
    fn new(base: ParsedScenario) -> Result<Self, ScenarioErrors> {
        let root = base.assembled()?;
        let mut errors = Errors::default();
        let read = match root.get("fit") {
            Some(node) => describe::Fit::read(node, &mut errors),
            None => {
                let wrong = Diagnostic::new("there is nothing to fit: the scenario has no `[fit]`")
                    .expected("[fit] with [[fit.variables]], each with a key and its bounds")
                    .hint("scenarios/fit.toml is an example; docs/fit.md has all keys");
                errors.push(root.origin, wrong);
                None
            }
        };
        let read = errors.finish(read, &base.sources)?;
        let mut errors = Errors::default();
        if read.variables.is_empty() {
            errors.push(read.variables.origin, mistake::empty_list());
        }
        let of_meter: Vec<Option<FitVariable>> =
            read.variables.iter().map(|one| meter_variable(one, &mut errors)).collect();
        check_meter_once(&read.variables, &of_meter, &mut errors);
        for one in &*read.variables {
            check_prior(one, &mut errors);
            check_paths(one, (&base, &root), &mut errors);
        }
        errors.check(&base.sources)?;
        let searched: Vec<Spanned<Searched>> = read
            .variables
            .iter()
            .zip(&of_meter)
            .filter(|(_, one)| one.is_none())
            .map(|(one, _)| searched(one))
            .collect();
        let title = root.get("title").and_then(|title| String::read(title, &mut Errors::default()));
        let notes = base.notes()?;
        let (display, varied, hash) = numeric_variables(base, &searched)?;
        let mut display = display.into_iter();
        let variables = of_meter.into_iter().zip(read.variables.iter()).filter_map(|(meter, read)| {
            meter.or_else(|| {
                display.next().map(|one| {
                    let own = root.at(&one.name).and_then(Node::number);
                    display_variable(one, own, read)
                })
            })
        });
        Ok(Self {
            variables: variables.collect(),
            varied,
            starts: read.starts.0 as usize,
            deviations: read.deviations.0,
            seed: read.seed.0,
            title,
            hash: sha256(json!([hash, read]).to_string().as_bytes()),
            notes,
        })
    }
}

/// The variable in the form of a search.
fn searched(read: &Spanned<describe::FitVariable>) -> Spanned<Searched> {
    let bounds = Spanned { value: Some(read.bounds.value.clone()), origin: read.bounds.origin };
    let value = Searched {
        key: read.key.clone(),
        keys: read.keys.clone(),
        compensated_by: read.compensated_by.clone(),
        bounds,
        choices: Spanned::without_span(None),
    };
    Spanned { value, origin: read.origin }
}

fn display_variable(found: SearchVariable, own: Option<f64>, read: &describe::FitVariable) -> FitVariable {
    let bounds = match found.range {
        SearchRange::Bounds(from, to) => [from, to],
        SearchRange::Choices(_) => [0.0, 0.0],
    };
    let start = found.start();
    let (name, target) = (found.name, FitTarget::Keys(found.keys));
    FitVariable { name, target, bounds, start, own, prior: prior(read) }
}

/// Smallest standard deviation of a prior, in widths of the bounds.
const LEAST_SIGMA: f64 = 1e-6;

/// Fails for a prior whose mean the bounds exclude, or that leaves nothing to fit.
fn check_prior(read: &describe::FitVariable, errors: &mut Errors) {
    let (Some(prior), [from, to]) = (&read.prior.value, read.bounds.as_slice()) else { return };
    let mean = prior.mean.0;
    if from.0 < to.0 && !(from.0..=to.0).contains(&mean) {
        let wrong = Diagnostic::new(format!("the mean of the prior, {mean}, is outside the bounds"))
            .expected(format!("a mean from {} to {}", from.0, to.0));
        errors.push(prior.mean.origin, wrong);
    }
    let least = LEAST_SIGMA * (to.0 - from.0);
    if from.0 < to.0 && prior.sigma.0 < least {
        let wrong = Diagnostic::new(format!("the prior holds the value within {}", prior.sigma.0))
            .expected(format!("at least {least}"))
            .hint("to hold a value, remove the variable and set its key");
        errors.push(prior.sigma.origin, wrong);
    }
}

/// What a fit can vary.
const FITTED: &str = "a number of what was measured, such as those of [display], [lighting] and [viewer], or \
                      meter.wavelength_offset_nm or meter.scale";

/// Fails for a setting, for a list, which would become one number, and for an item that the scenario does not have: a fit would add it.
fn check_paths(read: &describe::FitVariable, (base, root): (&ParsedScenario, &Node), errors: &mut Errors) {
    let single = read.key.iter().map(|path| (path, read.key.origin));
    let several = read.keys.iter().flatten().map(|path| (&path.value, path.origin));
    let other = read.compensated_by.iter().map(|path| (path, read.compensated_by.origin));
    for (text, origin) in single.chain(several).chain(other) {
        if let Some(wrong) = no_quantity(text, FITTED) {
            errors.push(origin, wrong);
            continue;
        }
        let path = KeyPath::new(text);
        if path.get(root).is_some_and(|node| matches!(node.value, Value::Array(_))) {
            let wrong = Diagnostic::new(format!("`{text}` is a list in this scenario"))
                .expected(format!("a key with one number, such as `{text}.0`"));
            errors.push(origin, mistake::of_path(wrong));
            continue;
        }
        let Some(missing) = path.prefixes().find(|part| part.get(root).is_none()) else { continue };
        let is_item = |part: &KeyPath| index(part.split_last().1).is_some();
        let item = path.prefixes().skip(missing.keys().len() - 1).find(is_item);
        if let Some(item) = item
            && let (Some(list), last) = item.split_last()
        {
            let count = match list.get(root).map(|node| &node.value) {
                Some(Value::Array(items)) => items.len(),
                None if base.wrong_path(list.text(), origin).is_none() => 0,
                _ => continue,
            };
            let there = match count {
                0 => "it has none".to_owned(),
                1 => "its only item is 0".to_owned(),
                _ => format!("its items are 0 to {}", count - 1),
            };
            let wrong = Diagnostic::new(format!("`{}` has no item {last}: {there}", list.present()))
                .hint("a fit varies what the scenario has: add the item to the scenario first");
            errors.push(origin, mistake::of_path(wrong));
        }
    }
}

fn prior(read: &describe::FitVariable) -> Option<[f64; 2]> {
    read.prior.value.as_ref().map(|prior| [prior.mean.0, prior.sigma.0])
}

/// Reads a variable of the measurement; `None` for one of the display, and after an error.
fn meter_variable(read: &Spanned<describe::FitVariable>, errors: &mut Errors) -> Option<FitVariable> {
    let is_of_meter = |path: &str| path.trim().starts_with("meter.");
    if let Some(path) = read.keys.iter().flatten().find(|path| is_of_meter(&path.value)) {
        let wrong = Diagnostic::new(format!("`{}` is a number of the measurement", path.value));
        errors.push(path.origin, wrong.expected("one such number under `key`, not in `keys`"));
        return None;
    }
    let name = read.key.as_ref().filter(|path| is_of_meter(path))?.trim();
    let known = OF_METER.iter().find(|(known, ..)| *known == name);
    let Some((known, target, [least, most], perfect)) = known else {
        let hint = suggestion(name, OF_METER.iter().map(|(name, ..)| *name), "numbers of a measurement");
        errors.push(read.key.origin, Diagnostic::new(format!("there is no `{name}`")).hint(hint));
        return None;
    };
    if read.compensated_by.is_some() {
        errors.push(
            read.compensated_by.origin,
            mistake::not_with("compensated_by", "a number of the measurement"),
        );
        return None;
    }
    let bounds: Vec<f64> = read.bounds.iter().map(|bound| bound.0).collect();
    let &[from, to] = bounds.as_slice() else {
        errors.push(
            read.bounds.origin,
            mistake::another_length("the smallest and the largest value, as [-3, 3]"),
        );
        return None;
    };
    if from >= to || from < *least || to > *most {
        let wrong = Diagnostic::new(format!("{from} to {to} are no bounds of `{known}`"))
            .expected(format!("the smaller value first, and both from {least} to {most}"));
        errors.push(read.bounds.origin, wrong);
        return None;
    }
    let start = if (from..=to).contains(perfect) { *perfect } else { 0.5 * (from + to) };
    let (name, target) = ((*known).to_owned(), target.clone());
    Some(FitVariable { name, target, bounds: [from, to], start, own: Some(*perfect), prior: prior(read) })
}

fn check_meter_once(
    read: &[Spanned<describe::FitVariable>],
    of_meter: &[Option<FitVariable>],
    errors: &mut Errors,
) {
    for (i, one) in of_meter.iter().enumerate() {
        let Some(one) = one else { continue };
        if of_meter[..i].iter().flatten().any(|other| other.target == one.target) {
            let wrong = Diagnostic::new(format!("more than one variable is `{}`", one.name));
            errors.push(read[i].key.origin, wrong);
        }
    }
}
