//! Positions of tables over places, and what is read from them.

use papilio_transport::spatial::Peak;

/// Places on each side of a peak in a table by adding.
pub(super) const PER_SIDE: usize = 40;

/// Ascending places along an axis, mm, dense near the peaks: each is `peak + width sinh(u)` with uniform u, `per_side` of
/// them on each side, up to `extent_mm` from the view's own ray. 0 and `fixed` are among them.
pub(super) fn places(
    (peaks, per_side): (&[Peak], usize),
    axis: usize,
    extent_mm: f64,
    fixed: &[f64],
) -> Vec<f64> {
    let mut all: Vec<(f64, f64)> = fixed.iter().chain([&0.0]).map(|at| (*at, 0.0)).collect();
    for peak in peaks {
        let end = (extent_mm / peak.width_mm).asinh();
        let step = end / per_side as f64;
        for k in -(per_side as i32)..=per_side as i32 {
            let u = f64::from(k) * step;
            let at = peak.at_mm[axis] + peak.width_mm * u.sinh();
            // Closer ones of another peak add nothing.
            all.push((at, 0.5 * peak.width_mm * u.cosh() * step));
        }
    }
    all.retain(|(at, _)| at.abs() <= extent_mm);
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let is_fixed = |at: f64| at == 0.0 || fixed.contains(&at);
    let mut kept: Vec<(f64, f64)> = Vec::with_capacity(all.len());
    for (at, distance) in all {
        let Some(last) = kept.last().copied() else {
            kept.push((at, distance));
            continue;
        };
        match (is_fixed(at), is_fixed(last.0)) {
            (true, true) if at > last.0 => kept.push((at, distance)),
            (true, true) => {}
            (true, false) if at - last.0 < distance.max(last.1) => {
                *kept.last_mut().unwrap_or(&mut (at, 0.0)) = (at, 0.0)
            }
            _ if at - last.0 >= distance.min(if last.1 > 0.0 { last.1 } else { distance }) => {
                kept.push((at, distance))
            }
            _ => {}
        }
    }
    kept.into_iter().map(|(at, _)| at).collect()
}

/// Ascending radii of rings about the view's own ray, mm, dense at the distances of the peaks: the light of a lamp's
/// image lies within a narrow ring.
/// Each sharp image at `images_mm` has its light between two radii, `sharp_mm` on both sides of it.
pub(super) fn radii(
    (peaks, per_side): (&[Peak], usize),
    extent_mm: f64,
    images_mm: &[[f64; 2]],
    sharp_mm: f64,
) -> Vec<f64> {
    let at_distance = |peak: &Peak| {
        let [x, y] = peak.at_mm;
        Peak { at_mm: [x.hypot(y), 0.0], width_mm: peak.width_mm }
    };
    let peaks: Vec<Peak> = peaks.iter().map(at_distance).collect();
    let beside = images_mm.iter().flat_map(|[x, y]| [-sharp_mm, sharp_mm].map(|side| x.hypot(*y) + side));
    let fixed: Vec<f64> = beside.chain([sharp_mm]).collect();
    let mut radii = places((&peaks, per_side), 0, extent_mm, &fixed);
    radii.retain(|radius| *radius > 0.0);
    radii
}

/// Place where a cumulative function, 0 to 1 over ascending places, reaches a value; `None` where the table
/// does not reach it.
pub(super) fn crossing(places: &[f64], cumulative: &[f64], value: f64) -> Option<f64> {
    let above = cumulative.iter().position(|share| *share >= value)?;
    if above == 0 {
        return (cumulative[0] == value).then(|| places[0]);
    }
    let piece = Piece::new(places, cumulative, above - 1);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if piece.at(middle) < value { low = middle } else { high = middle }
    }
    Some(places[above - 1] + piece.width * 0.5 * (low + high))
}

/// Part of the difference that fewer places make that is an error of what is read between all places: cubic pieces of half the
/// length have a sixteenth of the error, or a fourth where the slope jumps.
const OF_HALF: f64 = 0.25;

/// An interval that is narrower than this part of one beside it holds the light of a sharp image.
const STEP: f64 = 0.1;

/// Slope of such an interval over that of one beside it, at least.
const STEEP: f64 = 3.0;

/// Error of [`crossing`] by the distance of the places: what fewer places make of the crossings of all values in the interval and
/// the ones beside it, of which some differ little by chance.
pub(super) fn crossing_error(places: &[f64], cumulative: &[f64], value: f64) -> Option<f64> {
    let above = cumulative.iter().position(|share| *share >= value)?;
    let nearest = above.saturating_sub(2)..(above + 1).min(cumulative.len() - 1);
    let near = nearest.flat_map(|k| {
        let [from, to] = [cumulative[k], cumulative[k + 1]];
        [0.1, 0.3, 0.5, 0.7, 0.9].map(|part| from + part * (to - from))
    });
    let at = |value: f64| {
        error_between(places, cumulative, |places, cumulative| crossing(places, cumulative, value))
    };
    near.chain([value]).filter_map(at).reduce(f64::max)
}

/// Error of a number that is read from a table over ascending places, by their distance: what half as many places, the others or
/// these, make of it. `None` where there is no number.
pub(super) fn error_between(
    places: &[f64],
    values: &[f64],
    read: impl Fn(&[f64], &[f64]) -> Option<f64>,
) -> Option<f64> {
    let found = read(places, values)?;
    let errors = [0, 1].map(|first| {
        let kept = fewer(places, first);
        let [places, values] = [places, values].map(|all| kept.iter().map(|k| all[*k]).collect::<Vec<f64>>());
        read(&places, &values).map_or(0.0, |few| (few - found).abs())
    });
    Some(OF_HALF * errors[0].max(errors[1]))
}

/// Numbers of every second place, of both ends and of the places beside sharp images.
fn fewer(places: &[f64], first: usize) -> Vec<usize> {
    let width = |k: usize| places[k + 1] - places[k];
    let last = places.len().saturating_sub(1);
    let is_step = |k: usize| {
        let beside = [k.checked_sub(1), Some(k + 1).filter(|next| *next < last)];
        beside.into_iter().flatten().any(|other| width(k) < STEP * width(other))
    };
    let is_kept = |k: &usize| {
        k % 2 == first || *k == 0 || *k == last || is_step(*k) || k.checked_sub(1).is_some_and(is_step)
    };
    (0..places.len()).filter(is_kept).collect()
}

/// Difference between [`crossing`] and that of straight lines between the places: a bound of the error by their distance.
pub(super) fn between(places: &[f64], cumulative: &[f64], value: f64) -> Option<f64> {
    let above = cumulative.iter().position(|share| *share >= value)?;
    let Some(below) = above.checked_sub(1) else { return Some(0.0) };
    let [from, to] = [cumulative[below], cumulative[above]];
    let straight = places[below] + (places[above] - places[below]) * (value - from) / (to - from);
    Some((crossing(places, cumulative, value)? - straight).abs())
}

/// Value of a function tabulated at ascending places; held beyond them.
pub(super) fn interpolated(places: &[f64], values: &[f64], at: f64) -> f64 {
    let above = places.partition_point(|place| *place <= at);
    match above {
        0 => values.first().copied().unwrap_or_default(),
        above if above == places.len() => values[above - 1],
        above => {
            let piece = Piece::new(places, values, above - 1);
            piece.at((at - places[above - 1]) / piece.width)
        }
    }
}

/// Cubic between two places, with the slopes of parabolas through three points, on one side of a sharp image.
struct Piece {
    width: f64,
    values: [f64; 2],
    slopes: [f64; 2],
}

impl Piece {
    fn new(places: &[f64], values: &[f64], from: usize) -> Self {
        let chord = |k: usize| (values[k + 1] - values[k]) / (places[k + 1] - places[k]);
        let last = places.len() - 2;
        let width = |k: usize| places[k + 1] - places[k];
        // A sharp image in the interval beside a place tells nothing of the slope there.
        let is_step = |k: usize, beside: usize| {
            width(k) < STEP * width(beside) && chord(k).abs() > STEEP * chord(beside).abs()
        };
        let from_one_side = |near: usize, far: Option<usize>| {
            let far = far.filter(|far| *far <= last && !is_step(*far, near));
            let bend = |far| width(near) / (width(near) + width(far)) * (chord(near) - chord(far));
            chord(near) + far.map_or(0.0, bend)
        };
        let slope = |k: usize| {
            let (left, right) = (k.saturating_sub(1).min(last), k.min(last));
            if left != right && is_step(left, right) {
                return from_one_side(right, Some(right + 1));
            }
            if left != right && is_step(right, left) {
                return from_one_side(left, left.checked_sub(1));
            }
            let [a, b] = [left, right].map(width);
            (chord(left) * b + chord(right) * a) / (a + b)
        };
        // A step within the interval, as of a sharp image, has no parabola: no slope beyond three times the
        // mean.
        let mean = chord(from);
        let limited = |slope: f64| {
            if slope * mean > 0.0 { mean.signum() * slope.abs().min(3.0 * mean.abs()) } else { 0.0 }
        };
        Self {
            width: places[from + 1] - places[from],
            values: [values[from], values[from + 1]],
            slopes: [slope(from), slope(from + 1)].map(limited),
        }
    }

    /// Value at a fraction t of the interval.
    fn at(&self, t: f64) -> f64 {
        let s = 1.0 - t;
        let [from, to] = self.values;
        let hermite = from * s * s * (1.0 + 2.0 * t) + to * t * t * (1.0 + 2.0 * s);
        hermite + self.width * (self.slopes[0] * t * s * s - self.slopes[1] * t * t * s)
    }
}

/// Sums of bins up to each border, over the sum of all.
pub(super) fn cumulative(bins: &[f64]) -> Vec<f64> {
    let total: f64 = bins.iter().sum();
    let mut sum = 0.0;
    bins[..bins.len().saturating_sub(1)]
        .iter()
        .map(|bin| {
            sum += bin;
            if total > 0.0 { sum / total } else { 0.0 }
        })
        .collect()
}

/// Density at each border: of the two bins beside it. At a single border, of a point, it is 0.
pub(super) fn density(places: &[f64], bins: &[f64]) -> Vec<f64> {
    let total: f64 = bins.iter().sum();
    let at = |k: usize| {
        let from = places[k.saturating_sub(1)];
        let to = places[(k + 1).min(places.len() - 1)];
        let inside = bins[(k.max(1))..=k.min(places.len().saturating_sub(2)) + 1].iter().sum::<f64>();
        if to > from && total > 0.0 { inside / (to - from) / total } else { 0.0 }
    };
    (0..places.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cauchy's distribution: quartiles at one width. Between the places of a table, crossings are correct to
    /// 1e-3.
    #[test]
    fn crossings_of_a_known_distribution_are_found() {
        let peak = Peak { at_mm: [0.0; 2], width_mm: 0.02 };
        let places = places((&[peak], PER_SIDE), 0, 10.0, &[0.05]);
        assert!(places.contains(&0.05) && places.contains(&0.0));
        assert!(places.windows(2).all(|pair| pair[0] < pair[1]));
        let share: Vec<f64> = places.iter().map(|x| 0.5 + (x / 0.02).atan() / std::f64::consts::PI).collect();
        for (value, expected) in [(0.25, -0.02), (0.5, 0.0), (0.75, 0.02), (0.9, 0.02 * 3.077_683_5)] {
            let found = crossing(&places, &share, value).unwrap();
            assert!((found - expected).abs() < 1e-3 * (expected.abs() + 0.02), "{value}: {found} {expected}");
        }
        assert_eq!(crossing(&places, &share, 0.9999), None);
    }

    /// Cauchy's distribution beside a sharp image that has a part of the light: places of all shares are known, and within the
    /// stated errors, which are no larger than they need to be.
    #[test]
    fn errors_by_the_distance_of_places_are_those_of_a_known_distribution() {
        for (width_mm, sharp) in [(1e-4, 0.0), (0.02, 0.0), (0.02, 0.2), (0.3, 0.5)] {
            let peak = Peak { at_mm: [0.0; 2], width_mm };
            let places = places((&[peak], PER_SIDE), 0, 10.0, &[-1e-6, 1e-6]);
            let at = |x: f64| {
                let step = if x == 0.0 { 0.5 } else { f64::from(u8::from(x > 0.0)) };
                sharp * step + (1.0 - sharp) * (0.5 + (x / width_mm).atan() / std::f64::consts::PI)
            };
            let share: Vec<f64> = places.iter().map(|x| at(*x)).collect();
            let (mut off, mut stated) = (Vec::new(), Vec::new());
            for value in (1..100).map(|k| 0.01 * f64::from(k)) {
                let below = if value > 0.5 { sharp } else { 0.0 };
                let Some(found) = crossing(&places, &share, value) else { continue };
                let expected = match (value - 0.5).abs() < 0.5 * sharp + 1e-9 {
                    true => 0.0,
                    false => {
                        width_mm * (std::f64::consts::PI * ((value - below) / (1.0 - sharp) - 0.5)).tan()
                    }
                };
                let error = crossing_error(&places, &share, value).unwrap();
                let allowed = 1.5 * error + 1e-5 * (width_mm + expected.abs()) + 1e-6;
                assert!(
                    (found - expected).abs() < allowed,
                    "{width_mm} {sharp} {value}: {found} {expected} {error}"
                );
                off.push(((found - expected) / (width_mm + expected.abs())).abs());
                stated.push(error / (width_mm + expected.abs()));
            }
            let mean = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64;
            assert!(mean(&stated) < 20.0 * mean(&off) + 1e-5, "{width_mm} {sharp}: {stated:?} {off:?}");
        }
    }
}
