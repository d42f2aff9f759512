//! What a unit beam into the display becomes.
//!
//! All kernels are reciprocal: the beam that enters against the view's direction tells what the
//! view sees, of diffuse light (the share that leaves) and of a beam (the kernel towards it).

use super::base::{Falling, Rising};
use super::matrix::Matrix;
use super::prepare::Group;
use crate::front::Flat;
use crate::{Layered, Reflector};

/// What a unit beam from one extra node becomes, by column.
#[derive(Debug, Default, Clone)]
pub(super) struct Seen {
    /// The display's kernel, by way of the base, towards each light: `[order][light]`.
    pub(super) orders: Vec<Vec<Vec<f64>>>,
    /// The same of light that has not met the base: alike in all columns.
    pub(super) front: Vec<Vec<f64>>,
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
    /// Reflectance of all that is below the last scatterer, `[node, column]`: over the base (if
    /// that is specular), then, as the last column, over black.
    below: Matrix,
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
    /// For each group.
    pub(super) fn new(stack: &Layered, groups: &[Group]) -> Vec<Self> {
        let mut known = None;
        groups.iter().map(|group| Self::of_group(stack, group, &mut known)).collect()
    }

    fn of_group(stack: &Layered, group: &Group, known: &mut Option<(usize, Matrix)>) -> Self {
        let (states, bins) = (stack.base.states(), stack.base.bins());
        let place: Vec<usize> =
            (0..states).flat_map(|state| group.bins.iter().map(move |bin| state * bins + bin)).collect();
        let inactive = place.iter().map(|at| stack.base.inactive_absorptance[at % bins]).collect();
        let flats = &group.lower.flats;
        let black = |i: usize| flats[i].above;
        let (base, below) = match &stack.base.reflector {
            Reflector::Specular(_) => {
                if known.as_ref().is_none_or(|(family, _)| *family != group.family) {
                    *known = Some((group.family, specular(stack, group)));
                }
                let all = known.as_ref().map(|(_, all)| all);
                let base = Matrix::from_fn(group.beta.len(), place.len(), |i, c| {
                    all.map_or(0.0, |all| all[(place[c], i)])
                });
                let below = Matrix::from_fn(group.beta.len(), place.len() + 1, |i, c| {
                    if c == place.len() { black(i) } else { over_base(flats[i], base[(i, c)]) }
                });
                (BaseColumns::Specular(base), below)
            }
            // Its states are layers of their own, over black.
            Reflector::Scattering(_) => {
                let nothing = Matrix::zeros(group.beta.len(), place.len());
                let below = Matrix::from_fn(group.beta.len(), place.len() + 1, |i, _| black(i));
                (BaseColumns::Specular(nothing), below)
            }
            Reflector::Lambertian(all) => {
                let base = place.iter().map(|at| all[*at]).collect();
                (BaseColumns::Lambertian(base), Matrix::from_fn(group.beta.len(), 1, |i, _| black(i)))
            }
        };
        Self { place, base, below, inactive }
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

/// The base's reflectance at every node that its medium carries: `[place, node]`.
fn specular(stack: &Layered, group: &Group) -> Matrix {
    let mut all = Matrix::zeros(stack.base.states() * stack.base.bins(), group.beta.len());
    let air = crate::Medium::new(vec![1.0; stack.base.bins()].into());
    let medium = stack.layers.last().map_or(&air, |layer| &layer.medium);
    for (beta, (_, column)) in
        group.beta.iter().zip(all.columns_mut()).filter(|(beta, _)| **beta < group.index)
    {
        stack.base.reflectance(beta * beta, medium, column);
    }
    all
}

/// Flat layers over a base: light that arrives at it, for a unit that falls on the layers.
fn arrives(flat: Flat, base: f64) -> f64 {
    let open = 1.0 - base * flat.below;
    if open > 0.0 { flat.t / open } else { 0.0 }
}

/// The reflectance of flat layers and base.
fn over_base(flat: Flat, base: f64) -> f64 {
    flat.above + flat.t * base * arrives(flat, base)
}

impl Seen {
    pub(super) fn new(group: &Group, columns: &Columns, extra: usize, tolerance: f64) -> Self {
        let node = group.shares.scale.len() - group.extras() + extra;
        let mut seen = Self { diffuse_front: group.shares.leaving_front[node], ..Self::default() };
        seen.follow(group, columns, extra, tolerance);
        if let BaseColumns::Lambertian(reflectance) = &columns.base {
            seen.lambertian(group, columns, node, reflectance);
        }
        seen
    }

    fn follow(&mut self, group: &Group, columns: &Columns, extra: usize, tolerance: f64) {
        let black = columns.below.columns() - 1;
        let mut floor = vec![0.0; black + 1];
        let extras_alone = columns.below.rows_from(group.beta.len() - group.extras());
        for (m, above) in group.orders.iter().enumerate() {
            // Later orders have no nodes with weight.
            let below = if above.carried() > 0 { &columns.below } else { &extras_alone };
            let rising = above.rise(extra, below, tolerance, &mut floor);
            let mut front = Vec::new();
            let mut kernels = Vec::new();
            for (number, to) in group.lights.iter().enumerate() {
                let mut kernel = above.leaves(&rising, number, *to, below);
                let dark = kernel.pop().unwrap_or(0.0);
                kernel.iter_mut().for_each(|value| *value -= dark);
                front.push(above.front(extra, number) + dark);
                kernels.push(kernel);
            }
            self.front.push(front);
            if let BaseColumns::Specular(base) = &columns.base {
                self.orders.push(kernels);
                if m == 0 {
                    let falling = above.falls(&rising, below);
                    self.specular(group, columns, base, &rising, &falling);
                }
            }
        }
    }

    /// Diffuse light and ledger of a specular base.
    fn specular(
        &mut self,
        group: &Group,
        columns: &Columns,
        base: &Matrix,
        rising: &Rising,
        falling: &Falling,
    ) {
        let (shares, lower) = (&group.shares, &group.lower);
        self.diffuse = rising.total(&shares.scale, |i, _| shares.leaving[i]);
        let dark = self.diffuse.pop().unwrap_or(0.0);
        self.diffuse.iter_mut().for_each(|share| *share -= dark);
        self.diffuse_front += dark;
        let node = shares.scale.len() - group.extras() + rising.extra();
        let reflectance = |i: usize, c: usize| if c < columns.len() { base[(i, c)] } else { 0.0 };
        let arrival = |i: usize, c: usize| arrives(lower.flats[i], reflectance(i, c));
        let mut in_flats = vec![0.0; columns.len()];
        let layers = std::array::from_fn(|place| {
            let [from_above, from_below] = lower.absorbed.each_ref().map(|places| &places[place]);
            let upper = rising.total(&shares.scale, |i, _| shares.absorbed[1][place][i]);
            let lower = falling.total(&shares.scale, |i, c| {
                from_above[i] + arrival(i, c) * reflectance(i, c) * from_below[i]
            });
            in_flats.iter_mut().zip(&lower).for_each(|(sum, lower)| *sum += lower);
            let first = shares.absorbed[0][place][node];
            (0..columns.len()).map(|c| first + upper[c] + lower[c]).collect()
        });
        // What falls and does not rise ends below: no light is lost in what iteration left over.
        let [falls, rises] = [falling, rising].map(|light| light.total(&shares.scale, |_, _| 1.0));
        let arriving = falling.total(&shares.scale, arrival);
        let below: Vec<f64> = (0..columns.len()).map(|c| falls[c] - rises[c] - in_flats[c]).collect();
        self.book(columns, layers, &arriving, &below);
    }

    /// A Lambertian base makes all light alike: rank one, in closed form.
    fn lambertian(&mut self, group: &Group, columns: &Columns, node: usize, reflectance: &[f64]) {
        let shares = &group.shares;
        let regular = shares.scale.len() - group.extras();
        let areas: Vec<f64> = shares.scale[..regular].iter().map(|scale| scale * scale).collect();
        let whole: f64 = areas.iter().sum();
        let mean =
            |share: &[f64]| areas.iter().zip(share).map(|(area, share)| area * share).sum::<f64>() / whole;
        let returns = mean(&shares.returning);
        let rises: Vec<f64> =
            reflectance.iter().map(|r| shares.arriving[node] * r / (1.0 - r * returns)).collect();
        let scaled = |factor: f64| -> Vec<f64> { rises.iter().map(|x| x * factor).collect() };
        let towards = |to: &usize| scaled(shares.arriving[regular + to] / whole);
        self.orders.push(group.lights.iter().map(towards).collect());
        self.diffuse = scaled(mean(&shares.leaving));
        let layers = std::array::from_fn(|place| {
            let (above, below) = (shares.absorbed[0][place][node], mean(&shares.absorbed[1][place]));
            rises.iter().map(|x| above + below * x).collect()
        });
        let arrives: Vec<f64> = rises.iter().map(|x| shares.arriving[node] + returns * x).collect();
        let below: Vec<f64> = arrives.iter().zip(&rises).map(|(arrives, rises)| arrives - rises).collect();
        self.book(columns, layers, &arrives, &below);
    }

    /// `arrives` at the base; `below` is absorbed by pixel and inactive share.
    fn book(&mut self, columns: &Columns, layers: [Vec<f64>; 4], arrives: &[f64], below: &[f64]) {
        let returned = self.diffuse.iter().map(|share| share + self.diffuse_front).collect();
        let inactive: Vec<f64> = arrives.iter().zip(&columns.inactive).map(|(a, i)| a * i).collect();
        let [front, diffuser, glass, in_pixel] = layers;
        let pixel = (0..below.len()).map(|c| below[c] - inactive[c] + in_pixel[c]).collect();
        self.ledger = vec![returned, front, diffuser, glass, pixel, inactive];
    }
}
