//! Columns, states and wavelengths, from which all others are interpolated.
//!
//! The reflectance of a film as a function of direction has few independent shapes: 15 for the 648 columns of 8 states
//! and 81 wavelengths of an interferometric pixel, to 1e-4. Light that the base reflects twice is a quadratic form of
//! this function, and so on. *Pivots* are columns such that the reflectance of every column, its products at two
//! directions and at three are the same linear combination of those of the pivots: about 90 of 648. The light that
//! several reflections leave is then this combination, too. Pivoting by the largest remainder and elimination (the
//! interpolative decomposition: H. Cheng et al., SIAM J. Sci. Comput. 26, 1389 (2005)).

use super::matrix::Matrix;

/// Pivots of some columns, and what combines them.
#[derive(Debug, Clone)]
pub(super) struct Pivots {
    columns: Vec<usize>,
    /// `[pivot, column]`.
    weights: Matrix,
}

/// Smallest number of columns that are interpolated.
const FEWEST_COLUMNS: usize = 64;
/// Numbers of directions whose products of two and of three values are reproduced.
const DIRECTIONS: [usize; 2] = [6, 3];

impl Pivots {
    /// Determines pivots of a reflectance, `[node, column]`, at its first nodes, to this remainder of the largest
    /// column; `None` if they would be too many.
    pub(super) fn new(reflectance: &Matrix, nodes: usize, remainder: f64) -> Option<Self> {
        let count = reflectance.columns();
        if count < FEWEST_COLUMNS || nodes == 0 {
            return None;
        }
        let mut rest: Vec<Vec<f64>> = (0..count).map(|c| features(&reflectance.column(c)[..nodes])).collect();
        let mut sizes: Vec<f64> = rest.iter().map(|rest| dot(rest, rest)).collect();
        let enough = remainder * remainder * sizes.iter().copied().fold(0.0, f64::max);
        let (mut columns, mut factors) = (Vec::new(), Vec::new());
        while let Some((pivot, size)) = largest(&sizes).filter(|(_, size)| *size > enough) {
            if 4 * (columns.len() + 1) > count {
                return None;
            }
            let direction: Vec<f64> = rest[pivot].iter().map(|x| x / size.sqrt()).collect();
            let along: Vec<f64> = rest.iter().map(|rest| dot(rest, &direction)).collect();
            for ((rest, along), size) in rest.iter_mut().zip(&along).zip(&mut sizes) {
                rest.iter_mut().zip(&direction).for_each(|(x, d)| *x -= along * d);
                *size = dot(rest, rest);
            }
            // Rounding must not make it a pivot again.
            sizes[pivot] = 0.0;
            columns.push(pivot);
            factors.push(along);
        }
        let weights = combine(&columns, &factors, count);
        Some(Self { columns, weights })
    }

    /// Returns the numbers of the pivots.
    pub(super) fn columns(&self) -> &[usize] {
        &self.columns
    }

    /// Adds the values of all columns, interpolated from those of the pivots.
    pub(super) fn add_interpolated(&self, of_pivots: &Matrix, sum: &mut Matrix) {
        sum.add_product(of_pivots, &self.weights, self.columns.len());
    }
}

/// Returns the values of a column, and products of two and of three of them at some nodes.
fn features(column: &[f64]) -> Vec<f64> {
    let some = |count: usize| -> Vec<f64> {
        let count = count.min(column.len());
        (0..count).map(|k| column[(2 * k + 1) * column.len() / (2 * count)]).collect()
    };
    let [two, three] = DIRECTIONS.map(some);
    let mut all = column.to_vec();
    for (i, a) in two.iter().enumerate() {
        all.extend(two[i..].iter().map(|b| a * b));
    }
    for (i, a) in three.iter().enumerate() {
        for (j, b) in three.iter().enumerate().skip(i) {
            all.extend(three[j..].iter().map(|c| a * b * c));
        }
    }
    all
}

/// Returns the weights of the pivots by back substitution, given the components of all columns along the direction that
/// each pivot added.
fn combine(pivots: &[usize], factors: &[Vec<f64>], count: usize) -> Matrix {
    let mut weights = Matrix::from_fn(pivots.len(), count, |k, c| factors[k][c]);
    for (c, column) in weights.columns_mut() {
        if let Some(own) = pivots.iter().position(|pivot| *pivot == c) {
            column.fill(0.0);
            column[own] = 1.0;
            continue;
        }
        for k in (0..pivots.len()).rev() {
            let known: f64 = (k + 1..pivots.len()).map(|j| factors[k][pivots[j]] * column[j]).sum();
            column[k] = (column[k] - known) / factors[k][pivots[k]];
        }
    }
    weights
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn largest(sizes: &[f64]) -> Option<(usize, f64)> {
    sizes.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fringes of films of many thicknesses and wavelengths, and the light that three reflections leave.
    #[test]
    fn light_of_several_reflections_is_interpolated() {
        let (nodes, count) = (40, 300);
        let reflectance = Matrix::from_fn(nodes, count, |i, c| {
            let (sine, phase) = (i as f64 / nodes as f64, 6.0 + 0.02 * (c % 100) as f64);
            0.4 + 0.3 * (phase * (1.0 - 0.4 * sine * sine).sqrt() + (c / 100) as f64).cos()
        });
        let pivots = Pivots::new(&reflectance, nodes, 1e-6).unwrap();
        let back = |i: usize, j: usize| 0.1 / (1.0 + (i as f64 - j as f64).powi(2));
        let light = |c: usize, i: usize| -> f64 {
            let b = |i: usize| reflectance[(i, c)];
            let again = |i: usize, f: &dyn Fn(usize) -> f64| {
                b(i) * (0..nodes).map(|j| back(i, j) * f(j)).sum::<f64>()
            };
            again(i, &|j| again(j, &b))
        };
        let of_pivots = Matrix::from_fn(nodes, pivots.columns().len(), |i, p| light(pivots.columns()[p], i));
        let mut all = Matrix::zeros(nodes, count);
        pivots.add_interpolated(&of_pivots, &mut all);
        assert!(pivots.columns().len() < count / 4);
        let most = (0..count).map(|c| light(c, 13)).fold(0.0, f64::max);
        for c in (0..count).step_by(7) {
            for i in [0, 13, 39] {
                let (found, truth) = (all[(i, c)], light(c, i));
                assert!((found - truth).abs() < 1e-4 * most, "{c} {i}: {found} {truth} of {most}");
            }
        }
    }
}
