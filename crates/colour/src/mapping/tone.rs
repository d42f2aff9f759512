//! Tone curve of natural pictures: from the lightness of a picture to that of a display whose black is light.
//!
//! **What.** With the lightness K of the display's black, white being 1, and `s(x) = ln(1 + exp(x))`,
//! `g(L) = K + (1 - K) (s(a (L - K)) - s(-a K)) / (s(a (1 - K)) - s(-a K))`: light tones stay where they are,
//! dark ones bend towards K; 0 becomes K and 1 stays. It increases everywhere, and its slope is continuous.
//! A black that is added to all colours in linear light, as by black point compensation, is a veil instead:
//! with a black of 0.07 of white, light and saturated colours lose half of their chroma.
//!
//! **Parameters.** K from 0 to below 1, and the sharpness `a K` of the bend: 3 is smooth, 8 keeps more tones
//! where they are, and leaves less detail below the black.

/// A tone curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tone {
    black: f64,
    steepness: f64,
    least: f64,
    scale: f64,
}

/// Lightness of a black below which the curve is that of this lightness: it is a straight line then, to 1e-3.
const LEAST_BLACK: f64 = 1e-3;

impl Tone {
    /// The curve of a display whose black has this lightness.
    pub fn new(black: f64, sharpness: f64) -> Self {
        let black = if black.is_finite() { black.clamp(0.0, 0.99) } else { 0.0 };
        let steepness = sharpness / black.max(LEAST_BLACK);
        let least = softplus(-steepness * black);
        let scale = (1.0 - black) / (softplus(steepness * (1.0 - black)) - least);
        Self { black, steepness, least, scale }
    }

    /// Lightness on the display of a lightness of the picture, which is limited to 0 to 1.
    pub fn lightness(&self, lightness: f64) -> f64 {
        let lightness = lightness.clamp(0.0, 1.0);
        let bent = softplus(self.steepness * (lightness - self.black)) - self.least;
        (self.black + self.scale * bent).clamp(self.black, 1.0)
    }
}

/// `ln(1 + exp(x))`.
fn softplus(x: f64) -> f64 {
    x.max(0.0) + (-x.abs()).exp().ln_1p()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tone_keeps_light_tones_and_white_and_increases() {
        for black in [0.0, 0.01, 0.2, 0.42, 0.6] {
            for sharpness in [2.5, 4.0, 8.0] {
                let tone = Tone::new(black, sharpness);
                let at = |k: i32| tone.lightness(f64::from(k) / 1000.0);
                assert!((at(0) - black).abs() < 1e-15 && (at(1000) - 1.0).abs() < 1e-12, "{black}");
                assert!((0..1000).all(|k| at(k) < at(k + 1)), "{black} {sharpness}");
                // Tones above the black stay, to what the softplus adds to its asymptote, ln 2 at most.
                let most = std::f64::consts::LN_2 * black.max(1e-3) / sharpness;
                let added = |k: i32| at(k) - f64::from(k) / 1000.0;
                let above = (1000.0 * black).ceil() as i32..=1000;
                assert!(above.clone().all(|k| (-0.01..=1.05 * most + 1e-9).contains(&added(k))), "{black}");
            }
        }
    }
}
