//! Calibration against a known white.
//!
//! A white of known reflectance, measured on the same grid, tells what instrument and optics do to each
//! direction: the correction is its known f, `reflectance_factor/pi` (Spectralon: .99, taken as
//! Lambertian), over the f that was measured, and the sample is multiplied by it cell by cell. Vignetting,
//! uneven coatings and the scale go; blur, stray light and noise stay, and the reference's own noise
//! comes on top ([`Calibration::noise`]).
//!
//! **What corrects what**: a part of the sample is corrected by the reference's part of the same way, or
//! by its only part: the cells of reflection and transmission lie in the same directions of the sphere. A
//! channel is corrected by the same channel, or by the only one.
//!
//! **Nothing is extrapolated.** Where the sample has a value and the reference has none, the result is
//! NaN, and counted.
//!
//! Total integrated scatter, where the file gives it, is multiplied with what the correction does to the
//! light of its incidence.
//!
//! **Limits**: a Lambertian white. Real ones are within some per cent of it, up to 60 deg or so.

use std::f64::consts::PI;

use crate::{Channel, Fill, Geometry, GoniometryError, Measurement, Part, Shape, SpecularGrid, Way};

/// Where the correction of a cell differs from its neighbours' mean by more than this share, it is called
/// rough.
const ROUGH: f64 = 0.05;

/// A sample after calibration, and what was done to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// The sample, corrected.
    pub measurement: Measurement,
    /// For each part and channel, in their order.
    pub calibrations: Vec<Calibration>,
}

/// What a correction is like.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// The part of the sample.
    pub way: Way,
    /// Its channel.
    pub channel: Channel,
    /// Smallest and largest factor.
    pub range: [f64; 2],
    /// Cells that were corrected.
    pub corrected: usize,
    /// Cells with a value for which the reference has none: NaN now.
    pub uncovered: usize,
    /// Standard deviation of neighbouring factors, relative (on specular-centred grids): what the
    /// reference's noise adds.
    pub noise: Option<f64>,
    /// Factors that differ from the mean of their neighbours by more than 5 %.
    pub rough: usize,
}

/// A sample, corrected by a white of this reflectance factor that was measured on the same grid.
///
/// # Errors
/// If the grids differ, a way of light or a channel has no reference, or the reflectance factor is not
/// above 0.
pub fn calibrated(
    sample: &Measurement,
    reference: &Measurement,
    reflectance_factor: f64,
) -> Result<Calibrated, GoniometryError> {
    if !(reflectance_factor > 0.0 && reflectance_factor.is_finite()) {
        let what = "the reflectance factor of the reference";
        return Err(GoniometryError::OutOfRange { what, value: reflectance_factor, expected: "above 0" });
    }
    let known = reflectance_factor / PI;
    let mut calibrated = Calibrated { measurement: sample.clone(), calibrations: Vec::new() };
    for part in &mut calibrated.measurement.parts {
        let white = reference_part(reference, part.way)?;
        same_cells(&part.geometry, &white.geometry)?;
        for channel in 0..part.channels.len() {
            let correction = correction(white, part.channels[channel], known)?;
            calibrated.calibrations.push(apply(part, channel, &correction));
        }
    }
    let remark = format!("calibrated against a white of reflectance factor {reflectance_factor}");
    calibrated.measurement.provenance.remarks.push(remark);
    Ok(calibrated)
}

fn reference_part(reference: &Measurement, way: Way) -> Result<&Part, GoniometryError> {
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

/// Known over measured; `None` where the reference has no light.
fn correction(white: &Part, channel: Channel, known: f64) -> Result<Vec<Option<f64>>, GoniometryError> {
    let same = white.channels.iter().position(|other| *other == channel);
    let only = (white.channels.len() == 1).then_some(0);
    let number = same.or(only).ok_or(GoniometryError::NoChannel(channel))?;
    let factor = |measured: &f64| (*measured > 0.0 && measured.is_finite()).then(|| known / measured);
    Ok(white.channel(number).iter().map(factor).collect())
}

fn apply(part: &mut Part, channel: usize, correction: &[Option<f64>]) -> Calibration {
    let cells = correction.len();
    let before = part.channel(channel).to_vec();
    let mut calibration = Calibration {
        way: part.way,
        channel: part.channels[channel],
        range: [f64::INFINITY, 0.0],
        corrected: 0,
        uncovered: 0,
        noise: None,
        rough: 0,
    };
    for (value, factor) in part.values[channel * cells..].iter_mut().zip(correction) {
        // NaN and 0 stand for what was not measured.
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

/// How much light there is after the correction, over that before, by incidence: the integrals of the smooth lobes through
/// the cells that have both.
fn changes(grid: &SpecularGrid, before: &[f64], after: &[f64]) -> Vec<f64> {
    let both = |values: &[f64], other: &[f64]| -> Shape {
        let kept =
            values.iter().zip(other).map(|(value, other)| if other.is_finite() { *value } else { f64::NAN });
        Shape::of_grid(grid, &kept.collect::<Vec<_>>(), Fill::None)
    };
    let [before, after] = [both(before, after), both(after, before)];
    let change = |incidence: usize| {
        let [before, after] = [&before, &after].map(|shape| shape.total(incidence));
        if before > 0.0 { after / before } else { 1.0 }
    };
    (0..grid.incidences_deg.len()).map(change).collect()
}

/// Standard deviation of the factors from second differences of their logarithms along the lines, and how
/// many are rough.
fn roughness(grid: &SpecularGrid, correction: &[Option<f64>]) -> (Option<f64>, usize) {
    let lines = correction.chunks_exact(grid.radials_deg.len().max(1));
    let mut differences: Vec<f64> = lines
        .flat_map(|line| line.windows(3))
        .filter_map(|three| Some((three[0]?.ln() - 2.0 * three[1]?.ln() + three[2]?.ln()).abs()))
        .collect();
    let rough = differences.iter().filter(|difference| 0.5 * **difference > ROUGH).count();
    differences.sort_by(f64::total_cmp);
    // A normal law's median of |d| is .6745 sigma, and the variances add as 1 + 4 + 1.
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

    /// The camera sees less of what is off its axis; the scale is off, too.
    fn vignetting(to: Beta) -> f64 {
        0.8 * (1.0 - 0.6 * to.squared() + 0.1 * to.x)
    }

    fn measured(instrument: &Instrument, way: Way, f: &dyn Fn(Beta, Beta) -> f64) -> Measurement {
        let count = instrument.channels.len();
        instrument.measure("", &[View { way, f, straight: 0.0, factors: &vec![1.0; count] }]).unwrap()
    }

    fn sample(_: Beta, delta: Beta) -> f64 {
        0.9 * Lobe::KCorrelation { width: 0.1 }.density(Beta::default(), delta)
    }

    #[test]
    fn vignetting_is_removed_whole() {
        let instrument = instrument(0);
        let lobe = |from: Beta, to: Beta| sample(from, to - from);
        let white = |_: Beta, to: Beta| 0.99 / PI * vignetting(to);
        let truth = measured(&instrument, Way::FrontTransmission, &lobe);
        let seen = measured(&instrument, Way::FrontTransmission, &|from, to| lobe(from, to) * vignetting(to));
        // The white is measured in reflection.
        let reference = measured(&instrument, Way::FrontReflection, &white);
        let result = calibrated(&seen, &reference, 0.99).unwrap();
        for (ours, truth) in result.measurement.parts[0].values.iter().zip(&truth.parts[0].values) {
            assert!((ours - truth).abs() <= 1e-12 * truth, "{ours} {truth}");
        }
        for (ours, truth) in result.measurement.parts[0].tis.iter().zip(&truth.parts[0].tis) {
            assert!((ours / truth - 1.0).abs() < 2e-3, "{ours} {truth}");
        }
        assert_eq!(result.calibrations.len(), 3);
        let calibration = result.calibrations[0];
        assert_eq!((calibration.uncovered, calibration.rough), (0, 0));
        assert!(calibration.range[0] > 1.1 && calibration.range[1] > 2.0, "{calibration:?}");
        assert!(calibration.noise.unwrap() < 1e-3, "{calibration:?}");
    }

    #[test]
    fn noise_and_holes_of_the_reference_are_told() {
        let mut instrument = instrument(3);
        let lobe = |from: Beta, to: Beta| sample(from, to - from);
        let seen = measured(&instrument, Way::FrontReflection, &lobe);
        instrument.noise = Noise { relative: 0.02, ..instrument.noise };
        let mut reference = measured(&instrument, Way::FrontReflection, &|_, _| 0.99 / PI);
        reference.parts[0].values[3] = f64::NAN;
        reference.parts[0].values[91] = 0.0;
        let result = calibrated(&seen, &reference, 0.99).unwrap();
        let calibration = result.calibrations[0];
        assert_eq!(calibration.uncovered, 2);
        assert!(result.measurement.parts[0].values[3].is_nan());
        assert!((calibration.noise.unwrap() / 0.02 - 1.0).abs() < 0.1, "{calibration:?}");
        // Second differences have a standard deviation of 4.9 %, twice the limit is 2.04 of them: 4.1 %
        // of the cells.
        let share = calibration.rough as f64 / calibration.corrected as f64;
        assert!((share - 0.041).abs() < 0.01, "{share}");
    }

    #[test]
    fn what_does_not_belong_together_is_refused() {
        let instrument = instrument(0);
        let reference = measured(&instrument, Way::FrontReflection, &|_, _| 0.3);
        let refusal = |sample: &Measurement, reference: &Measurement, factor: f64| {
            calibrated(sample, reference, factor).unwrap_err()
        };
        let mut other = instrument.clone();
        other.grid.radials_deg.truncate(40);
        let sample = measured(&other, Way::FrontReflection, &|_, _| 0.3);
        assert_eq!(refusal(&sample, &reference, 0.99), GoniometryError::GridsDiffer("radial distances"));
        let mut two = reference.clone();
        two.parts.push(Part { way: Way::BackReflection, ..two.parts[0].clone() });
        let sample = measured(&instrument, Way::FrontTransmission, &|_, _| 0.3);
        assert_eq!(refusal(&sample, &two, 0.99), GoniometryError::NoReference(Way::FrontTransmission));
        let mut other = instrument.clone();
        other.channels = vec![Channel::Red, Channel::Blue];
        let sample = measured(&other, Way::FrontReflection, &|_, _| 0.3);
        assert_eq!(refusal(&sample, &reference, 0.99), GoniometryError::NoChannel(Channel::Red));
        assert!(matches!(refusal(&reference, &reference, 0.0), GoniometryError::OutOfRange { .. }));
    }
}
