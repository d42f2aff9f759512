//! Tests of hulls and coverages.

use papilio_testing::{Dice, laws};

use super::*;
use crate::{ColourError, Corners, D65_WHITE, Xyz};

fn xyz([x, y, z]: [f64; 3]) -> Xyz {
    Xyz { x, y, z }
}

fn mixture(states: &[Xyz], weights: &[f64]) -> Xyz {
    let sum: f64 = weights.iter().sum();
    states.iter().zip(weights).fold(xyz([0.0; 3]), |all, (state, weight)| all + *state * (weight / sum))
}

/// The six inks that pimoroni's library `inky` states as sRGB: black, white, yellow, red, blue, green.
fn inks() -> Vec<Xyz> {
    let linear = |byte: u8| {
        let encoded = f64::from(byte) / 255.0;
        if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
    };
    let inks = [[0, 0, 0], [161, 164, 165], [208, 190, 71], [156, 72, 75], [61, 59, 94], [58, 91, 70]];
    inks.map(|ink: [u8; 3]| {
        let [r, g, b] = ink.map(linear);
        xyz([
            0.4124 * r + 0.3576 * g + 0.1805 * b,
            0.2126 * r + 0.7152 * g + 0.0722 * b,
            0.0193 * r + 0.1192 * g + 0.9505 * b,
        ])
    })
    .to_vec()
}

/// Random states with 0 to 3 dimensions.
fn random_states(dice: &mut Dice) -> Vec<Xyz> {
    let dimensions = dice.below(4);
    let mut point = |scale: f64| [0, 1, 2].map(|_| dice.between(0.0, scale));
    let (origin, directions) = (point(1.0), [point(1.0), point(1.0), point(1.0)]);
    dice.several(2..=9, |dice| {
        let weights = [0, 1, 2].map(|k| if k < dimensions { dice.throw() } else { 0.0 });
        xyz([0, 1, 2].map(|i| origin[i] + (0..3).map(|k| weights[k] * directions[k][i]).sum::<f64>()))
    })
}

#[test]
fn hull_of_sub_pixels_has_six_faces_and_that_of_greys_two_ends() {
    let cube: Vec<_> =
        (0..8).map(|on| xyz([0, 1, 2].map(|k| f64::from(u8::from(on >> k & 1 == 1))))).collect();
    let hull = StateHull::new(&cube).unwrap();
    assert_eq!((hull.dimensions(), hull.faces()), (3, 6));
    assert!((hull.excess(xyz([0.5, 0.5, 1.25])) - 0.25).abs() < 1e-15);
    let greys = StateHull::new(&[0.1, 0.4, 0.6].map(|y| D65_WHITE * y)).unwrap();
    assert_eq!((greys.dimensions(), greys.faces()), (1, 2));
    assert!(greys.contains(D65_WHITE * 0.33) && !greys.contains(D65_WHITE * 0.05));
    assert!(!greys.contains(xyz([0.3; 3])));
    let flat = StateHull::new(&[[0.0; 3], [0.6; 3], [0.2, 0.1, 0.05]].map(xyz)).unwrap();
    assert_eq!((flat.dimensions(), flat.faces()), (2, 3));
}

#[test]
fn states_that_cannot_be_mixed_are_refused() {
    assert_eq!(StateHull::new(&[D65_WHITE]), Err(ColourError::States { states: 1 }));
    assert!(StateHull::new(&[D65_WHITE; 65]).is_err() && StateHull::new(&[D65_WHITE; 64]).is_ok());
    assert!(LeastVariance::new(&[D65_WHITE, xyz([f64::NAN, 0.0, 0.0])]).is_err());
    let greys = Corners { xyz: [0, 1, 2, 3, 4, 5, 6, 7].map(|k| D65_WHITE * f64::from(k)) };
    assert_eq!(SubPixels::new(&greys), Err(ColourError::Dependent));
}

/// Mixtures are inside, have coverages that mix them again, and have no more variance than the weights that
/// mixed them. A colour beyond the states is outside, and the nearest colour is inside and, from there, in no
/// direction of a state nearer.
#[test]
fn mixtures_of_random_states_are_inside_and_have_least_variance() {
    let draw = |dice: &mut Dice| {
        let states = random_states(dice);
        let weights: Vec<_> = states.iter().map(|_| dice.throw()).collect();
        (states, weights, [0, 1, 2].map(|_| dice.between(-0.5, 3.0)))
    };
    laws(400, draw, |(states, weights, outside)| {
        let hull = StateHull::new(states).unwrap();
        let colour = mixture(states, weights);
        assert!(states.iter().all(|state| hull.contains(*state)) && hull.contains(colour));
        let found = LeastVariance::new(states).unwrap().coverages(colour).unwrap();
        let ours: Vec<_> = (0..states.len()).map(|k| found.of(k)).collect();
        assert!(mixture(states, &ours).distance(colour) < 1e-8, "{found:?}");
        let sum: f64 = weights.iter().sum();
        let square =
            |weights: &[f64]| -> f64 { weights.iter().zip(states).map(|(w, s)| w * s.y.powi(2)).sum() };
        assert!(square(&ours) < square(weights) / sum + 1e-7, "{found:?}");
        let (outside, white) = (xyz(*outside), xyz([1.0, 1.2, 0.8]));
        let nearest = hull.nearest(outside, white);
        assert!(hull.contains(nearest), "{nearest:?} {}", hull.excess(nearest));
        let scaled = |one: Xyz, other: Xyz| {
            [(one.x - other.x) / white.x, (one.y - other.y) / white.y, (one.z - other.z) / white.z]
        };
        let away = scaled(outside, nearest);
        let nearer = |state: &Xyz| crate::matrix::dot(away, scaled(*state, nearest));
        assert!(hull.contains(outside) || states.iter().all(|state| nearer(state) < 1e-7));
    });
}

/// Least variances of greys between white and black, computed by a general solver of linear programmes
/// (scipy's HiGHS).
#[test]
fn six_inks_mix_greys_with_the_least_variance() {
    let inks = inks();
    let solver = LeastVariance::new(&inks).unwrap();
    for (part, relative) in [(0.5, 0.765), (0.25, 0.715), (0.1, 1.149)] {
        let found = solver.coverages(inks[1] * part).unwrap();
        let mean = part * inks[1].y;
        let variance: f64 = found.iter().map(|(k, coverage)| coverage * (inks[k].y - mean).powi(2)).sum();
        assert!((variance.sqrt() / mean - relative).abs() < 5.1e-4, "{part}: {}", variance.sqrt() / mean);
        if part == 0.5 {
            let [w, r, b, g] = [1, 3, 4, 5].map(|state| found.of(state));
            let expected = [(w, 0.365), (r, 0.070), (b, 0.222), (g, 0.343)];
            assert!(expected.iter().all(|(ours, theirs)| (ours - theirs).abs() < 5.1e-4), "{found:?}");
        }
    }
    assert_eq!(solver.coverages(inks[1] * 1.1), None);
}

#[test]
fn greys_are_mixed_of_their_neighbours() {
    let greys: Vec<_> = [0.02, 0.6, 0.2, 0.4].map(|y| D65_WHITE * y).to_vec();
    let found = LeastVariance::new(&greys).unwrap().coverages(D65_WHITE * 0.25).unwrap();
    assert!((found.of(2) - 0.75).abs() < 1e-12 && (found.of(3) - 0.25).abs() < 1e-12, "{found:?}");
}

#[test]
fn coverages_of_sub_pixels_are_unique_and_mix_the_colour() {
    let (k, r, g, b) = ([0.02, 0.02, 0.03], [0.2, 0.1, 0.03], [0.1, 0.25, 0.06], [0.09, 0.07, 0.4]);
    let corner = |on: usize| {
        let on = |bit: usize| f64::from(u8::from(on >> bit & 1 == 1));
        xyz([0, 1, 2].map(|i| k[i] + on(0) * (r[i] - k[i]) + on(1) * (g[i] - k[i]) + on(2) * (b[i] - k[i])))
    };
    let mut corners = Corners { xyz: [0, 1, 2, 3, 4, 5, 6, 7].map(corner) };
    let sub_pixels = SubPixels::new(&corners).unwrap();
    assert!(sub_pixels.misfit() < 1e-15);
    let drive = [0.3, 0.9, 0.1];
    let ours = sub_pixels.coverages(corners.mix(drive));
    assert!(ours.iter().zip(drive).all(|(o, d)| (o - d).abs() < 1e-14), "{ours:?}");
    assert!(sub_pixels.xyz(drive).distance(corners.mix(drive)) < 1e-15);
    corners.xyz[7] = corners.xyz[7] * 1.1;
    assert!((SubPixels::new(&corners).unwrap().misfit() - 0.1 / 1.1 * 0.43 / 0.38).abs() < 1e-12);
}
