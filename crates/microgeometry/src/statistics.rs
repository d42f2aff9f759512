//! Statistics of heights: moments, correlation length, power spectral density, and what an instrument's
//! cut-off leaves of rms and slopes.
//!
//! The map is taken as periodic, as rays see it. With the amplitudes a(f) of its discrete Fourier transform,
//! divided by the number of heights, the power spectral density W is `|a|² A` (A the area of the map), its
//! integral over all frequencies the variance, and that of `(2π f)² W` the variance of the slopes. Sums over
//! frequencies are taken over rings as wide as one step of the frequency.
//!
//! **Filters** are Gaussians of ISO 16610-61, with a transmission of 50 % at the cut-off:
//! `exp(-ln 2 (f λ)²)`.

use std::f64::consts::{LN_2, TAU};

use num_complex::Complex64;
use papilio_fourier::Plane;

use crate::{HeightMap, HeightStatistics};

/// Bins of the power spectral density, equal steps of the logarithm of the frequency.
const BINS: usize = 40;

/// Cut-offs at which rms and slopes are stated.
const CUTOFFS: usize = 24;

/// Statistics of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Statistics {
    /// Root mean square height about the mean, um.
    pub rms_um: f64,
    /// Skewness of the heights: 0 for Gaussian ones, negative for pits.
    pub skewness: f64,
    /// Kurtosis of the heights: 3 for Gaussian ones.
    pub kurtosis: f64,
    /// Root mean square slope between neighbours along x and y: that of the facets.
    pub slope_rms: [f64; 2],
    /// Smallest distance at which the autocorrelation, averaged over all directions, is 1/e, um; `None` for a
    /// flat map, or if it does not fall so far within half of the map.
    pub correlation_um: Option<f64>,
    /// Two-dimensional power spectral density, averaged over directions: frequency (cycles per um) and
    /// density (um⁴).
    pub density: Vec<[f64; 2]>,
    /// Cut-off of a Gaussian filter of short wavelengths (um), and rms height (um) and rms slope (along one
    /// axis) of what passes it.
    pub by_cutoff: Vec<[f64; 3]>,
}

impl Statistics {
    /// The statistics of a map.
    pub fn of(map: &HeightMap) -> Self {
        let heights = map.heights_um();
        let count = heights.len() as f64;
        let mean = heights.iter().sum::<f64>() / count;
        let moment =
            |power: i32| heights.iter().map(|height| (height - mean).powi(power)).sum::<f64>() / count;
        let HeightStatistics { rms_um, slope_rms } = map.statistics();
        let waves = Waves::of(map, mean);
        let rings = waves.rings();
        let relative = |power: i32| if rms_um > 0.0 { moment(power) / rms_um.powi(power) } else { 0.0 };
        Self {
            rms_um,
            skewness: relative(3),
            kurtosis: relative(4),
            slope_rms,
            correlation_um: waves.correlation_um(),
            density: waves.density(&rings),
            by_cutoff: waves.by_cutoff(&rings),
        }
    }
}

impl HeightMap {
    /// The map after Gaussian filters: what is shorter than `short_um` is removed, and what is longer than
    /// `long_um`.
    #[must_use]
    pub fn filtered(&self, short_um: Option<f64>, long_um: Option<f64>) -> Self {
        let plane = Plane::new([self.columns(), self.rows()]);
        let mut orders =
            plane.forward(self.heights_um().iter().map(|height| Complex64::from(*height)).collect());
        let count = orders.len() as f64;
        for (at, order) in orders.iter_mut().enumerate() {
            let [x, y] = frequency(self, at);
            let passed = |cutoff: f64| (-LN_2 * (x * x + y * y) * cutoff * cutoff).exp();
            *order *= short_um.map_or(1.0, passed) * long_um.map_or(1.0, |long| 1.0 - passed(long)) / count;
        }
        let heights = plane.inverse(orders).into_iter().map(|height| height.re).collect();
        self.with_heights(heights)
    }
}

/// Frequency of an order of the transform of a map, along x and y, cycles per um.
fn frequency(map: &HeightMap, at: usize) -> [f64; 2] {
    let [columns, rows] = [map.columns(), map.rows()];
    let of = |k: usize, count: usize, pitch: f64| {
        let order = if 2 * k > count { k as f64 - count as f64 } else { k as f64 };
        order / (count as f64 * pitch)
    };
    [of(at / rows, columns, map.pitch_um()[0]), of(at % rows, rows, map.pitch_um()[1])]
}

/// The waves of a map.
struct Waves<'a> {
    map: &'a HeightMap,
    /// Variance of each order, um².
    power: Vec<f64>,
}

impl<'a> Waves<'a> {
    fn of(map: &'a HeightMap, mean: f64) -> Self {
        let plane = Plane::new([map.columns(), map.rows()]);
        let heights = map.heights_um().iter().map(|height| Complex64::from(height - mean)).collect();
        let count = map.heights_um().len() as f64;
        let power = plane.forward(heights).iter().map(|order| order.norm_sqr() / (count * count)).collect();
        Self { map, power }
    }

    /// Area of the map, um².
    fn area(&self) -> f64 {
        let pitch = self.map.pitch_um();
        self.power.len() as f64 * pitch[0] * pitch[1]
    }

    /// Step of the frequency: one wave along the longer side.
    fn step(&self) -> f64 {
        let pitch = self.map.pitch_um();
        1.0 / (self.map.columns() as f64 * pitch[0]).max(self.map.rows() as f64 * pitch[1])
    }

    /// Highest frequency that the heights resolve along both axes.
    fn highest(&self) -> f64 {
        let pitch = self.map.pitch_um();
        0.5 / pitch[0].max(pitch[1])
    }

    /// Sums over rings of frequencies, ascending, without the mean height.
    fn rings(&self) -> Vec<Ring> {
        let step = self.step();
        let mut rings: Vec<Ring> = Vec::new();
        for (at, power) in self.power.iter().enumerate().skip(1) {
            let [x, y] = frequency(self.map, at);
            let frequency = x.hypot(y);
            let ring = (frequency / step).round() as usize;
            if ring >= rings.len() {
                rings.resize(ring + 1, Ring::default());
            }
            rings[ring].frequency += frequency;
            rings[ring].power += power;
            rings[ring].squares += power * frequency * frequency;
            rings[ring].count += 1.0;
        }
        rings.retain(|ring| ring.count > 0.0);
        rings.iter_mut().for_each(|ring| ring.frequency /= ring.count);
        rings
    }

    /// Smallest distance at which the mean correlation is 1/e.
    fn correlation_um(&self) -> Option<f64> {
        let plane = Plane::new([self.map.columns(), self.map.rows()]);
        let correlation = plane.inverse(self.power.iter().map(|power| Complex64::from(*power)).collect());
        let pitch = self.map.pitch_um();
        let [columns, rows] = [self.map.columns(), self.map.rows()];
        let step = pitch[0].max(pitch[1]);
        let rings = columns.min(rows) / 2;
        let mut sums = vec![[0.0; 2]; rings + 1];
        for (at, value) in correlation.iter().enumerate() {
            let near = |k: usize, count: usize| k.min(count - k) as f64;
            let [x, y] = [near(at % columns, columns) * pitch[0], near(at / columns, rows) * pitch[1]];
            if let Some(sum) = sums.get_mut((x.hypot(y) / step).round() as usize) {
                sum[0] += value.re;
                sum[1] += 1.0;
            }
        }
        let means: Vec<f64> = sums.iter().map(|[sum, count]| sum / count.max(1.0)).collect();
        let variance = means.first().copied().filter(|variance| *variance > 0.0)?;
        let wanted = variance * (-1.0_f64).exp();
        let ring = means.iter().position(|mean| *mean < wanted)?;
        let [before, after] = [means[ring - 1], means[ring]];
        Some(step * (ring as f64 - 1.0 + (before - wanted) / (before - after)))
    }

    /// Mean density in bins of the logarithm of the frequency.
    fn density(&self, rings: &[Ring]) -> Vec<[f64; 2]> {
        let (least, most) = (self.step(), self.highest());
        let mut bins = vec![Ring::default(); BINS];
        for ring in rings {
            let bin = (BINS as f64 * (ring.frequency / least).ln() / (most / least).ln()).floor();
            if bin >= 0.0 && bin < BINS as f64 {
                let bin = &mut bins[bin as usize];
                bin.frequency += ring.frequency * ring.count;
                bin.power += ring.power;
                bin.count += ring.count;
            }
        }
        let area = self.area();
        let filled = bins.into_iter().filter(|bin| bin.count > 0.0);
        filled.map(|bin| [bin.frequency / bin.count, area * bin.power / bin.count]).collect()
    }

    /// Root mean square height and slope that pass each cut-off.
    fn by_cutoff(&self, rings: &[Ring]) -> Vec<[f64; 3]> {
        let (least, most) = (1.0 / self.highest(), 0.5 / self.step());
        if most <= least {
            return Vec::new();
        }
        let row = |k: usize| {
            let cutoff = least * (most / least).powf(k as f64 / (CUTOFFS - 1) as f64);
            let passed =
                |ring: &Ring| ring.power * (-2.0 * LN_2 * ring.mean_square() * cutoff * cutoff).exp();
            let variance: f64 = rings.iter().map(passed).sum();
            let slopes: f64 = rings.iter().map(|ring| passed(ring) * TAU * TAU * ring.mean_square()).sum();
            // Along one axis: half of the square of the gradient.
            [cutoff, variance.sqrt(), (0.5 * slopes).sqrt()]
        };
        (0..CUTOFFS).map(row).collect()
    }
}

/// A ring of frequencies: their mean (cycles per um), the sum of their variances (um²), and their number.
#[derive(Debug, Clone, Copy, Default)]
struct Ring {
    frequency: f64,
    power: f64,
    /// The variances, each times the square of its frequency.
    squares: f64,
    count: f64,
}

impl Ring {
    /// Mean square of the frequency, weighted by the variances: exact for a single wave.
    fn mean_square(&self) -> f64 {
        if self.power > 0.0 { self.squares / self.power } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{RandomHeights, Spectrum};

    /// A Gaussian face has the statistics that it is made of.
    #[test]
    fn gaussian_faces_have_their_statistics() {
        let spectrum = Spectrum::Gaussian { rms_um: 0.3, correlation_um: 5.0 };
        let face = RandomHeights::new(spectrum, 3).unwrap();
        let found = Statistics::of(&face.realisation(0).unwrap());
        assert!((found.rms_um / 0.3 - 1.0).abs() < 0.06, "{}", found.rms_um);
        let correlation = found.correlation_um.unwrap();
        assert!((correlation / 5.0 - 1.0).abs() < 0.1, "{correlation}");
        // Slopes of a Gaussian: 2^(1/2) rms/correlation along each axis.
        let slope = 2.0_f64.sqrt() * 0.3 / 5.0;
        assert!(
            found.slope_rms.iter().all(|found| (found / slope - 1.0).abs() < 0.1),
            "{:?}",
            found.slope_rms
        );
        assert!(found.skewness.abs() < 0.4 && (found.kurtosis - 3.0).abs() < 0.8, "{found:?}");
        // The density where there is much of it, in rings of many orders.
        let largest = face.density_um4(0.0);
        let some: Vec<f64> = found
            .density
            .iter()
            .filter(|[f, _]| face.density_um4(*f) > 0.05 * largest && *f > 0.04)
            .map(|[f, density]| density / face.density_um4(*f))
            .collect();
        let mean = some.iter().sum::<f64>() / some.len() as f64;
        assert!(some.len() > 3 && (mean - 1.0).abs() < 0.15, "{some:?}");
    }

    /// A wave at the cut-off keeps half of its height, in the map and in the table; a longer one by the other
    /// filter.
    #[test]
    fn filters_pass_half_at_the_cut_off() {
        let side = 64;
        let height = |at: usize| (TAU * 4.0 * (at % side) as f64 / side as f64).sin();
        let map = HeightMap::new(side, [0.5; 2], (0..side * side).map(height).collect()).unwrap();
        // 4 periods of 8 um.
        let rms = |map: &HeightMap| Statistics::of(map).rms_um;
        assert!((rms(&map) - 0.5_f64.sqrt()).abs() < 1e-12);
        for filtered in [map.filtered(Some(8.0), None), map.filtered(None, Some(8.0))] {
            assert!((rms(&filtered) / rms(&map) - 0.5).abs() < 1e-12);
        }
        // Between neighbours 1/16 of a period apart.
        let slope = 2.0 * (TAU / 32.0).sin() / 0.5 * 0.5_f64.sqrt();
        let found = Statistics::of(&map);
        assert!((found.slope_rms[0] - slope).abs() < 1e-12 && found.slope_rms[1] < 1e-9);
        // A wave of 8 um behind a filter: its gradient is along x alone.
        let [cutoff, rms, slope] = found.by_cutoff[10];
        let passed = (-LN_2 * (cutoff / 8.0).powi(2)).exp() * 0.5_f64.sqrt();
        assert!((rms - passed).abs() < 1e-12 && (slope - passed * TAU / 8.0 * 0.5_f64.sqrt()).abs() < 1e-12);
        assert!(found.by_cutoff.windows(2).all(|pair| pair[1][1] < pair[0][1] && pair[1][2] < pair[0][2]));
        assert_eq!(Statistics::of(&HeightMap::new(1, [1.0; 2], vec![0.3]).unwrap()).correlation_um, None);
    }
}
