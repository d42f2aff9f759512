//! Sobol indices: contributions of keys to the variance of a metric.
//!
//! The *first-order* index of a key is the fraction of a metric's variance that vanishes on average if the
//! key is fixed and nothing else changes. The *total* index is the fraction that remains on average if only
//! this key varies, interactions with other keys included. The first-order indices of independent keys sum to
//! at most 1, and to 1 if there are no interactions. A total index of 0 means that the key has no effect.
//!
//! Correlated keys have no indices of their own, because their effects cannot be separated; their group has.
//!
//! # Method
//!
//! 1. A [polynomial chaos](super::surrogate) is fitted to all displays. Its own indices have closed forms.
//! 2. The residual is estimated from displays that share some of their keys ("pick-freeze"): every sum over
//!    displays is the sum of the metric, minus the sum of a fit to other replicates, plus the known expected
//!    value of the fit's sum (a control variate). This is unbiased, however good the fit is, and only the
//!    residual contributes to the errors. If a fit is of no use, the sums of the metric are used alone.
//! 3. First-order indices are the mean of two estimators, weighted by their errors: one is exact for a key
//!    without effect, the other for a key that causes all variance.
//! 4. All indices of a metric are moved to the nearest consistent ones, in units of their errors: see
//!    [`consistent`]. Standard errors are those before this step.
//!
//! Sources: first order A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), eq. 16, centred, and eq.
//! 17 (M. J. W. Jansen); total index M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999).

use schemars::JsonSchema;
use serde::Serialize;

use super::consistent::consistent;
use super::estimate::{Estimate, Sums, is_rounding, jackknife_error};
use super::plan::{Draw, Plan, REPLICATES, replicate};
use super::surrogate::{Basis, Fits, Term, Workspace};

/// Sobol indices of a group of keys: its contributions to a metric's variance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Indices {
    /// First-order index.
    pub first: Estimate,
    /// Total index, interactions with other groups included.
    pub total: Estimate,
}

/// Values of a metric for the displays of a plan; NaN where it is undefined.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// Values for each row's own display.
    pub own: Vec<f64>,
    /// Values for the second display of each row that has one: the first rows.
    pub other: Vec<f64>,
    /// Values for the mixed displays of the same rows, `[group][row]`: the group's keys are those of the
    /// second display.
    pub mixed: Vec<Vec<f64>>,
}

/// Sensitivities of a metric.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// Indices of each group of keys; `None` if the metric does not vary.
    pub indices: Vec<Option<Indices>>,
    /// Polynomial fit that they are based on; `None` if there is none, or the metric does not vary.
    pub surrogate: Option<Surrogate>,
}

/// Polynomial fit of a metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Surrogate {
    /// Number of products of polynomials, including the constant.
    pub terms: usize,
    /// Fraction of the variance that the fit does not explain, for displays to which it was not fitted.
    pub unexplained: f64,
}

/// Largest unexplained fraction of the variance of a fit that is used. Between and beyond the displays, a
/// worse fit may have any value.
const MOST_UNEXPLAINED: f64 = 0.1;

/// Smallest standard error of an index that uses a fit: moments of polynomials have errors of up to 1e-5. It is larger for fewer than
/// a thousand displays: beyond the outermost of n, with a probability of 1/n, a fit may be wrong by [`MOST_UNEXPLAINED`], and no
/// replicate shows it.
const LEAST_ERROR: f64 = 1e-4;

impl Sensitivities {
    /// Computes the sensitivities of several metrics of a plan's displays.
    pub fn of(plan: &Plan, metrics: &[Samples]) -> Vec<Self> {
        let rows = metrics.first().map_or(0, |one| one.own.len());
        let count = metrics.first().map_or(0, |one| one.other.len());
        let groups = plan.groups().len();
        if count == 0 {
            let none = || Self { indices: vec![None; groups], surrogate: None };
            return metrics.iter().map(|_| none()).collect();
        }
        let basis = Basis::new(plan, rows, count);
        let fits: Vec<Option<Fits>> = metrics.iter().map(|one| one.fit(&basis)).collect();
        let fitted = FittedSamples::of(plan, &basis, &fits, count);
        let each = metrics.iter().zip(&fits).enumerate().map(|(metric, (samples, fit))| {
            let group_indices = |group: usize| {
                let fit =
                    fit.as_ref().map(|fit| GroupFit { basis: &basis, fit, keys: &plan.groups()[group] });
                samples.indices(group, fit.map(|fit| (fit, &fitted.0[metric])))
            };
            let indices: Vec<Option<Indices>> = (0..groups).map(group_indices).collect();
            let fit = fit.as_ref().filter(|_| indices.iter().any(Option::is_some));
            let surrogate = fit.map(|fit| Surrogate { terms: fit.terms(), unexplained: fit.unexplained });
            Self { indices: consistent(indices), surrogate }
        });
        each.collect()
    }
}

/// Fit of a metric, and a group of keys.
#[derive(Clone, Copy)]
struct GroupFit<'a> {
    basis: &'a Basis,
    fit: &'a Fits,
    keys: &'a [usize],
}

impl GroupFit<'_> {
    /// Mean and variance of a replicate's fit, and the variances that the group causes alone and with
    /// interactions.
    fn moments(&self, replicate: usize) -> [f64; 4] {
        let mean = self.basis.mean(self.fit, replicate);
        let part = |counts: &dyn Fn(&Term) -> bool| self.basis.variance(self.fit, replicate, counts);
        let is_in_group = |(key, _): &(usize, usize)| self.keys.contains(key);
        [
            mean,
            part(&|_| true),
            part(&|term| term.iter().all(is_in_group)),
            part(&|term| term.iter().any(is_in_group)),
        ]
    }

    /// Least standard errors of the first-order and the total index: those of the fit itself, which was fitted to this many displays.
    /// Each replicate's fit is that of all others, so that the spread of their indices is a jackknife.
    fn errors(&self, displays: usize) -> [f64; 2] {
        let moments: Vec<[f64; 4]> = (0..REPLICATES).map(|replicate| self.moments(replicate)).collect();
        let least = LEAST_ERROR.max(MOST_UNEXPLAINED / displays as f64);
        [2, 3].map(|part| jackknife_error(moments.iter().map(|one| one[part] / one[1])).max(least))
    }
}

/// Values of the fits for all displays, `[metric]`; empty for a metric without a fit.
struct FittedSamples(Vec<Samples>);

impl FittedSamples {
    fn of(plan: &Plan, basis: &Basis, fits: &[Option<Fits>], count: usize) -> Self {
        let groups = plan.groups().len();
        let empty = Samples { own: vec![], other: vec![], mixed: vec![vec![]; groups] };
        let mut all = vec![empty; fits.len()];
        let known: Vec<&Fits> = fits.iter().flatten().collect();
        let mut workspace = Workspace::default();
        if known.is_empty() {
            return Self(all);
        }
        for row in 0..count {
            for draw in [Draw::Own, Draw::Other].into_iter().chain((0..groups).map(Draw::Mixed)) {
                basis.evaluate(plan, &known, row, draw, &mut workspace);
                let fitted = all.iter_mut().zip(fits).filter(|(_, fit)| fit.is_some());
                for ((samples, _), value) in fitted.zip(&workspace.values_of_fits) {
                    match draw {
                        Draw::Own => samples.own.push(*value),
                        Draw::Other => samples.other.push(*value),
                        Draw::Mixed(group) => samples.mixed[group].push(*value),
                    }
                }
            }
        }
        Self(all)
    }
}

/// Number of sums over rows: the metric, its square, the terms of the estimators of the group's variance, and
/// the count.
const TERMS: usize = 7;

impl Samples {
    /// Fits polynomials to all displays; `None` if the metric is undefined for one of them, or the fit is of
    /// no use.
    fn fit(&self, basis: &Basis) -> Option<Fits> {
        let undefined = |values: &Vec<f64>| values.iter().any(|value| !value.is_finite());
        if [&self.own, &self.other].into_iter().chain(&self.mixed).any(undefined) {
            return None;
        }
        let value = |row: usize, draw: Draw| match draw {
            Draw::Own => self.own[row],
            Draw::Other => self.other[row],
            Draw::Mixed(group) => self.mixed[group][row],
        };
        basis.fit(value).filter(|fit| fit.terms() > 1 && fit.unexplained <= MOST_UNEXPLAINED)
    }

    /// Number of displays.
    fn displays(&self) -> usize {
        self.own.len() + (1 + self.mixed.len()) * self.other.len()
    }

    /// Values of a row for its own display, the second one, and the one with a group mixed in from the
    /// second.
    fn row(&self, group: usize, row: usize) -> [f64; 3] {
        [self.own[row], self.other[row], self.mixed[group][row]]
    }

    /// Indices of a group; `None` if the metric does not vary.
    fn indices(&self, group: usize, fitted: Option<(GroupFit<'_>, &Self)>) -> Option<Indices> {
        let rows = (0..self.other.len()).map(|row| (row, self.row(group, row)));
        let known: Vec<(usize, [f64; 3])> =
            rows.filter(|(_, row)| row.iter().all(|value| !value.is_nan())).collect();
        let centre = known.iter().map(|(_, [a, b, _])| 0.5 * (a + b)).sum::<f64>() / known.len() as f64;
        let plain =
            Estimators(Sums::of(known.iter().map(|(row, values)| (replicate(*row), terms(*values, centre)))));
        if known.is_empty() || is_rounding(centre, plain.variance(None)) {
            return None;
        }
        let controlled = fitted.map(|(fit, fitted)| {
            let expected_terms: Vec<[f64; TERMS]> =
                (0..REPLICATES).map(|replicate| expected(fit.moments(replicate), centre)).collect();
            let sums = Sums::of(known.iter().map(|(row, values)| {
                let [own, fit] = [*values, fitted.row(group, *row)].map(|values| terms(values, centre));
                let expected = expected_terms[replicate(*row)];
                let mut sum = [1.0; TERMS];
                (0..TERMS - 1).for_each(|k| sum[k] = own[k] - fit[k] + expected[k]);
                (replicate(*row), sum)
            }));
            (Estimators(sums), fit.errors(self.displays()))
        });
        // The sums are uncertain by at least one row: no replicate may contain any of the rare events.
        let far =
            known.iter().flat_map(|(_, row)| row).map(|value| (value - centre).powi(2)).fold(0.0, f64::max);
        let one_row = far / known.len() as f64 / plain.variance(None);
        let is_inert = known.iter().all(|(_, [a, _, m])| a == m);
        let is_alone = known.iter().all(|(_, [_, b, m])| b == m);
        Some(IndexEstimates { plain, controlled, one_row, is_inert, is_alone }.indices())
    }
}

/// Estimators of a group's indices, from the metric alone and with a fit as control variate.
struct IndexEstimates {
    plain: Estimators,
    /// The latter, and the least errors of the first-order and the total index: those of the fit itself.
    controlled: Option<(Estimators, [f64; 2])>,
    /// Change of an index by one row.
    one_row: f64,
    /// True if the group has no effect in any row.
    is_inert: bool,
    /// True if no other group has an effect in any row.
    is_alone: bool,
}

impl IndexEstimates {
    /// Returns the better estimators for an index, and their standard error. `is_certain` is true if the rows
    /// determine the index exactly.
    fn better(
        &self,
        of: fn(&Estimators, Option<usize>) -> f64,
        order: usize,
        is_certain: bool,
    ) -> (&Estimators, f64) {
        let error = |all: &Estimators| Estimate::jackknife(|left_out| of(all, left_out)).standard_error;
        let plain = error(&self.plain).max(if is_certain { 0.0 } else { self.one_row });
        // A fit that is of no use adds its own errors. Selecting the smaller of two uncertain errors would be
        // biased.
        match self.controlled.as_ref().map(|(all, errors)| (all, error(all).max(errors[order]))) {
            Some((all, controlled)) if plain >= 0.5 * controlled => (all, controlled),
            _ => (&self.plain, plain),
        }
    }

    fn indices(&self) -> Indices {
        let (weak, weak_error) = self.better(Estimators::first_of_weak_group, 0, self.is_inert);
        let (strong, strong_error) = self.better(Estimators::first_of_strong_group, 0, self.is_alone);
        let (all, all_error) = self.better(Estimators::total, 1, self.is_inert);
        let [weak_variance, strong_variance] = [weak_error, strong_error].map(|error| error * error);
        // An estimator without error receives the full weight.
        let weight = strong_variance / (weak_variance + strong_variance).max(f64::MIN_POSITIVE);
        let mut first = Estimate::jackknife(|left_out| {
            weight * weak.first_of_weak_group(left_out)
                + (1.0 - weight) * strong.first_of_strong_group(left_out)
        });
        let mut total = Estimate::jackknife(|left_out| all.total(left_out));
        // The mean of two estimators is at best as accurate as that of independent ones. The error of a fit is common to both.
        let of_fit = self
            .controlled
            .as_ref()
            .filter(|(fitted, _)| std::ptr::eq(weak, fitted) || std::ptr::eq(strong, fitted));
        let independent = weak_error.min(strong_error) * std::f64::consts::FRAC_1_SQRT_2;
        let least = of_fit.map_or(independent, |(_, errors)| independent.max(errors[0]));
        first.standard_error = first.standard_error.max(least);
        total.standard_error = total.standard_error.max(all_error);
        Indices { first, total }
    }
}

/// Terms of a row from the values of its own, the second and the mixed display, relative to a centre.
fn terms(values: [f64; 3], centre: f64) -> [f64; TERMS] {
    let [a, b, m] = values.map(|value| value - centre);
    let halved = |difference: f64| 0.5 * difference * difference;
    [0.5 * (a + b), 0.5 * (a * a + b * b), b * (m - a), m - a, halved(b - m), halved(m - a), 1.0]
}

/// Expected values of [`terms`] for a fit with known moments.
fn expected([mean, variance, own, shared]: [f64; 4], centre: f64) -> [f64; TERMS] {
    let mean = mean - centre;
    [mean, variance + mean * mean, own, 0.0, variance - own, shared, 1.0]
}

/// Estimators of indices from sums of [`terms`] over all replicates, or over all but one.
struct Estimators(Sums<TERMS>);

impl Estimators {
    fn variance(&self, left_out: Option<usize>) -> f64 {
        let [sum, squares, .., count] = self.0.without(left_out);
        squares / count - (sum / count).powi(2)
    }

    /// First-order index; exact for a group without effect.
    fn first_of_weak_group(&self, left_out: Option<usize>) -> f64 {
        let [sum, _, product, change, .., count] = self.0.without(left_out);
        (product - sum * change / count) / count / self.variance(left_out)
    }

    /// First-order index; exact for a group that causes all variance.
    fn first_of_strong_group(&self, left_out: Option<usize>) -> f64 {
        let [.., halved, _, count] = self.0.without(left_out);
        1.0 - halved / count / self.variance(left_out)
    }

    fn total(&self, left_out: Option<usize>) -> f64 {
        let [.., halved, count] = self.0.without(left_out);
        halved / count / self.variance(left_out)
    }
}
