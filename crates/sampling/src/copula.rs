//! Correlated random numbers: a Gaussian copula.
//!
//! Independent uniform numbers are converted to standard normal numbers, mixed to have the given
//! correlations, and converted back to uniform numbers. Each number can then be given any distribution of its
//! own. The coefficients are the correlations of the normal numbers. For two normal distributions they equal
//! Pearson's coefficient; Spearman's rank correlation is `6/pi asin(r/2)` for all continuous distributions.
//!
//! Source: R. B. Nelsen, *An Introduction to Copulas*, 2nd ed. (2006), chapter 3.1. The mixing matrix is the
//! Cholesky factor of the matrix of coefficients.

use crate::distribution::{normal_cdf, normal_quantile};

/// Correlation matrix of several random numbers, as its Cholesky factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// Rows of the Cholesky factor, one for each number, up to the diagonal.
    rows: Vec<Vec<f64>>,
}

/// Correlation coefficient of two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// Zero-based indices of the two numbers.
    pub between: [usize; 2],
    /// The coefficient, from -1 to 1, both excluded.
    pub value: f64,
}

impl Correlation {
    /// Returns the correlation of `count` numbers; pairs without a coefficient are independent.
    ///
    /// # Errors
    /// Index of a coefficient that is incompatible with the others: the correlation matrix is not positive
    /// definite.
    pub fn new(count: usize, coefficients: &[Coefficient]) -> Result<Self, usize> {
        let value = |i: usize, j: usize| {
            let matches = |one: &&Coefficient| one.between == [i, j] || one.between == [j, i];
            coefficients.iter().find(matches).map_or(0.0, |one| one.value)
        };
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
        for i in 0..count {
            let mut row = Vec::with_capacity(i + 1);
            for (j, other) in rows.iter().enumerate() {
                let known: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
                row.push((value(i, j) - known) / other[j]);
            }
            let rest = 1.0 - row.iter().map(|a| a * a).sum::<f64>();
            // The number is determined by the others, up to rounding.
            if rest.is_nan() || rest <= 1e-12 {
                let in_row =
                    |one: &Coefficient| one.between.contains(&i) && one.between.iter().all(|k| *k <= i);
                return Err(coefficients.iter().rposition(in_row).unwrap_or(0));
            }
            row.push(rest.sqrt());
            rows.push(row);
        }
        Ok(Self { rows })
    }

    /// Correlates independent uniform numbers in place.
    pub fn apply(&self, uniform: &mut [f64]) {
        if self.groups().len() == self.rows.len() {
            return;
        }
        let normals: Vec<f64> = uniform.iter().map(|u| normal_quantile(*u)).collect();
        for (number, row) in uniform.iter_mut().zip(&self.rows) {
            // A number that depends on no other stays the same to the last digit.
            if row.iter().rev().skip(1).any(|factor| *factor != 0.0) {
                *number = normal_cdf(row.iter().zip(&normals).map(|(a, z)| a * z).sum());
            }
        }
    }

    /// Groups of correlated numbers, directly or through others. Groups are independent of each other.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let correlates = |j: &usize| row.get(*j).is_some_and(|factor| *factor != 0.0) && *j != i;
            let (joined, mut rest): (Vec<_>, Vec<_>) =
                groups.into_iter().partition(|group: &Vec<usize>| group.iter().any(correlates));
            let mut group: Vec<usize> = joined.into_iter().flatten().chain([i]).collect();
            group.sort_unstable();
            rest.push(group);
            groups = rest;
        }
        groups.sort();
        groups
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{SampleStream, Sampler};

    fn pair(i: usize, j: usize, value: f64) -> Coefficient {
        Coefficient { between: [i, j], value }
    }

    /// The coefficients of many normal numbers are the given ones, and each number stays uniform.
    #[test]
    fn correlated_numbers_have_given_coefficients_and_stay_uniform() {
        let stated = [pair(0, 1, 0.8), pair(3, 1, -0.5), pair(0, 3, -0.2)];
        let correlation = Correlation::new(4, &stated).unwrap();
        let numbers = SampleStream::new(Sampler::Sobol, 0, 0);
        let count = 1 << 14;
        let all: Vec<[f64; 4]> = (0..count)
            .map(|path| {
                let mut uniform = numbers.block(path, 0);
                correlation.apply(&mut uniform);
                uniform
            })
            .collect();
        let sum = |of: &dyn Fn(&[f64; 4]) -> f64| all.iter().map(of).sum::<f64>() / count as f64;
        for i in 0..4 {
            assert!((sum(&|u| u[i]) - 0.5).abs() < 1e-3 && (sum(&|u| u[i] * u[i]) - 1.0 / 3.0).abs() < 1e-3);
            for j in 0..i {
                let stated = stated.iter().find(|one| one.between == [i, j] || one.between == [j, i]);
                let found = sum(&|u| normal_quantile(u[i]) * normal_quantile(u[j]));
                assert!((found - stated.map_or(0.0, |one| one.value)).abs() < 5e-3, "{i} {j} {found}");
            }
        }
        assert_eq!(correlation.groups(), [vec![0, 1, 3], vec![2]]);
        // An independent number is not changed.
        assert_eq!(all[7][2], numbers.block(7, 0)[2]);
    }

    #[test]
    fn impossible_coefficient_is_refused_by_index() {
        let impossible = [pair(0, 1, 0.9), pair(1, 2, 0.9), pair(0, 2, -0.9)];
        assert_eq!(Correlation::new(3, &impossible), Err(2));
        assert_eq!(Correlation::new(2, &[pair(1, 0, 1.0)]), Err(0));
        assert!(Correlation::new(3, &[]).is_ok_and(|one| one.groups().len() == 3));
    }

    #[test]
    fn groups_include_indirect_correlations() {
        let chain = [pair(0, 4, 0.5), pair(2, 4, 0.5), pair(1, 3, 0.5)];
        let groups = Correlation::new(5, &chain).unwrap().groups();
        assert_eq!(groups, [vec![0, 2, 4], vec![1, 3]]);
    }
}
