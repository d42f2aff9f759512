//! Light of the states by frequency and place, summed over paths.

use num_complex::Complex64;
use papilio_transport::ReflectanceFactor;
use papilio_transport::walk::places::Kernel;

use crate::spatial::measured::{Light, sum};

/// Sums of a replicate, or of several.
pub(super) struct Sums {
    /// `[state][light]`.
    lights: Vec<Vec<OfLight>>,
}

/// Light of a state in one light. All but Y is in the unit of the response.
struct OfLight {
    y: f64,
    light: Light,
    cells: Vec<f64>,
}

impl Sums {
    /// Sums of lights: luminous weights, light of the states, and their response.
    pub(super) fn new<'a>(
        lights: impl Iterator<Item = (&'a [f64], &'a ReflectanceFactor, &'a Kernel)>,
        states: usize,
        frequencies: usize,
    ) -> Self {
        let mut all: Vec<Vec<OfLight>> = (0..states).map(|_| Vec::new()).collect();
        for (weights, rho, kernel) in lights {
            let rows = rho.via_pixel.chunks_exact(weights.len());
            for (state, (of_state, row)) in all.iter_mut().zip(rows).enumerate() {
                let part = |values: &[f64]| {
                    let count = values.len() / states;
                    values[state * count..][..count].to_vec()
                };
                let transfer = &kernel.transfer[2 * state * frequencies..][..2 * frequencies];
                of_state.push(OfLight {
                    y: row.iter().zip(weights).map(|(light, weight)| light * weight).sum(),
                    light: Light {
                        transfer: [0, 1].map(|axis| transfer[axis * frequencies..][..frequencies].to_vec()),
                        strips: [0, 1].map(|axis| part(&kernel.strips[axis])),
                        rings: part(&kernel.rings),
                    },
                    cells: part(&kernel.cells),
                });
            }
        }
        Self { lights: all }
    }

    /// Empty sums of the same shape.
    pub(super) fn zeros(&self) -> Self {
        let mut zeros = Self { lights: Vec::new() };
        for lights in &self.lights {
            zeros.lights.push(lights.iter().map(OfLight::zeros).collect());
        }
        zeros
    }

    /// Adds others, times a weight.
    pub(super) fn add(&mut self, other: &Self, weight: f64) {
        for (own, other) in self.lights.iter_mut().flatten().zip(other.lights.iter().flatten()) {
            own.add(other, weight);
        }
    }

    /// Each light with its Y, and at last their sum; `[state][light]`.
    pub(super) fn lights(&self) -> Vec<Vec<Light>> {
        let of_state = |lights: &Vec<OfLight>| {
            let mut lights: Vec<Light> = lights.iter().map(|one| one.light.scaled(one.scale())).collect();
            let all = sum(&lights);
            lights.extend(all);
            lights
        };
        self.lights.iter().map(of_state).collect()
    }

    /// Fractions of the light in the cells, without the last, which is all light beyond; `[state][cell]`.
    pub(super) fn cells(&self) -> Vec<Vec<f64>> {
        let of_state = |lights: &Vec<OfLight>| {
            let y: f64 = lights.iter().map(|one| one.y).sum();
            let count = lights.first().map_or(0, |one| one.cells.len() - 1);
            let cell = |k: usize| lights.iter().map(|one| one.scale() * one.cells[k]).sum::<f64>();
            (0..count).map(|k| if y > 0.0 { cell(k) / y } else { 0.0 }).collect()
        };
        self.lights.iter().map(of_state).collect()
    }
}

impl OfLight {
    fn zeros(&self) -> Self {
        Self { y: 0.0, light: self.light.scaled(0.0), cells: vec![0.0; self.cells.len()] }
    }

    /// Factor by which the response has the Y of the light at frequency 0.
    fn scale(&self) -> f64 {
        let zero = self.light.transfer[0][0].re;
        if zero > 0.0 { self.y / zero } else { 0.0 }
    }

    fn add(&mut self, other: &Self, weight: f64) {
        let add = |sum: &mut [f64], more: &[f64]| {
            sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += weight * more);
        };
        self.y += weight * other.y;
        add(&mut self.cells, &other.cells);
        add(&mut self.light.rings, &other.light.rings);
        for axis in [0, 1] {
            add(&mut self.light.strips[axis], &other.light.strips[axis]);
            let more = other.light.transfer[axis].iter();
            let pairs = self.light.transfer[axis].iter_mut().zip(more);
            pairs.for_each(|(sum, more): (&mut Complex64, _)| *sum += weight * more);
        }
    }
}
