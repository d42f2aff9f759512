//! The virtual goniometer against closed forms, published values and laws.

use crate::*;

const GLASS: f64 = 1.5;

fn measured(surface: &Surface, incidence_deg: &[f64], rays: u64) -> Vec<Total> {
    let goniometer = Goniometer {
        index_above: 1.0,
        index_below: GLASS,
        incidence_deg: incidence_deg.to_vec(),
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

/// Feng's hemispheres, side by side on squares: values of a separate program. Their standard errors are 1e-3; three of them are allowed.
#[test]
fn hemispheres_are_those_of_a_separate_program() {
    let caps = Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice: Lattice::Square };
    let totals = measured(&Surface::Caps(caps), &[0.0, 30.0, 41.0, 60.0, 75.0], 400);
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
