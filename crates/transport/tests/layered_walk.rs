//! The general tracer: against the panel's tracers, published slabs and the laws of light.

mod common;

use common::*;
use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::Sampler;
use papilio_spectra::Spectrum;
use papilio_transport::{
    Base, Cone, Diffuser, Interface, Layer, Layered, Medium, Panel, Scattering, Source, Stack, Top,
};

fn layered(layers: Vec<Layer>, base: Base) -> Stack {
    Stack::Layered(Layered { layers, base })
}

fn layer(interface: Interface, medium: Medium) -> Layer {
    Layer { interface, medium }
}

fn clear(index: f64) -> Medium {
    Medium::new(one(index))
}

fn slab(index: f64, optical_thickness: f64, anisotropy: f64, albedo: f64) -> Medium {
    clear(index).with_scattering(Scattering { optical_thickness, anisotropy, albedo: one(albedo) })
}

/// A slab under air, with Fresnel's face where the index changes.
fn under_air(medium: Medium) -> Layer {
    let interface = if medium.constant_index() == Some(1.0) { Interface::Open } else { Interface::Fresnel };
    layer(interface, medium)
}

/// A slab of index 1 (optical thickness, anisotropy, albedo) over a base.
fn check(what: &str, stack: &Stack, from: Cone, source: Source, paths: u64, truth: f64) {
    for sampler in [Sampler::Random, Sampler::Sobol] {
        assert_unbiased(&format!("{what}, {sampler:?}"), truth, 0.05, |seed| {
            let estimates = replicates_of(stack, from, &[source], seed, paths, sampler);
            mean_and_error(estimates.iter().map(|e| rho(e, 0)))
        });
    }
}

/// Hemispherical reflectances of slabs over black: by reciprocity, diffuse light seen
/// from that direction.
#[test]
fn index_matched_slabs() {
    for (albedo, tau, g, normal, oblique) in [
        (0.9, 1.0, 0.0, 0.267410, 0.393662),
        (0.9, 4.0, 0.0, 0.408142, 0.504093),
        (0.9, 1.0, 0.75, 0.055947, 0.171039),
        (0.99, 1.0, 0.9, 0.025123, 0.110993),
        (1.0, 0.5, 0.9, 0.012376, 0.058414),
        (1.0, 1.0, 0.75, 0.078740, 0.240480),
        (1.0, 8.0, 0.9, 0.250996, 0.475303),
    ] {
        let stack = layered(vec![under_air(slab(1.0, tau, g, albedo))], mirror(0.0));
        for (theta_deg, truth) in [(0.0, normal), (60.0, oblique)] {
            let what = format!("slab {albedo} {tau} {g} from {theta_deg}");
            check(&what, &stack, view(theta_deg), Source::Diffuse, 256, truth);
        }
    }
}
