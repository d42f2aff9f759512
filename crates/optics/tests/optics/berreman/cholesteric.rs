//! Cholesteric layers: selective reflection and rotation.

use std::f64::consts::PI;

use papilio_optics::berreman::{Stack, jones, mueller};

use super::{normal, twisted};

const INDICES: [f64; 2] = [1.5, 1.6];
const PITCH_NM: f64 = 355.0;

/// Reflection of a right-handed helix, of right and left circular light, and V of the reflected light per light of each kind.
fn reflected(nm: f64, turns: f64) -> [[f64; 2]; 2] {
    // Clockwise downwards: right-handed.
    let layers = twisted(INDICES, turns * PITCH_NM, -360.0 * turns, 40 * turns as usize);
    let matched = 0.5 * (INDICES[0] + INDICES[1]);
    let m = mueller(&Stack { front: matched, layers, back: matched.into() }, normal(nm)).unwrap().r;
    [1.0, -1.0].map(|v| [m[0][0] + v * m[0][3], m[3][0] + v * m[3][3]])
}

/// Between n_o p and n_e p all light of the handedness of the helix returns and keeps its handedness; none of the
/// other does (P. G. de Gennes, J. Prost, "The Physics of Liquid Crystals", 2nd ed., section 6.1).
#[test]
fn bragg_plateau_reflects_the_handedness_of_the_helix_between_both_indices() {
    let [blue, red] = INDICES.map(|n| n * PITCH_NM);
    for nm in [blue + 6.0, 0.5 * (blue + red), red - 6.0] {
        let [right, left] = reflected(nm, 40.0);
        assert!(right[0] > 0.99 && (right[1] - right[0]).abs() < 0.01, "{nm}: {right:?}");
        assert!(left[0] < 0.005, "{nm}: {left:?}");
    }
    for nm in [blue - 60.0, red + 60.0] {
        let [right, left] = reflected(nm, 40.0);
        assert!(right[0] < 0.1 && left[0] < 0.005, "{nm}: {right:?} {left:?}");
    }
    // In the middle, tanh^2 of the coupling pi dn/(2 n) per half turn (coupled waves, of first order in dn).
    let [right, _] = reflected(0.5 * (blue + red), 10.0);
    let coupling: f64 = PI * (red - blue) / (red + blue) * 20.0;
    assert!((right[0] - coupling.tanh().powi(2)).abs() < 0.01, "{right:?} {coupling}");
}

/// H. de Vries, Acta Cryst. 4, 219 (1951): away from the band, the plane of linear light turns by
/// `2 pi/p a^2/(8 x^2 (1 - x^2))` per length, with `a = (e1 - e2)/(e1 + e2)` and `x = lambda/(n p)`: against the helix
/// where waves are short, with it where they are long. The sense follows from dispersion (Kramers and Kronig): on the red side
/// of the band, the circular light that it reflects is the slower one.
#[test]
fn linear_light_turns_as_de_vries_says() {
    // Little birefringence: his formula is of second order in it.
    let (birefringence, turns) = (0.02, 40.0);
    let n = 1.5_f64;
    let layers =
        twisted([n - birefringence / 2.0, n + birefringence / 2.0], turns * PITCH_NM, -360.0 * turns, 2400);
    let stack = Stack { front: n, layers, back: n.into() };
    for x in [0.6, 0.75, 1.35, 1.6] {
        let nm = x * n * PITCH_NM;
        let t = jones(&stack, normal(nm)).unwrap().t;
        // Circular amplitudes: their phases differ by twice the rotation. Seen from below, this helix turns counter-clockwise.
        let i = num_complex::Complex64::I;
        let [plus, minus] = [i, -i].map(|i| (t[0][0] + t[1][1]) + i * (t[1][0] - t[0][1]));
        let found = 0.5 * (plus / minus).arg();
        let [low, high] = [n - birefringence / 2.0, n + birefringence / 2.0].map(|n| n * n);
        let a: f64 = (high - low) / (high + low);
        let expected = 2.0 * PI * turns * a * a / (8.0 * x * x * (1.0 - x * x));
        assert!((found / -expected - 1.0).abs() < 0.03, "{x}: {found} {expected}");
    }
}
