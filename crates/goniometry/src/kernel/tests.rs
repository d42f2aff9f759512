//! Tests of kernels: against the lobe that was measured, and sums over the disc.

use std::f64::consts::PI;

use super::*;
use crate::{Channel, ScatterMode, SpecularGrid, Symmetry};
use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};

const WIDTH: f64 = 0.1;
const TIS: [f64; 4] = [0.9, 0.88, 0.8, 0.7];

fn lobe(from: Beta, to: Beta) -> f64 {
    0.8 * WIDTH / (2.0 * PI * (WIDTH * WIDTH + (to - from).squared()).powf(1.5))
}

/// Part of a foil on a grid of 1 deg with the values of `f`.
fn part(f: impl Fn(Beta, Beta) -> f64) -> MeasuredPart {
    let steps = |to: u32, step: u32| (0..=to / step).map(|k| f64::from(k * step)).collect::<Vec<_>>();
    let grid = SpecularGrid {
        rotations_deg: vec![0.0],
        incidences_deg: steps(60, 20),
        azimuths_deg: steps(180, 10),
        radials_deg: steps(180, 1),
        symmetry: Symmetry::Plane,
    };
    let mut values = Vec::new();
    for theta in &grid.incidences_deg {
        for azimuth in &grid.azimuths_deg {
            values.extend(grid.radials_deg.iter().map(|radial| {
                let to = SpecularGrid::direction(*theta, *azimuth, *radial);
                to.map_or(0.0, |to| f(ray(*theta), to.leaving()))
            }));
        }
    }
    MeasuredPart {
        way: ScatterMode::FrontTransmission,
        channels: vec![Channel::Monochrome],
        geometry: Geometry::Specular(grid),
        values,
        tis: TIS.to_vec(),
    }
}

fn ray(theta_deg: f64) -> Beta {
    Beta::towards(theta_deg, 0.0, 1.0)
}

/// The light of a lobe leaves through a bare interface of index 1.5, without reflection back through the
/// lobe. Lamination recovers the lobe. Near grazing, where the interface transmits little, the division
/// is limited.
#[test]
fn lamination_removes_back_surface_loss() {
    let behind = part(|from, to| lobe(from, to) * (1.0 - fresnel_reflectance(1.0, 1.5, to.length())));
    let preparation = Preparation { lamination: Some(Lamination { index: 1.5 }), ..Preparation::default() };
    let (laminated, changes) = kernel(&behind, 0, &preparation, &[]).unwrap();
    let (seen, _) = kernel(&behind, 0, &Preparation::default(), &[]).unwrap();
    assert!(changes.laminated && changes.totals.iter().all(|[before, after]| after > before));
    for from in [0.0, 20.0, 40.0, 60.0].map(ray) {
        for (theta, phi) in [(0.0, 0.0), (15.0, 70.0), (35.0, 10.0), (60.0, 0.0), (70.0, 120.0)] {
            let to = Beta::towards(theta, phi, 1.0);
            let ratio = laminated.evaluate(from, to) / lobe(from, to);
            assert!((ratio - 1.0).abs() < 1e-3, "{from:?} {to:?}: {ratio}");
            // Without lamination the values include the loss of the interface, at least 4 %.
            assert!(seen.evaluate(from, to) < 0.965 * lobe(from, to), "{from:?} {to:?}");
        }
    }
}

/// Feng 2012, eq. 3-10: the integral of k f S, averaged over the spectrum, equals the instrument's TIS.
#[test]
fn totals_are_normalised_to_instrument_tis() {
    let spectrum = [0.2, 0.9, 0.95, 0.91];
    let mean = spectrum.iter().sum::<f64>() / 4.0;
    let preparation = Preparation { to_tis: true, ..Preparation::default() };
    let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &spectrum).unwrap();
    for (k, tis) in TIS.into_iter().enumerate() {
        let averaged = mean * scatter.albedo_at(ray(20.0 * k as f64).x);
        assert!((averaged / tis - 1.0).abs() < 1e-3, "{k}: {averaged} {tis}");
        assert!((changes.totals[k][1] / tis - 1.0).abs() < 1e-3);
    }
    let without = MeasuredPart { tis: vec![0.0; 4], ..part(lobe) };
    assert_eq!(kernel(&without, 0, &preparation, &[]).unwrap_err(), GoniometryError::NoTis);
}

/// Beyond the last incidence, light is lost and the loss is reported; with extrapolation, the lobe is
/// used about its own specular direction.
#[test]
fn light_beyond_last_incidence_is_lost_unless_extrapolated() {
    let [(none, lost), (hold, extended)] = [None, Some(1.0)].map(|extrapolate| {
        kernel(&part(lobe), 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap()
    });
    assert!((lost.lost - 0.25).abs() < 1e-12 && lost.last_deg == 60.0 && extended.lost == 0.0, "{lost:?}");
    let (from, to) = (ray(75.0), ray(70.0));
    assert_eq!(none.evaluate(from, to), 0.0);
    assert!((hold.evaluate(from, to) / lobe(from, to) - 1.0).abs() < 3e-3, "{}", hold.evaluate(from, to));
}

/// With a single incidence, along the normal, the lobe is used at all incidences on request; otherwise
/// others are dark.
#[test]
fn single_incidence_is_held_on_request() {
    let mut part = part(lobe);
    let Geometry::Specular(grid) = &mut part.geometry else { panic!("{:?}", part.geometry) };
    grid.incidences_deg.truncate(1);
    part.values.truncate(grid.cells());
    part.tis.truncate(1);
    let made =
        |extrapolate| kernel(&part, 0, &Preparation { extrapolate, ..Preparation::default() }, &[]).unwrap();
    let (none, lost) = made(None);
    let (hold, held) = made(Some(1.0));
    for (from, to) in [(0.0, 10.0), (20.0, 15.0), (70.0, 60.0)].map(|(from, to)| (ray(from), ray(to))) {
        let value = hold.evaluate(from, to);
        assert!((value / lobe(from, to) - 1.0).abs() < 3e-3, "{from:?}: {value}");
        assert_eq!(none.evaluate(from, to), if from.x == 0.0 { value } else { 0.0 });
    }
    assert_eq!((none.albedo_at(0.1), none.reversed().evaluate(ray(10.0), ray(20.0))), (0.0, 0.0));
    assert_eq!((lost.lost, lost.held_single, held.lost, held.held_single), (1.0, false, 0.0, true));
}

/// A dense measurement of a lobe that is no k-correlation (exponential) up to 80 deg: in the glass it holds
/// the light of the true lobe at every incidence, by a sum over the disc of the glass. At 80 deg the line
/// away from the normal ends 0.015 from the peak, and its slope there extrapolated to 1.4 times the light
/// that arrives.
#[test]
fn tails_in_the_glass_conserve_light_at_oblique_incidence() {
    let exponential = |from: Beta, to: Beta| {
        let width = 0.15;
        0.9 * (-(to - from).length() / width).exp() / (2.0 * PI * width * width)
    };
    let mut part = part(exponential);
    let Geometry::Specular(grid) = &mut part.geometry else { panic!("{:?}", part.geometry) };
    grid.incidences_deg = (0..=16).map(|k| 5.0 * f64::from(k)).collect();
    part.values.clear();
    for theta in &grid.incidences_deg {
        for azimuth in &grid.azimuths_deg {
            part.values.extend(grid.radials_deg.iter().map(|radial| {
                let to = SpecularGrid::direction(*theta, *azimuth, *radial);
                to.map_or(0.0, |to| exponential(ray(*theta), to.leaving()))
            }));
        }
    }
    let preparation = Preparation { extrapolate: Some(1.5), ..Preparation::default() };
    let (scatter, changes) = kernel(&part, 0, &preparation, &[]).unwrap();
    let steps = 600;
    let middle = |k: i32| 1.5 * (f64::from(2 * k + 1) / f64::from(steps) - 1.0);
    for theta in [0.0, 40.0, 60.0, 75.0, 80.0] {
        let from = ray(theta);
        let squares = (0..steps).flat_map(|i| (0..steps).map(move |j| Beta { x: middle(i), y: middle(j) }));
        let sum: f64 = squares.filter(|to| to.squared() < 2.25).map(|to| exponential(from, to)).sum();
        let total = sum * (3.0 / f64::from(steps)).powi(2);
        let found = scatter.albedo_at(from.x);
        assert!((found / total - 1.0).abs() < 0.01, "{theta}: {found} instead of {total}");
    }
    assert!((changes.held - 0.0302).abs() < 1e-4 && changes.lost == 0.0, "{changes:?}");
}

/// Values in relative units take the level that is stated for the smallest incidence; the ratios of
/// incidences remain.
#[test]
fn stated_level_scales_all_incidences() {
    let relative = part(|from, to| 17.0 * lobe(from, to));
    let level = |level| Preparation { level, ..Preparation::default() };
    let (scaled, changes) = kernel(&relative, 0, &level(Some(0.7)), &[]).unwrap();
    let (plain, _) = kernel(&part(lobe), 0, &level(None), &[]).unwrap();
    assert!((scaled.albedo_at(0.0) - 0.7).abs() < 1e-4 && changes.level == Some(0.7));
    let ratio = |theta: f64| scaled.albedo_at(ray(theta).x) / plain.albedo_at(ray(theta).x);
    assert!((ratio(60.0) / ratio(0.0) - 1.0).abs() < 1e-6);
}

/// Extrapolated tails in the glass equal the true lobe there.
#[test]
fn tails_are_extrapolated_into_the_glass() {
    let preparation = Preparation { extrapolate: Some(1.5), ..Preparation::default() };
    let (scatter, changes) = kernel(&part(lobe), 0, &preparation, &[]).unwrap();
    let back = scatter.reversed();
    for (from, to) in [(0.0, 1.2), (0.5, 1.1), (0.86, 1.45), (0.3, -1.4)] {
        let [from, to] = [from, to].map(|x| Beta { x, y: 0.0 });
        for value in [scatter.evaluate(from, to), back.evaluate(to, from)] {
            assert!((value / lobe(from, to) - 1.0).abs() < 1e-2, "{from:?} {to:?}: {value}");
        }
        assert_eq!(scatter.evaluate(to, from), 0.0);
    }
    let closed = Lobe::KCorrelation { width: WIDTH };
    for (k, length) in [0.0, 20.0, 40.0, 60.0].map(|theta| ray(theta).length()).into_iter().enumerate() {
        let (air, glass) =
            (0.8 * closed.fraction_in_disc(length, 1.0), 0.8 * closed.fraction_in_disc(length, 1.5));
        assert!((changes.totals[k][1] - air).abs() < 1e-4, "{k}: {air} {:?}", changes.totals[k]);
        assert!(
            (scatter.albedo_at(length) - glass).abs() < 3e-4,
            "{k}: {glass} {}",
            scatter.albedo_at(length)
        );
    }
    for length in [0.2, 0.97, 1.0, 1.003, 1.05, 1.2, 1.45] {
        let fraction = 0.8 * closed.fraction_in_disc(length, 1.0);
        assert!(
            (back.albedo_at(length) - fraction).abs() < 5e-4,
            "{length}: {fraction} {}",
            back.albedo_at(length)
        );
    }
}
