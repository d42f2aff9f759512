//! Test patterns of black and white, with the fraction of each pixel that is black.
//!
//! Edges need not lie between pixels: what a pixel shows is the area, so that patterns have no jagged edges
//! of their own.

use std::f64::consts::{PI, TAU};

use crate::text::area::Areas;

/// Inclination of the slanted edge from the columns of pixels, degrees, as in ISO 12233.
const SLANT_DEG: f64 = 5.0;

/// Diameter of the star over the shorter side of the panel.
const STAR: f64 = 0.9;

/// Number of black spokes of a Siemens star without a period.
const SPOKES: f64 = 36.0;

/// Period of stripes and squares without one, pixels.
const PERIOD: f64 = 8.0;

/// A pattern of black and white.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestPattern {
    /// Black on the left, white on the right of an edge through the middle, 5 deg from the columns.
    SlantedEdge,
    /// Stripes along y, half of a period each; the first at the left is black.
    Stripes,
    /// Squares with sides of half a period; the one at the upper left corner is black.
    Checker,
    /// Black spokes on white; the period is that at the rim.
    Siemens,
}

impl TestPattern {
    /// The period where none is given, mm: 8 pixels, or that of a star with 36 spokes.
    pub fn usual_period_mm(self, count: [usize; 2], pitch_mm: [f64; 2]) -> f64 {
        match self {
            Self::Siemens => PI * STAR * shorter(count, pitch_mm) / SPOKES,
            _ => PERIOD * pitch_mm[0],
        }
    }

    /// Number of black spokes of a Siemens star with this period at the rim, mm.
    pub fn spokes(count: [usize; 2], pitch_mm: [f64; 2], period_mm: f64) -> f64 {
        (PI * STAR * shorter(count, pitch_mm) / period_mm).round().max(1.0)
    }

    /// Returns the fraction of each pixel that is black, by rows from the top, on `count` = columns and rows
    /// of pixels of `pitch_mm`.
    ///
    /// `period_mm` is that of stripes and squares, and of the star at its rim; the edge has none.
    pub fn black(self, count: [usize; 2], pitch_mm: [f64; 2], period_mm: f64) -> Vec<f32> {
        match self {
            Self::SlantedEdge => slanted_edge(count, pitch_mm),
            Self::Stripes => {
                let row: Vec<f32> = (0..count[0]).map(|at| dark(at, pitch_mm[0], period_mm) as f32).collect();
                row.repeat(count[1])
            }
            Self::Checker => {
                let parts =
                    |k: usize| (0..count[k]).map(|at| dark(at, pitch_mm[k], period_mm)).collect::<Vec<_>>();
                let [across, down] = [parts(0), parts(1)];
                let pixel = |y: &f64, x: &f64| (x * y + (1.0 - x) * (1.0 - y)) as f32;
                down.iter().flat_map(|y| across.iter().map(move |x| pixel(y, x))).collect()
            }
            Self::Siemens => siemens(count, pitch_mm, Self::spokes(count, pitch_mm, period_mm)),
        }
    }
}

fn size(count: [usize; 2], pitch_mm: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| count[k] as f64 * pitch_mm[k])
}

fn shorter(count: [usize; 2], pitch_mm: [f64; 2]) -> f64 {
    let [width, height] = size(count, pitch_mm);
    width.min(height)
}

/// Fraction of a pixel in the first half of a period.
fn dark(at: usize, pitch_mm: f64, period_mm: f64) -> f64 {
    let within = |x: f64| {
        let periods = (x / period_mm).floor();
        0.5 * periods * period_mm + (x - periods * period_mm).min(0.5 * period_mm)
    };
    let [start, end] = [at as f64, (at + 1) as f64].map(|edge| within(edge * pitch_mm));
    ((end - start) / pitch_mm).clamp(0.0, 1.0)
}

fn slanted_edge(count: [usize; 2], pitch_mm: [f64; 2]) -> Vec<f32> {
    let size_mm = size(count, pitch_mm);
    let slope = SLANT_DEG.to_radians().tan() * 0.5 * size_mm[1];
    let middle = 0.5 * size_mm[0];
    // Corners beyond the panel are left out.
    let far = middle + slope;
    let corners = [[-far, 0.0], [middle - slope, 0.0], [middle + slope, size_mm[1]], [-far, size_mm[1]]];
    let mut areas = Areas::new(count);
    polygon(&mut areas, corners.into_iter(), pitch_mm);
    from_the_top(&areas, count)
}

fn siemens(count: [usize; 2], pitch_mm: [f64; 2], spokes: f64) -> Vec<f32> {
    let middle = size(count, pitch_mm).map(|size| 0.5 * size);
    let radius = 0.5 * STAR * shorter(count, pitch_mm);
    let width = PI / spokes;
    // A chord is within 1e-3 of a pixel of its arc.
    let chords =
        (width * (radius / pitch_mm[0].min(pitch_mm[1]) / 8e-3).sqrt()).ceil().clamp(1.0, 1e3) as usize;
    let mut areas = Areas::new(count);
    for spoke in 0..spokes as usize {
        let arc = (0..=chords).map(|chord| {
            let angle = TAU * spoke as f64 / spokes + width * chord as f64 / chords as f64;
            [middle[0] + radius * angle.cos(), middle[1] + radius * angle.sin()]
        });
        polygon(&mut areas, std::iter::once(middle).chain(arc), pitch_mm);
    }
    from_the_top(&areas, count)
}

fn polygon(areas: &mut Areas, corners: impl Iterator<Item = [f64; 2]>, pitch_mm: [f64; 2]) {
    for (number, corner) in corners.enumerate() {
        let corner = [0, 1].map(|k| corner[k] / pitch_mm[k]);
        if number == 0 {
            areas.move_to(corner);
        } else {
            areas.line_to(corner);
        }
    }
    areas.close();
}

fn from_the_top(areas: &Areas, count: [usize; 2]) -> Vec<f32> {
    areas.coverage().chunks_exact(count[0].max(1)).rev().flatten().map(|covered| *covered as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const COUNT: [usize; 2] = [60, 40];
    const PITCH: [f64; 2] = [0.1, 0.2];

    fn mean(values: &[f32]) -> f64 {
        values.iter().map(|value| f64::from(*value)).sum::<f64>() / values.len() as f64
    }

    /// Stripes of 2.5 pixels: black, black, half, white, white, and again.
    #[test]
    fn stripes_and_squares_have_their_areas() {
        let stripes = TestPattern::Stripes.black(COUNT, PITCH, 0.5);
        let expected = [1.0, 1.0, 0.5, 0.0, 0.0];
        let near = |at: usize| (f64::from(stripes[at]) - expected[at % 60 % 5]).abs() < 1e-6;
        assert!((0..stripes.len()).all(near), "{:?}", &stripes[..10]);
        let squares = TestPattern::Checker.black(COUNT, PITCH, 0.8);
        assert!((mean(&squares) - 0.5).abs() < 1e-6);
        // Sides of 4 columns and 2 rows; black at the upper left.
        assert_eq!(squares[..8], [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!((squares[60], squares[2 * 60], squares[2 * 60 + 4]), (1.0, 0.0, 1.0));
        assert!((mean(&TestPattern::Stripes.black(COUNT, PITCH, 0.01)) - 0.5).abs() < 1e-9);
    }

    /// The edge goes through the middle, and moves by tan(5 deg) of a height: to the right at the top.
    #[test]
    fn slanted_edge_moves_by_its_angle() {
        let edge = TestPattern::SlantedEdge.black(COUNT, PITCH, 0.0);
        let place =
            |row: usize| 0.1 * edge[row * 60..][..60].iter().map(|value| f64::from(*value)).sum::<f64>();
        assert!((mean(&edge) - 0.5).abs() < 1e-6);
        let moved = place(0) - place(39);
        assert!((moved - 39.0 * 0.2 * 5_f64.to_radians().tan()).abs() < 1e-5, "{moved}");
        assert!((0..40).all(|row| edge[row * 60] == 1.0 && edge[row * 60 + 59] == 0.0));
    }

    /// Half of a disc of 0.9 of the shorter side, 6 mm, is black; each spoke has its place.
    #[test]
    fn star_covers_half_of_its_disc() {
        for period in [0.1, 0.5, 3.0] {
            let star = TestPattern::Siemens.black(COUNT, PITCH, period);
            let black = mean(&star) * 6.0 * 8.0;
            assert!((black - 0.5 * PI * 2.7 * 2.7).abs() < 0.01, "{period}: {black}");
            assert!(star.iter().all(|value| (0.0..=1.0).contains(value)));
        }
        // 4 spokes: the first is counter-clockwise from the right, so black above the middle at the right.
        let star = TestPattern::Siemens.black(COUNT, PITCH, PI * 0.9 * 6.0 / 4.0);
        let at = |x: usize, y: usize| star[y * 60 + x];
        assert_eq!((at(45, 17), at(45, 22), at(0, 0)), (1.0, 0.0, 0.0));
        let usual = TestPattern::Siemens.usual_period_mm(COUNT, PITCH);
        assert_eq!(TestPattern::spokes(COUNT, PITCH, usual), 36.0);
        assert!((TestPattern::Checker.usual_period_mm(COUNT, PITCH) - 0.8).abs() < 1e-12);
    }
}
