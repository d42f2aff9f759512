//! Evaluation of `[optimize]`: from its description to a search.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Method as Solver, MetricSource, Scene};
use serde_json::Value as Json;
use sha2::{Digest, Sha256};

use super::{Key, Optimisation, SearchCondition, SearchRange, SearchVariable};
use crate::describe::optimize as describe;
use crate::error::{Errors, ScenarioErrors};
use crate::library::hex;
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::read::{Read, Spanned};
use crate::scenario::Scenario;
use crate::set::Change;
use crate::tree::Node;
use crate::varied::{ParameterisedScenario, ParsedScenario, QUANTITY, VariedKey, no_quantity};

/// Reads the `[optimize]` of a scenario.
pub(super) fn search(base: ParsedScenario) -> Result<Optimisation, ScenarioErrors> {
    let root = base.assembled()?;
    let mut errors = Errors::default();
    let described = match root.get("optimize") {
        Some(node) => describe::Optimize::read(node, &mut errors),
        None => {
            let wrong = Diagnostic::new("there is nothing to optimise: the scenario has no `[optimize]`")
                .expected("`[optimize]` with its variables and objectives")
                .hint("scenarios/optimize.toml is an example; docs/optimize.md has all keys");
            errors.push(root.origin, wrong);
            None
        }
    };
    let described = errors.finish(described, &base.sources)?;
    let title = root.get("title").and_then(|title| String::read(title, &mut Errors::default()));
    Reader { base, root, errors: Errors::default(), file_notes: Vec::new() }.search(&described, title)
}

/// Reads variables that are numbers, for a fit: with the scenario that they parameterise, and its hash.
pub(crate) fn numeric_variables(
    base: ParsedScenario,
    specs: &[Spanned<describe::Variable>],
) -> Result<(Vec<SearchVariable>, ParameterisedScenario, String), ScenarioErrors> {
    let root = base.assembled()?;
    let mut reader = Reader { base, root, errors: Errors::default(), file_notes: Vec::new() };
    let found: Vec<Option<ReadVariable>> = specs.iter().map(|one| reader.variable(one)).collect();
    let found: Option<Vec<ReadVariable>> = found.into_iter().collect();
    reader.check_once(found.as_deref().unwrap_or_default());
    let found = std::mem::take(&mut reader.errors).finish(found, &reader.base.sources)?;
    let varied = ParameterisedScenario::new(reader.base.clone(), Vec::new(), varied_keys(&found));
    reader.check_numbers(&varied, &found)?;
    let own = condition_scene(&varied, &found)?;
    reader.check_solver(
        &own.scene,
        "a fit with method = \"monte-carlo\" would follow the noise of the Monte Carlo solver",
        "set solver.method = \"adding\"",
    )?;
    reader.check_ends(&varied, &found)?;
    Ok((found.into_iter().map(|one| one.variable).collect(), varied, own.hash))
}

/// The keys of all variables, in order.
fn varied_keys(found: &[ReadVariable]) -> Vec<VariedKey> {
    let keys = found.iter().flat_map(|one| {
        let keys = one.variable.keys.iter().zip(&one.origins);
        keys.map(|(key, origin)| VariedKey {
            path: KeyPath::new(&key.path),
            origin: *origin,
            values: one.values,
        })
    });
    keys.collect()
}

/// A variable, with the places of its keys.
struct ReadVariable {
    variable: SearchVariable,
    /// Place of each path.
    origins: Vec<Origin>,
    /// Place of the bounds or choices.
    values: Origin,
    /// Place and value of each bound, or place and index of each choice.
    ends: Vec<(Origin, f64)>,
}

impl ReadVariable {
    /// Returns a note on the value of the compensating key at `x`.
    fn given(&self, x: f64) -> Option<String> {
        let Key { path, slope, offset } = self.variable.keys.iter().find(|key| key.slope < 0.0)?;
        Some(format!("at this bound `{path}` is {}", tidy(slope * x + offset)))
    }
}

pub(super) struct Reader {
    pub(super) base: ParsedScenario,
    root: Node,
    pub(super) errors: Errors,
    /// Notes on files of the search.
    pub(super) file_notes: Vec<String>,
}

impl Reader {
    fn search(
        mut self,
        spec: &describe::Optimize,
        title: Option<String>,
    ) -> Result<Optimisation, ScenarioErrors> {
        let found: Vec<Option<ReadVariable>> = spec.variables.iter().map(|one| self.variable(one)).collect();
        if spec.variables.is_empty() {
            self.errors.push(spec.variables.origin, mistake::empty_list());
        }
        if spec.objectives.is_empty() {
            self.errors.push(spec.objectives.origin, mistake::empty_list());
        }
        let found: Option<Vec<ReadVariable>> = found.into_iter().collect();
        self.check_once(found.as_deref().unwrap_or_default());
        self.check_names(spec);
        let found = std::mem::take(&mut self.errors).finish(found, &self.base.sources)?;
        let conditions = self.conditions(spec, &found);
        let scenes = conditions
            .iter()
            .map(|one| condition_scene(&one.varied, &found))
            .collect::<Result<Vec<_>, _>>()?;
        for (condition, known) in conditions.iter().zip(&scenes) {
            self.check_solver(
                &known.scene,
                "a search with method = \"monte-carlo\" would follow the noise of the Monte Carlo solver",
                "set solver.method = \"adding\"; the Monte Carlo solver checks the best design afterwards",
            )?;
            self.check_numbers(&condition.varied, &found)?;
            self.check_ends(&condition.varied, &found)?;
        }
        let names: Vec<&str> = conditions.iter().map(|one| one.name.as_str()).collect();
        let weights: Vec<f64> = conditions.iter().map(|one| one.weight).collect();
        let objectives: Option<Vec<_>> =
            spec.objectives.iter().map(|one| self.objective(one, &names, &weights, &scenes)).collect();
        let constraints: Vec<Option<Vec<_>>> =
            spec.constraints.iter().map(|one| self.constraint(one, &names, &scenes)).collect();
        let constraints: Option<Vec<Vec<_>>> = constraints.into_iter().collect();
        let both =
            std::mem::take(&mut self.errors).finish(objectives.zip(constraints), &self.base.sources)?;
        let (objectives, constraints) = both;
        let quantities = objectives.iter().flat_map(|one| one.parts.iter().map(|(_, quantity)| quantity));
        let mut quantities = quantities.chain(constraints.iter().flatten().map(|one| &one.quantity));
        // The content of a picture belongs to the hash.
        let of_picture = quantities.any(|one| one.quantity.source() == MetricSource::Image);
        let pictured = match of_picture {
            true => conditions.iter().map(|one| hash_with_picture(&one.varied, &found)).collect(),
            false => Ok(Vec::new()),
        }?;
        let hash = hash(spec, &scenes, &pictured);
        let mut warnings = self.base.scenario(&[])?.resolve()?.warnings;
        for one in scenes.into_iter().flat_map(|one| one.warnings) {
            if !warnings.contains(&one) {
                warnings.push(one);
            }
        }
        Ok(Optimisation {
            method: spec.method.0,
            starts: spec.starts.0 as usize,
            seed: spec.seed.0,
            evaluations: spec.evaluations.0 as usize,
            points: spec.points.0 as usize,
            variables: found.into_iter().map(|one| one.variable).collect(),
            conditions,
            objectives,
            constraints: constraints.concat(),
            title,
            hash,
            warnings,
            notes: [self.base.notes()?, self.file_notes].concat(),
        })
    }

    fn variable(&mut self, spec: &Spanned<describe::Variable>) -> Option<ReadVariable> {
        let single = spec.key.value.iter().map(|key| (key.clone(), spec.key.origin));
        let several = spec.keys.value.iter().flatten().map(|key| (key.value.clone(), key.origin));
        let paths: Vec<(String, Origin)> = single.chain(several).collect();
        if spec.key.is_some() == spec.keys.is_some() || paths.is_empty() {
            let given = usize::from(spec.key.is_some()) + usize::from(spec.keys.is_some());
            self.errors.push(spec.origin, mistake::exactly_one("`key` and `keys`", given));
            return None;
        }
        let mut keys: Vec<Key> = paths.iter().map(|(path, _)| Key::plain(path)).collect();
        let mut origins: Vec<Origin> = paths.iter().map(|(_, origin)| *origin).collect();
        for (path, origin) in paths
            .iter()
            .map(|(path, origin)| (path, *origin))
            .chain(spec.compensated_by.iter().map(|path| (path, spec.compensated_by.origin)))
        {
            if let Some(wrong) = no_quantity(path, QUANTITY) {
                self.errors.push(origin, wrong);
                return None;
            }
        }
        let own = self.root.at(&paths[0].0).cloned();
        if let Some(compensating) = &spec.compensated_by.value {
            let sum =
                own.as_ref().and_then(Node::number).zip(self.root.at(compensating).and_then(Node::number));
            let Some((own, other)) = sum else {
                let both = [(compensating, spec.compensated_by.origin), (&paths[0].0, paths[0].1)];
                let wrong = both
                    .into_iter()
                    .find_map(|(path, origin)| Some((origin, self.base.wrong_path(path, origin)?)));
                let no_sum = || {
                    let wrong = format!(
                        "`{compensating}` and `{}` have no constant sum: both must be numbers in this scenario",
                        paths[0].0
                    );
                    Diagnostic::new(wrong)
                        .hint("give both keys a number; their sum then stays constant")
                        .into()
                };
                let (origin, problem) = wrong.unwrap_or_else(|| (spec.compensated_by.origin, no_sum()));
                self.errors.push(origin, problem);
                return None;
            };
            let count = paths.len() as f64;
            keys.push(Key { path: compensating.clone(), slope: -count, offset: other + count * own });
            origins.push(spec.compensated_by.origin);
        }
        let (range, ends) = self.range(spec)?;
        let own = own.and_then(|own| match &range {
            SearchRange::Bounds(from, to) => own.number().filter(|own| (*from..=*to).contains(own)),
            SearchRange::Choices(choices) => {
                let own = plain(&own.to_json());
                choices.iter().position(|choice| plain(choice) == own).map(|at| at as f64)
            }
        });
        let values = if spec.bounds.is_some() { spec.bounds.origin } else { spec.choices.origin };
        let variable = SearchVariable { name: paths[0].0.clone(), keys, range, own };
        Some(ReadVariable { variable, origins, values, ends })
    }

    fn range(&mut self, spec: &Spanned<describe::Variable>) -> Option<(SearchRange, Vec<(Origin, f64)>)> {
        match (&spec.bounds.value, &spec.choices.value) {
            (Some(bounds), None) => match bounds.as_slice() {
                [from, to] if from.0 < to.0 => {
                    Some((SearchRange::Bounds(from.0, to.0), vec![(from.origin, from.0), (to.origin, to.0)]))
                }
                [from, to] => {
                    self.errors.push(spec.bounds.origin, no_bounds(from.0, to.0));
                    None
                }
                _ => {
                    let wrong = mistake::another_length("the smallest and the largest value, as [0, 120]");
                    self.errors.push(spec.bounds.origin, wrong);
                    None
                }
            },
            (None, Some(choices)) => {
                if spec.compensated_by.is_some() {
                    self.errors
                        .push(spec.compensated_by.origin, mistake::not_with("compensated_by", "`choices`"));
                    return None;
                }
                let ends = choices.0.iter().enumerate().map(|(at, node)| (node.origin, at as f64));
                Some((SearchRange::Choices(choices.0.iter().map(Node::to_json).collect()), ends.collect()))
            }
            (bounds, choices) => {
                let given = usize::from(bounds.is_some()) + usize::from(choices.is_some());
                self.errors.push(spec.origin, mistake::exactly_one("`bounds` and `choices`", given));
                None
            }
        }
    }

    fn check_once(&mut self, found: &[ReadVariable]) {
        let all: Vec<(&str, Origin)> = found
            .iter()
            .flat_map(|one| {
                one.variable.keys.iter().map(|key| key.path.as_str()).zip(one.origins.iter().copied())
            })
            .collect();
        for (i, (path, origin)) in all.iter().enumerate() {
            let key = KeyPath::new(path);
            let before = || all[..i].iter().map(|(other, _)| KeyPath::new(other));
            if before().any(|other| other == key) {
                let wrong = Diagnostic::new(format!("more than one variable sets `{path}`"));
                self.errors
                    .push(*origin, wrong.expected("each key in one variable").hint("remove one of them"));
            } else if let Some(other) = before().find(|other| other.overlaps(&key)) {
                self.errors.push(*origin, mistake::overlapping(path, &other.present()));
            }
        }
    }

    fn check_names(&mut self, spec: &describe::Optimize) {
        for (i, condition) in spec.conditions.iter().enumerate() {
            if spec.conditions[..i].iter().any(|other| other.name.value == condition.name.value) {
                let wrong =
                    Diagnostic::new(format!("there are two conditions named `{}`", condition.name.value));
                self.errors.push(condition.name.origin, wrong);
            }
        }
    }

    fn conditions(&self, spec: &describe::Optimize, found: &[ReadVariable]) -> Vec<SearchCondition> {
        let keys = varied_keys(found);
        let condition = |name: &str, weight, fixed: &[Change]| SearchCondition {
            name: name.to_owned(),
            weight,
            varied: ParameterisedScenario::new(self.base.clone(), fixed.to_vec(), keys.clone()),
        };
        if spec.conditions.is_empty() {
            return vec![condition("", 1.0, &[])];
        }
        let described = spec.conditions.iter();
        described.map(|one| condition(&one.name.value, one.weight.0, &one.set.value.0)).collect()
    }

    /// Fails for the Monte Carlo solver, whose noise derivatives would follow.
    fn check_solver(&self, own: &Scene, wrong: &str, hint: &str) -> Result<(), ScenarioErrors> {
        let mut errors = Errors::default();
        if own.solver.method == Solver::MonteCarlo {
            let place = self.root.at("solver.method").map_or(self.root.origin, |node| node.origin);
            errors.push(place, Diagnostic::new(wrong).hint(hint));
        }
        errors.check(&self.base.sources)
    }

    /// Fails for a key that is a word in the scenario, and that accepts no number.
    fn check_numbers(
        &self,
        varied: &ParameterisedScenario,
        found: &[ReadVariable],
    ) -> Result<(), ScenarioErrors> {
        /// A number that each key which is a word or a number accepts, such as an index for a material.
        const ACCEPTED: f64 = 1.5;
        let mut errors = Errors::default();
        let numeric = found.iter().filter(|one| matches!(one.variable.range, SearchRange::Bounds(..)));
        for one in numeric {
            for (key, origin) in one.variable.keys.iter().zip(&one.origins) {
                let is_word = |node: &Node| matches!(node.to_json(), Json::String(_) | Json::Bool(_));
                if !self.root.at(&key.path).is_some_and(is_word) {
                    continue;
                }
                let accepts = |x: f64| {
                    let value = Node::from_json(&x.into(), *origin);
                    let change = Change { value, origin: *origin, path: KeyPath::new(&key.path) };
                    varied.with(std::iter::once(change)).and_then(|scenario| scenario.resolve()).is_ok()
                };
                if !one.ends.iter().map(|end| end.1).chain([ACCEPTED]).any(accepts) {
                    let wrong = Diagnostic::new(format!("`{}` is not a number", key.path));
                    errors.push(*origin, wrong.expected("a key with a number"));
                }
            }
        }
        errors.check(&self.base.sources)
    }

    /// Tests each bound and each choice, with all other variables at their starting points.
    fn check_ends(
        &self,
        varied: &ParameterisedScenario,
        found: &[ReadVariable],
    ) -> Result<(), ScenarioErrors> {
        for (i, one) in found.iter().enumerate() {
            for (origin, x) in &one.ends {
                let changes = found.iter().enumerate().flat_map(|(j, other)| {
                    let x = if i == j { *x } else { other.variable.start() };
                    let origins = other.origins.iter().map(move |at| if i == j { *origin } else { *at });
                    other.variable.values(x).into_iter().zip(origins)
                });
                let changes = changes.map(|((path, value), origin)| Change {
                    value: Node::from_json(&value, origin),
                    origin,
                    path: KeyPath::new(&path),
                });
                let tried = varied.with(changes).and_then(|scenario| scenario.resolve());
                tried.map_err(|errors| {
                    let errors = errors.asked_for_at(&self.base.sources.place(*origin));
                    errors.noted(|_| one.given(*x))
                })?;
            }
        }
        Ok(())
    }
}

/// Error: the lower bound is not below the upper one.
fn no_bounds(from: f64, to: f64) -> Diagnostic {
    let expected = "the smaller value first, and a larger one";
    if from == to {
        return Diagnostic::new(format!("both bounds are {from}"))
            .expected(expected)
            .hint("a key that does not vary is not a variable: remove it here, and set the key itself");
    }
    Diagnostic::new(format!("the first bound, {from}, is above the second, {to}")).expected(expected)
}

/// The resolved scenario of a condition, at the starting point.
pub(super) struct ConditionScene {
    pub(super) scene: Scene,
    pub(super) states: Vec<String>,
    hash: String,
    warnings: Vec<String>,
}

/// Resolves the scenario of a condition at the starting point.
fn condition_scene(
    varied: &ParameterisedScenario,
    found: &[ReadVariable],
) -> Result<ConditionScene, ScenarioErrors> {
    let resolved = at_start(varied, found)?.resolve()?;
    let states = resolved.scene.display.state_names();
    Ok(ConditionScene { scene: resolved.scene, states, hash: resolved.hash, warnings: resolved.warnings })
}

/// The hash of a condition at the starting point, with the picture of `[image]`.
fn hash_with_picture(
    varied: &ParameterisedScenario,
    found: &[ReadVariable],
) -> Result<String, ScenarioErrors> {
    Ok(at_start(varied, found)?.resolve_with_picture()?.hash)
}

/// The scenario of a condition at the starting point.
fn at_start(varied: &ParameterisedScenario, found: &[ReadVariable]) -> Result<Scenario, ScenarioErrors> {
    let values: Vec<Json> = found
        .iter()
        .flat_map(|one| one.variable.values(one.variable.start()).into_iter().map(|(_, value)| value))
        .collect();
    varied.scenario(&values)
}

/// Computes the hash of a search: of its description, its scenarios and their pictures.
fn hash(spec: &describe::Optimize, known: &[ConditionScene], pictured: &[String]) -> String {
    let mut digest = Sha256::new();
    digest.update(serde_json::to_string(spec).unwrap_or_default());
    known.iter().for_each(|known| digest.update(&known.hash));
    pictured.iter().for_each(|hash| digest.update(hash));
    hex(&digest.finalize())
}

/// Converts numbers to floats, so that equal values compare equal.
fn plain(value: &Json) -> Json {
    value.as_f64().map_or_else(|| value.clone(), Json::from)
}
