//! Smooth interpolation of a grid of inclinations between the viewer's directions.

use super::line::Line;
use crate::{Direction, SphericalGrid};

/// Values of one channel on a grid of inclinations and azimuths. The logarithm is interpolated cubically in
/// the viewer's azimuth and then in the inclination, and linearly next to zeros ([`Line`]), for light from
/// the grid's own inclinations and its first azimuth.
pub(super) struct Smooth<'a> {
    grid: &'a SphericalGrid,
    values: &'a [f64],
    /// Ascending azimuths from that of the light, degrees, with their indices on the grid's axis: a little
    /// more than one turn.
    azimuths: Vec<(f64, usize)>,
    /// True if the azimuths of one side represent both.
    mirrored: bool,
}

impl<'a> Smooth<'a> {
    pub(super) fn new(grid: &'a SphericalGrid, values: &'a [f64]) -> Self {
        let light = grid.phi_i_deg.first().copied().unwrap_or(0.0);
        let axis: Vec<(f64, usize)> =
            grid.phi_o_deg.iter().enumerate().map(|(place, phi)| (phi - light, place)).collect();
        let mirrored = grid.is_half();
        let copy = |sign: f64, turn: f64| axis.iter().map(move |(phi, place)| (sign * phi + turn, *place));
        let mut azimuths: Vec<(f64, usize)> = if mirrored {
            copy(1.0, 0.0).chain(copy(-1.0, 0.0)).chain(copy(-1.0, 360.0)).collect()
        } else {
            copy(1.0, 0.0).chain(copy(1.0, -360.0)).chain(copy(1.0, 360.0)).collect()
        };
        azimuths.sort_by(|a, b| a.0.total_cmp(&b.0));
        azimuths.dedup_by(|b, a| b.0 - a.0 < 1e-9);
        Self { grid, values, azimuths, mirrored }
    }

    /// Returns f for light from one of the grid's inclinations, given by its index, towards `o`, interpolated
    /// between the grid's directions.
    pub(super) fn value(&self, theta_i: usize, o: Direction) -> f64 {
        let light = self.grid.phi_i_deg.first().copied().unwrap_or(0.0);
        let turned = (o.phi_deg - light).rem_euclid(360.0);
        let phi = if self.mirrored { turned.min(360.0 - turned) } else { turned };
        let azimuths = &self.azimuths[around(&self.azimuths, |(known, _)| *known <= phi)];
        let angles: Vec<f64> = azimuths.iter().map(|(angle, _)| *angle).collect();
        let thetas = around(&self.grid.theta_o_deg, |known| *known <= o.theta_deg);
        let first = theta_i * self.grid.phi_i_deg.len() * self.grid.theta_o_deg.len();
        let ring = |theta_o: usize| {
            let cell = (first + theta_o) * self.grid.phi_o_deg.len();
            let values: Vec<f64> = azimuths.iter().map(|(_, place)| self.values[cell + place]).collect();
            through_measured(&angles, &values, phi)
        };
        let rings: Vec<f64> = thetas.clone().map(ring).collect();
        through_measured(&self.grid.theta_o_deg[thetas], &rings, o.theta_deg)
    }
}

/// Value at `x` of the line through the measured ones of a few points; NaN if none was measured.
fn through_measured(axis: &[f64], values: &[f64], x: f64) -> f64 {
    let known = || axis.iter().zip(values).filter(|(_, value)| value.is_finite());
    let values: Vec<f64> = known().map(|(_, value)| *value).collect();
    if values.is_empty() { f64::NAN } else { Line::new(known().map(|(x, _)| *x).collect(), &values).value(x) }
}

/// Range of the two nodes before and the two after the point where `below` becomes false; fewer at the ends
/// of the axis.
fn around<T>(axis: &[T], below: impl FnMut(&T) -> bool) -> std::ops::Range<usize> {
    let upper = axis.partition_point(below);
    upper.saturating_sub(2)..(upper + 2).min(axis.len())
}
