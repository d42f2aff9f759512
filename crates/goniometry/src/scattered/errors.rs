//! Errors of the interpolation of listed pairs, from the pairs themselves.

use super::local::predicted;
use super::near::Tree;
use super::{NEAREST, Point, Scale, WEIGHTS, WIDTHS, levels};

/// Number of points with which the scale is chosen, and of those that are tested.
const CHOSEN_BY: usize = 150;
const TESTED: usize = 500;
/// Fraction of the largest value below which a point is not tested: noise and dark tails.
const FAINT: f64 = 1e-3;

/// Differences of predicted from measured values, relative to the measured ones.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairError {
    /// Root mean square.
    pub rms: f64,
    /// Mean.
    pub mean: f64,
    /// Difference that 95 % of the points do not exceed.
    pub within_95: f64,
    /// Number of points that were predicted.
    pub points: usize,
}

/// Errors of an interpolation between listed pairs. Those of the values themselves (noise) are included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairErrors {
    /// Each point predicted from all others.
    pub one_left_out: PairError,
    /// The points of each incidence but the first and the last predicted from the other incidences; `None` if there are fewer
    /// than three, or more than `MOST_INCIDENCES`.
    pub incidence_left_out: Option<PairError>,
}

/// Returns the scale with which points best predict each other.
pub(super) fn best_scale(points: &[Point], incidence: f64) -> Scale {
    let score = |scale: &Scale| {
        let tree = Tree::new(points.iter().map(|point| scale.place(point)).collect());
        let differences = differences(points, *scale, &tree, CHOSEN_BY);
        // A point that no scale predicts does not decide.
        differences.map(|difference| difference.clamp(-1.0, 1.0).powi(2)).sum::<f64>()
    };
    let best = |scales: &[Scale]| {
        let scored = scales.iter().map(|scale| (*scale, score(scale)));
        scored.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(scale, _)| scale)
    };
    let start = Scale { width: 10.0, weight: 1.0, incidence };
    let width = best(&WIDTHS.map(|width| Scale { width, ..start })).unwrap_or(start);
    best(&WEIGHTS.map(|weight| Scale { weight, ..width })).unwrap_or(width)
}

/// Returns the errors of an interpolation.
pub(super) fn errors(points: &[Point], scale: Scale, tree: &Tree) -> PairErrors {
    let one_left_out = PairError::of(differences(points, scale, tree, TESTED).collect());
    let levels = levels(points);
    let incidence_left_out = (3..=super::MOST_INCIDENCES).contains(&levels.len()).then(|| {
        let inner = levels[1] - 1e-9..levels[levels.len() - 1] - 1e-9;
        let others = |k: usize, other: usize| (points[k].theta_i_deg - points[other].theta_i_deg).abs() > 0.1;
        let tested = tested(points, TESTED).filter(|k| inner.contains(&points[*k].theta_i_deg));
        PairError::of(tested.map(|k| difference(points, scale, tree, k, &|other| others(k, other))).collect())
    });
    PairErrors { one_left_out, incidence_left_out }
}

impl PairError {
    fn of(differences: Vec<f64>) -> Self {
        let points = differences.len();
        let mean_of =
            |of: fn(f64) -> f64| differences.iter().map(|d| of(*d)).sum::<f64>() / points.max(1) as f64;
        let (rms, mean) = (mean_of(|d| d * d).sqrt(), mean_of(|d| d));
        let mut sizes: Vec<f64> = differences.iter().map(|d| d.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let at = (0.95 * points as f64) as usize;
        Self {
            rms,
            mean,
            within_95: sizes.get(at.min(points.saturating_sub(1))).copied().unwrap_or(0.0),
            points,
        }
    }
}

/// Relative differences of predicted points from their values, of at most `most` points.
fn differences<'a>(
    points: &'a [Point],
    scale: Scale,
    tree: &'a Tree,
    most: usize,
) -> impl Iterator<Item = f64> + 'a {
    tested(points, most).map(move |k| difference(points, scale, tree, k, &|other| other != k))
}

/// Numbers of at most `most` points that are not faint.
fn tested(points: &[Point], most: usize) -> impl Iterator<Item = usize> + '_ {
    let largest = points.iter().map(|point| point.value).fold(0.0, f64::max);
    let bright: Vec<usize> = (0..points.len()).filter(|k| points[*k].value > FAINT * largest).collect();
    let (count, tested) = (bright.len(), bright.len().min(most));
    (0..tested).map(move |k| bright[k * count / tested])
}

fn difference(
    points: &[Point],
    scale: Scale,
    tree: &Tree,
    point: usize,
    accepts: &dyn Fn(usize) -> bool,
) -> f64 {
    let place = scale.place(&points[point]);
    let near = tree.nearest(place, NEAREST, accepts);
    predicted(tree, points, place, &near) / points[point].value - 1.0
}
