//! A surface with Gaussian random heights: the statistics of an antiglare face.
//!
//! **Model.** Heights are a stationary, isotropic Gaussian process with the correlation `exp(-r²/ξ²)`. Slopes
//! are then Gaussian, too, and their root mean square along any axis is `σ = sqrt(2) s/ξ`, s being that of
//! the heights.
//!
//! **Parameters.** `slope_rms`: σ, along one axis, 1 (a Beckmann distribution of roughness
//! `alpha = sqrt(2) σ`); antiglare glass has 0.005 to 0.05. `correlation_mm`: ξ, the distance at which the
//! correlation is 1/e; 0.005 to 0.05 mm.
//!
//! **Haze.** A thin face of index n deviates light along the normal by `(n - 1) m`, m being its slope. The
//! fraction beyond 2.5° is `exp(-sin²(2.5°)/(2 (n - 1)² σ²))`, which determines σ and nothing else. Neither
//! haze nor a gloss number determines ξ: it is read from a profile, where the mean spacing of profile
//! elements (RSm, ISO 21920) is `sqrt(2) π ξ` (Rice 1945) where every crossing of the mean counts.
//!
//! **Validity.** Small slopes; geometric optics, for which the heights are rough optically:
//! [`regular_fraction`](RandomFace::regular_fraction) is the fraction of light that the face does not
//! scatter, which is neglected in the formula of the haze. Real faces are neither exactly Gaussian nor of one
//! scale.

use std::f64::consts::{PI, SQRT_2};

use crate::lobe::HAZE_ANGLE_DEG;
use crate::rough::Distribution;

/// Gaussian random face.
///
/// ```
/// use papilio_optics::RandomFace;
/// // A haze of 3 % on glass of index 1.5: slopes of 0.0329.
/// let slope_rms = RandomFace::slope_rms_from_haze(0.03, 1.5).unwrap();
/// assert!((slope_rms - 0.0329).abs() < 1e-4);
/// assert!(RandomFace::slope_rms_from_haze(1.0, 1.5).is_none());
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RandomFace {
    /// Root mean square slope along one axis, above 0.
    pub slope_rms: f64,
    /// Distance at which the correlation of heights is 1/e, mm, above 0.
    pub correlation_mm: f64,
}

impl RandomFace {
    /// Returns the slope that causes this haze, 0 to 1 (both excluded), in transmission through a plate of
    /// this index, above 1, with one such face; the light is that of the whole hemisphere, all of it
    /// scattered. `None` outside these ranges.
    pub fn slope_rms_from_haze(haze: f64, index: f64) -> Option<f64> {
        let possible = haze > 0.0 && haze < 1.0 && index > 1.0 && index.is_finite();
        possible.then(|| haze_sine() / ((index - 1.0) * (-2.0 * haze.ln()).sqrt()))
    }

    /// Returns the haze of a plate of this index, the inverse of [`Self::slope_rms_from_haze`].
    pub fn haze(&self, index: f64) -> f64 {
        let deviation = (index - 1.0) * self.slope_rms;
        (-0.5 * (haze_sine() / deviation).powi(2)).exp()
    }

    /// Returns the slopes of Gaussian faces with the mean absolute slope of faces that have this haze: with GGX
    /// slopes, the longest tail, and with Gaussian ones ([`Self::slope_rms_from_haze`]). Real faces are between
    /// the two.
    pub fn slopes_from_haze(haze: f64, index: f64) -> Option<[f64; 2]> {
        let gaussian = Self::slope_rms_from_haze(haze, index)?;
        let alpha = Distribution::Ggx.alpha_from_steeper(haze, haze_sine() / (index - 1.0));
        let mean = Distribution::Ggx.mean_slope(alpha) / Distribution::Beckmann.mean_slope(1.0);
        Some([Distribution::Beckmann.slope_rms(mean)?, gaussian])
    }

    /// Root mean square height, mm.
    pub fn height_rms_mm(&self) -> f64 {
        self.slope_rms * self.correlation_mm / SQRT_2
    }

    /// Fraction of light along the normal that a plate of this index transmits without scattering:
    /// `exp(-(2π (n - 1) s/λ)²)`. The haze of such a face is lower by about this fraction than
    /// [`Self::haze`].
    pub fn regular_fraction(&self, index: f64, wavelength_nm: f64) -> f64 {
        let phase = 2.0 * PI * (index - 1.0) * self.height_rms_mm() / (wavelength_nm * 1e-6);
        (-phase * phase).exp()
    }

    /// Correlation of the slopes at two points with this offset, mm, over their mean square: of both along x,
    /// of one along x and the other along y, of both along y.
    pub fn slope_correlation(&self, offset_mm: [f64; 2]) -> [f64; 3] {
        let [x, y] = offset_mm.map(|offset| offset / self.correlation_mm);
        let decay = (-(x * x + y * y)).exp();
        [(1.0 - 2.0 * x * x) * decay, -2.0 * x * y * decay, (1.0 - 2.0 * y * y) * decay]
    }

    /// Power spectrum of the heights at a spatial frequency of `frequency_per_mm` (cycles per mm), mm⁴: its
    /// integral over the plane of frequencies is the mean square height.
    pub fn height_spectrum(&self, frequency_per_mm: f64) -> f64 {
        let width = PI.sqrt() * self.correlation_mm * self.height_rms_mm();
        let phase = PI * self.correlation_mm * frequency_per_mm;
        width * width * (-phase * phase).exp()
    }
}

fn haze_sine() -> f64 {
    HAZE_ANGLE_DEG.to_radians().sin()
}

#[cfg(test)]
mod tests {
    use super::*;

    const FACE: RandomFace = RandomFace { slope_rms: 0.03, correlation_mm: 0.015 };

    #[test]
    fn haze_and_slope_are_inverse() {
        for haze in [1e-6, 0.03, 0.5, 0.99] {
            let slope_rms = RandomFace::slope_rms_from_haze(haze, 1.5).unwrap();
            let face = RandomFace { slope_rms, ..FACE };
            assert!((face.haze(1.5) / haze - 1.0).abs() < 1e-12, "{haze}");
        }
        assert!((RandomFace::slope_rms_from_haze(0.03, 1.5).unwrap() - 0.0329).abs() < 5e-5);
        for (haze, index) in [(0.0, 1.5), (1.0, 1.5), (f64::NAN, 1.5), (0.1, 1.0), (0.1, f64::NAN)] {
            assert!(RandomFace::slope_rms_from_haze(haze, index).is_none(), "{haze} {index}");
        }
    }

    /// The tangent law of GGX: half of the light is beyond the angle at which the slope is alpha, the mean absolute
    /// slope; that of a Gaussian face is sqrt(2/pi) of its root mean square.
    #[test]
    fn longer_tails_have_smaller_slopes_of_the_same_haze() {
        let [tail, gaussian] = RandomFace::slopes_from_haze(0.5, 1.5).unwrap();
        assert!((tail - haze_sine() / 0.5 * (0.5 * PI).sqrt()).abs() < 1e-12);
        assert_eq!(Some(gaussian), RandomFace::slope_rms_from_haze(0.5, 1.5));
        let [tail, gaussian] = RandomFace::slopes_from_haze(0.03, 1.5).unwrap();
        assert!((tail - 0.0192).abs() < 1e-4 && (gaussian - 0.0329).abs() < 1e-4, "{tail}");
        assert_eq!(RandomFace::slopes_from_haze(0.0, 1.5), None);
    }

    /// The correlation of slopes is the negative second derivative of that of heights.
    #[test]
    fn slopes_are_correlated_as_derivatives_of_heights() {
        let height = |x: f64, y: f64| {
            FACE.height_rms_mm().powi(2) * (-(x * x + y * y) / FACE.correlation_mm.powi(2)).exp()
        };
        let (x, y, e) = (0.007, -0.011, 1e-5);
        let second = [
            (height(x + e, y) - 2.0 * height(x, y) + height(x - e, y)) / (e * e),
            (height(x + e, y + e) - height(x + e, y - e) - height(x - e, y + e) + height(x - e, y - e))
                / (4.0 * e * e),
            (height(x, y + e) - 2.0 * height(x, y) + height(x, y - e)) / (e * e),
        ];
        for (found, second) in FACE.slope_correlation([x, y]).into_iter().zip(second) {
            assert!((found * FACE.slope_rms.powi(2) + second).abs() < 1e-9, "{found} {second}");
        }
        assert_eq!(FACE.slope_correlation([0.0, 0.0]), [1.0, 0.0, 1.0]);
    }

    #[test]
    fn spectrum_integrates_to_mean_square_height_and_slope() {
        let step = 0.05;
        let rings = (0..4000).map(|k| step * (f64::from(k) + 0.5));
        let [height, slope] = rings.fold([0.0, 0.0], |[height, slope], f| {
            let power = FACE.height_spectrum(f) * 2.0 * PI * f * step;
            // Half of |2π f|² along each axis.
            [height + power, slope + power * 2.0 * (PI * f).powi(2)]
        });
        assert!((height / FACE.height_rms_mm().powi(2) - 1.0).abs() < 1e-6);
        assert!((slope / FACE.slope_rms.powi(2) - 1.0).abs() < 1e-6);
    }
}
