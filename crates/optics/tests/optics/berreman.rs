//! Berreman's 4x4 method: closed forms, published values, laws, and two independent programs.

mod cholesteric;
mod closed_forms;
mod laws;
mod reference;
mod spectral;
mod thick;

use num_complex::Complex64;
use papilio_optics::berreman::{AnisotropicLayer, Dielectric, Stack, Wave, axes, direction, slices};
use papilio_testing::Dice;

const NM: f64 = 550.0;

/// Index of a mirror that reflects all light, to 1e-5 of the phase.
const MIRROR: Complex64 = Complex64::new(0.0, 1e6);

fn layer(dielectric: Dielectric, thickness_nm: f64) -> AnisotropicLayer {
    AnisotropicLayer { dielectric, thickness_nm, coherent: true }
}

/// Uniaxial layer with its axis in the panel.
fn plate([n_o, n_e]: [Complex64; 2], azimuth_deg: f64, thickness_nm: f64) -> AnisotropicLayer {
    layer(Dielectric::uniaxial(n_o, n_e, direction(azimuth_deg, 0.0)).unwrap(), thickness_nm)
}

/// Normal incidence, with p along x.
fn normal(wavelength_nm: f64) -> Wave {
    Wave { wavelength_nm, beta: 0.0, azimuth_deg: 0.0 }
}

/// Twisted layer of a liquid crystal, azimuth 0 at the top.
fn twisted([n_o, n_e]: [f64; 2], thickness_nm: f64, twist_deg: f64, count: usize) -> Vec<AnisotropicLayer> {
    slices([n_o.into(), n_e.into()], thickness_nm, count, |depth| papilio_optics::berreman::Director {
        azimuth_deg: twist_deg * depth,
        tilt_deg: 0.0,
    })
    .unwrap()
}

/// A tensor of any symmetry and orientation; `loss` scales its extinction.
fn any_dielectric(dice: &mut Dice, loss: f64) -> Dielectric {
    let index = |dice: &mut Dice| Complex64::new(dice.between(1.0, 2.5), loss * dice.between(0.0, 0.5));
    let mut indices = [index(dice), index(dice), index(dice)];
    match dice.below(4) {
        0 => indices[1] = indices[0],
        1 => indices = [indices[0]; 3],
        _ => {}
    }
    let turned = axes(dice.between(0.0, 360.0), dice.between(-90.0, 90.0), dice.between(0.0, 360.0));
    Dielectric::biaxial(indices, turned).unwrap()
}

/// Stack of up to six layers, with a light that enters it.
fn any_case(dice: &mut Dice, loss: f64) -> (Stack, Wave) {
    let one = |dice: &mut Dice| layer(any_dielectric(dice, loss), dice.between(0.0, 900.0));
    let layers = dice.several(0..=6, one);
    let stack = Stack { front: dice.between(1.0, 2.0), layers, back: dice.between(1.0, 2.5).into() };
    let beta = dice.between(0.0, 0.999) * stack.front;
    (stack, Wave { wavelength_nm: dice.between(380.0, 780.0), beta, azimuth_deg: dice.between(0.0, 360.0) })
}
