//! Objectives and constraints as scaled numbers.
//!
//! An objective becomes a *merit*, which a search minimises: `-v / s` for a value v to be maximised, `v / s`
//! for one to be minimised, `((v - t) / s)^2` for a target t. The scale s is the magnitude of the scenario's
//! own value. A constraint becomes its *violation*: the distance from the limit, divided by the magnitude of
//! the limit. It is at most 0 if the constraint is satisfied.

use papilio_scenario::{NamedQuantity, Optimisation, SearchAim, SearchObjective};

/// Largest relative violation of a feasible design: optimisers satisfy constraints to about this accuracy.
pub const FEASIBLE: f64 = 1e-6;

/// Objectives and constraints.
#[derive(Debug, Clone, PartialEq)]
pub struct Aims {
    objectives: Vec<Objective>,
    limits: Vec<Limit>,
}

#[derive(Debug, Clone, PartialEq)]
struct Objective {
    /// Weights and indices of quantities.
    parts: Vec<(f64, usize)>,
    aim: SearchAim,
    size: f64,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Limit {
    quantity: usize,
    /// 1 for an upper limit, -1 for a lower limit.
    sign: f64,
    limit: f64,
    size: f64,
}

impl Aims {
    pub(super) fn new(spec: &Optimisation, own: &[Option<f64>]) -> Self {
        let quantities = spec.quantities();
        let index = |one: &NamedQuantity| quantities.iter().position(|known| *known == one).unwrap_or(0);
        let objective = |one: &SearchObjective| {
            let parts: Vec<(f64, usize)> =
                one.parts.iter().map(|(weight, part)| (*weight, index(part))).collect();
            let target = if let SearchAim::Target(target) = one.aim { target } else { 0.0 };
            let size = size(&[mean(&parts, own).unwrap_or(0.0), target]);
            Objective { parts, aim: one.aim, size }
        };
        let limits = spec.constraints.iter().flat_map(|constraint| {
            let quantity = index(&constraint.quantity);
            let limit = move |sign: f64, limit: f64| Limit {
                quantity,
                sign,
                limit,
                size: if limit == 0.0 { size(&[own[quantity].unwrap_or(0.0)]) } else { limit.abs() },
            };
            constraint
                .at_least
                .map(|least| limit(-1.0, least))
                .into_iter()
                .chain(constraint.at_most.map(|most| limit(1.0, most)))
        });
        Self { objectives: spec.objectives.iter().map(objective).collect(), limits: limits.collect() }
    }

    /// Number of objectives.
    pub fn objectives(&self) -> usize {
        self.objectives.len()
    }

    /// Number of limits; `at_least` and `at_most` count separately.
    pub fn limits(&self) -> usize {
        self.limits.len()
    }

    /// Value of an objective; `None` where it is undefined.
    pub fn value(&self, objective: usize, values: &[Option<f64>]) -> Option<f64> {
        mean(&self.objectives[objective].parts, values)
    }

    /// Merit of an objective; smaller is better.
    pub fn merit(&self, objective: usize, values: &[Option<f64>]) -> Option<f64> {
        let Objective { aim, size, .. } = self.objectives[objective];
        self.value(objective, values).map(|value| match aim {
            SearchAim::Maximise => -value / size,
            SearchAim::Minimise => value / size,
            SearchAim::Target(target) => ((value - target) / size).powi(2),
        })
    }

    /// Derivatives of a merit from those of the quantities, `[quantity][variable]`.
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

    /// Violation of each limit: 0 or less if it is satisfied, infinite if its quantity is undefined.
    pub(super) fn violations(&self, values: &[Option<f64>]) -> Vec<f64> {
        let violation = |one: &Limit| {
            values[one.quantity].map_or(f64::INFINITY, |value| one.sign * (value - one.limit) / one.size)
        };
        self.limits.iter().map(violation).collect()
    }

    /// Derivatives of the [`violations`](Self::violations), `[limit][variable]`.
    pub(super) fn violation_slopes(&self, slopes: &[f64], variables: usize) -> Vec<f64> {
        let row = |one: &Limit| {
            let (start, factor) = (one.quantity * variables, one.sign / one.size);
            slopes[start..start + variables].iter().map(move |slope| factor * slope).collect::<Vec<_>>()
        };
        self.limits.iter().flat_map(row).collect()
    }

    /// Largest relative violation of a design's constraints; at most [`FEASIBLE`] for a feasible design.
    pub fn missed(&self, values: &[Option<f64>]) -> f64 {
        self.violations(values).into_iter().fold(0.0, f64::max)
    }
}

fn mean(parts: &[(f64, usize)], values: &[Option<f64>]) -> Option<f64> {
    parts.iter().map(|(weight, at)| values[*at].map(|value| weight * value)).sum()
}

/// Largest magnitude of the values; 1 if all are zero.
fn size(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    if largest > 0.0 && largest.is_finite() { largest } else { 1.0 }
}
