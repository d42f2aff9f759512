//! Grid warped according to a surface's facets: the RGL database (Dupuy & Jakob 2018, "An adaptive
//! parameterization for efficient material acquisition and rendering", ACM Trans. Graph. 37(6)).
//!
//! For each direction of the light, the distribution of visible facet normals (`vndf`, on a square of theta_m
//! and phi_m) determines where light goes. Its cumulative map takes half vectors to a second square, on which
//! the measured values are smooth. With `jacobian`, f cos(theta_o) = value x ndf(m) / (4 sigma(i)), where
//! `ndf` is the density of normals and `sigma` the projected area of the facets. Squares: `u =
//! sqrt(theta/(pi/2))`, `v = (phi + pi)/(2 pi)`; with at most two azimuths of the light, the sample is
//! isotropic, and phi_m is relative to that of the light. Reflection only.
//!
//! f is the stored f cos divided by the cosine. At the horizon, where the interpolated f cos does not vanish
//! exactly, f is unknown; where the cosine is below [`HORIZON_COS`], there is no value.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::axis::between;
use super::warp::{Warp, bilinear, nodes, patch};
use crate::Direction;

/// Data of a [`WarpedGrid`].
#[derive(Debug, Clone, PartialEq)]
pub struct WarpFields {
    /// Azimuths of the light, radians, ascending.
    pub phi_i: Vec<f64>,
    /// Inclinations of the light, radians, ascending.
    pub theta_i: Vec<f64>,
    /// Density of normals, `[phi][theta]`, with its numbers of rows and columns.
    pub ndf: (Vec<f64>, [usize; 2]),
    /// Projected area of the facets, `[phi][theta]`, with its numbers of rows and columns.
    pub sigma: (Vec<f64>, [usize; 2]),
    /// Density of visible normals, `[phi_i][theta_i][phi][theta]`, with its numbers of rows and columns.
    pub vndf: (Vec<f64>, [usize; 2]),
    /// Numbers of rows and columns of the values.
    pub shape: [usize; 2],
    /// True if the values are to be multiplied by ndf / (4 sigma).
    pub jacobian: bool,
}

/// Cosine of theta_o below which (from 89.94 deg) f cos / cos is a ratio of rounding and interpolation
/// errors. It excludes a fraction of 1e-6 of a Lambertian reflection.
const HORIZON_COS: f64 = 1e-3;

/// Warped grid. Cells in the order phi_i, theta_i, row, column, the last fastest. **The values of a part on
/// it are not f**, but those stored in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct WarpedGrid {
    fields: WarpFields,
    warp: Warp,
}

impl WarpedGrid {
    /// Grid from its data; `None` if the lengths are inconsistent, an axis does not ascend, or a density is
    /// negative or nowhere positive.
    pub fn new(fields: WarpFields) -> Option<Self> {
        let ascends = |axis: &[f64]| {
            let is_finite = !axis.is_empty() && axis.iter().all(|angle| angle.is_finite());
            is_finite && axis.windows(2).all(|pair| pair[0] < pair[1])
        };
        let fits = |(values, [rows, columns]): &(Vec<f64>, [usize; 2]), nodes: usize| {
            let sound = values.iter().all(|v| v.is_finite() && *v >= 0.0);
            let count = rows.checked_mul(*columns).and_then(|cells| cells.checked_mul(nodes));
            *rows >= 2 && *columns >= 2 && sound && count == Some(values.len())
        };
        let lights = fields.phi_i.len().checked_mul(fields.theta_i.len())?;
        let is_sound = ascends(&fields.phi_i)
            && ascends(&fields.theta_i)
            && fields.shape.iter().all(|length| *length >= 2)
            && fits(&fields.ndf, 1)
            && fits(&fields.sigma, 1)
            && fits(&fields.vndf, lights);
        let [rows, columns] = fields.vndf.1;
        let warp = is_sound.then(|| Warp::new(&fields.vndf.0, columns, rows))??;
        Some(Self { fields, warp })
    }

    /// The data of the grid.
    pub fn fields(&self) -> &WarpFields {
        &self.fields
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        let [rows, columns] = self.fields.shape;
        self.fields.phi_i.len() * self.fields.theta_i.len() * rows * columns
    }

    pub(super) fn is_isotropic(&self) -> bool {
        self.fields.phi_i.len() <= 2
    }

    /// Azimuths of the light, degrees, and their weights in the mean over a turn, of which the measured range is the whole,
    /// or a part that mirror symmetry repeats.
    pub(crate) fn lights_deg(&self) -> Vec<(f64, f64)> {
        let phi = &self.fields.phi_i;
        let weight = |k: usize| phi[(k + 1).min(phi.len() - 1)] - phi[k.saturating_sub(1)];
        (0..phi.len()).map(|k| (phi[k].to_degrees(), weight(k))).collect()
    }

    /// Reflects a pair into the measured range of azimuths by the sample's mirror symmetry: a half or a
    /// quarter of the circle, from -180 deg.
    fn reduced(&self, mut i: [f64; 3], mut o: [f64; 3]) -> [[f64; 3]; 2] {
        let phi = &self.fields.phi_i;
        let range = phi[phi.len() - 1] - phi[0];
        let sectors = if self.is_isotropic() { 1 } else { (TAU / range).round() as usize };
        if sectors >= 2 {
            let flip_y = i[1] > 0.0;
            let flip_x = if sectors == 4 { i[0] > 0.0 } else { flip_y };
            for (flip, k) in [(flip_x, 0), (flip_y, 1)] {
                if flip {
                    i[k] = -i[k];
                    o[k] = -o[k];
                }
            }
        }
        [i, o]
    }

    /// The measured directions of light around a direction, with their weights.
    fn lights(&self, phi_i: f64, theta_i: f64) -> Option<[(usize, f64); 4]> {
        let axis = &self.fields.phi_i;
        let phi = if self.is_isotropic() {
            // One or two azimuths represent all.
            between(axis, phi_i.clamp(axis[0], axis[axis.len() - 1]))
        } else {
            [phi_i, phi_i - TAU, phi_i + TAU].into_iter().find_map(|phi| between(axis, phi))
        };
        Some(nodes(phi?, between(&self.fields.theta_i, theta_i)?, self.fields.theta_i.len()))
    }

    pub(super) fn evaluate(&self, values: &[f64], i: Direction, o: Direction) -> Option<f64> {
        if values.len() != self.cells() {
            return None;
        }
        Some(self.weights(i, o)?.iter().map(|(cell, weight)| weight * values[*cell]).sum())
    }

    /// Cells and weights whose sum is f of any channel, for light from `i` towards `o`.
    pub(crate) fn weights(&self, i: Direction, o: Direction) -> Option<[(usize, f64); 16]> {
        let [i, o] = self.reduced(i.vector(), o.vector());
        if o[2] < HORIZON_COS {
            return None;
        }
        let m = Direction::of_vector([i[0] + o[0], i[1] + o[1], i[2] + o[2]]);
        let light = Direction::of_vector(i);
        let (theta_i, phi_i) = (light.theta_deg.to_radians(), light.phi_deg.to_radians());
        let phi_m = m.phi_deg.to_radians() - if self.is_isotropic() { phi_i } else { 0.0 };
        let at_m = [(m.theta_deg.to_radians() / FRAC_PI_2).sqrt(), ((phi_m + PI) / TAU).rem_euclid(1.0)];
        let fields = &self.fields;
        let lights = self.lights(phi_i, theta_i)?;
        let [x, y] = self.warp.invert(&lights, at_m)?;
        let [rows, columns] = fields.shape;
        let on = |(grid, [rows, columns]): &(Vec<f64>, [usize; 2]), at| {
            bilinear(|cell| grid[cell], *columns, *rows, at)
        };
        let mut factor = 1.0 / o[2];
        if fields.jacobian {
            let at_i = [(theta_i / FRAC_PI_2).sqrt(), (phi_i + PI) / TAU];
            factor *= on(&fields.ndf, at_m) / (4.0 * on(&fields.sigma, at_i));
        }
        let ((column, x), (row, y)) = (patch(x, columns), patch(y, rows));
        Some(std::array::from_fn(|k| {
            let ((node, weight), dx, dy) = (lights[k / 4], k % 2, k / 2 % 2);
            let corner = if dx == 1 { x } else { 1.0 - x } * if dy == 1 { y } else { 1.0 - y };
            (node * rows * columns + (row + dy) * columns + column + dx, factor * weight * corner)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields() -> WarpFields {
        WarpFields {
            phi_i: vec![0.0],
            theta_i: vec![0.0, FRAC_PI_2],
            ndf: (vec![3.0; 4], [2, 2]),
            sigma: (vec![0.5; 4], [2, 2]),
            // 2u: its cumulative map is u^2 = theta_m / 90 deg.
            vndf: ([0.0, 2.0, 0.0, 2.0].repeat(2), [2, 2]),
            shape: [2, 2],
            jacobian: true,
        }
    }

    /// Light from 30 deg, viewer at 50 deg on the other side of the normal: theta_m = 10 deg, and values that
    /// increase with the first uniform number give 1/9 x 3/(4 x 0.5) / cos 50 deg.
    #[test]
    fn isotropic_value_equals_hand_computation() {
        let grid = WarpedGrid::new(fields()).unwrap();
        let values = [0.0, 1.0, 0.0, 1.0].repeat(2);
        for turn in [0.0, 123.0] {
            let (i, o) = (Direction::new(30.0, turn), Direction::new(50.0, 180.0 + turn));
            let f = grid.evaluate(&values, i, o).unwrap();
            let expected = 1.5 / 9.0 / 50_f64.to_radians().cos();
            assert!((f / expected - 1.0).abs() < 1e-9, "{f} {expected}");
        }
    }

    /// With azimuths over a quarter of the circle, the others are found by reflection.
    #[test]
    fn quarter_of_azimuths_is_mirrored_to_full_circle() {
        let quarter = WarpFields {
            phi_i: vec![-PI, -0.75 * PI, -FRAC_PI_2],
            vndf: (vec![1.0; 24], [2, 2]),
            jacobian: false,
            ..fields()
        };
        let grid = WarpedGrid::new(quarter).unwrap();
        let values: Vec<f64> = (0..24).map(|cell| f64::from(1 + cell / 8)).collect();
        for (azimuth, value) in
            [(-180.0, 1.0), (-135.0, 2.0), (-45.0, 2.0), (45.0, 2.0), (0.0, 1.0), (90.0, 3.0), (112.5, 2.5)]
        {
            let f = grid.evaluate(&values, Direction::new(30.0, azimuth), Direction::new(0.0, 0.0));
            assert!((f.unwrap() - value).abs() < 1e-9, "{azimuth}: {f:?}");
        }
        let eighth = WarpFields { phi_i: vec![-PI, -3.0, -2.9], vndf: (vec![1.0; 24], [2, 2]), ..fields() };
        let f = WarpedGrid::new(eighth).unwrap().evaluate(
            &values,
            Direction::new(30.0, 90.0),
            Direction::new(0.0, 0.0),
        );
        assert_eq!(f, None, "nothing is extrapolated");
    }

    #[test]
    fn inconsistent_fields_are_refused() {
        for spoil in [
            |f: &mut WarpFields| f.theta_i = vec![1.0, 0.0],
            |f: &mut WarpFields| f.phi_i = vec![],
            |f: &mut WarpFields| f.phi_i = vec![f64::NAN],
            |f: &mut WarpFields| f.vndf.0.truncate(7),
            |f: &mut WarpFields| f.vndf.0[0] = -1.0,
            |f: &mut WarpFields| f.vndf.0 = vec![0.0; 8],
            |f: &mut WarpFields| f.ndf.1 = [usize::MAX, 2],
            |f: &mut WarpFields| f.shape = [1, 2],
        ] {
            let mut fields = fields();
            spoil(&mut fields);
            assert_eq!(WarpedGrid::new(fields), None);
        }
    }
}
