//! Half and difference angles (Rusinkiewicz 1998), as the MERL database has them (Matusik et al. 2003).
//!
//! For an isotropic, reciprocal surface in reflection: `theta_h` is the inclination of the half vector,
//! `theta_d` and `phi_d` are the direction of the light about it. phi_d goes to 180 deg; beyond lies
//! the reciprocal pair. theta_h is denser near 0, where mirrors have their peak: cell
//! `90 sqrt(theta_h/90 deg)`.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::Direction;

/// The grid of the MERL database: cells in the order theta_h, theta_d, phi_d, the last fastest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct HalfAngleGrid;

impl HalfAngleGrid {
    /// How many cells of theta_h, theta_d and phi_d there are.
    pub const SHAPE: [usize; 3] = [90, 90, 180];

    /// How many cells there are.
    pub fn cells(&self) -> usize {
        Self::SHAPE.iter().product()
    }

    /// The cell of light from `i` towards `o`; `None` for grazing pairs without a half vector.
    pub(super) fn cell(&self, i: Direction, o: Direction) -> Option<usize> {
        let (i, o) = (i.vector(), o.vector());
        let sum = [i[0] + o[0], i[1] + o[1], i[2] + o[2]];
        let half = Direction::of_vector(sum);
        if sum.map(f64::abs).iter().sum::<f64>() < 1e-9 {
            return None;
        }
        let (theta_h, phi_h) = (half.theta_deg.to_radians(), half.phi_deg.to_radians());
        let difference = Direction::of_vector(about_y(about_z(i, -phi_h), -theta_h));
        let (theta_d, mut phi_d) = (difference.theta_deg.to_radians(), difference.phi_deg.to_radians());
        if phi_d < 0.0 {
            phi_d += PI;
        }
        let [h, d, p] = Self::SHAPE;
        let place = |share: f64, cells: usize| ((share * cells as f64) as usize).min(cells - 1);
        let h_at = place((theta_h / FRAC_PI_2).sqrt(), h);
        Some((h_at * d + place(theta_d / FRAC_PI_2, d)) * p + place(phi_d / PI, p))
    }

    /// Light and viewer of the middle of a cell, the half vector at azimuth 0.
    pub(super) fn directions(&self, cell: usize) -> Option<[Direction; 2]> {
        let [h, d, p] = Self::SHAPE;
        let middle = |number: usize, cells: usize| (number as f64 + 0.5) / cells as f64;
        let theta_h = middle(cell / (p * d), h).powi(2) * FRAC_PI_2;
        let theta_d = middle(cell / p % d, d) * FRAC_PI_2;
        let phi_d = middle(cell % p, p) * PI;
        let difference = Direction::new(theta_d.to_degrees(), phi_d.to_degrees()).vector();
        let mirrored = [-difference[0], -difference[1], difference[2]];
        let [i, o] = [difference, mirrored].map(|d| about_y(d, theta_h));
        (cell < self.cells() && i[2] >= 0.0 && o[2] >= 0.0)
            .then(|| [Direction::of_vector(i), Direction::of_vector(o)])
    }
}

fn about_z([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [x * cos - y * sin, x * sin + y * cos, z]
}

fn about_y([x, y, z]: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    [x * cos + z * sin, y, z * cos - x * sin]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_their_middles() {
        let grid = HalfAngleGrid;
        let mut inside = 0;
        for cell in (0..grid.cells()).step_by(97) {
            if let Some([i, o]) = grid.directions(cell) {
                inside += 1;
                assert_eq!(grid.cell(i, o), Some(cell));
                let [i, o] = [i, o].map(|d| Direction::new(d.theta_deg, d.phi_deg + 77.0));
                assert_eq!(grid.cell(i, o), Some(cell), "the sample is alike in all azimuths");
                assert_eq!(grid.cell(o, i), Some(cell), "and reciprocal");
            }
        }
        assert!(inside > 5000);
    }

    /// Light from 45.5 deg towards its mirror direction: theta_h 0, theta_d 45.5.
    #[test]
    fn a_worked_direction() {
        let light = Direction::new(45.5, 0.0);
        assert_eq!(HalfAngleGrid.cell(light, light.specular()).map(|cell| cell / 180), Some(45));
        // Both from 40 deg: theta_d 0, theta_h 40, and sqrt(40/90) 90 = 60.
        assert_eq!(
            HalfAngleGrid.cell(Direction::new(40.2, 9.0), Direction::new(40.2, 9.0)).map(|c| c / 16200),
            Some(60)
        );
    }
}
