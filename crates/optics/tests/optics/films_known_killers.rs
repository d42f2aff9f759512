//! Cases in which other implementations fail, each with a test of its name, by both implementations.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::film::{
    Coherent, Film, GapFilm, Layer, Polarisation, SimdLevel, SpectralLayer, Thickness, coherent,
};
use papilio_optics::interface::{fresnel_reflectance_p, fresnel_reflectance_s};

const ALUMINIUM: Complex64 = Complex64::new(0.9656, 6.4581);
const NM: f64 = 550.0;

fn layer(index: impl Into<Complex64>, thickness_nm: f64) -> Layer {
    Layer { index: index.into(), thickness_nm }
}

/// Returns s and p, after a check that the fast implementation agrees for every choice of the gap.
fn both(incidence: f64, layers: &[Layer], substrate: impl Into<Complex64>, beta: f64) -> [Coherent; 2] {
    let film = Film { incidence, layers: layers.to_vec(), substrate: substrate.into() };
    let found = [Polarisation::S, Polarisation::P].map(|p| coherent(&film, NM, beta, p).unwrap());
    let mean = 0.5 * (found[0].reflectance + found[1].reflectance);
    for gap in 0..=layers.len() {
        let spectral = |(j, layer): (usize, &Layer)| SpectralLayer {
            index: vec![layer.index],
            thickness: if j == gap { Thickness::Gap } else { Thickness::Fixed(layer.thickness_nm) },
        };
        let stack: Vec<SpectralLayer> = layers.iter().enumerate().map(spectral).collect();
        let gap_nm = layers.get(gap).map_or(0.0, |layer| layer.thickness_nm);
        let fast = GapFilm::new(&[NM], &[incidence], &stack, &[film.substrate]).unwrap();
        for level in SimdLevel::available() {
            let mut out = [f64::NAN];
            fast.clone().with_simd_level(level).reflectance(&[beta], &[gap_nm], &mut out).unwrap();
            assert!((out[0] - mean).abs() < 1e-12, "gap {gap}, {level:?}: {} {mean}", out[0]);
        }
    }
    found
}

fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() < tolerance, "{a} {b}: {:e}", a - b);
}

fn sum(c: &Coherent) -> f64 {
    c.reflectance + c.transmittance + c.absorptance.iter().sum::<f64>()
}

#[test]
fn opaque_metal_neither_overflows_nor_changes_the_reflectance() {
    for beta in [0.0, 0.9, 1.2, 1.4999] {
        let bulk = both(1.5, &[], ALUMINIUM, beta);
        // A millimetre of metal: exp(2 Im delta) would be 1e64000.
        for thickness_nm in [1e3, 1e4, 1e6] {
            let slab = both(1.5, &[layer(ALUMINIUM, thickness_nm)], 1.5, beta);
            for (slab, bulk) in slab.iter().zip(&bulk) {
                assert_close(slab.reflectance, bulk.reflectance, 1e-13);
                assert!(slab.transmittance < 1e-30);
                assert_close(sum(slab), 1.0, 1e-13);
            }
        }
    }
}

#[test]
fn layers_behind_opaque_metal_are_dark_and_harmless() {
    let layers = [layer(ALUMINIUM, 1e6), layer(1.5, 1e3), layer(ALUMINIUM, 1e6), layer(2.0, 100.0)];
    for found in both(1.0, &layers, 1.5, 0.5) {
        assert_eq!(found.transmittance, 0.0);
        assert!(found.t.norm() == 0.0 && found.r.is_finite());
        assert!(found.absorptance[1..].iter().all(|a| a.abs() < 1e-30));
    }
}

#[test]
fn tiny_k_approaches_zero_k() {
    for beta in [0.0, 0.5, 0.99, 1.01, 1.3] {
        let thin = |k: f64| [layer(Complex64::new(1.0, k), 300.0), layer(Complex64::new(2.0, k), 200.0)];
        for substrate in [1.0, 1.5] {
            let none = both(1.5, &thin(0.0), substrate, beta);
            for log_k in [-300, -100, -30, -18, -16, -15, -14] {
                let k = 10.0_f64.powi(log_k);
                let found = both(1.5, &thin(k), Complex64::new(substrate, k), beta);
                // The true absorptance of so small a k: of the order of k times path over wavelength, times
                // the resonance of a waveguide near cut-off.
                let tolerance = 1e-13 + 1e3 * k;
                for (found, none) in found.iter().zip(&none) {
                    assert_close(found.reflectance, none.reflectance, tolerance);
                    assert_close(found.transmittance, none.transmittance, tolerance);
                }
            }
        }
    }
}

#[test]
fn power_into_an_absorbing_substrate_never_exceeds_one() {
    // |t|^2 times the ratio of indices would give more than 1 here.
    for (n, k) in [(0.05, 4.0), (1.0, 1.0), (4.0, 0.1), (0.5, 8.0)] {
        for beta in [0.0, 0.5, 0.9, 0.99] {
            for found in both(1.0, &[layer(1.4, 120.0)], Complex64::new(n, k), beta) {
                assert!((0.0..=1.0).contains(&found.transmittance));
                assert_close(sum(&found), 1.0, 1e-14);
            }
        }
    }
}

/// P. Yeh, "Optical Waves in Layered Media", eq. 4.2: at normal incidence T is Re(n2)/n1 |t|^2.
#[test]
fn transmittance_into_metal_equals_textbook() {
    for found in both(1.5, &[], ALUMINIUM, 0.0) {
        let t = 2.0 * 1.5 / (1.5 + ALUMINIUM);
        assert!((found.t - t).norm() < 1e-15);
        assert_close(found.transmittance, ALUMINIUM.re / 1.5 * t.norm_sqr(), 1e-15);
    }
}

#[test]
fn total_internal_reflection_from_a_dense_medium() {
    for beta in [1.0 + 1e-9, 1.1, 1.3, 1.4999] {
        for layers in [vec![], vec![layer(1.8, 90.0)], vec![layer(1.8, 90.0), layer(1.2, 40.0)]] {
            for found in both(1.5, &layers, 1.0, beta) {
                assert_close(found.reflectance, 1.0, 1e-13);
                assert_eq!(found.transmittance, 0.0);
            }
        }
    }
}

/// Frustrated total reflection, closed form: S. Zhu et al., Am. J. Phys. 54, 601 (1986), eq. 3-5.
#[test]
fn tunnelling_through_an_evanescent_gap_equals_its_closed_form() {
    let (n, beta) = (1.5_f64, 1.2_f64);
    let (q, kappa) = ((n * n - beta * beta).sqrt(), (beta * beta - 1.0).sqrt());
    for gap_nm in [0.0, 10.0, 100.0, 500.0, 3000.0] {
        let sinh = (2.0 * PI * kappa * gap_nm / NM).sinh();
        for (found, ratio) in
            both(n, &[layer(1.0, gap_nm)], n, beta).iter().zip([q / kappa, q / (kappa * n * n)])
        {
            let a = 0.25 * (ratio + 1.0 / ratio).powi(2);
            let transmitted = 1.0 / (1.0 + a * sinh * sinh);
            assert_close(found.transmittance, transmitted, 1e-14);
            assert_close(found.reflectance, 1.0 - transmitted, 1e-13);
        }
    }
}

#[test]
fn thick_evanescent_gap_does_not_overflow() {
    for found in both(1.5, &[layer(1.0, 1e9)], ALUMINIUM, 1.4) {
        assert_close(found.reflectance, 1.0, 1e-13);
    }
}

/// A layer whose own index equals beta: sin(delta)/q is 0/0. The closed form of its limit, for s between
/// equal media, is T = 1/(1 + (q k0 d/2)^2).
#[test]
fn light_grazing_inside_layer_equals_closed_form() {
    let beta = 1.5 * 60.0_f64.to_radians().sin();
    let q = (1.5 * 1.5 - beta * beta).sqrt();
    let depth = 2.0 * PI / NM * 100.0;
    let [s, p] = both(1.5, &[layer(beta, 100.0)], 1.5, beta);
    assert_close(s.transmittance, 1.0 / (1.0 + (0.5 * q * depth).powi(2)), 1e-13);
    let eta = q / 2.25;
    assert_close(p.transmittance, 1.0 / (1.0 + (0.5 * beta * beta * depth * eta).powi(2)), 1e-13);
    for found in [s, p] {
        assert_close(sum(&found), 1.0, 1e-14);
    }
    for around in [beta * (1.0 - 1e-9), beta * (1.0 + 1e-9)] {
        let near = both(1.5, &[layer(around, 100.0), layer(beta, 50.0)], 1.5, beta);
        let at = both(1.5, &[layer(beta, 150.0)], 1.5, beta);
        assert_close(near[0].reflectance, at[0].reflectance, 1e-7);
    }
    // A gap of that index directly under glass of that index, and a substrate too.
    both(1.5, &[layer(beta, 10.0), layer(beta, 20.0)], beta, beta);
}

#[test]
fn grazing_incidence_reflects_everything() {
    let grazing = 1.0 - f64::EPSILON;
    for substrate in [Complex64::from(1.5), ALUMINIUM] {
        for found in both(1.0, &[layer(1.4, 100.0)], substrate, grazing) {
            assert!(found.reflectance > 1.0 - 1e-6 && found.reflectance <= 1.0 + 1e-15);
        }
    }
}

#[test]
fn layers_of_zero_thickness_change_nothing() {
    let bare = both(1.0, &[layer(2.0, 80.0)], ALUMINIUM, 0.7);
    let with = both(1.0, &[layer(ALUMINIUM, 0.0), layer(2.0, 80.0), layer(1.0, 0.0)], ALUMINIUM, 0.7);
    for (a, b) in bare.iter().zip(&with) {
        assert_close(a.reflectance, b.reflectance, 1e-15);
    }
}

#[test]
fn film_without_layers_equals_fresnel() {
    for (n1, n2) in [(1.0, 1.5), (1.5, 1.0), (1.33, 1.33)] {
        for i in 0..100 {
            let beta = n1 * f64::from(i) / 100.0;
            let [s, p] = both(n1, &[], n2, beta);
            assert_close(s.reflectance, fresnel_reflectance_s(n1, n2, beta), 1e-14);
            assert_close(p.reflectance, fresnel_reflectance_p(n1, n2, beta), 1e-14);
        }
    }
}

#[test]
fn light_that_cannot_exist_is_refused_or_zero() {
    let film = Film { incidence: 1.5, layers: vec![], substrate: 1.0.into() };
    for beta in [1.5, 2.0, -0.1, f64::NAN, f64::INFINITY] {
        assert!(coherent(&film, NM, beta, Polarisation::S).is_err());
    }
    // The incidence medium is dispersive: at 1.51 light exists only in the blue.
    let fast = GapFilm::new(&[450.0, 650.0], &[1.53, 1.51], &[], &[1.0.into(); 2]).unwrap();
    let mut out = [f64::NAN; 2];
    fast.reflectance(&[1.51], &[0.0], &mut out).unwrap();
    assert_eq!(out, [1.0, 0.0]);
    assert!(fast.reflectance(&[f64::NAN], &[0.0], &mut out).is_err());
}

#[test]
fn hundreds_of_layers_of_metal_and_glass_stay_finite() {
    let pair = [layer(ALUMINIUM, 15.0), layer(1.5, 90.0)];
    let layers: Vec<Layer> = pair.iter().cycle().take(200).copied().collect();
    for beta in [0.0, 0.7, 0.999] {
        for found in both(1.0, &layers, 1.5, beta) {
            assert!((0.0..=1.0).contains(&found.reflectance));
        }
    }
}

#[test]
fn invalid_films_are_refused() {
    let good = || SpectralLayer { index: vec![1.5.into(); 2], thickness: Thickness::Fixed(10.0) };
    let new = |layers: &[SpectralLayer]| GapFilm::new(&[400.0, 500.0], &[1.0; 2], layers, &[1.5.into(); 2]);
    assert!(new(&[good()]).is_ok());
    assert!(new(&[SpectralLayer { thickness: Thickness::Fixed(-1.0), ..good() }]).is_err());
    assert!(new(&[SpectralLayer { thickness: Thickness::Fixed(f64::NAN), ..good() }]).is_err());
    assert!(new(&[SpectralLayer { index: vec![1.5.into()], ..good() }]).is_err());
    assert!(new(&[SpectralLayer { index: vec![Complex64::new(1.5, -1e-3); 2], ..good() }]).is_err());
    assert!(new(&[SpectralLayer { index: vec![Complex64::ZERO; 2], ..good() }]).is_err());
    let gap = || SpectralLayer { thickness: Thickness::Gap, ..good() };
    assert!(new(&[gap(), gap()]).is_err());
    assert!(GapFilm::new(&[0.0], &[1.0], &[], &[1.5.into()]).is_err());
    assert!(GapFilm::new(&[400.0], &[-1.0], &[], &[1.5.into()]).is_err());
    let film = new(&[gap()]).unwrap();
    assert!(film.reflectance(&[0.0], &[f64::NAN], &mut [0.0; 2]).is_err());
    assert!(film.reflectance(&[0.0], &[100.0], &mut [0.0; 3]).is_err());
    assert!(film.reflectance(&[], &[], &mut []).is_ok());
}
