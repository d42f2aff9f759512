//! Any layers: operators on nodes of |beta|, one set for each azimuthal order.
//!
//! # Method
//! Every layer is an operator on direction cosines (van de Hulst 1963; Grant & Hunt 1969): what it
//! sends back, from above and from below, and what it lets through. Two parts make one by
//! solving for the light between them, all orders of inter-reflection at once. Stacks have no
//! preferred azimuth: Fourier orders of the azimuth do not mix.
//!
//! - [`precision`]: what a level is; [`directions`]: views and sources; [`grid`]: the nodes;
//!   [`convergence`]: the azimuthal orders;
//! - [`algebra`]: operators with light that keeps its direction apart; [`beams`]: what they make of
//!   a few beams; [`matrix`]: what they are made of;
//! - [`slab`], [`lobes`], [`rough`]: what scatters; [`elements`]: layers as [`part`]s; [`part`]: two
//!   parts as one;
//! - [`base`]: the stack closed below its last scatterer by flat layers and pixel, by state and
//!   wavelength; [`seen`]: what comes of it.
//!
//! # What the level decides
//! Nodes, Legendre terms, azimuthal orders, and points of fields of view and round sources: the
//! error falls by a factor of five to ten from level to level. Wide rough faces do worse, two or
//! three: light that facets refract along the face jumps to zero there.
//!
//! # Cost
//! Wavelengths at which the layers above the base are alike share their operators; where indices
//! are alike, the nodes and what scatters. Work grows with the square to the cube of the nodes, and with
//! azimuthal orders: both as 1/width of the narrowest lobe. Diffuse light takes order 0 alone.

mod algebra;
mod base;
mod beams;
mod convergence;
mod directions;
mod elements;
mod grid;
mod lobes;
mod matrix;
mod part;
mod pixels;
mod precision;
mod prepare;
mod rough;
mod scatter;
mod scatterers;
mod seen;
mod slab;

use std::f64::consts::PI;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::Narrowest;
use super::images::ImagePoints;
use crate::specular::layered_image;
use crate::{Base, Cone, Estimate, Layered, Ledger, Reflector, Rho, Source};
use directions::{Directions, Ray};
use pixels::Pixels;
use precision::Precision;
use prepare::Group;
use seen::{Columns, Seen};

/// Radial nodes, besides the directions of views and sources, that a level takes.
pub(super) fn nodes_needed(stack: &Layered, level: u32) -> usize {
    let needed = |stack: &Layered| prepare::nodes_needed(stack, &Precision::new(level));
    pixels::each_as_layers(stack)
        .map_or_else(|| needed(stack), |all| all.iter().map(needed).max().unwrap_or(0))
}

/// What takes most of them.
pub(super) fn narrowest(stack: &Layered) -> Option<Narrowest> {
    let precision = Precision::new(0);
    let narrowest = |stack: &Layered| precision::narrowest(stack, &prepare::splits(stack, 0), &precision);
    let worst =
        |all: Vec<Layered>| all.into_iter().max_by_key(|stack| prepare::nodes_needed(stack, &precision));
    match pixels::each_as_layers(stack) {
        Some(all) => worst(all).as_ref().and_then(narrowest),
        None => narrowest(stack),
    }
}

/// Prepared for a stack, its views and its sources.
#[derive(Debug)]
pub(super) struct Kernel {
    precision: Precision,
    directions: Directions,
    /// For each view, the mirror images in it.
    images: Vec<Vec<ImagePoints>>,
    groups: Vec<Group>,
    /// What was seen over the last base.
    last: Mutex<Option<Arc<OverBase>>>,
    /// Of a base that scatters by kernels.
    pixels: Mutex<Option<Arc<Pixels>>>,
    level: u32,
    asked: (Vec<Cone>, Vec<Source>),
}

/// What beams from all extra nodes become over one base, as far as anyone asked: views of the
/// same inclination share it.
#[derive(Debug)]
struct OverBase {
    base: Base,
    columns: Vec<Columns>,
    /// `[extra node][group]`.
    seen: Vec<OnceLock<Vec<Seen>>>,
}

impl Clone for Kernel {
    fn clone(&self) -> Self {
        Self {
            precision: self.precision,
            directions: self.directions.clone(),
            images: self.images.clone(),
            groups: self.groups.clone(),
            last: Mutex::default(),
            pixels: Mutex::default(),
            level: self.level,
            asked: self.asked.clone(),
        }
    }
}

impl Kernel {
    pub(super) fn new(level: u32) -> Self {
        Self {
            precision: Precision::new(level),
            directions: Directions::default(),
            images: Vec::new(),
            groups: Vec::new(),
            last: Mutex::default(),
            pixels: Mutex::default(),
            level,
            asked: (Vec::new(), Vec::new()),
        }
    }

    pub(super) fn prepare(&mut self, stack: &Layered, views: &[Cone], sources: &[Source]) {
        self.asked = (views.to_vec(), sources.to_vec());
        if let Reflector::Scattering(_) = stack.base.reflector {
            self.groups = Vec::new();
            self.pixels = Mutex::new(Some(Arc::new(Pixels::new(stack, self.level, views, sources))));
            return;
        }
        let digits = self.precision.digits;
        self.directions = Directions::new(stack, views, sources, &self.precision);
        self.images = views.iter().map(|view| super::images::image_points(view, sources, digits)).collect();
        self.groups = prepare::groups(stack, &self.directions, &self.precision);
        self.last = Mutex::default();
        self.pixels = Mutex::default();
    }

    pub(super) fn nodes(&self) -> usize {
        let pixels = self.pixels.lock().unwrap_or_else(PoisonError::into_inner);
        let of_pixels = pixels.as_ref().map_or(0, |pixels| pixels.nodes());
        self.groups.iter().map(|group| group.nodes).max().unwrap_or(of_pixels)
    }

    pub(super) fn estimate(&self, stack: &Layered, view: usize) -> Estimate {
        if let Reflector::Scattering(_) = stack.base.reflector {
            return self.pixels(stack).estimate(view);
        }
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let zeros = Rho { base: vec![0.0; states * bins], front: vec![0.0; bins] };
        let rho = vec![zeros; self.directions.sources.len()];
        let mut estimate = Estimate { rho, ledger: Ledger::zeros(states * bins) };
        let over = self.over(stack);
        for ray in &self.directions.views[view] {
            let seen = over.seen[ray.extra].get_or_init(|| {
                let groups = self.groups.iter().zip(&over.columns);
                groups
                    .map(|(group, columns)| Seen::new(group, columns, ray.extra, self.precision.iteration))
                    .collect()
            });
            for ((group, columns), seen) in self.groups.iter().zip(&over.columns).zip(seen) {
                self.add_ray(group, columns, ray, seen, &mut estimate);
            }
        }
        self.add_images(stack, view, &mut estimate);
        estimate
    }

    /// Kernels over this base, which scatters by its own.
    fn pixels(&self, stack: &Layered) -> Arc<Pixels> {
        let mut last = self.pixels.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last.as_ref().filter(|known| known.serves(&stack.base)) {
            return Arc::clone(known);
        }
        let pixels = Arc::new(Pixels::new(stack, self.level, &self.asked.0, &self.asked.1));
        *last = Some(Arc::clone(&pixels));
        pixels
    }

    /// What is known over this base.
    fn over(&self, stack: &Layered) -> Arc<OverBase> {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = last.as_ref().filter(|known| known.base == stack.base) {
            return Arc::clone(known);
        }
        let over = Arc::new(OverBase {
            base: stack.base.clone(),
            columns: Columns::new(stack, &self.groups),
            seen: vec![OnceLock::new(); self.directions.beta.len()],
        });
        *last = Some(Arc::clone(&over));
        over
    }

    fn add_ray(&self, group: &Group, columns: &Columns, ray: &Ray, seen: &Seen, estimate: &mut Estimate) {
        for (source, rho) in self.directions.sources.iter().zip(&mut estimate.rho) {
            if source.is_empty() {
                columns.add(&mut rho.base, &seen.diffuse, ray.weight);
                group.bins.iter().for_each(|&bin| rho.front[bin] += ray.weight * seen.diffuse_front);
            }
            for light in source {
                let number = group.lights.binary_search(&light.extra).unwrap_or(0);
                let mut base = vec![0.0; columns.len()];
                let mut front = 0.0;
                for (m, front_of_lights) in seen.front.iter().enumerate() {
                    let both_ways = if m == 0 { 1.0 } else { 2.0 };
                    let factor = both_ways * (m as f64 * (ray.turn - light.turn)).cos();
                    front += factor * front_of_lights[number];
                    if let Some(kernel) = seen.orders.get(m).map(|lights| &lights[number]) {
                        base.iter_mut().zip(kernel).for_each(|(sum, k)| *sum += factor * k);
                    }
                }
                let weight = PI * ray.weight * light.weight;
                columns.add(&mut rho.base, &base, weight);
                group.bins.iter().for_each(|&bin| rho.front[bin] += weight * front);
            }
        }
        let Ledger { returned, front, diffuser, glass, pixel, inactive, unaccounted: _ } =
            &mut estimate.ledger;
        for (book, shares) in
            [returned, front, diffuser, glass, pixel, inactive].into_iter().zip(&seen.ledger)
        {
            columns.add(book, shares, ray.weight);
        }
    }

    fn add_images(&self, stack: &Layered, view: usize, estimate: &mut Estimate) {
        for image in &self.images[view] {
            let rho = &mut estimate.rho[image.source];
            for point in &image.points {
                let seen = layered_image(stack, point.beta);
                rho.base.iter_mut().zip(&seen.base).for_each(|(sum, x)| *sum += point.weight * x);
                rho.front.iter_mut().zip(&seen.front).for_each(|(sum, x)| *sum += point.weight * x);
            }
        }
    }
}
