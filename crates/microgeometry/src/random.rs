//! Random faces: heights with Gaussian statistics and a given power spectral density.
//!
//! Heights are made in Fourier space: independent Gaussian amplitudes, whose variance is the two-dimensional
//! power spectral density W times the area of a bin. With frequencies in cycles per um and W in um⁴, the
//! variance of the heights is the integral of W over all frequencies.
//!
//! | kind | correlation of heights | W(f) |
//! |---|---|---|
//! | Gaussian | `exp(-r²/τ²)` | `π τ² s² exp(-(π τ f)²)` |
//! | exponential | `exp(-r/τ)` | `2 π τ² s² (1 + (2 π τ f)²)^(-3/2)`, up to the cut-off |
//! | ABC | by its PSD | `A (1 + (B f)²)^(-C/2)`, up to the cut-off |
//! | table | by its PSD | that of a measurement, up to the cut-off |
//!
//! s is the root mean square height. The rms slope of an exponential face grows without limit with the
//! cut-off of its frequencies: rays have no answer without one.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_fourier::Plane;
use papilio_sampling::{SampleStream, Sampler};

use crate::{HeightMap, MicrogeometryError};

/// Statistics of a random face.
#[derive(Debug, Clone, PartialEq)]
pub enum Spectrum {
    /// Correlation of heights `exp(-r²/τ²)`.
    Gaussian {
        /// Root mean square height s, um.
        rms_um: f64,
        /// Distance τ at which the correlation is 1/e, um.
        correlation_um: f64,
    },
    /// Correlation of heights `exp(-r/τ)`, without frequencies beyond a cut-off.
    Exponential {
        /// Root mean square height s without the cut-off, um.
        rms_um: f64,
        /// Distance τ at which the correlation is 1/e, um.
        correlation_um: f64,
        /// Shortest wavelength of the face, um.
        cutoff_um: f64,
    },
    /// K-correlation (ABC) model of the two-dimensional power spectral density, without frequencies beyond a
    /// cut-off.
    Abc {
        /// A (um⁴), B (um) and C.
        abc: [f64; 3],
        /// Shortest wavelength of the face, um.
        cutoff_um: f64,
    },
    /// Two-dimensional power spectral density by a table: straight lines between its points if both axes are
    /// logarithmic, constant below the first frequency, and 0 above the last one and beyond the cut-off.
    Table {
        /// Frequencies (cycles per um), ascending and at least 0, and densities (um⁴), at least 0.
        points: Vec<[f64; 2]>,
        /// Shortest wavelength of the face, um.
        cutoff_um: f64,
    },
}

impl Spectrum {
    /// Root mean square height without a cut-off, um, where it is given.
    pub fn rms_um(&self) -> Option<f64> {
        match *self {
            Self::Gaussian { rms_um, .. } | Self::Exponential { rms_um, .. } => Some(rms_um),
            Self::Abc { .. } | Self::Table { .. } => None,
        }
    }
}

/// Density of a table at a frequency.
fn of_table(points: &[[f64; 2]], frequency: f64) -> f64 {
    let after = points.partition_point(|[known, _]| *known < frequency);
    match (points.get(after.wrapping_sub(1)), points.get(after)) {
        (None, Some([_, density])) => *density,
        (Some([f, w]), Some([g, v])) => match *f > 0.0 && *w > 0.0 && *v > 0.0 {
            true => w * (v / w).powf((frequency / f).ln() / (g / f).ln()),
            false => w + (v - w) * (frequency - f) / (g - f),
        },
        (_, None) => 0.0,
    }
}

/// Length of the longest structures of a table: that of the frequency at which its density has fallen to half
/// of its first value.
fn longest_of_table(points: &[[f64; 2]]) -> f64 {
    let first = points.first().map_or(0.0, |[_, density]| *density);
    let half = points.iter().find(|[frequency, density]| *frequency > 0.0 && *density <= 0.5 * first);
    half.or(points.last()).map_or(0.0, |[frequency, _]| 1.0 / (2.0 * PI * frequency))
}

/// Fails for a table that is no density.
fn check_table(points: &[[f64; 2]]) -> Result<(), MicrogeometryError> {
    let is_right = points.iter().flatten().all(|value| value.is_finite() && *value >= 0.0)
        && points.windows(2).all(|pair| pair[0][0] < pair[1][0])
        && points.iter().any(|[frequency, density]| *frequency > 0.0 && *density > 0.0);
    if is_right {
        return Ok(());
    }
    let wrong = "this table is no power spectral density (expected ascending frequencies, and finite densities of at least 0)";
    Err(MicrogeometryError::RandomFace { wrong: wrong.to_owned() })
}

/// Cells in a correlation length of a Gaussian face, and in the shortest wavelength of others: facets then
/// follow the slopes within 1 %.
const CELLS: f64 = 12.0;

/// Cells in the shortest wavelength of a face for waves, whose phase needs no facets.
const CELLS_OF_WAVES: f64 = 4.0;

/// Largest rms height over the correlation length: an rms slope of 7.
const MOST_ASPECT: f64 = 5.0;

/// Fewest correlation lengths along a side.
const LENGTHS: f64 = 20.0;

/// Fewest and most cells along a side.
const SIDE: [usize; 2] = [256, 4096];

/// A random face.
#[derive(Debug, Clone, PartialEq)]
pub struct RandomHeights {
    spectrum: Spectrum,
    seed: u64,
    side: usize,
    pitch_um: f64,
}

impl RandomHeights {
    /// A face of these statistics.
    ///
    /// # Errors
    /// Numbers that are not positive; lengths whose ratio needs more than 4096 cells along a side.
    pub fn new(spectrum: Spectrum, seed: u64) -> Result<Self, MicrogeometryError> {
        Self::with_cells(spectrum, seed, CELLS)
    }

    /// The same statistics on the coarser grid that is enough for waves, if they have a cut-off.
    pub(crate) fn for_waves(&self) -> Result<Self, MicrogeometryError> {
        match self.spectrum {
            Spectrum::Gaussian { .. } => Ok(self.clone()),
            Spectrum::Exponential { .. } | Spectrum::Abc { .. } | Spectrum::Table { .. } => {
                Self::with_cells(self.spectrum.clone(), self.seed, CELLS_OF_WAVES)
            }
        }
    }

    fn with_cells(spectrum: Spectrum, seed: u64, cells: f64) -> Result<Self, MicrogeometryError> {
        let (lengths, finest, longest) = match spectrum {
            Spectrum::Gaussian { rms_um, correlation_um } => (
                vec![("rms height (um)", rms_um), ("correlation length (um)", correlation_um)],
                correlation_um,
                correlation_um,
            ),
            Spectrum::Exponential { rms_um, correlation_um, cutoff_um } => {
                let all = vec![
                    ("rms height (um)", rms_um),
                    ("correlation length (um)", correlation_um),
                    ("cut-off (um)", cutoff_um),
                ];
                (all, cutoff_um, correlation_um)
            }
            Spectrum::Abc { abc: [a, b, c], cutoff_um } => (
                vec![("A (um4)", a), ("B (um)", b), ("C", c), ("cut-off (um)", cutoff_um)],
                cutoff_um,
                b / (2.0 * PI),
            ),
            Spectrum::Table { ref points, cutoff_um } => {
                check_table(points)?;
                (vec![("cut-off (um)", cutoff_um)], cutoff_um, longest_of_table(points))
            }
        };
        if let Some((what, value)) =
            lengths.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0))
        {
            return Err(MicrogeometryError::NotANumber {
                of: "a random face",
                what,
                value,
                wanted: "positive",
            });
        }
        if let Spectrum::Gaussian { rms_um, correlation_um }
        | Spectrum::Exponential { rms_um, correlation_um, .. } = spectrum
            && rms_um > MOST_ASPECT * correlation_um
        {
            let wrong = format!(
                "heights of {rms_um:e} um rms with a correlation length of {correlation_um:e} um are spikes, between which light meets facets without \
                 end (expected a `correlation_um` of at least {:e} or lower heights)",
                rms_um / MOST_ASPECT
            );
            return Err(MicrogeometryError::RandomFace { wrong });
        }
        let pitch_um = finest / cells;
        let cells = (LENGTHS * longest.max(finest) / pitch_um).ceil() as usize;
        if cells > SIDE[1] {
            let wrong = format!(
                "a random face with structures from {finest} um to {longest} um needs {cells} x {cells} heights (expected at most {most} along a \
                 side; a longer cut-off needs fewer)",
                most = SIDE[1]
            );
            return Err(MicrogeometryError::RandomFace { wrong });
        }
        Ok(Self { spectrum, seed, side: cells.max(SIDE[0]).next_power_of_two(), pitch_um })
    }

    /// Its statistics.
    pub fn spectrum(&self) -> &Spectrum {
        &self.spectrum
    }

    /// Number of heights along a side of a realisation, and their distance, um.
    pub fn grid(&self) -> (usize, f64) {
        (self.side, self.pitch_um)
    }

    /// Two-dimensional power spectral density at a frequency (cycles per um), um⁴.
    pub fn density_um4(&self, frequency: f64) -> f64 {
        match self.spectrum {
            Spectrum::Gaussian { rms_um, correlation_um: tau } => {
                PI * (tau * rms_um).powi(2) * (-(PI * tau * frequency).powi(2)).exp()
            }
            Spectrum::Exponential { rms_um, correlation_um: tau, cutoff_um } => {
                match frequency * cutoff_um <= 1.0 {
                    true => {
                        2.0 * PI
                            * (tau * rms_um).powi(2)
                            * (1.0 + (2.0 * PI * tau * frequency).powi(2)).powf(-1.5)
                    }
                    false => 0.0,
                }
            }
            Spectrum::Abc { abc: [a, b, c], cutoff_um } => match frequency * cutoff_um <= 1.0 {
                true => a * (1.0 + (b * frequency).powi(2)).powf(-0.5 * c),
                false => 0.0,
            },
            Spectrum::Table { ref points, cutoff_um } => match frequency * cutoff_um <= 1.0 {
                true => of_table(points, frequency),
                false => 0.0,
            },
        }
    }

    /// The same statistics over a square whose side is at least this long, as far as the largest number of
    /// heights allows.
    pub(crate) fn over(&self, least_um: f64) -> Self {
        let wanted = (least_um / self.pitch_um).ceil().min(SIDE[1] as f64) as usize;
        Self { side: self.side.max(wanted.next_power_of_two()), ..self.clone() }
    }

    /// Heights of a replicate, periodic in both directions.
    ///
    /// # Errors
    /// None for a face that could be made.
    pub fn realisation(&self, replicate: u64) -> Result<HeightMap, MicrogeometryError> {
        let side = self.side;
        let bin = 1.0 / (side as f64 * self.pitch_um);
        let numbers = SampleStream::new(Sampler::Random, self.seed, replicate).part(0x6865_6967_6874);
        let frequency = |k: usize| bin * if 2 * k > side { k as f64 - side as f64 } else { k as f64 };
        let amplitude = |at: usize| {
            let [column, row] = [at / side, at % side];
            let density = self.density_um4(frequency(column).hypot(frequency(row)));
            // The mean height is none; the real part of complex noise has half of its variance, in both
            // parts.
            let scale = if at == 0 { 0.0 } else { (density * bin * bin).sqrt() };
            let [u, v, ..] = numbers.block(at as u64, 0);
            // Box and Muller (1958).
            Complex64::from_polar(scale * (-2.0 * u.ln()).sqrt(), 2.0 * PI * v)
        };
        let spectrum: Vec<Complex64> = (0..side * side).map(amplitude).collect();
        let heights = Plane::new([side; 2]).inverse(spectrum);
        HeightMap::new(side, [self.pitch_um; 2], heights.into_iter().map(|height| height.re).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A table of the ABC model is the model: between its points, and in its heights.
    #[test]
    fn tables_of_a_density_are_the_density() {
        let (abc, cutoff_um) = ([0.02, 15.0, 3.0], 1.5);
        let model = RandomHeights::new(Spectrum::Abc { abc, cutoff_um }, 4).unwrap();
        let point = |k: u32| {
            let frequency = 1e-3 * 10_f64.powf(0.01 * f64::from(k));
            [frequency, model.density_um4(frequency)]
        };
        let mut points: Vec<[f64; 2]> =
            (0..=290).map(point).take_while(|[_, density]| *density > 0.0).collect();
        points.push([1.0 / cutoff_um, model.density_um4(1.0 / cutoff_um)]);
        let table = RandomHeights::new(Spectrum::Table { points: points.clone(), cutoff_um }, 4).unwrap();
        for frequency in [0.0, 0.00123, 0.0456, 0.3, 0.65] {
            let ratio = table.density_um4(frequency) / model.density_um4(frequency);
            assert!((ratio - 1.0).abs() < 1e-3, "{frequency}: {ratio}");
        }
        assert_eq!(table.density_um4(0.7), 0.0);
        assert_eq!(table.grid(), model.grid());
        let [one, other] = [&table, &model].map(|face| face.realisation(0).unwrap());
        let rms = model.realisation(0).unwrap().statistics().rms_um;
        let largest =
            one.heights_um().iter().zip(other.heights_um()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(largest < 5e-3 * rms, "{largest} {rms}");
        for wrong in [vec![], vec![[0.1, -1.0]], vec![[0.2, 1.0], [0.1, 1.0]], vec![[0.0, 1.0]]] {
            assert!(RandomHeights::new(Spectrum::Table { points: wrong, cutoff_um }, 0).is_err());
        }
    }
}
