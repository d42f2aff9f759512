//! What a unit beam into the display becomes.
//!
//! All kernels are reciprocal: the beam that enters against the view's direction tells what the
//! view sees, of diffuse light (the share that leaves) and of a beam (the kernel towards it).

use super::base::Rising;
use super::matrix::Matrix;
use super::prepare::Group;
use crate::{Layered, Reflector};

/// What a unit beam from one extra node becomes, by column.
#[derive(Debug, Default, Clone)]
pub(super) struct Seen {
    /// The display's kernel, by way of the base, towards each light: `[order][light]`.
    pub(super) orders: Vec<Vec<Vec<f64>>>,
    /// The share that leaves, by way of the base.
    pub(super) diffuse: Vec<f64>,
    /// The share that leaves without having met it.
    pub(super) diffuse_front: f64,
    /// Returned, then absorbed in front, diffuser, glass, pixel, inactive.
    pub(super) ledger: Vec<Vec<f64>>,
}

/// The base at a group's wavelengths: a column is a state and a wavelength.
#[derive(Debug)]
pub(super) struct Columns {
    /// Where each column stands in `[state][wavelength]`.
    place: Vec<usize>,
    base: BaseColumns,
    inactive: Vec<f64>,
}

#[derive(Debug)]
enum BaseColumns {
    /// `[node, column]`.
    Specular(Matrix),
    /// By column.
    Lambertian(Vec<f64>),
}

impl Columns {
    pub(super) fn new(stack: &Layered, group: &Group) -> Self {
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let place: Vec<usize> =
            (0..states).flat_map(|state| group.bins.iter().map(move |bin| state * bins + bin)).collect();
        let inactive = place.iter().map(|at| stack.base.inactive_absorptance[at % bins]).collect();
        let base = match &stack.base.reflector {
            Reflector::Specular(_) => BaseColumns::Specular(specular(stack, group, &place)),
            Reflector::Lambertian(all) => BaseColumns::Lambertian(place.iter().map(|at| all[*at]).collect()),
        };
        Self { place, base, inactive }
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.place.len()
    }

    /// Adds values by column to sums by state and wavelength.
    pub(super) fn add(&self, sums: &mut [f64], values: &[f64], weight: f64) {
        for (at, value) in self.place.iter().zip(values) {
            sums[*at] += weight * value;
        }
    }
}

/// The base's reflectance at every node that its medium carries.
fn specular(stack: &Layered, group: &Group, place: &[usize]) -> Matrix {
    let mut all = vec![0.0; stack.base.states() * stack.base.bins()];
    let mut table = Matrix::zeros(group.grid.len(), place.len());
    let air = crate::Medium::new(vec![1.0; stack.base.bins()].into());
    let medium = stack.layers.last().map_or(&air, |layer| &layer.medium);
    for (i, beta) in group.grid.beta.iter().enumerate().filter(|(_, beta)| **beta < group.index) {
        stack.base.reflectance(beta * beta, medium, &mut all);
        place.iter().enumerate().for_each(|(c, at)| table[(i, c)] = all[*at]);
    }
    table
}

impl Seen {
    pub(super) fn new(group: &Group, columns: &Columns, extra: usize, tolerance: f64) -> Self {
        let diffuse_front = group.leaving_front[group.grid.regular + extra];
        let mut seen = Self { diffuse_front, ..Self::default() };
        match &columns.base {
            BaseColumns::Specular(base) => seen.specular(group, columns, extra, base, tolerance),
            BaseColumns::Lambertian(reflectance) => seen.lambertian(group, columns, extra, reflectance),
        }
        seen
    }

    fn specular(&mut self, group: &Group, columns: &Columns, extra: usize, base: &Matrix, tolerance: f64) {
        let mut floor = vec![0.0; columns.len()];
        let extras_alone = base.rows_from(group.grid.regular);
        for (m, above) in group.orders.iter().enumerate() {
            // Later orders have no nodes with weight.
            let base = if above.regular() > 0 { base } else { &extras_alone };
            let rising = above.rise(extra, base, tolerance, &mut floor);
            let towards = |(number, to): (usize, &usize)| above.leaves(&rising, number, *to, base);
            self.orders.push(group.lights.iter().enumerate().map(towards).collect());
            if m == 0 {
                self.diffuse = rising.total(&group.leaving, &group.grid);
                self.specular_books(group, columns, &rising, extra);
            }
        }
    }

    fn specular_books(&mut self, group: &Group, columns: &Columns, rising: &Rising, extra: usize) {
        let node = group.grid.regular + extra;
        let total = |share: &[f64]| rising.total(share, &group.grid);
        let layers = std::array::from_fn(|place| {
            let above = group.absorbed[0][place][node];
            total(&group.absorbed[1][place]).into_iter().map(|below| above + below).collect()
        });
        let arrives: Vec<f64> =
            total(&group.returning).into_iter().map(|again| group.arriving[node] + again).collect();
        let reflected = total(&vec![1.0; group.grid.len()]);
        self.book(columns, layers, &arrives, &reflected);
    }

    /// A Lambertian base makes all light alike: rank one, in closed form.
    fn lambertian(&mut self, group: &Group, columns: &Columns, extra: usize, reflectance: &[f64]) {
        let (grid, node) = (&group.grid, group.grid.regular + extra);
        let area = |i: usize| if grid.beta[i] < group.index { grid.scale[i].powi(2) } else { 0.0 };
        let whole: f64 = (0..grid.regular).map(area).sum();
        let mean = |share: &[f64]| (0..grid.regular).map(|i| area(i) * share[i]).sum::<f64>() / whole;
        let returns = mean(&group.returning);
        let rises: Vec<f64> =
            reflectance.iter().map(|r| group.arriving[node] * r / (1.0 - r * returns)).collect();
        let scaled = |factor: f64| -> Vec<f64> { rises.iter().map(|x| x * factor).collect() };
        let towards = |to: &usize| scaled(group.arriving[grid.regular + to] / whole);
        self.orders.push(group.lights.iter().map(towards).collect());
        self.diffuse = scaled(mean(&group.leaving));
        let layers = std::array::from_fn(|place| {
            let (above, below) = (group.absorbed[0][place][node], mean(&group.absorbed[1][place]));
            rises.iter().map(|x| above + below * x).collect()
        });
        let arrives: Vec<f64> = rises.iter().map(|x| group.arriving[node] + returns * x).collect();
        self.book(columns, layers, &arrives, &rises);
    }

    fn book(&mut self, columns: &Columns, layers: [Vec<f64>; 3], arrives: &[f64], reflected: &[f64]) {
        let returned = self.diffuse.iter().map(|share| share + self.diffuse_front).collect();
        let inactive: Vec<f64> = arrives.iter().zip(&columns.inactive).map(|(a, i)| a * i).collect();
        let pixel = (0..arrives.len()).map(|c| arrives[c] - reflected[c] - inactive[c]).collect();
        let [front, diffuser, glass] = layers;
        self.ledger = vec![returned, front, diffuser, glass, pixel, inactive];
    }
}
