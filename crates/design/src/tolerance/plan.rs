//! Which pieces are made.
//!
//! Row `n` of a plan belongs to replicate `n mod 16` and is point `n / 16` of that replicate's own scramble. For
//! sensitivities a row has, besides its own numbers, those of another, independent piece, and mixtures of both: all
//! numbers its own, but those of one group of correlated keys (mostly a single key) the other's.
//!
//! Range: up to eight keys, both pieces of a row are points of one scrambled Sobol set; beyond sixteen numbers a row
//! goes on with independent random ones, and errors fall more slowly.
//!
//! Source: A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010): "radial" rows of A, B and A with a column of B.

use papilio_sampling::{Correlation, Distribution, Numbers, Sampler};

use super::polynomials::{Coordinate, Polynomials};

/// Independent replicates, which give every number its error.
pub const REPLICATES: usize = 16;

/// Which piece of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Draw {
    /// Its own.
    Own,
    /// The other, independent one.
    Other,
    /// Its own, but for a group of keys.
    Mixed(usize),
}

/// How a set of keys scatters, and the pieces that stand for it.
#[derive(Debug, Clone)]
pub struct Plan {
    distributions: Vec<Distribution>,
    correlation: Correlation,
    groups: Vec<Vec<usize>>,
    seed: u64,
}

impl Plan {
    /// Pieces whose keys scatter so; `correlation` is of as many numbers.
    pub fn new(distributions: Vec<Distribution>, correlation: Correlation, seed: u64) -> Self {
        Self { distributions, groups: correlation.groups(), correlation, seed }
    }

    /// The keys in groups of those that are correlated, in order.
    pub fn groups(&self) -> &[Vec<usize>] {
        &self.groups
    }

    /// A number of each key; of a choice its place in its list.
    pub fn piece(&self, row: u64, draw: Draw) -> Vec<f64> {
        let mut even = self.even(row, draw);
        self.correlation.apply(&mut even);
        self.distributions.iter().zip(even).map(|(one, u)| one.quantile(u)).collect()
    }

    /// The independent even numbers that a piece is made of.
    fn even(&self, row: u64, draw: Draw) -> Vec<f64> {
        let count = self.distributions.len();
        let replicates = REPLICATES as u64;
        let numbers = Numbers::new(Sampler::Sobol, self.seed, row % replicates);
        let number = |k: usize| numbers.block(row / replicates, (k / 4) as u32)[k % 4];
        let of_other = |k: &usize| match draw {
            Draw::Own => false,
            Draw::Other => true,
            Draw::Mixed(group) => self.groups.get(group).is_some_and(|group| group.contains(k)),
        };
        (0..count).map(|k| number(if of_other(&k) { count + k } else { k })).collect()
    }

    /// Whether a key is correlated with none.
    fn coordinate(&self, key: usize) -> Coordinate {
        let is_alone = self.groups.iter().any(|group| *group == [key]);
        Coordinate::of(&self.distributions[key], is_alone)
    }

    /// A piece's coordinates, which are independent of each other: one for each key.
    pub(super) fn coordinates(&self, row: u64, draw: Draw) -> Vec<f64> {
        let even = self.even(row, draw).into_iter().zip(&self.distributions).enumerate();
        even.map(|(key, (u, distribution))| self.coordinate(key).at(distribution, u)).collect()
    }

    /// The polynomials of each key's coordinate.
    pub(super) fn polynomials(&self) -> Vec<Polynomials> {
        let of = |(key, one)| Polynomials::of(one, self.coordinate(key));
        self.distributions.iter().enumerate().map(of).collect()
    }
}

/// The replicate of a row.
pub(super) fn replicate(row: usize) -> usize {
    row % REPLICATES
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::Coefficient;

    fn plan() -> Plan {
        let uniform = Distribution::Uniform { from: 0.0, to: 1.0 };
        let together = Coefficient { between: [0, 2], value: 0.9 };
        let correlation = Correlation::new(3, &[together]).unwrap();
        Plan::new(vec![uniform; 3], correlation, 5)
    }

    #[test]
    fn a_mixed_piece_takes_a_group_from_the_other() {
        let plan = plan();
        assert_eq!(plan.groups(), [vec![0, 2], vec![1]]);
        for row in 0..64 {
            let [own, other] = [Draw::Own, Draw::Other].map(|draw| plan.piece(row, draw));
            assert_eq!(plan.piece(row, Draw::Mixed(0)), [other[0], own[1], other[2]]);
            assert_eq!(plan.piece(row, Draw::Mixed(1)), [own[0], other[1], own[2]]);
        }
    }
}
