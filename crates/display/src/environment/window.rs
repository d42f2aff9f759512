//! The light that a glossmeter's receptor accepts: a rectangular window around a direction.
//!
//! # Model
//! The source and the receptor of a glossmeter are rectangles with angular sizes in the plane of incidence and across it.
//! Light that leaves the sample with a small deviation from the mirror direction falls into the receptor for a part of the
//! source: along each of the two axes, the overlap of an interval of the receptor's width with one of the source's width.
//! The window is the product of both overlaps, relative to the whole source: 1 within half of the difference of the
//! widths, 0 beyond half of their sum, linear between.
//!
//! The axis in the plane is the angle about the normal of that plane; the axis across is the angle from the plane.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use papilio_transport::{Edge, Field, Radiance};

use super::pose::by_inclination;

/// A receptor and the source whose image falls on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeterWindow {
    /// Inclination of its middle, degrees, 0 to 90.
    pub theta_deg: f64,
    /// Azimuth of its middle, degrees.
    pub phi_deg: f64,
    /// Angular size of the source: in the plane of incidence and across, degrees.
    pub source_deg: [f64; 2],
    /// The same of the receptor.
    pub receptor_deg: [f64; 2],
}

/// Rows and columns across the window of the cells from which directions are sampled.
const CELLS: usize = 16;
/// Columns of a whole circle, at most.
const MOST_COLUMNS: f64 = 7200.0;

impl MeterWindow {
    /// Returns, along each axis, the angles from the middle at which the accepted fraction begins to decrease and at which it ends,
    /// radians; and the largest fraction: below 1 if the receptor is smaller than the source.
    pub(crate) fn trapezium(&self) -> ([[f64; 2]; 2], [f64; 2]) {
        let both = |axis: usize| [self.source_deg[axis], self.receptor_deg[axis]].map(f64::to_radians);
        let ends = [0, 1].map(|axis| {
            let [source, receptor] = both(axis);
            [0.5 * (source - receptor).abs(), 0.5 * (source + receptor)]
        });
        let most = [0, 1].map(|axis| {
            let [source, receptor] = both(axis);
            (receptor / source).min(1.0)
        });
        (ends, most)
    }

    /// Returns the light that the window accepts, for unit irradiance, and the irradiance in the plane of the display of the
    /// window itself, sr; `None` if the window extends below the horizon.
    pub fn light(&self) -> Option<(Field, f64)> {
        let accepted = Accepted::new(self);
        let [from, to] = accepted.span();
        if to >= FRAC_PI_2 {
            return None;
        }
        let edges: Vec<f64> =
            (0..=CELLS).map(|row| (from + (to - from) * row as f64 / CELLS as f64).to_degrees()).collect();
        let across = 2.0 * accepted.ends[1][1] / to.sin();
        let columns = (CELLS as f64 * 2.0 * PI / across).clamp(16.0, MOST_COLUMNS).ceil() as usize;
        let mean = |row: usize, column: usize| {
            let part = |k: usize| (k as f64 + 0.5) / 4.0;
            let at = |k: usize| {
                let theta = edges[row] + (edges[row + 1] - edges[row]) * part(k % 4);
                let phi = 2.0 * PI * (column as f64 + part(k / 4)) / columns as f64;
                accepted.at(by_inclination(theta.to_radians(), phi))
            };
            (0..16).map(at).sum::<f64>() / 16.0
        };
        let cells = (0..CELLS * columns).map(|cell| mean(cell / columns, cell % columns)).collect();
        Field::of(Arc::new(accepted), &edges, columns, cells)
    }
}

/// The window in the frame of its plane of incidence.
#[derive(Debug)]
struct Accepted {
    /// Unit vectors: the middle of the window; in the plane, towards larger inclination; across.
    frame: [[f64; 3]; 3],
    /// Along each axis, the angles from the middle at which the fraction begins to decrease, and at which it ends, radians.
    ends: [[f64; 2]; 2],
    /// Largest fraction along each axis: below 1 if the receptor is smaller than the source.
    most: [f64; 2],
    middle: f64,
}

impl Accepted {
    fn new(window: &MeterWindow) -> Self {
        let (theta, phi) = (window.theta_deg.to_radians(), window.phi_deg.to_radians());
        let frame = [
            by_inclination(theta, phi),
            by_inclination(theta + FRAC_PI_2, phi),
            by_inclination(FRAC_PI_2, phi + FRAC_PI_2),
        ];
        let (ends, most) = window.trapezium();
        Self { frame, ends, most, middle: theta }
    }
}

impl Radiance for Accepted {
    fn at(&self, direction: [f64; 3]) -> f64 {
        let [along, in_plane, across] =
            self.frame.map(|axis| axis.iter().zip(direction).map(|(a, b)| a * b).sum::<f64>());
        let angles = [in_plane.atan2(along), across.clamp(-1.0, 1.0).asin()];
        let fraction = |axis: usize| {
            let [from, to] = self.ends[axis];
            self.most[axis] * ((to - angles[axis].abs()) / (to - from)).clamp(0.0, 1.0)
        };
        fraction(0) * fraction(1)
    }

    fn edges(&self) -> Vec<Edge> {
        let [middle, in_plane, across] = self.frame;
        let signed = |axis: usize| self.ends[axis].into_iter().flat_map(|end| [end, -end]);
        // The angle in the plane is constant on half of a great circle.
        let meridian = |end: f64| {
            let (sin, cos) = end.sin_cos();
            let centre = std::array::from_fn(|i| cos * in_plane[i] - sin * middle[i]);
            Edge { centre, radius: FRAC_PI_2, scale: f64::INFINITY }
        };
        let parallel = |end: f64| Edge { centre: across, radius: FRAC_PI_2 - end, scale: f64::INFINITY };
        signed(0).map(meridian).chain(signed(1).map(parallel)).collect()
    }

    fn span(&self) -> [f64; 2] {
        let [half, across] = self.ends.map(|[_, end]| end);
        // The cosine of the inclination is that in the plane times the cosine of the angle across.
        let least = (self.middle - half).max(0.0);
        let most = ((self.middle + half).cos() * across.cos()).acos();
        [least, most]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    const GLOSS_20: MeterWindow =
        MeterWindow { theta_deg: 20.0, phi_deg: 0.0, source_deg: [0.75, 2.5], receptor_deg: [1.8, 3.6] };

    /// The integral of each overlap is the product of the widths, so that the irradiance is close to the receptor's solid
    /// angle times the cosine.
    #[test]
    fn irradiance_is_that_of_the_receptor() {
        for theta_deg in [0.5, 20.0, 60.0] {
            let (_, irradiance) = MeterWindow { theta_deg, ..GLOSS_20 }.light().unwrap();
            let receptor = 1.8_f64.to_radians() * 3.6_f64.to_radians();
            let expected = receptor * theta_deg.to_radians().cos();
            assert!((irradiance / expected - 1.0).abs() < 1e-3, "{theta_deg}: {irradiance} {expected}");
        }
        assert!(MeterWindow { theta_deg: 89.0, ..GLOSS_20 }.light().is_none());
    }

    /// Whole in the middle, half where the edge of the receptor halves the source's image, nothing beyond.
    #[test]
    fn window_is_whole_in_the_middle_and_ends() {
        let (light, irradiance) = GLOSS_20.light().unwrap();
        let at = |theta: f64| irradiance * light.radiance(Beta::from_source(theta, 0.0, 1.0));
        for (off, fraction) in [(0.0, 1.0), (0.5, 1.0), (0.9, 0.5), (-0.9, 0.5), (1.2, 0.1), (1.3, 0.0)] {
            assert!((at(20.0 + off) - fraction).abs() < 1e-9, "{off}: {}", at(20.0 + off));
        }
    }

    /// All that is lit can be sampled.
    #[test]
    fn sampled_directions_cover_the_window() {
        for window in [GLOSS_20, MeterWindow { theta_deg: 1.0, phi_deg: 130.0, ..GLOSS_20 }] {
            let (light, irradiance) = window.light().unwrap();
            let mut sum = 0.0;
            let side = 1000;
            for k in 0..side * side {
                let u = [k % side, k / side].map(|i| (i as f64 + 0.5) / f64::from(side));
                let (beta, density) = light.sample(u);
                sum += light.radiance(beta) / density;
            }
            let mean = sum / f64::from(side * side);
            assert!((mean - 1.0).abs() < 3e-3, "{mean} {irradiance}");
        }
    }
}
