//! Half and difference angles (Rusinkiewicz 1998), as in the MERL database (Matusik et al. 2003).
//!
//! For an isotropic, reciprocal surface in reflection: `theta_h` is the inclination of the half vector,
//! `theta_d` and `phi_d` are the direction of the light relative to it. phi_d ranges to 180 deg; beyond are
//! the reciprocal pairs. The grid of theta_h is denser near 0, where specular reflection has its peak: cell
//! `90 sqrt(theta_h/90 deg)`.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::Direction;

/// Grid of the MERL database: cells in the order theta_h, theta_d, phi_d, the last fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HalfAngleGrid;

impl HalfAngleGrid {
    /// Numbers of cells of theta_h, theta_d and phi_d.
    pub const SHAPE: [usize; 3] = [90, 90, 180];

    /// Number of cells.
    pub fn cells(&self) -> usize {
        Self::SHAPE.iter().product()
    }

    /// Returns the cell of light from `i` towards `o`; `None` for grazing pairs without a half vector.
    pub(super) fn cell(&self, i: Direction, o: Direction) -> Option<usize> {
        let (i, o) = (i.vector(), o.vector());
        let sum = [i[0] + o[0], i[1] + o[1], i[2] + o[2]];
        let half = Direction::of_vector(sum);
        if sum.map(f64::abs).iter().sum::<f64>() < 1e-9 {
            return None;
        }
        let (theta_h, phi_h) = (half.theta_deg.to_radians(), half.phi_deg.to_radians());
        let difference = Direction::of_vector(rotated_about_y(rotated_about_z(i, -phi_h), -theta_h));
        let (theta_d, mut phi_d) = (difference.theta_deg.to_radians(), difference.phi_deg.to_radians());
        if phi_d < 0.0 {
            phi_d += PI;
        }
        let [h, d, p] = Self::SHAPE;
        let index = |fraction: f64, cells: usize| ((fraction * cells as f64) as usize).min(cells - 1);
        let h_index = index((theta_h / FRAC_PI_2).sqrt(), h);
        Some((h_index * d + index(theta_d / FRAC_PI_2, d)) * p + index(phi_d / PI, p))
    }

    /// Directions of light and viewer at the centre of a cell, with the half vector at azimuth 0.
    pub(super) fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        let [h, d, p] = Self::SHAPE;
        let centre = |number: usize, cells: usize| (number as f64 + 0.5) / cells as f64;
        let theta_h = centre(cell / (p * d), h).powi(2) * FRAC_PI_2;
        let theta_d = centre(cell / p % d, d) * FRAC_PI_2;
        let phi_d = centre(cell % p, p) * PI;
        let difference = Direction::new(theta_d.to_degrees(), phi_d.to_degrees()).vector();
        let mirrored = [-difference[0], -difference[1], difference[2]];
        let [i, o] = [difference, mirrored].map(|d| rotated_about_y(d, theta_h));
        (cell < self.cells() && i[2] >= 0.0 && o[2] >= 0.0)
            .then(|| [Direction::of_vector(i), Direction::of_vector(o)])
    }
}

fn rotated_about_z([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos, z]
}

fn rotated_about_y([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [x * cos + z * sin, y, z * cos - x * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cell_centres_are_in_their_cells() {
        let grid = HalfAngleGrid;
        let mut inside = 0;
        for cell in (0..grid.cells()).step_by(97) {
            if let Some([i, o]) = grid.directions(cell) {
                inside += 1;
                assert_eq!(grid.cell(i, o), Some(cell));
                let [i, o] = [i, o].map(|d| Direction::new(d.theta_deg, d.phi_deg + 77.0));
                assert_eq!(grid.cell(i, o), Some(cell), "isotropic");
                assert_eq!(grid.cell(o, i), Some(cell), "reciprocal");
            }
        }
        assert!(inside > 5000);
    }

    /// Light from 45.5 deg towards its mirror direction: theta_h = 0, theta_d = 45.5 deg.
    #[test]
    fn cells_of_mirror_and_retroreflection_equal_hand_computation() {
        let light = Direction::new(45.5, 0.0);
        assert_eq!(HalfAngleGrid.cell(light, light.specular()).map(|cell| cell / 180), Some(45));
        // Both from 40 deg: theta_d = 0, theta_h = 40 deg, and sqrt(40/90) 90 = 60.
        assert_eq!(
            HalfAngleGrid.cell(Direction::new(40.2, 9.0), Direction::new(40.2, 9.0)).map(|c| c / 16200),
            Some(60)
        );
    }
}
