//! Waves at oblique angles: orders of gratings, energy, reciprocity, phase screens against the closed forms.

use std::f64::consts::PI;

use papilio_fourier::Plane;

use crate::harvey_shack::Lobes;
use crate::screen_rings::{Orders, ScreenLight, ScreenRings};
use crate::wave_way::{Way, first_inside, inside};
use crate::waves::Waves;
use crate::*;

const INDEX: [f64; 2] = [1.0, 1.5];

/// All ways of these inclinations from both sides.
fn ways(incidence_deg: &[f64]) -> Vec<Way> {
    let of = |from: Side| incidence_deg.iter().map(move |deg| Way::both(INDEX, from, *deg));
    let all = Side::ALL.into_iter().flat_map(of);
    all.flat_map(|(reflected, transmitted)| [Some(reflected), transmitted]).flatten().collect()
}

/// Bessel function J_m by its integral, which the midpoint rule gives to the last digits.
fn bessel(m: u32, x: f64) -> f64 {
    let steps = 400;
    let at = |k: u32| {
        let t = PI * (f64::from(k) + 0.5) / f64::from(steps);
        (f64::from(m) * t - x * t.sin()).cos()
    };
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

/// Paths by hand: from air at 60 deg into glass of 1.5 and back, and both mirrors.
#[test]
fn paths_are_those_of_the_refracted_and_reflected_light() {
    let behind = (2.25_f64 - 0.75).sqrt();
    let (mirrored, through) = Way::both(INDEX, Side::Above, 60.0);
    assert!((mirrored.path(mirrored.beta) - 1.0).abs() < 1e-12);
    assert!((through.unwrap().path(mirrored.beta) - (behind - 0.5)).abs() < 1e-12);
    assert!((mirrored.fresnel - 0.08918671).abs() < 1e-8);
    let (below, none) = Way::both(INDEX, Side::Below, 60.0);
    assert!((below.path(below.beta) - 1.5).abs() < 1e-12 && none.is_none() && below.fresnel == 1.0);
    // A way and the opposite one have the same paths.
    let (_, up) = Way::both(INDEX, Side::Below, 20.0);
    let (_, down) = Way::both(INDEX, Side::Above, 40.0);
    let (up, down) = (up.unwrap(), down.unwrap());
    assert!((up.path(down.beta) - down.path(up.beta)).abs() < 1e-12);
}

/// The arc of a circle in a disc, by counting points.
#[test]
fn circles_are_in_discs_as_far_as_points_are() {
    let mut dice = papilio_testing::Dice::new(0xc1c1e, 0);
    for _ in 0..200 {
        let (radius, beta, disc) = (dice.between(0.0, 2.0), dice.between(0.0, 1.5), dice.between(0.5, 1.5));
        let points = 4000;
        let is_in = |k: &u32| {
            let angle = PI * (f64::from(*k) + 0.5) / f64::from(points);
            (beta + radius * angle.cos()).hypot(radius * angle.sin()) <= disc
        };
        let counted = f64::from((0..points).filter(is_in).count() as u32) / f64::from(points);
        assert!((inside(radius, beta, disc) - counted).abs() < 1e-3, "{radius} {beta} {disc}");
    }
    assert_eq!([first_inside(0.0, 0.0, 1.0), first_inside(0.0, 1.2, 1.0)], [0.0, PI]);
}

/// A sinusoidal grating at 30 and 60 deg from both sides: orders J_m^2 of the oblique phase amplitude in the
/// directions of the grating law. Light comes from all azimuths, so that an order counts by the part of its
/// circle that exists.
#[test]
fn oblique_gratings_have_their_orders() {
    let (um, pitch_um, amplitude_um) = (0.55, 1.7, 0.3);
    let height = |at: usize| amplitude_um * (std::f64::consts::TAU * at as f64 / 128.0).sin();
    let map = HeightMap::new(128, [pitch_um / 128.0; 2], (0..128).map(height).collect()).unwrap();
    let plane = Plane::new([128, 1]);
    let all = ways(&[30.0, 60.0]);
    let light = ScreenLight::new(all.iter().map(|way| (*way, um)));
    let rings = ScreenRings::new(&map, (&plane, Orders::Exact), &light, &|| false).unwrap();
    let mut evanescent = 0;
    for way in all {
        let phase = way.regular_per_um(um) * amplitude_um;
        let found = rings.of(&way, um);
        assert!((found.regular - bessel(0, phase).powi(2)).abs() < 1e-9, "{way:?}: {found:?}");
        let share = |disc: f64| {
            let order = |m: u32| {
                2.0 * bessel(m, phase).powi(2) * inside(um * f64::from(m) / pitch_um, way.beta, disc)
            };
            (1..60).map(order).sum::<f64>()
        };
        let lost = 1.0 - found.regular - share(way.disc());
        assert!((found.evanescent - lost).abs() < 1e-9, "{way:?}: {found:?} {lost}");
        evanescent += u32::from(lost > 0.01);
        let (regular, seen) = (if way.beta <= way.seen() { found.regular } else { 0.0 }, share(way.seen()));
        // The first order is at 0.32, so that all orders are haze.
        assert!((found.haze - seen / (regular + seen)).abs() < 1e-9, "{way:?}: {found:?}");
    }
    assert!(evanescent > 3, "the test has no power where all orders exist");
}

/// Crossed sines: amplitudes of the orders (m, n) are products of J_m and J_n of the oblique phase amplitude,
/// and the squares of those that exist beyond 2.5 deg are the haze. In one map, the first orders are within 2.5
/// deg by a hair at 540 nm. In the other one, most light goes beyond. There are more phases than screens.
#[test]
fn crossed_gratings_have_their_orders_at_all_inclinations() {
    let wavelengths_nm: Vec<f64> = (0..=14).map(|k| 400.0 + 20.0 * f64::from(k)).collect();
    let incidence_deg = vec![0.0, 20.0, 40.0, 60.0, 75.0];
    for (periods, pitch_um, amplitude_um) in [(8, 99.4 / 8.0, 0.1), (1, 3.0, 0.25), (1, 3.0, 1.0)] {
        let points = if amplitude_um > 0.5 { 256 } else { 64 * periods / 2 + 32 };
        let sine = |at: usize| (2.0 * PI * (at * periods) as f64 / points as f64).sin();
        let height = |at: usize| amplitude_um * (sine(at % points) + sine(at / points));
        let heights = (0..points * points).map(height).collect();
        let map = HeightMap::new(points, [pitch_um * periods as f64 / points as f64; 2], heights).unwrap();
        let surface = Surface::Heights(map);
        let waves = Waves {
            index: INDEX,
            incidence_deg: incidence_deg.clone(),
            wavelengths_nm: wavelengths_nm.clone(),
        };
        let found = waves.combined(&surface, &[waves.screen(&surface, 0, &|| false).unwrap()]);
        let mut tests = 0;
        for one in found.shares.iter().filter(|one| [440.0, 540.0, 680.0].contains(&one.wavelength_nm)) {
            let um = 1e-3 * one.wavelength_nm;
            let (reflected, transmitted) = Way::both(INDEX, one.from, one.theta_deg);
            let pairs = [(Some(reflected), Some(one.reflected)), (transmitted, one.transmitted)];
            for (way, shares) in pairs.into_iter().filter_map(|(way, shares)| Some((way?, shares?))) {
                let phase = way.regular_per_um(um) * amplitude_um;
                let powers: Vec<f64> = (0..100).map(|m| bessel(m, phase).powi(2)).collect();
                let (mut near, mut far, mut exists) = (0.0, 0.0, 0.0);
                for m in 0..100_usize {
                    for n in 0..100_usize {
                        let both = [m, n].iter().filter(|order| **order > 0).count() as i32;
                        let power = 2.0_f64.powi(both) * powers[m] * powers[n];
                        let distance = um * (m as f64).hypot(n as f64) / pitch_um;
                        exists += power * inside(distance, way.beta, way.disc());
                        let seen = power * inside(distance, way.beta, way.seen());
                        let is_haze = distance > 2.5_f64.to_radians().sin();
                        *(if is_haze { &mut far } else { &mut near }) += seen;
                    }
                }
                let what = format!("{amplitude_um} um, {} nm, {:?}: {shares:?}", one.wavelength_nm, way);
                assert!((shares.regular.value - powers[0].powi(2)).abs() < 1e-9, "{what}");
                assert!((shares.haze.value - far / (near + far)).abs() < 1e-6, "{what} {far} {near}");
                assert!((shares.evanescent.value - 1.0 + exists).abs() < 1e-6, "{what} {exists}");
                tests += 1;
            }
        }
        assert_eq!(tests, 3 * (2 * 5 + 5 + 3));
    }
}

/// A face without structures keeps all light in the regular direction.
#[test]
fn flat_screens_scatter_nothing() {
    let map = HeightMap::new(4, [1.0; 2], vec![0.0; 16]).unwrap();
    let all = ways(&[0.0, 50.0]);
    let light = ScreenLight::new(all.iter().map(|way| (*way, 0.55)));
    let rings = ScreenRings::new(&map, (&Plane::new([4; 2]), Orders::Exact), &light, &|| false).unwrap();
    for way in all {
        let found = rings.of(&way, 0.55);
        assert!((found.regular - 1.0).abs() < 1e-12 && found.evanescent.abs() < 1e-12, "{found:?}");
    }
}

/// Lobes of one angle: regular, scattered and evanescent light add up to 1, whatever the disc. Beyond a disc
/// as wide as the series reaches, nothing is left.
#[test]
fn closed_forms_conserve_energy_before_and_after_renormalisation() {
    let um = 0.55;
    let faces = [
        Spectrum::Gaussian { rms_um: 0.1, correlation_um: 1.0 },
        Spectrum::Exponential { rms_um: 0.15, correlation_um: 4.0, cutoff_um: 0.5 },
        Spectrum::Exponential { rms_um: 0.6, correlation_um: 15.0, cutoff_um: 0.5 },
    ];
    for spectrum in faces {
        let lobes = Lobes::new(&spectrum, um, 3.0).unwrap();
        for way in ways(&[0.0, 30.0, 70.0]) {
            let regular = (-lobes.g(way.path(way.beta))).exp();
            let one = lobes.scattered(&way, false);
            // The evanescent light, from the rest of each circle.
            let beyond = evanescent(&lobes, &way);
            let what = format!("{spectrum:?} {way:?}: {one:?} {beyond}");
            assert!((regular + one.all + beyond - 1.0).abs() < 3e-4, "{what}");
            let two = lobes.scattered(&way, true);
            let found = lobes.of(&way);
            assert!((regular + found.renormalisation * two.all - 1.0).abs() < 1e-12, "{what}");
            assert!(found.haze > 0.0 && found.haze < 1.0 && found.one_angle_haze < 1.0, "{what} {found:?}");
        }
    }
}

/// Light of one angle in directions that do not exist, by another quadrature: fine steps in the square of the
/// distance over 1 + distance.
fn evanescent(lobes: &Lobes, way: &Way) -> f64 {
    let g = lobes.g(way.path(way.beta));
    let steps = 3000;
    let at = |k: u32| {
        // distance = t/(1 - t): from 0 to far beyond all discs.
        let t = (f64::from(k) + 0.5) / f64::from(steps);
        let (distance, slope) = (t / (1.0 - t), (1.0 - t).powi(-2));
        match inside(distance, way.beta, way.disc()) {
            1.0 => 0.0,
            part => 2.0 * PI * distance * slope * lobes.density(g, distance) * (1.0 - part),
        }
    };
    (0..steps).map(at).sum::<f64>() / f64::from(steps)
}

/// The density is symmetric in both directions: from a to b as from b to a, in both ways, from both sides.
#[test]
fn two_angle_lobes_are_reciprocal_and_one_angle_lobes_are_not() {
    let spectrum = Spectrum::Gaussian { rms_um: 0.2, correlation_um: 1.5 };
    let lobes = Lobes::new(&spectrum, 0.55, 3.0).unwrap();
    let mut differs = 0.0_f64;
    for (one, other, beta) in [(Side::Above, Side::Above, 0.6), (Side::Below, Side::Below, 1.2)] {
        let [a, b] = [(one, 0.3), (other, beta)].map(|(side, beta): (Side, f64)| {
            let index = if side == Side::Above { INDEX[0] } else { INDEX[1] };
            Way::both(INDEX, side, (beta / index).asin().to_degrees()).0
        });
        let [there, back] = [(a, b), (b, a)].map(|(from, to)| {
            differs = differs.max((from.path(from.beta) / to.path(to.beta) - 1.0).abs());
            lobes.density(lobes.g(from.path(to.beta)), to.beta - from.beta)
        });
        assert!((there / back - 1.0).abs() < 1e-12, "{there} {back}");
    }
    let (_, down) = Way::both(INDEX, Side::Above, 25.0);
    let (_, up) = Way::both(INDEX, Side::Below, 35.0);
    let (down, up) = (down.unwrap(), up.unwrap());
    let [there, back] = [(down, up), (up, down)]
        .map(|(from, to)| lobes.density(lobes.g(from.path(to.beta)), (to.beta - from.beta).abs()));
    assert!((there / back - 1.0).abs() < 1e-12 && differs > 0.1);
}

/// Lobes of small heights are those of first order: g of both directions times the power spectral density
/// over its integral, s². The scattered light is K times that, and K corrects what the disc cuts off.
#[test]
fn small_heights_scatter_by_their_power_spectral_density() {
    let (um, rms_um) = (0.55, 0.002);
    let spectrum = Spectrum::Gaussian { rms_um, correlation_um: 0.5 };
    let face = RandomHeights::new(spectrum.clone(), 0).unwrap();
    let lobes = Lobes::new(&spectrum, um, 3.0).unwrap();
    let (way, _) = Way::both(INDEX, Side::Above, 40.0);
    for beta in [0.3, 0.6, 0.9] {
        let distance: f64 = beta - way.beta;
        let path = way.path(beta);
        let expected = (2.0 * PI * path / um).powi(2) * face.density_um4(distance.abs() / um) / (um * um);
        let found = lobes.density(lobes.g(path), distance);
        assert!((found / expected - 1.0).abs() < 0.01, "{beta}: {found} {expected}");
    }
}

/// Screens of Gaussian faces at 0, 30 and 70 deg from both sides against the sum of lobes with the phase of
/// the regular direction; errors by the scatter of the screens.
#[test]
fn oblique_screens_have_the_closed_forms() {
    let rms_um = 0.12;
    let spectrum = Spectrum::Gaussian { rms_um, correlation_um: 2.0 };
    let surface = Surface::Random(RandomHeights::new(spectrum.clone(), 11).unwrap());
    let waves = Waves { index: INDEX, incidence_deg: vec![30.0, 70.0], wavelengths_nm: vec![550.0] };
    let screens: Vec<_> = (0..Waves::screens(&surface))
        .map(|number| waves.screen(&surface, number, &|| false).unwrap())
        .collect();
    let found = waves.combined(&surface, &screens);
    let mut tests = 0;
    for one in &found.shares {
        let lobes = Lobes::new(&spectrum, 1e-3 * one.wavelength_nm, 3.0).unwrap();
        let (reflected, transmitted) = Way::both(INDEX, one.from, one.theta_deg);
        let pairs = [(Some(reflected), Some(one.reflected)), (transmitted, one.transmitted)];
        for (way, shares) in pairs.into_iter().filter_map(|(way, shares)| Some((way?, shares?))) {
            let regular = (-lobes.g(way.path(way.beta))).exp();
            let scattered = lobes.scattered(&way, false);
            let checks = [
                (shares.regular, regular, 2e-3),
                (shares.haze, shares.closed_form.unwrap().one_angle_haze, 4e-3),
                (shares.evanescent, 1.0 - regular - scattered.all, 2e-3),
            ];
            for (measured, expected, least) in checks {
                let allowed = 4.5 * measured.error + least;
                assert!(
                    (measured.value - expected).abs() < allowed,
                    "{} {:?} {}: {shares:?} {expected}",
                    one.theta_deg,
                    one.from,
                    one.wavelength_nm
                );
                tests += 1;
            }
        }
    }
    // From above both ways at three inclinations; from below at two of them, one of which is beyond the
    // critical angle.
    assert_eq!(tests, 3 * (2 * 3 + 2 + 1));
}

/// Cubics between few phases are the transforms of all phases.
#[test]
fn powers_between_phases_are_interpolated() {
    let spectrum = Spectrum::Gaussian { rms_um: 0.2, correlation_um: 4.0 };
    let map = RandomHeights::new(spectrum, 3).unwrap().realisation(0).unwrap();
    let plane = Plane::new([map.columns(), map.rows()]);
    let phase = |k: u32| 2.0 * 1.2_f64.powf(f64::from(k));
    let nodes: Vec<f64> = (0..16).map(phase).collect();
    let nodes = ScreenLight::of_phases(nodes);
    let rings = ScreenRings::new(&map, (&plane, Orders::Cells), &nodes, &|| false).unwrap();
    for way in ways(&[20.0, 50.0]) {
        let um = 0.55;
        let one = ScreenLight::new([(way, um)]);
        let exact = ScreenRings::new(&map, (&plane, Orders::Cells), &one, &|| false).unwrap();
        let [found, expected] = [&rings, &exact].map(|rings| rings.of(&way, um));
        assert!((found.regular - expected.regular).abs() < 1e-4, "{found:?} {expected:?}");
        assert!((found.haze - expected.haze).abs() < 2e-3, "{found:?} {expected:?}");
        assert!((found.evanescent - expected.evanescent).abs() < 2e-3, "{found:?} {expected:?}");
    }
}

/// The part of a cell beyond a circle, by counting points.
#[test]
fn cells_are_beyond_circles_as_far_as_points_are() {
    let mut dice = papilio_testing::Dice::new(0xce11, 0);
    let mut cut = 0;
    for _ in 0..300 {
        let centre = [dice.between(-2.0, 2.0), dice.between(-2.0, 2.0)];
        let sides = [dice.between(0.1, 2.0), dice.between(0.1, 2.0)];
        let radius = dice.between(0.2, 2.5);
        let points = 100;
        let place =
            |k: usize, at: i32| centre[k] + sides[k] * ((f64::from(at) + 0.5) / f64::from(points) - 0.5);
        let is_far = |(x, y): &(i32, i32)| place(0, *x).hypot(place(1, *y)) > radius;
        let all = (0..points).flat_map(|x| (0..points).map(move |y| (x, y)));
        let counted = all.filter(is_far).count() as f64 / f64::from(points * points);
        let found = Orders::Cells.beyond(centre, sides, radius);
        assert!((found - counted).abs() < 4e-3, "{centre:?} {sides:?} {radius}: {found} {counted}");
        cut += u32::from(counted > 0.05 && counted < 0.95);
    }
    assert!(cut > 50, "{cut} cells are cut");
}

/// Haze of a random face changes steadily with the wavelength, where the orders of its short period move past
/// 2.5 deg in groups of four and eight. The judge is the series for a face without a period, whose slope it
/// has; the level is that of a few realisations.
#[test]
fn haze_of_random_faces_has_no_steps_where_orders_pass_the_angle() {
    let spectrum = Spectrum::Gaussian { rms_um: 0.08, correlation_um: 3.0 };
    let surface = Surface::Random(RandomHeights::new(spectrum.clone(), 5).unwrap());
    let period_um = surface.heights(0).unwrap().period_um()[0];
    // The twelve orders as far as (5, 0), and the eight as far as (5, 1), pass 2.5 deg at these wavelengths.
    let passes = |square: f64| 1e3 * 2.5_f64.to_radians().sin() * period_um / square.sqrt();
    let wavelengths_nm: Vec<f64> =
        [25.0, 26.0].into_iter().flat_map(|square| [passes(square) - 1.0, passes(square) + 1.0]).collect();
    assert!(wavelengths_nm.iter().all(|nm| (400.0..700.0).contains(nm)), "{period_um}");
    let waves =
        Waves { index: INDEX, incidence_deg: vec![0.0, 20.0], wavelengths_nm: wavelengths_nm.clone() };
    let screens: Vec<_> = (0..Waves::screens(&surface))
        .map(|number| waves.screen(&surface, number, &|| false).unwrap())
        .collect();
    let found = waves.combined(&surface, &screens);
    for (from, theta_deg) in
        [(Side::Above, 0.0), (Side::Below, 0.0), (Side::Above, 20.0), (Side::Below, 20.0)]
    {
        let of = |nm: f64| {
            let is =
                |one: &&WaveShares| (one.from, one.theta_deg, one.wavelength_nm) == (from, theta_deg, nm);
            let shares = found.shares.iter().find(is).unwrap().transmitted.unwrap();
            [shares.haze.value, shares.closed_form.unwrap().one_angle_haze]
        };
        for pair in wavelengths_nm.chunks(2) {
            let [before, after] = [of(pair[0]), of(pair[1])];
            let [step, expected] = [0, 1].map(|k| after[k] - before[k]);
            assert!((step - expected).abs() < 2e-3, "{from:?} {theta_deg} {pair:?}: {step} {expected}");
        }
    }
    // From both sides, light along the normal meets the same screen.
    for nm in wavelengths_nm {
        let of = |from: Side| {
            let is = |one: &&WaveShares| (one.from, one.theta_deg, one.wavelength_nm) == (from, 0.0, nm);
            found.shares.iter().find(is).unwrap().transmitted.unwrap()
        };
        assert_eq!(of(Side::Above).haze, of(Side::Below).haze);
    }
}
