//! Interpolation along one line of a measurement, from the peak outwards.

/// Change of ln f, over an interval, that a slope against the rise of that interval may cause; a slope along it is limited
/// to three times the rise, up to which a cubic is monotonic.
const OVERSHOOT: f64 = 0.5;

/// Values of a lobe along a line, interpolated in `x = ln(1 + (|delta|/w)^2)`. Where values are positive, the
/// logarithm is interpolated cubically, with the slopes of the parabola through three points (suitable for
/// tails of any steepness). Next to zeros, interpolation is linear.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Line {
    x: Vec<f64>,
    /// ln f; minus infinity at zeros.
    logs: Vec<f64>,
    slopes: Vec<f64>,
}

impl Line {
    /// Line through points with ascending `x`, at least one; values that are not positive count as zero.
    pub(super) fn new(x: Vec<f64>, values: &[f64]) -> Self {
        let logs: Vec<f64> =
            values.iter().map(|f| if *f > 0.0 { f.ln() } else { f64::NEG_INFINITY }).collect();
        let slopes = (0..x.len()).map(|k| slope(&x, &logs, k)).collect();
        Self { x, logs, slopes }
    }

    /// Interpolates the value at `x`. Beyond the last point, extrapolates along the last slope if it is
    /// negative; otherwise uses the last value.
    pub(super) fn value(&self, x: f64) -> f64 {
        let last = self.x.len() - 1;
        let upper = self.x.partition_point(|known| *known <= x);
        if upper == 0 {
            return self.logs[0].exp();
        }
        if upper > last {
            return (self.logs[last] + self.slopes[last].min(0.0) * (x - self.x[last])).exp();
        }
        let (lower, width) = (upper - 1, self.x[upper] - self.x[upper - 1]);
        let t = (x - self.x[lower]) / width;
        let [a, b] = [self.logs[lower], self.logs[upper]];
        if !(a.is_finite() && b.is_finite()) {
            return (1.0 - t) * a.exp() + t * b.exp();
        }
        let [p, q] = [self.slopes[lower], self.slopes[upper]].map(|slope| slope * width);
        let (s, rise) = (1.0 - t, b - a);
        // Where a lobe has an edge, parabolas would overshoot by powers of ten.
        let limited = |slope: f64| {
            (slope * rise.signum()).clamp(-OVERSHOOT, 3.0 * rise.abs() + OVERSHOOT) * rise.signum()
        };
        let [p, q] = [p, q].map(limited);
        (a + t * rise + t * s * (s * (p - rise) - t * (q - rise))).exp()
    }

    /// The line over another abscissa, a function of this one.
    pub(super) fn over(&self, abscissa: impl Fn(f64) -> f64) -> Self {
        let x: Vec<f64> = self.x.iter().map(|x| abscissa(*x)).collect();
        let slopes = (0..x.len()).map(|k| slope(&x, &self.logs, k)).collect();
        Self { x, logs: self.logs.clone(), slopes }
    }

    /// Returns whether the second value is less than half the first.
    pub(super) fn halves_at_once(&self) -> bool {
        matches!(self.logs[..], [first, second, ..] if second < first - std::f64::consts::LN_2)
    }

    /// The line through the first point and every other one, the even (`parity` 0) or the odd ones (1).
    pub(super) fn coarser(&self, parity: usize) -> Self {
        let retained = |values: &[f64]| -> Vec<f64> {
            let all = values.iter().copied().enumerate();
            all.filter(|(k, _)| *k == 0 || k % 2 == parity).map(|(_, value)| value).collect()
        };
        let (x, logs) = (retained(&self.x), retained(&self.logs));
        let slopes = (0..x.len()).map(|k| slope(&x, &logs, k)).collect();
        Self { x, logs, slopes }
    }
}

/// Slope at a point of the parabola through it and its positive neighbours.
fn slope(x: &[f64], logs: &[f64], k: usize) -> f64 {
    if !logs[k].is_finite() {
        return 0.0;
    }
    let secant = |a: usize, b: usize| (logs[b] - logs[a]) / (x[b] - x[a]);
    let good = |k: usize| logs.get(k).is_some_and(|log| log.is_finite());
    match (k > 0 && good(k - 1), good(k + 1)) {
        (true, true) => {
            let (before, after) = (x[k] - x[k - 1], x[k + 1] - x[k]);
            (secant(k - 1, k) * after + secant(k, k + 1) * before) / (before + after)
        }
        (false, true) if good(k + 2) => {
            end(secant(k, k + 1), secant(k + 1, k + 2), x[k + 1] - x[k], x[k + 2] - x[k + 1])
        }
        (true, false) if k > 1 && good(k - 2) => {
            end(secant(k - 1, k), secant(k - 2, k - 1), x[k] - x[k - 1], x[k - 1] - x[k - 2])
        }
        (false, true) => secant(k, k + 1),
        (true, false) => secant(k - 1, k),
        (false, false) => 0.0,
    }
}

/// Slope of a parabola at its end, from the two nearest secants and their widths.
fn end(near: f64, far: f64, width: f64, next: f64) -> f64 {
    near + (near - far) * width / (width + next)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parabola_of_logarithm_is_interpolated_exactly() {
        let law = |x: f64| (1.0 - 2.0 * x + 0.3 * x * x).exp();
        let x = vec![0.0, 0.3, 0.5, 1.1, 1.4];
        let values: Vec<f64> = x.iter().map(|x| law(*x)).collect();
        let line = Line::new(x, &values);
        for k in 0..14 {
            let x = 0.1 * f64::from(k);
            assert!((line.value(x) / law(x) - 1.0).abs() < 1e-14, "{x}");
        }
    }

    /// A parabola through the edge of a lobe has slopes that would raise the values beside it by powers of ten.
    #[test]
    fn values_beside_an_edge_stay_near_their_neighbours() {
        let law = |r: f64| (-(r / 0.05_f64).powi(8)).exp();
        let x: Vec<f64> = (0..5).map(|k| (0.026 * f64::from(k) / 0.05).powi(2)).collect();
        let values: Vec<f64> = (0..5).map(|k| law(0.026 * f64::from(k))).collect();
        let line = Line::new(x.clone(), &values);
        for (x, f) in x.windows(2).zip(values.windows(2)) {
            for t in [0.1, 0.3, 0.5, 0.7, 0.9] {
                let found = line.value(x[0] + t * (x[1] - x[0]));
                assert!((f[1] / 1.2..=f[0] * 1.2).contains(&found), "{x:?} {f:?}: {found}");
            }
        }
    }

    #[test]
    fn zeros_stay_zero_and_values_stay_nonnegative() {
        let line = Line::new(vec![0.0, 1.0, 2.0, 3.0], &[2.0, 1.0, 0.0, 0.0]);
        assert_eq!(line.value(1.5), 0.5);
        assert_eq!([2.0, 2.5, 3.0, 9.0].map(|x| line.value(x)), [0.0; 4]);
    }
}
