//! Calibration with a white reference.
//!
//! A white of known reflectance, measured on the same grid, shows the effect of instrument and optics on each
//! direction. The correction is its known f, `reflectance_factor/pi` (Spectralon: 0.99, taken as Lambertian),
//! over the measured f. The sample is multiplied by it, cell by cell. This removes vignetting, non-uniform
//! coatings and the error of scale. Blur, stray light and noise remain, and the noise of the reference is
//! added ([`Calibration::noise`]).
//!
//! **Correspondence**: a part of the sample is corrected with the reference's part of the same scatter mode,
//! or with its only part, because the cells of reflection and transmission lie in the same directions of the
//! sphere. A channel is corrected with the same channel, or with the only one.
//!
//! **Nothing is extrapolated.** Where the sample has a value and the reference has none, the result is
//! NaN, and the cell is counted.
//!
//! Total integrated scatter that the file gives is multiplied by the relative change of the
//! light of its incidence.
//!
//! **Limits**: the white is assumed to be Lambertian. Real ones are so within some per cent, up to about 60
//! deg.

use std::f64::consts::PI;

use crate::{
    Channel, Fill, Geometry, GoniometryError, MeasuredPart, Measurement, ScatterMode, Shape, SpecularGrid,
};

/// Relative difference of a correction factor from its neighbours' mean above which it is counted as
/// rough.
const ROUGH: f64 = 0.05;

/// Calibrated sample, with the corrections.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibratedSample {
    /// The corrected sample.
    pub measurement: Measurement,
    /// Corrections of each part and channel, in their order.
    pub calibrations: Vec<Calibration>,
}

/// Statistics of the correction of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// Scatter mode of the sample's part.
    pub way: ScatterMode,
    /// Scatter mode of the reference's part.
    pub reference: ScatterMode,
    /// Channel of the sample.
    pub channel: Channel,
    /// Smallest and largest factor.
    pub range: [f64; 2],
    /// Number of corrected cells.
    pub corrected: usize,
    /// Number of cells with a value but without one in the reference; they are now NaN.
    pub uncovered: usize,
    /// Relative standard deviation of neighbouring factors (specular-centred grids): the noise that
    /// the reference adds.
    pub noise: Option<f64>,
    /// Number of factors that differ from the mean of their neighbours by more than 5 %.
    pub rough: usize,
}

impl Calibration {
    /// Returns whether a transmission is the reference of another scatter mode, although a white is known by its reflectance.
    pub fn has_transmission_as_white(&self) -> bool {
        self.reference.is_transmission() && self.reference != self.way
    }
}

/// Corrects a sample with a white of this reflectance factor that was measured on the same grid.
///
/// # Errors
/// If the grids differ, a scatter mode or a channel has no reference, or the reflectance factor is not
/// above 0.
pub fn calibrated(
    sample: &Measurement,
    reference: &Measurement,
    reflectance_factor: f64,
) -> Result<CalibratedSample, GoniometryError> {
    if !(reflectance_factor > 0.0 && reflectance_factor.is_finite()) {
        let what = "the reflectance factor of the reference";
        return Err(GoniometryError::OutOfRange { what, value: reflectance_factor, expected: "above 0" });
    }
    let known = reflectance_factor / PI;
    let mut calibrated = CalibratedSample { measurement: sample.clone(), calibrations: Vec::new() };
    for part in &mut calibrated.measurement.parts {
        let white = reference_part(reference, part.way)?;
        same_cells(&part.geometry, &white.geometry)?;
        for channel in 0..part.channels.len() {
            let correction = correction(white, part.channels[channel], known)?;
            calibrated.calibrations.push(apply(part, channel, (white.way, &correction)));
        }
    }
    let remark = format!("calibrated against a white of reflectance factor {reflectance_factor}");
    calibrated.measurement.provenance.remarks.push(remark);
    Ok(calibrated)
}

fn reference_part(reference: &Measurement, way: ScatterMode) -> Result<&MeasuredPart, GoniometryError> {
    let same = reference.parts.iter().find(|part| part.way == way);
    let only = (reference.parts.len() == 1).then(|| reference.parts.first()).flatten();
    same.or(only).ok_or(GoniometryError::NoReference(way))
}

fn same_cells(sample: &Geometry, reference: &Geometry) -> Result<(), GoniometryError> {
    if sample == reference {
        return Ok(());
    }
    let (Geometry::Specular(a), Geometry::Specular(b)) = (sample, reference) else {
        return Err(GoniometryError::GridsDiffer("directions"));
    };
    let axes = [
        ("rotations", &a.rotations_deg, &b.rotations_deg),
        ("incidences", &a.incidences_deg, &b.incidences_deg),
        ("azimuths", &a.azimuths_deg, &b.azimuths_deg),
        ("radial distances", &a.radials_deg, &b.radials_deg),
    ];
    let differing = axes.into_iter().find(|(_, a, b)| a != b).map(|(name, ..)| name);
    Err(GoniometryError::GridsDiffer(differing.unwrap_or("symmetries")))
}

/// Returns the known f over the measured f; `None` where the reference has no light.
fn correction(
    white: &MeasuredPart,
    channel: Channel,
    known: f64,
) -> Result<Vec<Option<f64>>, GoniometryError> {
    let same = white.channels.iter().position(|other| *other == channel);
    let only = (white.channels.len() == 1).then_some(0);
    let number = same.or(only).ok_or(GoniometryError::NoChannel(channel))?;
    let factor = |measured: &f64| (*measured > 0.0 && measured.is_finite()).then(|| known / measured);
    Ok(white.channel(number).iter().map(factor).collect())
}

fn apply(
    part: &mut MeasuredPart,
    channel: usize,
    (reference, correction): (ScatterMode, &[Option<f64>]),
) -> Calibration {
    let cells = correction.len();
    let before = part.channel(channel).to_vec();
    let mut calibration = Calibration {
        way: part.way,
        reference,
        channel: part.channels[channel],
        range: [f64::INFINITY, 0.0],
        corrected: 0,
        uncovered: 0,
        noise: None,
        rough: 0,
    };
    for (value, factor) in part.values[channel * cells..].iter_mut().zip(correction) {
        // NaN and 0 mark cells that were not measured.
        if !value.is_finite() || *value == 0.0 {
            continue;
        }
        match factor {
            Some(factor) => {
                *value *= factor;
                calibration.corrected += 1;
                calibration.range = [calibration.range[0].min(*factor), calibration.range[1].max(*factor)];
            }
            None => {
                *value = f64::NAN;
                calibration.uncovered += 1;
            }
        }
    }
    if let Geometry::Specular(grid) = &part.geometry {
        (calibration.noise, calibration.rough) = roughness(grid, correction);
        let after = &part.values[channel * cells..][..cells];
        let changes = changes(grid, &before, after);
        let blocks = grid.rotations_deg.len() * grid.incidences_deg.len();
        let tis = part.tis.iter_mut().skip(channel * blocks).take(blocks);
        tis.zip(changes.iter().cycle()).for_each(|(tis, change)| *tis *= change);
    }
    calibration
}

/// Ratio of the light after and before the correction, by incidence: from integrals of the smooth lobes
/// through the cells that have both values.
fn changes(grid: &SpecularGrid, before: &[f64], after: &[f64]) -> Vec<f64> {
    let common = |values: &[f64], other: &[f64]| -> Shape {
        let masked =
            values.iter().zip(other).map(|(value, other)| if other.is_finite() { *value } else { f64::NAN });
        Shape::of_grid(grid, &masked.collect::<Vec<_>>(), Fill::None)
    };
    let [before, after] = [common(before, after), common(after, before)];
    let change = |incidence: usize| {
        let [before, after] = [&before, &after].map(|shape| shape.total(incidence));
        if before > 0.0 { after / before } else { 1.0 }
    };
    (0..grid.incidences_deg.len()).map(change).collect()
}

/// Standard deviation of the factors from second differences of their logarithms along radial lines, and the
/// number of rough factors.
fn roughness(grid: &SpecularGrid, correction: &[Option<f64>]) -> (Option<f64>, usize) {
    let lines = correction.chunks_exact(grid.radials_deg.len().max(1));
    let mut differences: Vec<f64> = lines
        .flat_map(|line| line.windows(3))
        .filter_map(|three| Some((three[0]?.ln() - 2.0 * three[1]?.ln() + three[2]?.ln()).abs()))
        .collect();
    let rough = differences.iter().filter(|difference| 0.5 * **difference > ROUGH).count();
    differences.sort_by(f64::total_cmp);
    // The median of |d| of a normal distribution is 0.6745 sigma, and the variances add as 1 + 4 + 1.
    let median = differences.get(differences.len() / 2);
    (median.map(|median| median / 0.6745 / 6.0_f64.sqrt()), rough)
}

#[cfg(test)]
mod tests {
    use papilio_optics::Scatterer;

    use super::*;
    use crate::{Instrument, Noise, View};
    use papilio_optics::{Beta, lobe::Lobe};

    fn instrument(seed: u64) -> Instrument {
        let mut instrument = Instrument::imaging_sphere();
        instrument.grid.incidences_deg = vec![0.0, 30.0, 60.0];
        instrument.noise.seed = seed;
        instrument
    }

    /// Vignetting of the camera, with an error of scale.
    fn vignetting(to: Beta) -> f64 {
        0.8 * (1.0 - 0.6 * to.squared() + 0.1 * to.x)
    }

    fn measured(instrument: &Instrument, way: ScatterMode, f: &dyn Fn(Beta, Beta) -> f64) -> Measurement {
        let count = instrument.channels.len();
        instrument.measure("", &[View { way, f, straight: 0.0, factors: &vec![1.0; count] }]).unwrap()
    }

    fn sample(_: Beta, delta: Beta) -> f64 {
        0.9 * Lobe::KCorrelation { width: 0.1 }.density(Beta::default(), delta)
    }

    #[test]
    fn vignetting_is_removed_by_calibration() {
        let instrument = instrument(0);
        let lobe = |from: Beta, to: Beta| sample(from, to - from);
        let white = |_: Beta, to: Beta| 0.99 / PI * vignetting(to);
        let truth = measured(&instrument, ScatterMode::FrontTransmission, &lobe);
        let seen = measured(&instrument, ScatterMode::FrontTransmission, &|from, to| {
            lobe(from, to) * vignetting(to)
        });
        // The white is measured in reflection, the sample in transmission.
        let reference = measured(&instrument, ScatterMode::FrontReflection, &white);
        let result = calibrated(&seen, &reference, 0.99).unwrap();
        for (ours, truth) in result.measurement.parts[0].values.iter().zip(&truth.parts[0].values) {
            assert!((ours - truth).abs() <= 1e-12 * truth, "{ours} {truth}");
        }
        for (ours, truth) in result.measurement.parts[0].tis.iter().zip(&truth.parts[0].tis) {
            assert!((ours / truth - 1.0).abs() < 2e-3, "{ours} {truth}");
        }
        assert_eq!(result.calibrations.len(), 3);
        assert!(result.calibrations.iter().all(|one| !one.has_transmission_as_white()));
        let turned = calibrated(&reference, &seen, 0.99).unwrap();
        assert!(turned.calibrations.iter().all(Calibration::has_transmission_as_white));
        let calibration = result.calibrations[0];
        assert_eq!((calibration.uncovered, calibration.rough), (0, 0));
        assert!(calibration.range[0] > 1.1 && calibration.range[1] > 2.0, "{calibration:?}");
        assert!(calibration.noise.unwrap() < 1e-3, "{calibration:?}");
    }

    #[test]
    fn noise_and_holes_of_reference_are_reported() {
        let mut instrument = instrument(3);
        let lobe = |from: Beta, to: Beta| sample(from, to - from);
        let seen = measured(&instrument, ScatterMode::FrontReflection, &lobe);
        instrument.noise = Noise { relative: 0.02, ..instrument.noise };
        let mut reference = measured(&instrument, ScatterMode::FrontReflection, &|_, _| 0.99 / PI);
        reference.parts[0].values[3] = f64::NAN;
        reference.parts[0].values[91] = 0.0;
        let result = calibrated(&seen, &reference, 0.99).unwrap();
        let calibration = result.calibrations[0];
        assert_eq!(calibration.uncovered, 2);
        assert!(result.measurement.parts[0].values[3].is_nan());
        assert!((calibration.noise.unwrap() / 0.02 - 1.0).abs() < 0.1, "{calibration:?}");
        // Second differences have a standard deviation of 4.9 %, and twice the limit is 2.04 times that: 4.1
        // % of the cells are rough.
        let fraction = calibration.rough as f64 / calibration.corrected as f64;
        assert!((fraction - 0.041).abs() < 0.01, "{fraction}");
    }

    #[test]
    fn reference_with_other_grid_mode_or_channel_is_refused() {
        let instrument = instrument(0);
        let reference = measured(&instrument, ScatterMode::FrontReflection, &|_, _| 0.3);
        let refusal = |sample: &Measurement, reference: &Measurement, factor: f64| {
            calibrated(sample, reference, factor).unwrap_err()
        };
        let mut other = instrument.clone();
        other.grid.radials_deg.truncate(40);
        let sample = measured(&other, ScatterMode::FrontReflection, &|_, _| 0.3);
        assert_eq!(refusal(&sample, &reference, 0.99), GoniometryError::GridsDiffer("radial distances"));
        let mut two = reference.clone();
        two.parts.push(MeasuredPart { way: ScatterMode::BackReflection, ..two.parts[0].clone() });
        let sample = measured(&instrument, ScatterMode::FrontTransmission, &|_, _| 0.3);
        assert_eq!(
            refusal(&sample, &two, 0.99),
            GoniometryError::NoReference(ScatterMode::FrontTransmission)
        );
        let mut other = instrument.clone();
        other.channels = vec![Channel::Red, Channel::Blue];
        let sample = measured(&other, ScatterMode::FrontReflection, &|_, _| 0.3);
        assert_eq!(refusal(&sample, &reference, 0.99), GoniometryError::NoChannel(Channel::Red));
        assert!(matches!(refusal(&reference, &reference, 0.0), GoniometryError::OutOfRange { .. }));
    }
}
