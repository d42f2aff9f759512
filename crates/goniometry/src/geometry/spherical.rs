//! A grid of inclinations and azimuths of light and viewer.

use super::axis::{Weights, around, between, mirrored};
use crate::Direction;

/// A product of angles, degrees, each ascending. Cells in the order theta_i, phi_i, theta_o, phi_o, the last
/// fastest.
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
    /// How many cells there are.
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

    /// f between the cells: linear in all angles. With one azimuth of the light those of the viewer are
    /// relative to it, and if they end at 180 deg the other side is their mirror image.
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

    /// The viewer's azimuth less the light's, on the axis of a grid whose light has azimuth `only`.
    fn relative(&self, dphi_deg: f64, only: f64) -> Option<Weights> {
        let axis: Vec<f64> = self.phi_o_deg.iter().map(|phi| phi - only).collect();
        let (first, last) = (*axis.first()?, *axis.last()?);
        let is_half = axis.len() > 1 && first >= 0.0 && last <= 180.0;
        if is_half { mirrored(&axis, dphi_deg) } else { around(&axis, dphi_deg) }
    }

    fn mean(&self, values: &[f64], weights: [Weights; 4]) -> Option<f64> {
        let lengths = [&self.theta_i_deg, &self.phi_i_deg, &self.theta_o_deg, &self.phi_o_deg].map(Vec::len);
        let mut sum = 0.0;
        for corner in 0..16 {
            let picked: [(usize, f64); 4] = std::array::from_fn(|k| weights[k][corner >> k & 1]);
            let share: f64 = picked.iter().map(|(_, share)| share).product();
            if share > 0.0 {
                let cell = picked.iter().zip(lengths).fold(0, |cell, ((k, _), length)| cell * length + k);
                sum += share * values.get(cell)?;
            }
        }
        Some(sum)
    }
}
