//! Interpolation of a predicted spectrum at measured wavelengths.

/// Weights of four neighbouring values of a uniform grid of `count` values at the position `at`, in steps from
/// the first; and the index of the first of them. Between the middle two the interpolation is the cubic of
/// Catmull and Rom: it equals the values on the grid, and its first derivative is continuous. In the first and
/// the last step it is the parabola through the nearest three values. `None` outside the grid, or if it has
/// fewer than four values.
pub(super) fn weights(at: f64, count: usize) -> Option<(usize, [f64; 4])> {
    /// Rounding of wavelengths, in steps.
    const ROUNDING: f64 = 1e-9;
    let last = count.checked_sub(1).filter(|last| *last >= 3)?;
    if !(-ROUNDING..=last as f64 + ROUNDING).contains(&at) {
        return None;
    }
    let cell = (at.max(0.0).floor() as usize).min(last - 1);
    let t = at - cell as f64;
    if cell == 0 {
        return Some((0, [0.5 * (t - 1.0) * (t - 2.0), t * (2.0 - t), 0.5 * t * (t - 1.0), 0.0]));
    }
    if cell == last - 1 {
        let s = 1.0 - t;
        let [a, b, c] = [0.5 * (s - 1.0) * (s - 2.0), s * (2.0 - s), 0.5 * s * (s - 1.0)];
        return Some((last - 3, [0.0, c, b, a]));
    }
    let (t2, t3) = (t * t, t * t * t);
    let weights = [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ];
    Some((cell - 1, weights))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabola_is_interpolated_exactly_and_ends_are_included() {
        let values: Vec<f64> = (0..7).map(|i| 2.0 - 0.3 * f64::from(i) + 0.7 * f64::from(i * i)).collect();
        for step in 0..=60 {
            let at = 0.1 * f64::from(step);
            let (first, weights) = weights(at, values.len()).unwrap();
            let found: f64 = weights.iter().zip(&values[first..]).map(|(w, v)| w * v).sum();
            assert!((found - (2.0 - 0.3 * at + 0.7 * at * at)).abs() < 1e-12, "{at}: {found}");
        }
        assert!(weights(6.1, 7).is_none() && weights(-0.1, 7).is_none() && weights(1.0, 3).is_none());
    }
}
