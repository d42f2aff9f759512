//! Notes on the result of a fit: what a user must know before using its numbers.

use papilio_scenario::FitTarget;

use super::bounded::step;
use super::levenberg_marquardt::{Minimum, dot};
use super::model::{Unit, counted};
use super::report::{FittedVariable, Runs, Starts};
use super::run::Fitting;
use super::statistics::leverages;
use super::undetermined::determined;

/// Standard deviations of chi-square above its degrees of freedom, and its ratio to them, beyond which the model is noted not to
/// describe the data.
const FAR_ABOVE: f64 = 6.0;
const TIMES: f64 = 3.0;
/// Standard deviations of a prior beyond which a value does not agree with it.
const FAR_FROM_PRIOR: f64 = 4.0;
/// Degrees of freedom below which residuals do not determine their standard deviation.
const LEAST_FREEDOM: f64 = 0.5;
/// Chi-square over the degrees of freedom below which residuals are too small for the stated errors to be too small.
const SMALL: f64 = 0.25;
/// Runs that are fewer than this, in standard deviations, are noted.
const FEW_RUNS: f64 = -3.0;

impl Fitting<'_> {
    /// Remarks on the result.
    pub(super) fn remarks(
        &self,
        best: &Minimum,
        fitted: &[FittedVariable],
        runs: &Option<Runs>,
        starts: Starts,
    ) -> Vec<String> {
        let of_data = &best.residuals[..self.model.observations.len().min(best.residuals.len())];
        let is_small = dot(of_data, of_data) < SMALL * self.degrees_of_freedom().max(1) as f64;
        let systematic = runs.filter(|runs| runs.z < FEW_RUNS && !is_small).map(|runs| {
            format!(
                "the residuals have {} runs of one sign, independent errors have {:.0} (z = {:.1}): the model or the measurement differs \
                 systematically, and the intervals are too narrow",
                runs.count, runs.expected, runs.z
            )
        });
        let lonely = (starts.best == 1 && starts.count > 2).then(|| {
            format!(
                "only one of {} starts has found this minimum: use more starts (fit.starts) or narrower bounds",
                starts.count
            )
        });
        let outside = self.spec.variables.iter().filter_map(|one| {
            let own = one.own.filter(|own| !(one.bounds[0]..=one.bounds[1]).contains(own))?;
            Some(format!("{}: the scenario's own value, {own}, is outside the bounds", one.name))
        });
        let all = outside.chain(self.misfit(best)).chain(systematic).chain(lonely);
        all.chain(cuts(fitted)).chain(self.dropped()).chain(self.of_meter(fitted)).collect()
    }

    /// Warning of numbers without a stated standard deviation that leave no degree of freedom to determine one.
    pub(super) fn without_weights(&self, best: &Minimum) -> Option<String> {
        let leverages = leverages(&best.jacobian, &determined(&best.jacobian).covariance);
        let of = |unit: Unit| -> (usize, f64) {
            let all = self.model.observations.iter().zip(&leverages);
            let unstated = all.filter(|(one, _)| one.standard_deviation.is_none() && one.unit() == unit);
            unstated.fold((0, 0.0), |(count, freedom), (_, leverage)| (count + 1, freedom + 1.0 - leverage))
        };
        let too_few = [Unit::Fraction, Unit::Lab].map(of).into_iter();
        let count: usize =
            too_few.filter(|(_, freedom)| *freedom < LEAST_FREEDOM).map(|(count, _)| count).sum();
        (count > 0).then(|| {
            let (numbers, _) = counted(count, "measured number", "measured numbers");
            let (variables, _) = counted(self.spec.variables.len(), "variable", "variables");
            let them = if count == 1 { "counts" } else { "count" };
            format!(
                "{numbers} without a standard deviation {them} as exact, because {variables} leave no residuals from which it follows: \
                 the intervals are too narrow (a column standard_deviation states it)"
            )
        })
    }

    /// Remark on a chi-square far above its degrees of freedom, where all standard deviations are stated.
    fn misfit(&self, best: &Minimum) -> Option<String> {
        let freedom = self.degrees_of_freedom().max(0);
        let some = freedom.max(1) as f64;
        let most = (some + FAR_ABOVE * (2.0 * some).sqrt()).max(TIMES * some);
        let is_stated = !self.has_unstated(Unit::Fraction) && !self.has_unstated(Unit::Lab);
        if !is_stated {
            return self.far_from_its_prior(best);
        }
        if best.chi_square <= most {
            return None;
        }
        let (of_freedom, _) = counted(freedom as usize, "degree of freedom", "degrees of freedom");
        let prior = self.prior_against_the_data(best).unwrap_or_default();
        let chi_square = in_short(best.chi_square);
        Some(format!(
            "chi-square, {chi_square}, is far above {of_freedom}: the model does not describe the data within the stated standard deviations, and \
             the intervals are too narrow{prior}"
        ))
    }

    /// Remark on the value that is farthest from the mean of its prior, where the errors of the data follow from their residuals.
    fn far_from_its_prior(&self, best: &Minimum) -> Option<String> {
        let priors = self.spec.variables.iter().filter_map(|one| Some((one.name.as_str(), one.prior?)));
        let away = priors.zip(best.residuals.iter().skip(self.model.observations.len()));
        let ((name, [mean, sigma]), away) = away.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        (away.abs() > FAR_FROM_PRIOR).then(|| {
            format!(
                "{name} is {:.1} standard deviations of its prior, {mean} +- {sigma}, from the mean: the data do not agree with it",
                away.abs()
            )
        })
    }

    /// The prior without which chi-square would fall most, if that is by most of it.
    fn prior_against_the_data(&self, best: &Minimum) -> Option<String> {
        let priors = self.spec.variables.iter().filter_map(|one| Some((one.name.as_str(), one.prior?)));
        let first = self.model.observations.len();
        let without = priors.enumerate().filter_map(|(row, prior)| {
            let row = first + row;
            let cut = |all: &[f64]| {
                all.iter().enumerate().filter(|(at, _)| *at != row).map(|(_, one)| *one).collect::<Vec<f64>>()
            };
            let jacobian: Vec<Vec<f64>> = best.jacobian.iter().map(|column| cut(column)).collect();
            let mut moved = cut(&best.residuals);
            let held = vec![false; best.point.len()];
            let step = step(&jacobian, &moved, &best.point, &held, 1e-8)?;
            for (column, by) in jacobian.iter().zip(&step) {
                moved.iter_mut().zip(column).for_each(|(residual, slope)| *residual += slope * by);
            }
            Some((dot(&moved, &moved), prior))
        });
        let (least, (name, [mean, sigma])) = without.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (least < 0.5 * best.chi_square).then(|| {
            format!(
                "; it would be about {} without the prior of {name}, {mean} +- {sigma}, with which the data do not agree",
                in_short(least)
            )
        })
    }

    /// Remark on measured numbers that are not used because of the offset.
    fn dropped(&self) -> Option<String> {
        let dropped = self.model.dropped;
        (dropped > 0).then(|| {
            let (numbers, are) = counted(dropped, "number", "numbers");
            format!(
                "BIC and chi-square are of {} numbers; {numbers} {are} not used because of the bounds of meter.wavelength_offset_nm: BIC can only be \
                 compared with that of a fit to the same numbers",
                self.model.observations.len()
            )
        })
    }

    /// Remark on numbers of the meter, which the fitted scenario cannot have.
    fn of_meter(&self, fitted: &[FittedVariable]) -> Option<String> {
        let of_meter = self.spec.variables.iter().zip(fitted);
        let of_meter = of_meter.filter(|(one, _)| !matches!(one.target, FitTarget::Keys(_)));
        let names: Vec<&str> = of_meter.map(|(one, _)| one.name.as_str()).collect();
        (!names.is_empty()).then(|| {
            format!(
                "{} in fitted.toml only as comments: `papilio compare` of fitted.toml with these data does not apply them; fit.csv has the \
                 residuals",
                match names.as_slice() {
                    [one] => format!("{one} is"),
                    several => format!("{} are", several.join(" and ")),
                }
            )
        })
    }
}

/// Remarks on intervals that bounds have cut: one for the bounds of each variable.
fn cuts(fitted: &[FittedVariable]) -> Vec<String> {
    let remark = |bounded: &FittedVariable| {
        let key = &bounded.key;
        let cut: Vec<&FittedVariable> = fitted.iter().filter(|one| one.cut_by.contains(key)).collect();
        let others: Vec<&str> = cut.iter().map(|one| one.key.as_str()).filter(|other| other != key).collect();
        let is_own = cut.len() > others.len() && !bounded.at_bound;
        let by_prior = bounded.prior.filter(|_| is_own).map_or("", |_| ", within its prior");
        let of_others = match others.as_slice() {
            [one] => format!(
                "the interval of {one} ends where {key} is at its bounds: the data determine only both together"
            ),
            several => format!(
                "the intervals of {} end where {key} is at its bounds: the data determine them only together with it",
                several.join(", ")
            ),
        };
        match (is_own, others.is_empty()) {
            (false, true) => None,
            (false, false) => Some(of_others),
            (true, true) => Some(format!("the interval of {key} ends at its bounds{by_prior}")),
            (true, false) => Some(format!("the interval of {key} ends at its bounds{by_prior}; {of_others}")),
        }
    };
    fitted.iter().filter_map(remark).collect()
}

/// A chi-square in a sentence.
fn in_short(chi_square: f64) -> String {
    match chi_square < 1e7 {
        true => format!("{chi_square:.0}"),
        false => format!("{chi_square:.2e}"),
    }
}
