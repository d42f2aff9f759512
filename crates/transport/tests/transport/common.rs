//! Small stacks, and their results by Monte Carlo.

use papilio_sampling::{SampleStream, Sampler};
use papilio_spectra::Spectrum;
pub(crate) use papilio_testing::{assert_unbiased, assert_unbiased_over, everyday, mean_and_error, sized};
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Base, Cone, Estimate, Front, Medium, Nodes, Panel, Reflector, Source, Stack, Top,
};

pub(crate) const REPLICATES: u64 = 32;

/// One wavelength, one state.
pub(crate) fn one(value: f64) -> Spectrum {
    vec![value].into()
}

pub(crate) fn mirror(reflectance: f64) -> Base {
    let table = AngularTable {
        nodes: Nodes::Constant,
        basis: vec![reflectance].into(),
        mixture: vec![1.0],
        common: vec![0.0],
    };
    Base { reflector: Reflector::Specular(table), inactive_absorptance: one(0.0) }
}

pub(crate) fn lambertian(reflectance: f64) -> Base {
    Base { reflector: Reflector::Lambertian(vec![reflectance]), inactive_absorptance: one(0.0) }
}

/// A panel in glass of index 1.5 without front.
pub(crate) fn panel(top: Top, base: Base) -> Panel {
    Panel { front: Front::none(1), top, medium: Medium::new(one(1.5)), base, single_pass: false }
}

/// A front of screen from components (R, A).
pub(crate) fn front(components: &[(f64, f64)], first_order: bool) -> Front {
    let components = components.iter().map(|(r, a)| (std::slice::from_ref(r), std::slice::from_ref(a)));
    if first_order { Front::first_order(1, components) } else { Front::exact(1, components) }
}

pub(crate) fn view(theta_deg: f64) -> Cone {
    Cone::new(theta_deg, 0.0, 0.0, 1.0)
}

/// Estimates of 32 replicates.
pub(crate) fn replicates(
    stack: &Panel,
    view: Cone,
    sources: &[Source],
    seed: u64,
    paths: u64,
    sampler: Sampler,
) -> Vec<Estimate> {
    replicates_of(&Stack::Panel(stack.clone()), view, sources, seed, paths, sampler)
}

/// The same for a display in either form.
pub(crate) fn replicates_of(
    stack: &Stack,
    view: Cone,
    sources: &[Source],
    seed: u64,
    paths: u64,
    sampler: Sampler,
) -> Vec<Estimate> {
    let walk = Walk::new(stack, view, sources);
    let traced = (0..REPLICATES).map(|stream| {
        let mut replicate = walk.replicate();
        walk.trace(&mut replicate, &SampleStream::new(sampler, seed, stream), paths);
        replicate
    });
    // Together, as in a run: replicates correct each other's noise.
    walk.estimates(&traced.collect::<Vec<_>>())
}

/// Total reflectance factor of the first wavelength and state under source `i`.
pub(crate) fn rho(estimate: &Estimate, i: usize) -> f64 {
    estimate.rho[i].via_pixel[0] + estimate.rho[i].front[0]
}
