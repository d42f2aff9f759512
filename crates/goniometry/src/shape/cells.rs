//! Cells of one incidence, folded onto a half plane, and the best width of the abscissa.

use super::abscissa;
use crate::{Direction, SpecularGrid};

/// Angles that differ by less than this are equal, degrees.
pub(super) const SAME_DEG: f64 = 1e-6;

/// Range of widths w for the search, in direction cosines.
const WIDTHS: [f64; 2] = [1e-3, 10.0];
const WIDTHS_TRIED: usize = 41;

/// Cells of one incidence on the half plane: `[azimuth][radial]`, as points (|delta|, f). Cells outside
/// the hemisphere are omitted.
pub(super) struct Cells {
    pub(super) theta_deg: f64,
    pub(super) azimuths: Vec<f64>,
    pub(super) lines: Vec<Vec<[f64; 2]>>,
    /// Number of points of each line up to its last cell with a value; the following ones were not measured.
    pub(super) measured: Vec<usize>,
    /// Last radial distance of the grid, degrees, if the hemisphere extends beyond it.
    pub(super) limit_deg: Option<f64>,
    /// Smallest distance, degrees, at which the measured cells of a line end before the horizon.
    pub(super) measured_to_deg: Option<f64>,
}

impl Cells {
    /// Smallest distance at which a line falls to half its peak.
    pub(super) fn half(&self) -> f64 {
        let of_line = |line: &Vec<[f64; 2]>| {
            let peak = line.first().map_or(0.0, |[_, f]| *f);
            line.iter().find(|[_, f]| *f < 0.5 * peak).map(|[delta, _]| *delta)
        };
        self.lines.iter().filter_map(of_line).fold(1.0, f64::min)
    }
}

/// Sums of a root mean square difference.
#[derive(Default)]
pub(super) struct DifferenceSums {
    differences: f64,
    values: f64,
}

impl DifferenceSums {
    /// Adds values with their weights, and returns their mean; `None` if there are none.
    pub(super) fn mean(&mut self, values: &[(f64, f64)]) -> Option<f64> {
        let weights: f64 = values.iter().map(|(_, weight)| weight).sum();
        let mean = values.iter().map(|(value, weight)| weight * value).sum::<f64>() / weights;
        self.differences += values.iter().map(|(value, weight)| weight * (value - mean).powi(2)).sum::<f64>();
        self.values += if values.is_empty() { 0.0 } else { weights * mean * mean };
        (!values.is_empty()).then_some(mean)
    }

    pub(super) fn relative(&self) -> f64 {
        if self.values > 0.0 { (self.differences / self.values).sqrt() } else { 0.0 }
    }
}

/// Cells of an incidence on one half plane up to a `|beta|`, with the mean of values that are equal by
/// symmetry.
pub(super) fn folded(
    grid: &SpecularGrid,
    values: &[f64],
    (incidence, horizon): (usize, f64),
    asymmetry: &mut DifferenceSums,
) -> Cells {
    let (azimuths, radials) = (grid.azimuths_deg.len(), grid.radials_deg.len());
    // Azimuth from the plane of incidence; its two sides are equal by symmetry.
    let aside = |k: usize| {
        let azimuth = grid.azimuths_deg[k].rem_euclid(360.0);
        azimuth.min(360.0 - azimuth)
    };
    let mut half: Vec<f64> = (0..azimuths).map(aside).collect();
    half.sort_by(f64::total_cmp);
    half.dedup_by(|b, a| *b - *a < SAME_DEG);
    let weights = grid.rotation_weights();
    let theta_deg = grid.incidences_deg[incidence];
    let last_deg = grid.radials_deg.last().copied().unwrap_or(0.0);
    let mut cells = Cells {
        theta_deg,
        azimuths: Vec::new(),
        lines: Vec::new(),
        measured: Vec::new(),
        limit_deg: Some(last_deg).filter(|last| *last < 90.0 + theta_deg - SAME_DEG),
        measured_to_deg: None,
    };
    for azimuth in half {
        let like: Vec<usize> = (0..azimuths).filter(|k| (aside(*k) - azimuth).abs() < SAME_DEG).collect();
        // Distances from the specular direction in the plane of direction cosines, with the mean of the measured values.
        let mut line: Vec<(f64, Option<f64>)> = Vec::with_capacity(radials);
        let beyond_grid = SpecularGrid::direction(theta_deg, azimuth, last_deg + SAME_DEG);
        // Distance of the last measured point, and whether it is the last cell of the line.
        let (mut measured_deg, mut to_the_end) = (0.0, true);
        for (r, radial) in grid.radials_deg.iter().enumerate() {
            let to = SpecularGrid::direction(cells.theta_deg, azimuth, *radial);
            let Some(beta) = to.map(Direction::leaving).filter(|beta| r == 0 || beta.length() <= horizon)
            else {
                break;
            };
            let rows = weights.iter().enumerate().flat_map(|(turn, weight)| {
                let row = (turn * grid.incidences_deg.len() + incidence) * azimuths;
                like.iter().map(move |m| (values[(row + m) * radials + r], *weight))
            });
            let known: Vec<(f64, f64)> = rows.filter(|(value, _)| value.is_finite()).collect();
            let mean = asymmetry.mean(&known);
            // Distance from the specular direction in the plane of direction cosines.
            let delta = (beta.x - cells.theta_deg.to_radians().sin()).hypot(beta.y);
            if line.last().is_none_or(|(before, _)| delta > *before) {
                line.push((delta, mean));
            }
            to_the_end = mean.is_some();
            if to_the_end {
                measured_deg = *radial;
            }
        }
        let last = line.iter().rposition(|(_, mean)| mean.is_some());
        if last.is_some() && (beyond_grid.is_some() || !to_the_end) {
            let least = cells.measured_to_deg.unwrap_or(f64::INFINITY);
            cells.measured_to_deg = Some(least.min(measured_deg));
        }
        // Points that were not measured are interpolated between measured ones, and dark behind the last.
        let of_point = |(k, (delta, mean)): (usize, &(f64, Option<f64>))| match mean {
            Some(mean) => Some([*delta, *mean]),
            None => (last.is_none_or(|last| k > last)).then_some([*delta, 0.0]),
        };
        let points: Vec<[f64; 2]> = line.iter().enumerate().filter_map(of_point).collect();
        let measured = last.map_or(0, |last| line[..=last].iter().filter(|(_, mean)| mean.is_some()).count());
        cells.measured.push(measured);
        cells.azimuths.push(azimuth.to_radians());
        cells.lines.push(points);
    }
    // Azimuths without a measured point are interpolated between the others.
    let is_known = |k: &usize| cells.measured[*k] > 0;
    let known: Vec<usize> = (0..cells.measured.len()).filter(is_known).collect();
    if known.is_empty() {
        cells.measured = cells.lines.iter().map(Vec::len).collect();
    } else if known.len() < cells.measured.len() {
        cells.azimuths = known.iter().map(|k| cells.azimuths[*k]).collect();
        cells.lines = known.iter().map(|k| std::mem::take(&mut cells.lines[*k])).collect();
        cells.measured = known.iter().map(|k| cells.measured[*k]).collect();
    }
    cells
}

/// Removes the points behind the last measured cell of each line.
pub(super) fn without_unmeasured_tails(mut cells: Cells) -> Cells {
    let Cells { lines, measured, .. } = &mut cells;
    lines.iter_mut().zip(measured).for_each(|(line, measured)| line.truncate(*measured));
    cells
}

/// Removes the zeros behind the last positive value of each line; counts the removed points and all points.
pub(super) fn without_tail_zeros(mut cells: Cells, filled: &mut [f64; 2]) -> Cells {
    for line in &mut cells.lines {
        let keep = line.iter().rposition(|[_, f]| *f > 0.0).map_or(line.len(), |last| last + 1);
        filled[0] += (line.len() - keep) as f64;
        filled[1] += line.len() as f64;
        line.truncate(keep);
    }
    cells
}

/// Width with which the line through its two neighbours best predicts each point, weighted by their light.
///
/// All points count, and straight lines: a parabola through every other point has a second width with which it
/// happens to meet the one point that has most of the light, if steps are as large as the lobe.
pub(super) fn best_width<'a>(lines: impl Iterator<Item = &'a Vec<[f64; 2]>> + Clone) -> f64 {
    let score = |width: f64| -> f64 { lines.clone().map(|points| missed(points, width)).sum() };
    let step = (WIDTHS[1] / WIDTHS[0]).ln() / (WIDTHS_TRIED - 1) as f64;
    let widths = (0..WIDTHS_TRIED).map(|k| WIDTHS[0] * (k as f64 * step).exp());
    let best = widths.map(|width| (width, score(width))).min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(1.0, |(width, _)| width)
}

/// Light of the differences between points and the straight lines between their neighbours, of the logarithm
/// unless one of them is dark.
fn missed(points: &[[f64; 2]], width: f64) -> f64 {
    let of_point = |three: &[[f64; 2]]| {
        let [x, next, last] = [0, 1, 2].map(|k| abscissa(three[k][0], width));
        let t = (next - x) / (last - x);
        let (before, after) = (three[0][1].max(0.0), three[2][1].max(0.0));
        let predicted = match before > 0.0 && after > 0.0 {
            true => ((1.0 - t) * before.ln() + t * after.ln()).exp(),
            false => (1.0 - t) * before + t * after,
        };
        let area = three[1][0] * (three[2][0] - three[0][0]);
        (area * (predicted - three[1][1])).abs()
    };
    points.windows(3).map(of_point).sum()
}
