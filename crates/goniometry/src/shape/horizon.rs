//! Directions near the horizon that were not measured: where a file ends, or holds zeros.
//!
//! Many instruments end some degrees before the horizon, and write zeros beyond. No light in any direction beyond one
//! inclination, where the lobes did not decrease before, is the end of the instrument and not that of the light: these cells
//! count as not measured. So do zeros at the horizon itself, which has no projected area.

use std::borrow::Cow;

use super::resample::on_rings;
use crate::{Geometry, MeasuredPart};

/// Inclination from which zeros are those of the horizon itself, degrees.
const HORIZON_DEG: f64 = 89.99;
/// Smallest inclination at which zeros in all directions are the end of an instrument, degrees.
const LEAST_END_DEG: f64 = 60.0;
/// Cells within this angle of the end, degrees, must have light, but for a few of them.
const BAND_DEG: f64 = 10.0;
const LIT_IN_BAND: f64 = 0.9;
/// Rounding of angles, degrees.
const SAME_DEG: f64 = 0.01;
/// Smallest ratio of a value to that before it, in the median over the lines that end there: a lobe that decreases faster may
/// be dark beyond.
const JUMP: f64 = 0.5;

/// Largest inclination, degrees, to which light was measured, if that is before the horizon: the last row of a grid of
/// inclinations, or where the light of all lobes ends at once.
pub(crate) fn inclined_to_deg(part: &MeasuredPart, channel: usize) -> Option<f64> {
    let part = &*on_rings(part);
    let end = dark_beyond_deg(part, channel);
    let last = match &part.geometry {
        Geometry::Spherical(grid) => {
            let azimuths = grid.phi_o_deg.len().max(1);
            let rows = part.channel(channel).chunks_exact(azimuths).enumerate();
            let known = rows.filter(|(_, row)| row.iter().any(|value| value.is_finite()));
            known.map(|(row, _)| row % grid.theta_o_deg.len()).max().map(|row| grid.theta_o_deg[row])
        }
        Geometry::Pairs(pairs) => {
            let known = pairs.iter().zip(part.channel(channel)).filter(|(_, value)| value.is_finite());
            known.map(|([_, to], _)| to.theta_deg).max_by(f64::total_cmp)
        }
        _ => None,
    };
    [end, last].into_iter().flatten().min_by(f64::total_cmp).filter(|theta| *theta < 90.0 - 1e-6)
}

/// Returns the part with the zeros that were not measured as such.
pub(super) fn without_dark_horizon(part: &MeasuredPart) -> Cow<'_, MeasuredPart> {
    let Some(end_deg) = dark_beyond_deg(part, part.luminous()) else { return Cow::Borrowed(part) };
    let cells = part.geometry.cells();
    let mut part = part.clone();
    for (number, value) in part.values.iter_mut().enumerate().filter(|(_, value)| **value == 0.0) {
        if theta_deg(&part.geometry, number % cells).is_some_and(|theta| theta > end_deg - SAME_DEG) {
            *value = f64::NAN;
        }
    }
    Cow::Owned(part)
}

/// Inclination of the viewer, degrees, of a cell in the hemisphere.
fn theta_deg(geometry: &Geometry, cell: usize) -> Option<f64> {
    geometry.directions(cell).map(|[_, to]| to.theta_deg)
}

/// Inclination beyond which all cells of a grid hold zeros that were not measured.
fn dark_beyond_deg(part: &MeasuredPart, channel: usize) -> Option<f64> {
    let lines = Lines::of(&part.geometry)?;
    let values = part.channel(channel);
    let known =
        || (0..values.len()).filter_map(|cell| Some((theta_deg(&part.geometry, cell)?, values[cell])));
    let end_deg = known().filter(|(_, f)| *f > 0.0).map(|(theta, _)| theta).max_by(f64::total_cmp)?;
    let mut dark =
        known().filter(|(theta, f)| *f == 0.0 && *theta > end_deg + 1e-6).map(|(theta, _)| theta).peekable();
    dark.peek()?;
    if dark.all(|theta| theta > HORIZON_DEG) {
        return Some(end_deg);
    }
    let band =
        || known().filter(|(theta, f)| f.is_finite() && (end_deg - BAND_DEG..=end_deg).contains(theta));
    let lit = band().filter(|(_, f)| *f > 0.0).count() as f64 / band().count().max(1) as f64;
    if end_deg < LEAST_END_DEG || lit < LIT_IN_BAND {
        return None;
    }
    let mut ratios: Vec<f64> = (0..values.len())
        .filter_map(|cell| {
            let [before, after] = lines.neighbours(cell)?;
            let beyond = theta_deg(&part.geometry, after)? > end_deg + 1e-6;
            (beyond && values[cell] > 0.0 && values[before] > 0.0).then(|| values[cell] / values[before])
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios.get(ratios.len() / 2).filter(|ratio| **ratio >= JUMP).map(|_| end_deg)
}

/// Lines of cells outwards from the specular direction, or from the normal.
struct Lines {
    /// Number of cells from one to the next of its line.
    stride: usize,
    /// Number of cells of a line.
    length: usize,
}

impl Lines {
    fn of(geometry: &Geometry) -> Option<Self> {
        match geometry {
            Geometry::Specular(grid) => Some(Self { stride: 1, length: grid.radials_deg.len() }),
            Geometry::Spherical(grid) => {
                Some(Self { stride: grid.phi_o_deg.len(), length: grid.theta_o_deg.len() })
            }
            _ => None,
        }
    }

    /// Cells before and after a cell on its line.
    fn neighbours(&self, cell: usize) -> Option<[usize; 2]> {
        let on_line = cell / self.stride % self.length;
        (on_line > 0 && on_line + 1 < self.length).then(|| [cell - self.stride, cell + self.stride])
    }
}
