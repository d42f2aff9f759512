//! Pairs of directions between the nodes of an exported BSDF, at which what a reader interpolates is compared
//! with the display.

use crate::lobe_width::LobeWidths;
use crate::rings::RingGrid;
use crate::viewers::{Viewer, ViewerGrid};

/// Inclinations next to which light is tested, degrees.
const LIGHTS_DEG: [f64; 6] = [2.0, 12.0, 30.0, 47.0, 61.0, 72.0];

/// Largest inclination of viewers, degrees: readers differ in what they do between the last node and the
/// horizon.
const LAST_DEG: f64 = 80.0;

/// Distances from the mirror direction in units of the lobe's width.
const DISTANCES: [f64; 12] = [0.0, 0.23, 0.45, 0.7, 1.05, 1.6, 2.5, 4.1, 7.2, 13.0, 29.0, 67.0];

/// Azimuths about the mirror direction, degrees.
const AZIMUTHS_DEG: [f64; 4] = [11.0, 63.0, 117.0, 166.0];

/// The same on both sides of the plane of incidence.
const ROUND_AZIMUTHS_DEG: [f64; 6] = [11.0, 63.0, 117.0, 166.0, 223.0, 302.0];

/// Azimuths next to which light is tested, degrees.
const PHI_DEG: [f64; 3] = [20.0, 80.0, 140.0];

/// Pairs of directions at which an exported BSDF is tested.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeGrid {
    theta_i_deg: Vec<f64>,
    phi_i_deg: Vec<f64>,
    viewers: Vec<Vec<Viewer>>,
}

impl ProbeGrid {
    /// Pairs for an export with these inclinations of the light: light half-way between some of them, where
    /// interpolation is least accurate, and along one; viewers at distances from the mirror direction that
    /// scale with the lobe.
    pub fn between(nodes_deg: &[f64], widths: &LobeWidths) -> Self {
        let middles: Vec<f64> = nodes_deg.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
        let nearest = |wanted: &f64| {
            let off = |middle: &&f64| (**middle - wanted).abs();
            middles.iter().min_by(|a, b| off(a).total_cmp(&off(b))).copied()
        };
        let mut theta_i_deg: Vec<f64> = nodes_deg.first().copied().into_iter().collect();
        theta_i_deg.extend(LIGHTS_DEG.iter().filter_map(nearest));
        theta_i_deg.sort_by(f64::total_cmp);
        theta_i_deg.dedup();
        let viewers = theta_i_deg
            .iter()
            .map(|light| Self::about_mirror(*light, (&AZIMUTHS_DEG, RingGrid::viewer), widths))
            .collect();
        Self { theta_i_deg, phi_i_deg: Vec::new(), viewers }
    }

    /// The same pairs for an export with azimuths of the light in steps of `phi_step_deg`, with light half-way between some of them and
    /// viewers on both sides of the plane of incidence.
    pub fn around(nodes_deg: &[f64], phi_step_deg: f64, widths: &LobeWidths) -> Self {
        let theta_i_deg = Self::between(nodes_deg, widths).theta_i_deg;
        let middle = |phi: &f64| (phi / phi_step_deg).floor().mul_add(phi_step_deg, 0.5 * phi_step_deg);
        let mut phi_i_deg: Vec<f64> = PHI_DEG.iter().map(middle).filter(|phi| *phi < 180.0).collect();
        phi_i_deg.dedup();
        let on_side = RingGrid::viewer_on_side;
        let viewers = |theta: &f64| Self::about_mirror(*theta, (&ROUND_AZIMUTHS_DEG, on_side), widths);
        let viewers = theta_i_deg
            .iter()
            .flat_map(|theta| std::iter::repeat_n(viewers(theta), phi_i_deg.len()))
            .collect();
        Self { theta_i_deg, phi_i_deg, viewers }
    }

    fn about_mirror(
        light_deg: f64,
        (azimuths_deg, viewer): (&[f64], impl Fn(f64, f64, f64) -> Option<Viewer>),
        widths: &LobeWidths,
    ) -> Vec<Viewer> {
        let width_deg = 2.0 * widths.at(0.0);
        let mut viewers = Vec::new();
        for distance in DISTANCES {
            let radial_deg = distance * width_deg;
            let azimuths = if distance == 0.0 { &azimuths_deg[..1] } else { azimuths_deg };
            for azimuth in azimuths.iter().filter(|_| radial_deg < 180.0) {
                let viewer = viewer(light_deg, *azimuth, radial_deg);
                viewers.extend(viewer.filter(|viewer| viewer.theta_o_deg <= LAST_DEG));
            }
        }
        viewers
    }
}

impl ViewerGrid for ProbeGrid {
    fn theta_i_deg(&self) -> &[f64] {
        &self.theta_i_deg
    }

    fn phi_i_deg(&self) -> &[f64] {
        &self.phi_i_deg
    }

    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let viewers = self.viewers[light].clone();
        let numbers = (0..viewers.len()).map(Some).collect();
        (viewers, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probes_are_between_nodes_and_within_the_lobe() {
        let nodes: Vec<f64> = (0..18).map(|k| 5.0 * f64::from(k)).collect();
        let grid = ProbeGrid::between(&nodes, &LobeWidths::constant(1.0));
        assert_eq!(grid.theta_i_deg(), [0.0, 2.5, 12.5, 27.5, 47.5, 62.5, 72.5]);
        for light in 0..7 {
            let (viewers, _) = grid.viewers(light);
            assert!(viewers.len() > 20, "{}", viewers.len());
            let mirror = viewers.iter().filter(|viewer| {
                (viewer.theta_o_deg - grid.theta_i_deg()[light]).abs() < 1.0 && viewer.theta_o_deg <= LAST_DEG
            });
            assert!(mirror.count() > 2);
        }
    }
}
