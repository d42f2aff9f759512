//! Rings of viewers about the mirror direction, as imaging spheres measure them and the tabular BSDF of Radiant and Zemax holds them.
//!
//! For light from the inclination a, the mirror direction is `s = (sin a, 0, cos a)`. The viewer at the distance r from it and at the
//! azimuth A about it is in the direction `cos r s + sin r (cos A e0 + sin A e1)`, with `e0 = (-cos a, 0, sin a)`, towards the normal, and
//! `e1 = (0, -1, 0)`.

use crate::viewers::{Viewer, ViewerGrid, ViewerState, ViewerTable};

/// BSDF on rings about the mirror direction.
pub type RingTable = ViewerTable<RingGrid>;

/// Directions of a [`RingTable`], in air.
#[derive(Debug, Clone, PartialEq)]
pub struct RingGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths about the mirror direction, ascending, 0 (towards the normal) to 180 degrees: the display is symmetric about the plane
    /// of incidence.
    pub azimuths_deg: Vec<f64>,
    /// Distances from the mirror direction, ascending, 0 to 180 degrees.
    pub radials_deg: Vec<f64>,
}

impl RingGrid {
    /// Grid with inclinations of the light in steps of `step_deg` degrees, a divisor of 90, from 0 to below 90; azimuths in steps of
    /// 5 deg, and distances in steps of 0.5 deg to 10 deg, 1 deg to 30 deg and 2 deg beyond.
    pub fn even(step_deg: f64) -> Self {
        let steps = (90.0 / step_deg).round() as u32;
        let fine = (0..20).map(|k| 0.5 * f64::from(k));
        let medium = (10..30).map(f64::from);
        Self {
            theta_i_deg: (0..steps).map(|k| step_deg * f64::from(k)).collect(),
            azimuths_deg: (0..=36).map(|k| 5.0 * f64::from(k)).collect(),
            radials_deg: fine.chain(medium).chain((15..=90).map(|k| 2.0 * f64::from(k))).collect(),
        }
    }

    /// Returns the number of cells.
    pub fn cells(&self) -> usize {
        self.theta_i_deg.len() * self.azimuths_deg.len() * self.radials_deg.len()
    }

    /// Returns the viewer of a cell for light from `theta_i_deg`; `None` below the horizon.
    pub fn viewer(theta_i_deg: f64, azimuth_deg: f64, radial_deg: f64) -> Option<Viewer> {
        let (sin_i, cos_i) = theta_i_deg.to_radians().sin_cos();
        let (sin_r, cos_r) = radial_deg.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        let towards = sin_r * cos_azimuth;
        // The light is at azimuth 0, and thus the mirror direction at 180.
        Viewer::of_vector([
            towards * cos_i - cos_r * sin_i,
            sin_r * sin_azimuth,
            cos_r * cos_i + towards * sin_i,
        ])
    }
}

impl ViewerGrid for RingGrid {
    fn theta_i_deg(&self) -> &[f64] {
        &self.theta_i_deg
    }

    /// Cells in the order azimuth, distance, the last fastest. All azimuths have the same viewers for light along the normal, and at
    /// the distance 0.
    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let (theta_i, radials) = (self.theta_i_deg[light], self.radials_deg.len());
        let mut viewers = Vec::new();
        let mut numbers: Vec<Option<usize>> = Vec::with_capacity(self.azimuths_deg.len() * radials);
        for (row, azimuth) in self.azimuths_deg.iter().enumerate() {
            for (column, radial) in self.radials_deg.iter().enumerate() {
                let number = if row > 0 && (theta_i == 0.0 || *radial == 0.0) {
                    numbers[column]
                } else {
                    Self::viewer(theta_i, *azimuth, *radial).map(|viewer| {
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

impl RingTable {
    /// Computes the difference between the sum over the table's directions and the scattered light: the largest over states and
    /// inclinations of the light, relative to the largest of the state; spectra are averaged. It shows whether the directions are
    /// dense enough to resolve the lobes of the display.
    pub fn missed(&self) -> f64 {
        let bins = self.wavelength_nm.len().max(1);
        let mean = |spectrum: &mut dyn Iterator<Item = f64>| spectrum.sum::<f64>() / bins as f64;
        let weights: Vec<Vec<f64>> =
            (0..self.grid.theta_i_deg.len()).map(|light| self.weights(light)).collect();
        let of_state = |state: &ViewerState| {
            let mut rest = state.brdf.chunks_exact(bins);
            let beams =
                state.directional_hemispherical.chunks_exact(bins).zip(state.specular.chunks_exact(bins));
            let (mut missed, mut most) = (0.0_f64, 0.0_f64);
            for (weights, (leaving, mirror)) in weights.iter().zip(beams) {
                let sum: f64 = weights
                    .iter()
                    .zip(&mut rest)
                    .map(|(weight, spectrum)| weight * mean(&mut spectrum.iter().map(|f| f64::from(*f))))
                    .sum();
                let scattered =
                    mean(&mut leaving.iter().zip(mirror).map(|(leaving, mirror)| leaving - mirror));
                missed = missed.max((sum - scattered).abs());
                most = most.max(mean(&mut leaving.iter().copied()));
            }
            if most > 0.0 { missed / most } else { 0.0 }
        };
        self.states.iter().map(of_state).fold(0.0, f64::max)
    }

    /// Projected solid angle of each viewer of one direction of the light, for both sides of the plane of incidence, by the
    /// trapezoidal rule.
    fn weights(&self, light: usize) -> Vec<f64> {
        let (viewers, numbers) = self.grid.viewers(light);
        let [arcs, steps] = [&self.grid.azimuths_deg, &self.grid.radials_deg].map(|axis| widths(axis));
        let mut weights = vec![0.0; viewers.len()];
        for (cell, number) in numbers.iter().enumerate() {
            let (row, column) = (cell / steps.len().max(1), cell % steps.len().max(1));
            if let Some(number) = number {
                let ring = self.grid.radials_deg[column].to_radians().sin() * steps[column];
                weights[*number] += 2.0 * arcs[row] * ring * viewers[*number].cos_theta_o;
            }
        }
        weights
    }
}

/// Widths of the trapezoidal rule at these angles, radians.
fn widths(angles_deg: &[f64]) -> Vec<f64> {
    let half = |pair: &[f64]| 0.5 * (pair[1] - pair[0]).to_radians();
    let mut widths = vec![0.0; angles_deg.len()];
    for (k, pair) in angles_deg.windows(2).enumerate() {
        widths[k] += half(pair);
        widths[k + 1] += half(pair);
    }
    widths
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

    /// A perfect white scatters all light: the sum of the projected solid angles is pi.
    #[test]
    fn sum_over_rings_of_a_perfect_white_equals_its_reflectance() {
        let grid = RingGrid::even(15.0);
        let viewers: usize = (0..6).map(|light| grid.viewers(light).0.len()).sum();
        let state = ViewerState {
            name: "white".to_owned(),
            brdf: vec![std::f64::consts::FRAC_1_PI as f32; viewers],
            specular: vec![0.0; 6],
            directional_hemispherical: vec![1.0; 6],
        };
        let mut table = RingTable {
            grid,
            wavelength_nm: vec![550.0],
            states: vec![state],
            nodes: 0,
            discretisation_error: 0.0,
            row_errors: crate::RowErrors::default(),
        };
        assert!(table.missed() < 5e-3, "{}", table.missed());
        table.states[0].directional_hemispherical.fill(0.9);
        assert!((table.missed() - 1.0 / 9.0).abs() < 6e-3, "{}", table.missed());
    }

    #[test]
    fn equal_directions_have_one_viewer() {
        let grid = RingGrid::even(45.0);
        let (normal, numbers) = grid.viewers(0);
        assert_eq!(numbers.len(), grid.azimuths_deg.len() * grid.radials_deg.len());
        // Below 90 deg.
        assert_eq!(normal.len(), 20 + 20 + 30);
        let (oblique, numbers) = grid.viewers(1);
        assert_eq!(oblique.len() + 36, numbers.iter().flatten().count());
    }
}
