//! Directions in the space of the variables that the data do not determine.
//!
//! The coordinates are in widths of the bounds, the residuals in standard deviations. A singular value of the
//! Jacobian is therefore by how many standard deviations the residuals change between the bounds along a
//! direction. Below 1, every value within the bounds agrees with the data; and a value that is small beside the
//! largest is an error of the differences from which the Jacobian is computed.

use super::levenberg_marquardt::dot;
use super::matrix::eigen;

/// Smallest singular value of a determined direction.
const SMALLEST: f64 = 1.0;
/// Smallest singular value of the Jacobian with columns of length 1: relative errors of the columns are below it.
const SMALLEST_OF_UNITS: f64 = 1e-4;
/// Smallest component of a direction that counts.
const COMPONENT: f64 = 1e-3;

/// What the data determine.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Determined {
    /// Groups of variables that the data cannot tell apart; a group of one has no effect on the data.
    pub(super) undetermined: Vec<Vec<usize>>,
    /// Covariance of all coordinates in the determined directions, row by row.
    pub(super) covariance: Vec<f64>,
}

/// Divides the directions of a Jacobian, column by column.
pub(super) fn determined(jacobian: &[Vec<f64>]) -> Determined {
    let n = jacobian.len();
    let products = |columns: &[Vec<f64>]| -> Vec<f64> {
        columns.iter().flat_map(|a| columns.iter().map(move |b| dot(a, b))).collect()
    };
    let lengths: Vec<f64> = jacobian.iter().map(|column| dot(column, column).sqrt()).collect();
    let (values, vectors) = eigen(&products(jacobian), n);
    let mut null: Vec<Vec<f64>> = Vec::new();
    let mut covariance = vec![0.0; n * n];
    for (value, vector) in values.iter().zip(&vectors) {
        if value.max(0.0).sqrt() < SMALLEST {
            null.push(vector.clone());
        }
    }
    // Directions of columns of length 1, in which scales do not matter.
    let units: Vec<Vec<f64>> = jacobian
        .iter()
        .zip(&lengths)
        .map(|(column, length)| {
            column.iter().map(|one| if *length > 0.0 { one / length } else { 0.0 }).collect()
        })
        .collect();
    let (unit_values, unit_vectors) = eigen(&products(&units), n);
    for (value, vector) in unit_values.iter().zip(&unit_vectors) {
        if value.max(0.0).sqrt() < SMALLEST_OF_UNITS {
            let direction: Vec<f64> = vector
                .iter()
                .zip(&lengths)
                .map(|(one, length)| if *length > 0.0 { one / length } else { *one })
                .collect();
            let size = dot(&direction, &direction).sqrt();
            null.push(direction.into_iter().map(|one| one / size).collect());
        } else {
            for i in 0..n {
                for k in 0..n {
                    if lengths[i] > 0.0 && lengths[k] > 0.0 {
                        covariance[i * n + k] += vector[i] * vector[k] / value / (lengths[i] * lengths[k]);
                    }
                }
            }
        }
    }
    Determined { undetermined: groups(&null, &errors(&values, &vectors)), covariance }
}

/// Standard errors of the coordinates in the directions that the data determine.
fn errors(values: &[f64], vectors: &[Vec<f64>]) -> Vec<f64> {
    let determined = || values.iter().zip(vectors).filter(|(value, _)| value.max(0.0).sqrt() >= SMALLEST);
    let of = |k: usize| determined().map(|(value, vector)| vector[k] * vector[k] / value).sum::<f64>().sqrt();
    (0..vectors.len()).map(of).collect()
}

/// Variables of each undetermined direction, joined if directions share one: those that it changes by more
/// than their standard errors.
fn groups(null: &[Vec<f64>], errors: &[f64]) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for direction in null {
        let largest = direction.iter().fold(0.0_f64, |most, one| most.max(one.abs()));
        let counts = |k: &usize| direction[*k].abs() > (COMPONENT * largest).max(errors[*k]);
        let mut group: Vec<usize> = (0..direction.len()).filter(counts).collect();
        let (joined, others): (Vec<_>, Vec<_>) =
            groups.into_iter().partition(|other| other.iter().any(|k| group.contains(k)));
        joined.into_iter().for_each(|other| group.extend(other));
        group.sort_unstable();
        group.dedup();
        groups = others;
        if !group.is_empty() {
            groups.push(group);
        }
    }
    groups.sort();
    groups
}

/// Correlation above which two variables whose intervals span their bounds are one group.
const CORRELATED: f64 = 0.9;

/// Adds variables whose intervals of 95 % span their bounds to the groups: every value within the bounds agrees
/// with the data.
pub(super) fn with_spanning(
    mut groups: Vec<Vec<usize>>,
    spanning: &[usize],
    covariance: &[f64],
) -> Vec<Vec<usize>> {
    let n = covariance.len().isqrt();
    let correlation =
        |i: usize, k: usize| covariance[i * n + k] / (covariance[i * n + i] * covariance[k * n + k]).sqrt();
    let mut left = spanning.to_vec();
    while let Some(first) = left.pop() {
        let mut group = vec![first];
        while let Some(at) =
            left.iter().position(|k| group.iter().any(|one| correlation(*one, *k).abs() > CORRELATED))
        {
            group.push(left.remove(at));
        }
        group.sort_unstable();
        groups.push(group);
    }
    groups.sort();
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(f: impl Fn(f64) -> f64) -> Vec<f64> {
        (0..20).map(|i| f(f64::from(i))).collect()
    }

    const COVARIANCE: [f64; 16] =
        [1.0, 0.0, 0.1, -1.9, 0.0, 1.0, 0.0, 0.0, 0.1, 0.0, 1.0, 0.0, -1.9, 0.0, 0.0, 4.0];

    #[test]
    fn pair_with_proportional_effects_and_variable_without_effect_are_found() {
        let columns = [
            column(|x| 30.0 * (0.3 * x).sin()),
            column(|x| -60.0 * (0.3 * x).sin()),
            column(|_| 0.0),
            column(|x| 40.0 + x),
        ];
        let found = determined(&columns);
        assert_eq!(found.undetermined, [vec![0, 1], vec![2]]);
        let plain = determined(&columns[2..]);
        assert_eq!(plain.undetermined, [vec![0]]);
        let expected = 1.0 / dot(&columns[3], &columns[3]);
        assert!((plain.covariance[3] - expected).abs() < 1e-12 * expected);
    }

    #[test]
    fn weak_effect_is_undetermined_and_strong_correlation_is_not() {
        assert_eq!(determined(&[column(|x| 0.01 * x), column(|x| 50.0 + x)]).undetermined, [vec![0]]);
        assert_eq!(with_spanning(vec![vec![1]], &[0, 2, 3], &COVARIANCE), [vec![0, 3], vec![1], vec![2]]);
        let correlated = [column(|x| 100.0 + x), column(|x| 100.0 + 1.2 * x)];
        assert!(determined(&correlated).undetermined.is_empty());
    }
}
