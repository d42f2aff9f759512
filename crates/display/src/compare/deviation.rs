//! Standard deviations of both sides, and the agreement of numbers within them.

use papilio_spectra::Tabulated;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Colour, Quantity, SpectrumComparison};

/// Standard deviation of a measured quantity, in its unit.
#[derive(Debug, Clone, PartialEq)]
pub enum StandardDeviation {
    /// Of a spectrum at each of its wavelengths.
    Spectrum(Tabulated),
    /// Of the three numbers of a colour.
    Colour([f64; 3]),
}

/// Standard deviations of the numbers of a simulated state.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StateDeviation {
    /// Of the reflectance factors; empty if they are not known.
    pub reflectance_factor: Vec<f64>,
    /// Of X, Y, Z.
    pub xyz: [f64; 3],
    /// Of L\*, a\*, b\*.
    pub lab: [f64; 3],
}

/// Agreement of several numbers: `z` is a difference over its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Agreement {
    /// How many numbers were compared.
    pub count: usize,
    /// Root mean square of z; about 1 if the differences are as large as their standard deviations.
    pub z_rms: f64,
    /// Fraction of the numbers whose z is from -2 to 2; about 0.954 of independent normal errors.
    pub within_2: f64,
}

impl Agreement {
    /// Agreement of the numbers of several; `None` of none.
    pub fn together(all: impl Iterator<Item = Self>) -> Option<Self> {
        let of = |one: Self| [1.0, one.z_rms * one.z_rms, one.within_2].map(|value| value * one.count as f64);
        let [count, squares, within] =
            all.map(of).fold([0.0; 3], |sum, one| [sum[0] + one[0], sum[1] + one[1], sum[2] + one[2]]);
        (count > 0.0).then(|| Self {
            count: count as usize,
            z_rms: (squares / count).sqrt(),
            within_2: within / count,
        })
    }

    /// Agreement of numbers by their z; `None` of none.
    pub fn of(all: impl Iterator<Item = f64>) -> Option<Self> {
        let (mut count, mut squares, mut within) = (0, 0.0, 0);
        for z in all {
            count += 1;
            squares += z * z;
            within += usize::from(z.abs() <= 2.0);
        }
        let fraction = |sum: f64| sum / count as f64;
        (count > 0).then(|| Self {
            count,
            z_rms: fraction(squares).sqrt(),
            within_2: fraction(within as f64),
        })
    }
}

/// z at the measured wavelengths, from z on a finer grid, between whose points it is linear; as it is if the
/// measurement is as fine.
pub(super) fn z_of_measured(z: &[f64], grid_nm: &[f64], measured_nm: &[f64]) -> Vec<f64> {
    let (Some(&first), Some(&last)) = (grid_nm.first(), grid_nm.last()) else { return z.to_vec() };
    let own: Vec<f64> = measured_nm.iter().copied().filter(|nm| (first..=last).contains(nm)).collect();
    if z.len() != grid_nm.len() || own.len() >= z.len() {
        return z.to_vec();
    }
    let at = |nm: &f64| {
        let above = grid_nm.partition_point(|known| known < nm).clamp(1, z.len() - 1);
        let along = (nm - grid_nm[above - 1]) / (grid_nm[above] - grid_nm[above - 1]);
        z[above - 1] + along * (z[above] - z[above - 1])
    };
    own.iter().map(at).collect()
}

/// z of a difference, from the standard deviations of both sides; `None` if both are 0.
pub(super) fn z(difference: f64, [simulated, measured]: [f64; 2]) -> Option<f64> {
    let deviation = simulated.hypot(measured);
    (deviation > 0.0).then(|| difference / deviation)
}

impl StateDeviation {
    /// z of the measured numbers; empty if their standard deviation is not known.
    pub(super) fn z(
        &self,
        quantity: &Quantity,
        measured: Option<&StandardDeviation>,
        sides: [&Colour; 2],
        spectrum: Option<&SpectrumComparison>,
    ) -> Vec<f64> {
        let of_colour = |all: [[Option<f64>; 3]; 2], own: [f64; 3], measured: [f64; 3]| {
            let [simulated, seen] = all;
            let pairs = simulated.into_iter().zip(seen).zip(own).zip(measured);
            pairs.filter_map(|(((a, b), own), measured)| z(a? - b?, [own, measured])).collect()
        };
        match (quantity, measured, spectrum) {
            (Quantity::Xyz(_), Some(StandardDeviation::Colour(measured)), _) => {
                of_colour(sides.map(|one| [one.X, one.Y, one.Z].map(Some)), self.xyz, *measured)
            }
            (Quantity::Lab(_), Some(StandardDeviation::Colour(measured)), _) => {
                of_colour(sides.map(|one| [one.L_star, one.a_star, one.b_star]), self.lab, *measured)
            }
            (Quantity::Spectrum(_), Some(StandardDeviation::Spectrum(_)), Some(both)) => {
                let own = both.simulated_deviation.iter().copied().chain(std::iter::repeat(0.0));
                let differences = both.simulated.iter().zip(&both.measured);
                let all = differences.zip(own).zip(&both.measured_deviation);
                all.filter_map(|(((a, b), own), measured)| z(a - b, [own, *measured])).collect()
            }
            _ => Vec::new(),
        }
    }
}
