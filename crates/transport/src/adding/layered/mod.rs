//! Any layers: operators on nodes of |beta|, one set for each azimuthal order.
//!
//! # Method
//! Every layer is an operator on direction cosines (van de Hulst 1963; Grant & Hunt 1969): what it
//! sends back, from above and from below, and what it lets through. Two parts make one by
//! solving for the light between them, all orders of inter-reflection at once. Stacks have no
//! preferred azimuth: Fourier orders of the azimuth do not mix.
//!
//! - [`grid`]: the nodes; [`algebra`]: operators with light that keeps its direction apart;
//! - [`slab`], [`lobes`], [`rough`]: what scatters; [`elements`]: layers as [`part`]s; [`part`]: two
//!   parts as one;
//! - [`base`]: the stack closed by the pixel, by state and wavelength.
//!
//! # What the level decides
//! Nodes, Legendre terms, azimuthal orders, and points of fields of view and round sources: the
//! error falls by more than five from level to level.
//!
//! # Cost
//! Wavelengths at which the layers above the base are alike share their operators. Work grows with
//! the cube of the nodes, nodes as 1/width of the narrowest lobe.

mod algebra;
mod base;
mod elements;
mod gauss;
mod grid;
mod lobes;
mod part;
mod prepare;
mod rough;
mod scatterers;
mod slab;

use std::f64::consts::PI;

use faer::Mat;

use super::images::ImagePoints;
use crate::specular::layered_image;
use crate::{Cone, Estimate, Layered, Ledger, Reflector, Rho, Source};
use base::Rising;
use prepare::{Group, Order, Precision, Ray};

/// Prepared for a stack, its views and its sources.
#[derive(Debug, Clone)]
pub(super) struct Kernel {
    precision: Precision,
    /// For each view, its rays; the weights sum to one.
    views: Vec<Vec<Ray>>,
    /// For each source, its rays: none for diffuse light.
    sources: Vec<Vec<Ray>>,
    /// For each view, the mirror images in it.
    images: Vec<Vec<ImagePoints>>,
    groups: Vec<Group>,
}

impl Kernel {
    pub(super) fn new(level: u32) -> Self {
        let precision = Precision::new(level);
        Self { precision, views: Vec::new(), sources: Vec::new(), images: Vec::new(), groups: Vec::new() }
    }

    pub(super) fn prepare(&mut self, stack: &Layered, views: &[Cone], sources: &[Source]) {
        let digits = self.precision.digits;
        let directions = prepare::Directions::new(stack, views, sources, &self.precision);
        self.images = views.iter().map(|view| super::images::image_points(view, sources, digits)).collect();
        self.groups = prepare::groups(stack, &directions, &self.precision);
        (self.views, self.sources) = (directions.views, directions.sources);
    }

    pub(super) fn nodes(&self) -> usize {
        self.groups.iter().map(|group| group.grid.len()).max().unwrap_or(0)
    }

    pub(super) fn estimate(&self, stack: &Layered, view: usize) -> Estimate {
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let zeros = Rho { base: vec![0.0; states * bins], front: vec![0.0; bins] };
        let mut estimate =
            Estimate { rho: vec![zeros; self.sources.len()], ledger: Ledger::zeros(states * bins) };
        for group in &self.groups {
            let columns = Columns::new(stack, group);
            let mut seen: Vec<(usize, Seen)> = Vec::new();
            for ray in &self.views[view] {
                let at = seen.iter().position(|(node, _)| *node == ray.node).unwrap_or_else(|| {
                    seen.push((ray.node, self.from_node(group, &columns, group.node(ray))));
                    seen.len() - 1
                });
                self.add_ray(group, &columns, ray, &seen[at].1, &mut estimate);
            }
        }
        self.add_images(stack, view, &mut estimate);
        estimate
    }

    /// Everything that a unit beam from this node becomes.
    fn from_node(&self, group: &Group, columns: &Columns, node: usize) -> Seen {
        let lights = &group.light_nodes;
        let mut seen =
            Seen { orders: Vec::new(), diffuse: Vec::new(), diffuse_front: 0.0, ledger: Vec::new() };
        for (m, order) in group.orders.iter().enumerate() {
            // Later orders may have no nodes with weight.
            let skipped = group.grid.len() - order.above.down.len();
            let node = node - skipped;
            match &columns.base {
                BaseColumns::Specular(reflectance) => {
                    let reflectance = reflectance.get(skipped.., ..).to_owned();
                    let rising = order.above.rise(node, &reflectance);
                    let leaving =
                        lights.iter().map(|to| order.above.leaves(&rising, to - skipped, &reflectance));
                    seen.orders.push(leaving.collect());
                    if m == 0 {
                        specular_books(group, order, columns, &rising, &mut seen);
                    }
                }
                BaseColumns::Lambertian(reflectance) if m == 0 => {
                    lambertian(group, order, columns, node, reflectance, &mut seen);
                }
                BaseColumns::Lambertian(_) => seen.orders.push(Vec::new()),
            }
        }
        seen
    }

    fn add_ray(&self, group: &Group, columns: &Columns, ray: &Ray, seen: &Seen, estimate: &mut Estimate) {
        for (source, rho) in self.sources.iter().zip(&mut estimate.rho) {
            if source.is_empty() {
                columns.add(&mut rho.base, &seen.diffuse, ray.weight);
                group.bins.iter().for_each(|&bin| rho.front[bin] += ray.weight * seen.diffuse_front);
            }
            for light in source {
                let mut base = vec![0.0; columns.count];
                let mut front = 0.0;
                let at = group.light_nodes.iter().position(|node| *node == group.node(light)).unwrap_or(0);
                for (m, order) in group.orders.iter().enumerate() {
                    let both_ways = if m == 0 { 1.0 } else { 2.0 };
                    let factor = both_ways * (m as f64 * (ray.turn - light.turn)).cos();
                    let skipped = group.grid.len() - order.above.down.len();
                    front += factor * order.front.at(group.node(ray) - skipped, group.node(light) - skipped);
                    if let Some(kernel) = seen.orders[m].get(at) {
                        base.iter_mut().zip(kernel).for_each(|(sum, k)| *sum += factor * k);
                    }
                }
                let weight = PI * ray.weight * light.weight;
                columns.add(&mut rho.base, &base, weight);
                group.bins.iter().for_each(|&bin| rho.front[bin] += weight * front);
            }
        }
        let ledger = &mut estimate.ledger;
        let books = [
            &mut ledger.returned,
            &mut ledger.front,
            &mut ledger.diffuser,
            &mut ledger.glass,
            &mut ledger.pixel,
            &mut ledger.inactive,
        ];
        for (book, shares) in books.into_iter().zip(&seen.ledger) {
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

/// What a unit beam from one node becomes, by column.
#[derive(Debug)]
struct Seen {
    /// The display's kernel, by way of the base, towards each light's node: `[order][light]`.
    orders: Vec<Vec<Vec<f64>>>,
    /// The share that leaves, by way of the base.
    diffuse: Vec<f64>,
    /// The share that leaves without having met it.
    diffuse_front: f64,
    /// Returned, then absorbed in front, diffuser, glass, pixel, inactive.
    ledger: Vec<Vec<f64>>,
}

/// The base at a group's wavelengths: a column is a state and a wavelength.
struct Columns {
    count: usize,
    /// Where each column stands in `[state][wavelength]`.
    place: Vec<usize>,
    base: BaseColumns,
    inactive: Vec<f64>,
}

enum BaseColumns {
    /// `[node, column]`.
    Specular(Mat<f64>),
    /// By column.
    Lambertian(Vec<f64>),
}

impl Columns {
    fn new(stack: &Layered, group: &Group) -> Self {
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let place: Vec<usize> =
            (0..states).flat_map(|state| group.bins.iter().map(move |bin| state * bins + bin)).collect();
        let inactive = place.iter().map(|at| stack.base.inactive_absorptance[at % bins]).collect();
        let base = match (&stack.base.reflector, stack.layers.last()) {
            (Reflector::Specular(_), Some(layer)) => {
                let mut all = vec![0.0; states * bins];
                let mut table = Mat::zeros(group.grid.len(), place.len());
                for (i, beta) in group.grid.beta.iter().enumerate().filter(|(_, beta)| **beta < group.index) {
                    stack.base.reflectance(beta * beta, &layer.medium, &mut all);
                    place.iter().enumerate().for_each(|(c, at)| table[(i, c)] = all[*at]);
                }
                BaseColumns::Specular(table)
            }
            (Reflector::Lambertian(all), _) => {
                BaseColumns::Lambertian(place.iter().map(|at| all[*at]).collect())
            }
            (Reflector::Specular(_), None) => BaseColumns::Lambertian(vec![0.0; place.len()]),
        };
        Self { count: place.len(), place, base, inactive }
    }

    fn add(&self, sums: &mut [f64], values: &[f64], weight: f64) {
        for (at, value) in self.place.iter().zip(values) {
            sums[*at] += weight * value;
        }
    }
}

fn specular_books(group: &Group, order: &Order, columns: &Columns, rising: &Rising, seen: &mut Seen) {
    let grid = &group.grid;
    let total = |share: &[f64]| base::total(rising, share, grid);
    seen.diffuse = total(&group.leaving);
    seen.diffuse_front = group.leaving_front[rising.node];
    let ones = vec![1.0; grid.len()];
    let reflected = total(&ones);
    // What rises was sent back by the base: what arrives is what passes plus what returns.
    let returns = total(&order.above.below.pull_back(&ones, &grid.scale));
    let passes = order.above.down.pull_back(&ones, &grid.scale)[rising.node];
    let arrives: Vec<f64> = returns.iter().map(|r| r + passes).collect();
    let upper = group.absorbed.each_ref().map(|books| books.each_ref().map(Vec::as_slice));
    let layers = |place: usize| -> Vec<f64> {
        let above = upper[0][place][rising.node];
        total(upper[1][place]).into_iter().map(|below| above + below).collect()
    };
    book(seen, columns, [layers(0), layers(1), layers(2)], &arrives, &reflected);
}

fn book(seen: &mut Seen, columns: &Columns, layers: [Vec<f64>; 3], arrives: &[f64], reflected: &[f64]) {
    let returned = seen.diffuse.iter().map(|share| share + seen.diffuse_front).collect();
    let inactive: Vec<f64> = arrives.iter().zip(&columns.inactive).map(|(a, i)| a * i).collect();
    let pixel = (0..arrives.len()).map(|c| arrives[c] - reflected[c] - inactive[c]).collect();
    let [front, diffuser, glass] = layers;
    seen.ledger = vec![returned, front, diffuser, glass, pixel, inactive];
}

/// A Lambertian base makes all light alike: rank one, in closed form.
fn lambertian(
    group: &Group,
    order: &Order,
    columns: &Columns,
    node: usize,
    reflectance: &[f64],
    seen: &mut Seen,
) {
    let grid = &group.grid;
    let carried = grid.below(group.index);
    let area: Vec<f64> = (0..grid.regular).map(|i| carried[i] * grid.scale[i] * grid.scale[i]).collect();
    let whole: f64 = area.iter().sum();
    let mean = |share: &[f64]| area.iter().zip(share).map(|(a, s)| a * s).sum::<f64>() / whole;
    let arrives = order.above.down.pull_back(&carried, &grid.scale);
    let returns = mean(&order.above.below.pull_back(&carried, &grid.scale));
    let rises: Vec<f64> = reflectance.iter().map(|r| arrives[node] * r / (1.0 - r * returns)).collect();
    let scaled = |factor: f64| -> Vec<f64> { rises.iter().map(|x| x * factor).collect() };
    seen.orders.push(group.light_nodes.iter().map(|&light| scaled(arrives[light] / whole)).collect());
    seen.diffuse = scaled(mean(&group.leaving));
    seen.diffuse_front = group.leaving_front[node];
    let layers = std::array::from_fn(|place| {
        let below = mean(&group.absorbed[1][place]);
        rises.iter().map(|x| group.absorbed[0][place][node] + below * x).collect()
    });
    let arriving: Vec<f64> = rises.iter().map(|x| arrives[node] + returns * x).collect();
    book(seen, columns, layers, &arriving, &rises);
}
