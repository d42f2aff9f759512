//! Coverages of any states with the least variance of luminance.
//!
//! **What.** More than four states mix most colours in many ways. The least visible pattern, approximately,
//! is that whose states differ least in luminance: `min sum c_s (Y_s - Y)²` subject to `sum c_s XYZ_s = XYZ`,
//! `sum c_s = 1`, `c_s >= 0`, a linear programme. Since the mean of Y is fixed, the objective is
//! `sum c_s Y_s²` without a constant, which does not depend on the colour: the solution is a fixed
//! triangulation of the hull, the lower side of the hull of the points (X, Y, Z, Y²). It is computed once; a
//! colour then finds its tetrahedron as the one whose linear function is largest. At most four states are
//! used, and coverages are continuous in the colour.
//!
//! **Parameters.** X, Y, Z of 2 to 64 states. If several solutions are equally good, the earlier states
//! decide, by 1e-9 of the objective.
//!
//! **Source.** The minimal-brightness-variation criterion of Shaked, Arad, Fitzhugh, Sobel, *Ink relocation
//! for color halftones*, PICS 1998, as a linear programme over Neugebauer primaries: Morovič, Morovič,
//! Arnabat, *HANS*, IEEE Trans. Image Process. 21, 688 (2012).

use super::hull::require_states;
use super::span::Span;
use crate::matrix::dot;
use crate::{ColourError, Xyz};

/// Coverage below 0, or distance from the states' plane relative to the brightest, up to which a colour is
/// taken to be inside.
const TOLERANCE: f64 = 1e-6;
/// Weight of the order of the states, relative to the squared luminance of the brightest.
const ORDER: f64 = 1e-9;

/// Coverages of at most four states; they are at least 0 and their sum is 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coverages {
    states: [usize; 4],
    coverages: [f64; 4],
}

impl Coverages {
    /// Index and coverage of each state with a coverage above 0.
    pub fn iter(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.states.iter().copied().zip(self.coverages).filter(|(_, coverage)| *coverage > 0.0)
    }

    /// Coverage of a state.
    pub fn of(&self, state: usize) -> f64 {
        self.iter().filter(|(one, _)| *one == state).map(|(_, coverage)| coverage).sum()
    }
}

/// A simplex of states: a tetrahedron, or a triangle or segment of states in a plane or on a line.
#[derive(Debug, Clone, PartialEq)]
struct Cell {
    states: [usize; 4],
    /// Coverages as linear functions of the coordinates: three factors and a constant each.
    coverages: [[f64; 4]; 4],
    /// The objective as such a function.
    objective: [f64; 4],
}

/// Coverages with the least variance of luminance, for states in one light and view.
#[derive(Debug, Clone, PartialEq)]
pub struct LeastVariance {
    span: Span,
    cells: Vec<Cell>,
}

fn value(function: &[f64; 4], at: [f64; 3]) -> f64 {
    function[0] * at[0] + function[1] * at[1] + function[2] * at[2] + function[3]
}

impl LeastVariance {
    /// Triangulates the hull of the states.
    ///
    /// # Errors
    ///
    /// [`ColourError::States`] unless there are 2 to 64 states with finite values.
    pub fn new(states: &[Xyz]) -> Result<Self, ColourError> {
        require_states(states)?;
        let span = Span::of(states);
        let at: Vec<_> = states.iter().map(|state| span.coordinates(*state)).collect();
        let brightest = states.iter().map(|state| state.y.abs()).fold(f64::MIN_POSITIVE, f64::max);
        // Irregular numbers of increasing size: no five states remain on one plane of the four-dimensional
        // hull.
        let order = |state: usize| ORDER * ((state + 1) as f64).sqrt();
        let heights: Vec<_> =
            states.iter().enumerate().map(|(k, state)| (state.y / brightest).powi(2) + order(k)).collect();
        let mut triangulation = Self { span, cells: Vec::new() };
        let mut chosen = [0; 4];
        triangulation.add_cells(&at, &heights, &mut chosen, 0, 0);
        Ok(triangulation)
    }

    /// Tries all sets of `rank + 1` states that begin with the chosen ones.
    fn add_cells(
        &mut self,
        at: &[[f64; 3]],
        heights: &[f64],
        chosen: &mut [usize; 4],
        count: usize,
        from: usize,
    ) {
        if count <= self.span.rank {
            for state in from..at.len() {
                chosen[count] = state;
                self.add_cells(at, heights, chosen, count + 1, state + 1);
            }
            return;
        }
        let Some(inverse) = inverse_of_simplex(&chosen[..count], at) else { return };
        let mut cell = Cell { states: [chosen[0]; 4], coverages: [[0.0; 4]; 4], objective: [0.0; 4] };
        for (k, row) in inverse.iter().take(count).enumerate() {
            cell.states[k] = chosen[k];
            cell.coverages[k] = *row;
            (0..4).for_each(|i| cell.objective[i] += heights[chosen[k]] * row[i]);
        }
        if at.iter().zip(heights).all(|(point, height)| *height - value(&cell.objective, *point) > -1e-12) {
            self.cells.push(cell);
        }
    }

    /// Computes the coverages of a colour; `None` if it is outside the hull by more than 1e-6 of a coverage.
    pub fn coverages(&self, colour: Xyz) -> Option<Coverages> {
        if self.span.distance(colour) > TOLERANCE * self.span.size {
            return None;
        }
        let at = self.span.coordinates(colour);
        let mut best: Option<(&Cell, f64)> = None;
        for cell in &self.cells {
            let objective = value(&cell.objective, at);
            if best.is_none_or(|(_, most)| objective > most) {
                best = Some((cell, objective));
            }
        }
        let (cell, _) = best?;
        let raw = cell.coverages.map(|function| value(&function, at));
        if !raw.iter().all(|coverage| *coverage >= -TOLERANCE) {
            return None;
        }
        let positive = raw.map(|coverage| coverage.max(0.0));
        let sum: f64 = positive.iter().sum();
        Some(Coverages { states: cell.states, coverages: positive.map(|coverage| coverage / sum) })
    }
}

/// Coverages of the corners of a simplex as linear functions of coordinates; `None` if it has no volume.
fn inverse_of_simplex(corners: &[usize], at: &[[f64; 3]]) -> Option<[[f64; 4]; 4]> {
    let count = corners.len();
    // Rows of the system: each used coordinate, then the sum of the coverages. On the right: the unit matrix.
    let mut m = [[0.0; 8]; 4];
    for row in 0..count {
        for (column, corner) in corners.iter().enumerate() {
            m[row][column] = if row + 1 < count { at[*corner][row] } else { 1.0 };
        }
        m[row][4 + if row + 1 < count { row } else { 3 }] = 1.0;
    }
    for column in 0..count {
        let pivot = (column..count).max_by(|i, k| m[*i][column].abs().total_cmp(&m[*k][column].abs()))?;
        if m[pivot][column].abs() < 1e-9 {
            return None;
        }
        m.swap(column, pivot);
        let scale = 1.0 / m[column][column];
        m[column].iter_mut().for_each(|entry| *entry *= scale);
        let done = m[column];
        for (row, entries) in m.iter_mut().enumerate().take(count) {
            if row != column {
                let factor = entries[column];
                entries.iter_mut().zip(done).for_each(|(entry, part)| *entry -= factor * part);
            }
        }
    }
    Some(m.map(|row| [row[4], row[5], row[6], row[7]]))
}

/// Weights of the points whose mixture is nearest to the origin, with their indices: Wolfe's algorithm.
pub(crate) fn nearest_weights(points: &[[f64; 3]]) -> Vec<(usize, f64)> {
    let size = points.iter().map(|point| dot(*point, *point)).fold(f64::MIN_POSITIVE, f64::max);
    let first =
        (0..points.len()).min_by(|i, k| dot(points[*i], points[*i]).total_cmp(&dot(points[*k], points[*k])));
    let mut set = vec![(first.unwrap_or(0), 1.0)];
    let mixture = |set: &[(usize, f64)]| {
        set.iter().fold([0.0; 3], |sum, (k, weight)| [0, 1, 2].map(|i| sum[i] + weight * points[*k][i]))
    };
    // Each round ends nearer to the origin with a subset that was not met before; the number only bounds
    // rounding.
    for _ in 0..8 * points.len() {
        let here = mixture(&set);
        let along = |k: &usize| dot(here, points[*k]);
        let Some(next) = (0..points.len()).min_by(|i, k| along(i).total_cmp(&along(k))) else { break };
        if dot(here, here) - along(&next) <= 1e-14 * size
            || set.iter().any(|(k, _)| *k == next)
            || set.len() == 4
        {
            break;
        }
        set.push((next, 0.0));
        while let Some(affine) = nearest_of_plane(&set, points) {
            if affine.iter().all(|weight| *weight > 0.0) {
                set.iter_mut().zip(affine).for_each(|(member, weight)| member.1 = weight);
                break;
            }
            let ratio = |(member, weight): (&(usize, f64), &f64)| member.1 / (member.1 - weight);
            let blocked = set.iter().zip(&affine).filter(|(_, weight)| **weight <= 0.0).map(ratio);
            let step = blocked.fold(1.0, f64::min);
            for (member, weight) in set.iter_mut().zip(&affine) {
                member.1 += step * (weight - member.1);
            }
            let least =
                (0..set.len()).filter(|k| affine[*k] <= 0.0).min_by(|i, k| set[*i].1.total_cmp(&set[*k].1));
            least.map(|k| set.remove(k));
        }
        if set.len() > 1 && nearest_of_plane(&set, points).is_none() {
            set.retain(|(_, weight)| *weight > 0.0);
            break;
        }
    }
    let sum: f64 = set.iter().map(|(_, weight)| weight).sum();
    set.iter().map(|(k, weight)| (*k, weight / sum)).collect()
}

/// Weights of the point nearest to the origin in the plane of a set of points; `None` if they are not
/// independent.
fn nearest_of_plane(set: &[(usize, f64)], points: &[[f64; 3]]) -> Option<Vec<f64>> {
    let count = set.len();
    let base = points[set[0].0];
    let edges: Vec<_> = set[1..].iter().map(|(k, _)| super::span::difference(points[*k], base)).collect();
    let mut m: Vec<Vec<f64>> = edges
        .iter()
        .map(|edge| edges.iter().map(|other| dot(*edge, *other)).chain([-dot(*edge, base)]).collect())
        .collect();
    let size = edges.iter().map(|edge| dot(*edge, *edge)).fold(0.0, f64::max);
    for column in 0..count - 1 {
        let pivot = (column..count - 1).max_by(|i, k| m[*i][column].abs().total_cmp(&m[*k][column].abs()))?;
        if m[pivot][column].abs() <= 1e-14 * size {
            return None;
        }
        m.swap(column, pivot);
        let done = m[column].clone();
        for (row, entries) in m.iter_mut().enumerate() {
            if row != column {
                let factor = entries[column] / done[column];
                entries.iter_mut().zip(&done).for_each(|(entry, part)| *entry -= factor * part);
            }
        }
    }
    let others: Vec<f64> = (0..count - 1).map(|k| m[k][count - 1] / m[k][k]).collect();
    Some(std::iter::once(1.0 - others.iter().sum::<f64>()).chain(others).collect())
}
