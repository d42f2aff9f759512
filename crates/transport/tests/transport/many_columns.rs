//! Bases of many states and wavelengths below a scatterer, and many views, by *adding*: their light is
//! computed together. A base of a single wavelength and state, or a single view, is computed alone.

use papilio_optics::lobe::Lobe;
use papilio_optics::rough::{Distribution, Rough};
use papilio_transport::{
    AngularTable, Base, Component, Diffuser, Estimate, Interface, Layer, Medium, Nodes, Reflector, Source,
    Stack,
};

use crate::common::{everyday, sized, view};
use crate::layers::{beam, views};

const BINS: usize = 60;

/// A film with fringes over angle and wavelength, at some of the wavelengths and in some states.
fn film(bins: &[usize], states: &[f64]) -> Base {
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
    let inactive_absorptance = vec![0.01; bins.len()].into();
    Base { reflector: Reflector::Specular(table), inactive_absorptance }
}

fn medium(index: f64, bins: &[usize]) -> Medium {
    Medium::new(vec![index; bins.len()].into())
}

/// The film under rough glass; a gap of air on top, if there is one, conceals from the solver that the rough
/// interface is the surface.
fn display(alpha: f64, air: bool, bins: &[usize], states: &[f64]) -> Stack {
    let rough = Rough::with(Distribution::Ggx, alpha, 1.0, 1.5);
    let mut layers = vec![Layer::new(Interface::Rough(rough), medium(1.5, bins))];
    if air {
        layers.insert(0, Layer::new(Interface::Open, medium(1.0, bins)));
    }
    Stack::general(layers, film(bins, states))
}

/// The film under a cover glass with a diffuser below it and a foil that reflects differently at each
/// wavelength.
fn covered(bins: &[usize], states: &[f64]) -> Stack {
    let reflectance: Vec<f64> = bins.iter().map(|bin| 0.02 + 0.1 * *bin as f64 / BINS as f64).collect();
    let foil = Component { reflectance: reflectance.into(), absorptance: vec![0.01; bins.len()].into() };
    let lobe = Lobe::KCorrelation { width: 0.08 };
    let transmittance = vec![0.9; bins.len()].into();
    let diffuser = Diffuser { lobe, transmittance, regular_fraction: 0.05 };
    let layer = |interface, index| Layer::new(interface, medium(index, bins));
    let layers = vec![
        layer(Interface::Fresnel, 1.5),
        layer(Interface::Component(foil), 1.5),
        layer(Interface::Diffuser(diffuser), 1.0),
        layer(Interface::Fresnel, 1.5),
    ];
    Stack::general(layers, film(bins, states))
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
    for (alpha, air, level) in everyday(2, [(0.1, false, sized(0, 1)), (0.3, true, 0), (0.3, false, 1)]) {
        let together = estimates(level, &display(alpha, air, &all, &states));
        for (bin, state) in everyday(3, [(0, 0), (59, 2), (22, 1), (7, 2), (44, 0)]) {
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

/// Light of several wavelengths is followed in blocks. Orders are counted for the views together, and so is
/// the order from which light is left out that meets the base more than once.
#[test]
fn many_wavelengths_and_views_together_equal_each_alone() {
    let (states, bins): (_, Vec<usize>) = ([0.1, 0.8], (0..BINS).step_by(2).collect());
    // The fourth is in the mirror direction of the beam: it has many more orders than the others.
    let cones = [-60.0, -20.0, 0.0, 20.0, 45.0, 70.0].map(view);
    let sources = [Source::Diffuse, beam(-20.0, 0.0)];
    let stack = covered(&bins, &states);
    let together = views(0, &stack, &cones, &sources);
    for (cone, together) in cones.iter().zip(&together) {
        let alone = &views(0, &stack, &[*cone], &sources)[0];
        let single = &views(0, &covered(&bins[7..8], &states[1..]), &[*cone], &sources)[0];
        let columns = bins.len() * states.len();
        let column = bins.len() + 7;
        for number in 0..=sources.len() {
            let of = |estimate: &Estimate, column| numbers(estimate, column, bins.len())[number];
            // The series of orders ends at 1e-5 of the sum of the magnitudes of all orders at this level.
            let largest = (0..columns).map(|column| of(together, column)).fold(0.0, f64::max);
            for column in 0..columns {
                let (found, alone) = (of(together, column), of(alone, column));
                let what = format!("{cone:?}, column {column}, number {number}: {found} {alone}");
                assert!((found - alone).abs() < 2e-5 * largest, "{what}");
            }
            let (found, single) = (of(together, column), numbers(single, 0, 1)[number]);
            assert!((found - single).abs() < 2e-5 * largest, "{cone:?}, number {number}: {found} {single}");
        }
    }
}
