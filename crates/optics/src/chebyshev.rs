//! Functions tabulated on [0, 1] as Chebyshev series on pieces, adaptively divided.

use std::f64::consts::PI;

/// Terms of the series on a piece.
const TERMS: usize = 16;

/// Width below which a piece is not divided further: such a narrow piece carries no light.
const NARROWEST: f64 = 1e-10;

/// `K` functions of one variable on [0, 1].
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Piecewise<const K: usize> {
    /// Starts of the pieces; the first is 0.
    starts: Vec<f64>,
    /// 2 over the width of each piece.
    scales: Vec<f64>,
    /// Coefficients of each piece.
    series: Vec<[[f64; K]; TERMS]>,
}

impl<const K: usize> Piecewise<K> {
    /// Halves [0, 1] until, between the nodes, the series approximate all functions to within `tolerance`;
    /// `None` if that takes more than `most_pieces`.
    pub(crate) fn new<E>(
        tolerance: f64,
        most_pieces: usize,
        function: impl FnMut(f64) -> Result<[f64; K], E>,
    ) -> Result<Option<Self>, E> {
        Self::no_narrower(NARROWEST, tolerance, most_pieces, function)
    }

    /// Does the same, but does not divide pieces narrower than this.
    pub(crate) fn no_narrower<E>(
        narrowest: f64,
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
            if to - from < narrowest || misses_by(&series, &mut at)? <= tolerance {
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

    /// Returns the start and end of each piece.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        self.starts.iter().zip(&self.scales).map(|(start, scale)| (*start, start + 2.0 / scale))
    }

    /// Returns the functions at x, 0 to 1.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> [f64; K] {
        let piece = self.starts.partition_point(|&start| start <= x).saturating_sub(1);
        clenshaw(&self.series[piece], (x - self.starts[piece]) * self.scales[piece] - 1.0)
    }
}

impl Piecewise<1> {
    /// Tabulates functions of x and of this one on the same pieces; sums are preserved by functions that are
    /// linear in it.
    pub(crate) fn map<const K: usize>(&self, mut function: impl FnMut(f64, f64) -> [f64; K]) -> Piecewise<K> {
        let series = self.pieces().map(|(from, to)| {
            let at = |x: f64| {
                let x = 0.5 * (from + to + (to - from) * x);
                Ok::<_, std::convert::Infallible>(function(x, self.at(x)[0]))
            };
            let Ok(series) = interpolate(&mut { at });
            series
        });
        Piecewise { series: series.collect(), starts: self.starts.clone(), scales: self.scales.clone() }
    }
}

impl<const K: usize> Piecewise<K> {
    /// Returns the integral of `x^power f(x)`, power up to 3, from the start of the piece, as a function of
    /// x within it; f is the function of this number.
    pub(crate) fn moment(&self, number: usize, power: usize, piece: usize) -> impl Fn(f64) -> f64 + use<K> {
        const MOST: usize = TERMS + 4;
        let (start, scale) = (self.starts[piece], self.scales[piece]);
        let half = 1.0 / scale;
        let mut product = [0.0; MOST];
        product.iter_mut().zip(&self.series[piece]).for_each(|(value, series)| *value = series[number]);
        let at = |series: &[f64; MOST], term: usize| series.get(term).copied().unwrap_or(0.0);
        // x f, by t T_k = (T_(k-1) + T_(k+1))/2, t T_0 = T_1.
        for _ in 0..power {
            let f = product;
            for (term, value) in product.iter_mut().enumerate() {
                let below = match term {
                    0 => 0.0,
                    1 => 2.0 * f[0],
                    _ => f[term - 1],
                };
                *value = (start + half) * f[term] + 0.5 * half * (below + at(&f, term + 1));
            }
        }
        // Its integral, by that of T_k: T_(k+1)/(2k + 2) - T_(k-1)/(2k - 2).
        let mut integral = [[0.0]; MOST];
        for term in 1..MOST {
            let below = if term == 1 { 2.0 * product[0] } else { product[term - 1] };
            integral[term][0] = half * (below - at(&product, term + 1)) / (2.0 * term as f64);
        }
        let at_start = clenshaw(&integral, -1.0)[0];
        move |x| clenshaw(&integral, (x - start) * scale - 1.0)[0] - at_start
    }
}

/// Returns the series through the values at the Chebyshev points of [-1, 1].
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

/// Returns the largest error midway between the Chebyshev points and at the ends.
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
    fn narrow_peak_is_found_and_resolved() {
        let peak = |x: f64| [1e-6 / (1e-6 + (x - 0.3).powi(2)), (40.0 * x).sin()];
        let table = table(1e-10, peak).unwrap();
        for step in 0..=10_000 {
            let x = f64::from(step) / 10_000.0;
            let (found, exact) = (table.at(x), peak(x));
            assert!((found[0] - exact[0]).abs() < 1e-9 && (found[1] - exact[1]).abs() < 1e-9, "{x}");
        }
    }

    #[test]
    fn moments_equal_integrals() {
        let table = table(1e-12, |x| [0.0, (3.0 * x).cos()]).unwrap();
        // By parts.
        let [first, third] = [
            |x: f64| x * (3.0 * x).sin() / 3.0 + (3.0 * x).cos() / 9.0,
            |x: f64| {
                let (sin, cos) = (3.0 * x).sin_cos();
                (x.powi(3) / 3.0 - 6.0 * x / 27.0) * sin + (x * x / 3.0 - 6.0 / 81.0) * cos
            },
        ];
        for (piece, (start, end)) in table.pieces().enumerate() {
            for (power, integral) in [(1, first), (3, third)] {
                let moment = table.moment(1, power, piece);
                for x in [start, 0.7 * start + 0.3 * end, end] {
                    assert!((moment(x) - (integral(x) - integral(start))).abs() < 1e-12, "{power} {x}");
                }
            }
        }
    }

    #[test]
    fn function_with_too_many_pieces_is_refused() {
        assert_eq!(table(1e-9, |x| [(1e5 * x).sin()]), None);
    }

    #[test]
    fn step_ends_in_narrow_piece() {
        let table = table(1e-9, |x| [f64::from(u8::from(x > 0.3))]).unwrap();
        assert!((table.at(0.3 - 1e-9)[0]).abs() < 1e-9 && (table.at(0.3 + 1e-9)[0] - 1.0).abs() < 1e-9);
    }
}
