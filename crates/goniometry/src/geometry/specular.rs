//! Grid of an imaging sphere: rings about the specular direction.
//!
//! Light comes from inclination `a` at azimuth 180 deg, so that its specular direction is `s = (sin a, 0, cos
//! a)`. A cell at radial distance `r` and azimuth `A` about it has the direction `d = cos r s + sin r (cos A
//! e0 + sin A e1)` with `e0 = (-cos a, 0, sin a)`, which points from `s` towards the normal, and `e1 = s x e0
//! = (0, -1, 0)`. Cells with `d.z < 0` are outside the hemisphere.
//!
//! For a sample rotated by `w` about its normal, counter-clockwise seen from the front, all directions are
//! rotated by `-w` relative to the sample: light comes from azimuth `180 - w`.

use super::axis::{Weights, around, between, mirrored};
use super::one_side::turn_weights;
use crate::Direction;

/// Grid of rings about the specular direction. Cells in the order rotation, incidence, azimuth, radial
/// distance, the last fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecularGrid {
    /// Rotations of the sample about its normal, degrees, ascending.
    pub rotations_deg: Vec<f64>,
    /// Inclinations of the light, degrees, ascending.
    pub incidences_deg: Vec<f64>,
    /// Azimuths about the specular direction, degrees, ascending.
    pub azimuths_deg: Vec<f64>,
    /// Distances from the specular direction, degrees, ascending.
    pub radials_deg: Vec<f64>,
    /// Symmetry of the azimuths.
    pub symmetry: Symmetry,
}

/// Symmetry of a grid's azimuths.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Azimuths 0 to 180 deg, mirrored in the plane of incidence.
    Plane,
    /// Full circle of azimuths.
    None,
}

impl SpecularGrid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rotations_deg.len()
            * self.incidences_deg.len()
            * self.azimuths_deg.len()
            * self.radials_deg.len()
    }

    /// Weights of the rotations in the mean over a full turn.
    pub(crate) fn rotation_weights(&self) -> Vec<f64> {
        turn_weights(&self.rotations_deg)
    }

    /// Directions of light and viewer of a cell, in the coordinates of the sample; `None` outside the
    /// hemisphere.
    pub(crate) fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        let (radials, azimuths) = (self.radials_deg.len(), self.azimuths_deg.len());
        let radial = self.radials_deg.get(cell.checked_rem(radials)?)?;
        let azimuth = self.azimuths_deg.get((cell / radials).checked_rem(azimuths)?)?;
        let incidence = cell / radials / azimuths;
        let incidences = self.incidences_deg.len();
        let incidence_deg = *self.incidences_deg.get(incidence.checked_rem(incidences)?)?;
        let rotation = self.rotations_deg.get(incidence / incidences)?;
        let viewer = Self::direction(incidence_deg, *azimuth, *radial)?;
        let light = Direction::new(incidence_deg, 180.0 - rotation);
        Some([light, Direction::new(viewer.theta_deg, viewer.phi_deg - rotation)])
    }

    /// Interpolates f linearly in rotation, incidence, azimuth and radial distance. Cells outside the
    /// hemisphere are ignored.
    pub(super) fn evaluate(&self, values: &[f64], i: Direction, o: Direction) -> Option<f64> {
        let turn = around(&self.rotations_deg, 180.0 - i.phi_deg)?;
        let incidence = between(&self.incidences_deg, i.theta_deg)?;
        let viewer = Direction::new(o.theta_deg, o.phi_deg + 180.0 - i.phi_deg);
        let (azimuth_deg, radial_deg) = Self::coordinates(i.theta_deg, viewer);
        let azimuth = match self.symmetry {
            _ if self.azimuths_deg.len() == 1 => [(0, 1.0), (0, 0.0)],
            Symmetry::Plane => mirrored(&self.azimuths_deg, azimuth_deg)?,
            Symmetry::None => around(&self.azimuths_deg, azimuth_deg)?,
        };
        self.mean(values, [turn, incidence, azimuth, between(&self.radials_deg, radial_deg)?])
    }

    /// Returns whether all cells about a direction have light at an incidence, given by its index, with
    /// azimuths no farther apart than this; the light comes from azimuth 180 deg. `false` next to the end of
    /// the measured cells.
    pub(crate) fn is_surrounded(
        &self,
        values: &[f64],
        incidence: usize,
        to: Direction,
        apart_deg: f64,
    ) -> bool {
        let (azimuth_deg, radial_deg) = Self::coordinates(self.incidences_deg[incidence], to);
        let azimuth = match self.symmetry {
            _ if self.azimuths_deg.len() == 1 => Some([(0, 1.0), (0, 0.0)]),
            Symmetry::Plane => mirrored(&self.azimuths_deg, azimuth_deg),
            Symmetry::None => around(&self.azimuths_deg, azimuth_deg),
        };
        let Some((azimuth, radial)) = azimuth.zip(between(&self.radials_deg, radial_deg)) else {
            return false;
        };
        let used = |weights: Weights| weights.into_iter().filter(|(_, weight)| *weight > 1e-6);
        let gap = (self.azimuths_deg[azimuth[1].0] - self.azimuths_deg[azimuth[0].0]).rem_euclid(360.0);
        let is_lit = |a: usize, r: usize| {
            (0..self.rotations_deg.len()).any(|turn| {
                let row = (turn * self.incidences_deg.len() + incidence) * self.azimuths_deg.len() + a;
                values.get(row * self.radials_deg.len() + r).is_some_and(|f| *f > 0.0)
            })
        };
        (used(azimuth).count() < 2 || gap <= apart_deg)
            && used(azimuth).all(|(a, _)| used(radial).all(|(r, _)| is_lit(a, r)))
    }

    /// Weighted mean of the neighbouring cells.
    fn mean(&self, values: &[f64], [turn, incidence, azimuth, radial]: [Weights; 4]) -> Option<f64> {
        let (mut sum, mut weight) = (0.0, 0.0);
        for corner in 0..16 {
            let pick = |weights: Weights, bit: usize| weights[corner >> bit & 1];
            let ((t, wt), (n, wn)) = (pick(turn, 0), pick(incidence, 1));
            let ((a, wa), (r, wr)) = (pick(azimuth, 2), pick(radial, 3));
            let weight_of_cell = wt * wn * wa * wr;
            let angles = [self.incidences_deg[n], self.azimuths_deg[a], self.radials_deg[r]];
            if weight_of_cell > 0.0 && Self::is_inside(angles) {
                let row = (t * self.incidences_deg.len() + n) * self.azimuths_deg.len() + a;
                sum += weight_of_cell * values.get(row * self.radials_deg.len() + r)?;
                weight += weight_of_cell;
            }
        }
        (weight > 0.0).then(|| sum / weight)
    }

    /// Returns true if a cell is in the hemisphere; tests the angles first, which is faster.
    fn is_inside([incidence_deg, azimuth_deg, radial_deg]: [f64; 3]) -> bool {
        incidence_deg + radial_deg < 89.999
            || Self::direction(incidence_deg, azimuth_deg, radial_deg).is_some()
    }

    /// Azimuth and radial distance, degrees, about the specular direction of light from azimuth 180 deg.
    fn coordinates(incidence_deg: f64, viewer: Direction) -> (f64, f64) {
        let (sin_a, cos_a) = incidence_deg.to_radians().sin_cos();
        let [x, y, z] = viewer.vector();
        let along = x * sin_a + z * cos_a;
        let [towards, across] = [z * sin_a - x * cos_a, -y];
        let aside = towards.hypot(across);
        // In the specular direction, up to rounding, the azimuth is undefined.
        let azimuth = if aside < 1e-12 { 0.0 } else { across.atan2(towards).to_degrees() };
        (azimuth, aside.atan2(along).to_degrees())
    }

    /// Direction of a cell, for light from azimuth 180 deg; `None` outside the hemisphere.
    pub fn direction(incidence_deg: f64, azimuth_deg: f64, radial_deg: f64) -> Option<Direction> {
        let (sin_a, cos_a) = incidence_deg.to_radians().sin_cos();
        let (sin_r, cos_r) = radial_deg.to_radians().sin_cos();
        let (sin_azimuth, cos_azimuth) = azimuth_deg.to_radians().sin_cos();
        let towards = sin_r * cos_azimuth;
        let d = [cos_r * sin_a - towards * cos_a, -sin_r * sin_azimuth, cos_r * cos_a + towards * sin_a];
        // The horizon is included, up to rounding.
        (d[2] >= -1e-12).then(|| Direction::of_vector([d[0], d[1], d[2].max(0.0)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The worked directions in the description of the format.
    #[test]
    fn cell_directions_equal_those_of_the_format_description() {
        for (azimuth, theta, phi) in [(0.0, 10.0, 0.0), (90.0, 35.531, -36.052), (180.0, 50.0, 0.0)] {
            let d = SpecularGrid::direction(30.0, azimuth, 20.0).unwrap();
            assert!((d.theta_deg - theta).abs() < 1e-3 && (d.phi_deg - phi).abs() < 1e-3, "{azimuth}: {d:?}");
        }
        assert_eq!(SpecularGrid::direction(75.0, 180.0, 20.0), None);
    }

    fn grid(symmetry: Symmetry, azimuths_deg: &[f64]) -> SpecularGrid {
        SpecularGrid {
            rotations_deg: vec![0.0, 90.0, 180.0, 270.0],
            incidences_deg: vec![0.0, 30.0, 60.0],
            azimuths_deg: azimuths_deg.to_vec(),
            radials_deg: vec![0.0, 10.0, 20.0, 40.0],
            symmetry,
        }
    }

    /// At its cells, a grid returns their values, for all azimuths of the light.
    #[test]
    fn evaluation_at_a_cell_returns_its_value() {
        let all = [0.0, 60.0, 120.0, 180.0, 240.0, 300.0];
        for (symmetry, azimuths) in [(Symmetry::Plane, &all[..4]), (Symmetry::None, &all[..])] {
            let grid = grid(symmetry, azimuths);
            let values: Vec<f64> = (0..grid.cells()).map(|cell| cell as f64).collect();
            for (cell, value) in values.iter().enumerate() {
                let Some([i, o]) = grid.directions(cell) else { continue };
                let f = grid.evaluate(&values, i, o).unwrap();
                // At the centre all azimuths coincide.
                if cell % 4 > 0 {
                    assert!((f - value).abs() < 1e-6, "{cell}: {f} {value}");
                }
            }
        }
    }

    /// A lobe about the specular direction moves with the light; there is no second peak between incidences.
    #[test]
    fn interpolated_lobe_moves_with_the_light() {
        let grid = SpecularGrid { rotations_deg: vec![0.0], ..grid(Symmetry::Plane, &[0.0, 180.0]) };
        let lobe = [10.0, 4.0, 1.0, 0.0];
        let values: Vec<f64> = lobe.iter().copied().cycle().take(grid.cells()).collect();
        for theta in [0.0, 12.0, 30.0, 45.0] {
            let light = Direction::new(theta, 77.0);
            let f =
                |beyond: f64| grid.evaluate(&values, light, Direction::new((theta + beyond).abs(), 257.0));
            assert!((f(0.0).unwrap() - 10.0).abs() < 1e-9);
            assert!((f(10.0).unwrap() - 4.0).abs() < 1e-9);
            assert!((f(15.0).unwrap() - 2.5).abs() < 1e-9);
        }
        let (high, far) = (Direction::new(61.0, 0.0), Direction::new(80.0, 0.0));
        assert_eq!(grid.evaluate(&values, high, high.specular()), None, "beyond the last incidence");
        assert_eq!(grid.evaluate(&values, Direction::new(0.0, 0.0), far), None, "beyond the last distance");
    }
}
