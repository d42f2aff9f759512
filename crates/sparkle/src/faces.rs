//! Random faces, synthesised by their spectrum.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_optics::RandomFace;
use papilio_sampling::SampleStream;
use papilio_transport::spatial::Cells;

/// Highest frequency of a face times its correlation length: the power beyond is 3e-10 of that of all slopes.
pub(crate) const HIGHEST: f64 = 1.6;

/// Draws periodic Gaussian faces of given statistics.
///
/// The wave of each frequency has a random amplitude that depends on the frequency and on the numbers of the
/// replicate alone: finer cells show the same face at more points.
pub struct FaceSampler {
    face: RandomFace,
    cells: Cells,
    plane: Plane,
}

impl FaceSampler {
    /// Prepares faces on these cells, at most 0.3 correlation lengths wide; a period should have 8 or more of
    /// these lengths.
    pub fn new(face: RandomFace, cells: Cells) -> Self {
        Self { face, cells, plane: Plane::new(cells.count) }
    }

    /// Draws heights at the middles of cells, mm.
    pub fn heights(&self, numbers: &SampleStream) -> Vec<f64> {
        self.draw(numbers, |_| Complex64::ONE).into_iter().map(|value| value.re).collect()
    }

    /// Draws the slopes of the same face: along x the real parts, along y the imaginary parts.
    pub fn slopes(&self, numbers: &SampleStream) -> Vec<Complex64> {
        self.draw(numbers, |[x, y]| Complex64::new(0.0, 2.0 * PI) * Complex64::new(x, y))
    }

    /// Sums waves of random heights, each multiplied by `factor` of its frequency.
    fn draw(&self, numbers: &SampleStream, factor: impl Fn([f64; 2]) -> Complex64) -> Vec<Complex64> {
        let [columns, rows] = self.cells.count;
        let area = self.cells.period_mm[0] * self.cells.period_mm[1];
        let most = [0, 1].map(|axis| {
            let waves = (HIGHEST * self.cells.period_mm[axis] / self.face.correlation_mm) as usize;
            waves.min((self.cells.count[axis] - 1) / 2) as i64
        });
        let mut spectrum = vec![Complex64::ZERO; self.cells.len()];
        for x in 0..=most[0] {
            for y in -most[1]..=most[1] {
                // Half of the plane; the other half has the conjugate waves.
                if x == 0 && y <= 0 {
                    continue;
                }
                let frequency = [x as f64 / self.cells.period_mm[0], y as f64 / self.cells.period_mm[1]];
                let radius = frequency[0].hypot(frequency[1]);
                if radius * self.face.correlation_mm > HIGHEST {
                    continue;
                }
                // Heights at the middles of cells.
                let turn = PI * (x as f64 / columns as f64 + y as f64 / rows as f64);
                let size = FRAC_1_SQRT_2 * (self.face.height_spectrum(radius) / area).sqrt();
                let wave = normal(numbers, x, y) * Complex64::from_polar(size, turn);
                let bin = |x: i64, y: i64| {
                    (x.rem_euclid(columns as i64) * rows as i64 + y.rem_euclid(rows as i64)) as usize
                };
                spectrum[bin(x, y)] = wave * factor(frequency);
                spectrum[bin(-x, -y)] = wave.conj() * factor(frequency.map(|f| -f));
            }
        }
        self.plane.inverse(spectrum)
    }
}

/// Complex number with independent normal parts of variance 1, the same for each wave.
fn normal(numbers: &SampleStream, x: i64, y: i64) -> Complex64 {
    let [u, v, ..] = numbers.block(((x as u64) << 24) + (y + (1 << 23)) as u64, 0);
    Complex64::from_polar((-2.0 * u.ln()).sqrt(), 2.0 * PI * v)
}

#[cfg(test)]
mod tests {
    use papilio_sampling::Sampler;

    use super::*;

    const FACE: RandomFace = RandomFace { slope_rms: 0.03, correlation_mm: 0.015 };

    fn sampler(count: usize) -> FaceSampler {
        FaceSampler::new(FACE, Cells { count: [count, count], period_mm: [0.3, 0.24] })
    }

    fn numbers(replicate: u64) -> SampleStream {
        SampleStream::new(Sampler::Random, 5, replicate)
    }

    #[test]
    fn finer_cells_show_the_same_face() {
        // Three cells beside each other have their middles where the one cell has its own.
        let (coarse, fine) = (sampler(96).slopes(&numbers(0)), sampler(288).slopes(&numbers(0)));
        for (column, row) in [(0, 0), (17, 5), (95, 60)] {
            let other = fine[(3 * row + 1) * 288 + 3 * column + 1];
            assert!((coarse[row * 96 + column] - other).norm() < 1e-9, "{column} {row}");
        }
    }

    #[test]
    fn slopes_are_derivatives_of_heights() {
        let count = 480;
        let (heights, slopes) = (sampler(count).heights(&numbers(1)), sampler(count).slopes(&numbers(1)));
        let at = |column: usize, row: usize| heights[row % count * count + column % count];
        for (column, row) in [(7, 400), (200, 3), (479, 479)] {
            let along = |d: [f64; 4], step: f64| (8.0 * (d[2] - d[1]) - d[3] + d[0]) / (12.0 * step);
            let [x, y] = [
                [count - 2, count - 1, 1, 2].map(|k| at(column + k, row)),
                [count - 2, count - 1, 1, 2].map(|k| at(column, row + k)),
            ];
            let expected = Complex64::new(along(x, 0.3 / 480.0), along(y, 0.24 / 480.0));
            let found = slopes[row * count + column];
            assert!((found - expected).norm() < 1e-5, "{found} {expected}");
        }
    }

    /// Mean squares of slopes and their correlation at a distance, over replicates.
    #[test]
    fn slopes_have_stated_statistics() {
        let sampler = sampler(96);
        let offset = [4, 3];
        let expected = FACE.slope_correlation([4.0 * 0.3 / 96.0, 3.0 * 0.24 / 96.0]);
        let of = |which: fn(Complex64, Complex64) -> f64| {
            papilio_testing::mean_and_error((0..48).map(|replicate| {
                let slopes = sampler.slopes(&numbers(replicate));
                let pair = |k: usize| {
                    let (column, row) = ((k % 96 + offset[0]) % 96, (k / 96 + offset[1]) % 96);
                    which(slopes[k], slopes[row * 96 + column])
                };
                (0..slopes.len()).map(pair).sum::<f64>() / slopes.len() as f64 / FACE.slope_rms.powi(2)
            }))
        };
        type Product = fn(Complex64, Complex64) -> f64;
        let cases: [(Product, f64); 6] = [
            (|a, _| a.re * a.re, 1.0),
            (|a, _| a.im * a.im, 1.0),
            (|a, _| a.re * a.im, 0.0),
            (|a, b| a.re * b.re, expected[0]),
            (|a, b| a.re * b.im, expected[1]),
            (|a, b| a.im * b.im, expected[2]),
        ];
        for (which, expected) in cases {
            let (mean, error) = of(which);
            assert!(error < 0.02 && (mean - expected).abs() < 4.5 * error, "{mean} ± {error}, {expected}");
        }
    }
}
