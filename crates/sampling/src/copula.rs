//! Numbers that scatter together: a Gaussian copula.
//!
//! Even numbers are made standard normal ones, mixed so that they have the correlations that are stated, and made
//! even again: whatever their distributions, each keeps its own, and they rise together as the coefficients say.
//! Coefficients are those of the normal numbers between; of two normal distributions they are Pearson's own, and
//! Spearman's rank correlation is `6/pi asin(r/2)` for all continuous ones.
//!
//! Source: R. B. Nelsen, *An Introduction to Copulas*, 2nd ed. (2006), chapter 3.1; the mixing is the Cholesky factor
//! of the matrix of coefficients.

use crate::distribution::{normal, share_below};

/// Which of several numbers rise and fall together, and how strictly.
#[derive(Debug, Clone, PartialEq)]
pub struct Correlation {
    /// The Cholesky factor, a row for each number, up to its diagonal.
    rows: Vec<Vec<f64>>,
}

/// A coefficient between two numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficient {
    /// The two, by their places from 0.
    pub between: [usize; 2],
    /// From -1 to 1, both excluded.
    pub value: f64,
}

impl Correlation {
    /// Of so many numbers; those without a coefficient are independent.
    ///
    /// # Errors
    /// The place of a coefficient that no numbers can have beside the others: their matrix is not positive definite.
    pub fn new(count: usize, coefficients: &[Coefficient]) -> Result<Self, usize> {
        let value = |i: usize, j: usize| {
            let of = |one: &&Coefficient| one.between == [i, j] || one.between == [j, i];
            coefficients.iter().find(of).map_or(0.0, |one| one.value)
        };
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
        for i in 0..count {
            let mut row = Vec::with_capacity(i + 1);
            for (j, other) in rows.iter().enumerate() {
                let known: f64 = row.iter().zip(other).map(|(a, b)| a * b).sum();
                row.push((value(i, j) - known) / other[j]);
            }
            let rest = 1.0 - row.iter().map(|a| a * a).sum::<f64>();
            // Numbers that follow from others are no numbers of their own; rounding leaves a little.
            if rest.is_nan() || rest <= 1e-12 {
                let of_row =
                    |one: &Coefficient| one.between.contains(&i) && one.between.iter().all(|k| *k <= i);
                return Err(coefficients.iter().rposition(of_row).unwrap_or(0));
            }
            row.push(rest.sqrt());
            rows.push(row);
        }
        Ok(Self { rows })
    }

    /// Makes independent even numbers ones that rise together.
    pub fn apply(&self, even: &mut [f64]) {
        if self.groups().len() == self.rows.len() {
            return;
        }
        let normals: Vec<f64> = even.iter().map(|u| normal(*u)).collect();
        for (number, row) in even.iter_mut().zip(&self.rows) {
            // A number that goes by no other stays as it is, to the last digit.
            if row.iter().rev().skip(1).any(|of| *of != 0.0) {
                *number = share_below(row.iter().zip(&normals).map(|(a, z)| a * z).sum());
            }
        }
    }

    /// The numbers in groups of those that go together, by way of others too: groups are independent of each other.
    pub fn groups(&self) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        for (i, row) in self.rows.iter().enumerate() {
            let goes_with = |j: &usize| row.get(*j).is_some_and(|of| *of != 0.0) && *j != i;
            let (with, mut rest): (Vec<_>, Vec<_>) =
                groups.into_iter().partition(|group: &Vec<usize>| group.iter().any(goes_with));
            let mut group: Vec<usize> = with.into_iter().flatten().chain([i]).collect();
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
    use crate::{Numbers, Sampler};

    fn pair(i: usize, j: usize, value: f64) -> Coefficient {
        Coefficient { between: [i, j], value }
    }

    /// The coefficients of many normal numbers are those that were stated, and each number stays even.
    #[test]
    fn numbers_correlate_as_stated() {
        let stated = [pair(0, 1, 0.8), pair(3, 1, -0.5), pair(0, 3, -0.2)];
        let correlation = Correlation::new(4, &stated).unwrap();
        let numbers = Numbers::new(Sampler::Sobol, 0, 0);
        let count = 1 << 14;
        let all: Vec<[f64; 4]> = (0..count)
            .map(|path| {
                let mut even = numbers.block(path, 0);
                correlation.apply(&mut even);
                even
            })
            .collect();
        let sum = |of: &dyn Fn(&[f64; 4]) -> f64| all.iter().map(of).sum::<f64>() / count as f64;
        for i in 0..4 {
            assert!((sum(&|u| u[i]) - 0.5).abs() < 1e-3 && (sum(&|u| u[i] * u[i]) - 1.0 / 3.0).abs() < 1e-3);
            for j in 0..i {
                let stated = stated.iter().find(|one| one.between == [i, j] || one.between == [j, i]);
                let found = sum(&|u| normal(u[i]) * normal(u[j]));
                assert!((found - stated.map_or(0.0, |one| one.value)).abs() < 5e-3, "{i} {j} {found}");
            }
        }
        assert_eq!(correlation.groups(), [vec![0, 1, 3], vec![2]]);
        // What goes by no other is not touched.
        assert_eq!(all[7][2], numbers.block(7, 0)[2]);
    }

    #[test]
    fn coefficients_that_no_numbers_have_are_named() {
        let impossible = [pair(0, 1, 0.9), pair(1, 2, 0.9), pair(0, 2, -0.9)];
        assert_eq!(Correlation::new(3, &impossible), Err(2));
        assert_eq!(Correlation::new(2, &[pair(1, 0, 1.0)]), Err(0));
        assert!(Correlation::new(3, &[]).is_ok_and(|one| one.groups().len() == 3));
    }

    #[test]
    fn groups_join_by_way_of_others() {
        let chain = [pair(0, 4, 0.5), pair(2, 4, 0.5), pair(1, 3, 0.5)];
        let groups = Correlation::new(5, &chain).unwrap().groups();
        assert_eq!(groups, [vec![0, 2, 4], vec![1, 3]]);
    }
}
