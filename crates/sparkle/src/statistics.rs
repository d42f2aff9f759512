//! Moments over pixels, and the deviation that follows from them.

use std::f64::consts::PI;

use crate::PixelLight;

/// Sums over the pixels of one replicate.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    /// Number of pixels.
    pub count: f64,
    /// Sum of their light.
    pub sum: f64,
    /// Sum of its squares.
    pub squares: f64,
}

impl Moments {
    /// Adds the light of a pixel, of which there are two estimates with independent errors: their product has
    /// no mean error.
    pub(crate) fn add(&mut self, [one, other]: PixelLight) {
        self.count += 1.0;
        self.sum += 0.5 * (one + other);
        self.squares += one * other;
    }

    fn plus(self, other: Self, sign: f64) -> Self {
        Self {
            count: self.count + sign * other.count,
            sum: self.sum + sign * other.sum,
            squares: self.squares + sign * other.squares,
        }
    }

    fn mean(&self) -> f64 {
        self.sum / self.count
    }

    /// Standard deviation over the mean; 0 where the squares differ by rounding errors alone.
    fn deviation(&self) -> f64 {
        let mean = self.mean();
        let variance = (self.squares / self.count - mean * mean) * self.count / (self.count - 1.0);
        let rounding = 1e-14 * mean * mean;
        if variance.abs() <= rounding { 0.0 } else { variance.max(0.0).sqrt() / mean }
    }
}

/// Pixel power deviation with its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Standard deviation of the light of equal pixels over its mean.
    pub ppd: f64,
    /// Standard error of `ppd`, by the jackknife over replicates.
    pub standard_error: f64,
    /// Mean light of a pixel.
    pub mean: f64,
    /// Standard error of `mean`.
    pub mean_error: f64,
}

impl Deviation {
    /// Returns the deviation of two or more replicates.
    pub fn new(replicates: &[Moments]) -> Self {
        let all = replicates.iter().fold(Moments::default(), |sum, one| sum.plus(*one, 1.0));
        let without = |of: &dyn Fn(&Moments) -> f64| {
            let values: Vec<f64> = replicates.iter().map(|one| of(&all.plus(*one, -1.0))).collect();
            let n = values.len() as f64;
            let mean = values.iter().sum::<f64>() / n;
            (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() * (n - 1.0) / n).sqrt()
        };
        Self {
            ppd: all.deviation(),
            standard_error: without(&Moments::deviation),
            mean: all.mean(),
            mean_error: without(&Moments::mean),
        }
    }

    /// The same deviation with the errors that this number of independent pixels has besides:
    /// `ppd/sqrt(2 pixels)`, and that of their mean.
    pub(crate) fn of_independent(self, pixels: f64) -> Self {
        Self {
            standard_error: self.standard_error.hypot(self.ppd / (2.0 * pixels).sqrt()),
            mean_error: self.mean_error.hypot(self.mean * self.ppd / pixels.sqrt()),
            ..self
        }
    }
}

/// Sparkle of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sparkle {
    /// Of the panel in the light of the room.
    pub all: Deviation,
    /// Matrix term: of the same windows in uniform light. Its mean is that of the matrix, within the standard
    /// error.
    pub matrix: Deviation,
    /// Source term: of a uniform pixel plane in the light of the room.
    pub source: Deviation,
}

/// Contrast (root mean square) of sparkle within an octave around a spatial frequency, cycles per mm:
/// multiplied by the eye's contrast sensitivity there, it is above 1 where sparkle is above threshold.
///
/// Pixels are independent squares of uniform light, so that the spectrum is that of one pixel.
pub fn band_contrast(ppd: f64, pitch_mm: [f64; 2], frequency_per_mm: f64) -> f64 {
    const STEPS: usize = 64;
    let sinc = |x: f64| if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) };
    let mut sum = 0.0;
    for ring in 0..STEPS {
        // Equal areas between f/sqrt(2) and f sqrt(2): the octave is a ring of area 3/2 pi f².
        let share = (ring as f64 + 0.5) / STEPS as f64;
        let radius = frequency_per_mm * (0.5 + 1.5 * share).sqrt();
        for step in 0..STEPS {
            let (sin, cos) = (2.0 * PI * (step as f64 + 0.5) / STEPS as f64).sin_cos();
            sum += (sinc(radius * cos * pitch_mm[0]) * sinc(radius * sin * pitch_mm[1])).powi(2);
        }
    }
    let area = 1.5 * PI * frequency_per_mm * frequency_per_mm;
    ppd * (pitch_mm[0] * pitch_mm[1] * area * sum / (STEPS * STEPS) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::SQRT_2;

    use super::*;

    #[test]
    fn equal_pixels_have_no_deviation() {
        let mut one = Moments::default();
        (0..20).for_each(|_| one.add([0.1 + 0.2; 2]));
        let found = Deviation::new(&[one, one, one]);
        assert_eq!((found.ppd, found.standard_error), (0.0, 0.0));
        assert!((found.mean - 0.3).abs() < 1e-15);
    }

    #[test]
    fn deviation_is_that_of_all_pixels() {
        let values = [1.0, 2.0, 4.0, 5.0, 3.0, 3.0];
        let replicates: Vec<Moments> = values
            .chunks(2)
            .map(|pair| {
                let mut one = Moments::default();
                pair.iter().for_each(|value| one.add([*value; 2]));
                one
            })
            .collect();
        // Mean 3, variance 10/5.
        let found = Deviation::new(&replicates);
        assert!((found.ppd - SQRT_2 / 3.0).abs() < 1e-15 && (found.mean - 3.0).abs() < 1e-15);
        // Means without one replicate: 3.75, 2.25, 3.
        assert!((found.mean_error - (2.0 / 3.0 * 2.0 * 0.75_f64.powi(2)).sqrt()).abs() < 1e-14);
    }

    /// All octaves together have the whole contrast.
    #[test]
    fn octaves_add_to_pixel_power_deviation() {
        let octave = |k: i32| band_contrast(0.05, [0.084, 0.1], 2.0_f64.powi(k)).powi(2);
        let sum: f64 = (-4..12).map(octave).sum();
        assert!((sum.sqrt() / 0.05 - 1.0).abs() < 0.01, "{}", sum.sqrt());
    }
}
