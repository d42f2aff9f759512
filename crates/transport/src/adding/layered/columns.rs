//! The base by state and wavelength, as seen from the layers above its medium.

use papilio_optics::Beta;

use super::matrix::Matrix;
use super::prepare::Group;
use crate::front::Flat;
use crate::{Reflector, Stack};

/// The base at a group's wavelengths: each column is a state and a wavelength.
#[derive(Debug)]
pub(super) struct Columns {
    /// Index of each column in `[state][wavelength]`.
    pub(super) place: Vec<usize>,
    pub(super) base: BaseColumns,
    /// Reflectance of everything below the last scatterer, `[node, column]`: over the base (if it is
    /// specular), then, as the last column, over black.
    pub(super) below: Matrix,
    pub(super) inactive: Vec<f64>,
}

/// The base itself.
#[derive(Debug)]
pub(super) enum BaseColumns {
    /// `[node, column]`.
    Specular(Matrix),
    /// By column.
    Lambertian(Vec<f64>),
}

impl Columns {
    /// Computes the columns of the groups of one family.
    pub(super) fn new(stack: &Stack, groups: &[&Group]) -> Vec<Self> {
        let known = match (&stack.base().reflector, groups.first()) {
            (Reflector::Specular(_), Some(group)) => Some(specular(stack, group)),
            _ => None,
        };
        groups.iter().map(|group| Self::of_group(stack, group, known.as_ref())).collect()
    }

    fn of_group(stack: &Stack, group: &Group, known: Option<&Matrix>) -> Self {
        let (states, bins) = (stack.base().states(), stack.base().bins());
        let place: Vec<usize> =
            (0..states).flat_map(|state| group.bins.iter().map(move |bin| state * bins + bin)).collect();
        let inactive = place.iter().map(|at| stack.base().inactive_absorptance[at % bins]).collect();
        let flats = &group.lower.flats;
        let black = |i: usize| flats[i].above;
        let (base, below) = match &stack.base().reflector {
            Reflector::Specular(_) => {
                let base = Matrix::from_fn(group.beta.len(), place.len(), |i, c| {
                    known.map_or(0.0, |all| all[(place[c], i)])
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

    /// Returns the number of columns.
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

/// Returns the reflectance of the base at every node that its medium carries: `[place, node]`.
fn specular(stack: &Stack, group: &Group) -> Matrix {
    let mut all = Matrix::zeros(stack.base().states() * stack.base().bins(), group.beta.len());
    let air = crate::Medium::new(vec![1.0; stack.base().bins()].into());
    let medium = stack.layers.last().map_or(&air, |layer| &layer.medium);
    for (beta, (_, column)) in
        group.beta.iter().zip(all.columns_mut()).filter(|(beta, _)| **beta < group.index)
    {
        stack.reflectance_of(stack.base(), Beta { x: *beta, y: 0.0 }, medium, column);
    }
    all
}

/// Returns the light that arrives at the base below flat layers, per unit that falls on the layers.
pub(super) fn arrives(flat: Flat, base: f64) -> f64 {
    let open = 1.0 - base * flat.below;
    if open > 0.0 { flat.t / open } else { 0.0 }
}

/// Returns the reflectance of flat layers and base.
fn over_base(flat: Flat, base: f64) -> f64 {
    flat.above + flat.t * base * arrives(flat, base)
}
