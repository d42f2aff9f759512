//! Functions tabulated on [0, 1] as Chebyshev series on pieces, cut as finely as they need.

use std::f64::consts::PI;

/// Terms of the series on a piece.
const TERMS: usize = 16;

/// A piece narrower than this is not cut further: whatever happens within it carries no light.
const NARROWEST: f64 = 1e-10;

/// `K` functions of one variable on [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piecewise<const K: usize> {
    /// Where the pieces begin; the first at 0.
    starts: Vec<f64>,
    /// 2 over the width of each piece.
    scales: Vec<f64>,
    /// Coefficients of each piece.
    series: Vec<[[f64; K]; TERMS]>,
}

impl<const K: usize> Piecewise<K> {
    /// Halves [0, 1] until, between the nodes, the series miss none of the functions by more
    /// than `tolerance`; `None` if that takes more than `most_pieces`.
    pub(crate) fn new<E>(
        tolerance: f64,
        most_pieces: usize,
        mut function: impl FnMut(f64) -> Result<[f64; K], E>,
    ) -> Result<Option<Self>, E> {
        let mut table = Self { starts: Vec::new(), scales: Vec::new(), series: Vec::new() };
        let mut waiting = vec![(0.0, 1.0)];
        while let Some((from, to)) = waiting.pop() {
            let middle = 0.5 * (from + to);
            let half = 0.5 * (to - from);
            let mut at = |x: f64| function(middle + half * x);
            let series = interpolate(&mut at)?;
            if to - from < NARROWEST || misses_by(&series, &mut at)? <= tolerance {
                table.starts.push(from);
                table.scales.push(1.0 / half);
                table.series.push(series);
            } else {
                waiting.extend([(middle, to), (from, middle)]);
            }
            if table.starts.len() + waiting.len() > most_pieces {
                return Ok(None);
            }
        }
        Ok(Some(table))
    }

    /// The functions at x, 0 to 1.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> [f64; K] {
        let piece = self.starts.partition_point(|&start| start <= x).saturating_sub(1);
        clenshaw(&self.series[piece], (x - self.starts[piece]) * self.scales[piece] - 1.0)
    }
}

/// The series through the values at the Chebyshev points of [-1, 1].
fn interpolate<const K: usize, E>(
    at: &mut impl FnMut(f64) -> Result<[f64; K], E>,
) -> Result<[[f64; K]; TERMS], E> {
    let mut series = [[0.0; K]; TERMS];
    for node in 0..TERMS {
        let angle = PI * (node as f64 + 0.5) / TERMS as f64;
        let value = at(angle.cos())?;
        for (term, coefficients) in series.iter_mut().enumerate() {
            let share = if term == 0 { 1.0 } else { 2.0 } / TERMS as f64;
            let weight = share * (term as f64 * angle).cos();
            coefficients.iter_mut().zip(value).for_each(|(c, v)| *c += weight * v);
        }
    }
    Ok(series)
}

/// The largest error midway between the Chebyshev points and at the ends.
fn misses_by<const K: usize, E>(
    series: &[[f64; K]; TERMS],
    at: &mut impl FnMut(f64) -> Result<[f64; K], E>,
) -> Result<f64, E> {
    let mut worst = 0.0_f64;
    for extreme in 0..=TERMS {
        let x = (PI * extreme as f64 / TERMS as f64).cos();
        let (found, exact) = (clenshaw(series, x), at(x)?);
        worst = found.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(worst, f64::max);
    }
    Ok(worst)
}

#[inline]
fn clenshaw<const K: usize>(series: &[[f64; K]; TERMS], x: f64) -> [f64; K] {
    let (mut last, mut before) = ([0.0; K], [0.0; K]);
    for coefficients in series[1..].iter().rev() {
        let next = std::array::from_fn(|k| coefficients[k] + 2.0 * x * last[k] - before[k]);
        (before, last) = (last, next);
    }
    std::array::from_fn(|k| series[0][k] + x * last[k] - before[k])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table<const K: usize>(tolerance: f64, function: impl Fn(f64) -> [f64; K]) -> Option<Piecewise<K>> {
        Piecewise::new(tolerance, 200, |x| Ok::<_, ()>(function(x))).unwrap()
    }

    #[test]
    fn a_narrow_peak_is_found_and_resolved() {
        let peak = |x: f64| [1e-6 / (1e-6 + (x - 0.3).powi(2)), (40.0 * x).sin()];
        let table = table(1e-10, peak).unwrap();
        for step in 0..=10_000 {
            let x = f64::from(step) / 10_000.0;
            let (found, exact) = (table.at(x), peak(x));
            assert!((found[0] - exact[0]).abs() < 1e-9 && (found[1] - exact[1]).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn what_needs_too_many_pieces_is_refused() {
        assert_eq!(table(1e-9, |x| [(1e5 * x).sin()]), None);
    }

    #[test]
    fn a_step_ends_in_a_narrow_piece() {
        let table = table(1e-9, |x| [f64::from(u8::from(x > 0.3))]).unwrap();
        assert!((table.at(0.3 - 1e-9)[0]).abs() < 1e-9 && (table.at(0.3 + 1e-9)[0] - 1.0).abs() < 1e-9);
    }
}
