//! Convex hull of the states of a display in X, Y, Z.
//!
//! **What.** All colours that mixtures of the states by area have: an intersection of half-spaces, each with
//! one face of the hull as its border. Every half-space contains all states exactly, so that rounding may
//! enlarge the hull by 1e-7 of the brightest state but never cuts a state off.
//!
//! **Parameters.** X, Y, Z of 2 to 64 states in one light and view, on one scale.
//!
//! **Range.** Any states. Greys on a line, or black, white and one ink, have a hull without volume
//! (`dimensions` below 3); states that differ from a line or plane by less than 1e-9 of their extent are on
//! it.

use super::span::{Span, difference, length};
use crate::matrix::{cross, dot};
use crate::{ColourError, Xyz};

/// Distance from the hull, relative to the brightest state, up to which a colour is contained.
pub const TOLERANCE: f64 = 1e-9;

/// Largest number of states.
pub(super) const MOST_STATES: usize = 64;

/// Colours on one side of a plane: `normal . xyz <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct HalfSpace {
    pub(crate) normal: [f64; 3],
    pub(crate) offset: f64,
}

/// The convex hull of the states of a display.
#[derive(Debug, Clone, PartialEq)]
pub struct StateHull {
    states: Vec<Xyz>,
    span: Span,
    half_spaces: Vec<HalfSpace>,
}

/// Checks the number of states and that they are finite.
pub(super) fn require_states(states: &[Xyz]) -> Result<(), ColourError> {
    let finite = states.iter().all(|state| state.to_array().iter().all(|value| value.is_finite()));
    if finite && (2..=MOST_STATES).contains(&states.len()) {
        Ok(())
    } else {
        Err(ColourError::States { states: states.len() })
    }
}

impl StateHull {
    /// Computes the hull.
    ///
    /// # Errors
    ///
    /// [`ColourError::States`] unless there are 2 to 64 states with finite values.
    pub fn new(states: &[Xyz]) -> Result<Self, ColourError> {
        require_states(states)?;
        let span = Span::of(states);
        let mut hull = Self { states: states.to_vec(), span, half_spaces: Vec::new() };
        for normal in hull.span.perpendicular().to_vec() {
            hull.add(normal);
            hull.add(normal.map(|part| -part));
        }
        hull.add_faces();
        Ok(hull)
    }

    /// Finds the faces: planes through states that have all others on one side.
    fn add_faces(&mut self) {
        let at: Vec<_> = self.states.iter().map(|state| self.span.coordinates(*state)).collect();
        let mut faces: Vec<[f64; 3]> = Vec::new();
        let mut try_plane = |normal: [f64; 3]| {
            let size = length(normal);
            if size < 1e-10 {
                return;
            }
            for normal in [1.0, -1.0].map(|sign| normal.map(|part| sign * part / size)) {
                let offset = at.iter().map(|point| dot(normal, *point)).fold(f64::NEG_INFINITY, f64::max);
                let needed = if self.span.rank == 3 { 3 } else { self.span.rank };
                let on = at.iter().filter(|point| offset - dot(normal, **point) < 1e-10).count();
                let new = !faces.iter().any(|face| length(difference(*face, normal)) < 1e-9);
                if on >= needed && new {
                    faces.push(normal);
                }
            }
        };
        let count = at.len();
        match self.span.rank {
            0 => {}
            1 => try_plane([1.0, 0.0, 0.0]),
            2 => {
                for (i, j) in (0..count).flat_map(|i| (0..i).map(move |j| (i, j))) {
                    try_plane(cross(difference(at[j], at[i]), [0.0, 0.0, 1.0]));
                }
            }
            _ => {
                for (i, j) in (0..count).flat_map(|i| (0..i).map(move |j| (i, j))) {
                    for k in 0..j {
                        try_plane(cross(difference(at[j], at[i]), difference(at[k], at[i])));
                    }
                }
            }
        }
        for face in faces {
            self.add(self.span.normal(face));
        }
    }

    /// Adds the half-space with this normal that just contains all states.
    fn add(&mut self, normal: [f64; 3]) {
        let along = self.states.iter().map(|state| dot(normal, state.to_array()));
        let offset = along.fold(f64::NEG_INFINITY, f64::max);
        self.half_spaces.push(HalfSpace { normal, offset });
    }

    /// The states.
    pub fn states(&self) -> &[Xyz] {
        &self.states
    }

    /// The half-spaces whose intersection the hull is.
    pub(crate) fn half_spaces(&self) -> &[HalfSpace] {
        &self.half_spaces
    }

    /// Length of X, Y, Z of the brightest state.
    pub(crate) fn size(&self) -> f64 {
        self.span.size
    }

    /// Number of dimensions of the hull: 3, or 2 of states in a plane, 1 of states on a line, 0 of equal
    /// states.
    pub fn dimensions(&self) -> usize {
        self.span.rank
    }

    /// Number of faces of a hull with volume, of edges of a flat one, of ends of a line.
    pub fn faces(&self) -> usize {
        self.half_spaces.len() - 2 * self.span.perpendicular().len()
    }

    /// Largest distance of a colour from a face, towards the outside, in X, Y, Z: at most 0 inside.
    pub fn excess(&self, colour: Xyz) -> f64 {
        let colour = colour.to_array();
        let out = self.half_spaces.iter().map(|side| dot(side.normal, colour) - side.offset);
        out.fold(f64::NEG_INFINITY, f64::max)
    }

    /// Returns whether a mixture of the states has this colour, within 1e-9 of the brightest state.
    pub fn contains(&self, colour: Xyz) -> bool {
        self.contains_within(colour, TOLERANCE)
    }

    /// Returns whether the colour is outside no face by more than a tolerance, relative to the brightest
    /// state.
    pub fn contains_within(&self, colour: Xyz, tolerance: f64) -> bool {
        let (colour, tolerance) = (colour.to_array(), tolerance * self.span.size);
        self.half_spaces.iter().all(|side| dot(side.normal, colour) - side.offset <= tolerance)
    }

    /// Normal of the plane of a flat hull.
    pub(crate) fn plane(&self) -> Option<[f64; 3]> {
        (self.span.rank == 2).then(|| self.span.perpendicular()[0])
    }

    /// Part of a step, 0 to 1, that is inside the hull, from a contained colour.
    pub(crate) fn part_inside(&self, from: Xyz, step: Xyz) -> f64 {
        let (from, step) = (from.to_array(), step.to_array());
        let slack = TOLERANCE * self.span.size;
        let part = |side: &HalfSpace| {
            let (rate, room) = (dot(side.normal, step), side.offset - dot(side.normal, from));
            // Along a plane of a flat hull, the rate is rounding.
            if rate > slack { (room / rate).max(0.0) } else { 1.0 }
        };
        self.half_spaces.iter().map(part).fold(1.0, f64::min)
    }

    /// Returns the contained colour that is nearest: the Euclidean distance of X, Y and Z, each divided by
    /// that of `white`.
    ///
    /// It is unique. The algorithm is that of P. Wolfe, *Finding the nearest point in a polytope*, Math.
    /// Programming 11, 128 (1976).
    pub fn nearest(&self, colour: Xyz, white: Xyz) -> Xyz {
        if self.contains_within(colour, 0.0) {
            return colour;
        }
        let (white, colour) = (white.to_array(), colour.to_array());
        let scaled = |state: &Xyz| {
            let state = state.to_array();
            [0, 1, 2].map(|k| (state[k] - colour[k]) / white[k])
        };
        let points: Vec<_> = self.states.iter().map(scaled).collect();
        let weights = super::mixture::nearest_weights(&points);
        weights
            .iter()
            .fold(Xyz { x: 0.0, y: 0.0, z: 0.0 }, |sum, (state, weight)| sum + self.states[*state] * *weight)
    }
}
