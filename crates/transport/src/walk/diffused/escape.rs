//! Table of the fraction of the light below the diffuser that leaves into the air. Its closed form takes an
//! elliptic integral, which costs ten times as much as the rest of a path's first pass.
//!
//! The table holds the fraction of a k-correlation lobe of width b that falls into `|beta| <= 1`; it
//! decreases from 1 to 0 over about b around the rim. With steps of b/32 in `|beta|^2`, b/64 there in
//! `|beta|`, and cubic interpolation among four points, the error is below 1e-8.

use papilio_optics::lobe::Lobe;
use papilio_sampling::warp::rounded;

/// Steps per width of the lobe.
const STEPS: f64 = 32.0;

/// Width below which there is no table: it would exceed the first caches of a processor.
const NARROWEST: f64 = 0.01;

/// Number of offsets that are computed together.
const SIDE_BY_SIDE: usize = 16;

/// Cubic polynomials of the position between uniform steps of `|beta|^2`.
#[derive(Debug)]
pub(in crate::walk) struct Escape {
    lobe: Lobe,
    per_square: f64,
    steps: Vec<[f64; 4]>,
}

impl Escape {
    /// Tabulates the fractions for `|beta|` up to `largest`. Narrow lobes have no table: their fractions are
    /// computed each time.
    pub(in crate::walk) fn new(lobe: Lobe, largest: f64) -> Self {
        let width = match lobe {
            Lobe::KCorrelation { width } => width.min(1.0),
            Lobe::Lambertian => 0.0,
        };
        if width < NARROWEST {
            return Self { lobe, per_square: 0.0, steps: Vec::new() };
        }
        let per_square = STEPS / width;
        // One point before the first step (that of the cubic through the next four), and two after the last.
        let count = ((largest * largest * per_square).ceil() as usize + 4).next_multiple_of(SIDE_BY_SIDE);
        let mut values = vec![0.0];
        for first in (0..count).step_by(SIDE_BY_SIDE) {
            let offset = |k: usize| ((first + k) as f64 / per_square).sqrt();
            values.extend(lobe.fractions_in_disc::<SIDE_BY_SIDE>(std::array::from_fn(offset), 1.0));
        }
        values[0] = 4.0 * (values[1] + values[3]) - 6.0 * values[2] - values[4];
        let steps = values
            .windows(4)
            .map(|around| polynomial([around[0], around[1], around[2], around[3]]))
            .collect();
        Self { lobe, per_square, steps }
    }

    /// Returns the fractions at these `|beta|^2`; those beyond the disc of the medium have no meaning. The
    /// widest registers are not used: they gather four numbers from each of many places more slowly than
    /// scalar loads do.
    #[inline(never)]
    pub(in crate::walk) fn at<const N: usize>(&self, squared: &[f64; N]) -> [f64; N] {
        let mut shares = [0.0; N];
        for (share, squared) in shares.iter_mut().zip(squared) {
            let at = squared * self.per_square;
            let (step, number) = rounded(at);
            *share = match self.steps.get(number as usize).or(self.steps.last()) {
                Some([a, b, c, d]) => {
                    let t = at - step;
                    a + t * (b + t * (c + t * d))
                }
                None => self.lobe.fraction_in_disc(squared.sqrt(), 1.0),
            };
        }
        shares
    }
}

/// Returns the coefficients of the cubic through values at -1, 0, 1 and 2.
fn polynomial([before, here, next, after]: [f64; 4]) -> [f64; 4] {
    let bend = (before + next) / 2.0 - here;
    let twist = (after - before) / 6.0 - (next - here) / 2.0;
    [here, next - here - bend - twist, bend, twist]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_equals_closed_form() {
        for width in [0.003, 0.01, 0.0567, 0.3, 2.0] {
            let lobe = Lobe::KCorrelation { width };
            let leaving = Escape::new(lobe, 1.52);
            for step in 0..=15_200 {
                let offset = f64::from(step) * 1e-4;
                let [found] = leaving.at(&[offset * offset]);
                let expected = lobe.fraction_in_disc(offset, 1.0);
                assert!((found - expected).abs() < 1e-8, "b {width}, |beta| {offset}: {found} {expected}");
            }
        }
    }
}
