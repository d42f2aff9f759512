//! Which keys are to blame: Sobol indices of variance.
//!
//! The *first-order* index of a key is the share of a metric's variance that would be gone if the key did not
//! scatter and nothing else changed, on average; the *total* index is the share that would be left if nothing but the key
//! scattered, interactions with other keys included. Of independent keys, the first-order indices sum to 1 at most,
//! and to 1 where keys act one by one; a total index of 0 means that the key makes no difference.
//!
//! Correlated keys have no indices of their own: what each of them does cannot be told apart. Their group has.
//!
//! # How they are found
//!
//! 1. A [polynomial chaos](super::surrogate) is fitted to all displays. Its own indices have closed forms.
//! 2. What it leaves over is estimated from displays that share some of their keys ("pick-freeze"): every sum over displays is that
//!    of the metric less that of the fit, which was made of other replicates, plus what the fit's is known to be. That
//!    is right on average whatever the fit is worth, and its errors are those of the remainder alone. Where a fit is of no use the
//!    sums of the metric stand alone.
//! 3. First-order indices are the mean, weighted by their errors, of two estimators: one is exact for a key that does
//!    nothing, the other for a key that does all.
//! 4. All indices of a metric are moved to the nearest that there can be, in units of their errors: see [`consistent`]. Errors stay those
//!    from before that.
//!
//! Sources: first order A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), eq. 16, centred, and eq. 17 (M. J. W.
//! Jansen); total index M. J. W. Jansen, Comput. Phys. Commun. 117, 35 (1999).

use serde::Serialize;

use super::consistent::consistent;
use super::estimate::{Estimate, Sums};
use super::plan::{Draw, Plan, replicate};
use super::surrogate::{Basis, Fits, Room, Term};

/// How much of a metric's variance comes from a group of keys.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Indices {
    /// By itself.
    pub first: Estimate,
    /// With all that it does together with others.
    pub total: Estimate,
}

/// What a metric is at the displays of a plan; NaN where it is undefined.
#[derive(Debug, Clone, PartialEq)]
pub struct Samples {
    /// At each row's own display.
    pub own: Vec<f64>,
    /// At the other display of each row that has one: the first rows.
    pub other: Vec<f64>,
    /// For each group of keys, at the display that has it from the other, of the same rows.
    pub mixed: Vec<Vec<f64>>,
}

/// A metric's sensitivities.
#[derive(Debug, Clone, PartialEq)]
pub struct Sensitivities {
    /// For each group of keys; `None` where the metric does not scatter.
    pub indices: Vec<Option<Indices>>,
    /// The fit that they rest on; `None` where there is none.
    pub surrogate: Option<Surrogate>,
}

/// The polynomials that stand for a metric.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Surrogate {
    /// How many products of polynomials there are, the constant included.
    pub terms: usize,
    /// The share of the variance that they leave unexplained, in displays that they were not fitted to.
    pub unexplained: f64,
}

/// Fits that leave more of the variance unexplained are not used: between and beyond the displays they may be anything.
const MOST_UNEXPLAINED: f64 = 0.1;

/// What a fit adds in error at least: moments of polynomials are known to 1e-5, and what they are beyond the outermost of the displays is not
/// seen by any error that comes from these.
const LEAST_ERROR: f64 = 1e-4;

impl Sensitivities {
    /// Of several metrics of a plan's displays.
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
        let said = Said::of(plan, &basis, &fits, count);
        let each = metrics.iter().zip(&fits).enumerate().map(|(metric, (samples, fit))| {
            let of_group = |group: usize| {
                let parts = fit.as_ref().map(|fit| Parts { basis: &basis, fit, keys: &plan.groups()[group] });
                samples.indices(group, parts.map(|parts| (parts, &said.0[metric])))
            };
            let surrogate =
                fit.as_ref().map(|fit| Surrogate { terms: fit.terms(), unexplained: fit.unexplained });
            Self { indices: consistent((0..groups).map(of_group).collect()), surrogate }
        });
        each.collect()
    }
}

/// A fit, and a group of keys.
#[derive(Clone, Copy)]
struct Parts<'a> {
    basis: &'a Basis,
    fit: &'a Fits,
    keys: &'a [usize],
}

impl Parts<'_> {
    /// Mean; variance; what comes from the group by itself and with others; of a replicate's fit.
    fn of(&self, replicate: usize) -> [f64; 4] {
        let mean = self.basis.mean(self.fit, replicate);
        let part = |counts: &dyn Fn(&Term) -> bool| self.basis.variance(self.fit, replicate, counts);
        let is_here = |(key, _): &(usize, usize)| self.keys.contains(key);
        [
            mean,
            part(&|_| true),
            part(&|term| term.iter().all(is_here)),
            part(&|term| term.iter().any(is_here)),
        ]
    }
}

/// What fits say of all displays: `[metric]`, as the metrics' own samples; empty without a fit.
struct Said(Vec<Samples>);

impl Said {
    fn of(plan: &Plan, basis: &Basis, fits: &[Option<Fits>], count: usize) -> Self {
        let groups = plan.groups().len();
        let empty = Samples { own: vec![], other: vec![], mixed: vec![vec![]; groups] };
        let mut said = vec![empty; fits.len()];
        let known: Vec<&Fits> = fits.iter().flatten().collect();
        let mut room = Room::default();
        if known.is_empty() {
            return Self(said);
        }
        for row in 0..count {
            for draw in [Draw::Own, Draw::Other].into_iter().chain((0..groups).map(Draw::Mixed)) {
                basis.said(plan, &known, row, draw, &mut room);
                let fitted = said.iter_mut().zip(fits).filter(|(_, fit)| fit.is_some());
                for ((samples, _), value) in fitted.zip(&room.said) {
                    match draw {
                        Draw::Own => samples.own.push(*value),
                        Draw::Other => samples.other.push(*value),
                        Draw::Mixed(group) => samples.mixed[group].push(*value),
                    }
                }
            }
        }
        Self(said)
    }
}

/// Sums over rows: of the metric, of the squares; of what comes from the group by two estimators; their pieces; the count.
const TERMS: usize = 7;

impl Samples {
    /// Polynomials for all displays; none where the metric is undefined at one, or they are worth nothing.
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

    /// A row's values at its own display, the other, and the one that has a group from the other.
    fn row(&self, group: usize, row: usize) -> [f64; 3] {
        [self.own[row], self.other[row], self.mixed[group][row]]
    }

    /// The indices of a group; `None` if the metric does not scatter.
    fn indices(&self, group: usize, fitted: Option<(Parts<'_>, &Self)>) -> Option<Indices> {
        let rows = (0..self.other.len()).map(|row| (row, self.row(group, row)));
        let known: Vec<(usize, [f64; 3])> =
            rows.filter(|(_, row)| row.iter().all(|value| !value.is_nan())).collect();
        let centre = known.iter().map(|(_, [a, b, _])| 0.5 * (a + b)).sum::<f64>() / known.len() as f64;
        let plain =
            Estimators(Sums::of(known.iter().map(|(row, values)| (replicate(*row), terms(*values, centre)))));
        // What rounding leaves of metrics that do not change is no variance.
        let least = 1e-20 * (centre * centre + plain.variance(None));
        if known.is_empty() || plain.variance(None) <= least {
            return None;
        }
        let controlled = fitted.map(|(parts, said)| {
            let known_of: Vec<[f64; TERMS]> =
                (0..super::REPLICATES).map(|of| expected(parts.of(of), centre)).collect();
            Estimators(Sums::of(known.iter().map(|(row, values)| {
                let [own, fit] = [*values, said.row(group, *row)].map(|values| terms(values, centre));
                let known = known_of[replicate(*row)];
                let mut sum = [1.0; TERMS];
                (0..TERMS - 1).for_each(|k| sum[k] = own[k] - fit[k] + known[k]);
                (replicate(*row), sum)
            })))
        });
        // A row more or less is always in doubt: of what happens rarely, no replicate may have met any.
        let far =
            known.iter().flat_map(|(_, row)| row).map(|value| (value - centre).powi(2)).fold(0.0, f64::max);
        let one_row = far / known.len() as f64 / plain.variance(None);
        let is_inert = known.iter().all(|(_, [a, _, m])| a == m);
        let is_alone = known.iter().all(|(_, [_, b, m])| b == m);
        Some(Roads { plain, controlled, one_row, is_inert, is_alone }.indices())
    }
}

/// The rows of a group as they are, and as differences from a fit.
struct Roads {
    plain: Estimators,
    controlled: Option<Estimators>,
    /// What a row more or less makes of an index.
    one_row: f64,
    /// No row tells of the group.
    is_inert: bool,
    /// No row tells of anything else.
    is_alone: bool,
}

impl Roads {
    /// The better one for an index, and its error. If it `is_certain`, rows say all that there is to say.
    fn better(&self, of: fn(&Estimators, Option<usize>) -> f64, is_certain: bool) -> (&Estimators, f64) {
        let error = |all: &Estimators| Estimate::jackknife(|left_out| of(all, left_out)).standard_error;
        let plain = error(&self.plain).max(if is_certain { 0.0 } else { self.one_row });
        // A fit that is of no use adds its own errors. Not the smaller of two unsure errors: that would be too small.
        match self.controlled.as_ref().map(|all| (all, error(all))) {
            Some((all, controlled)) if plain >= 0.5 * controlled => (all, controlled.max(LEAST_ERROR)),
            _ => (&self.plain, plain),
        }
    }

    fn indices(&self) -> Indices {
        let (little, little_error) = self.better(Estimators::of_little, self.is_inert);
        let (much, much_error) = self.better(Estimators::of_much, self.is_alone);
        let (all, all_error) = self.better(Estimators::total, self.is_inert);
        let [little_varies, much_varies] = [little_error, much_error].map(|error| error * error);
        // The whole of the weight to one that has no error.
        let weight = much_varies / (little_varies + much_varies).max(f64::MIN_POSITIVE);
        let mut first = Estimate::jackknife(|left_out| {
            weight * little.of_little(left_out) + (1.0 - weight) * much.of_much(left_out)
        });
        let mut total = Estimate::jackknife(|left_out| all.total(left_out));
        // A mean of two is no surer than two independent ones make it.
        let least = little_error.min(much_error) * std::f64::consts::FRAC_1_SQRT_2;
        first.standard_error = first.standard_error.max(least);
        total.standard_error = total.standard_error.max(all_error);
        Indices { first, total }
    }
}

/// The terms of a row, about a centre: of its own, of the other and of the mixed display.
fn terms(values: [f64; 3], centre: f64) -> [f64; TERMS] {
    let [a, b, m] = values.map(|value| value - centre);
    let halved = |difference: f64| 0.5 * difference * difference;
    [0.5 * (a + b), 0.5 * (a * a + b * b), b * (m - a), m - a, halved(b - m), halved(m - a), 1.0]
}

/// What [`terms`] are on average of a fit whose parts are known.
fn expected([mean, variance, own, shared]: [f64; 4], centre: f64) -> [f64; TERMS] {
    let mean = mean - centre;
    [mean, variance + mean * mean, own, 0.0, variance - own, shared, 1.0]
}

/// Indices from sums of [`terms`], of all replicates or all but one.
struct Estimators(Sums<TERMS>);

impl Estimators {
    fn variance(&self, left_out: Option<usize>) -> f64 {
        let [sum, squares, .., count] = self.0.without(left_out);
        squares / count - (sum / count).powi(2)
    }

    fn of_little(&self, left_out: Option<usize>) -> f64 {
        let [sum, _, product, change, .., count] = self.0.without(left_out);
        (product - sum * change / count) / count / self.variance(left_out)
    }

    fn of_much(&self, left_out: Option<usize>) -> f64 {
        let [.., halved, _, count] = self.0.without(left_out);
        1.0 - halved / count / self.variance(left_out)
    }

    fn total(&self, left_out: Option<usize>) -> f64 {
        let [.., halved, count] = self.0.without(left_out);
        halved / count / self.variance(left_out)
    }
}
