//! What a random face scatters by waves, as a mixture of few lobes: the same lobes at all wavelengths, in proportions that depend on the wavelength.
//!
//! **Closed form.** Behind Gaussian heights with the correlation exp(-r/l), a fraction exp(-g) of the light keeps its direction, g being the square
//! of the rms phase. The rest is the sum of exp(-g) g^m/m! times k-correlation lobes of the width m b₁, b₁ = λ/(2π l) (see [`waves`](crate::waves)).
//!
//! **Mixture.** Widths are powers of a constant (1.3). A lobe between two of them becomes both, in the proportion that keeps the
//! light within half of its width: its density is that of the lobe within 1 %.

use std::f64::consts::PI;

/// Ratio of neighbouring widths.
const WIDTH_STEP: f64 = 1.3;

/// Widest lobe: wider ones are uniform, too.
const WIDEST: f64 = 4.0;

/// Fraction of the light below which a lobe is left to its neighbour.
const LEAST: f64 = 1e-4;

/// A lobe: the logarithm of its width to the base 1.3, a whole number, and its fraction of the light by wavelength.
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
        let most = (g + 40.0 * g.sqrt() + 40.0) as u64;
        let mut log_weight = -g;
        for m in 1..=most {
            log_weight += (g / m as f64).ln();
            let (low, share) = neighbours((m as f64 * first).min(WIDEST));
            add(low, at, (1.0 - share) * log_weight.exp());
            add(low + 1, at, share * log_weight.exp());
        }
    }
    joined(lobes)
}

/// The next narrower width, and the share of the next wider one.
fn neighbours(width: f64) -> (i32, f64) {
    let low = (width.ln() / WIDTH_STEP.ln()).floor() as i32;
    let beyond = |of: f64| of / of.hypot(0.5 * width);
    let [below, above] = [low, low + 1].map(|power| beyond(WIDTH_STEP.powi(power)));
    (low, ((beyond(width) - below) / (above - below)).clamp(0.0, 1.0))
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

    /// The mixture is the series: its density within 1 %, its light within 1e-12; few lobes are enough.
    #[test]
    fn mixtures_are_the_series() {
        let nm = [450.0, 550.0, 650.0];
        for (rms_um, l) in [(0.05, 4.0), (0.3, 10.0), (0.589, 15.4)] {
            let phase = 2.0 * PI * 0.5 * rms_um;
            let lobes = wave_lobes(phase, l, &nm);
            assert!(lobes.len() < 20, "{}", lobes.len());
            for (at, nm) in nm.iter().enumerate() {
                let um = 1e-3 * nm;
                let g = (phase / um).powi(2);
                let light: f64 = lobes.iter().map(|lobe| lobe.fractions[at]).sum();
                assert!((light - (1.0 - (-g).exp())).abs() < 1e-12, "{rms_um} {nm}: {light}");
                let lobe = |width: f64, beta: f64| width / (2.0 * PI * width.hypot(beta).powi(3));
                for beta in [0.0, 0.02, 0.05, 0.2, 0.6] {
                    let mut weight = (-g).exp();
                    let mut exact = 0.0;
                    for m in 1..400 {
                        weight *= g / f64::from(m);
                        exact += weight * lobe(f64::from(m) * um / (2.0 * PI * l), beta);
                    }
                    let mixed: f64 =
                        lobes.iter().map(|one| one.fractions[at] * lobe(one.width(), beta)).sum();
                    assert!((mixed / exact - 1.0).abs() < 0.01, "{rms_um} {nm} {beta}: {mixed} {exact}");
                }
            }
        }
    }
}
