//! Keys of `[tolerance]`: distributions about the values of the scenario.

use papilio_diagnostics::Diagnostic;
use papilio_sampling::Distribution;
use serde_json::Value;

use crate::describe::sweep::Any;
use crate::describe::tolerance::{Bins, LogNormal, Normal, Scattered, Triangular, Uniform};
use crate::error::Errors;
use crate::mistake::{self, Mistake};
use crate::origin::Origin;
use crate::path::KeyPath;
use crate::read::Spanned;
use crate::tolerance::ScatteredKey;
use crate::varied::{ParsedScenario, QUANTITY, no_quantity};

const KINDS: &str = "`normal`, `lognormal`, `uniform`, `triangular` and `choices`";

/// Evaluates a key with its distribution; `filled` is the scenario of `base` with its defaults.
pub(crate) fn scattered(
    key: &Spanned<Scattered>,
    base: &ParsedScenario,
    filled: &Value,
    errors: &mut Errors,
) -> Option<ScatteredKey> {
    let paths: Vec<(&str, Origin)> = match (&key.key.value, &key.keys.value) {
        (Some(path), None) => vec![(path, key.key.origin)],
        (None, Some(paths)) if !paths.is_empty() => {
            paths.iter().map(|path| (path.as_str(), path.origin)).collect()
        }
        (None, Some(_)) => {
            errors.push(key.keys.origin, mistake::empty_list());
            return None;
        }
        (one, other) => {
            let given = usize::from(one.is_some()) + usize::from(other.is_some());
            errors.push(key.origin, mistake::exactly_one("`key` and `keys`", given));
            return None;
        }
    };
    let settings = paths.iter().filter_map(|(path, origin)| Some((*origin, no_quantity(path, QUANTITY)?)));
    let settings: Vec<_> = settings.collect();
    if !settings.is_empty() {
        settings.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
        return None;
    }
    let values: Vec<Option<f64>> = paths.iter().map(|(path, _)| number_at(filled, path)).collect();
    let absent = paths.iter().zip(&values).filter(|(_, values)| values.is_none());
    let wrong = absent.filter_map(|((path, origin), _)| Some((*origin, base.wrong_path(path, *origin)?)));
    let wrong: Vec<(Origin, Mistake)> = wrong.collect();
    if !wrong.is_empty() {
        wrong.into_iter().for_each(|(origin, problem)| errors.push(origin, problem));
        return None;
    }
    if *key.relative && key.choices.is_some() {
        let wrong = mistake::not_with("relative = true", "choices");
        errors.push(
            key.relative.origin,
            wrong.hint("choices are values of the key: multiply them yourself, and remove `relative`"),
        );
        return None;
    }
    let centre = Centre::of(*key.relative, &values);
    let distribution = distribution(key, &centre, errors);
    // The key's own value is needed only where the numbers are relative to it, or deviations from it.
    let moved = paths.iter().zip(&values).map(|((path, origin), values)| {
        let is_deviation = *key.relative || paths.len() > 1;
        match (values, &key.choices.value) {
            (_, Some(_)) => Some(((*path).to_owned(), 1.0, 0.0)),
            (Some(value), None) if *key.relative => Some(((*path).to_owned(), *value, 0.0)),
            (Some(value), None) if is_deviation => Some(((*path).to_owned(), 1.0, *value)),
            (_, None) if !is_deviation => Some(((*path).to_owned(), 1.0, 0.0)),
            (..) => {
                errors.push(*origin, no_number(path));
                None
            }
        }
    });
    let moved: Option<Vec<_>> = moved.collect::<Vec<_>>().into_iter().collect();
    let name = key.name.as_ref().map_or_else(|| paths[0].0.to_owned(), |name| name.0.clone());
    let choices = key.choices.iter().flat_map(|bins| bins.values.iter().map(|value| value.0.to_json()));
    Some(ScatteredKey { name, paths: moved?, distribution: distribution?, choices: choices.collect() })
}

/// Returns the number at a path of the scenario with its defaults.
fn number_at(filled: &Value, path: &str) -> Option<f64> {
    KeyPath::new(path).in_json(filled)?.as_f64()
}

/// Error: the scenario has no number as the centre of a distribution.
fn no_number(path: &str) -> Diagnostic {
    Diagnostic::new(format!("the scenario has no number at `{path}`")).hint(
        "give the centre (`mean`, `median`, `mode`, or `from` and `to`); with several keys, each needs a number",
    )
}

/// Centre of a distribution that does not specify one.
struct Centre(Option<f64>);

impl Centre {
    fn of(relative: bool, values: &[Option<f64>]) -> Self {
        Self(match values {
            _ if relative => Some(1.0),
            [one] => *one,
            _ => Some(0.0),
        })
    }

    /// Returns the specified centre, or else the value of the key.
    fn or(&self, given: &Spanned<Option<Any>>, key: &Spanned<Scattered>, errors: &mut Errors) -> Option<f64> {
        let centre = given.value.map(|one| one.0).or(self.0);
        if centre.is_none() {
            errors.push(key.key.origin, no_number(key.key.as_deref().unwrap_or_default()));
        }
        centre
    }
}

fn distribution(key: &Spanned<Scattered>, centre: &Centre, errors: &mut Errors) -> Option<Distribution> {
    let given = [
        key.normal.value.as_ref().map(|one| normal(one, centre.or(&one.mean, key, errors)?, errors)),
        key.lognormal.value.as_ref().map(|one| lognormal(one, centre.or(&one.median, key, errors)?, errors)),
        key.uniform.value.as_ref().map(|one| uniform(one, key.uniform.origin, centre, key, errors)),
        key.triangular
            .value
            .as_ref()
            .map(|one| triangular(one, key.triangular.origin, centre.or(&one.mode, key, errors)?, errors)),
        key.choices.value.as_ref().map(|one| bins(one, errors)),
    ];
    let mut given: Vec<Option<Distribution>> = given.into_iter().flatten().collect();
    match given.len() {
        1 => given.remove(0),
        count => {
            errors.push(key.origin, mistake::exactly_one(KINDS, count));
            None
        }
    }
}

/// Returns the ends of a range that is not empty.
fn ends(
    from: &Spanned<Option<Any>>,
    to: &Spanned<Option<Any>>,
    widest: [f64; 2],
    errors: &mut Errors,
) -> Option<[f64; 2]> {
    let [low, high] = [from.value.map_or(widest[0], |one| one.0), to.value.map_or(widest[1], |one| one.0)];
    if low < high {
        return Some([low, high]);
    }
    errors.push(to.origin.max(from.origin), mistake::empty_range(low, high));
    None
}

/// Standard deviations from the centre beyond which a truncated distribution has no part: 3e-7 of all displays.
const FARTHEST: f64 = 5.0;

/// Refuses ends, in standard deviations from the centre, that exclude practically all displays.
fn check_near(
    ends: [f64; 2],
    (centre, value): (&str, f64),
    place: Origin,
    errors: &mut Errors,
) -> Option<()> {
    if ends[0] <= FARTHEST && ends[1] >= -FARTHEST {
        return Some(());
    }
    let wrong =
        format!("`from` and `to` exclude practically all displays: the {centre}, {value}, is far outside");
    let hint = "they are values of the key, and factors of its value with relative = true, not differences";
    errors.push(place, Diagnostic::new(wrong).hint(hint));
    None
}

fn normal(one: &Normal, mean: f64, errors: &mut Errors) -> Option<Distribution> {
    let within = ends(&one.from, &one.to, [f64::NEG_INFINITY, f64::INFINITY], errors)?;
    let far = within.map(|end| (end - mean) / one.sigma.0);
    check_near(far, ("mean", mean), one.to.origin.max(one.from.origin), errors)?;
    Some(Distribution::Normal { mean, sigma: one.sigma.0, within })
}

fn lognormal(one: &LogNormal, median: f64, errors: &mut Errors) -> Option<Distribution> {
    let within = ends(&one.from, &one.to, [0.0, f64::INFINITY], errors)?;
    if median <= 0.0 {
        errors.push(
            one.median.origin,
            Diagnostic::new(format!("{median} has no logarithm")).expected("a number above 0"),
        );
        return None;
    }
    let far = within.map(|end| (end / median).ln() / one.sigma.0);
    check_near(far, ("median", median), one.to.origin.max(one.from.origin), errors)?;
    Some(Distribution::LogNormal { median, sigma: one.sigma.0, within })
}

fn uniform(
    one: &Uniform,
    place: Origin,
    centre: &Centre,
    key: &Spanned<Scattered>,
    errors: &mut Errors,
) -> Option<Distribution> {
    let [from, to] = match (one.from.value, one.to.value, one.plus_minus.value) {
        (Some(_), Some(_), None) => ends(&one.from, &one.to, [0.0; 2], errors)?,
        (None, None, Some(half)) => {
            let centre = centre.or(&Spanned::without_span(None), key, errors)?;
            [centre - half.0, centre + half.0]
        }
        _ => return range_or_half(place, one.plus_minus.is_some(), errors),
    };
    Some(Distribution::Uniform { from, to })
}

fn triangular(one: &Triangular, place: Origin, mode: f64, errors: &mut Errors) -> Option<Distribution> {
    let [from, to] = match (one.from.value, one.to.value, one.plus_minus.value) {
        (Some(_), Some(_), None) => ends(&one.from, &one.to, [0.0; 2], errors)?,
        (None, None, Some(half)) => [mode - half.0, mode + half.0],
        _ => return range_or_half(place, one.plus_minus.is_some(), errors),
    };
    if (from..=to).contains(&mode) {
        return Some(Distribution::Triangular { from, mode, to });
    }
    let wrong = |what: &str| {
        Diagnostic::new(format!("{what}, {mode}, is outside the range from {from} to {to}"))
            .expected(format!("a number from {from} to {to}"))
    };
    match one.mode.is_some() {
        true => errors.push(
            one.mode.origin,
            wrong("the mode").hint("`from` and `to` are the ends of the distribution"),
        ),
        false => {
            let hint = "without `mode`, the scenario's value is the mode (several keys: a deviation of 0; relative: the factor 1)";
            errors.push(place, wrong("the mode, the scenario's value").hint(hint));
        }
    }
    None
}

fn range_or_half<T>(place: Origin, half: bool, errors: &mut Errors) -> Option<T> {
    let given = if half { 2 } else { 0 };
    errors.push(place, mistake::exactly_one("{ from, to } and { plus_minus }", given));
    None
}

fn bins(one: &Bins, errors: &mut Errors) -> Option<Distribution> {
    let count = one.values.len();
    if count == 0 {
        errors.push(one.values.origin, mistake::empty_list());
        return None;
    }
    let weights: Vec<f64> = match &one.weights.value {
        Some(weights) => weights.iter().map(|weight| weight.0).collect(),
        None => vec![1.0; count],
    };
    if weights.len() == count && weights.iter().sum::<f64>() > 0.0 {
        return Some(Distribution::Choices { weights });
    }
    let wrong = Diagnostic::new(match weights.len() == count {
        true => "all weights are 0".to_owned(),
        false => format!("there are {} weights for {count} values", weights.len()),
    });
    errors.push(one.weights.origin, wrong.expected(format!("{count} weights, not all 0")));
    None
}
