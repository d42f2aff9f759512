//! The virtual goniometer against closed forms, published values and laws.

use crate::harvey_shack::Lobes;
use crate::waves::Waves;
use crate::*;

const GLASS: f64 = 1.5;

fn measured(surface: &Surface, incidence_deg: &[f64], rays: u64) -> Vec<Total> {
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: GLASS,
        coating: Coating::None,
        incidence_deg: incidence_deg.to_vec(),
        azimuths: None,
        rays,
        seed: papilio_testing::seeds(),
    };
    let replicates = (0..REPLICATES).map(|number| goniometer.replicate(surface, number, &|| false).unwrap());
    goniometer.totals(&replicates.collect::<Vec<_>>()).unwrap()
}

/// A flat face has Fresnel's reflectances, and sends nothing off the regular directions.
#[test]
fn flat_faces_are_those_of_fresnel() {
    let totals = measured(&Surface::Flat, &[0.0, 30.0, 60.0, 75.0], 8);
    for (total, reflectance) in
        totals.iter().zip([0.04, 0.04152263, 0.08918671, 0.25306056, 0.04, 0.05519017])
    {
        assert!((total.reflected.value - reflectance).abs() < 1e-8, "{total:?}");
        assert!((total.reflected.value - total.regular_reflected.value).abs() < 1e-12);
        assert!((total.transmitted.value - total.regular_transmitted.value).abs() < 1e-12);
        assert!(
            (total.reflected.value + total.transmitted.value - 1.0).abs() < 1e-12
                && total.mean_facets.value == 1.0
        );
    }
}

/// Feng's hemispheres, side by side on squares: values of a separate program. Their standard errors are 1e-3;
/// three of them are allowed.
#[test]
fn hemispheres_are_those_of_a_separate_program() {
    let caps = Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice: Lattice::Square };
    let totals =
        measured(&Surface::Caps(caps), &[0.0, 30.0, 41.0, 60.0, 75.0], papilio_testing::sized(200, 400));
    let from_air = [
        [0.0252, 0.9436, 0.0312],
        [0.0257, 0.8028, 0.1715],
        [0.0278, 0.5880, 0.3842],
        [0.0387, 0.1615, 0.7998],
        [0.0718, 0.0311, 0.8971],
    ];
    for (total, [reflected, seen, beyond]) in totals.iter().zip(from_air) {
        let within = total.transmitted.value - total.transmitted_beyond.value;
        let pairs =
            [(total.reflected.value, reflected), (within, seen), (total.transmitted_beyond.value, beyond)];
        for (found, expected) in pairs {
            assert!(
                (found - expected).abs() < 3e-3 + 4.0 * total.transmitted_beyond.error,
                "{expected}: {total:?}"
            );
        }
    }
    for (total, transmitted) in totals[5..].iter().zip([0.5220, 0.5122, 0.4263, 0.4704, 0.1076]) {
        let allowed = 3e-3 + 4.0 * total.transmitted.error;
        assert!((total.transmitted.value - transmitted).abs() < allowed, "{transmitted}: {total:?}");
        assert!(total.mean_facets.value > 1.5 && total.mean_facets.value < 3.3, "{total:?}");
    }
}

/// Small Gaussian slopes: light along the normal is deflected by (n - 1) slopes; half of it by less than (n -
/// 1) alpha sqrt(ln 2).
#[test]
fn small_gaussian_slopes_have_the_closed_form() {
    let alpha = 0.1;
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 0.5 * alpha * 10.0, correlation_um: 10.0 }, 5)
        .unwrap();
    let statistics = face.realisation(0).unwrap().statistics();
    // A realisation of 21 correlation lengths has few independent heights.
    assert!((statistics.rms_um - 0.5).abs() < 0.1, "{statistics:?}");
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: GLASS,
        coating: Coating::None,
        incidence_deg: Vec::new(),
        azimuths: None,
        rays: 80,
        seed: 1,
    };
    let replicates: Vec<Replicate> = (0..REPLICATES)
        .map(|number| goniometer.replicate(&Surface::Random(face.clone()), number, &|| false).unwrap())
        .collect();
    let found = goniometer.kernel(&replicates).unwrap();
    let bands = &found.bands;
    // The first band is within 2.5 deg of the normal: |beta| up to 0.0436, the median of the slopes' lobe
    // being 0.0416.
    let row = &found.scattered[..bands.count() * found.azimuths()];
    let within: f64 = bands
        .of(Side::Below)
        .take(1)
        .map(|to| row[to * found.azimuths()..][..found.azimuths()].iter().sum::<f64>())
        .sum();
    let all: f64 = bands
        .of(Side::Below)
        .map(|to| row[to * found.azimuths()..][..found.azimuths()].iter().sum::<f64>())
        .sum();
    // Light within the band is convolved with the band itself: a Gaussian of 1/e width w = (n - 1) alpha in
    // the disc of radius b, averaged over starts in the disc, by quadrature.
    let (w, b) = (0.5 * alpha, 2.5_f64.to_radians().sin());
    let expected = averaged_over_disc(w, b);
    assert!((within / all - expected).abs() < 0.02, "{} {expected}", within / all);
}

/// Fraction of a Gaussian `exp(-r^2/w^2)` about a uniform point of a disc of radius b that lies in the disc.
fn averaged_over_disc(w: f64, b: f64) -> f64 {
    let steps = 60;
    let cell = 2.0 * b / f64::from(steps);
    let points: Vec<[f64; 2]> = (0..steps * steps)
        .map(|k| {
            [0, 1].map(|axis| -b + cell * (f64::from(if axis == 0 { k % steps } else { k / steps }) + 0.5))
        })
        .filter(|[x, y]| x.hypot(*y) < b)
        .collect();
    let pairs =
        points.iter().flat_map(|a| points.iter().map(move |b| (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)));
    let sum: f64 = pairs.map(|square| (-square / (w * w)).exp()).sum();
    sum * cell * cell / (std::f64::consts::PI * w * w) / points.len() as f64
}

/// Blocks only save time: with and without them, rays meet the same places.
#[test]
fn blocks_do_not_change_what_rays_meet() {
    use crate::heights::Triangles;
    use crate::ray::{Face as _, Met, Ray};
    let face = RandomHeights::new(Spectrum::Gaussian { rms_um: 4.0, correlation_um: 10.0 }, 7).unwrap();
    let map = face.realisation(0).unwrap();
    let [with, without] = [true, false].map(|blocks| Triangles::with_blocks(&map, blocks));
    let mut dice = papilio_testing::Dice::new(0xb10c, 0);
    let mut facets = 0;
    for _ in 0..3000 {
        let (sine, azimuth) = (dice.between(0.0, 0.999), dice.between(0.0, std::f64::consts::TAU));
        let side = dice.of(Side::ALL);
        let up = if side == Side::Above { -1.0 } else { 1.0 } * (1.0 - sine * sine).sqrt();
        let [low, high] = with.heights_um();
        let z = if side == Side::Above { high } else { low };
        let mut ray = Ray {
            at: [dice.between(0.0, 213.0), dice.between(0.0, 213.0), z],
            along: [sine * azimuth.cos(), sine * azimuth.sin(), up],
        };
        // Where a ray meets a facet, it goes on as from a mirror; where the normal is, on its own side.
        for _ in 0..4 {
            match (with.next(&ray, side), without.next(&ray, side)) {
                (Met::Facet { at, normal }, Met::Facet { at: other, normal: beside }) => {
                    (0..3).for_each(|k| assert!((at[k] - other[k]).abs() < 1e-7, "{at:?} {other:?}"));
                    assert!(crate::ray::dot(normal, beside) > 1.0 - 1e-9 || (at[2] - other[2]).abs() < 1e-7);
                    let cosine = crate::ray::dot(ray.along, normal);
                    ray = Ray { at, along: crate::ray::moved(ray.along, -2.0 * cosine, normal) };
                    facets += 1;
                }
                (one, other) => {
                    assert_eq!(one, other);
                    break;
                }
            }
        }
    }
    assert!(facets > 3000);
}

/// An exponential face with the haze of the dissertation's H78: its haze falls with the wavelength. The
/// series is that of a separate program; a single lobe of width g b1, to which it tends at large g, has 0.84,
/// 0.78 and 0.73: too much by 0.02 to 0.04 at these g of 7 to 15.
#[test]
fn haze_of_an_exponential_face_depends_on_wavelength() {
    let (rms_um, correlation_um) = (0.554, 15.4);
    let spectrum = Spectrum::Exponential { rms_um, correlation_um, cutoff_um: 1.0 };
    for (nm, haze, of_lobe) in [(450.0, 0.8163273, 0.84), (550.0, 0.7512621, 0.78), (650.0, 0.6885330, 0.73)]
    {
        let um = 1e-3 * nm;
        let g = (std::f64::consts::TAU * 0.5 * rms_um / um).powi(2);
        let found = Lobes::new(&spectrum, um, 1.0).unwrap().normal_haze(g);
        assert!((found - haze).abs() < 1e-6, "{nm}: {found}");
        let width = g * um / (std::f64::consts::TAU * correlation_um);
        let beyond = |beta: f64| width / width.hypot(beta);
        let lobe = (beyond(2.5_f64.to_radians().sin()) - beyond(1.0)) / (1.0 - beyond(1.0));
        assert!(
            (lobe - of_lobe).abs() < 0.005 && lobe - found > 0.015 && lobe - found < 0.04,
            "{nm}: {lobe}"
        );
    }
}

fn measured_by_waves(surface: &Surface, incidence_deg: &[f64], wavelengths_nm: &[f64]) -> ByWaves {
    let waves = Waves {
        index: [1.0, GLASS],
        incidence_deg: incidence_deg.to_vec(),
        wavelengths_nm: wavelengths_nm.to_vec(),
    };
    let screens: Vec<_> =
        (0..Waves::screens(surface)).map(|k| waves.screen(surface, k, &|| false).unwrap()).collect();
    waves.combined(surface, &screens)
}

/// Screens of Gaussian faces: the straight part and the haze are those of the closed forms, and rms heights
/// of 20 to 200 nm have the known shares.
#[test]
fn screens_of_gaussian_faces_have_the_closed_forms() {
    for (rms_nm, straight, mirror) in
        [(20.0, 0.98703, 0.81155), (50.0, 0.92167, 0.27115), (100.0, 0.72161, 0.0054)]
    {
        let spectrum = Spectrum::Gaussian { rms_um: 1e-3 * rms_nm, correlation_um: 4.0 };
        let surface = Surface::Random(RandomHeights::new(spectrum.clone(), 2).unwrap());
        let found = measured_by_waves(&surface, &[], &[450.0, 550.0]);
        let found: Vec<(&WaveShares, &WayShares)> = found.along_normal().collect();
        let (green, through) = found[1];
        // Few independent heights: a realisation is 21 correlation lengths wide.
        assert!(
            (through.regular.value - straight).abs() < 4.5 * through.regular.error + 1e-3,
            "{rms_nm}: {green:?}"
        );
        let mirrored = &green.reflected.regular;
        assert!((mirrored.value - mirror).abs() < 4.5 * mirrored.error + 1e-2, "{rms_nm}: {green:?}");
        for (shares, one) in &found {
            let um = 1e-3 * shares.wavelength_nm;
            let g = (std::f64::consts::PI * 1e-3 * rms_nm / um).powi(2);
            let haze = Lobes::new(&spectrum, um, 1.0).unwrap().normal_haze(g);
            assert!((one.closed_form.unwrap().one_angle_haze - haze).abs() < 1e-12);
            assert!((one.g / g - 1.0).abs() < 0.05, "{rms_nm}: {} {g}", one.g);
            assert!((one.haze.value - haze).abs() < 4.5 * one.haze.error + 2e-3, "{rms_nm}: {one:?} {haze}");
        }
        assert!(found[0].1.regular.value < through.regular.value);
    }
}

/// A sinusoidal grating has the orders J_m^2, and an array of caps those of a separate program.
#[test]
fn gratings_have_their_orders() {
    let amplitude = 2.0;
    let um = 0.55;
    let height = |at: usize| {
        let phase = std::f64::consts::TAU * (at % 64) as f64 / 64.0;
        amplitude * phase.sin() * um / (std::f64::consts::TAU * 0.5)
    };
    // A period of 12 um: the first order is at beta 0.0458, beyond 2.5 deg, and so are all others.
    let map = HeightMap::new(64, [12.0 / 64.0; 2], (0..64 * 8).map(height).collect()).unwrap();
    let found = measured_by_waves(&Surface::Heights(map), &[], &[550.0]);
    let (_, through) = found.along_normal().next().unwrap();
    assert!((through.regular.value - 0.0501270810).abs() < 1e-9, "{found:?}");
    assert!((through.haze.value - (1.0 - 0.0501270810)).abs() < 1e-9, "{found:?}");
    // Caps 10 um apart: light within half of the largest |beta| of rays, which have 0.4110 there.
    for (radius_um, beta, within) in [(25.0, 0.0502, 0.3659), (12.5, 0.1014, 0.4281)] {
        let caps = Caps { pitch_um: 10.0, radius_um, aperture_um: 5.0, lattice: Lattice::Square };
        let map = Surface::Caps(caps).heights(0).unwrap();
        let plane = papilio_fourier::Plane::new([map.columns(), map.rows()]);
        let phase = std::f64::consts::PI / um;
        let [_, far] =
            crate::waves::shares(&map, (&plane, crate::screen_rings::Orders::Exact), phase, um, beta);
        assert!((1.0 - far - within).abs() < 2e-3, "{radius_um}: {}", 1.0 - far);
    }
}
