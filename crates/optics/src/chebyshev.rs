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

    /// Where each piece begins and ends.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        self.starts.iter().zip(&self.scales).map(|(start, scale)| (*start, start + 2.0 / scale))
    }

    /// The functions at x, 0 to 1.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> [f64; K] {
        let piece = self.starts.partition_point(|&start| start <= x).saturating_sub(1);
        clenshaw(&self.series[piece], (x - self.starts[piece]) * self.scales[piece] - 1.0)
    }
}

impl Piecewise<1> {
    /// The integral of `x f(x)` from where the piece begins, as a function of x within it.
    pub(crate) fn first_moment(&self, piece: usize) -> impl Fn(f64) -> f64 {
        let (start, scale) = (self.starts[piece], self.scales[piece]);
        let half = 1.0 / scale;
        let f = |term: usize| if term < TERMS { self.series[piece][term][0] } else { 0.0 };
        // x f, by t T_k = (T_(k-1) + T_(k+1))/2, t T_0 = T_1.
        let mut product = [0.0; TERMS + 2];
        for (term, value) in product.iter_mut().enumerate() {
            let below = if term == 1 {
                2.0 * f(0)
            } else if term > 1 {
                f(term - 1)
            } else {
                0.0
            };
            *value = (start + half) * f(term) + 0.5 * half * (below + f(term + 1));
        }
        // Its integral, by that of T_k: T_(k+1)/(2k + 2) - T_(k-1)/(2k - 2).
        let mut integral = [[0.0]; TERMS + 2];
        for term in 1..TERMS + 2 {
            let below = if term == 1 { 2.0 * product[0] } else { product[term - 1] };
            let above = product.get(term + 1).unwrap_or(&0.0);
            integral[term][0] = half * (below - above) / (2.0 * term as f64);
        }
        let at_start = clenshaw(&integral, -1.0)[0];
        move |x| clenshaw(&integral, (x - start) * scale - 1.0)[0] - at_start
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
fn clenshaw<const K: usize>(series: &[[f64; K]], x: f64) -> [f64; K] {
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
    fn first_moments_are_integrals() {
        let table = table(1e-12, |x| [(3.0 * x).cos()]).unwrap();
        let integral = |x: f64| x * (3.0 * x).sin() / 3.0 + (3.0 * x).cos() / 9.0;
        for (piece, (start, end)) in table.pieces().enumerate() {
            let moment = table.first_moment(piece);
            for x in [start, 0.7 * start + 0.3 * end, end] {
                assert!((moment(x) - (integral(x) - integral(start))).abs() < 1e-12, "{x}");
            }
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
