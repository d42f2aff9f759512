//! Metals and films on facets: closed forms, energy, reciprocity, and published shares of single reflections.

use num_complex::Complex64;
use papilio_optics::film::{Film, Layer, Polarisation, coherent};
use papilio_sampling::{SampleStream, Sampler};
use papilio_testing::{assert_student, mean_and_error};

use crate::bands::Bands;
use crate::goniometer::start;
use crate::laws_tests::{diffuse, kinds};
use crate::path::{Facets, Leaves, follow};
use crate::*;

const INDEX: [f64; 2] = [1.0, 1.5];
const SILVER: Complex64 = Complex64::new(0.06, 3.6);

fn goniometer(coating: Coating, incidence_deg: &[f64], rays: u64) -> Goniometer {
    let [index_above, index_below] = INDEX;
    Goniometer {
        index_above,
        index_below,
        coating,
        incidence_deg: incidence_deg.to_vec(),
        azimuths: None,
        rays,
        seed: 7,
    }
}

fn replicates(of: &Goniometer, surface: &Surface) -> Vec<Replicate> {
    (0..REPLICATES).map(|number| of.replicate(surface, number, &|| false).unwrap()).collect()
}

/// A dielectric film on a thin one of aluminium, which absorbs.
fn layers() -> Vec<Layer> {
    vec![
        Layer { index: Complex64::new(2.3, 0.0), thickness_nm: 60.0 },
        Layer { index: Complex64::new(0.9, 6.4), thickness_nm: 8.0 },
    ]
}

fn absorbing() -> Coating {
    Coating::films(INDEX, &layers(), 550.0).unwrap()
}

/// Reflectance and transmittance of a flat face by the reference of films, the mean of s and p.
fn flat(from: usize, layers: Vec<Layer>, substrate: Complex64, beta: f64) -> [f64; 2] {
    let film = Film { incidence: INDEX[from], layers, substrate };
    let [s, p] = [Polarisation::S, Polarisation::P].map(|one| coherent(&film, 550.0, beta, one).unwrap());
    [0.5 * (s.reflectance + p.reflectance), 0.5 * (s.transmittance + p.transmittance)]
}

/// A flat face with a metal or a film has the closed forms, from both sides.
#[test]
fn coated_flat_faces_have_the_closed_forms() {
    let incidence = [0.0, 30.0, 60.0, 80.0];
    for (coating, is_metal) in [(Coating::Metal { index: SILVER }, true), (absorbing(), false)] {
        let of = goniometer(coating, &incidence, 4);
        let totals = of.totals_alone(&Surface::Flat);
        for total in totals {
            let from = total.from as usize;
            let beta = INDEX[from] * total.theta_deg.to_radians().sin();
            let [reflectance, transmittance] = match (is_metal, from) {
                (true, _) => [flat(from, Vec::new(), SILVER, beta)[0], 0.0],
                (false, 0) => flat(0, layers(), INDEX[1].into(), beta),
                (false, _) => flat(1, layers().into_iter().rev().collect(), INDEX[0].into(), beta),
            };
            assert!((total.reflected.value - reflectance).abs() < 1e-8, "{total:?} {reflectance}");
            assert!((total.transmitted.value - transmittance).abs() < 1e-8, "{total:?} {transmittance}");
            let sum = total.reflected.value + total.transmitted.value + total.absorbed.value;
            // Both are sums over rays, which round.
            assert!((sum - 1.0).abs() < 1e-12 && (total.mean_facets.value - 1.0).abs() < 1e-12, "{total:?}");
            assert!((total.regular_reflected.value - total.reflected.value).abs() < 1e-12);
        }
    }
}

/// Grooves of 90 deg of a grey mirror: light along the normal meets two facets, and rho^2 of it returns,
/// whatever the place.
#[test]
fn grooves_of_a_mirror_return_the_square_of_its_reflectance() {
    let grooves = Surface::Heights(HeightMap::new(2, [1.0; 2], vec![0.0, 1.0]).unwrap());
    let of = goniometer(Coating::Mirror { reflectance: 0.8 }, &[0.0], 16);
    let totals = of.totals_alone(&grooves);
    let above = &totals[0];
    assert!((above.reflected.value - 0.64).abs() < 1e-12, "{above:?}");
    assert!((above.absorbed.value - 0.36).abs() < 1e-12 && above.transmitted.value == 0.0, "{above:?}");
    // 0.2 is absorbed by the first facet, and all other light meets both.
    assert!((above.mean_facets.value - 1.8).abs() < 1e-12, "{above:?}");
}

/// Absorbing films on surfaces of many kinds: nothing is missing, and diffuse light goes down as it comes up.
/// Paths are long enough, in pyramids and spikes, for weights below which light is absorbed by chance.
#[test]
fn absorbing_films_obey_the_laws() {
    let bands = Bands::new(INDEX);
    let of = goniometer(absorbing(), &[0.0, 60.0], 8);
    let mut scores = Vec::new();
    for surface in &kinds()[..11] {
        let found = replicates(&of, surface);
        for total in of.totals(&found).unwrap() {
            let sum = total.reflected.value + total.transmitted.value + total.absorbed.value;
            assert!((sum - 1.0).abs() < 1e-12 && total.absorbed.value > 0.05, "{total:?}");
        }
        let differences = found.iter().map(|one| diffuse(&bands, one)).map(|[down, up]| down - up);
        let (mean, error) = mean_and_error(differences);
        scores.push(mean / error);
    }
    assert_student("diffuse transmittance of absorbing films", &scores, scores.len() as f64);
}

/// The kernel of a face with an absorbing film: its rows sum to 1 - absorptance, and its audit knows what is
/// absorbed.
#[test]
fn kernels_of_absorbing_films_keep_what_is_absorbed() {
    let caps = Caps { pitch_um: 4.5, radius_um: 2.25, aperture_um: 2.25, lattice: Lattice::Square };
    let of = goniometer(absorbing(), &[], 100);
    let kernel = of.kernel(&replicates(&of, &Surface::Caps(caps))).unwrap();
    let row = kernel.scattered.len() / kernel.bands.count();
    for (band, row) in kernel.scattered.chunks_exact(row).enumerate() {
        let regular = kernel.regular_reflected[band] + kernel.regular_transmitted[band];
        let sum = row.iter().sum::<f64>() + regular + kernel.absorbed[band];
        assert!((sum - 1.0).abs() < 1e-6 && kernel.absorbed[band] > 0.05, "{band}: {sum}");
    }
    let known: Vec<f64> = kernel.audit.energy_z.iter().copied().filter(|z| *z != 0.0).collect();
    // Neighbouring bands share rays: a quarter of the scores counts as independent.
    assert_student("energy of bands", &known, 0.25 * known.len() as f64);
    let z = kernel.audit.reciprocity_z_rms;
    assert!((0.8..1.2).contains(&z), "{:?}", kernel.audit);
}

/// Gaussian faces from both sides: reflectances of explicit heights by a separate program (three realisations
/// of 256 x 256, with their standard errors), and those of Heitz's walk over microfacets, whose heights are
/// not correlated and whose reflectances are right to about 2 % of the light that meets several facets, or of
/// R. Fewer rays every day; all in `cargo xtask full`.
#[test]
fn gaussian_heights_reflect_as_smiths_walk_to_two_percent() {
    let walked = [
        (
            0.5,
            [0.0387, 0.0649, 0.0984, 0.8464],
            Some([[0.0395, 0.0002], [0.0668, 0.0010], [0.0982, 0.0038], [0.8417, 0.0037]]),
        ),
        (0.2, [0.0395, 0.0904, 0.0397, 0.9952], None),
    ];
    let rays = 24 * papilio_testing::seeds();
    for (alpha, walked, published) in papilio_testing::everyday(1, walked) {
        let spectrum = Spectrum::Gaussian { rms_um: 5.0 * alpha, correlation_um: 10.0 };
        let surface = Surface::Random(RandomHeights::new(spectrum, 21).unwrap());
        let goniometer = Goniometer {
            index_above: 1.0,
            index_below: 1.5,
            coating: Coating::None,
            incidence_deg: vec![0.0, 60.0],
            azimuths: None,
            rays,
            seed: 4,
        };
        for (at, total) in goniometer.totals_alone(&surface).iter().enumerate() {
            let Measured { value, error } = total.reflected;
            let what = format!("{alpha} {total:?}");
            assert!(error < 0.01, "the test is weak: {what}");
            assert!(
                (value - walked[at]).abs() < 0.02 * walked[at].max(0.1) + 4.0 * error.hypot(0.0008),
                "{what} {}",
                walked[at]
            );
            if let Some([expected, uncertain]) = published.map(|all: [[f64; 2]; 4]| all[at]) {
                assert!((value - expected).abs() < 4.0 * error.hypot(uncertain), "{what} {expected}");
            }
        }
    }
}

/// A Gaussian face of a white metal with alpha 0.5: at 60 deg the share 0.8756(11) meets one facet, by a
/// separate program with three realisations of 256 x 256 heights; Smith's uncorrelated heights have 0.8683.
#[test]
fn light_on_a_white_metal_meets_one_facet_as_often_as_published() {
    let spectrum = Spectrum::Gaussian { rms_um: 2.5, correlation_um: 10.0 };
    let surface = Surface::Random(RandomHeights::new(spectrum, 11).unwrap());
    let white = Coating::Mirror { reflectance: 1.0 };
    let (sine, cosine) = 60_f64.to_radians().sin_cos();
    let rays = 256;
    // Half of the realisations, each of which takes longer than its rays.
    let shares = (0..REPLICATES / 2).map(|number| {
        let numbers = SampleStream::new(Sampler::Sobol, 3, number);
        let mut once = 0.0;
        let trace = |face: &dyn crate::ray::Face| {
            for path in 0..rays {
                let [x, y, azimuth, _] = numbers.block(path, 0);
                let ray = start(face, Side::Above, [sine, cosine], [x, y], azimuth);
                let facets = Facets { index: INDEX, coating: &white };
                let stays = follow(face, facets, &ray, Side::Above, (&numbers, path), &mut |leaves| {
                    let Leaves { side, weight, facets, .. } = leaves;
                    assert_eq!((side, weight), (Side::Above, 1.0));
                    once += f64::from(u8::from(facets == 1));
                });
                assert_eq!((stays.lost, stays.absorbed), (0.0, 0.0));
            }
        };
        surface.with_face(number, trace).unwrap();
        once / rays as f64
    });
    let (mean, error) = mean_and_error(shares);
    assert!(error < 0.01, "the test is weak: {error}");
    assert!((mean - 0.8756).abs() < 4.0 * error.hypot(0.0011), "{mean} {error}");
}
