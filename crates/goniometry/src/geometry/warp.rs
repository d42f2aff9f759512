//! Bilinear density on the unit square at each node of two axes, and its cumulative map.
//!
//! The map from uniform numbers to points of the density uses a marginal distribution over rows and then a
//! conditional distribution along a row. Only the inverse is needed here, from points to uniform numbers.
//! Densities and cumulative sums are both interpolated linearly between the nodes of the axes, as in the
//! reference implementation of the parametrisation.

use super::axis::Weights;

/// Densities over x (columns) and y (rows) at a list of nodes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Warp {
    width: usize,
    height: usize,
    /// `[node][y][x]`, normalised to an integral of 1 over the square.
    density: Vec<f64>,
    /// Integral along each row to the end of each column: `[node][y][x - 1]`.
    rows: Vec<f64>,
    /// Integral over all rows to the end of each row: `[node][y - 1]`.
    marginal: Vec<f64>,
}

impl Warp {
    /// Map from samples `[node][y][x]`; `None` unless there are at least two in each direction, none is
    /// negative, and each node has a positive integral.
    pub(super) fn new(samples: &[f64], width: usize, height: usize) -> Option<Self> {
        if width < 2 || height < 2 || samples.iter().any(|v| !(*v >= 0.0 && v.is_finite())) {
            return None;
        }
        let mut warp = Self { width, height, density: Vec::new(), rows: Vec::new(), marginal: Vec::new() };
        samples.chunks_exact(width * height).try_for_each(|node| warp.add(node))?;
        Some(warp)
    }

    fn add(&mut self, node: &[f64]) -> Option<()> {
        let running = |step: f64| {
            let mut sum = 0.0;
            move |pair: &[f64]| {
                sum += (pair[0] + pair[1]) * step;
                sum
            }
        };
        let (dx, dy) = (0.5 / (self.width - 1) as f64, 0.5 / (self.height - 1) as f64);
        let rows: Vec<f64> =
            node.chunks_exact(self.width).flat_map(|row| row.windows(2).map(running(dx))).collect();
        let ends: Vec<f64> =
            rows.chunks_exact(self.width - 1).filter_map(|row| row.last().copied()).collect();
        let marginal: Vec<f64> = ends.windows(2).map(running(dy)).collect();
        let norm = 1.0 / marginal.last()?;
        if !norm.is_finite() {
            return None;
        }
        self.density.extend(node.iter().map(|v| v * norm));
        self.rows.extend(rows.iter().map(|v| v * norm));
        self.marginal.extend(marginal.iter().map(|v| v * norm));
        Some(())
    }

    /// Returns the uniform numbers of a point; `None` on a row without light.
    pub(super) fn invert(&self, nodes: &[(usize, f64)], [x, y]: [f64; 2]) -> Option<[f64; 2]> {
        let (column, x) = patch(x, self.width);
        let (row, y) = patch(y, self.height);
        let (columns, rows) = (self.width - 1, self.height - 1);
        let sum = |table: &[f64], size: usize, index: usize| -> f64 {
            nodes.iter().map(|(node, weight)| weight * table[node * size + index]).sum()
        };
        let density =
            |dx, dy| sum(&self.density, self.width * self.height, (row + dy) * self.width + column + dx);
        let along = |dy, end: usize| match end {
            0 => 0.0,
            end => sum(&self.rows, columns * self.height, (row + dy) * columns + end - 1),
        };
        let lerp = |a: f64, b: f64, fraction: f64| a + fraction * (b - a);
        let at_left = lerp(density(0, 0), density(0, 1), y);
        let at_right = lerp(density(1, 0), density(1, 1), y);
        let before = lerp(along(0, column), along(1, column), y);
        let [whole_0, whole_1] = [0, 1].map(|dy| along(dy, columns));
        let whole = lerp(whole_0, whole_1, y);
        let u = before + x * lerp(at_left, at_right, x / 2.0) / columns as f64;
        let below = if row == 0 { 0.0 } else { sum(&self.marginal, rows, row - 1) };
        let v = below + y * lerp(whole_0, whole_1, y / 2.0) / rows as f64;
        (whole > 0.0).then(|| [u / whole, v])
    }
}

/// Cell of a uniform grid of `points` points over 0 to 1, and the position in it.
pub(super) fn patch(x: f64, points: usize) -> (usize, f64) {
    let x = x.clamp(0.0, 1.0) * (points - 1) as f64;
    let index = (x as usize).min(points - 2);
    (index, x - index as f64)
}

/// Interpolates a bilinear grid `[y][x]` at a point of the unit square.
pub(super) fn bilinear(grid: impl Fn(usize) -> f64, width: usize, height: usize, [x, y]: [f64; 2]) -> f64 {
    let ((column, x), (row, y)) = (patch(x, width), patch(y, height));
    let at = |dx: usize, dy: usize| grid((row + dy) * width + column + dx);
    (at(0, 0) * (1.0 - x) + at(1, 0) * x) * (1.0 - y) + (at(0, 1) * (1.0 - x) + at(1, 1) * x) * y
}

/// The four nodes of two axes, the second fastest, with their weights.
pub(super) fn nodes(first: Weights, second: Weights, length: usize) -> [(usize, f64); 4] {
    std::array::from_fn(|k| {
        let ((a, weight_a), (b, weight_b)) = (first[k / 2], second[k % 2]);
        (a * length + b, weight_a * weight_b)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The density 2x has the cumulative sum x^2; (x + y) has, along a row, (x^2/2 + x y)/(1/2 + y).
    #[test]
    fn cumulative_sums_of_bilinear_densities_are_exact() {
        let slope = Warp::new(&[0.0, 1.0, 2.0, 0.0, 1.0, 2.0], 3, 2).unwrap();
        let plane = Warp::new(&[0.0, 1.0, 1.0, 2.0], 2, 2).unwrap();
        for [x, y] in [[0.2, 0.9], [0.7, 0.1], [0.5, 0.5], [1.0, 1.0]] {
            let close = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-14;
            assert!(close(slope.invert(&[(0, 1.0)], [x, y]).unwrap(), [x * x, y]));
            let expected = [(x * x / 2.0 + x * y) / (0.5 + y), (y + y * y) / 2.0];
            assert!(close(plane.invert(&[(0, 1.0)], [x, y]).unwrap(), expected));
        }
        assert_eq!(Warp::new(&[0.0; 4], 2, 2), None);
        assert_eq!(Warp::new(&[1.0, -1.0, 1.0, 1.0], 2, 2), None);
    }
}
