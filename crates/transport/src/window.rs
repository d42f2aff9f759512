//! Windows of sub-pixels: areas of a period of the pixel array, and how much of one is seen through another.
//!
//! **What.** A [`Window`] is a set of [`Rectangle`]s in fractions of the period (the pitch of a pixel), x to
//! the right and y up from the lower left corner. The array repeats it without end. All areas are exact: no
//! window is sampled at points.
//!
//! **Shares.** A viewer who looks along an oblique ray sees the array shifted; light that is spread sees it
//! shifted by a distribution of vectors. The mean over window i of what window j covers there is the share of
//! j in what is seen through i: for a list of shifts by [`shares_by_shifts`], for a point spread given by its
//! Fourier transform by [`shares_by_transfer`]. With the light that each sub-pixel reflects as a weight, it
//! is the crosstalk of a uniform page.

use std::f64::consts::PI;

use num_complex::Complex64;

/// Rectangle in fractions of the period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    /// Left and right edge.
    pub x: [f64; 2],
    /// Lower and upper edge.
    pub y: [f64; 2],
}

impl Rectangle {
    /// The whole period.
    pub const WHOLE: Self = Self { x: [0.0, 1.0], y: [0.0, 1.0] };

    /// Area, as a fraction of the period.
    pub fn area(&self) -> f64 {
        length(self.x) * length(self.y)
    }

    /// Area that two rectangles share, without repetition.
    pub fn overlap(&self, other: &Self) -> f64 {
        common(self.x, other.x) * common(self.y, other.y)
    }

    /// The rectangle with its width and height multiplied by these factors about its middle.
    #[must_use]
    pub fn scaled(&self, [by_x, by_y]: [f64; 2]) -> Self {
        let about = |[from, to]: [f64; 2], by: f64| {
            let (middle, half) = (0.5 * (from + to), 0.5 * by * (to - from));
            [middle - half, middle + half]
        };
        Self { x: about(self.x, by_x), y: about(self.y, by_y) }
    }
}

/// Area of a sub-pixel: rectangles that do not overlap.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Window {
    /// The rectangles; none for a sub-pixel without area.
    pub rectangles: Vec<Rectangle>,
}

impl Window {
    /// A window of a single rectangle.
    pub fn from_rectangle(rectangle: Rectangle) -> Self {
        Self { rectangles: vec![rectangle] }
    }

    /// Area, as a fraction of the period.
    pub fn area(&self) -> f64 {
        self.rectangles.iter().map(Rectangle::area).sum()
    }

    /// Area of this window, shifted by `shift` periods, that the repeated window `other` covers.
    pub fn overlap(&self, other: &Self, shift: [f64; 2]) -> f64 {
        let pairs = self.rectangles.iter().flat_map(|a| other.rectangles.iter().map(move |b| (a, b)));
        pairs.map(|(a, b)| repeated(a.x, b.x, shift[0]) * repeated(a.y, b.y, shift[1])).sum()
    }

    /// Fraction that the window covers of each of `columns` x `rows` equal cells of a period; rows from the
    /// bottom, columns from the left.
    pub fn coverage(&self, [columns, rows]: [usize; 2]) -> Vec<f64> {
        let along = |side: [f64; 2], count: usize| -> Vec<f64> {
            let scaled = side.map(|edge| edge * count as f64);
            (0..count).map(|cell| common(scaled, [cell as f64, (cell + 1) as f64])).collect()
        };
        let mut cells = vec![0.0; columns * rows];
        for rectangle in &self.rectangles {
            let (x, y) = (along(rectangle.x, columns), along(rectangle.y, rows));
            for (row, y) in cells.chunks_mut(columns).zip(y) {
                row.iter_mut().zip(&x).for_each(|(cell, x)| *cell += x * y);
            }
        }
        cells
    }

    /// Integral of `exp(-2 pi i w.x)` over the window, w in cycles per period. At integers these are the
    /// coefficients of the Fourier series of the repeated window; at 0 it is the area.
    pub fn transform(&self, wave: [f64; 2]) -> Complex64 {
        let along = |[from, to]: [f64; 2], wave: f64| {
            let half = PI * wave * (to - from);
            let sinc = if half == 0.0 { 1.0 } else { half.sin() / half };
            Complex64::from_polar((to - from) * sinc, -PI * wave * (from + to))
        };
        self.rectangles.iter().map(|one| along(one.x, wave[0]) * along(one.y, wave[1])).sum()
    }
}

/// Mean over each window i of the fraction that each window j covers, `[i][j]`, for a point spread given by
/// its transfer function at whole cycles per period, along x and y: 1 at 0, and the complex conjugate at the
/// opposite frequency. The point at r (periods) of the spread is what is seen from the origin.
///
/// The series ends at `orders` cycles along each axis; the transfer should be negligible beyond.
pub fn shares_by_transfer(
    windows: &[Window],
    orders: u32,
    transfer: impl Fn([f64; 2]) -> Complex64,
) -> Vec<Vec<f64>> {
    let mut shares = vec![vec![0.0; windows.len()]; windows.len()];
    let last = i64::from(orders);
    // One of each pair of opposite frequencies, whose terms are complex conjugates, and 0.
    let waves = (0..=last).flat_map(|x| (-last..=last).map(move |y| (x, y)));
    for (x, y) in waves.filter(|wave| *wave >= (0, 0)) {
        let wave = [x as f64, y as f64];
        let factor = if (x, y) == (0, 0) { 1.0 } else { 2.0 };
        // The shift r of the spread multiplies coefficients of the source by exp(+2 pi i w.r).
        let seen_through = factor * transfer(wave).conj();
        let coefficients: Vec<Complex64> = windows.iter().map(|window| window.transform(wave)).collect();
        for (row, seen) in shares.iter_mut().zip(&coefficients) {
            for (share, source) in row.iter_mut().zip(&coefficients) {
                *share += (seen.conj() * source * seen_through).re;
            }
        }
    }
    for (row, window) in shares.iter_mut().zip(windows) {
        let area = window.area();
        row.iter_mut().for_each(|share| *share = if area == 0.0 { 0.0 } else { *share / area });
    }
    shares
}

fn length([from, to]: [f64; 2]) -> f64 {
    to - from
}

/// Length that two intervals share.
fn common(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[1].min(b[1]) - a[0].max(b[0])).max(0.0)
}

/// Length of an interval, shifted, that an interval covers which repeats with the period 1.
fn repeated(a: [f64; 2], b: [f64; 2], shift: f64) -> f64 {
    let moved = a.map(|edge| edge + shift);
    // Copies of b at whole numbers from the first to the last that can touch a.
    let (first, last) = ((moved[0] - b[1]).floor() as i64, (moved[1] - b[0]).ceil() as i64);
    (first..=last).map(|copy| common(moved, b.map(|edge| edge + copy as f64))).sum()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_1_SQRT_2;

    use super::*;
    use crate::numerics::quadrature::gauss;
    use crate::spatial::{closed, displacement, rows, stripes};
    use papilio_optics::Beta;

    /// Mean over each window i of the fraction that each window j covers, `[i][j]`, for a distribution of
    /// shifts: each a vector in periods and its weight. Rows sum to the sum of the weights where the windows
    /// cover the whole period.
    fn shares_by_shifts(windows: &[Window], shifts: &[([f64; 2], f64)]) -> Vec<Vec<f64>> {
        let of_pair = |seen: &Window, source: &Window| {
            let overlap: f64 =
                shifts.iter().map(|(shift, weight)| weight * seen.overlap(source, *shift)).sum();
            if overlap == 0.0 { 0.0 } else { overlap / seen.area() }
        };
        windows.iter().map(|seen| windows.iter().map(|source| of_pair(seen, source)).collect()).collect()
    }

    /// Crosstalk: of the light that is seen through each window i, the fraction that comes from each window
    /// j, `[i][j]`, for shares and the light of each window (such as its reflectance, or the transmittance of
    /// its filter). Rows sum to 1; in a row without light all are 0.
    fn crosstalk(shares: &[Vec<f64>], light: &[f64]) -> Vec<Vec<f64>> {
        let normalised = |row: &Vec<f64>| {
            let seen: Vec<f64> = row.iter().zip(light).map(|(share, light)| share * light).collect();
            let sum: f64 = seen.iter().sum();
            seen.into_iter().map(|one| if sum > 0.0 { one / sum } else { 0.0 }).collect()
        };
        shares.iter().map(normalised).collect()
    }

    /// Red, green and blue stripes of the same width.
    fn thirds() -> Vec<Window> {
        stripes(&[1.0 / 3.0; 3], 1.0)
    }

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found - expected).abs() < tolerance, "{found} {expected}");
    }

    #[test]
    fn overlap_of_shifted_window_has_closed_forms() {
        let windows = thirds();
        for (shift, own, right, left) in [
            (0.0, 1.0, 0.0, 0.0),
            (0.1, 0.7, 0.3, 0.0),
            (-0.1, 0.7, 0.0, 0.3),
            (0.5, 0.0, 0.5, 0.5),
            (1.0, 1.0, 0.0, 0.0),
            (-7.9, 0.7, 0.3, 0.0),
        ] {
            // A shift along the stripes changes nothing.
            let shares = shares_by_shifts(&windows, &[([shift, 0.37], 1.0)]);
            for (i, shares) in shares.iter().enumerate() {
                for (j, expected) in [(i, own), ((i + 1) % 3, right), ((i + 2) % 3, left)] {
                    close(shares[j], expected, 1e-12);
                }
            }
        }
    }

    /// Whatever is not in one window is in another, or inactive.
    #[test]
    fn rows_of_shares_sum_to_what_is_covered() {
        let shifts = [([0.21, -0.4], 0.25), ([3.7, 0.05], 0.75)];
        let cells = [vec![(0, 0.3), (1, 0.1)], vec![(2, 0.2), (0, 0.4)]];
        for row in shares_by_shifts(&rows(&cells, 3, 1.0), &shifts) {
            close(row.iter().sum(), 1.0, 1e-12);
        }
        let active = rows(&cells, 3, 0.8);
        let inactive = |window: &Window| {
            let whole = Window::from_rectangle(Rectangle::WHOLE);
            let covered: f64 = active.iter().map(|one| window.overlap(one, [0.21, -0.4])).sum();
            window.overlap(&whole, [0.21, -0.4]) - covered
        };
        let total: f64 = active.iter().map(inactive).sum();
        assert!(total > 0.05 && total < 0.2, "{total}");
        let area: f64 = active.iter().map(Window::area).sum();
        close(area, 0.8, 1e-12);
    }

    #[test]
    fn coverage_of_cells_is_the_area() {
        let window = Window {
            rectangles: vec![
                Rectangle { x: [0.13, 0.41], y: [0.02, 0.97] },
                Rectangle { x: [0.6, 0.61], y: [0.3, 0.35] },
            ],
        };
        for cells in [[1, 1], [7, 3], [64, 50]] {
            let coverage = window.coverage(cells);
            let mean = coverage.iter().sum::<f64>() / coverage.len() as f64;
            close(mean, window.area(), 1e-14);
            assert!(coverage.iter().all(|cell| (0.0..=1.0 + 1e-12).contains(cell)));
        }
        let whole = Window::from_rectangle(Rectangle::WHOLE).coverage([5, 4]);
        assert!(whole.iter().all(|cell| (cell - 1.0).abs() < 1e-14));
        // Rows from the bottom: y in [0.3, 0.35] is in the second of five rows, x in [0.6, 0.61] in the third
        // of four columns.
        let small = Window { rectangles: vec![window.rectangles[1]] };
        close(small.coverage([4, 5])[4 + 2], 0.01 * 4.0 * 0.05 * 5.0, 1e-14);
    }

    #[test]
    fn transform_of_a_window_is_its_fourier_integral() {
        let window = Window {
            rectangles: vec![
                Rectangle { x: [0.1, 0.45], y: [0.2, 0.9] },
                Rectangle { x: [0.5, 0.7], y: [0.0, 0.1] },
            ],
        };
        close(window.transform([0.0; 2]).re, window.area(), 1e-15);
        let wave = [2.0, -1.3];
        let mut sum = Complex64::ZERO;
        for one in &window.rectangles {
            for x in gauss(one.x[0], one.x[1], 20) {
                for y in gauss(one.y[0], one.y[1], 20) {
                    let turns = wave[0] * x.x + wave[1] * y.x;
                    sum += Complex64::from_polar(x.weight * y.weight, -2.0 * PI * turns);
                }
            }
        }
        assert!((window.transform(wave) - sum).norm() < 1e-14);
    }

    /// A shift is a transfer function of modulus 1: the series then converges slowly, so that a shift blurred
    /// by a lobe is compared with a sum of the closed form over the pixels around.
    #[test]
    fn series_equals_sum_over_the_pixels_around() {
        let cells = [vec![(0, 0.3), (1, 0.2)], vec![(1, 0.2), (2, 0.3)]];
        let windows = rows(&cells, 3, 0.85);
        let (width, shift) = (0.22, [0.17, -0.06]);
        let transfer = |wave: [f64; 2]| {
            let turns = wave[0] * shift[0] + wave[1] * shift[1];
            let modulation = closed::lobe_in_diffuse_light(wave[0].hypot(wave[1]), width);
            Complex64::from_polar(modulation, -2.0 * PI * turns)
        };
        let found = shares_by_transfer(&windows, 24, transfer);
        for (i, seen) in windows.iter().enumerate() {
            for (j, source) in windows.iter().enumerate() {
                close(found[i][j], around(seen, source, width, shift), 1e-6);
            }
        }
    }

    /// Mean over a window, shifted, of what the lobe shows of another: the pixels up to 40 periods away in
    /// closed form, all others as their mean.
    fn around(seen: &Window, source: &Window, width: f64, shift: [f64; 2]) -> f64 {
        const FAR: i32 = 40;
        let at = |side: [f64; 2], by: f64| side.map(|edge| edge + by);
        let mut sum = 0.0;
        for one in &seen.rectangles {
            let place = [at(one.x, shift[0]), at(one.y, shift[1])];
            for other in &source.rectangles {
                for column in -FAR..=FAR {
                    for row in -FAR..=FAR {
                        let copy = [at(other.x, f64::from(column)), at(other.y, f64::from(row))];
                        sum += closed::lobe_between_rectangles(place, copy, width);
                    }
                }
            }
            let near = [-f64::from(FAR), f64::from(FAR) + 1.0];
            let beyond = one.area() - closed::lobe_between_rectangles(place, [near; 2], width);
            sum += beyond * source.area();
        }
        sum / seen.area()
    }

    /// Light that enters through stripes at a height above others, from all of the air through an ideal
    /// antireflection face: values of a separate program.
    #[test]
    fn entrance_by_the_own_stripe_is_known() {
        let windows = stripes(&[0.2; 5], 1.0);
        for (height, expected) in
            [(0.1, 0.966_65), (0.25, 0.916_63), (0.5, 0.833_25), (1.0, 0.666_50), (2.0, 0.406_24)]
        {
            let mut shifts = Vec::new();
            for ring in 0..600 {
                let radius = ((f64::from(ring) + 0.5) / 600.0).sqrt();
                for step in 0..720 {
                    let (sin, cos) = (PI * (f64::from(step) + 0.5) / 360.0).sin_cos();
                    let beta = Beta { x: radius * cos, y: radius * sin };
                    // Heights are in widths of a stripe, shifts in periods of five.
                    shifts.push((displacement(beta, 0.2 * height, 1.5), 1.0 / 432_000.0));
                }
            }
            let own = shares_by_shifts(&windows[2..3], &shifts)[0][0];
            close(own, expected, 1e-5);
            if height < 1.1 {
                close(own, closed::entrance_own_stripe(1.0, height, 1.5), 1e-5);
            }
        }
    }

    /// H78 (b = 0.05667) over 0.5 mm of glass, three equal stripes at 300 ppi: sums over the stripes around
    /// by the one-dimensional closed form (a separate program). A stripe alone has 0.37455.
    #[test]
    fn crosstalk_of_stripes_under_a_lobe_is_known() {
        const OWN: f64 = 0.452_588_7;
        let (width, pitch) = (0.05667 * 0.5 / 1.5, 25.4 / 300.0);
        let transfer = |wave: [f64; 2]| {
            Complex64::from(closed::lobe_in_diffuse_light(wave[0].hypot(wave[1]) / pitch, width))
        };
        let shares = shares_by_transfer(&thirds(), 30, transfer);
        for row in crosstalk(&shares, &[1.0; 3]) {
            close(row.iter().sum(), 1.0, 1e-12);
        }
        for (i, row) in shares.iter().enumerate() {
            close(row[i], OWN, 1e-6);
            close(row[(i + 1) % 3], 0.5 * (1.0 - OWN), 1e-6);
        }
        // Only red and blue reflect.
        let of_green = &crosstalk(&shares, &[1.0, 0.0, 0.5])[1];
        close(of_green[0], 2.0 / 3.0, 1e-9);
        close(of_green[1], 0.0, 1e-15);
        assert_eq!(crosstalk(&shares, &[0.0; 3])[0], [0.0; 3]);
    }

    /// Share that is seen through the neighbour at 10, 30, 45 and 60 deg for each ratio of height to width of
    /// a stripe.
    #[test]
    fn oblique_view_through_the_neighbour_is_known() {
        let windows = thirds();
        for (deg, per_height) in
            [(10.0_f64, 0.116_55), (30.0, 0.353_55), (45.0, 0.534_52), (60.0, FRAC_1_SQRT_2)]
        {
            let beta = Beta { x: deg.to_radians().sin(), y: 0.0 };
            let height = 0.8;
            let [x, y] = displacement(beta, height / 3.0, 1.5);
            let shares = shares_by_shifts(&windows, &[([-x, -y], 1.0)]);
            close(shares[1][0], height * per_height, 1e-5);
            close(shares[1][1], 1.0 - height * per_height, 1e-5);
        }
    }
}
