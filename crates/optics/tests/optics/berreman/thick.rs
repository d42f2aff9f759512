//! Thick slabs without fringes.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::berreman::{AnisotropicLayer, Dielectric, Stack, Wave, direction, mueller};
use papilio_optics::interface::fresnel_reflectance;

use super::{NM, layer, normal};

fn thick(layer: AnisotropicLayer) -> AnisotropicLayer {
    AnisotropicLayer { coherent: false, ..layer }
}

/// A pane of glass in air: `2 R/(1 + R)` of s and of p.
#[test]
fn a_pane_of_glass_reflects_the_sum_of_all_orders() {
    let glass = thick(layer(Dielectric::isotropic(1.5.into()).unwrap(), 7e5));
    let stack = Stack { front: 1.0, layers: vec![glass], back: 1.0.into() };
    let wave = Wave { beta: 0.8, ..normal(NM) };
    let found = mueller(&stack, wave).unwrap();
    let film = papilio_optics::film::Film { incidence: 1.0, layers: vec![], substrate: 1.5.into() };
    let both =
        [papilio_optics::film::Polarisation::P, papilio_optics::film::Polarisation::S].map(|polarisation| {
            let r = papilio_optics::film::coherent(&film, NM, 0.8, polarisation).unwrap().reflectance;
            2.0 * r / (1.0 + r)
        });
    assert!((found.r[0][0] - 0.5 * (both[0] + both[1])).abs() < 1e-13, "{found:?}");
    assert!((found.r[0][1] - 0.5 * (both[0] - both[1])).abs() < 1e-13);
    assert!((found.r[0][0] + found.t[0][0] - 1.0).abs() < 1e-13);
    // The mean of both faces without s and p, for comparison: not the same.
    let mean = fresnel_reflectance(1.0, 1.5, 0.8);
    assert!((found.r[0][0] - 2.0 * mean / (1.0 + mean)).abs() > 1e-3);
}

/// Incoherent is the mean over a thickness that varies by many periods of the fringes; here of an absorbing pane over a metal, with an
/// anisotropic film on it. Light that went through more often than that has another phase each time.
#[test]
fn an_incoherent_slab_is_the_mean_over_its_thickness() {
    let film = layer(Dielectric::uniaxial(1.5.into(), 1.9.into(), direction(30.0, 20.0)).unwrap(), 150.0);
    let index = Complex64::new(1.52, 1e-6);
    let glass = |thickness_nm| layer(Dielectric::isotropic(index).unwrap(), thickness_nm);
    let stack = |slab| Stack { front: 1.0, layers: vec![film, slab, film], back: Complex64::new(1.0, 6.0) };
    let wave = Wave { beta: 0.6, azimuth_deg: 40.0, ..normal(NM) };
    let found = mueller(&stack(thick(glass(1e5))), wave).unwrap().r;
    let period = NM / (2.0 * (1.52_f64.powi(2) - 0.36).sqrt());
    let count = 64;
    let mut mean = [[0.0; 4]; 4];
    for k in 0..count {
        // Centred, as the slab absorbs.
        let offset = period * ((f64::from(k) + 0.5) / f64::from(count) - 0.5);
        let one = mueller(&stack(glass(1e5 + offset)), wave).unwrap().r;
        mean.iter_mut().flatten().zip(one.iter().flatten()).for_each(|(sum, m)| *sum += m / f64::from(count));
    }
    for (a, b) in found.iter().flatten().zip(mean.iter().flatten()) {
        assert!((a - b).abs() < 1e-6, "{found:?} {mean:?}");
    }
}

/// A thick retarder keeps the phase between its two waves: without reflections it is the coherent one.
#[test]
fn a_thick_retarder_keeps_its_retardance() {
    let retarder =
        layer(Dielectric::uniaxial(1.5.into(), 1.50001.into(), direction(30.0, 10.0)).unwrap(), 1e7);
    let stack = |slab| Stack { front: 1.5, layers: vec![slab], back: 1.5.into() };
    let wave = Wave { beta: 0.5, azimuth_deg: 10.0, ..normal(NM) };
    let [a, b] = [retarder, thick(retarder)].map(|slab| mueller(&stack(slab), wave).unwrap().t);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a - b).abs() < 1e-5, "{a} {b}");
    }
    // It does retard: by 2 pi dn d/lambda at most.
    assert!(b[1][1] < 0.99 && 1e7 * 1e-5 / NM * 2.0 * PI > 1.0);
}

/// An absorbing slab attenuates by exp(-4 pi k d/(lambda cos)).
#[test]
fn a_thick_absorber_attenuates_by_its_extinction() {
    let index = Complex64::new(1.5, 1e-7);
    let slab = thick(layer(Dielectric::isotropic(index).unwrap(), 1e8));
    let stack = Stack { front: 1.5, layers: vec![slab], back: 1.5.into() };
    let found = mueller(&stack, normal(NM)).unwrap().t[0][0];
    assert!((found - (-4.0 * PI * 1e-7 * 1e8 / NM).exp()).abs() < 1e-9, "{found}");
}
