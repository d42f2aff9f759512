//! Cells of a measurement as data of a fit.

use std::collections::HashMap;
use std::f64::consts::PI;

use papilio_optics::Beta;

use crate::models::{Model, Pair};
use crate::{Geometry, MeasuredPart, SpecularGrid, SphericalGrid, Symmetry};

/// Measured values with their directions, each direction once.
///
/// All lobes are isotropic and reciprocal. Equal values of directions that only a rotation, a mirror image or reciprocity distinguishes
/// are copies of one reading: those of a table that is listed twice, or of a file that was made symmetric. Each has its weight, but
/// for intervals they count once, because their errors are equal.
/// Cells without a value are omitted: NaN, or exactly 0, which files contain outside the instrument's field
/// of view. At radial distance 0, all azimuths of a specular-centred grid are the same direction. It counts
/// once, with the mean of their values.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Data {
    pub(super) cells: Vec<Cell>,
}

/// Rounding of cosines and of squared distances of equal pairs.
const SAME_PAIR: f64 = 1e-9;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Cell {
    pub(super) pair: Pair,
    pub(super) value: f64,
    /// Solid angle, sr; 1 if the geometry does not define it.
    pub(super) solid_angle: f64,
}

impl Data {
    /// Data from values f (1/sr) of pairs of directions: `[from, to]` of propagation in air, value.
    pub fn new(values: impl IntoIterator<Item = ([Beta; 2], f64)>) -> Self {
        let mut data = Self::default();
        values.into_iter().for_each(|([from, to], value)| data.push(from, to, value, 1.0));
        data
    }

    /// Data of one channel of a part, given by its index.
    pub fn of_part(part: &MeasuredPart, channel: usize) -> Self {
        let mut data = Self::default();
        let values = part.channel(channel);
        for (cell, &value) in values.iter().enumerate() {
            let Some([light, viewer]) = part.geometry.directions(cell) else { continue };
            let (value, solid_angle) = match &part.geometry {
                Geometry::Specular(grid) => match specular(grid, values, cell) {
                    Some(known) => known,
                    None => continue,
                },
                Geometry::Spherical(grid) => (value, spherical(grid, cell)),
                _ => (value, 1.0),
            };
            data.push(light.arriving(), viewer.leaving(), value, solid_angle);
        }
        data
    }

    /// Number of the reading of each cell, and the number of readings: copies have the same one.
    pub(super) fn readings(&self) -> (Vec<usize>, usize) {
        let key = |cell: &Cell| {
            let Pair { delta2, cos_in, cos_out } = cell.pair;
            let rounded = |x: f64| (x / SAME_PAIR).round() as i64;
            let [a, b] = [rounded(cos_in), rounded(cos_out)];
            (cell.value.to_bits(), rounded(delta2), a.min(b), a.max(b))
        };
        let mut known = HashMap::new();
        let mut number = |cell| {
            let next = known.len();
            *known.entry(key(cell)).or_insert(next)
        };
        let numbers = self.cells.iter().map(&mut number).collect();
        (numbers, known.len())
    }

    fn push(&mut self, from: Beta, to: Beta, value: f64, solid_angle: f64) {
        if let Some(pair) = Pair::new(from, to).filter(|_| value.is_finite() && value != 0.0) {
            self.cells.push(Cell { pair, value, solid_angle });
        }
    }

    /// Number of cells with a value.
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// Returns true if no cell has a value.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// Relative difference of a model's total over the cells from that of the data.
    pub(super) fn total_error(&self, f: impl Fn(&Pair) -> f64) -> f64 {
        let light = |cell: &Cell| cell.pair.cos_out * cell.solid_angle;
        let [ours, theirs] = self.cells.iter().fold([0.0; 2], |[ours, theirs], cell| {
            [ours + light(cell) * f(&cell.pair), theirs + light(cell) * cell.value]
        });
        ours / theirs - 1.0
    }

    /// Width of the k-correlation lobe with the half width of the data.
    pub(super) fn width(&self) -> f64 {
        let mut cells: Vec<&Cell> = self.cells.iter().collect();
        cells.sort_by(|a, b| a.pair.delta2.total_cmp(&b.pair.delta2));
        let peak = cells.iter().take(8).map(|cell| cell.value).fold(0.0, f64::max);
        // A k-correlation lobe has half its peak at b sqrt(2^(2/3) - 1).
        let half = cells.iter().find(|cell| cell.value < 0.5 * peak);
        half.map_or(1.0, |cell| cell.pair.delta2.sqrt() / 0.766).clamp(1e-3, 1.0)
    }

    /// Amplitude of a model, by linear least squares.
    pub(super) fn amplitude(&self, unit: &Model) -> f64 {
        let [product, square] = self.cells.iter().fold([0.0; 2], |[product, square], cell| {
            let f = unit.value_and_slopes(&cell.pair)[0];
            let weight = cell.pair.cos_in * cell.pair.cos_in;
            [product + weight * f * cell.value, square + weight * f * f]
        });
        if square > 0.0 { product / square } else { 1.0 }
    }
}

/// Value and solid angle of a cell; `None` if another cell represents its direction.
fn specular(grid: &SpecularGrid, values: &[f64], cell: usize) -> Option<(f64, f64)> {
    let (radials, azimuths) = (&grid.radials_deg, &grid.azimuths_deg);
    let (radial, azimuth) = (cell % radials.len(), cell / radials.len() % azimuths.len());
    let [inner, outer] = around(radials, radial, 180.0);
    let cap = inner.cos() - outer.cos();
    if radials[radial] == 0.0 {
        // The cell of the first azimuth represents all of them.
        let all = (0..azimuths.len()).filter_map(|k| values.get(cell + k * radials.len()).copied());
        let known = all.filter(|f| azimuth == 0 && f.is_finite());
        let (count, sum) = known.fold((0.0, 0.0), |(count, sum), f| (count + 1.0, sum + f));
        return (count > 0.0).then(|| (sum / count, 2.0 * PI * cap));
    }
    let [before, after] = match grid.symmetry {
        Symmetry::Plane => around(azimuths, azimuth, 180.0).map(|angle| 2.0 * angle),
        Symmetry::None => around_circle(azimuths, azimuth),
    };
    Some((values[cell], cap * (after - before)))
}

fn spherical(grid: &SphericalGrid, cell: usize) -> f64 {
    let azimuth = cell % grid.phi_o_deg.len();
    let theta = cell / grid.phi_o_deg.len() % grid.theta_o_deg.len();
    let [inner, outer] = around(&grid.theta_o_deg, theta, 90.0);
    let [before, after] = around_circle(&grid.phi_o_deg, azimuth);
    (inner.cos() - outer.cos()) * (after - before)
}

/// Limits of a cell, radians: half-way to its neighbours, between 0 and the end.
fn around(angles: &[f64], k: usize, end: f64) -> [f64; 2] {
    let middle = |other: f64| 0.5 * (angles[k] + other);
    let before = if k > 0 { middle(angles[k - 1]) } else { 0.0 };
    [before, angles.get(k + 1).map_or(end, |next| middle(*next))].map(f64::to_radians)
}

/// Limits of a cell on a full circle, radians.
fn around_circle(angles: &[f64], k: usize) -> [f64; 2] {
    let last = angles.len() - 1;
    let before = if k > 0 { angles[k - 1] } else { angles[last] - 360.0 };
    let after = if k < last { angles[k + 1] } else { angles[0] + 360.0 };
    [0.5 * (before + angles[k]), 0.5 * (angles[k] + after)].map(f64::to_radians)
}
