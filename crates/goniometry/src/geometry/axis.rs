//! Interpolation on an axis of angles.

/// Two indices on an axis and their interpolation weights.
pub(super) type Weights = [(usize, f64); 2];

/// Tolerance for angles at an end of the axis, degrees.
const SLACK_DEG: f64 = 1e-6;

/// Interpolation weights of an angle on an ascending axis; `None` beyond its ends.
pub(super) fn between(axis: &[f64], angle: f64) -> Option<Weights> {
    let (first, last) = (*axis.first()?, *axis.last()?);
    if !(first - SLACK_DEG..=last + SLACK_DEG).contains(&angle) {
        return None;
    }
    let next = axis.partition_point(|other| *other < angle).clamp(1, axis.len().max(2) - 1);
    if axis.len() == 1 {
        return Some([(0, 1.0), (0, 0.0)]);
    }
    let fraction = ((angle - axis[next - 1]) / (axis[next] - axis[next - 1])).clamp(0.0, 1.0);
    Some([(next - 1, 1.0 - fraction), (next, fraction)])
}

/// Interpolation weights of an azimuth on a periodic axis. Between its last and its first
/// angle, these two are used if they are no more than half a turn apart. An axis of one angle represents
/// all azimuths.
pub(super) fn around(axis: &[f64], azimuth: f64) -> Option<Weights> {
    let (first, last) = (*axis.first()?, *axis.last()?);
    if axis.len() == 1 {
        return Some([(0, 1.0), (0, 0.0)]);
    }
    let turned = first + (azimuth - first).rem_euclid(360.0);
    if let Some(weights) = between(axis, turned).or_else(|| between(axis, turned - 360.0)) {
        return Some(weights);
    }
    let gap = first + 360.0 - last;
    let fraction = (turned - last) / gap;
    (gap > 0.0 && gap <= 180.0).then_some([(axis.len() - 1, 1.0 - fraction), (0, fraction)])
}

/// Interpolation weights of an azimuth relative to a plane of symmetry; an axis within 0 to 180 deg covers
/// one side. Next to the plane, an azimuth has the same value as its mirror image, if the axis ends half a
/// step before it.
pub(super) fn mirrored(axis: &[f64], azimuth: f64) -> Option<Weights> {
    let turned = azimuth.rem_euclid(360.0);
    let side = turned.min(360.0 - turned);
    let near = match axis {
        [first, second, ..] if side < *first && *first <= 0.5 * (second - first) + SLACK_DEG => *first,
        [.., before, last] if side > *last && 180.0 - last <= 0.5 * (last - before) + SLACK_DEG => *last,
        _ => side,
    };
    between(axis, near)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolation_weights_on_open_periodic_and_mirrored_axes() {
        let axis = [0.0, 10.0, 30.0];
        assert_eq!(between(&axis, 15.0), Some([(1, 0.75), (2, 0.25)]));
        assert_eq!(between(&axis, 0.0), Some([(0, 1.0), (1, 0.0)]));
        assert_eq!((between(&axis, 31.0), between(&[], 0.0), between(&axis, f64::NAN)), (None, None, None));
        assert_eq!(between(&[5.0], 5.0), Some([(0, 1.0), (0, 0.0)]));
        let round = [0.0, 90.0, 180.0, 270.0];
        assert_eq!(around(&round, -45.0), Some([(3, 0.5), (0, 0.5)]));
        assert_eq!(around(&round, 450.0), Some([(0, 0.0), (1, 1.0)]));
        assert_eq!(around(&axis, 200.0), None);
        assert_eq!(mirrored(&[0.0, 180.0], -45.0), Some([(0, 0.75), (1, 0.25)]));
        let centres = [45.0, 135.0];
        assert_eq!(mirrored(&centres, 10.0), Some([(0, 1.0), (1, 0.0)]));
        assert_eq!(mirrored(&centres, 190.0), Some([(0, 0.0), (1, 1.0)]));
        assert_eq!(mirrored(&[60.0, 120.0], 10.0), None);
    }
}
