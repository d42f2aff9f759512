//! Smooth interpolation of values on three axes: incidence, distance and azimuth.
//!
//! The interpolation is cubic in the logarithm, so that lobes over many decades keep their shape between
//! nodes: along diameters through the peak a spline with continuous curvature, then cubics over azimuth and
//! incidence, all with slopes that do not overshoot. A cell with a zero at a corner has no logarithm: there
//! it is linear.

use std::f64::consts::PI;

use super::axis::{Axis, STEEPEST};

/// The interpolant.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Smooth {
    pub(super) incidence: Axis,
    pub(super) radial: Axis,
    pub(super) azimuth: Axis,
    /// Logarithms and their radial slopes, `[incidence][radial][azimuth]`, with one more incidence and one
    /// more azimuth on either side.
    ln: Vec<f64>,
    slope: Vec<f64>,
    /// The values themselves, in the same order.
    plain: Vec<f64>,
    /// Whether cells are linear, `[incidence][radial][azimuth]`.
    linear: Vec<bool>,
}

/// Values by incidence, distance and azimuth.
struct Grid {
    incidence: Vec<f64>,
    radial: Vec<f64>,
    azimuth: Vec<f64>,
    values: Vec<f64>,
}

impl Grid {
    fn at(&self, i: usize, k: usize, j: usize) -> f64 {
        self.values[(i * self.radial.len() + k) * self.azimuth.len() + j]
    }

    fn row_mut(&mut self, i: usize, k: usize) -> &mut [f64] {
        let len = self.azimuth.len();
        &mut self.values[(i * self.radial.len() + k) * len..][..len]
    }

    /// Returns the value on the other side of the peak from azimuth number `j`.
    fn opposite(&self, i: usize, k: usize, j: usize) -> f64 {
        let angle = PI - self.azimuth[j];
        let right = self.azimuth.partition_point(|a| *a < angle - 1e-9).clamp(1, self.azimuth.len() - 1);
        let [start, end] = [right - 1, right].map(|j| self.azimuth[j]);
        let t = ((angle - start) / (end - start)).clamp(0.0, 1.0);
        mix(self.at(i, k, right - 1), self.at(i, k, right), t)
    }

    /// Returns the logarithms along the diameter at azimuth number `j`, its other side first.
    fn diameter(&self, i: usize, j: usize) -> (Vec<f64>, Vec<f64>) {
        // A peak that is a node itself occurs once.
        let first = usize::from(self.radial[0] == 0.0);
        let far = (first..self.radial.len()).rev();
        let x = far.clone().map(|k| -self.radial[k]).chain(self.radial.iter().copied());
        let y = far.map(|k| self.opposite(i, k, j)).chain((0..self.radial.len()).map(|k| self.at(i, k, j)));
        (x.collect(), y.map(f64::ln).collect())
    }

    /// Adds the peak as a node if it is not among the distances.
    fn with_peak(self) -> Self {
        if self.radial[0] == 0.0 {
            return self;
        }
        let (count, len) = (self.radial.len(), self.azimuth.len());
        let mut values = Vec::with_capacity(self.values.len() + len * self.incidence.len());
        for i in 0..self.incidence.len() {
            let tops = (0..len).map(|j| {
                let (x, y) = self.diameter(i, j);
                let slopes = slopes(&x, &y);
                let (left, h) = (count - 1, 2.0 * self.radial[0]);
                (0.5 * (y[left] + y[count]) + 0.125 * h * (slopes[left] - slopes[count])).exp()
            });
            let top = tops.sum::<f64>() / len as f64;
            values.extend(std::iter::repeat_n(top, len));
            values.extend_from_slice(&self.values[i * count * len..][..count * len]);
        }
        let radial = std::iter::once(0.0).chain(self.radial).collect();
        Self { radial, values, ..self }
    }

    /// Replaces values at the peak, and of light along the normal, by their mean over azimuth.
    fn even_where_azimuth_is_none(&mut self) {
        for i in 0..self.incidence.len() {
            let normal = self.incidence[i] == 0.0;
            for k in 0..if normal { self.radial.len() } else { 1 } {
                even(self.row_mut(i, k));
            }
        }
    }
}

/// Interpolates between two values, by their logarithms if these exist.
fn mix(a: f64, b: f64, t: f64) -> f64 {
    if a > 0.0 && b > 0.0 { a * (b / a).powf(t) } else { a + (b - a) * t }
}

fn even(row: &mut [f64]) {
    let count = row.len() as f64;
    let mean = if row.iter().all(|v| *v > 0.0) {
        (row.iter().map(|v| v.ln()).sum::<f64>() / count).exp()
    } else {
        row.iter().sum::<f64>() / count
    };
    row.fill(mean);
}

impl Smooth {
    /// Builds the interpolation from values in `[incidence][azimuth][radial]` order on ascending axes:
    /// `|beta|` of incidence, distance from the specular direction, azimuth about it.
    pub(super) fn new(incidence: &[f64], radial: &[f64], azimuth: &[f64], values: &[f64]) -> Self {
        // An axis of one node becomes one of two equal ones.
        let twice = |nodes: &[f64], other: f64| match nodes {
            [only] => (vec![only.min(other), only.max(other)], vec![0, 0]),
            _ => (nodes.to_vec(), (0..nodes.len()).collect::<Vec<_>>()),
        };
        let (azimuth_nodes, azimuth_of) = twice(azimuth, PI);
        let (mut incidence_nodes, mut incidence_of) =
            twice(incidence, if incidence[0] < 1.0 { 1.0 } else { 0.0 });
        if incidence_nodes[0] > 0.0 {
            incidence_nodes.insert(0, 0.0);
            incidence_of.insert(0, 0);
        }
        let mut all = Vec::with_capacity(incidence_of.len() * azimuth_of.len() * radial.len());
        for i in &incidence_of {
            for k in 0..radial.len() {
                let row = azimuth_of.iter().map(|j| values[(i * azimuth.len() + j) * radial.len() + k]);
                all.extend(row);
            }
        }
        let grid =
            Grid { incidence: incidence_nodes, radial: radial.to_vec(), azimuth: azimuth_nodes, values: all };
        let mut grid = grid.with_peak();
        grid.even_where_azimuth_is_none();
        Self::of(grid)
    }

    fn of(grid: Grid) -> Self {
        let [incidences, distances, azimuths] =
            [&grid.incidence, &grid.radial, &grid.azimuth].map(|axis| axis.len());
        // Replaces the logarithm of zero, which cells use only to find slopes.
        let positive = grid.values.iter().copied().filter(|v| *v > 0.0);
        let floor = positive.fold(f64::INFINITY, f64::min).min(1.0).ln() - 3.0;
        let row = azimuths + 2;
        let len = (incidences + 2) * distances * row;
        let mut all = Self {
            linear: linear_cells(&grid),
            incidence: Axis::new(
                grid.incidence.clone(),
                -grid.incidence[1],
                2.0 * grid.incidence[incidences - 1] - grid.incidence[incidences - 2],
            ),
            radial: Axis::mirrored(grid.radial.clone()),
            azimuth: Axis::mirrored(grid.azimuth.clone()),
            ln: vec![floor; len],
            slope: vec![0.0; len],
            plain: vec![0.0; len],
        };
        for i in 0..incidences {
            for j in 0..azimuths {
                let (x, y) = grid.diameter(i, j);
                let slopes = slopes(&x, &y);
                for k in 0..distances {
                    let at = ((i + 1) * distances + k) * row + j + 1;
                    all.plain[at] = grid.at(i, k, j);
                    all.ln[at] = y[distances - 1 + k].max(floor);
                    all.slope[at] = slopes[distances - 1 + k];
                }
            }
        }
        all.fill_beyond(&grid);
        all
    }

    /// Fills the values beyond the ends of incidence and azimuth.
    fn fill_beyond(&mut self, grid: &Grid) {
        let (distances, azimuths) = (grid.radial.len(), grid.azimuth.len());
        let row = azimuths + 2;
        let plane = distances * row;
        let last = grid.incidence.len();
        for values in [&mut self.ln, &mut self.slope, &mut self.plain] {
            let mirror = |values: &mut Vec<f64>, planes: std::ops::Range<usize>| {
                for start in planes.flat_map(|i| (0..distances).map(move |k| i * plane + k * row)) {
                    values[start] = values[start + 2];
                    values[start + row - 1] = values[start + row - 3];
                }
            };
            mirror(values, 1..last + 1);
            for k in 0..distances {
                for j in 0..azimuths {
                    // Incidence from the other side: the plane of incidence rotated by half a turn.
                    let angle = PI - grid.azimuth[j];
                    let place = self.azimuth.place(angle);
                    let from = 2 * plane + k * row + 1 + place.cell;
                    values[k * row + 1 + j] = values[from] + place.t * (values[from + 1] - values[from]);
                    // Continues as between the last two.
                    let at = last * plane + k * row + 1 + j;
                    values[at + plane] = 2.0 * values[at] - values[at - plane];
                }
            }
            mirror(values, 0..1);
            mirror(values, last + 1..last + 2);
        }
    }

    /// Returns the function. An incidence beyond the nodes is that of the nearest; beyond the last distance
    /// the function is 0.
    #[inline]
    pub(super) fn value(&self, incidence: f64, distance: f64, azimuth: f64) -> f64 {
        if distance > self.radial.last() {
            return 0.0;
        }
        let (i, k, j) =
            (self.incidence.place(incidence), self.radial.place(distance), self.azimuth.place(azimuth));
        let [distances, azimuths] = [self.radial.nodes().len(), self.azimuth.nodes().len()];
        let row = azimuths + 2;
        let at = |offset: usize| ((i.cell + offset) * distances + k.cell) * row + j.cell;
        if self.linear[(i.cell * (distances - 1) + k.cell) * (azimuths - 1) + j.cell] {
            let between = |at: usize| {
                let along = |at: usize| self.plain[at] + j.t * (self.plain[at + 1] - self.plain[at]);
                along(at) + k.t * (along(at + row) - along(at))
            };
            let [low, high] = [1, 2].map(|offset| between(at(offset) + 1));
            return low + i.t * (high - low);
        }
        let [near, far, near_slope, far_slope] = k.hermite();
        let (near_slope, far_slope) = (near_slope * k.width(), far_slope * k.width());
        let along = |offset: usize| {
            let at = at(offset);
            let four = |values: &[f64], at: usize| -> [f64; 4] {
                values[at..].first_chunk().copied().unwrap_or_default()
            };
            let [a, b] = [at, at + row].map(|at| four(&self.ln, at));
            let [c, d] = [at, at + row].map(|at| four(&self.slope, at));
            j.cubic(std::array::from_fn(|l| near * a[l] + far * b[l] + near_slope * c[l] + far_slope * d[l]))
        };
        i.cubic(std::array::from_fn(along)).exp()
    }
}

/// Returns the cells with a zero at one of their corners.
fn linear_cells(grid: &Grid) -> Vec<bool> {
    let mut linear = Vec::new();
    for i in 1..grid.incidence.len() {
        for k in 1..grid.radial.len() {
            for j in 1..grid.azimuth.len() {
                let dark = |corner: usize| {
                    grid.at(i - (corner & 1), k - (corner >> 1 & 1), j - (corner >> 2)) <= 0.0
                };
                linear.push((0..8).any(dark));
            }
        }
    }
    linear
}

/// Returns slopes of the spline with continuous curvature through values at ascending `x`, limited by
/// [`STEEPEST`]. Intervals separated by values without a logarithm are independent.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut all = vec![0.0; x.len()];
    let mut start = 0;
    while start < x.len() {
        let end = start + y[start..].iter().take_while(|y| y.is_finite()).count();
        stretch(&x[start..end], &y[start..end], &mut all[start..end]);
        start = end + 1;
    }
    all
}

fn stretch(x: &[f64], y: &[f64], out: &mut [f64]) {
    if x.len() < 2 {
        return;
    }
    let secants: Vec<f64> = (1..x.len()).map(|i| (y[i] - y[i - 1]) / (x[i] - x[i - 1])).collect();
    let last = x.len() - 1;
    if last == 1 {
        out.fill(secants[0]);
        return;
    }
    let width = |i: usize| x[i + 1] - x[i];
    // At the ends the slope of the parabola through the last three.
    let end = |own: usize, next: usize| {
        secants[own] + (secants[own] - secants[next]) * width(own) / (width(own) + width(next))
    };
    out[0] = end(0, 1);
    out[last] = end(last - 1, last - 2);
    // Thomas elimination.
    let mut upper = vec![0.0; x.len()];
    for i in 1..last {
        let [left, right] = [1.0 / width(i - 1), 1.0 / width(i)];
        let right_side = 3.0 * (secants[i - 1] * left + secants[i] * right) - left * out[i - 1];
        let pivot = 2.0 * (left + right) - left * upper[i - 1];
        upper[i] = right / pivot;
        out[i] = right_side / pivot;
    }
    for i in (1..last).rev() {
        out[i] -= upper[i] * out[i + 1];
    }
    for (i, slope) in out.iter_mut().enumerate() {
        let beside = [i.max(1) - 1, i.min(last - 1)].map(|s| secants[s].abs());
        let most = STEEPEST * beside[0].min(beside[1]);
        *slope = slope.clamp(-most, most);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spline_error_is_of_fourth_order() {
        let error = |count: usize| {
            let x: Vec<f64> = (0..=count).map(|i| i as f64 / count as f64 * 2.0).collect();
            let y: Vec<f64> = x.iter().map(|x| (1.0 + x * x).ln()).collect();
            let found = slopes(&x, &y);
            let middle = count / 2;
            (found[middle] - 2.0 * x[middle] / (1.0 + x[middle] * x[middle])).abs()
        };
        assert!(error(8) < 1e-2 && error(16) < error(8) / 8.0, "{} {}", error(8), error(16));
    }

    #[test]
    fn values_without_logarithm_separate_intervals() {
        let y = [0.0, 1.0, f64::NEG_INFINITY, 5.0, f64::NEG_INFINITY, 2.0, 3.0, 4.0];
        let x: Vec<f64> = (0..8).map(f64::from).collect();
        assert_eq!(slopes(&x, &y), [1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    }
}
