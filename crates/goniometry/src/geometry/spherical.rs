//! A grid of inclinations and azimuths of light and viewer.

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
}
