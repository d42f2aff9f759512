//! Area that a closed outline covers of each pixel.

/// Flatness of curves, pixels.
const FLATNESS: f64 = 1e-3;

/// Signed areas of an outline, accumulated edge by edge.
///
/// Each edge adds, to the pixels of the rows that it crosses, the area to its right; sums along the rows are
/// the coverage.
pub(crate) struct Areas {
    count: [usize; 2],
    /// Differences of the coverage from one pixel of a row to the next.
    steps: Vec<f64>,
    at: [f64; 2],
    start: [f64; 2],
}

impl Areas {
    pub(crate) fn new(count: [usize; 2]) -> Self {
        Self { count, steps: vec![0.0; (count[0] + 1) * count[1]], at: [0.0; 2], start: [0.0; 2] }
    }

    /// Fraction of each pixel that is covered, row by row.
    pub(crate) fn coverage(&self) -> Vec<f64> {
        let rows = self.steps.chunks(self.count[0] + 1).flat_map(|row| {
            let sums = row[..self.count[0]].iter().scan(0.0, |sum, step| {
                *sum += step;
                Some(f64::abs(*sum).min(1.0))
            });
            sums.collect::<Vec<_>>()
        });
        rows.collect()
    }

    pub(crate) fn move_to(&mut self, to: [f64; 2]) {
        (self.at, self.start) = (to, to);
    }

    pub(crate) fn close(&mut self) {
        self.line_to(self.start);
    }

    /// Adds a quadratic Bézier curve.
    pub(crate) fn quadratic_to(&mut self, control: [f64; 2], to: [f64; 2]) {
        let from = self.at;
        let bend = [0, 1].map(|k| from[k] - 2.0 * control[k] + to[k]);
        self.curve(bend[0].hypot(bend[1]), |t| {
            [0, 1].map(|k| {
                let s = 1.0 - t;
                s * s * from[k] + 2.0 * s * t * control[k] + t * t * to[k]
            })
        });
    }

    /// Adds a cubic Bézier curve.
    pub(crate) fn cubic_to(&mut self, [first, second]: [[f64; 2]; 2], to: [f64; 2]) {
        let from = self.at;
        let bend = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (a[0] - 2.0 * b[0] + c[0]).hypot(a[1] - 2.0 * b[1] + c[1])
        };
        self.curve(3.0 * bend(from, first, second).max(bend(first, second, to)), |t| {
            [0, 1].map(|k| {
                let s = 1.0 - t;
                s * s * s * from[k] + 3.0 * s * t * (s * first[k] + t * second[k]) + t * t * t * to[k]
            })
        });
    }

    /// Adds chords of a curve whose second derivative is up to twice `bend`: they are within `bend/(4 n²)` of
    /// it.
    fn curve(&mut self, bend: f64, point: impl Fn(f64) -> [f64; 2]) {
        let chords = (bend / (4.0 * FLATNESS)).sqrt().ceil().clamp(1.0, 1000.0) as usize;
        for chord in 1..=chords {
            self.line_to(point(chord as f64 / chords as f64));
        }
    }

    /// Adds a straight edge; what is beyond the array is left out.
    pub(crate) fn line_to(&mut self, to: [f64; 2]) {
        let from = std::mem::replace(&mut self.at, to);
        let (sign, [lower, upper]) = if from[1] <= to[1] { (1.0, [from, to]) } else { (-1.0, [to, from]) };
        let height = upper[1] - lower[1];
        if height == 0.0 {
            return;
        }
        let slope = (upper[0] - lower[0]) / height;
        let first = lower[1].floor().max(0.0);
        for row in first as usize..self.count[1] {
            let [bottom, top] = [lower[1].max(row as f64), upper[1].min(row as f64 + 1.0)];
            if bottom >= top {
                break;
            }
            let ends = [bottom, top].map(|y| lower[0] + slope * (y - lower[1]));
            self.span(row, sign * (top - bottom), [ends[0].min(ends[1]), ends[0].max(ends[1])]);
        }
    }

    /// Adds an edge within a row, of this height, between two places along x.
    fn span(&mut self, row: usize, height: f64, [left, right]: [f64; 2]) {
        let columns = self.count[0];
        let steps = &mut self.steps[row * (columns + 1)..][..=columns];
        let first = (left.max(0.0) as usize).min(columns);
        let last = (right.max(0.0).ceil() as usize).max(first + 1).min(columns);
        let length = right - left;
        let mut before = 0.0;
        for (column, step) in steps[..last].iter_mut().enumerate().skip(first) {
            // Area to the right of the edge: whole for the part of the edge on the left of the pixel, a
            // trapezium for the part within.
            let [start, end] = [column as f64, column as f64 + 1.0];
            let part = |x: f64| {
                if length > 0.0 {
                    ((x - left) / length).clamp(0.0, 1.0)
                } else {
                    f64::from(u8::from(x > left))
                }
            };
            let [begun, ended] = [part(start), part(end)];
            let middle = 0.5 * (left.clamp(start, end) + right.clamp(start, end));
            let covered = height * (begun + (ended - begun) * (end - middle));
            *step += covered - before;
            before = covered;
        }
        steps[last] += height - before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polygon(corners: &[[f64; 2]], count: [usize; 2]) -> Vec<f64> {
        let mut areas = Areas::new(count);
        areas.move_to(corners[0]);
        corners[1..].iter().for_each(|corner| areas.line_to(*corner));
        areas.close();
        areas.coverage()
    }

    #[test]
    fn rectangle_covers_parts_of_pixels() {
        let found = polygon(&[[0.25, 0.5], [2.5, 0.5], [2.5, 2.0], [0.25, 2.0]], [4, 3]);
        let expected = [0.375, 0.5, 0.25, 0.0, 0.75, 1.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    #[test]
    fn triangle_covers_halves_of_pixels() {
        let found = polygon(&[[0.0, 0.0], [3.0, 0.0], [0.0, 3.0]], [3, 3]);
        let expected = [1.0, 1.0, 0.5, 1.0, 0.5, 0.0, 0.5, 0.0, 0.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?}");
    }

    /// Coverage of a slanted quadrilateral against points on a fine grid, also where it leaves the array.
    #[test]
    fn coverage_is_fraction_of_points_inside() {
        let corners = [[0.3, 0.2], [5.7, 1.1], [6.9, 3.7], [1.1, 2.6]];
        let found = polygon(&corners, [6, 4]);
        let inside = |x: f64, y: f64| {
            (0..4).all(|k| {
                let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % 4]);
                (bx - ax) * (y - ay) - (by - ay) * (x - ax) > 0.0
            })
        };
        let fine = 200;
        for (pixel, found) in found.iter().enumerate() {
            let corner = [(pixel % 6) as f64, (pixel / 6) as f64];
            let at = |k: usize| (k as f64 + 0.5) / f64::from(fine);
            let lit = |k: &usize| inside(corner[0] + at(k % 200), corner[1] + at(k / 200));
            let expected = (0..200 * 200).filter(lit).count() as f64 / f64::from(fine * fine);
            assert!((found - expected).abs() < 2e-3, "{pixel}: {found} {expected}");
        }
    }

    /// Four quadratic curves, and four cubic ones, in place of a circle.
    #[test]
    fn curves_enclose_their_area() {
        let r = 4.0;
        let mut quadratic = Areas::new([10, 10]);
        quadratic.move_to([5.0 + r, 5.0]);
        for (c, to) in [
            ([9.0, 9.0], [5.0, 9.0]),
            ([1.0, 9.0], [1.0, 5.0]),
            ([1.0, 1.0], [5.0, 1.0]),
            ([9.0, 1.0], [9.0, 5.0]),
        ] {
            quadratic.quadratic_to(c, to);
        }
        // A parabola leaves a sixth of each quarter square outside.
        let area: f64 = quadratic.coverage().iter().sum();
        assert!((area - 4.0 * r * r * 5.0 / 6.0).abs() < 0.02, "{area}");
        let k = 0.552_284_749_8 * r;
        let mut cubic = Areas::new([10, 10]);
        cubic.move_to([9.0, 5.0]);
        cubic.cubic_to([[9.0, 5.0 + k], [5.0 + k, 9.0]], [5.0, 9.0]);
        cubic.cubic_to([[5.0 - k, 9.0], [1.0, 5.0 + k]], [1.0, 5.0]);
        cubic.cubic_to([[1.0, 5.0 - k], [5.0 - k, 1.0]], [5.0, 1.0]);
        cubic.cubic_to([[5.0 + k, 1.0], [9.0, 5.0 - k]], [9.0, 5.0]);
        let area: f64 = cubic.coverage().iter().sum();
        assert!((area - std::f64::consts::PI * r * r).abs() < 0.04, "{area}");
    }
}
