//! Branches of many paths, followed side by side.
//!
//! All branches of a batch of paths advance together, one event at a time: a *generation*. Branches of a
//! generation are ordered by where they are, and the points of a low-discrepancy set are given to them in
//! this order. Neighbours, whose futures are distributed almost equally, then take decisions that complement
//! each other, in every generation and not only in the first few (array-RQMC: P. L'Ecuyer, C. Lécot, B.
//! Tuffin, Oper. Res. 56, 958 (2008)). Each branch by itself has uniform numbers that are independent of its
//! past, since the set of each generation of each batch is randomized again: estimates are unbiased, and the
//! errors of batches are independent. Roulette is systematic for the same reason ([`Roulette`]).

use papilio_sampling::SampleStream;

use super::bulk::Stay;
use super::light::Light;
use super::{Gathered, OutgoingRay};

/// The branches that are to be followed.
#[derive(Debug, Clone, Default)]
pub(super) struct Generation {
    pub(super) travelling: Vec<Travelling>,
    pub(super) arrived: Vec<Arrived>,
    /// Memory for further branches.
    spare: Vec<Light>,
}

/// A branch between two events.
#[derive(Debug, Clone)]
pub(super) struct Travelling {
    /// The path, from 0 in the batch.
    pub(super) path: usize,
    /// Number of its meetings with a pixel that scatters.
    pub(super) meetings: u32,
    pub(super) sent: OutgoingRay,
    pub(super) light: Light,
}

/// A branch at an event that it takes part in.
#[derive(Debug, Clone)]
pub(super) struct Arrived {
    /// The path, from 0 in the batch.
    pub(super) path: usize,
    /// Number of its meetings with a pixel that scatters.
    pub(super) meetings: u32,
    /// Number of the event.
    pub(super) event: usize,
    pub(super) sent: OutgoingRay,
    /// Position in a scattering medium that the branch has entered before.
    pub(super) stay: Option<Stay>,
    pub(super) light: Light,
    pub(super) gathered: Gathered,
}

impl Generation {
    pub(super) fn is_empty(&self) -> bool {
        self.travelling.is_empty() && self.arrived.is_empty()
    }

    /// Returns a copy of light in used memory.
    fn copy(&mut self, light: &Light) -> Light {
        match self.spare.pop() {
            Some(mut copy) => {
                copy.clone_from(light);
                copy
            }
            None => light.clone(),
        }
    }

    /// Adds a branch that leaves an event; returns its light.
    pub(super) fn depart(
        &mut self,
        (path, meetings): (usize, u32),
        sent: OutgoingRay,
        light: &Light,
    ) -> &mut Light {
        let light = self.copy(light);
        self.travelling.push(Travelling { path, meetings, sent, light });
        let last = self.travelling.len() - 1;
        &mut self.travelling[last].light
    }

    /// Adds a branch that arrives at an event.
    pub(super) fn arrive(
        &mut self,
        (path, meetings): (usize, u32),
        event: usize,
        sent: OutgoingRay,
        light: &Light,
    ) {
        let light = self.copy(light);
        self.arrived.push(Arrived { path, meetings, event, sent, stay: None, light, gathered: Vec::new() });
    }

    /// Keeps the memory of light that has been followed.
    pub(super) fn recycle(&mut self, light: Light) {
        if !light.fresh.is_empty() {
            self.spare.push(light);
        }
    }

    /// Frees memory.
    pub(super) fn shrink(&mut self) {
        *self = Self::default();
    }
}

/// Random numbers of a generation of a batch.
///
/// Each generation of each batch has a set with a scramble of its own. A set that continued over the batches
/// would give a branch of the same rank nearly the same number in every batch (the leading digits of a Sobol
/// point follow from the last digits of its index), and the error of these pairs of rank and number would not
/// fall with the number of batches.
#[derive(Debug)]
pub(super) struct GenerationNumbers(SampleStream);

impl GenerationNumbers {
    /// Numbers for generation `generation` of the batch that begins with path `first`.
    pub(super) fn new(numbers: &SampleStream, generation: u32, first: u64) -> Self {
        Self(numbers.part(u64::from(generation)).part(first))
    }

    /// Returns the numbers of the branch with this rank.
    pub(super) fn of(&self, rank: usize) -> [f64; 4] {
        self.0.block(rank as u64, 0)
    }

    /// Returns a roulette for each of several alternatives of a decision. Each decision has numbers of its
    /// own: which branches take the second one depends on the numbers of the first.
    pub(super) fn roulettes(&self, decision: Decision, count: usize) -> Vec<Roulette> {
        let numbers = self.0.independent().part(decision as u64);
        (0..count).map(|k| Roulette(numbers.block(k as u64, u32::MAX)[0])).collect()
    }
}

/// The decisions of a generation that are made by roulette.
#[derive(Debug, Clone, Copy)]
pub(super) enum Decision {
    /// At which events a branch arrives.
    Arrival,
    /// To which sides of an interface it goes on.
    Sides,
}

/// Systematic roulette: of consecutive branches, the number that survive differs from the sum of their
/// probabilities by less than one. (Each survives with exactly its own probability.)
#[derive(Debug, Clone)]
pub(super) struct Roulette(f64);

impl Roulette {
    pub(super) fn survives(&mut self, probability: f64) -> bool {
        if probability >= 1.0 {
            return true;
        }
        self.0 += probability;
        let survives = self.0 >= 1.0;
        if survives {
            self.0 -= 1.0;
        }
        survives
    }
}

/// Order of branches by a coarse class, and by several numbers from 0 to 1 so that neighbours are close in
/// all of them (Morton order).
pub(super) fn key<const N: usize>(class: usize, place: [f64; N]) -> u64 {
    let bits = (48 / N).min(16);
    let cells = place.map(|number| ((number * f64::from(1_u32 << bits)) as u64).min((1 << bits) - 1));
    let mut key = class as u64;
    for bit in (0..bits).rev() {
        for cell in cells {
            key = key << 1 | (cell >> bit & 1);
        }
    }
    key
}

/// Returns the indices of items in the order of their keys.
pub(super) fn order<T>(items: &[T], key: impl Fn(&T) -> u64) -> Vec<usize> {
    let mut keys: Vec<(u64, usize)> = items.iter().enumerate().map(|(k, item)| (key(item), k)).collect();
    keys.sort_unstable();
    keys.into_iter().map(|(_, k)| k).collect()
}
