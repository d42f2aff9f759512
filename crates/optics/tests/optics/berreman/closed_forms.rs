//! Layers whose answer is a closed form or a published value.

use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;
use papilio_optics::berreman::{AnisotropicLayer, Dielectric, Stack, Wave, axes, jones, mueller};
use papilio_optics::film::{Film, Layer, Polarisation, coherent};
use papilio_testing::{Dice, laws, sized};

use super::{MIRROR, NM, layer, normal, plate, twisted};

/// Isotropic layers are those of [`papilio_optics::film`], to rounding: amplitudes, s and p apart.
#[test]
fn isotropic_stacks_equal_films() {
    let medium = |dice: &mut Dice| match dice.below(3) {
        0 => Complex64::new(dice.between(0.7, 3.0), 0.0),
        1 => Complex64::new(dice.between(0.7, 3.0), dice.log_between(1e-9, 0.1)),
        _ => Complex64::new(dice.between(0.04, 4.0), dice.between(0.1, 8.0)),
    };
    let case = |dice: &mut Dice| {
        let one = |dice: &mut Dice| Layer { index: medium(dice), thickness_nm: dice.between(0.0, 800.0) };
        let layers = dice.several(0..=5, one);
        let film = Film { incidence: dice.between(1.0, 2.0), layers, substrate: medium(dice) };
        let beta = dice.between(0.0, 0.999) * film.incidence;
        (film, Wave { wavelength_nm: NM, beta, azimuth_deg: dice.between(0.0, 360.0) })
    };
    laws(sized(150, 2000), case, |(film, wave)| {
        let one = |l: &Layer| layer(Dielectric::isotropic(l.index).unwrap(), l.thickness_nm);
        let layers: Vec<AnisotropicLayer> = film.layers.iter().map(one).collect();
        let found = jones(&Stack { front: film.incidence, layers, back: film.substrate }, *wave).unwrap();
        let r = [Polarisation::P, Polarisation::S].map(|p| coherent(film, NM, wave.beta, p).unwrap());
        let expected = [[r[0].r, 0.0.into()], [0.0.into(), r[1].r]];
        for (found, expected) in found.r.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).norm() < 1e-12, "{found} {expected}");
        }
        let powers = [found.r[0][0].norm_sqr(), found.r[1][1].norm_sqr()];
        assert!((powers[0] - r[0].reflectance).abs() < 1e-12 && (powers[1] - r[1].reflectance).abs() < 1e-12);
        let t = mueller_transmittance(film, wave);
        assert!((t - 0.5 * (r[0].transmittance + r[1].transmittance)).abs() < 1e-12, "{t}");
    });
}

fn mueller_transmittance(film: &Film, wave: &Wave) -> f64 {
    let one = |l: &Layer| layer(Dielectric::isotropic(l.index).unwrap(), l.thickness_nm);
    let stack =
        Stack { front: film.incidence, layers: film.layers.iter().map(one).collect(), back: film.substrate };
    mueller(&stack, *wave).unwrap().t[0][0]
}

/// Half of the light is polarised along x, passes a retarder at 45 deg to a mirror and again on its return: cos^2 of
/// the retardance of it is left. Values of a zero-order film of 550 nm, flat, with the dispersion of polycarbonate, and reversed;
/// and with the axis off by a few degrees.
#[test]
fn circular_polariser_over_a_mirror_leaves_the_square_of_the_cosine() {
    // Weakly anisotropic and thick: no light comes back from the faces between the layers.
    let reflectance = |nm: f64, retardance_nm: f64, off_deg: f64| {
        let polariser = plate([1.5.into(), Complex64::new(1.5, 2e-5)], 90.0, 3e7);
        let retarder = plate([1.5.into(), 1.50002.into()], 45.0 + off_deg, retardance_nm / 0.00002);
        let stack = Stack { front: 1.5, layers: vec![polariser, retarder], back: MIRROR };
        mueller(&stack, normal(nm)).unwrap().r[0][0]
    };
    let quarter = NM / 4.0;
    for (nm, expected) in [(450.0, 0.058_489), (550.0, 0.0), (650.0, 0.028_636)] {
        let found = reflectance(nm, quarter, 0.0);
        let retardance = 2.0 * PI * quarter / nm;
        assert!((found - 0.5 * retardance.cos().powi(2)).abs() < 1e-5, "{nm}: {found}");
        assert!((found - expected).abs() < 1e-5, "{nm}: {found}");
    }
    for (off_deg, expected) in [(1.0, 0.000_609), (3.0, 0.005_463), (5.0, 0.015_077)] {
        let found = reflectance(NM, quarter, off_deg);
        assert!((found - expected).abs() < 1e-5, "{off_deg}: {found}");
    }
}

/// C. H. Gooch, H. A. Tarry, J. Phys. D 8, 1575 (1975): a cell of 90 deg between parallel polarisers.
#[test]
fn twisted_nematic_transmits_as_gooch_and_tarry() {
    let birefringence = 1e-4;
    let transmittance = |over_wavelength: f64| {
        let thickness_nm = over_wavelength * NM / birefringence;
        let layers = twisted([1.5, 1.5 + birefringence], thickness_nm, 90.0, 400);
        let t = jones(&Stack { front: 1.5, layers, back: 1.5.into() }, normal(NM)).unwrap().t;
        // p of the light that leaves is along x, as the first polariser.
        t[0][0].norm_sqr()
    };
    let root = [3.0_f64, 15.0, 35.0].map(|square| 0.5 * square.sqrt());
    assert!((root[0] - 0.866_025).abs() < 1e-6 && (root[1] - 1.936_492).abs() < 1e-6);
    for minimum in root {
        assert!(transmittance(minimum) < 1e-6, "{minimum}: {}", transmittance(minimum));
    }
    for (over_wavelength, expected) in [(0.25, 0.772_812_97), (0.5, 0.316_563_84), (1.0, 0.026_263_11)] {
        let found = transmittance(over_wavelength);
        let u: f64 = 2.0 * over_wavelength;
        let closed = (FRAC_PI_2 * (1.0 + u * u).sqrt()).sin().powi(2) / (1.0 + u * u);
        assert!((closed - expected).abs() < 1e-8);
        assert!((found - expected).abs() < 2e-5, "{over_wavelength}: {found}");
    }
}

/// P. Yeh, C. Gu, "Optics of Liquid Crystal Displays", chapter 4: the matrix of a cell and its transpose.
#[test]
fn reflective_twisted_nematic_equals_jones_matrices() {
    let birefringence = 1e-4;
    let reflectance = |twist_deg: f64, over_wavelength: f64| {
        let layers =
            twisted([1.5, 1.5 + birefringence], over_wavelength * NM / birefringence, twist_deg, 400);
        let r = jones(&Stack { front: 1.5, layers, back: MIRROR }, normal(NM)).unwrap().r;
        r[0][0].norm_sqr()
    };
    let closed = |twist_deg: f64, over_wavelength: f64| {
        let (phi, half) = (twist_deg.to_radians(), PI * over_wavelength);
        let x = phi.hypot(half);
        let (a, c) = (Complex64::new(x.cos(), -half * x.sin() / x), -phi * x.sin() / x);
        (a * a + c * c).norm_sqr()
    };
    let dark = 90.0 / 2.0_f64.sqrt();
    assert!(closed(dark, 0.125_f64.sqrt()) < 1e-12);
    assert!(reflectance(dark, 0.125_f64.sqrt()) < 1e-6, "{}", reflectance(dark, 0.125_f64.sqrt()));
    for (twist_deg, over_wavelength, expected) in [(90.0, 0.5, 0.599_149_35), (90.0, 0.25, 0.402_760_11)] {
        assert!((closed(twist_deg, over_wavelength) - expected).abs() < 1e-8);
        for sense in [1.0, -1.0] {
            let found = reflectance(sense * twist_deg, over_wavelength);
            assert!((found - expected).abs() < 1e-4, "{twist_deg}, {over_wavelength}: {found}");
        }
    }
    // Not twisted, director at 45 deg.
    let ecb = plate([1.5.into(), (1.5 + birefringence).into()], 45.0, 0.3 * NM / birefringence);
    let r = jones(&Stack { front: 1.5, layers: vec![ecb], back: MIRROR }, normal(NM)).unwrap().r;
    assert!((r[0][0].norm_sqr() - (2.0 * PI * 0.3).cos().powi(2)).abs() < 1e-4);
}

/// Dark cell of n 1.5 and 1.6 over aluminium: |r_pp|^2, |r_sp|^2 and |r_ss|^2 of two other programs, which agree to six digits
/// (one multiplies matrix exponentials, the other is pyElli 0.23.1).
#[test]
fn twisted_cell_over_aluminium_equals_other_programs_to_six_digits() {
    let twist_deg = 90.0 / 2.0_f64.sqrt();
    let thickness_nm = NM * 0.125_f64.sqrt() / 0.1;
    for (theta_deg, expected) in [
        (0.0_f64, [0.001_517, 0.874_156, 0.001_045]),
        (30.0, [0.003_834, 0.871_455, 0.002_900]),
        (60.0, [0.027_135, 0.847_920, 0.024_599]),
    ] {
        for sense in [1.0, -1.0] {
            let layers = twisted([1.5, 1.6], thickness_nm, sense * twist_deg, 400);
            let stack = Stack { front: 1.5, layers, back: Complex64::new(0.9656, 6.4581) };
            let wave = Wave { beta: theta_deg.to_radians().sin(), ..normal(NM) };
            let r = jones(&stack, wave).unwrap().r;
            let found = [r[0][0], r[1][0], r[1][1]].map(|r| r.norm_sqr());
            let equal = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6);
            assert!(equal, "{theta_deg}: {found:?} {expected:?}");
        }
    }
}

/// The conventions: azimuths counter-clockwise as seen by the viewer, V > 0 clockwise as seen by whoever receives the light.
#[test]
fn a_quarter_wave_plate_at_45_deg_makes_right_circular_light_below() {
    let quarter = plate([1.5.into(), 1.5001.into()], 45.0, NM / 4.0 / 0.0001);
    let stack = Stack { front: 1.5, layers: vec![quarter], back: 1.5.into() };
    let found = jones(&stack, normal(NM)).unwrap().t;
    // The receiver below sees the slow axis at -45 deg: s lags by a quarter period behind -p.
    let s_over_p = found[1][0] / found[0][0];
    assert!((s_over_p + Complex64::I).norm() < 1e-3, "{s_over_p}");
    let stokes = mueller(&stack, normal(NM)).unwrap().t;
    assert!((stokes[3][0] + stokes[3][1] - 1.0).abs() < 1e-3, "{stokes:?}");
    // Turned with the light, the plate acts the same: azimuths of waves and of axes turn in one sense.
    let turned = Stack { layers: vec![plate([1.5.into(), 1.5001.into()], 75.0, NM / 4.0 / 0.0001)], ..stack };
    let again = jones(&turned, Wave { azimuth_deg: 30.0, ..normal(NM) }).unwrap().t;
    assert!((again[1][0] / again[0][0] + Complex64::I).norm() < 1e-3);
}

/// A positive tilt raises the end of the director at its azimuth: light that travels along its azimuth downwards
/// meets it more across, light that travels back meets it more along, where the index is ordinary.
#[test]
fn a_tilted_director_is_seen_along_its_axis_from_its_azimuth() {
    let axis = papilio_optics::berreman::direction(0.0, 45.0);
    let tilted = layer(Dielectric::uniaxial(1.5.into(), 1.6.into(), axis).unwrap(), 1000.0);
    let stack = Stack { front: 1.5, layers: vec![tilted], back: 1.5.into() };
    let retardance = |azimuth_deg: f64| {
        let t = jones(&stack, Wave { beta: 1.5 * 0.5, azimuth_deg, ..normal(NM) }).unwrap().t;
        (t[0][0] / t[1][1]).arg().abs()
    };
    // Light that travels to the azimuth 180 goes down at 30 deg from the normal, 15 deg from the director.
    let (along, across) = (retardance(180.0), retardance(0.0));
    assert!(along < 0.3 * across, "{along} {across}");
}

/// A biaxial crystal whose axes are exchanged in name only.
#[test]
fn principal_axes_may_be_named_in_any_order() {
    let [a, b, c] = axes(20.0, 30.0, 40.0);
    let [x, y, z] = [1.5, 1.6, 1.7].map(Complex64::from);
    let stack = |indices, axes| {
        let layers = vec![layer(Dielectric::biaxial(indices, axes).unwrap(), 700.0)];
        jones(&Stack { front: 1.0, layers, back: 1.5.into() }, Wave { beta: 0.6, ..normal(NM) }).unwrap()
    };
    let difference = stack([x, y, z], [a, b, c]).r[0][1] - stack([z, x, y], [c, a, b]).r[0][1];
    assert!(difference.norm() < 1e-14);
}
