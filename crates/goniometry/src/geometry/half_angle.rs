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

    /// Interpolates f linearly between the centres of cells in their numbers, of every n-th cell along each axis: in the root of
    /// theta_h, theta_d and phi_d. Before the first centre and beyond the last one, theta_h and theta_d are those of the centre, because
    /// f is an even function of both at 0. Cells that were not measured do not take part; `None` in them, and for grazing
    /// pairs without a half vector.
    pub(crate) fn evaluate(&self, values: &[f64], [i, o]: [Direction; 2], every: [usize; 3]) -> Option<f64> {
        let place = Self::place(i, o)?;
        values.get(Self::cell_at(place)).filter(|f| f.is_finite())?;
        // Numbers of the centres below and above, and the fraction of the latter.
        let between: [(usize, usize, f64); 3] = std::array::from_fn(|axis| {
            let (cells, step) = (Self::SHAPE[axis], every[axis]);
            let count = cells.div_ceil(step);
            let at = (place[axis] - 0.5) / step as f64;
            if axis == 2 {
                let low = at.floor();
                let turned = low.rem_euclid(count as f64) as usize % count;
                return (step * turned, step * ((turned + 1) % count), at - low);
            }
            let at = at.clamp(0.0, (count - 1) as f64);
            let low = at as usize;
            (step * low, step * (low + 1).min(count - 1), at - low as f64)
        });
        let (mut sum, mut weights) = (0.0, 0.0);
        for corner in 0..8 {
            let picked: [(usize, f64); 3] = std::array::from_fn(|axis| {
                let (low, high, fraction) = between[axis];
                if corner >> axis & 1 == 0 { (low, 1.0 - fraction) } else { (high, fraction) }
            });
            let weight: f64 = picked.iter().map(|(_, weight)| weight).product();
            let f = values.get(Self::number(picked.map(|(number, _)| number))).copied();
            if let Some(f) = f.filter(|f| f.is_finite() && weight > 0.0) {
                sum += weight * f;
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// Place of light from `i` towards `o` on the axes of theta_h, theta_d and phi_d, in cells.
    fn place(i: Direction, o: Direction) -> Option<[f64; 3]> {
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
        let [h, d, p] = Self::SHAPE.map(|cells| cells as f64);
        Some([h * (theta_h / FRAC_PI_2).sqrt(), d * theta_d / FRAC_PI_2, p * phi_d / PI])
    }

    /// Cell of a place.
    fn cell_at(place: [f64; 3]) -> usize {
        Self::number(std::array::from_fn(|axis| (place[axis] as usize).min(Self::SHAPE[axis] - 1)))
    }

    fn number([h, d, p]: [usize; 3]) -> usize {
        (h * Self::SHAPE[1] + d) * Self::SHAPE[2] + p
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

    fn cell_of(i: Direction, o: Direction) -> Option<usize> {
        HalfAngleGrid::place(i, o).map(HalfAngleGrid::cell_at)
    }

    #[test]
    fn cell_centres_are_in_their_cells() {
        let grid = HalfAngleGrid;
        let mut inside = 0;
        for cell in (0..grid.cells()).step_by(97) {
            if let Some([i, o]) = grid.directions(cell) {
                inside += 1;
                assert_eq!(cell_of(i, o), Some(cell));
                let [i, o] = [i, o].map(|d| Direction::new(d.theta_deg, d.phi_deg + 77.0));
                assert_eq!(cell_of(i, o), Some(cell), "isotropic");
                assert_eq!(cell_of(o, i), Some(cell), "reciprocal");
            }
        }
        assert!(inside > 5000);
    }

    /// Light from 45.5 deg towards its mirror direction: theta_h = 0, theta_d = 45.5 deg.
    #[test]
    fn cells_of_mirror_and_retroreflection_equal_hand_computation() {
        let light = Direction::new(45.5, 0.0);
        assert_eq!(cell_of(light, light.specular()).map(|cell| cell / 180), Some(45));
        // Both from 40 deg: theta_d = 0, theta_h = 40 deg, and sqrt(40/90) 90 = 60.
        assert_eq!(
            cell_of(Direction::new(40.2, 9.0), Direction::new(40.2, 9.0)).map(|c| c / 16200),
            Some(60)
        );
    }

    /// Numbers that are linear on each axis are interpolated exactly, reciprocally, and across the seam of phi_d; a cell that was
    /// not measured has no value and does not change that of its neighbours.
    #[test]
    fn values_between_centres_are_linear() {
        let grid = HalfAngleGrid;
        let [_, d, p] = HalfAngleGrid::SHAPE;
        let folded = |number: usize| (number as f64 - 89.5).abs();
        let mut values: Vec<f64> = (0..grid.cells())
            .map(|cell| 1.0 + (cell / (p * d)) as f64 + 3.0 * (cell / p % d) as f64 + folded(cell % p))
            .collect();
        let pairs = [
            (31.0, 4.0, 52.0, 155.0),
            (8.0, 0.0, 9.3, 181.0),
            (60.0, 10.0, 45.0, 97.0),
            (0.0, 0.0, 20.0, 3.0),
        ];
        for (theta_i, phi_i, theta_o, phi_o) in pairs {
            let pair = [Direction::new(theta_i, phi_i), Direction::new(theta_o, phi_o)];
            let [h, d, p] = HalfAngleGrid::place(pair[0], pair[1]).unwrap();
            // At 90 and at 180 deg, both neighbours have the same number.
            let folded = (p - 90.0).abs().clamp(0.5, 89.5);
            let expected = 1.0 + (h - 0.5).max(0.0) + 3.0 * (d - 0.5).max(0.0) + folded;
            for pair in [pair, [pair[1], pair[0]]] {
                let f = grid.evaluate(&values, pair, [1; 3]).unwrap();
                assert!((f - expected).abs() < 1e-6, "{pair:?}: {f} {expected}");
            }
        }
        let pair = [Direction::new(31.0, 4.0), Direction::new(52.0, 155.0)];
        let place = HalfAngleGrid::place(pair[0], pair[1]).unwrap();
        let own = HalfAngleGrid::cell_at(place);
        values.iter_mut().enumerate().filter(|(cell, _)| *cell != own).for_each(|(_, f)| *f = f64::NAN);
        assert_eq!(grid.evaluate(&values, pair, [1; 3]), Some(values[own]));
        values[own] = f64::NAN;
        assert_eq!(grid.evaluate(&values, pair, [1; 3]), None);
    }
}
