//! A rough surface over flat layers and a specular or Lambertian base, which *adding* treats by product
//! integration.

use std::cell::RefCell;
use std::collections::HashMap;

use papilio_optics::rough::{Distribution, Rough};
use papilio_sampling::Sampler;
use papilio_transport::{Base, Cone, Interface, Layer, Source, Stack};

use crate::common::*;
use crate::layers::*;

fn surface(distribution: Distribution, alpha: f64, base: Base) -> Stack {
    stack([(Interface::Rough(Rough::with(distribution, alpha, 1.0, 1.5)), clear(1.5))], base)
}

/// The same display with a gap of air on top, which the solver does not recognise as one with a rough
/// surface.
fn below_air(stack: &Stack) -> Stack {
    let mut layers = stack.layers().to_vec();
    layers.insert(0, Layer::new(Interface::Open, clear(1.0)));
    Stack::general(layers, stack.base().clone())
}

/// Normal and oblique views, one of them in the mirror direction of the beam.
const VIEWS_DEG: [f64; 3] = [8.0, 20.0, 60.0];

fn sources() -> [Source; 3] {
    [Source::Diffuse, beam(-20.0, 0.0), Source::Disc(Cone::new(45.0, 90.0, 3.0, 1.0))]
}

/// Two roads: product integration on a coarse grid, and a fine grid that resolves both lobes. That grid
/// converges slowly for light refracted along the interface, which matters where a view sees faint light: its
/// levels are compared, too.
#[test]
fn surface_equals_a_grid_that_resolves_its_lobes() {
    let student = Distribution::StudentT { tail: 2.7 };
    let cases =
        [(Distribution::Ggx, 0.1), (student, 0.25), (Distribution::Beckmann, 0.15), (Distribution::Ggx, 0.4)];
    for (distribution, alpha) in everyday(2, cases) {
        for base in [mirror(0.8), lambertian(0.6)] {
            let coarse = surface(distribution, alpha, base);
            let cones = VIEWS_DEG.map(view);
            let found = views(2, &coarse, &cones, &sources());
            let [before, truths] = [1, 2].map(|level| views(level, &below_air(&coarse), &cones, &sources()));
            for (((found, truth), before), theta) in found.iter().zip(&truths).zip(&before).zip(VIEWS_DEG) {
                for source in 0..3 {
                    let what = format!("{distribution:?} {alpha}, {theta} deg, source {source}");
                    let [found, before] = [found, before].map(|one| rho(one, source) / rho(truth, source));
                    // Largest for the disc that a view at 60 deg sees far from its mirror direction.
                    assert_close(&format!("{what}: levels of the reference"), before, 1.0, 1e-3);
                    // The same disc is far out in the tail: the absolute error is that of GGX, the light is a quarter.
                    let is_faint = source == 2 && distribution == student;
                    assert_close(&what, found, 1.0, if is_faint { 1e-3 } else { 3e-4 });
                }
                let books = [&found.ledger, &truth.ledger].map(|l| [l.returned[0], l.pixel[0]]);
                assert_close("returned", books[0][0], books[1][0], 3e-5);
                assert_close("absorbed in the pixel", books[0][1], books[1][1], 3e-5);
            }
        }
    }
}

/// The stated error is four times the difference of two levels. A number of azimuthal orders, or of
/// directions around two narrow lobes, that is too small at both levels would not show in it.
#[test]
fn surface_has_the_error_of_two_levels() {
    for alpha in everyday(2, [0.1, 0.3, 0.04]) {
        let stack = surface(Distribution::Ggx, alpha, mirror(0.9));
        let cones = VIEWS_DEG.map(view);
        let [a, b, truth] = [0, 1, sized(2, 3)].map(|level| views(level, &stack, &cones, &sources()));
        for (number, theta) in VIEWS_DEG.iter().enumerate() {
            for source in 0..3 {
                let [a, b, truth] = [&a, &b, &truth].map(|all| rho(&all[number], source));
                let error = 4.0 * (b - a).abs() + 2e-5 * truth;
                assert!((b - truth).abs() < error, "{alpha}, {theta} deg, source {source}: {a} {b} {truth}");
            }
        }
    }
}

/// A nearly flat surface over a mirror, against random paths. Rare ones carry the light of source 2: few
/// seeds do not find enough of them.
#[test]
fn narrow_surface_equals_monte_carlo() {
    let stack = surface(Distribution::Ggx, 0.02, mirror(0.9));
    let sources = sources();
    // First the mirror direction of the beam.
    for theta in everyday(1, [20.0, 60.0, 8.0]) {
        // The noise of the paths is larger than the error of level 1.
        let truth = estimate(sized(1, 2), &stack, view(theta), &sources);
        let runs = RefCell::new(HashMap::new());
        for source in 0..sources.len() {
            let what = format!("{theta} deg, source {source}");
            assert_unbiased_over(16, &what, rho(&truth, source), 0.5, |seed| {
                let mut runs = runs.borrow_mut();
                let estimates = runs.entry(seed).or_insert_with(|| {
                    replicates_of(&stack, view(theta), &sources, seed, 256, Sampler::Sobol)
                });
                mean_and_error(estimates.iter().map(|estimate| rho(estimate, source)))
            });
        }
    }
}
