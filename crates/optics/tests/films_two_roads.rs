//! The fast road against the plain one, on random stacks and at every SIMD level.

#![allow(clippy::unwrap_used, reason = "a test may fail")]

use num_complex::Complex64;
use papilio_optics::film::{
    Film, GapFilm, Layer, Polarisation, SimdLevel, SpectralLayer, Thickness, coherent,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Glass, air, a weak absorber, a metal.
fn medium() -> impl Strategy<Value = Complex64> {
    prop_oneof![
        (0.7..3.0_f64).prop_map(|n| Complex64::new(n, 0.0)),
        Just(Complex64::new(1.0, 0.0)),
        ((0.7..3.0_f64), (-14.0..-1.0_f64)).prop_map(|(n, log_k)| Complex64::new(n, 10.0_f64.powf(log_k))),
        ((0.04..4.0_f64), (0.1..8.0_f64)).prop_map(|(n, k)| Complex64::new(n, k)),
    ]
}

fn layers(thickness_nm: impl Strategy<Value = f64>) -> impl Strategy<Value = Vec<Layer>> {
    let layer = (medium(), thickness_nm).prop_map(|(index, thickness_nm)| Layer { index, thickness_nm });
    prop::collection::vec(layer, 0..5)
}

/// A film, the gaps to try in it, and a direction.
#[derive(Debug)]
struct Case {
    above: Vec<Layer>,
    gap: Complex64,
    below: Vec<Layer>,
    substrate: Complex64,
    n0: f64,
    beta: f64,
    gaps_nm: Vec<f64>,
}

fn case<T: Strategy<Value = f64> + Clone>(
    share: impl Strategy<Value = f64>,
    thickness_nm: T,
) -> impl Strategy<Value = Case> {
    let stack = (layers(thickness_nm.clone()), medium(), layers(thickness_nm.clone()), medium());
    let gaps = prop::collection::vec(thickness_nm, 1..4);
    (stack, 1.0..2.0_f64, share, prop::bool::weighted(0.1), gaps).prop_map(
        |((above, gap, below, substrate), n0, share, grazes_gap, gaps_nm)| {
            let beta = if grazes_gap { gap.re } else { share * n0 };
            Case { above, gap, below, substrate, n0, beta, gaps_nm }
        },
    )
}

/// The mean of s and p on the plain road; 0 where the light does not exist.
fn plain(film: &Film, nm: f64, beta: f64) -> f64 {
    let of = |polarisation| coherent(film, nm, beta, polarisation).map_or(0.0, |c| c.reflectance);
    0.5 * (of(Polarisation::S) + of(Polarisation::P))
}

/// The largest difference between the roads, over 11 wavelengths (more than a register
/// holds, and not a multiple), all gaps and SIMD levels.
fn largest_difference(case: &Case) -> f64 {
    let wavelengths: Vec<f64> = (0..11).map(|i| 380.0 + 40.0 * f64::from(i)).collect();
    let count = wavelengths.len();
    let spectral = |index, thickness| SpectralLayer { index: vec![index; count], thickness };
    let fixed = |layer: &Layer| spectral(layer.index, Thickness::Fixed(layer.thickness_nm));
    let mut stack: Vec<SpectralLayer> = case.above.iter().map(fixed).collect();
    stack.push(spectral(case.gap, Thickness::Gap));
    stack.extend(case.below.iter().map(fixed));
    let fast =
        GapFilm::new(&wavelengths, &vec![case.n0; count], &stack, &vec![case.substrate; count]).unwrap();

    let mut largest = 0.0_f64;
    for level in SimdLevel::available() {
        let mut out = vec![f64::NAN; case.gaps_nm.len() * count];
        fast.clone().with_simd_level(level).reflectance(&[case.beta], &case.gaps_nm, &mut out).unwrap();
        for (&gap_nm, out) in case.gaps_nm.iter().zip(out.chunks_exact(count)) {
            let mut layers = case.above.clone();
            layers.push(Layer { index: case.gap, thickness_nm: gap_nm });
            layers.extend(&case.below);
            let film = Film { incidence: case.n0, layers, substrate: case.substrate };
            for (&fast, &nm) in out.iter().zip(&wavelengths) {
                let difference = (fast - plain(&film, nm, case.beta)).abs();
                assert!(!difference.is_nan(), "{level:?}, {gap_nm} nm, {nm} nm: {fast}");
                largest = largest.max(difference);
            }
        }
    }
    largest
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1000, failure_persistence: None, rng_seed: RngSeed::Fixed(0), ..Default::default() })]

    /// Layers of a display's size, up to 88 deg in the incidence medium. All but
    /// about one in a hundred thousand agree to 1e-12. That one lies next to a guided mode behind an evanescent
    /// barrier: the fast road carries the amplitudes of the incidence medium down through the
    /// barrier, where they all but cancel against the mode, and keeps 1e-16 over the relative
    /// distance to it (the case below). The bound is that of the comparison with `tmm`.
    #[test]
    fn roads_are_equal(case in case(prop_oneof![Just(0.0), 0.0..0.999_f64], prop_oneof![Just(0.0), 0.0..500.0_f64])) {
        let difference = largest_difference(&case);
        prop_assert!(difference < 1e-10, "{difference:e}");
    }

    /// Anything: 100 um of glass, grazing incidence, no light at all. Between grazing
    /// incidence and a thick light guide the finesse reaches 1e5, so that the last bits
    /// of the phase (1e3 rad) count 1e-16 * 1e3 * 1e5.
    #[test]
    fn roads_are_equal_in_resonators_too(
        case in case(
            prop_oneof![0.0..1.1_f64, Just(1.0 - 1e-9)],
            prop_oneof![0.0..1000.0_f64, 1e3..1e5_f64],
        ),
    ) {
        let difference = largest_difference(&case);
        prop_assert!(difference < 1e-8, "{difference:e}");
    }
}

/// A light guide 1e-5 from a mode behind an evanescent barrier: one of the hardest of many random films.
#[test]
fn next_to_a_guided_mode_the_roads_still_agree() {
    let layer = |n: f64, thickness_nm| Layer { index: Complex64::new(n, 0.0), thickness_nm };
    let case = Case {
        above: vec![layer(0.7, 409.86431620061734), layer(1.0, 248.54892670531905)],
        gap: Complex64::new(1.561994369324698, 5.5039783694005076e-14),
        below: vec![layer(1.0, 292.9970170411427)],
        substrate: Complex64::new(0.7, 0.0),
        n0: 1.6423258363121807,
        beta: 1.506256826439489,
        gaps_nm: vec![356.5346759164047],
    };
    let difference = largest_difference(&case);
    assert!(difference < 1e-11, "{difference:e}");
}
