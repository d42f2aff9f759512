//! What makes a design good, in numbers that a search can compare.
//!
//! An objective becomes a *merit*, which is to be small: `-v / s` of what is to be large, `v / s` of what is to be small,
//! `((v - t) / s)^2` of what is to be near `t`; `s` is the size of the scenario's own value. A constraint becomes a
//! number that is to be 0 or less: how far the limit is missed, over the size of the limit.

use papilio_scenario::{Optimisation, SearchAim, SearchObjective, SearchQuantity};

/// A design that misses its limits by no more than this, relative, meets them: optimisers end about there.
pub const FEASIBLE: f64 = 1e-6;

/// Objectives and constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct Aims {
    objectives: Vec<Objective>,
    limits: Vec<Limit>,
}

#[derive(Debug, Clone, PartialEq)]
struct Objective {
    /// Weights and numbers of quantities.
    parts: Vec<(f64, usize)>,
    aim: SearchAim,
    size: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Limit {
    quantity: usize,
    /// 1: no more; -1: no less.
    sign: f64,
    limit: f64,
    size: f64,
}

impl Aims {
    pub(super) fn new(said: &Optimisation, own: &[Option<f64>]) -> Self {
        let quantities = said.quantities();
        let number = |one: &SearchQuantity| quantities.iter().position(|known| *known == one).unwrap_or(0);
        let objective = |one: &SearchObjective| {
            let parts: Vec<(f64, usize)> =
                one.parts.iter().map(|(weight, part)| (*weight, number(part))).collect();
            let target = if let SearchAim::Target(target) = one.aim { target } else { 0.0 };
            let size = size(&[mean(&parts, own).unwrap_or(0.0), target]);
            Objective { parts, aim: one.aim, size }
        };
        let limits = said.constraints.iter().flat_map(|one| {
            let quantity = number(&one.quantity);
            let limit = move |sign: f64, limit: f64| Limit {
                quantity,
                sign,
                limit,
                size: if limit == 0.0 { size(&[own[quantity].unwrap_or(0.0)]) } else { limit.abs() },
            };
            one.at_least
                .map(|least| limit(-1.0, least))
                .into_iter()
                .chain(one.at_most.map(|most| limit(1.0, most)))
        });
        Self { objectives: said.objectives.iter().map(objective).collect(), limits: limits.collect() }
    }

    /// How many objectives there are.
    pub fn objectives(&self) -> usize {
        self.objectives.len()
    }

    /// How many limits there are, `at_least` and `at_most` counted each.
    pub fn limits(&self) -> usize {
        self.limits.len()
    }

    /// The value of an objective; `None` where it is not defined.
    pub fn value(&self, objective: usize, values: &[Option<f64>]) -> Option<f64> {
        mean(&self.objectives[objective].parts, values)
    }

    /// The merit of an objective: the smaller the better.
    pub fn merit(&self, objective: usize, values: &[Option<f64>]) -> Option<f64> {
        let Objective { aim, size, .. } = self.objectives[objective];
        self.value(objective, values).map(|value| match aim {
            SearchAim::Maximise => -value / size,
            SearchAim::Minimise => value / size,
            SearchAim::Target(target) => ((value - target) / size).powi(2),
        })
    }

    /// The slopes of a merit, from those of the quantities, `[quantity][variable]`.
    pub(super) fn merit_slopes(
        &self,
        objective: usize,
        values: &[Option<f64>],
        slopes: &[f64],
        variables: usize,
    ) -> Vec<f64> {
        let Objective { parts, aim, size } = &self.objectives[objective];
        let factor = match aim {
            SearchAim::Maximise => -1.0 / size,
            SearchAim::Minimise => 1.0 / size,
            SearchAim::Target(target) => {
                2.0 * (self.value(objective, values).unwrap_or(f64::NAN) - target) / (size * size)
            }
        };
        let slope = |variable: usize| {
            let sum: f64 = parts.iter().map(|(weight, at)| weight * slopes[at * variables + variable]).sum();
            factor * sum
        };
        (0..variables).map(slope).collect()
    }

    /// By how much each limit is missed: 0 or less where it is met; infinite where its quantity is not defined.
    pub(super) fn misses(&self, values: &[Option<f64>]) -> Vec<f64> {
        let miss = |one: &Limit| {
            values[one.quantity].map_or(f64::INFINITY, |value| one.sign * (value - one.limit) / one.size)
        };
        self.limits.iter().map(miss).collect()
    }

    /// The slopes of [`misses`](Self::misses), `[limit][variable]`.
    pub(super) fn miss_slopes(&self, slopes: &[f64], variables: usize) -> Vec<f64> {
        let of = |one: &Limit| {
            let (row, factor) = (one.quantity * variables, one.sign / one.size);
            slopes[row..row + variables].iter().map(move |slope| factor * slope).collect::<Vec<_>>()
        };
        self.limits.iter().flat_map(of).collect()
    }

    /// How far a design misses its limits, relative: at most [`FEASIBLE`] of one that meets them.
    pub fn missed(&self, values: &[Option<f64>]) -> f64 {
        self.misses(values).into_iter().fold(0.0, f64::max)
    }
}

fn mean(parts: &[(f64, usize)], values: &[Option<f64>]) -> Option<f64> {
    parts.iter().map(|(weight, at)| values[*at].map(|value| weight * value)).sum()
}

/// The largest of these; 1 of zeros.
fn size(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest > 0.0 && largest.is_finite() { largest } else { 1.0 }
}
