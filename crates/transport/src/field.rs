//! Light from all over the sky: a radiance for each cell of the air's hemisphere.
//!
//! # Model
//! Cells are rows of inclination times equal columns of azimuth; the radiance is the same within
//! a cell. It is kept for unit irradiance in the display plane: the integral of radiance over direction
//! cosines is 1, so that it is also the density with which [`Field::sample`] draws (inverse cumulative
//! distributions of rows, then of columns; uniform in direction cosines within a cell).
//!
//! Rows and columns are exact for rings and caps; a map is resampled to them by its reader. One column
//! is a field that is alike at all azimuths.

use std::f64::consts::{FRAC_PI_2, TAU};

use papilio_optics::Beta;

/// Radiance by direction, zero outside its rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Field {
    /// Inclinations between which the rows lie, radians, and the squares of their sines.
    edges: Vec<f64>,
    squares: Vec<f64>,
    columns: usize,
    /// `[row][column]`.
    radiance: Vec<f64>,
    /// Irradiance up to the end of each row.
    up_to_row: Vec<f64>,
    /// Up to the end of each column, as parts of its row's; `[row][column]`.
    up_to_column: Vec<f64>,
}

impl Field {
    /// Of these radiances, shape `[row][column]`, and the irradiance that they make in the display plane.
    ///
    /// Rows lie between the inclinations `edges_deg`, which ascend from 0 or more to 90 or less; column k
    /// holds azimuths from k to k + 1 of `columns` parts of the circle. `None` if the numbers do not fit
    /// together, if a radiance is negative or no number, or if there is no light.
    pub fn new(edges_deg: &[f64], columns: usize, radiance: Vec<f64>) -> Option<(Self, f64)> {
        let rows = edges_deg.len().checked_sub(1)?;
        let ascend = edges_deg.windows(2).all(|pair| pair[0] < pair[1]);
        let within = *edges_deg.first()? >= 0.0 && *edges_deg.last()? <= 90.0;
        if !ascend || !within || columns == 0 || rows.checked_mul(columns)? != radiance.len() {
            return None;
        }
        let edges: Vec<f64> = edges_deg.iter().map(|edge| edge.to_radians().min(FRAC_PI_2)).collect();
        let squares: Vec<f64> = edges.iter().map(|edge| edge.sin().powi(2)).collect();
        let (mut up_to_row, mut up_to_column) =
            (Vec::with_capacity(rows), Vec::with_capacity(radiance.len()));
        let mut irradiance = 0.0;
        for (row, squares) in radiance.chunks_exact(columns).zip(squares.windows(2)) {
            let start = up_to_column.len();
            let mut sum = 0.0;
            for value in row {
                sum += value;
                up_to_column.push(sum);
            }
            up_to_column[start..].iter_mut().for_each(|part| *part /= if sum > 0.0 { sum } else { 1.0 });
            irradiance += sum * cell_area(squares, columns);
            up_to_row.push(irradiance);
        }
        let is_light = irradiance > 0.0 && irradiance.is_finite();
        if !is_light || !radiance.iter().all(|value| *value >= 0.0) {
            return None;
        }
        up_to_row.iter_mut().for_each(|part| *part /= irradiance);
        let radiance = radiance.into_iter().map(|value| value / irradiance).collect();
        Some((Self { edges, squares, columns, radiance, up_to_row, up_to_column }, irradiance))
    }

    /// Even light from a ring around the normal, or from a cap where it begins at 0, degrees.
    pub fn ring(from_deg: f64, to_deg: f64) -> Option<Self> {
        Some(Self::new(&[from_deg, to_deg], 1, vec![1.0])?.0)
    }

    /// Radiance over irradiance, 1/sr, of the light that propagates with `beta`.
    #[inline]
    pub fn radiance(&self, beta: Beta) -> f64 {
        let square = beta.squared();
        let row = match self.squares.partition_point(|edge| *edge <= square) {
            0 => return 0.0,
            // The last row holds its own end, grazing light.
            all if all == self.squares.len() && square > self.squares[all - 1] => return 0.0,
            all if all == self.squares.len() => all - 2,
            after => after - 1,
        };
        self.row(row)[self.column(beta)]
    }

    /// The column that sends light of these direction cosines.
    #[inline]
    fn column(&self, beta: Beta) -> usize {
        if self.columns == 1 {
            return 0;
        }
        let turn = (-beta.y).atan2(-beta.x).rem_euclid(TAU) / TAU;
        ((turn * self.columns as f64) as usize).min(self.columns - 1)
    }

    /// A direction drawn by radiance: the direction cosines of its light, and [`Self::radiance`] there,
    /// which is the density.
    #[inline]
    pub fn sample(&self, u: [f64; 2]) -> (Beta, f64) {
        let (row, along) = pick(&self.up_to_row, u[0]);
        let (column, turn) = pick(&self.up_to_column[row * self.columns..][..self.columns], u[1]);
        let square = self.squares[row] + along * (self.squares[row + 1] - self.squares[row]);
        let (sin, cos) = ((column as f64 + turn) * TAU / self.columns as f64).sin_cos();
        let radius = -square.sqrt();
        (Beta { x: radius * cos, y: radius * sin }, self.row(row)[column])
    }

    /// True if it is alike at all azimuths.
    pub fn is_ring(&self) -> bool {
        self.columns == 1
    }

    /// The lit rows: the inclinations they lie between, radians, and their radiances.
    pub(crate) fn lit_rows(&self) -> impl Iterator<Item = ([f64; 2], &[f64])> {
        let rows = self.edges.windows(2).zip(self.radiance.chunks_exact(self.columns));
        let lit = rows.filter(|(_, row)| row.iter().any(|value| *value > 0.0));
        lit.map(|(edges, row)| ([edges[0], edges[1]], row))
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.radiance[row * self.columns..][..self.columns]
    }
}

/// Area of a row's cells in direction cosines.
fn cell_area(squares: &[f64], columns: usize) -> f64 {
    0.5 * (squares[1] - squares[0]) * TAU / columns as f64
}

/// Of parts that are summed up to 1, the one that holds `u`, and where in it.
#[inline]
fn pick(up_to: &[f64], u: f64) -> (usize, f64) {
    // Parts of nothing are never picked: what they are up to is no larger than what came before.
    let k = up_to.partition_point(|end| *end <= u).min(up_to.len() - 1);
    let from = if k > 0 { up_to[k - 1] } else { 0.0 };
    (k, ((u - from) / (up_to[k] - from)).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::{Numbers, Sampler};

    fn patches() -> Field {
        let radiance = vec![0.0, 1.0, 2.0, 0.5, 3.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 4.0, 0.1, 1.0, 0.0];
        Field::new(&[0.0, 10.0, 35.0, 60.0, 90.0], 4, radiance).unwrap().0
    }

    /// Chi-square of directions over cells, against the integral of the density over each.
    #[test]
    fn directions_are_drawn_by_radiance() {
        let field = patches();
        let numbers = Numbers::new(Sampler::Random, 7, 0);
        let (samples, mut counts) = (40_000_u64, [0.0; 16]);
        for path in 0..samples {
            let u = numbers.block(path, 0);
            let (beta, density) = field.sample([u[0], u[1]]);
            assert_eq!(density, field.radiance(beta));
            let row = field.squares.partition_point(|square| *square <= beta.squared()) - 1;
            counts[row * 4 + field.column(beta)] += 1.0;
        }
        let mut chi_square = 0.0;
        for (cell, count) in counts.iter().enumerate() {
            let expected = field.radiance[cell] * cell_area(&field.squares[cell / 4..], 4) * samples as f64;
            if expected == 0.0 {
                assert_eq!(*count, 0.0);
            } else {
                chi_square += (count - expected).powi(2) / expected;
            }
        }
        // Nine lit cells: eight degrees of freedom, .9999 quantile.
        assert!(chi_square < 31.8, "{chi_square}");
    }

    /// Two roads to the irradiance of one: the sum over cells, and uniform directions in the disc.
    #[test]
    fn radiance_integrates_to_one() {
        let field = patches();
        let numbers = Numbers::new(Sampler::Sobol, 0, 0);
        let samples = 1 << 15;
        let mean: f64 = (0..samples)
            .map(|path| {
                let u = numbers.block(path, 0);
                let (x, y) = papilio_sampling::warp::uniform_disc(1.0, [u[0], u[1]]);
                std::f64::consts::PI * field.radiance(Beta { x, y })
            })
            .sum();
        assert!((mean / samples as f64 - 1.0).abs() < 2e-3, "{mean}");
    }

    #[test]
    fn a_column_holds_the_light_from_its_azimuth() {
        // The column from 0 to 90 deg alone is lit.
        let (field, irradiance) = Field::new(&[0.0, 90.0], 4, vec![2.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((irradiance - 0.5 * std::f64::consts::PI).abs() < 1e-15);
        assert!(field.radiance(Beta::from_source(40.0, 45.0, 1.0)) > 0.0);
        assert_eq!(field.radiance(Beta::from_source(40.0, 135.0, 1.0)), 0.0);
        assert_eq!(field.radiance(Beta::from_source(-40.0, 45.0, 1.0)), 0.0);
    }

    #[test]
    fn what_is_no_field() {
        assert!(Field::new(&[0.0, 90.0], 1, vec![0.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 1, vec![-1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![2.0, -1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![f64::NAN, 1.0]).is_none());
        assert!(Field::new(&[0.0, 90.0], 2, vec![1.0]).is_none());
        assert!(Field::new(&[0.0, 0.0], 1, vec![1.0]).is_none());
        assert!(Field::new(&[0.0, 91.0], 1, vec![1.0]).is_none());
        assert!(Field::new(&[], 1, vec![]).is_none());
    }
}
