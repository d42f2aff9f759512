//! Bases of many states and wavelengths below a rough interface by *adding*: their light is computed together. A base of
//! a single wavelength and state is computed alone.

use papilio_optics::rough::{Distribution, Rough};
use papilio_transport::{
    AngularTable, Base, Estimate, Interface, Layer, Layered, Medium, Nodes, Reflector, Source, Stack,
};

use crate::common::view;
use crate::layers::{beam, views};

const BINS: usize = 60;

/// A film with fringes over angle and wavelength under rough glass, at some of the wavelengths and in some states; a gap of
/// air on top, if there is one, conceals from the solver that the rough interface is the surface.
fn display(alpha: f64, air: bool, bins: &[usize], states: &[f64]) -> Stack {
    let fringe = |cosine: f64, x: f64, phase: f64| 0.5 + 0.45 * (9.0 * cosine / (0.6 + x) + phase).cos();
    let mut basis = Vec::new();
    for cosine in (0..65).map(|k| f64::from(k) / 64.0) {
        for phase in [0.0, 1.4] {
            basis.extend(bins.iter().map(|bin| fringe(cosine, *bin as f64 / BINS as f64, phase)));
        }
    }
    let table = AngularTable {
        nodes: Nodes::Cosines(65),
        basis: basis.into(),
        mixture: states.iter().flat_map(|share| [*share, 0.9 - share]).collect(),
        common: vec![0.02; bins.len()],
    };
    let medium = |index: f64| Medium::new(vec![index; bins.len()].into());
    let rough = Rough::with(Distribution::Ggx, alpha, 1.0, 1.5);
    let mut layers = vec![Layer { interface: Interface::Rough(rough), medium: medium(1.5) }];
    if air {
        layers.insert(0, Layer { interface: Interface::Open, medium: medium(1.0) });
    }
    let inactive_absorptance = vec![0.01; bins.len()].into();
    let base = Base { reflector: Reflector::Specular(table), inactive_absorptance };
    Stack::Layered(Layered { layers, base })
}

fn estimates(level: u32, stack: &Stack) -> Vec<Estimate> {
    let sources = [Source::Diffuse, beam(-35.0, 0.0), beam(50.0, 100.0)];
    views(level, stack, &[0.0, 20.0, 65.0].map(view), &sources)
}

/// Returns the reflectance factors of a column, then what the pixel absorbs.
fn numbers(estimate: &Estimate, column: usize, bins: usize) -> Vec<f64> {
    let seen = estimate.rho.iter().map(|rho| rho.via_pixel[column] + rho.front[column % bins]);
    seen.chain([estimate.ledger.pixel[column]]).collect()
}

#[test]
fn many_states_and_wavelengths_together_equal_each_alone() {
    let states = [0.1, 0.5, 0.8];
    let all: Vec<usize> = (0..BINS).collect();
    for (alpha, air, level) in [(0.1, false, 1), (0.3, false, 1), (0.3, true, 0)] {
        let together = estimates(level, &display(alpha, air, &all, &states));
        for (bin, state) in [(0, 0), (7, 2), (22, 1), (44, 0), (59, 2)] {
            let alone = estimates(level, &display(alpha, air, &[bin], &[states[state]]));
            for (together, alone) in together.iter().zip(&alone) {
                let found = numbers(together, state * BINS + bin, BINS);
                for (number, (found, alone)) in found.iter().zip(numbers(alone, 0, 1)).enumerate() {
                    let what = format!("alpha {alpha}, air {air}, bin {bin}, state {state}, number {number}");
                    // Light is iterated to 1e-7 of the largest density.
                    let largest =
                        (0..BINS * states.len()).map(|column| numbers(together, column, BINS)[number]);
                    let largest = largest.fold(0.0, f64::max);
                    assert!((found - alone).abs() < 1e-6 * largest, "{what}: {found} {alone}");
                }
            }
        }
    }
}
