//! Volumes against single scattering, and against the laws of light.

use papilio_optics::interface::fresnel_reflectance;
use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::{assert_student, mean_and_error};

use crate::bands::Bands;
use crate::laws_tests::diffuse;
use crate::path::{Facets, follow};
use crate::ray::{Face as _, Met, Ray};
use crate::volume::Particles;
use crate::*;

const MATRIX: f64 = 1.5;

fn spheres(volume_fraction: f64, thickness_um: f64) -> Volume {
    Volume { radius_um: 5.0, length_um: 0.0, index: 1.7, volume_fraction, thickness_um, seed: 2 }
}

fn goniometer(incidence_deg: &[f64], rays: u64) -> Goniometer {
    Goniometer {
        index_above: MATRIX,
        index_below: MATRIX,
        coating: Coating::None,
        incidence_deg: incidence_deg.to_vec(),
        azimuths: None,
        rays,
        seed: 9,
    }
}

fn replicates(of: &Goniometer, volume: Volume) -> Vec<Replicate> {
    let surface = Surface::Volume(volume);
    (0..REPLICATES).map(|number| of.replicate(&surface, number, &|| false).unwrap()).collect()
}

/// Few spheres: light that meets none is exp(-N pi r^2 d/cos). Spheres that do not penetrate each other
/// shadow each other less than independent ones; in the second order of tau = 0.03, by less than tau^2/2 =
/// 4.5e-4 of all light.
#[test]
fn few_spheres_obey_beer_and_lambert() {
    let (fraction, thickness) = (0.002, 100.0);
    let of = goniometer(&[0.0, 60.0], 3000);
    let totals = of.totals_alone(&Surface::Volume(spheres(fraction, thickness)));
    for total in &totals {
        let tau = 0.75 * fraction * thickness / 5.0 / total.theta_deg.to_radians().cos();
        let Measured { value, error } = total.regular_transmitted;
        assert!(error < 2e-3, "the test is weak: {error}");
        assert!(
            (value - (-tau).exp()).abs() < 4.0 * error + 0.5 * tau * tau,
            "{value} {error} {}",
            (-tau).exp()
        );
        let sum = total.reflected.value + total.transmitted.value;
        assert!((sum - 1.0).abs() < 1e-12 && total.regular_reflected.value == 0.0, "{total:?}");
    }
}

/// Dense spheres shadow each other less than independent ones, whose light that meets none would be
/// exp(-1.875) = 0.153: a separate program, which places spheres and counts points that none covers, has
/// 0.1142(25).
#[test]
fn dense_spheres_shadow_as_in_a_separate_program() {
    let volume = Volume { radius_um: 4.0, ..spheres(0.1, 100.0) };
    let of = goniometer(&[0.0], 500);
    let totals = of.totals_alone(&Surface::Volume(volume));
    for total in &totals {
        let Measured { value, error } = total.regular_transmitted;
        assert!(error < 3e-3 && (value - 0.1142).abs() < 4.0 * error.hypot(0.0025), "{value} {error}");
    }
}

/// Mean cosine and backscattered fraction of the light of one sphere, by quadrature over the squared sine of
/// incidence: reflected light is turned by pi - 2 i, and light with p - 1 reflections inside by 2 (i - t) +
/// (p - 1)(pi - 2 t). Light is unpolarised at each facet.
fn by_quadrature(ratio: f64) -> [f64; 2] {
    let count = 20_000;
    let mut sums = [0.0; 2];
    for k in 0..count {
        let sine = ((f64::from(k) + 0.5) / f64::from(count)).sqrt();
        let (i, t) = (sine.asin(), (sine / ratio).asin());
        let reflectance = fresnel_reflectance(1.0, ratio, sine);
        let mut add = |weight: f64, turned: f64| {
            sums[0] += weight * turned.cos();
            sums[1] += if turned.cos() < 0.0 { weight } else { 0.0 };
        };
        add(reflectance, std::f64::consts::PI - 2.0 * i);
        let mut weight = (1.0 - reflectance).powi(2);
        for order in 0..60 {
            add(weight, 2.0 * (i - t) + f64::from(order) * (std::f64::consts::PI - 2.0 * t));
            weight *= reflectance;
        }
    }
    sums.map(|sum| sum / f64::from(count))
}

/// One sphere: its mean cosine and its backscattered light are those of the series of Fresnel and Snell.
#[test]
fn a_sphere_has_the_mean_cosine_of_its_series() {
    // Its images are too far away to be met.
    let volume = Volume { volume_fraction: 1e-9, ..spheres(0.0, 10.001) };
    let one = Particles::single([0.0, 0.0, 5.0005], &volume, 1e9);
    let rays = 512;
    let [cosines, backs] = [0, 1].map(|which| {
        let values = (0..REPLICATES).map(|number| {
            let numbers = SampleStream::new(Sampler::Sobol, 6, number);
            let mut sum = 0.0;
            for path in 0..rays {
                let [radius, turn, ..] = numbers.block(path, 0);
                let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
                let place = 5.0 * radius.sqrt();
                let ray = Ray { at: [place * cos, place * sin, 10.001], along: [0.0, 0.0, -1.0] };
                let facets = Facets { index: [MATRIX; 2], coating: &Coating::None };
                let stays = follow(&one, facets, &ray, Side::Above, (&numbers, path), &mut |leaves| {
                    let cosine = -leaves.along[2];
                    let back = f64::from(u8::from(cosine < 0.0));
                    sum += leaves.weight * if which == 0 { cosine } else { back };
                });
                assert_eq!(stays.lost, 0.0);
            }
            sum / rays as f64
        });
        mean_and_error(values)
    });
    let [cosine, back] = by_quadrature(1.7 / MATRIX);
    assert!(cosines.1 < 1e-3 && (cosines.0 - cosine).abs() < 4.0 * cosines.1, "{cosines:?} {cosine}");
    assert!(backs.1 < 1e-3 && (backs.0 - back).abs() < 4.0 * backs.1, "{backs:?} {back}");
}

/// Dense spheres, voids and fibres: nothing is lost, and diffuse light goes down as it comes up.
#[test]
fn volumes_obey_the_laws() {
    let bands = Bands::new([MATRIX; 2]);
    let of = goniometer(&[30.0], 8);
    let fibres = Volume { length_um: 20.0, radius_um: 2.0, ..spheres(0.08, 40.0) };
    let voids = Volume { index: 1.0, ..spheres(0.1, 40.0) };
    let mut scores = Vec::new();
    for volume in [spheres(0.25, 60.0), voids, fibres] {
        let found = replicates(&of, volume);
        let totals = of.totals(&found).unwrap();
        for total in &totals {
            assert!((total.reflected.value + total.transmitted.value - 1.0).abs() < 1e-12, "{total:?}");
            assert!(total.regular_transmitted.value < 0.9 && total.mean_facets.value > 0.3, "{total:?}");
        }
        let differences = found.iter().map(|one| diffuse(&bands, one)).map(|[down, up]| down - up);
        let (mean, error) = mean_and_error(differences);
        scores.push(mean / error);
    }
    assert_student("diffuse transmittance of volumes", &scores, scores.len() as f64);
}

/// Placed particles fill the wanted fraction and keep their distance; a fraction that cannot be placed is
/// refused.
#[test]
fn particles_are_placed_or_refused() {
    let volume = spheres(0.2, 60.0);
    let particles = Particles::new(&volume, 0).unwrap();
    let filled = particles.count() as f64 * volume.particle_um3();
    let all = particles.period_um()[0] * particles.period_um()[1] * 60.0;
    assert!((filled / all - 0.2).abs() < 2.0 * volume.particle_um3() / all);
    // A ray in the matrix meets the outside of a particle, at its radius from the axis.
    let fibres = Volume { length_um: 12.0, radius_um: 2.0, ..spheres(0.1, 40.0) };
    let particles = Particles::new(&fibres, 0).unwrap();
    let ray = Ray { at: [3.0, 4.0, 40.0], along: [0.48, 0.36, -0.8] };
    let Met::Facet { at, normal } = particles.next(&ray, Side::Above) else { panic!("nothing is met") };
    assert!(crate::ray::dot(normal, ray.along) < 0.0 && (2e-9..40.0).contains(&at[2]));
    assert!((particles.distance(at) - 2.0).abs() < 1e-9, "{}", particles.distance(at));
    let message = |volume: Volume| Particles::new(&volume, 0).unwrap_err().to_string();
    assert!(message(spheres(0.5, 60.0)).contains("cannot be placed one by one"));
    assert!(message(spheres(0.1, 9.0)).contains("do not fit"));
    assert!(message(Volume { index: f64::NAN, ..volume }).contains("index of the particles"));
    assert!((volume.size_parameter(1.5, 550.0) - 85.68).abs() < 0.01);
}

/// The grid finds the particle that a search of all finds, and nothing where that finds nothing.
#[test]
fn grids_find_the_nearest_particle() {
    let mut dice = papilio_testing::Dice::new(0x91d, 0);
    let fibres = Volume { length_um: 12.0, radius_um: 2.0, ..spheres(0.03, 40.0) };
    for volume in [spheres(0.02, 60.0), fibres] {
        let particles = Particles::new(&volume, 0).unwrap();
        let period = particles.period_um()[0];
        let mut met = 0;
        for _ in 0..200 {
            // Up to 45 deg: the way through the slab is shorter than a period.
            let (sine, azimuth) = (dice.between(0.0, 0.7), dice.between(0.0, std::f64::consts::TAU));
            let ray = Ray {
                at: [dice.between(0.0, period), dice.between(0.0, period), volume.thickness_um],
                along: [sine * azimuth.cos(), sine * azimuth.sin(), -(1.0 - sine * sine).sqrt()],
            };
            match (particles.next(&ray, Side::Above), particles.way_to_any(&ray)) {
                (Met::Facet { at, .. }, Some(way)) => {
                    let expected = crate::ray::moved(ray.at, way, ray.along);
                    assert!((0..3).all(|k| (at[k] - expected[k]).abs() < 1e-9), "{at:?} {expected:?}");
                    met += 1;
                }
                (found, expected) => {
                    assert!(found == Met::Nothing && expected.is_none(), "{found:?} {expected:?}")
                }
            }
        }
        assert!((20..190).contains(&met), "{met}");
    }
}

#[test]
fn volume_fraction_that_leaves_no_particles_is_refused() {
    let volume = |volume_fraction| Volume {
        radius_um: 1.0,
        length_um: 0.0,
        index: 1.6,
        volume_fraction,
        thickness_um: 20.0,
        seed: 0,
    };
    for fraction in [1e-12, 1e-20, 1e-300] {
        let refused = Particles::new(&volume(fraction), 0).unwrap_err().to_string();
        assert!(refused.contains("volume_fraction"), "{fraction}: {refused}");
    }
    // Few particles are found in few cells.
    assert!(Particles::new(&volume(1e-7), 0).is_ok());
}
