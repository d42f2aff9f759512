//! The matrix of windows on the pixel plane.

use crate::grid::floor;

/// A lit rectangle of each pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// x0, y0, x1, y1 (mm), relative to the lower left corner of the pixel; x0 <= x1, y0 <= y1, no larger
    /// than the pixel.
    pub rectangle_mm: [f64; 4],
    /// Reflectance of the window in the state that is shown, or any multiple of it.
    pub weight: f64,
}

/// Windows that repeat with the pitch.
#[derive(Debug, Clone, PartialEq)]
pub struct Matrix {
    /// Pitch of the pixels along x and y, mm.
    pub pitch_mm: [f64; 2],
    /// Windows of one pixel; where they overlap, their weights add.
    pub windows: Vec<Window>,
    /// Weight of the area that no window covers, as of a white mask; windows add to it.
    pub background: f64,
}

impl Matrix {
    /// Returns a matrix with one window of weight 1 in the middle of each square pixel.
    pub fn single(pitch_mm: f64, width_mm: f64, height_mm: f64) -> Self {
        let (x, y) = (0.5 * (pitch_mm - width_mm), 0.5 * (pitch_mm - height_mm));
        let rectangle_mm = [x, y, x + width_mm, y + height_mm];
        Self { pitch_mm: [pitch_mm; 2], windows: vec![Window { rectangle_mm, weight: 1.0 }], background: 0.0 }
    }

    /// Mean over the area of a pixel.
    pub fn mean(&self) -> f64 {
        let area = |[x0, y0, x1, y1]: [f64; 4]| (x1 - x0) * (y1 - y0);
        let lit: f64 = self.windows.iter().map(|window| window.weight * area(window.rectangle_mm)).sum();
        self.background + lit / (self.pitch_mm[0] * self.pitch_mm[1])
    }

    /// Prepares means over rectangles of this size.
    pub(crate) fn over(&self, size_mm: [f64; 2]) -> Means {
        let stripe = |from: f64, to: f64, axis: usize| Stripe {
            middle: from - 0.5 * size_mm[axis],
            width: to - from,
            pitch: self.pitch_mm[axis],
            per_pitch: 1.0 / self.pitch_mm[axis],
            size: size_mm[axis],
        };
        let windows = self.windows.iter().map(|window| {
            let [x0, y0, x1, y1] = window.rectangle_mm;
            (window.weight / (size_mm[0] * size_mm[1]), [stripe(x0, x1, 0), stripe(y0, y1, 1)])
        });
        Means { windows: windows.collect(), background: self.background }
    }
}

/// Mean of a matrix over a rectangle.
pub(crate) struct Means {
    windows: Vec<(f64, [Stripe; 2])>,
    background: f64,
}

impl Means {
    /// Returns the mean over the rectangle around this place.
    #[inline]
    pub(crate) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let of = |(weight, [along_x, along_y]): &(f64, [Stripe; 2])| {
            weight * along_x.overlap(x) * along_y.overlap(y)
        };
        self.background + self.windows.iter().map(of).sum::<f64>()
    }
}

/// A periodic stripe, and the size of intervals whose overlap with it is requested.
struct Stripe {
    /// Middle of an interval whose lower end is at the lower edge, less the size of the interval.
    middle: f64,
    width: f64,
    pitch: f64,
    per_pitch: f64,
    size: f64,
}

impl Stripe {
    /// Length of the overlap of the stripe and an interval around this place.
    #[inline]
    fn overlap(&self, place: f64) -> f64 {
        let upper = place - self.middle;
        self.up_to(upper) - self.up_to(upper - self.size)
    }

    /// Length of the stripe from its lower edge to a place.
    #[inline]
    fn up_to(&self, place: f64) -> f64 {
        let periods = floor(place * self.per_pitch);
        periods * self.width + (place - periods * self.pitch).min(self.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_over_rectangles_are_exact() {
        let mut matrix = Matrix::single(0.084, 0.026, 0.076);
        matrix.windows.push(Window { rectangle_mm: [0.0, 0.0, 0.01, 0.084], weight: 0.5 });
        matrix.background = 0.25;
        // A whole pixel has the mean, wherever it is.
        for place in [[0.042, 0.042], [0.05, -0.3], [-7.123, 4.56]] {
            assert!((matrix.over([0.084, 0.084]).at(place) - matrix.mean()).abs() < 1e-12);
        }
        // A quarter of a small square on the lower left corner of the window of the next pixel; within the
        // other window.
        let small = matrix.over([0.002, 0.002]);
        assert!((small.at([0.029 + 0.084, 0.004 - 0.168]) - 0.5).abs() < 1e-12);
        assert!((small.at([0.005, 0.05]) - 0.75).abs() < 1e-12);
        assert!((small.at([0.0, 0.083]) - 0.5).abs() < 1e-12);
    }
}
