//! What a random face scatters by waves, as a mixture of few lobes: the same lobes at all wavelengths, in
//! proportions that depend on the wavelength.
//!
//! **Closed form.** Behind Gaussian heights with the correlation exp(-r/l), a fraction exp(-g) of the light
//! keeps its direction, g being the square of the rms phase. The rest is the sum of exp(-g) g^m/m! times
//! k-correlation lobes of the width m b₁, b₁ = λ/(2π l) (see [`waves`](crate::waves)). With the correlation
//! exp(-r²/l²) the lobes are Gaussian, of the width sqrt(m) b₁, b₁ = λ/(π l) (Beckmann and Spizzichino 1963).
//!
//! **Mixture.** Widths are powers of a constant: 1.2 of k-correlation lobes, 1.1 of Gaussian ones. A lobe
//! between two of them becomes both. The proportion keeps the light of a k-correlation lobe within 0.7 of its
//! width: its density is that of the lobe within 1 %. It keeps the mean square of the distance of a Gaussian
//! lobe: its density is that of the lobe within 1.5 % up to twice its width.
//!
//! **Resolution.** A lobe narrower than 0.022 becomes that one with the same light beyond 2.5 deg, which is
//! haze, and light that keeps its direction: within about 1 deg of it, nothing is resolved, and the light of
//! such k-correlation lobes beyond 10 deg is up to 12 % too much.

use std::f64::consts::PI;

use papilio_optics::lobe::{FaceLobe, Gaussian, KCorrelation};

use crate::goniometer::haze_beta;
use crate::waves::poisson;

/// Widest lobe: wider ones are uniform, too.
const WIDEST: f64 = 4.0;

/// Fraction of the light below which a lobe is left to its neighbour.
const LEAST: f64 = 1e-4;

/// Correlation of heights at a distance r, with the correlation length l.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Correlation {
    /// exp(-r/l).
    Exponential,
    /// exp(-r²/l²).
    Gaussian,
}

impl Correlation {
    /// Ratio of neighbouring widths.
    fn step(self) -> f64 {
        match self {
            Self::Exponential => 1.2,
            Self::Gaussian => 1.1,
        }
    }

    /// Power of the narrowest width, 0.022: lobes of 1 deg, which *adding* resolves within seconds.
    fn narrowest(self) -> i32 {
        match self {
            Self::Exponential => -21,
            Self::Gaussian => -40,
        }
    }

    /// Width of the lobe of the order m, for a wavelength over 2π l.
    fn width_of(self, m: f64, um_over_length: f64) -> f64 {
        match self {
            Self::Exponential => m * um_over_length,
            Self::Gaussian => m.sqrt() * 2.0 * um_over_length,
        }
    }

    /// The lobe of a width.
    fn lobe(self, width: f64) -> FaceLobe {
        match self {
            Self::Exponential => FaceLobe::KCorrelation(KCorrelation { width }),
            Self::Gaussian => FaceLobe::Gaussian(Gaussian { width }),
        }
    }

    /// The next narrower width, and the share of the next wider one.
    fn neighbours(self, width: f64) -> (i32, f64) {
        let low = (width.ln() / self.step().ln()).floor() as i32;
        let widths = [low, low + 1].map(|power| self.step().powi(power));
        let measure = |one: f64| match self {
            Self::Exponential => self.beyond(one, 0.7 * width),
            Self::Gaussian => one * one,
        };
        let [below, above] = widths.map(measure);
        (low, ((measure(width) - below) / (above - below)).clamp(0.0, 1.0))
    }

    /// Fraction of a lobe beyond a distance.
    fn beyond(self, width: f64, distance: f64) -> f64 {
        1.0 - self.lobe(width).fraction_within(distance)
    }
}

/// A lobe, and its fraction of the light by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveLobe {
    /// The lobe.
    pub lobe: FaceLobe,
    /// Fractions.
    pub fractions: Vec<f64>,
}

/// Lobes of light along the normal behind a face, ascending by width. `phase_per_um`: rms phase of the light
/// at a wavelength of 1 um, radians; `wavelengths_nm`: in air.
pub fn wave_lobes(
    correlation: Correlation,
    phase_per_um: f64,
    correlation_um: f64,
    wavelengths_nm: &[f64],
) -> Vec<WaveLobe> {
    let mut powers: Vec<i32> = Vec::new();
    let mut lobes: Vec<WaveLobe> = Vec::new();
    let mut add = |power: i32, at: usize, fraction: f64| {
        let place = powers.partition_point(|other| *other < power);
        if powers.get(place) != Some(&power) {
            powers.insert(place, power);
            let lobe = correlation.lobe(correlation.step().powi(power));
            lobes.insert(place, WaveLobe { lobe, fractions: vec![0.0; wavelengths_nm.len()] });
        }
        lobes[place].fractions[at] += fraction;
    };
    let beyond = |width: f64| correlation.beyond(width, haze_beta());
    let narrowest = correlation.step().powi(correlation.narrowest());
    for (at, nm) in wavelengths_nm.iter().enumerate() {
        let um = 1e-3 * nm;
        let g = (phase_per_um / um).powi(2);
        let first = um / (2.0 * PI * correlation_um);
        for (m, weight) in poisson(g) {
            let width = correlation.width_of(m, first).min(WIDEST);
            if width <= narrowest {
                add(correlation.narrowest(), at, weight * beyond(width) / beyond(narrowest));
                continue;
            }
            let (low, share) = correlation.neighbours(width);
            add(low, at, (1.0 - share) * weight);
            add(low + 1, at, share * weight);
        }
    }
    joined(lobes)
}

/// Gives lobes with hardly any light to their neighbours.
fn joined(mut lobes: Vec<WaveLobe>) -> Vec<WaveLobe> {
    let is_dark = |lobe: &WaveLobe| lobe.fractions.iter().all(|fraction| *fraction < LEAST);
    while lobes.len() > 1 {
        let Some(dark) = lobes.iter().position(is_dark) else { break };
        let WaveLobe { fractions, .. } = lobes.remove(dark);
        let neighbour = dark.min(lobes.len() - 1);
        lobes[neighbour].fractions.iter_mut().zip(fractions).for_each(|(sum, one)| *sum += one);
    }
    lobes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mixture is the series: its haze within 0.002, and its density; few lobes are enough. The third
    /// face has narrow lobes alone. Densities of Gaussian lobes are compared where they are not negligible.
    #[test]
    fn mixtures_are_the_series() {
        let nm = [450.0, 550.0, 650.0];
        for (correlation, rms_um, l, close) in [
            (Correlation::Exponential, 0.3, 10.0, 0.02),
            (Correlation::Exponential, 0.589, 15.4, 0.01),
            (Correlation::Exponential, 0.05, 20.0, 0.12),
            (Correlation::Gaussian, 0.3, 3.0, 0.02),
            (Correlation::Gaussian, 1.2, 12.0, 0.03),
            (Correlation::Gaussian, 0.2, 2.0, 0.02),
        ] {
            let phase = 2.0 * PI * 0.5 * rms_um;
            let lobes = wave_lobes(correlation, phase, l, &nm);
            assert!(lobes.len() < 32, "{}", lobes.len());
            for (at, nm) in nm.iter().enumerate() {
                let um = 1e-3 * nm;
                let g = (phase / um).powi(2);
                // Poisson's weights.
                let series = |of: &dyn Fn(&FaceLobe) -> f64| -> f64 {
                    let mut weight = (-g).exp();
                    let mut term = |m: i32| {
                        weight *= g / f64::from(m);
                        let width = match correlation {
                            Correlation::Exponential => f64::from(m) * um / (2.0 * PI * l),
                            Correlation::Gaussian => f64::from(m).sqrt() * um / (PI * l),
                        };
                        weight * of(&correlation.lobe(width))
                    };
                    (1..400).map(&mut term).sum()
                };
                let mixture = |of: &dyn Fn(&FaceLobe) -> f64| -> f64 {
                    lobes.iter().map(|one| one.fractions[at] * of(&one.lobe)).sum()
                };
                let beyond = |lobe: &FaceLobe| 1.0 - lobe.fraction_within(haze_beta());
                let hazes = [mixture(&beyond), series(&beyond)];
                assert!((hazes[0] - hazes[1]).abs() < 0.002, "{correlation:?} {rms_um} {nm}: {hazes:?}");
                let distances = match correlation {
                    Correlation::Exponential => [0.2, 0.6, 1.0],
                    // Up to twice the width of all light.
                    Correlation::Gaussian => [0.3, 1.0, 2.0].map(|times| times * 2.0 * 0.5 * rms_um / l),
                };
                for beta in distances {
                    let density = |lobe: &FaceLobe| lobe.at_squared_distance(beta * beta);
                    let (mixed, exact) = (mixture(&density), series(&density));
                    let what = format!("{correlation:?} {rms_um} {nm} {beta}");
                    assert!((mixed / exact - 1.0).abs() < close, "{what}: {mixed} {exact}");
                }
            }
        }
    }

    /// Heights of many wavelengths: the lobe of geometrical optics, the distribution of the slopes m = rms
    /// sqrt(2)/l along an axis times the deviation n - 1, whatever the wavelength.
    #[test]
    fn large_gaussian_heights_refract_by_their_slopes() {
        let (rms_um, l, n) = (4.0, 60.0, 1.5);
        let nm = [450.0, 650.0];
        let lobes = wave_lobes(Correlation::Gaussian, 2.0 * PI * (n - 1.0) * rms_um, l, &nm);
        let slope = std::f64::consts::SQRT_2 * rms_um / l;
        for at in 0..nm.len() {
            for distance in [0.02, 0.05, 0.1] {
                let within: f64 =
                    lobes.iter().map(|one| one.fractions[at] * one.lobe.fraction_within(distance)).sum();
                let expected = 1.0 - (-0.5 * (distance / ((n - 1.0) * slope)).powi(2)).exp();
                assert!((within - expected).abs() < 0.01, "{distance}: {within} {expected}");
            }
        }
    }
}
