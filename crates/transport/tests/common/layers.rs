//! General stacks in few words, and what adding sees of them.

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_transport::adding::Kernel;
use papilio_transport::{
    Base, Cone, Diffuser, Estimate, Interface, Layer, Layered, Medium, Scattering, Source, Stack,
};

use crate::common::one;

pub(crate) fn clear(index: f64) -> Medium {
    Medium::new(one(index))
}

pub(crate) fn slab(thickness: f64, anisotropy: f64, albedo: f64, index: f64) -> Medium {
    let albedo = one(albedo);
    clear(index).with_scattering(Scattering { optical_thickness: thickness, anisotropy, albedo })
}

pub(crate) fn stack<const N: usize>(layers: [(Interface, Medium); N], base: Base) -> Stack {
    let layers = layers.into_iter().map(|(interface, medium)| Layer { interface, medium }).collect();
    Stack::Layered(Layered { layers, base })
}

pub(crate) fn diffuser(width: f64, transmittance: f64, straight_through: f64) -> Interface {
    let lobe = Lobe::KCorrelation { width };
    Interface::Diffuser(Diffuser { lobe, transmittance: one(transmittance), straight_through })
}

pub(crate) fn sheet(reflectance: f64, absorptance: f64) -> Interface {
    Interface::Sheet { reflectance: one(reflectance), absorptance: one(absorptance) }
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
