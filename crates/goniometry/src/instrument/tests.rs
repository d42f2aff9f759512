//! Tests of the virtual instrument.

use super::*;
use crate::{Audit, Fill, Shape};
use papilio_optics::Scatterer;
use papilio_optics::lobe::Lobe;

/// Coarser instrument, for speed.
fn small() -> Instrument {
    let mut instrument = Instrument::imaging_sphere();
    instrument.grid.incidences_deg = vec![0.0, 45.0, 75.0];
    instrument.channels = vec![Channel::Monochrome];
    instrument
}

fn measured(instrument: &Instrument, width: f64) -> MeasuredPart {
    let f = move |from: Beta, to: Beta| 0.9 * Lobe::KCorrelation { width }.density(from, to);
    let view = View { way: ScatterMode::FrontTransmission, f: &f, straight: 0.0, factors: &[1.0] };
    instrument.measure("test", &[view]).unwrap().parts.remove(0)
}

fn peak(part: &MeasuredPart, incidence: usize) -> f64 {
    part.values[incidence * 19 * 91]
}

/// Peaks of the three samples as in published figures: renormalised, and with T conserved.
#[test]
fn synthetic_samples_have_published_peaks() {
    let published = [(0.65, 99.6, 20.7, 19.7), (0.78, 47.3, 14.5, 13.8), (0.81, 38.6, 13.0, 12.3)];
    for (haze, sharp, renormalised, conserved) in published {
        let sample = SyntheticSample::new(haze).unwrap();
        let mut instrument = SyntheticSample::instrument();
        instrument.grid.incidences_deg = vec![0.0];
        instrument.grid.radials_deg.truncate(1);
        instrument.channels = vec![Channel::Monochrome];
        let seen = |instrument: &Instrument| {
            let measurement = sample.measured(instrument, &[1.0]).unwrap();
            assert!((measurement.parts[0].tis[0] - 0.9).abs() < 1e-4, "{:?}", measurement.parts[0].tis);
            measurement.parts[0].values[0]
        };
        // The published widths and peaks have three digits.
        let close =
            |ours: f64, published: f64| assert!((ours / published - 1.0).abs() < 5e-3, "{ours} {published}");
        close(seen(&instrument), renormalised);
        instrument.renormalise = false;
        close(seen(&instrument), conserved);
        instrument.blur = 0.0;
        close(seen(&instrument), sharp);
    }
}

#[test]
fn blurred_lobes_on_the_grid_equal_closed_form() {
    let mut instrument = small();
    instrument.blur = 0.0483;
    instrument.renormalise = false;
    let part = measured(&instrument, 0.05667);
    let sum = Lobe::KCorrelation { width: 0.05667 + 0.0483 };
    let mut count = 0;
    for (cell, value) in part.values.iter().enumerate() {
        let Some([light, viewer]) = part.geometry.directions(cell) else {
            assert_eq!(*value, 0.0);
            continue;
        };
        let exact = 0.9 * sum.density(light.arriving(), viewer.leaving());
        assert!((value / exact - 1.0).abs() < 1e-4, "{cell}: {value} {exact}");
        count += 1;
    }
    assert!(count > 2500, "{count}");
}

#[test]
fn renormalised_values_integrate_to_the_total() {
    let mut instrument = small();
    instrument.blur = 0.0483;
    let part = measured(&instrument, 0.05667);
    let shape = Shape::of_grid(&instrument.grid, &part.values, Fill::None);
    for k in 0..3 {
        let error = shape.total(k) / part.tis[k] - 1.0;
        assert!(error.abs() < shape.grid_error(k) + 2e-4, "{k}: {error}");
    }
    assert!(part.tis[0] > part.tis[2]);
}

/// The image of unscattered light is the kernel, added to the blurred lobe in closed form.
#[test]
fn unscattered_light_has_the_width_of_the_blur() {
    let mut instrument = small();
    instrument.grid.incidences_deg.truncate(2);
    instrument.blur = 0.05;
    instrument.renormalise = false;
    let [kernel, lobe, sum] = [0.05, 0.1, 0.15].map(|width| Lobe::KCorrelation { width });
    let f = move |from: Beta, to: Beta| 0.5 * lobe.density(from, to);
    let view = View { way: ScatterMode::FrontTransmission, f: &f, straight: 0.3, factors: &[1.0] };
    let part = instrument.measure("", &[view]).unwrap().parts.remove(0);
    for (cell, value) in part.values.iter().enumerate() {
        let Some([light, viewer]) = part.geometry.directions(cell) else { continue };
        let (from, to) = (light.arriving(), viewer.leaving());
        let exact = 0.5 * sum.density(from, to) + 0.3 * kernel.density(from, to);
        assert!((value / exact - 1.0).abs() < 1e-4, "{cell}: {value} {exact}");
    }
    assert!((part.tis[0] - 0.3 - 0.5 * lobe.hemispherical_fraction()).abs() < 1e-4, "{:?}", part.tis);
}

/// Negative results become 0: the mean of values far below a floor s is s/sqrt(2 pi), with a variance of s²/2 less its square.
#[test]
fn noise_raises_the_mean_of_dark_values() {
    let mut instrument = small();
    instrument.noise = Noise { relative: 0.0, floor: 0.05, seed: 7 };
    let view = View { way: ScatterMode::FrontReflection, f: &|_, _| 1e-9, straight: 0.0, factors: &[1.0] };
    let part = instrument.measure("", &[view]).unwrap().parts.remove(0);
    let is_pixel = |cell: &usize| !cell.is_multiple_of(91) && part.geometry.directions(*cell).is_some();
    let values: Vec<f64> = (0..part.values.len()).filter(is_pixel).map(|cell| part.values[cell]).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64 / 0.05;
    let expected = 1.0 / (2.0 * PI).sqrt();
    let deviation = ((0.5 - expected * expected) / values.len() as f64).sqrt();
    assert!((mean - expected).abs() < 4.0 * deviation, "{mean} {expected} {deviation}");
}

#[test]
fn noise_has_given_size_and_is_reproducible() {
    let mut instrument = small();
    let clean = measured(&instrument, 0.1);
    instrument.noise = Noise { relative: 0.01, floor: 1e-4, seed: 7 };
    instrument.dark_beyond_deg = 85.0;
    let noisy = measured(&instrument, 0.1);
    assert_eq!(noisy, measured(&instrument, 0.1));
    // At radial distance 0 there is one pixel for all azimuths.
    assert!((1..19).all(|k| noisy.values[k * 91] == noisy.values[0]) && noisy.values[0] != clean.values[0]);
    let (mut count, mut sum) = (0.0, 0.0);
    for (cell, (noisy, clean)) in noisy.values.iter().zip(&clean.values).enumerate() {
        let viewer = clean_direction(&instrument, cell);
        if viewer.is_none_or(|theta| theta > 85.0) {
            assert_eq!(*noisy, 0.0);
        } else if cell % 91 > 0 {
            sum += (noisy - clean).powi(2) / ((0.01 * clean).powi(2) + 1e-8);
            count += 1.0;
        }
    }
    // Mean of `count` squares of normal numbers: within 4 standard deviations, each sqrt(2/count).
    let mean: f64 = sum / count;
    assert!((mean - 1.0).abs() < 4.0 * (2.0_f64 / count).sqrt(), "{mean} {count}");
    assert!(peak(&noisy, 0) > 0.0);
}

fn clean_direction(instrument: &Instrument, cell: usize) -> Option<f64> {
    let geometry = Geometry::Specular(instrument.grid.clone());
    geometry.directions(cell).map(|[_, viewer]| viewer.theta_deg)
}

#[test]
fn channels_have_their_factors_and_provenance_says_synthetic() {
    let sample = SyntheticSample::new(0.78).unwrap();
    let nm: Vec<f64> = (0..81).map(|k| 380.0 + 5.0 * f64::from(k)).collect();
    let flat = vec![1.0; nm.len()];
    // Bands about 600, 550 and 440 nm: only the blue one overlaps the edge.
    let bands = [600.0, 550.0, 440.0]
        .map(|centre| nm.iter().map(|nm| (-((nm - centre) / 30.0_f64).powi(2)).exp()).collect::<Vec<f64>>());
    let factors = sample.factors(&nm, &flat, [&bands[0], &bands[1], &bands[2]]);
    assert!(factors[0] > 0.9999 && factors[1] > 0.9999, "{factors:?}");
    assert!(factors[2] < 0.995 && factors[2] > 0.95, "{factors:?}");
    assert!((sample.transmission(392.0) - 0.45).abs() < 1e-12);
    let mut instrument = SyntheticSample::instrument();
    instrument.blur = 0.0;
    let measurement = sample.measured(&instrument, &factors).unwrap();
    assert!(measurement.provenance.source.contains("synthetic"));
    assert_eq!(measurement.provenance.sample, "H78 (synthetic)");
    let part = &measurement.parts[0];
    assert!((part.channel(2)[0] / part.channel(0)[0] - factors[2] / factors[0]).abs() < 1e-12);
    assert!((part.tis(2, 0, 0).unwrap() - 0.9 * factors[2]).abs() < 1e-4);
    // The audit finds the haze of the sample.
    let haze = Audit::of(part, 1).unwrap().haze.unwrap();
    assert!((haze - 0.78).abs() < 2e-3, "{haze}");
}

#[test]
fn blur_noise_factors_or_haze_out_of_range_are_refused() {
    let instrument = Instrument { blur: -0.1, ..small() };
    let f = |_: Beta, _: Beta| 1.0;
    let view = View { way: ScatterMode::FrontReflection, f: &f, straight: 0.0, factors: &[1.0] };
    assert!(matches!(instrument.measure("", &[view]), Err(GoniometryError::OutOfRange { .. })));
    let view = View { straight: 0.1, ..view };
    assert!(matches!(
        small().measure("", &[view]),
        Err(GoniometryError::OutOfRange { what: "the blur", .. })
    ));
    let view = View { factors: &[], ..view };
    assert!(matches!(small().measure("", &[view]), Err(GoniometryError::OutOfRange { .. })));
    assert!(SyntheticSample::new(1.5).is_err());
}
