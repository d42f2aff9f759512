//! Sampling plan of a production.
//!
//! Row `n` of a plan belongs to replicate `n mod 16` and is point `n / 16` of the scrambled Sobol sequence of
//! this replicate. For sensitivities, a row also has a second, independent display and mixtures of both: a
//! mixture takes one group of correlated keys (usually a single key) from the second display and all other
//! keys from the first.
//!
//! Range: with up to eight keys, both displays of a row are points of one scrambled Sobol set. With more
//! keys, a row has more than sixteen numbers; those beyond the sixteenth are independent random numbers, and
//! errors decrease more slowly.
//!
//! Source: A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010): "radial" rows of A, B and A with a
//! column of B.

use papilio_sampling::{Correlation, Distribution, SampleStream, Sampler};

use super::polynomials::{Coordinate, Polynomials};

/// Number of independent replicates, from which standard errors are computed.
pub const REPLICATES: usize = 16;

/// Display of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Draw {
    /// The row's own display.
    Own,
    /// The second, independent display.
    Other,
    /// The row's own display with one group of keys from the second display.
    Mixed(usize),
}

/// Distributions of a set of keys, and the displays sampled from them.
#[derive(Debug, Clone)]
pub struct Plan {
    distributions: Vec<Distribution>,
    correlation: Correlation,
    groups: Vec<Vec<usize>>,
    seed: u64,
}

impl Plan {
    /// Creates the plan of keys with these distributions. `correlation` has the same number of keys.
    pub fn new(distributions: Vec<Distribution>, correlation: Correlation, seed: u64) -> Self {
        Self { distributions, groups: correlation.groups(), correlation, seed }
    }

    /// Groups of correlated keys, in order.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// Number of each key in a display; for a choice, its index.
    pub fn display(&self, row: u64, draw: Draw) -> Vec<f64> {
        let mut uniform = self.uniform(row, draw);
        self.correlation.apply(&mut uniform);
        self.distributions.iter().zip(uniform).map(|(one, u)| one.quantile(u)).collect()
    }

    /// Independent uniform numbers of a display, before correlation.
    fn uniform(&self, row: u64, draw: Draw) -> Vec<f64> {
        let count = self.distributions.len();
        let replicates = REPLICATES as u64;
        let numbers = SampleStream::new(Sampler::Sobol, self.seed, row % replicates);
        let number = |k: usize| numbers.block(row / replicates, (k / 4) as u32)[k % 4];
        let is_from_other = |k: &usize| match draw {
            Draw::Own => false,
            Draw::Other => true,
            Draw::Mixed(group) => self.groups.get(group).is_some_and(|group| group.contains(k)),
        };
        (0..count).map(|k| number(if is_from_other(&k) { count + k } else { k })).collect()
    }

    /// Coordinate of a key in the polynomial fit.
    fn coordinate(&self, key: usize) -> Coordinate {
        let is_alone = self.groups.iter().any(|group| *group == [key]);
        Coordinate::of(&self.distributions[key], is_alone)
    }

    /// Coordinates of a display, one for each key; they are independent of each other.
    pub(super) fn coordinates(&self, row: u64, draw: Draw) -> Vec<f64> {
        let uniform = self.uniform(row, draw).into_iter().zip(&self.distributions).enumerate();
        uniform.map(|(key, (u, distribution))| self.coordinate(key).at(distribution, u)).collect()
    }

    /// Polynomials of each key's coordinate.
    pub(super) fn polynomials(&self) -> Vec<Polynomials> {
        let polynomials = |(key, distribution)| Polynomials::of(distribution, self.coordinate(key));
        self.distributions.iter().enumerate().map(polynomials).collect()
    }
}

/// Replicate of a row.
pub(super) fn replicate(row: usize) -> usize {
    row % REPLICATES
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::Coefficient;

    fn plan() -> Plan {
        let uniform = Distribution::Uniform { from: 0.0, to: 1.0 };
        let coefficient = Coefficient { between: [0, 2], value: 0.9 };
        let correlation = Correlation::new(3, &[coefficient]).unwrap();
        Plan::new(vec![uniform; 3], correlation, 5)
    }

    #[test]
    fn mixed_display_takes_one_group_from_the_other() {
        let plan = plan();
        assert_eq!(plan.groups(), [vec![0, 2], vec![1]]);
        for row in 0..64 {
            let [own, other] = [Draw::Own, Draw::Other].map(|draw| plan.display(row, draw));
            assert_eq!(plan.display(row, Draw::Mixed(0)), [other[0], own[1], other[2]]);
            assert_eq!(plan.display(row, Draw::Mixed(1)), [own[0], other[1], own[2]]);
        }
    }
}
