//! Constructors of general stacks, and their results by adding.

use std::cell::RefCell;
use std::collections::HashMap;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::Sampler;
use papilio_transport::adding::Kernel;
use papilio_transport::{
    Base, Component, Cone, Diffuser, Estimate, Interface, Layer, Medium, Scattering, Source, Stack,
};

use crate::common::{assert_unbiased, mean_and_error, one, replicates_of, sized};

pub(crate) fn clear(index: f64) -> Medium {
    Medium::new(one(index))
}

pub(crate) fn slab(thickness: f64, anisotropy: f64, albedo: f64, index: f64) -> Medium {
    let albedo = one(albedo);
    clear(index).with_scattering(Scattering::unpolarised(thickness, anisotropy, albedo))
}

pub(crate) fn stack<const N: usize>(layers: [(Interface, Medium); N], base: Base) -> Stack {
    let layers = layers.into_iter().map(|(interface, medium)| Layer::new(interface, medium)).collect();
    Stack::general(layers, base)
}

pub(crate) fn diffuser(width: f64, transmittance: f64, regular_fraction: f64) -> Interface {
    let lobe = Lobe::KCorrelation { width };
    Interface::Diffuser(Diffuser { lobe, transmittance: one(transmittance), regular_fraction })
}

pub(crate) fn sheet(reflectance: f64, absorptance: f64) -> Interface {
    Interface::Component(Component { reflectance: one(reflectance), absorptance: one(absorptance) })
}

pub(crate) fn beam(theta_deg: f64, phi_deg: f64) -> Source {
    Source::Beam(Beta::from_source(theta_deg, phi_deg, 1.0))
}

pub(crate) fn views(level: u32, stack: &Stack, views: &[Cone], sources: &[Source]) -> Vec<Estimate> {
    let mut kernel = Kernel::new(level);
    kernel.prepare(stack, views, sources);
    (0..views.len()).map(|view| kernel.estimate(stack, view)).collect()
}

pub(crate) fn estimate(level: u32, stack: &Stack, view: Cone, sources: &[Source]) -> Estimate {
    views(level, stack, &[view], sources).remove(0)
}

pub(crate) fn assert_close(what: &str, found: f64, truth: f64, tolerance: f64) {
    assert!((found - truth).abs() <= tolerance, "{what}: {found} against {truth}");
}

/// Asserts that the Monte Carlo results of each state under each kind of source scatter about those of
/// adding, and that the ledgers close. Each seed is traced once.
pub(crate) fn assert_monte_carlo_agrees(name: &str, stack: &Stack, states: usize, paths: u64) {
    let sources = [Source::Diffuse, beam(-25.0, 0.0), Source::Disc(Cone::new(40.0, 90.0, 5.0, 1.0))];
    let eye = Cone::new(12.0, 0.0, 0.5, 1.0);
    // The noise of the paths is larger than the error of level 1, which is below 1e-3.
    let truth = estimate(sized(1, 2), stack, eye, &sources);
    let runs = RefCell::new(HashMap::new());
    for (source, state) in (0..sources.len()).flat_map(|source| (0..states).map(move |state| (source, state)))
    {
        let seen = |e: &Estimate| e.rho[source].via_pixel[state] + e.rho[source].front[0];
        let what = format!("{name}, source {source}, state {state}");
        assert_unbiased(&what, seen(&truth), 0.1, |seed| {
            let mut runs = runs.borrow_mut();
            let estimates = runs
                .entry(seed)
                .or_insert_with(|| replicates_of(stack, eye, &sources, seed, paths, Sampler::Sobol));
            for l in estimates.iter().map(|estimate| &estimate.ledger) {
                let taken = l.front[0] + l.diffuser[0] + l.glass[0] + l.pixel[0] + l.inactive[0];
                assert_close(name, l.returned[0] + taken + l.unaccounted[0], 1.0, 1e-12);
            }
            mean_and_error(estimates.iter().map(seen))
        });
    }
}
