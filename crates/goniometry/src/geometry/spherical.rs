//! Grid of inclinations and azimuths of light and viewer.

use super::axis::{Weights, around, between, mirrored};
use super::one_side::{SAME_DEG, within_half};
use crate::Direction;

/// Product grid of angles, degrees, each ascending. Cells in the order theta_i, phi_i, theta_o, phi_o, the
/// last fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SphericalGrid {
    /// Inclinations of the light.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the light.
    pub phi_i_deg: Vec<f64>,
    /// Inclinations of the viewer.
    pub theta_o_deg: Vec<f64>,
    /// Azimuths of the viewer.
    pub phi_o_deg: Vec<f64>,
}

impl SphericalGrid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        [&self.theta_i_deg, &self.phi_i_deg, &self.theta_o_deg, &self.phi_o_deg]
            .into_iter()
            .map(Vec::len)
            .product()
    }

    /// Directions of light and viewer of a cell.
    pub(crate) fn directions(&self, mut cell: usize) -> Option<[Direction; 2]> {
        let axes = [&self.phi_o_deg, &self.theta_o_deg, &self.phi_i_deg, &self.theta_i_deg];
        let mut angles = [0.0; 4];
        for (angle, axis) in angles.iter_mut().zip(axes) {
            *angle = *axis.get(cell.checked_rem(axis.len())?)?;
            cell /= axis.len();
        }
        let [phi_o, theta_o, phi_i, theta_i] = angles;
        Some([Direction::new(theta_i, phi_i), Direction::new(theta_o, phi_o)])
    }

    /// Interpolates f linearly in all angles. With one azimuth of the light, the azimuths of the viewer are
    /// relative to it; if they end at 180 deg, the other side is the mirror image.
    pub(super) fn evaluate(&self, values: &[f64], i: Direction, o: Direction) -> Option<f64> {
        let theta_i = between(&self.theta_i_deg, i.theta_deg)?;
        let theta_o = between(&self.theta_o_deg, o.theta_deg)?;
        let phi_i = around(&self.phi_i_deg, i.phi_deg)?;
        let phi_o = match self.phi_i_deg[..] {
            [only] => self.relative(o.phi_deg - i.phi_deg, only)?,
            _ => around(&self.phi_o_deg, o.phi_deg)?,
        };
        self.mean(values, [theta_i, phi_i, theta_o, phi_o])
    }

    /// Interpolation weights of the azimuth difference, on the axis of a grid whose light has azimuth `only`.
    fn relative(&self, dphi_deg: f64, only: f64) -> Option<Weights> {
        let axis: Vec<f64> = self.phi_o_deg.iter().map(|phi| phi - only).collect();
        if self.is_half() { mirrored(&axis, dphi_deg) } else { around(&axis, dphi_deg) }
    }

    /// Returns true if the viewer's azimuths cover one side of the plane of incidence and represent both.
    pub(crate) fn is_half(&self) -> bool {
        match (&self.phi_i_deg[..], &self.phi_o_deg[..]) {
            ([light], [first, .., last]) => first - light >= 0.0 && last - light <= 180.0,
            _ => false,
        }
    }

    /// Place of an azimuth on the axis of the viewer; `None` if it lies between its angles.
    pub(crate) fn viewer_place(&self, phi_deg: f64) -> Option<usize> {
        let near = around(&self.phi_o_deg, phi_deg)?;
        let is_here =
            |k: &usize| self.phi_o_deg.len() == 1 || within_half(self.phi_o_deg[*k] - phi_deg) < SAME_DEG;
        near.into_iter().map(|(k, _)| k).find(is_here)
    }

    fn mean(&self, values: &[f64], weights: [Weights; 4]) -> Option<f64> {
        let lengths = [&self.theta_i_deg, &self.phi_i_deg, &self.theta_o_deg, &self.phi_o_deg].map(Vec::len);
        let mut sum = 0.0;
        for corner in 0..16 {
            let picked: [(usize, f64); 4] = std::array::from_fn(|k| weights[k][corner >> k & 1]);
            let weight: f64 = picked.iter().map(|(_, weight)| weight).product();
            if weight > 0.0 {
                let cell = picked.iter().zip(lengths).fold(0, |cell, ((k, _), length)| cell * length + k);
                sum += weight * values.get(cell)?;
            }
        }
        Some(sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that are linear in the angles are interpolated exactly.
    #[test]
    fn interpolation_of_linear_values_is_exact() {
        let mut grid = SphericalGrid {
            theta_i_deg: vec![0.0, 40.0],
            phi_i_deg: vec![0.0, 120.0, 240.0],
            theta_o_deg: vec![0.0, 30.0, 80.0],
            phi_o_deg: vec![0.0, 90.0, 180.0, 270.0],
        };
        let value =
            |[i, o]: [Direction; 2]| i.theta_deg + 3.0 * o.theta_deg + 0.1 * o.phi_deg + 0.01 * i.phi_deg;
        let values = |grid: &SphericalGrid| -> Vec<f64> {
            (0..grid.cells()).map(|cell| value(grid.directions(cell).unwrap())).collect()
        };
        let pair = [Direction::new(13.0, 50.0), Direction::new(71.0, 200.0)];
        assert!((grid.evaluate(&values(&grid), pair[0], pair[1]).unwrap() - value(pair)).abs() < 1e-9);
        assert_eq!(grid.evaluate(&values(&grid), Direction::new(41.0, 0.0), pair[1]), None);
        // With one azimuth of the light, azimuths are relative to it; a half circle is mirrored.
        (grid.phi_i_deg, grid.phi_o_deg) = (vec![0.0], vec![0.0, 90.0, 180.0]);
        let turned =
            grid.evaluate(&values(&grid), Direction::new(13.0, 50.0), Direction::new(71.0, 50.0 - 120.0));
        let expected = value([Direction::new(13.0, 0.0), Direction::new(71.0, 120.0)]);
        assert!((turned.unwrap() - expected).abs() < 1e-9);
    }
}
