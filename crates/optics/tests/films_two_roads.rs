//! The fast road against the plain one, on random stacks and at every SIMD level.

use num_complex::Complex64;
use papilio_optics::film::{
    Film, GapFilm, Layer, Polarisation, SimdLevel, SpectralLayer, Thickness, coherent,
};
use proptest::prelude::*;

/// A medium at two wavelengths: glass, dilute, weak absorber, metal.
fn medium() -> impl Strategy<Value = Complex64> {
    prop_oneof![
        (0.7..3.0_f64).prop_map(|n| Complex64::new(n, 0.0)),
        Just(Complex64::new(1.0, 0.0)),
        ((0.7..3.0_f64), (-14.0..-1.0_f64)).prop_map(|(n, log_k)| Complex64::new(n, 10.0_f64.powf(log_k))),
        ((0.04..4.0_f64), (0.1..8.0_f64)).prop_map(|(n, k)| Complex64::new(n, k)),
    ]
}

fn layers() -> impl Strategy<Value = Vec<(Complex64, f64)>> {
    prop::collection::vec((medium(), prop_oneof![Just(0.0), 1.0..500.0_f64, 1e3..1e5_f64]), 0..5)
}

/// The mean of s and p on the plain road; 0 where the light does not exist.
fn plain(film: &Film, nm: f64, beta: f64) -> f64 {
    let of = |polarisation| coherent(film, nm, beta, polarisation).map_or(0.0, |c| c.reflectance);
    0.5 * (of(Polarisation::S) + of(Polarisation::P))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn gap_film_equals_coherent(
        above in layers(),
        gap in medium(),
        below in layers(),
        substrate in medium(),
        n0 in 1.0..2.0_f64,
        share in prop_oneof![Just(0.0), 0.0..1.1_f64, Just(1.0 - 1e-9)],
        gaps in prop::collection::vec(prop_oneof![Just(0.0), 0.0..1000.0_f64, 1e3..1e5_f64], 1..4),
        at_gap_index in prop::bool::weighted(0.1),
    ) {
        let wavelengths: Vec<f64> = (0..11).map(|i| 380.0 + 40.0 * f64::from(i)).collect();
        let count = wavelengths.len();
        let beta = if at_gap_index { gap.re } else { share * n0 };
        let spectral = |&(index, nm): &(Complex64, f64)| SpectralLayer { index: vec![index; count], thickness: Thickness::Fixed(nm) };
        let mut stack: Vec<SpectralLayer> = above.iter().map(spectral).collect();
        stack.push(SpectralLayer { index: vec![gap; count], thickness: Thickness::Gap });
        stack.extend(below.iter().map(spectral));
        let fast = GapFilm::new(&wavelengths, &vec![n0; count], &stack, &vec![substrate; count]).unwrap();
        for level in SimdLevel::available() {
            let fast = fast.clone().with_simd_level(level);
            let mut out = vec![f64::NAN; gaps.len() * count];
            fast.reflectance(&[beta], &gaps, &mut out).unwrap();
            for (g, &gap_nm) in gaps.iter().enumerate() {
                let all = above.iter().copied().chain([(gap, gap_nm)]).chain(below.iter().copied());
                let layers = all.map(|(index, thickness_nm)| Layer { index, thickness_nm }).collect();
                let film = Film { incidence: n0, layers, substrate };
                for (w, &nm) in wavelengths.iter().enumerate() {
                    let (fast, plain) = (out[g * count + w], plain(&film, nm, beta));
                    prop_assert!((fast - plain).abs() < 1e-12, "{level:?} {nm} nm: {fast} {plain} {:e}", fast - plain);
                }
            }
        }
    }
}
