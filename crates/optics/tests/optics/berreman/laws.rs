//! Laws of all anisotropic stacks: energy, reciprocity, splitting a layer.

use num_complex::Complex64;
use papilio_optics::berreman::{Jones, Stack, Wave, jones, mueller};
use papilio_testing::{Dice, laws, sized};

use super::{any_case, any_dielectric, layer};

/// q of a transparent medium, 0 where the wave does not travel.
fn vertical(index: f64, beta: f64) -> f64 {
    (index * index - beta * beta).max(0.0).sqrt()
}

fn backwards(wave: Wave) -> Wave {
    Wave { azimuth_deg: wave.azimuth_deg + 180.0, ..wave }
}

fn power(jones: &Jones, column: usize) -> f64 {
    jones[0][column].norm_sqr() + jones[1][column].norm_sqr()
}

#[test]
fn lossless_stacks_conserve_energy() {
    laws(
        sized(150, 1000),
        |dice: &mut Dice| any_case(dice, 0.0),
        |(stack, wave)| {
            let found = jones(stack, *wave).unwrap();
            let over = vertical(stack.back.re, wave.beta) / vertical(stack.front, wave.beta);
            for column in 0..2 {
                let sum = power(&found.r, column) + over * power(&found.t, column);
                assert!((sum - 1.0).abs() < 1e-12, "{sum}");
                if over > 0.0 {
                    let sum = power(&found.r_below, column) + power(&found.t_up, column) / over;
                    assert!((sum - 1.0).abs() < 1e-12, "from below: {sum}");
                }
            }
            let powers = mueller(stack, *wave).unwrap();
            assert!((powers.r[0][0] + powers.t[0][0] - 1.0).abs() < 1e-12);
        },
    );
}

/// Helmholtz: light sent back along its path with its polarisation reversed. The frame (p, s, travel) of the reversed wave has s
/// reversed, so that the matrix becomes its transpose with two signs.
#[test]
fn reversed_light_returns_with_reversed_polarisation() {
    for loss in [0.0, 0.3] {
        laws(
            sized(100, 1000),
            |dice: &mut Dice| any_case(dice, loss),
            |(stack, wave)| {
                let (there, back) = (jones(stack, *wave).unwrap(), jones(stack, backwards(*wave)).unwrap());
                let q = [vertical(stack.front, wave.beta), vertical(stack.back.re, wave.beta)];
                for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
                    let sign = if row == column { 1.0 } else { -1.0 };
                    let difference = there.r[row][column] - sign * back.r[column][row];
                    assert!(difference.norm() < 1e-12, "r {row}{column}: {difference}");
                    if q[1] > 0.0 {
                        let difference = there.t[row][column] * q[1] - sign * back.t_up[column][row] * q[0];
                        assert!(difference.norm() < 1e-12, "t {row}{column}: {difference}");
                    }
                }
            },
        );
    }
}

#[test]
fn splitting_a_layer_changes_nothing() {
    laws(
        sized(60, 500),
        |dice: &mut Dice| (any_case(dice, 0.3), dice.throw(), dice.throw()),
        |case| {
            let ((stack, wave), which, at) = case;
            let mut split = stack.clone();
            if stack.layers.is_empty() {
                return;
            }
            let k = (which * stack.layers.len() as f64) as usize;
            let [upper, lower] = [*at, 1.0 - at]
                .map(|part| layer(stack.layers[k].dielectric, part * stack.layers[k].thickness_nm));
            split.layers.splice(k..=k, [upper, lower]);
            let (whole, parts) = (jones(stack, *wave).unwrap(), jones(&split, *wave).unwrap());
            for (a, b) in
                whole.r.iter().chain(&whole.t).flatten().zip(parts.r.iter().chain(&parts.t).flatten())
            {
                assert!((a - b).norm() < 1e-12, "{a} {b}");
            }
        },
    );
}

/// Layers of any thickness: a millimetre of metal or of an absorbing crystal has no light behind it, and a finite answer.
#[test]
fn thick_absorbing_layers_do_not_overflow() {
    let mut dice = Dice::new(3, 0);
    for _ in 0..20 {
        let thick = layer(any_dielectric(&mut dice, 1.0), 1e6);
        let stack = |thickness_nm| Stack {
            front: 1.0,
            layers: vec![layer(thick.dielectric, thickness_nm)],
            back: Complex64::new(1.0, 5.0),
        };
        let wave = Wave { wavelength_nm: 550.0, beta: 0.7, azimuth_deg: dice.between(0.0, 360.0) };
        let [one, two] = [1e6, 2e6].map(|nm| jones(&stack(nm), wave).unwrap());
        for (a, b) in one.r.iter().flatten().zip(two.r.iter().flatten()) {
            assert!((a - b).norm() < 1e-10 && a.is_finite(), "{a} {b}");
        }
        assert!(power(&two.t, 0) < 1e-30);
    }
}

/// Wave, tensors and axes in special position: grazing in a layer (q = 0), along an optic axis, equal indices.
#[test]
fn degenerate_layers_are_limits_of_others() {
    let stack = |dielectric, beta: f64| {
        let found = jones(
            &Stack { front: 1.6, layers: vec![layer(dielectric, 300.0)], back: 1.7.into() },
            Wave { wavelength_nm: 550.0, beta, azimuth_deg: 25.0 },
        );
        found.unwrap().r
    };
    use papilio_optics::berreman::{Dielectric, direction};
    let isotropic = |n: f64| Dielectric::isotropic(n.into()).unwrap();
    let near = |a: Jones, b: Jones| {
        a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).norm() < 1e-6 && a.is_finite())
    };
    // Grazing: beta equal to the index of the layer.
    assert!(near(stack(isotropic(1.5), 1.5), stack(isotropic(1.5), 1.5 - 1e-9)));
    let axial = |tilt_deg| Dielectric::uniaxial(1.5.into(), 1.7.into(), direction(205.0, tilt_deg)).unwrap();
    // Along the optic axis inside: beta = n_o sin(90 - tilt).
    let beta = 1.5 * 40.0_f64.to_radians().cos();
    assert!(near(stack(axial(40.0), beta), stack(axial(40.0 + 1e-8), beta)));
    assert!(near(stack(axial(90.0), 0.0), stack(axial(90.0), 1e-9)));
}
