//! What a random face scatters by waves, as a mixture of few lobes: the same lobes at all wavelengths, in proportions that depend on the wavelength.
//!
//! **Closed form.** Behind Gaussian heights with the correlation exp(-r/l), a fraction exp(-g) of the light keeps its direction, g being the square
//! of the rms phase. The rest is the sum of exp(-g) g^m/m! times k-correlation lobes of the width m b₁, b₁ = λ/(2π l) (see [`waves`](crate::waves)).
//!
//! **Mixture.** Widths are powers of a constant (1.2). A lobe between two of them becomes both, in the proportion that keeps the
//! light within 0.7 of its width: its density is that of the lobe within 1 %.
//!
//! **Resolution.** A lobe narrower than 0.0217 becomes that one with the same light beyond 2.5 deg, which is haze, and light that keeps its
//! direction: within about 1 deg of it, nothing is resolved, and the light of such lobes beyond 10 deg is up to 12 % too much.

use std::f64::consts::PI;

use papilio_optics::lobe::KCorrelation;

use crate::goniometer::haze_beta;
use crate::waves::poisson;

/// Ratio of neighbouring widths.
const WIDTH_STEP: f64 = 1.2;

/// Power of the narrowest width, 0.0217: lobes of 1 deg, which *adding* resolves within seconds.
const NARROWEST: i32 = -21;

/// Widest lobe: wider ones are uniform, too.
const WIDEST: f64 = 4.0;

/// Fraction of the light below which a lobe is left to its neighbour.
const LEAST: f64 = 1e-4;

/// A lobe: the logarithm of its width to the base 1.2, a whole number, and its fraction of the light by wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct WaveLobe {
    /// The logarithm.
    pub power: i32,
    /// Fractions.
    pub fractions: Vec<f64>,
}

impl WaveLobe {
    /// Width of the k-correlation lobe, direction cosines.
    pub fn width(&self) -> f64 {
        WIDTH_STEP.powi(self.power)
    }
}

/// Lobes of light along the normal behind a face with the correlation exp(-r/l), ascending by width. `phase_per_um`: rms phase of the
/// light at a wavelength of 1 um, radians; `wavelengths_nm`: in air.
pub fn wave_lobes(phase_per_um: f64, correlation_um: f64, wavelengths_nm: &[f64]) -> Vec<WaveLobe> {
    let mut lobes: Vec<WaveLobe> = Vec::new();
    let mut add = |power: i32, at: usize, fraction: f64| {
        let place = lobes.partition_point(|lobe| lobe.power < power);
        if lobes.get(place).is_none_or(|lobe| lobe.power != power) {
            lobes.insert(place, WaveLobe { power, fractions: vec![0.0; wavelengths_nm.len()] });
        }
        lobes[place].fractions[at] += fraction;
    };
    for (at, nm) in wavelengths_nm.iter().enumerate() {
        let um = 1e-3 * nm;
        let g = (phase_per_um / um).powi(2);
        let first = um / (2.0 * PI * correlation_um);
        for (m, weight) in poisson(g) {
            let width = (m * first).min(WIDEST);
            let narrowest = WIDTH_STEP.powi(NARROWEST);
            if width <= narrowest {
                add(NARROWEST, at, weight * beyond(width, haze_beta()) / beyond(narrowest, haze_beta()));
                continue;
            }
            let (low, share) = neighbours(width);
            add(low, at, (1.0 - share) * weight);
            add(low + 1, at, share * weight);
        }
    }
    joined(lobes)
}

/// The next narrower width, and the share of the next wider one.
fn neighbours(width: f64) -> (i32, f64) {
    let low = (width.ln() / WIDTH_STEP.ln()).floor() as i32;
    let at = 0.7 * width;
    let [below, above] = [low, low + 1].map(|power| beyond(WIDTH_STEP.powi(power), at));
    (low, ((beyond(width, at) - below) / (above - below)).clamp(0.0, 1.0))
}

/// Fraction of a lobe beyond a distance.
fn beyond(width: f64, distance: f64) -> f64 {
    1.0 - KCorrelation { width }.fraction_within(distance)
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

    /// The mixture is the series: its haze within 0.002, its density beyond 10 deg within 1 %; few lobes are enough. The last face has narrow
    /// lobes alone.
    #[test]
    fn mixtures_are_the_series() {
        let nm = [450.0, 550.0, 650.0];
        for (rms_um, l, close) in [(0.3, 10.0, 0.02), (0.589, 15.4, 0.01), (0.05, 20.0, 0.12)] {
            let phase = 2.0 * PI * 0.5 * rms_um;
            let lobes = wave_lobes(phase, l, &nm);
            assert!(lobes.len() < 24, "{}", lobes.len());
            for (at, nm) in nm.iter().enumerate() {
                let um = 1e-3 * nm;
                let (g, first) = ((phase / um).powi(2), um / (2.0 * PI * l));
                // Poisson's weights.
                let series = |of: &dyn Fn(f64) -> f64| -> f64 {
                    let mut weight = (-g).exp();
                    let mut term = |m: i32| {
                        weight *= g / f64::from(m);
                        weight * of(f64::from(m) * first)
                    };
                    (1..400).map(&mut term).sum()
                };
                let mixture = |of: &dyn Fn(f64) -> f64| -> f64 {
                    lobes.iter().map(|lobe| lobe.fractions[at] * of(lobe.width())).sum()
                };
                let hazes = [
                    mixture(&|width| beyond(width, haze_beta())),
                    series(&|width| beyond(width, haze_beta())),
                ];
                assert!((hazes[0] - hazes[1]).abs() < 0.002, "{rms_um} {nm}: {hazes:?}");
                for beta in [0.2_f64, 0.6, 1.0] {
                    let density = |width: f64| width / (2.0 * PI * width.hypot(beta).powi(3));
                    let (mixed, exact) = (mixture(&density), series(&density));
                    assert!((mixed / exact - 1.0).abs() < close, "{rms_um} {nm} {beta}: {mixed} {exact}");
                }
            }
        }
    }
}
