//! Removal of an instrument's blur of known width.
//!
//! Blurred lobes are wider and lower than those of the sample: a diffuser of haze 78 % appears to have 90 %.
//! Deconvolution is ill-posed: details finer than the blur, and noise with them, are amplified exponentially.
//! Therefore only the rotationally symmetric shape of the lobe is deconvolved, and the cells are scaled
//! accordingly:
//!
//! 1. For each incidence, the mean over azimuth at equal |delta| = |beta_out - beta_in| is a radial profile
//!    d; beyond the horizon its tail is extrapolated. Blurring a profile is a matrix A, whose elements are
//!    elliptic integrals.
//! 2. The Richardson-Lucy iteration `p <- p A(d/A p)` (Richardson 1972; Lucy 1974) keeps p positive and
//!    conserves its light. It starts from d times a ratio of two k-correlation lobes: one with the half width
//!    of d minus the blur, over one with the half width of d. It ends when `A p` is within the given noise of
//!    d, when the misfit no longer decreases, or at a limit: [`DeblurStatistics::iterations`].
//! 3. Each cell is multiplied by `p/(A p)` at its |delta|. The noise of single cells is thus not amplified,
//!    only that of the mean. The asymmetry of the lobe remains as measured, and is not sharpened. The
//!    integral over the hemisphere is conserved.
//!
//! The result is blurred again with the quadrature of the virtual instrument and compared with the values:
//! [`DeblurStatistics::misfit`] is the difference that the method cannot explain.
//!
//! **Limits.** Details finer than about half the blur or than the grid's step are not recovered; there the
//! start determines the result. K-correlation lobes are recovered to 0.5 %. A Gaussian as wide as the blur is
//! recovered to 12 % at its peak and to some per cent on its flanks; its tails stay too bright, by about 1e-3
//! of the peak.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_sampling::{SampleStream, Sampler};

use super::blur::BlurredLobe;
use super::quadrature::Rule;
use super::rings::Rings;
use crate::{Fill, Geometry, GoniometryError, MeasuredPart, Shape, SpecularGrid};

/// Relative noise and number of draws of the trials that estimate the noise amplification.
const TRIAL_NOISE: f64 = 1e-3;
const DRAWS: u64 = 4;
/// Fraction of the peak above which cells count in the misfit and the noise amplification.
const FAINT: f64 = 1e-2;

/// Options of the removal of a blur.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeblurOptions {
    /// Width of the instrument's kernel, direction cosines, 0.0001 to 1: that of a k-correlation lobe,
    /// the image of a collimated beam.
    pub width: f64,
    /// Relative noise of a lobe's mean over azimuth; smaller misfits are not significant.
    pub noise: f64,
    /// Largest number of iterations.
    pub iterations: usize,
}

impl DeblurOptions {
    /// Options for an instrument with this width, with a noise of 1e-3 and at most 500 iterations.
    pub fn of_width(width: f64) -> Self {
        Self { width, noise: 1e-3, iterations: 500 }
    }
}

/// Result of the removal of a blur from one channel of a part.
#[derive(Debug, Clone, PartialEq)]
pub struct DeblurResult {
    /// Values without blur, in the grid's order.
    pub values: Vec<f64>,
    /// Statistics of each incidence.
    pub incidences: Vec<DeblurStatistics>,
    /// Relative noise of the result over that of the values, from trials: root mean square over cells
    /// above 1 % of the peak, and at the peak.
    pub noise_amplification: [f64; 2],
}

/// Statistics of the removal of a blur at one incidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DeblurStatistics {
    /// Inclination of the light, degrees.
    pub theta_deg: f64,
    /// Number of iterations.
    pub iterations: usize,
    /// Values in the specular direction before and after, 1/sr.
    pub peak: [f64; 2],
    /// Factor that conserves the integral over the hemisphere.
    pub scale: f64,
    /// Relative difference between the result, blurred again, and the values: root mean square over
    /// cells above 1 % of the peak at three azimuths.
    pub misfit: f64,
}

/// Removes the blur from one channel of a part, given by its index.
///
/// # Errors
/// If the part is not on a specular-centred grid, or the width is out of range.
pub fn deblurred(
    part: &MeasuredPart,
    channel: usize,
    how: &DeblurOptions,
) -> Result<DeblurResult, GoniometryError> {
    let Geometry::Specular(grid) = &part.geometry else {
        return Err(GoniometryError::NotSpecular("deblurred"));
    };
    if !(1e-4..=1.0).contains(&how.width) {
        let what = "the width of the blur";
        return Err(GoniometryError::OutOfRange { what, value: how.width, expected: "0.0001 to 1" });
    }
    if grid.cells() == 0 {
        return Ok(DeblurResult {
            values: Vec::new(),
            incidences: Vec::new(),
            noise_amplification: [1.0; 2],
        });
    }
    let (rings, values) = (Rings::new(how.width), part.channel(channel));
    let (clean, steps) = unblurred(grid, values, &rings, how, None);
    let incidences = statistics(grid, values, &clean, &steps, how.width);
    let noise_amplification = amplification(grid, values, &clean, &rings, how, &steps);
    Ok(DeblurResult { values: clean, incidences, noise_amplification })
}

/// Number of iterations and scale of each incidence.
type Steps = Vec<(usize, f64)>;

/// Values without blur; `fixed` prescribes the iterations of a previous run.
fn unblurred(
    grid: &SpecularGrid,
    values: &[f64],
    rings: &Rings,
    how: &DeblurOptions,
    fixed: Option<&Steps>,
) -> (Vec<f64>, Steps) {
    let before = Shape::of_grid(grid, values, Fill::Tail);
    let sharpened = |k: usize| {
        let from = Beta { x: grid.incidences_deg[k].to_radians().sin(), y: 0.0 };
        let d = rings.profile(&before, k, from);
        let (ratio, iterations) = rings.sharpened(&d, how, fixed.map(|done| done[k].0));
        let p: Vec<f64> = d.iter().zip(&ratio).map(|(d, ratio)| d * ratio).collect();
        let [before, after] = [&d, &p].map(|profile| rings.total(profile, from.x));
        let scale = if after > 0.0 { before / after } else { 1.0 };
        (ratio.into_iter().map(|ratio| ratio * scale).collect(), (iterations, scale))
    };
    let (ratios, steps): (Vec<Vec<f64>>, Steps) = (0..grid.incidences_deg.len()).map(sharpened).unzip();
    let mut clean = values.to_vec();
    each_cell(grid, |cell, k, delta| clean[cell] *= rings.interpolated(&ratios[k], delta.length()));
    (clean, steps)
}

/// Calls `f` for each cell in the hemisphere, with the indices of the cell and its incidence, and beta_out -
/// beta_in.
fn each_cell(grid: &SpecularGrid, mut f: impl FnMut(usize, usize, Beta)) {
    let mut cell = 0;
    for _ in &grid.rotations_deg {
        for (k, incidence) in grid.incidences_deg.iter().enumerate() {
            let from = Beta { x: incidence.to_radians().sin(), y: 0.0 };
            for azimuth in &grid.azimuths_deg {
                for radial in &grid.radials_deg {
                    if let Some(to) = SpecularGrid::direction(*incidence, *azimuth, *radial) {
                        f(cell, k, to.leaving() - from);
                    }
                    cell += 1;
                }
            }
        }
    }
}

fn statistics(
    grid: &SpecularGrid,
    values: &[f64],
    clean: &[f64],
    steps: &Steps,
    blur: f64,
) -> Vec<DeblurStatistics> {
    let [before, after] = [values, clean].map(|values| Shape::of_grid(grid, values, Fill::Tail));
    let rule = Rule::new();
    let one = |(k, (iterations, scale)): (usize, &(usize, f64))| {
        let theta_deg = grid.incidences_deg[k];
        let from = Beta { x: theta_deg.to_radians().sin(), y: 0.0 };
        let lobe = |from: Beta, to: Beta| after.value(k, to - from);
        let reblurred = BlurredLobe::new(&rule, &lobe, from, blur);
        let peak = [&before, &after].map(|shape| shape.value(k, Beta::default()));
        let (mut squares, mut count) = (0.0, 0.0);
        for azimuth in [0.0, 90.0, 180.0] {
            for radial in &grid.radials_deg {
                let Some(to) = SpecularGrid::direction(theta_deg, azimuth, *radial) else { continue };
                let value = before.value(k, to.leaving() - from);
                if value > FAINT * peak[0] {
                    squares += (reblurred.value(to.leaving()) / (scale * value) - 1.0).powi(2);
                    count += 1.0;
                }
            }
        }
        let misfit = if count > 0.0 { f64::sqrt(squares / count) } else { 0.0 };
        DeblurStatistics { theta_deg, iterations: *iterations, peak, scale: *scale, misfit }
    };
    steps.iter().enumerate().map(one).collect()
}

/// Computes [`DeblurResult::noise_amplification`].
fn amplification(
    grid: &SpecularGrid,
    values: &[f64],
    clean: &[f64],
    rings: &Rings,
    how: &DeblurOptions,
    steps: &Steps,
) -> [f64; 2] {
    let largest = values.iter().copied().fold(0.0, f64::max);
    let (mut all, mut peaks) = ([0.0; 2], [0.0; 2]);
    let radials = grid.radials_deg.len();
    for draw in 0..DRAWS {
        let numbers = SampleStream::new(Sampler::Random, 0, draw);
        let noisy = |(cell, value): (usize, &f64)| {
            let row = radials * grid.azimuths_deg.len();
            let pixel = if grid.radials_deg[cell % radials] == 0.0 { cell - cell % row } else { cell };
            let [u, v, ..] = numbers.block(pixel as u64, 0);
            value * (1.0 + TRIAL_NOISE * (-2.0 * u.ln()).sqrt() * (2.0 * PI * v).cos())
        };
        let noisy: Vec<f64> = values.iter().enumerate().map(noisy).collect();
        let (trial, _) = unblurred(grid, &noisy, rings, how, Some(steps));
        for (cell, value) in values.iter().enumerate().filter(|(_, value)| **value > FAINT * largest) {
            let squares = [(noisy[cell] / value - 1.0).powi(2), (trial[cell] / clean[cell] - 1.0).powi(2)];
            for k in 0..2 {
                all[k] += squares[k];
                peaks[k] += if grid.radials_deg[cell % radials] == 0.0 { squares[k] } else { 0.0 };
            }
        }
    }
    [all, peaks].map(|[before, after]| if before > 0.0 { f64::sqrt(after / before) } else { 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Instrument, Noise, ScatterMode, SyntheticSample, View};

    /// Ratio of a result to the truth perpendicular to the plane of incidence, for incidence `k` and radial
    /// index `r`.
    fn ratio_to_truth(
        truth: &dyn Fn(Beta, Beta) -> f64,
        grid: &SpecularGrid,
        values: &[f64],
        k: usize,
        r: usize,
    ) -> f64 {
        let theta = grid.incidences_deg[k];
        let to = SpecularGrid::direction(theta, grid.azimuths_deg[9], grid.radials_deg[r]).unwrap();
        let cell = (k * grid.azimuths_deg.len() + 9) * grid.radials_deg.len() + r;
        values[cell] / truth(Beta { x: theta.to_radians().sin(), y: 0.0 }, to.leaving())
    }

    fn instrument(noise: f64) -> Instrument {
        let mut instrument = SyntheticSample::instrument();
        instrument.channels = vec![Channel::Monochrome];
        instrument.grid.incidences_deg = vec![0.0, 30.0, 60.0, 75.0];
        instrument.noise = Noise { relative: noise, floor: 0.0, seed: 1 };
        instrument
    }

    /// Peaks of 20.7, 14.5 and 13.0 per sr are recovered to 99.8, 47.3 and 38.6, also without values beyond
    /// 85 deg, as in real files.
    #[test]
    fn deblurring_recovers_synthetic_samples() {
        for (haze, dark_beyond_deg) in [(0.65, 90.0), (0.78, 90.0), (0.78, 85.0), (0.81, 90.0)] {
            let instrument = Instrument { dark_beyond_deg, ..instrument(0.0) };
            let sample = SyntheticSample::new(haze).unwrap();
            let part = sample.measured(&instrument, &[1.0]).unwrap().parts.remove(0);
            let result = deblurred(&part, 0, &DeblurOptions::of_width(0.0483)).unwrap();
            let truth = |from: Beta, to: Beta| sample.btdf(from, to);
            for k in 0..4 {
                for r in [0, 1, 2, 3, 5, 8, 12, 20, 30] {
                    let ratio = ratio_to_truth(&truth, &instrument.grid, &result.values, k, r);
                    let dark = dark_beyond_deg < 90.0 && ratio == 0.0;
                    assert!(dark || (ratio - 1.0).abs() < 5e-3, "{haze} {k} {r}: {ratio}");
                }
                let done = &result.incidences[k];
                assert!(done.misfit < 0.02 && done.iterations < 500, "{haze}: {done:?}");
            }
            let [all, peak] = result.noise_amplification;
            assert!(all > 1.0 && all < 2.0 && peak > all && peak < 5.0, "{haze}: {all} {peak}");
            let after = Shape::of_grid(&instrument.grid, &result.values, Fill::Tail);
            assert!((after.total(0) / 0.9 - 1.0).abs() < 2e-3, "{haze}: {}", after.total(0));
        }
    }

    /// The start does not contain a Gaussian: its core is recovered to some per cent, and the
    /// misfit shows that its tails are not. Noise does not change this.
    #[test]
    fn deblurring_recovers_gaussian_core_to_12_percent() {
        let gaussian = |from: Beta, to: Beta| (-(to - from).squared() / 0.005).exp() * 0.9 / (0.005 * PI);
        let view = View { way: ScatterMode::FrontTransmission, f: &gaussian, straight: 0.0, factors: &[1.0] };
        for noise in [0.0, 0.003] {
            let instrument = instrument(noise);
            let part = instrument.measure("", &[view]).unwrap().parts.remove(0);
            let how = DeblurOptions { noise: noise / 4.0, ..DeblurOptions::of_width(0.0483) };
            let result = deblurred(&part, 0, &how).unwrap();
            let before = ratio_to_truth(&gaussian, &instrument.grid, &part.values, 0, 0);
            assert!(before < 0.4, "{before}");
            for k in 0..3 {
                for r in [0, 1, 2, 3] {
                    let ratio = ratio_to_truth(&gaussian, &instrument.grid, &result.values, k, r);
                    assert!((ratio - 1.0).abs() < 0.12, "{noise} {k} {r}: {ratio}");
                }
            }
            assert!(result.noise_amplification[0] > 1.0);
        }
    }

    #[test]
    fn flat_lobe_is_unchanged_and_bad_width_or_geometry_is_refused() {
        let instrument = instrument(0.0);
        let flat = |_: Beta, _: Beta| 0.3;
        let view = View { way: ScatterMode::FrontReflection, f: &flat, straight: 0.0, factors: &[1.0] };
        let mut part = Instrument { blur: 0.0, ..instrument }.measure("", &[view]).unwrap().parts.remove(0);
        let error = deblurred(&part, 0, &DeblurOptions::of_width(-1.0)).unwrap_err();
        assert!(matches!(error, GoniometryError::OutOfRange { .. }));
        // A flat lobe has no half width to sharpen.
        let same = deblurred(&part, 0, &DeblurOptions::of_width(0.05)).unwrap();
        for (after, before) in same.values.iter().zip(&part.values) {
            assert!((after - before).abs() < 1e-12, "{after} {before}");
        }
        part.values.iter_mut().for_each(|value| *value = 0.0);
        assert!(
            deblurred(&part, 0, &DeblurOptions::of_width(0.05)).unwrap().values.iter().all(|f| *f == 0.0)
        );
        part.values.iter_mut().for_each(|value| *value = f64::NAN);
        assert!(
            deblurred(&part, 0, &DeblurOptions::of_width(0.05)).unwrap().values.iter().all(|f| f.is_nan())
        );
        part.geometry = Geometry::Pairs(Vec::new());
        let error = deblurred(&part, 0, &DeblurOptions::of_width(0.05)).unwrap_err();
        assert_eq!(error, GoniometryError::NotSpecular("deblurred"));
    }
}
