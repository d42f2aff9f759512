//! Assignment of a path's uniform random numbers to its decisions.

use papilio_sampling::PLANNED_BLOCKS;

use super::Diffused;
use crate::walk::PathNumbers;

/// Uniform random numbers of one pass, separate ones for each decision.
#[derive(Clone, Copy)]
pub(super) struct PassNumbers<'a> {
    pub(super) path: &'a PathNumbers<'a>,
    pub(super) pass: u32,
    pub(super) down: [f64; 2],
    pub(super) up: [f64; 2],
    /// Direction of light from a Lambertian base.
    pub(super) base: [f64; 2],
    /// Whether the path continues.
    pub(super) survival: f64,
    /// Point of a source.
    pub(super) on_source: [f64; 2],
    /// Direction below the diffuser, sampled from the source's side.
    pub(super) backwards: [f64; 2],
}

impl<'a> PassNumbers<'a> {
    #[inline]
    pub(super) fn new(numbers: &'a PathNumbers<'a>, pass: u32, walk: &Diffused<'_>) -> Self {
        match pass {
            0 => return Self::first(numbers, walk),
            1 => return Self::second(numbers, walk),
            _ => {}
        }
        let [down @ .., a, b] = numbers.block(Self::of_pass(pass));
        let [base @ .., survival, _] = numbers.block(Self::of_pass(pass) + 1);
        let [on_source @ .., d, e] =
            if walk.directed { numbers.block(Self::of_pass(pass) + 2) } else { [0.5; 4] };
        Self { path: numbers, pass, down, up: [a, b], base, survival, on_source, backwards: [d, e] }
    }

    /// Returns planned numbers. A direction sampled from either end is two techniques, whose errors do not
    /// depend on each other's numbers: the same, best numbers serve both.
    #[inline]
    fn first(numbers: &'a PathNumbers<'a>, walk: &Diffused<'_>) -> Self {
        let down = numbers.beside_field();
        let [of_base @ .., on_source, beside] =
            if walk.discs || !walk.specular { numbers.block(1) } else { [0.5; 4] };
        let [_, _, last @ ..] = if walk.specular { [0.5; 4] } else { numbers.block(PLANNED_BLOCKS - 1) };
        let (up, backwards) = if walk.specular { (of_base, down) } else { (last, of_base) };
        let on_source = [on_source, beside];
        Self { path: numbers, pass: 0, down, up, base: of_base, survival: 1.0, on_source, backwards }
    }

    /// Returns planned numbers as well, since the path that continues starts again.
    #[inline]
    fn second(numbers: &'a PathNumbers<'a>, walk: &Diffused<'_>) -> Self {
        let [down @ .., a, b] = numbers.block(PLANNED_BLOCKS - 2);
        let [up @ .., c, d] = numbers.block(PLANNED_BLOCKS - 1);
        let [survival, ..] = numbers.block(Self::of_pass(1));
        let (base, on_source) = ([a, b], [c, d]);
        let backwards = if walk.specular { down } else { base };
        Self { path: numbers, pass: 1, down, up, base, survival, on_source, backwards }
    }

    /// Returns the first block of a pass after the first; each has four.
    #[inline]
    fn of_pass(pass: u32) -> u32 {
        PLANNED_BLOCKS + 4 * pass
    }

    /// Returns the numbers for the way out: up through the diffuser, and before that from a Lambertian base.
    pub(super) fn going_on(&self) -> [f64; 4] {
        self.path.block(if self.pass == 0 { 1 } else { Self::of_pass(self.pass) + 3 })
    }
}
