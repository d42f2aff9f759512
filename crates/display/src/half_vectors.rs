//! BSDF of a whole display on a grid of half vectors, for renderers.
//!
//! A lobe lies around the mirror direction and moves with the light. The half vector `m` of light and viewer
//! is near the normal there, wherever the light is: values on a grid of half vectors can be interpolated
//! between directions of the light, which values at fixed directions of the viewer cannot (their peaks would
//! be doubled).
//!
//! The grid is that of the RGL tensor files (Dupuy & Jakob 2018, ACM Trans. Graph. 37(6)). Rows have equal
//! steps of azimuth, `v = (phi_m - phi_i + pi) / (2 pi)`. Along a row, `u = sqrt(theta_m / (pi/2))` follows a
//! density, which the files call the distribution of visible normals: more nodes within the lobe of the
//! display, none below the horizon ([`NodeDensity`]). Readers interpolate linearly between nodes, and between
//! directions of the light at equal places on the grid; towards grazing light, where a lobe changes fastest
//! on half vectors, its inclinations are closer.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::brdf::half_turn;
use crate::lobe_width::LobeWidths;
use crate::node_density::NodeDensity;
use crate::viewers::{Viewer, ViewerGrid, ViewerTable};

/// BSDF on half vectors.
pub type HalfVectorTable = ViewerTable<HalfVectorGrid>;

/// Directions of a [`HalfVectorTable`], in air.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfVectorGrid {
    /// Inclinations of the light, ascending, 0 to less than 90 degrees.
    pub theta_i_deg: Vec<f64>,
    /// Azimuths of the light, ascending, -180 to 0 degrees; none for a display that is isotropic in azimuth.
    pub phi_i_deg: Vec<f64>,
    /// Number of nodes along u and along v, at least 2.
    pub size: usize,
    /// Inclination of the half vector within which the lobe falls by half, for each inclination of the light,
    /// degrees.
    pub width_deg: Vec<f64>,
}

impl HalfVectorGrid {
    /// Smallest number of nodes along an axis.
    pub const SMALLEST: usize = 8;

    /// Largest number of nodes along an axis.
    pub const LARGEST: usize = 256;

    /// Number of nodes along an axis that suits most displays.
    pub const USUAL: usize = 64;

    /// Largest inclination of the light of [`lights_deg`](Self::lights_deg), degrees: renderers hold its
    /// values up to 90 degrees.
    pub const LAST_THETA_DEG: f64 = 89.0;

    /// Grid for a lobe of these widths, with [`lights_deg`](Self::lights_deg).
    pub fn new(step_deg: f64, size: usize, widths: &LobeWidths) -> Self {
        let theta_i_deg = Self::lights_deg(step_deg);
        let width_deg = theta_i_deg.iter().map(|theta| widths.at(*theta)).collect();
        Self { theta_i_deg, phi_i_deg: Vec::new(), size, width_deg }
    }

    /// The same grid for a display that depends on azimuth: azimuths of the light in steps of `phi_step_deg`, a divisor of 90.
    pub fn around(step_deg: f64, phi_step_deg: f64, size: usize, widths: &LobeWidths) -> Self {
        let ahead = half_turn(phi_step_deg).into_iter().map(|phi| phi - 180.0);
        Self { phi_i_deg: ahead.chain([0.0]).collect(), ..Self::new(step_deg, size, widths) }
    }

    /// Inclination and azimuth of one direction of the light, number `light`, degrees; the azimuth is `None` for an isotropic display.
    fn light(&self, light: usize) -> (usize, Option<f64>) {
        let azimuths = self.phi_i_deg.len().max(1);
        (light / azimuths, self.phi_i_deg.get(light % azimuths).copied())
    }

    /// Returns inclinations of the light in steps of `step_deg` degrees, a divisor of 90, to 30 degrees, of
    /// half of it to 70 degrees, and of a quarter of it beyond; the last one is
    /// [`LAST_THETA_DEG`](Self::LAST_THETA_DEG).
    pub fn lights_deg(step_deg: f64) -> Vec<f64> {
        let mut lights = Vec::new();
        let mut quarters = 0_u32;
        loop {
            let theta = 0.25 * step_deg * f64::from(quarters);
            if theta > Self::LAST_THETA_DEG - 0.4 * step_deg {
                break;
            }
            lights.push(theta);
            quarters += match theta {
                theta if theta < 30.0 => 4,
                theta if theta < 70.0 => 2,
                _ => 1,
            };
        }
        lights.push(Self::LAST_THETA_DEG);
        lights
    }

    /// Density of the half vectors of one direction of the light, number `light`.
    pub fn density(&self, light: usize) -> NodeDensity {
        let (theta, phi) = self.light(light);
        let turn = phi.map(|phi_deg| phi_deg / 360.0);
        NodeDensity::new(self.theta_i_deg[theta], self.width_deg[theta], self.size, turn)
    }

    /// Returns u and v of the nodes of one direction of the light, `[row][column]`, with v relative to the azimuth of the light.
    pub fn nodes(&self, light: usize) -> Vec<[f64; 2]> {
        let steps = self.size.saturating_sub(1).max(1) as f64;
        let fractions: Vec<f64> = (0..self.size).map(|k| k as f64 / steps).collect();
        let (density, turn) = (self.density(light), self.light(light).1.unwrap_or(0.0) / 360.0);
        let row = |(row, v): (usize, &f64)| {
            let (u, v) = (density.places(row, &fractions), *v - turn);
            u.into_iter().map(move |u| [u, v])
        };
        fractions.iter().enumerate().flat_map(row).collect()
    }

    /// Returns the half vector of a point (u, v) of the square, relative to the azimuth of the light:
    /// inclination and azimuth, radians.
    pub fn half_vector([u, v]: [f64; 2]) -> [f64; 2] {
        [FRAC_PI_2 * u * u, TAU * v - PI]
    }

    /// Returns the viewer for light from `theta_i_deg` at a point (u, v); `None` below the horizon. Mirror images in the plane of
    /// incidence are the same.
    pub fn viewer(theta_i_deg: f64, at: [f64; 2]) -> Option<Viewer> {
        Viewer::of_vector(Self::mirrored(theta_i_deg, at))
    }

    /// Mirror direction of light from `theta_i_deg`, at azimuth 0, in the half vector of a point (u, v).
    fn mirrored(theta_i_deg: f64, at: [f64; 2]) -> [f64; 3] {
        let [theta_m, phi_m] = Self::half_vector(at);
        let (sin_i, cos_i) = theta_i_deg.to_radians().sin_cos();
        let (sin_m, cos_m) = theta_m.sin_cos();
        let m = [sin_m * phi_m.cos(), sin_m * phi_m.sin(), cos_m];
        let along = m[0] * sin_i + m[2] * cos_i;
        [2.0 * along * m[0] - sin_i, 2.0 * along * m[1], 2.0 * along * m[2] - cos_i]
    }

    /// Returns the factor by which density over (u, v) exceeds density over directions of the viewer, 1/sr,
    /// apart from the constant `8 pi^2`: `u sin(theta_m) cos(theta_d)`, with the angle theta_d between light
    /// and half vector.
    pub fn jacobian(theta_i_deg: f64, at: [f64; 2]) -> f64 {
        let [theta_m, phi_m] = Self::half_vector(at);
        let (sin_i, cos_i) = theta_i_deg.to_radians().sin_cos();
        at[0] * theta_m.sin() * (theta_m.sin() * phi_m.cos() * sin_i + theta_m.cos() * cos_i).max(0.0)
    }

    /// Returns the different viewers of one direction of the light, number `light`, and for each node,
    /// `[row][column]`, the number of its viewer; `None` below the horizon. Nodes that are mirror images in
    /// the plane of incidence have the same viewer.
    pub fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let (theta, phi) = self.light(light);
        let theta_i = self.theta_i_deg[theta];
        let nodes = self.nodes(light);
        let mut viewers = Vec::new();
        if phi.is_some() {
            let mut numbers: Vec<Option<usize>> = Vec::with_capacity(nodes.len());
            for (node, at) in nodes.iter().enumerate() {
                // All half vectors of the first column are along the normal; the first and the last row are the same.
                let same = if node % self.size == 0 && node > 0 {
                    Some(0)
                } else if node / self.size + 1 == self.size {
                    Some(node % self.size)
                } else {
                    None
                };
                let number = same.map(|same| numbers[same]).unwrap_or_else(|| {
                    Viewer::of_either_side(Self::mirrored(theta_i, *at)).map(|viewer| {
                        viewers.push(viewer);
                        viewers.len() - 1
                    })
                });
                numbers.push(number);
            }
            return (viewers, numbers);
        }
        let mut numbers: Vec<Option<usize>> = vec![None; self.size * self.size];
        for row in 0..self.size {
            for column in 0..self.size {
                // The azimuth of light along the normal is arbitrary, and so is that of a half vector along
                // it.
                let first_row = if theta_i == 0.0 || column == 0 { 0 } else { row.min(self.size - 1 - row) };
                numbers[row * self.size + column] = if first_row < row {
                    numbers[first_row * self.size + column]
                } else {
                    Self::viewer(theta_i, nodes[row * self.size + column]).map(|viewer| {
                        viewers.push(viewer);
                        viewers.len() - 1
                    })
                };
            }
        }
        (viewers, numbers)
    }

    /// Returns the number of values of a file of each of `states` states, all together, for a
    /// [`new`](Self::new) grid, or one [`around`](Self::around) with this step of azimuth.
    pub fn numbers(
        step_deg: f64,
        phi_step_deg: Option<f64>,
        size: usize,
        states: usize,
        wavelengths: usize,
    ) -> usize {
        let azimuths = phi_step_deg.map_or(1, |step| half_turn(step).len() + 1);
        [Self::lights_deg(step_deg).len(), azimuths, size, size, wavelengths]
            .iter()
            .fold(states, |product, length| product.saturating_mul(*length))
    }
}

impl ViewerGrid for HalfVectorGrid {
    fn theta_i_deg(&self) -> &[f64] {
        &self.theta_i_deg
    }

    fn phi_i_deg(&self) -> &[f64] {
        &self.phi_i_deg
    }

    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        self.viewers(light)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half vector along the normal is that of the mirror direction.
    #[test]
    fn first_column_is_the_mirror_direction() {
        for theta in [0.0, 20.0, 75.0] {
            let viewer = HalfVectorGrid::viewer(theta, [0.0, 0.3]).unwrap();
            assert!((viewer.theta_o_deg - theta).abs() < 1e-9);
            assert!(theta == 0.0 || (viewer.dphi_deg - 180.0).abs() < 1e-9);
        }
        // A facet towards the light sends it back.
        let at = [(30.0_f64 / 90.0).sqrt(), 0.5];
        let viewer = HalfVectorGrid::viewer(30.0, at).unwrap();
        assert!((viewer.theta_o_deg - 30.0).abs() < 1e-9 && viewer.dphi_deg < 1e-9, "{viewer:?}");
        assert_eq!(HalfVectorGrid::viewer(30.0, [1.0, 0.0]), None);
    }

    /// With azimuths, the viewer of a node is the mirror direction of the light in the half vector of the file, both by their azimuths.
    #[test]
    fn nodes_with_azimuths_are_half_vectors_by_their_azimuth() {
        let grid = HalfVectorGrid::around(45.0, 45.0, 8, &LobeWidths::constant(2.0));
        assert_eq!(grid.phi_i_deg, [-180.0, -135.0, -90.0, -45.0, 0.0]);
        let lights = grid.lights_deg();
        let unit = |theta_deg: f64, phi_deg: f64| {
            let ((sin, cos), (y, x)) = (theta_deg.to_radians().sin_cos(), phi_deg.to_radians().sin_cos());
            [sin * x, sin * y, cos]
        };
        for (light, [theta_i, phi_i]) in lights.into_iter().enumerate() {
            let (viewers, numbers) = grid.viewers(light);
            assert!(viewers.len() < 7 * 8 && viewers.len() > 20);
            for (node, number) in numbers.iter().enumerate() {
                let Some(viewer) = number.map(|number| viewers[number]) else { continue };
                let (i, o) = (unit(theta_i, phi_i), unit(viewer.theta_o_deg, phi_i + viewer.dphi_deg));
                let m: Vec<f64> = i.iter().zip(o).map(|(i, o)| i + o).collect();
                let u = (m[0].hypot(m[1]).atan2(m[2]) / FRAC_PI_2).sqrt();
                assert!((u - grid.nodes(light)[node][0]).abs() < 1e-6);
                let v = (m[1].atan2(m[0]) + PI) / TAU - (node / 8) as f64 / 7.0;
                assert!(u < 1e-6 || (v - v.round()).abs() < 1e-6, "{light} {node}: {v}");
            }
        }
    }

    /// Mirror images share a viewer, and the number of viewers is about half of that of the nodes.
    #[test]
    fn mirror_images_have_one_viewer() {
        let grid = HalfVectorGrid::new(30.0, 16, &LobeWidths::constant(2.0));
        assert_eq!(grid.theta_i_deg, [0.0, 30.0, 45.0, 60.0, 75.0, 89.0]);
        for light in 0..6 {
            let (viewers, numbers) = grid.viewers(light);
            for (node, number) in numbers.iter().enumerate() {
                let own = HalfVectorGrid::viewer(grid.theta_i_deg[light], grid.nodes(light)[node]);
                assert_eq!(number.is_some(), own.is_some());
                if let (Some(number), Some(own)) = (number, own) {
                    let shared = viewers[*number];
                    assert!((shared.theta_o_deg - own.theta_o_deg).abs() < 1e-6);
                    let turned = light == 0 || own.theta_o_deg < 1e-6;
                    assert!(turned || (shared.dphi_deg - own.dphi_deg).abs() < 1e-6);
                }
            }
            let most = if light == 0 { 16 } else { 16 * 8 };
            assert!(viewers.len() <= most, "{} viewers", viewers.len());
        }
    }

    /// The density of viewers over (u, v): the solid angle of the hemisphere is the integral of 8 pi^2 times
    /// the Jacobian.
    #[test]
    fn jacobian_integrates_to_the_solid_angle_of_the_hemisphere() {
        let steps = 400;
        for theta in [0.0, 40.0, 80.0] {
            let mut solid_angle = 0.0;
            for cell in 0..steps * steps {
                let at = [cell % steps, cell / steps].map(|k| (f64::from(k) + 0.5) / f64::from(steps));
                if HalfVectorGrid::viewer(theta, at).is_some() {
                    solid_angle += 8.0 * PI * PI * HalfVectorGrid::jacobian(theta, at);
                }
            }
            solid_angle /= f64::from(steps * steps);
            assert!((solid_angle / TAU - 1.0).abs() < 5e-3, "{theta}: {solid_angle}");
        }
    }
}
