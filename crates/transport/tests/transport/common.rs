//! Small stacks, and their results by Monte Carlo.

use papilio_sampling::{SampleStream, Sampler};
use papilio_spectra::Spectrum;
pub(crate) use papilio_testing::{assert_unbiased, assert_unbiased_over, everyday, mean_and_error, sized};
use papilio_transport::walk::Walk;
use papilio_transport::{
    AngularTable, Approximation, Base, Component, Cone, Estimate, Interface, Layer, Medium, Nodes, Reflector,
    Source, Stack, Top,
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
    Base { reflector: Reflector::lambertian(vec![reflectance], 1), inactive_absorptance: one(0.0) }
}

/// An ordinary panel, which tests change part by part; [`Self::stack`] writes it as layers.
#[derive(Debug, Clone)]
pub(crate) struct Panel {
    pub(crate) front: Front,
    pub(crate) top: Top,
    pub(crate) medium: Medium,
    pub(crate) base: Base,
    pub(crate) single_pass: bool,
}

/// Components of a front of screen, outermost first.
#[derive(Debug, Clone)]
pub(crate) struct Front(Vec<Component>);

impl Front {
    pub(crate) fn none() -> Self {
        Self(Vec::new())
    }

    pub(crate) fn is_none(&self) -> bool {
        self.0.is_empty()
    }

    /// A front of components (R, A), by wavelength.
    pub(crate) fn of<'a>(components: impl IntoIterator<Item = (&'a [f64], &'a [f64])>) -> Self {
        let spectrum = |values: &[f64]| Spectrum::from(values.to_vec());
        let component = |(reflectance, absorptance)| Component {
            reflectance: spectrum(reflectance),
            absorptance: spectrum(absorptance),
        };
        Self(components.into_iter().map(component).collect())
    }
}

impl Panel {
    /// The stack of its layers, which is an ordinary panel for both solvers.
    pub(crate) fn stack(&self) -> Stack {
        let air = Medium::new(vec![1.0; self.base.bins()].into());
        let in_air = |one: &Component| Layer::new(Interface::Component(one.clone()), air.clone());
        let interface = match &self.top {
            Top::IdealAr => Interface::IdealAr,
            Top::Fresnel(index) => {
                assert_eq!(index, self.medium.index(), "the face is that of the medium");
                Interface::Fresnel
            }
            Top::Diffuser(diffuser) => Interface::Diffuser(diffuser.clone()),
        };
        let mut layers: Vec<Layer> = self.front.0.iter().map(in_air).collect();
        layers.push(Layer::new(interface, self.medium.clone()));
        let approximation = Approximation { single_pass: self.single_pass, unrefracted: false };
        let stack = Stack::approximated(layers, self.base.clone(), approximation).unwrap();
        assert!(stack.panel().is_some());
        stack
    }
}

/// A stack with these thicknesses of its layers, mm.
pub(crate) fn thick(stack: &Stack, thickness_mm: &[f64]) -> Stack {
    let mut stack = stack.clone();
    stack.set_thickness_mm(thickness_mm);
    stack
}

/// A panel in glass of index 1.5 without front.
pub(crate) fn panel(top: Top, base: Base) -> Panel {
    Panel { front: Front::none(), top, medium: Medium::new(one(1.5)), base, single_pass: false }
}

/// A front of screen from components (R, A).
pub(crate) fn front(components: &[(f64, f64)]) -> Front {
    Front::of(components.iter().map(|(r, a)| (std::slice::from_ref(r), std::slice::from_ref(a))))
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
    replicates_of(&stack.stack(), view, sources, seed, paths, sampler)
}

/// The same for any stack.
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
