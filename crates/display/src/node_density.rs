//! Density with which the half vectors of an exported BSDF are placed, on rows of equal azimuth.
//!
//! On each row, the density over `u` (`theta_m = 90 deg u^2`) is proportional to `d theta_m / du` times
//! `a / (w + theta_m) / ln(1 + T / w) + (1 - a) / T`, with the inclination w at which the lobe has fallen by
//! half and the inclination T beyond which viewers are below the horizon: the distances between nodes are
//! equal within the lobe, and proportional to theta_m in its tails, which fall as powers of theta_m. It ends
//! in the tabulated cell of T, so that only the last node of a row is below the horizon.
//!
//! The tensor files of the RGL database hold such a density (`vndf`), tabulated in equal steps of u and
//! linear between. Its cumulative sums along a row are piecewise quadratic, and exact here.

use std::cmp::Ordering;
use std::f64::consts::FRAC_PI_2;

use crate::half_vectors::HalfVectorGrid;

/// Fraction of the nodes that follow the lobe, a.
const ON_LOBE: f64 = 0.7;

/// Tabulated values of a row for each node on it.
const PER_NODE: usize = 4;

/// Largest number of tabulated values of a row.
const MOST_COLUMNS: usize = 512;

/// Density of the half vectors of one direction of the light over u, for each row of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeDensity {
    columns: usize,
    /// `[row][column]`; the integral of each row over u is 1, up to rounding.
    values: Vec<f32>,
}

impl NodeDensity {
    /// Density for light from `theta_i_deg` and a lobe that falls by half within `width_deg` of half vectors,
    /// on `rows` rows. `turn`: the azimuth of the light as a fraction of a turn, if rows are not relative to it.
    pub(crate) fn new(theta_i_deg: f64, width_deg: f64, rows: usize, turn: Option<f64>) -> Self {
        let columns = (PER_NODE * rows).min(MOST_COLUMNS);
        let mut values = Vec::with_capacity(rows * columns);
        for row in 0..rows {
            // Rows that are mirror images are equal to the last bit; light along the normal has no azimuth.
            let first = match turn {
                _ if theta_i_deg == 0.0 => 0,
                None => row.min(rows - 1 - row),
                Some(_) => row % (rows - 1),
            };
            if first < row {
                values.extend_from_within(first * columns..(first + 1) * columns);
            } else {
                let v = row as f64 / (rows - 1) as f64 - turn.unwrap_or(0.0);
                values.extend(Self::row(theta_i_deg, width_deg.to_radians(), v, columns));
            }
        }
        Self { columns, values }
    }

    fn row(theta_i_deg: f64, width: f64, v: f64, columns: usize) -> Vec<f32> {
        let u = |column: usize| column as f64 / (columns - 1) as f64;
        let is_above = |u: f64| HalfVectorGrid::viewer(theta_i_deg, [u, v]).is_some();
        let above = (1..columns).take_while(|column| is_above(u(*column))).count().max(1);
        let end = FRAC_PI_2 * u((above + 1).min(columns - 1)).powi(2);
        let scale = ON_LOBE / (end / width).ln_1p();
        // The part of the last cell that is above the horizon: its square as a factor at the cell's beginning
        // leaves at most 1/32 of a cell's nodes below the horizon, and the density ends at the horizon if
        // that is at a tabulated place.
        let last =
            if above + 1 < columns { part_above(is_above, [u(above), u(above + 1)]).powi(2) } else { 1.0 };
        let density = |column: usize| {
            let theta_m = FRAC_PI_2 * u(column).powi(2);
            let inside = u(column) * (scale / (width + theta_m) + (1.0 - ON_LOBE) / end);
            match column.cmp(&above) {
                Ordering::Less => inside,
                Ordering::Equal => inside * last,
                Ordering::Greater => 0.0,
            }
        };
        let row: Vec<f64> = (0..columns).map(density).collect();
        let integral =
            row.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).sum::<f64>() / (columns - 1) as f64;
        row.into_iter().map(|value| (value / integral) as f32).collect()
    }

    /// Number of tabulated values of a row, at equal steps of u from 0 to 1.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The tabulated values, `[row][column]`.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// Density at a place u of a row.
    pub fn at(&self, row: usize, u: f64) -> f64 {
        let place = u * (self.columns - 1) as f64;
        let cell = (place as usize).min(self.columns - 2);
        let [a, b] = self.cell(row, cell);
        a + (b - a) * (place - cell as f64)
    }

    fn cell(&self, row: usize, cell: usize) -> [f64; 2] {
        let from = row * self.columns + cell;
        [f64::from(self.values[from]), f64::from(self.values[from + 1])]
    }

    /// Returns u below which each of the given fractions of a row lies. The fractions ascend from 0 to 1.
    pub(crate) fn places(&self, row: usize, fractions: &[f64]) -> Vec<f64> {
        let cells = self.columns - 1;
        let area = |cell: usize| {
            let [a, b] = self.cell(row, cell);
            0.5 * (a + b)
        };
        let total: f64 = (0..cells).map(area).sum();
        let (mut cell, mut before) = (0, 0.0);
        let place = |fraction: &f64| {
            let wanted = fraction * total;
            while cell + 1 < cells && before + area(cell) < wanted && area(cell + 1) > 0.0 {
                before += area(cell);
                cell += 1;
            }
            let [a, b] = self.cell(row, cell);
            let rest = (wanted - before).clamp(0.0, area(cell));
            // a x + (b - a) x^2 / 2 = rest, in the form that does not cancel.
            let root = (a * a + 2.0 * (b - a) * rest).max(0.0).sqrt();
            let x = if a + root > 0.0 { (2.0 * rest / (a + root)).min(1.0) } else { 0.0 };
            (cell as f64 + x) / cells as f64
        };
        fractions.iter().map(place).collect()
    }
}

/// Returns the part of a range that is above the horizon, of which its beginning is the highest.
fn part_above(is_above: impl Fn(f64) -> bool, [from, to]: [f64; 2]) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if is_above(from + middle * (to - from)) { low = middle } else { high = middle }
    }
    low
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fractions of the density below the places, summed by the trapezoidal rule, which is exact between
    /// tabulated values.
    #[test]
    fn places_have_the_given_fractions_of_the_density_below_them() {
        for (theta_i, width) in [(0.0, 0.05), (40.0, 3.0), (89.0, 20.0)] {
            let density = NodeDensity::new(theta_i, width, 9, None);
            let fractions: Vec<f64> = (0..9).map(|k| f64::from(k) / 8.0).collect();
            for row in 0..9 {
                let places = density.places(row, &fractions);
                assert_eq!(places[0], 0.0);
                let steps = 36_000;
                let (mut sum, mut next) = (0.0, 1);
                for k in 0..steps {
                    let u = (f64::from(k) + 0.5) / f64::from(steps);
                    while next < 8 && u > places[next] {
                        // A step of the sum has up to this fraction.
                        assert!((sum - fractions[next]).abs() < 2e-3, "{theta_i}, {row}: {sum}");
                        next += 1;
                    }
                    sum += density.at(row, u) / f64::from(steps);
                }
                assert!((sum - 1.0).abs() < 1e-5, "{sum}");
                // The last node is the first place below the horizon.
                let v = row as f64 / 8.0;
                assert_eq!(HalfVectorGrid::viewer(theta_i, [places[8], v]), None);
                assert!(HalfVectorGrid::viewer(theta_i, [places[7], v]).is_some());
            }
        }
    }
}
