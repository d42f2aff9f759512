//! Adding for layers in any order: operators on nodes of |beta|, one set for each azimuthal order.
//!
//! # Method
//! Every layer is an operator on direction cosines (van de Hulst 1963; Grant & Hunt 1969): reflection from
//! above and from below, and transmission. Two parts are combined by solving for the light between them,
//! which sums all orders of inter-reflection at once. Stacks have no preferred azimuth: Fourier orders over
//! the azimuth do not mix.
//!
//! - [`precision`]: the accuracy of a level; [`directions`]: views and sources; [`grid`]: the nodes;
//!   [`convergence`]: the azimuthal orders;
//! - [`algebra`]: operators in which light that keeps its direction is separate; [`beams`]: their effect on
//!   a few beams; [`matrix`]: their elements;
//! - [`slab`], [`lobes`], [`rough`]: scatterers; [`elements`]: layers as [`part`]s; [`part`]: combination of
//!   two parts;
//! - [`averages`]: flat layers that change faster over direction than the nodes resolve;
//! - [`wavelengths`]: those at which a first answer is computed;
//! - [`azimuth`]: Fourier orders of kernels without a closed series; [`once`]: light that such a kernel
//!   scatters only once, which needs none;
//! - [`first_bounce`]: light between two narrow lobes of a rough surface;
//! - [`prepare`]: the layers down to the last scatterer, order by order; [`base`]: the stack closed below
//!   it by flat layers and pixel, in [`columns`] by state and wavelength; [`beam_response`]: the light of
//!   beams that the views then see, summed over azimuths in [`gather`]; [`diffuse_response`]: diffuse light,
//!   and the ledger.
//!
//! # Discretisation
//! A level determines the nodes, Legendre terms, azimuthal orders, and points of fields of view and round
//! sources. The error decreases by a factor of five to ten from level to level. For wide rough interfaces
//! above anything but a Lambertian base the factor is only two or three: light that microfacets refract
//! along the interface jumps to zero there.
//!
//! # Cost
//! Wavelengths at which the layers above the base are equal share their operators; those with equal indices
//! share nodes and scatterers. Work grows with the square to the cube of the number of nodes, and with the
//! number of azimuthal orders: both as 1/width of the narrowest lobe. Diffuse light takes only order 0.

mod algebra;
mod averages;
mod azimuth;
mod base;
mod beam_response;
mod beams;
mod columns;
mod convergence;
mod diffuse_response;
mod directions;
mod elements;
mod first_bounce;
mod gather;
mod grid;
mod known;
mod lobes;
mod matrix;
mod once;
mod part;
mod pixels;
mod precision;
mod prepare;
mod rough;
mod scatter;
mod scatterers;
mod single;
mod slab;
mod splits;
mod spread;
mod wavelengths;

use std::borrow::Cow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::Narrowest;
use crate::light::images::{ImagePoints, Mirror, image_points};
use crate::specular::layered_image;
use crate::{Base, Cone, Estimate, Interface, Layer, Reflector, Source, Stack};
use beam_response::BeamResponse;
use directions::Directions;
use pixels::Pixels;
use precision::Precision;
pub(super) use precision::rough_surface;
use prepare::Prepared;
pub(super) use rough::refraction_width;
pub use spread::{LayeredSpread, NotCovered, PaperLight, Seen};

/// Returns the number of radial nodes that a level takes, besides the directions of views and sources.
pub(super) fn nodes_needed(stack: &Stack, level: u32) -> usize {
    let needed = |stack: &Stack| prepare::nodes_needed(stack, &Precision::new(f64::from(level)));
    pixels::each_as_layers(stack)
        .map_or_else(|| needed(stack), |all| all.iter().map(needed).max().unwrap_or(0))
}

/// Returns the scatterer that needs most of them.
pub(super) fn narrowest(stack: &Stack) -> Option<Narrowest> {
    let precision = Precision::new(0.0);
    let narrowest = |stack: &Stack| precision::narrowest(stack, &splits::splits(stack, 0), &precision);
    let worst =
        |all: Vec<Stack>| all.into_iter().max_by_key(|stack| prepare::nodes_needed(stack, &precision));
    match pixels::each_as_layers(stack) {
        Some(all) => worst(all).as_ref().and_then(narrowest),
        None => narrowest(stack),
    }
}

/// Kernel prepared for a stack, its views and its sources.
#[derive(Debug)]
pub(super) struct Kernel {
    precision: Precision,
    directions: Directions,
    /// For each view, the mirror images in it.
    images: Vec<Vec<ImagePoints>>,
    prepared: Prepared,
    /// Response over the last base.
    last: Mutex<Option<Arc<BeamResponse>>>,
    /// Kernels of a base that scatters by kernels.
    pixels: Mutex<Option<Arc<Pixels>>>,
    level: f64,
    /// Whether its estimates have a ledger.
    ledger: bool,
    /// Layers for which it is prepared.
    layers: Vec<Layer>,
    asked: (Vec<Cone>, Vec<Source>),
}

impl Clone for Kernel {
    fn clone(&self) -> Self {
        Self {
            precision: self.precision,
            directions: self.directions.clone(),
            images: self.images.clone(),
            prepared: self.prepared.clone(),
            last: Mutex::new(self.last().clone()),
            pixels: Mutex::default(),
            level: self.level,
            ledger: self.ledger,
            layers: self.layers.clone(),
            asked: self.asked.clone(),
        }
    }
}

impl Kernel {
    pub(super) fn new(level: f64, ledger: bool) -> Self {
        Self {
            precision: Precision::new(level),
            directions: Directions::default(),
            images: Vec::new(),
            prepared: Prepared::default(),
            last: Mutex::default(),
            pixels: Mutex::default(),
            level,
            ledger,
            layers: Vec::new(),
            asked: (Vec::new(), Vec::new()),
        }
    }

    /// Prepares views and sources; incomplete if `stop` is set during the computation.
    pub(super) fn prepare(&mut self, stack: &Stack, views: &[Cone], sources: &[Source], stop: &AtomicBool) {
        let digits = self.precision.digits;
        // The previous data may be large: they are freed first, but for kernels that other directions share.
        let known = std::mem::take(&mut self.prepared).into_known();
        let before = std::mem::take(&mut self.last).into_inner().unwrap_or_else(PoisonError::into_inner);
        let before = before.filter(|_| self.layers == stack.layers);
        self.layers.clone_from(&stack.layers);
        self.pixels = Mutex::default();
        self.asked = (views.to_vec(), sources.to_vec());
        if let Reflector::Scattering(_) = stack.base().reflector {
            self.pixels = Mutex::new(Some(Arc::new(Pixels::new(
                stack,
                (self.level, self.ledger),
                views,
                sources,
                stop,
            ))));
            return;
        }
        self.directions = Directions::new(stack, views, sources, &self.precision);
        self.directions.ledger = self.ledger;
        // They are valid for any base, whose fringes are not known here.
        self.images =
            views.iter().map(|view| image_points(view, sources, digits, Mirror::Across(0.0))).collect();
        let stack = self.coarser(stack);
        let before = before.as_deref();
        let (prepared, over) = Prepared::new(&stack, &self.directions, &self.precision, &known, before, stop);
        self.prepared = prepared;
        self.last = Mutex::new(Some(Arc::new(over)));
    }

    /// Returns whether its directions are also right over this base.
    pub(super) fn serves(&self, stack: &Stack) -> bool {
        !stack.base().is_specular()
            || (self.directions.serve(stack, &self.asked.0)
                && self.prepared.wavelengths == wavelengths::computed(stack, self.precision.wavelengths))
    }

    pub(super) fn nodes(&self) -> usize {
        let pixels = self.pixels.lock().unwrap_or_else(PoisonError::into_inner);
        let of_pixels = pixels.as_ref().map_or(0, |pixels| pixels.nodes());
        self.prepared.families.iter().flatten().map(|group| group.nodes).max().unwrap_or(of_pixels)
    }

    /// Returns the estimate of a view; invalid if `stop` was set during the computation.
    pub(super) fn estimate(&self, stack: &Stack, view: usize, stop: &AtomicBool) -> Estimate {
        if let Reflector::Scattering(_) = stack.base().reflector {
            return self.pixels(stack, stop).estimate(view, stop);
        }
        let over = self.over(stack, stop);
        if stop.load(Ordering::Relaxed) {
            return Estimate::default();
        }
        let mut estimate = over.estimate(&self.directions, view);
        wavelengths::interpolate(stack, &self.prepared.wavelengths, &mut estimate);
        self.add_images(stack, view, &mut estimate);
        estimate
    }

    /// Returns the kernels over this base, which scatters by kernels of its own.
    fn pixels(&self, stack: &Stack, stop: &AtomicBool) -> Arc<Pixels> {
        let mut last = self.pixels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last.as_ref().filter(|known| known.serves(stack.base())) {
            return Arc::clone(known);
        }
        let pixels =
            Arc::new(Pixels::new(stack, (self.level, self.ledger), &self.asked.0, &self.asked.1, stop));
        *last = (!stop.load(Ordering::Relaxed)).then(|| Arc::clone(&pixels));
        pixels
    }

    /// Returns the response over this base.
    fn over(&self, stack: &Stack, stop: &AtomicBool) -> Arc<BeamResponse> {
        let mut last = self.last();
        if let Some(known) = last.as_ref().filter(|known| is_over(known, stack)) {
            return Arc::clone(known);
        }
        let stack = self.coarser(stack);
        let over = Arc::new(self.prepared.over(&stack, &self.directions, &self.precision, stop));
        *last = (!stop.load(Ordering::Relaxed)).then(|| Arc::clone(&over));
        over
    }

    /// Returns the stack with tables of rough interfaces that are as coarse as the level.
    fn coarser<'a>(&self, stack: &'a Stack) -> Cow<'a, Stack> {
        let coarseness = self.precision.coarseness;
        let is_rough = |layer: &Layer| matches!(layer.interface, Interface::Rough(_));
        if coarseness == 0 || !stack.layers.iter().any(is_rough) {
            return Cow::Borrowed(stack);
        }
        let mut stack = stack.clone();
        for layer in &mut stack.layers {
            if let Interface::Rough(face) = &mut layer.interface {
                *face = face.coarser(coarseness);
            }
        }
        Cow::Owned(stack)
    }

    fn last(&self) -> MutexGuard<'_, Option<Arc<BeamResponse>>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn add_images(&self, stack: &Stack, view: usize, estimate: &mut Estimate) {
        for image in &self.images[view] {
            let rho = &mut estimate.rho[image.source];
            for point in &image.points {
                rho.add(&layered_image(stack, point.beta), point.weight);
            }
        }
    }
}

/// Returns whether a response is that over the base of this stack.
fn is_over(known: &BeamResponse, stack: &Stack) -> bool {
    let mirrors = match (&known.mirrors, stack.mirrors()) {
        (Some(known), Some(own)) => known.iter().zip(own).all(|(known, own)| is_same(known, own)),
        (None, None) => true,
        _ => false,
    };
    mirrors && is_same(&known.base, stack.base())
}

/// Returns whether two bases are equal; tables that are shared are not compared.
pub(super) fn is_same(one: &Base, other: &Base) -> bool {
    match (&one.reflector, &other.reflector) {
        (Reflector::Specular(a), Reflector::Specular(b)) if Arc::ptr_eq(&a.basis, &b.basis) => {
            let rest = a.nodes == b.nodes && a.mixture == b.mixture && a.common == b.common;
            rest && one.inactive_absorptance == other.inactive_absorptance
        }
        _ => one == other,
    }
}
