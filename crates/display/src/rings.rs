//! Rings of viewers about the mirror direction, as imaging spheres measure them and the tabular BSDF of
//! Radiant and Zemax holds them.
//!
//! For light from the inclination a, the mirror direction is `s = (sin a, 0, cos a)`. The viewer at the
//! distance r from it and at the azimuth A about it is in the direction
//! `cos r s + sin r (cos A e0 + sin A e1)`, with `e0 = (-cos a, 0, sin a)`, towards the normal, and
//! `e1 = (0, -1, 0)`.

use crate::HalfVectorGrid;
use crate::brdf::half_turn;
use crate::lobe_width::LobeWidths;
use crate::viewers::{Viewer, ViewerGrid, ViewerTable};

/// BSDF on rings about the mirror direction.
pub type RingTable = ViewerTable<RingGrid>;

/// Directions of a [`RingTable`], in air.
#[derive(Debug, Clone, PartialEq)]
pub struct RingGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the light, ascending, 0 to less than 180 degrees; none for a display that is isotropic in azimuth.
    pub phi_i_deg: Vec<f64>,
    /// Azimuths about the mirror direction, ascending, 0 (towards the normal) to 180 degrees where the display is
    /// symmetric about the plane of incidence; with azimuths of the light, to less than 360 degrees.
    pub azimuths_deg: Vec<f64>,
    /// Distances from the mirror direction, ascending, 0 to 180 degrees.
    pub radials_deg: Vec<f64>,
}

/// Largest step of the distances, as a fraction of the distance plus the width of the lobe: the chord of a
/// lobe that falls as the third power is then 0.5 % above it.
const STEP_ON_LOBE: f64 = 0.06;

/// Number of azimuths about the mirror direction where the display depends on azimuth.
const ROUND_AZIMUTHS: usize = 36;

/// Number of distances for most lobes: 116 to 215.
const USUAL_RADIALS: usize = 160;

impl RingGrid {
    /// Grid with the [inclinations of the light of half vectors](HalfVectorGrid::lights_deg), and the axes of
    /// [`about_lights`](Self::about_lights).
    pub fn new(step_deg: f64, widths: &LobeWidths) -> Self {
        Self::about_lights(HalfVectorGrid::lights_deg(step_deg), widths)
    }

    /// Grid for these inclinations of the light; azimuths in steps of 5 deg; distances in steps of 0.5 deg to
    /// 10 deg, 1 deg to 30 deg and 2 deg beyond, and between them as close as the lobe needs.
    pub fn about_lights(theta_i_deg: Vec<f64>, widths: &LobeWidths) -> Self {
        let fine = (1..20).map(|k| 0.5 * f64::from(k));
        let medium = (10..30).map(f64::from);
        let known = fine.chain(medium).chain((15..=90).map(|k| 2.0 * f64::from(k)));
        // Half vectors are half as far from the normal as viewers are from the mirror direction.
        let width_deg = 2.0 * widths.at(0.0);
        let mut radials_deg = vec![0.0];
        for end in known {
            let start: f64 = radials_deg.last().copied().unwrap_or(0.0);
            // Distances plus the width in equal ratios.
            let ratio = (end + width_deg) / (start + width_deg);
            let parts = (ratio.ln() / STEP_ON_LOBE.ln_1p()).ceil().max(1.0);
            let inner =
                (1..parts as u32).map(|k| (start + width_deg) * ratio.powf(f64::from(k) / parts) - width_deg);
            radials_deg.extend(inner.map(|radial| (1e5 * radial).round() / 1e5));
            radials_deg.push(end);
        }
        let azimuths_deg = (0..=36).map(|k| 5.0 * f64::from(k)).collect();
        Self { theta_i_deg, phi_i_deg: Vec::new(), azimuths_deg, radials_deg }
    }

    /// The same rings for a display that depends on azimuth: azimuths of the light in steps of `phi_step_deg`, a divisor of 180, and about the
    /// mirror direction in steps of 10 deg over the whole turn.
    #[must_use]
    pub fn around(self, phi_step_deg: f64) -> Self {
        let azimuths_deg = (0..ROUND_AZIMUTHS).map(|k| 360.0 * k as f64 / ROUND_AZIMUTHS as f64).collect();
        Self { phi_i_deg: half_turn(phi_step_deg), azimuths_deg, ..self }
    }

    /// Returns about how many values the viewers of a [`new`](Self::new) grid have, or of one [`around`](Self::around) with this step of
    /// azimuth.
    pub fn numbers(step_deg: f64, phi_step_deg: Option<f64>, states: usize, wavelengths: usize) -> usize {
        Self::numbers_of(HalfVectorGrid::lights_deg(step_deg).len(), phi_step_deg, states, wavelengths)
    }

    /// Returns the same of a grid with this number of inclinations of the light.
    pub fn numbers_of(
        inclinations: usize,
        phi_step_deg: Option<f64>,
        states: usize,
        wavelengths: usize,
    ) -> usize {
        let (lights, azimuths) = phi_step_deg.map_or((1, 37), |step| (half_turn(step).len(), ROUND_AZIMUTHS));
        // Of the cells, 0.65 are above the horizon.
        let of_light = USUAL_RADIALS * azimuths * 65 / 100;
        [inclinations, lights, of_light, wavelengths]
            .iter()
            .fold(states, |product, length| product.saturating_mul(*length))
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        self.lights_deg().len() * self.azimuths_deg.len() * self.radials_deg.len()
    }

    /// Returns the viewer of a cell for light from `theta_i_deg`; `None` below the horizon. Mirror images in the plane of incidence are
    /// the same.
    pub fn viewer(theta_i_deg: f64, azimuth_deg: f64, radial_deg: f64) -> Option<Viewer> {
        Viewer::of_vector(Self::vector(theta_i_deg, azimuth_deg, radial_deg))
    }

    /// The same, on its own side of the plane of incidence.
    pub(crate) fn viewer_on_side(theta_i_deg: f64, azimuth_deg: f64, radial_deg: f64) -> Option<Viewer> {
        Viewer::of_either_side(Self::vector(theta_i_deg, azimuth_deg, radial_deg))
    }

    fn vector(theta_i_deg: f64, azimuth_deg: f64, radial_deg: f64) -> [f64; 3] {
        let (sin_i, cos_i) = theta_i_deg.to_radians().sin_cos();
        let (sin_r, cos_r) = radial_deg.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        let towards = sin_r * cos_azimuth;
        // The light is at azimuth 0, and thus the mirror direction at 180.
        [towards * cos_i - cos_r * sin_i, sin_r * sin_azimuth, cos_r * cos_i + towards * sin_i]
    }
}

impl ViewerGrid for RingGrid {
    fn theta_i_deg(&self) -> &[f64] {
        &self.theta_i_deg
    }

    fn phi_i_deg(&self) -> &[f64] {
        &self.phi_i_deg
    }

    /// Cells in the order azimuth, distance, the last fastest. All azimuths have the same viewers for light
    /// along the normal above an isotropic display, and at the distance 0.
    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let (theta_i, radials) = (self.lights_deg()[light][0], self.radials_deg.len());
        let is_round = self.phi_i_deg.is_empty() && theta_i == 0.0;
        let mut viewers = Vec::new();
        let mut numbers: Vec<Option<usize>> = Vec::with_capacity(self.azimuths_deg.len() * radials);
        for (row, azimuth) in self.azimuths_deg.iter().enumerate() {
            for (column, radial) in self.radials_deg.iter().enumerate() {
                let number = if row > 0 && (is_round || *radial == 0.0) {
                    numbers[column]
                } else {
                    Self::viewer_on_side(theta_i, *azimuth, *radial).map(|viewer| {
                        viewers.push(viewer);
                        viewers.len() - 1
                    })
                };
                numbers.push(number);
            }
        }
        (viewers, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worked example of the format: light at 30 deg, distance 20 deg.
    #[test]
    fn cells_have_the_directions_of_the_format() {
        for (azimuth, theta, dphi) in
            [(0.0, 10.0, 180.0), (90.0, 35.531, 180.0 - 36.052), (180.0, 50.0, 180.0)]
        {
            let viewer = RingGrid::viewer(30.0, azimuth, 20.0).unwrap();
            assert!((viewer.theta_o_deg - theta).abs() < 1e-3, "{azimuth}: {viewer:?}");
            assert!((viewer.dphi_deg - dphi).abs() < 1e-3, "{azimuth}: {viewer:?}");
        }
        assert_eq!(RingGrid::viewer(75.0, 180.0, 20.0), None);
    }

    /// Distances are at most 2 deg apart, and close within a lobe; those that users read in tables are among
    /// them.
    #[test]
    fn distances_follow_the_lobe() {
        for width in [0.02, 0.5, 10.0] {
            let radials = RingGrid::new(45.0, &LobeWidths::constant(width)).radials_deg;
            let close = |pair: &[f64]| pair[1] - pair[0] < 0.0601 * (pair[0] + 2.0 * width).min(34.0);
            assert!(radials.windows(2).all(|pair| pair[0] < pair[1] && close(pair)), "{width}: {radials:?}");
            assert!([0.0, 0.5, 5.0, 20.0, 45.0 + 1.0, 180.0].iter().all(|known| radials.contains(known)));
            assert!(radials.len() < 220, "{}", radials.len());
        }
    }

    #[test]
    fn equal_directions_have_one_viewer() {
        let grid = RingGrid::new(45.0, &LobeWidths::constant(10.0));
        let (normal, numbers) = grid.viewers(0);
        assert_eq!(numbers.len(), grid.azimuths_deg.len() * grid.radials_deg.len());
        assert_eq!(normal.len(), grid.radials_deg.iter().filter(|radial| **radial < 90.0).count());
        let (oblique, numbers) = grid.viewers(1);
        assert_eq!(oblique.len() + 36, numbers.iter().flatten().count());
    }
}
