//! Laws of all films, on random stacks: energy, reciprocity, splitting a layer.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use num_complex::Complex64;
use papilio_optics::film::{Coherent, Film, Layer, Polarisation, absorbed, coherent};
use papilio_testing::{Dice, laws};

const NM: f64 = 550.0;

/// Glass, a weak absorber, a metal.
fn medium(dice: &mut Dice) -> Complex64 {
    match dice.below(3) {
        0 => Complex64::new(dice.between(0.7, 3.0), 0.0),
        1 => Complex64::new(dice.between(0.7, 3.0), dice.log_between(1e-9, 0.1)),
        _ => Complex64::new(dice.between(0.04, 4.0), dice.between(0.1, 8.0)),
    }
}

/// A film and a wave in it.
#[derive(Debug)]
struct Case {
    film: Film,
    beta: f64,
    polarisation: Polarisation,
}

/// Returns a case with this range of layers, each up to this thickness; up to 87 deg in the incidence
/// medium.
fn case(dice: &mut Dice, layers: RangeInclusive<usize>, thickest_nm: f64) -> Case {
    let layer = |dice: &mut Dice| Layer { index: medium(dice), thickness_nm: dice.between(0.0, thickest_nm) };
    let layers = dice.several(layers, layer);
    let film = Film { incidence: dice.between(1.0, 2.0), layers, substrate: medium(dice) };
    let beta = dice.between(0.0, 0.999) * film.incidence;
    Case { film, beta, polarisation: dice.of([Polarisation::S, Polarisation::P]) }
}

fn solve(film: &Film, beta: f64, polarisation: Polarisation) -> Coherent {
    coherent(film, NM, beta, polarisation).unwrap()
}

/// Returns the absorption of a layer by Joule's law: k0 Im(eps) times the integral of |E|^2, over the
/// incident flux. The field inside is found by cutting the layer into slices; Simpson's rule integrates it.
fn joule(film: &Film, j: usize, beta: f64, polarisation: Polarisation) -> f64 {
    const SLICES: usize = 1000;
    let Layer { index, thickness_nm } = film.layers[j];
    let slice = Layer { index, thickness_nm: thickness_nm / SLICES as f64 };
    let mut cut = film.clone();
    cut.layers.splice(j..=j, std::iter::repeat_n(slice, SLICES));
    let fields = solve(&cut, beta, polarisation).fields;
    let eps = index * index;
    let squared = |i: usize| {
        let field = fields[j + i];
        match polarisation {
            Polarisation::S => field.u.norm_sqr(),
            // E along the layers is V; perpendicular to them it is beta H/eps.
            Polarisation::P => field.v.norm_sqr() + (field.u * beta / eps).norm_sqr(),
        }
    };
    let weight = |i: usize| match i {
        0 | SLICES => 1.0,
        i if i % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let integral: f64 = (0..=SLICES).map(|i| weight(i) * squared(i)).sum::<f64>() * slice.thickness_nm / 3.0;
    let q0 = (film.incidence * film.incidence - beta * beta).sqrt();
    let eta0 = match polarisation {
        Polarisation::S => q0,
        Polarisation::P => q0 / (film.incidence * film.incidence),
    };
    2.0 * PI / NM * eps.im * integral / eta0
}

/// The absorptances are differences of Poynting fluxes; here they are compared with the field inside the
/// layers. Simpson's error, (2 k0 k h)^4/180 of the absorptance for slices h, is 5e-8 at most in layers of
/// up to 300 nm.
#[test]
fn reflected_transmitted_and_absorbed_sum_to_one() {
    laws(
        300,
        |dice| case(dice, 0..=3, 300.0),
        |Case { film, beta, polarisation }| {
            let found = solve(film, *beta, *polarisation);
            let absorbed: f64 = (0..film.layers.len()).map(|j| joule(film, j, *beta, *polarisation)).sum();
            assert!((found.reflectance + found.transmittance + absorbed - 1.0).abs() < 1e-7);
            for (j, &absorptance) in found.absorptance.iter().enumerate() {
                let joule = joule(film, j, *beta, *polarisation);
                assert!((absorptance - joule).abs() < 1e-7, "layer {j}: {absorptance} {joule}");
            }
            assert!(found.reflectance <= 1.0 + 1e-12 && found.transmittance >= 0.0);
            assert!((found.r.norm_sqr() - found.reflectance).abs() < 1e-15);
        },
    );
}

/// The sums are exact, with absorbing substrates, metals and evanescent fields; the reflectance is |r|^2.
#[test]
fn absorptances_of_layers_and_substrate_sum_to_one_minus_reflectance() {
    laws(
        300,
        |dice| case(dice, 0..=6, 300.0),
        |Case { film, beta, polarisation }| {
            let found = solve(film, *beta, *polarisation);
            let sum = found.absorptance.iter().sum::<f64>() + found.transmittance;
            assert!((sum + found.reflectance - 1.0).abs() < 1e-12, "{sum} {}", found.reflectance);
            let both = absorbed(film, NM, *beta).unwrap();
            let sum = both.layers.iter().sum::<f64>() + both.substrate;
            assert!((sum + both.reflectance - 1.0).abs() < 1e-12, "{sum} {}", both.reflectance);
            let [s, p] = [Polarisation::S, Polarisation::P].map(|one| solve(film, *beta, one));
            for (layer, absorptance) in both.layers.iter().enumerate() {
                let mean = 0.5 * (s.absorptance[layer] + p.absorptance[layer]);
                assert!((absorptance - mean).abs() < 1e-12 && *absorptance >= -1e-14);
            }
        },
    );
}

#[test]
fn transmittance_is_the_same_from_both_sides() {
    let draw = |dice: &mut Dice| {
        let mut case = case(dice, 0..=4, 500.0);
        let (n0, n1) = (case.film.incidence, dice.between(1.0, 2.0));
        case.film.substrate = n1.into();
        case.beta *= n0.min(n1) / n0;
        case
    };
    laws(300, draw, |Case { film: down, beta, polarisation }| {
        let layers = down.layers.iter().rev().copied().collect();
        let up = Film { incidence: down.substrate.re, layers, substrate: down.incidence.into() };
        let (down, up) = (solve(down, *beta, *polarisation), solve(&up, *beta, *polarisation));
        assert!((down.transmittance - up.transmittance).abs() < 1e-12);
    });
}

#[test]
fn split_layer_equals_whole_layer() {
    let draw = |dice: &mut Dice| {
        let case = case(dice, 1..=4, 500.0);
        let layer = dice.below(case.film.layers.len());
        (case, layer, dice.throw())
    };
    laws(300, draw, |(Case { film, beta, polarisation }, j, cut)| {
        let Layer { index, thickness_nm } = film.layers[*j];
        let mut split = film.clone();
        split.layers[*j].thickness_nm = cut * thickness_nm;
        split.layers.insert(j + 1, Layer { index, thickness_nm: thickness_nm - cut * thickness_nm });
        let (whole, split) = (solve(film, *beta, *polarisation), solve(&split, *beta, *polarisation));
        assert!((whole.r - split.r).norm() < 1e-12);
        assert!((whole.t - split.t).norm() < 1e-12);
        let halves = split.absorptance[*j] + split.absorptance[j + 1];
        assert!((whole.absorptance[*j] - halves).abs() < 1e-12);
    });
}
