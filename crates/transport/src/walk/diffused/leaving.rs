//! The share of light at the diffuser's underside that leaves into the air, tabulated: its closed form takes an
//! elliptic integral, ten times what else a path's first pass does.
//!
//! A k-correlation lobe of width b puts it into `|beta| <= 1`; the share falls from 1 to 0 over some b about the rim. Steps
//! of b/64 and cubic interpolation among four points err by less than 1e-8.

use papilio_optics::lobe::Lobe;

/// Steps to a width of the lobe.
const STEPS: f64 = 64.0;

/// Narrower lobes would take more room than a processor's first caches have.
const NARROWEST: f64 = 0.01;

/// Offsets that are computed side by side.
const SIDE_BY_SIDE: usize = 16;

/// Shares at even steps of `|beta|` from one step below 0 on.
#[derive(Debug)]
pub(super) struct Leaving {
    lobe: Lobe,
    per_beta: f64,
    values: Vec<f64>,
}

impl Leaving {
    /// For `|beta|` up to `largest`. Narrow lobes have no table: their shares are computed each time.
    pub(super) fn new(lobe: Lobe, largest: f64) -> Self {
        let width = match lobe {
            Lobe::KCorrelation { width } => width.min(1.0),
            Lobe::Lambertian => 0.0,
        };
        if width < NARROWEST {
            return Self { lobe, per_beta: 0.0, values: Vec::new() };
        }
        let per_beta = STEPS / width;
        // A point before the first step, and three behind the last.
        let count = ((largest * per_beta).ceil() as usize + 4).next_multiple_of(SIDE_BY_SIDE);
        let mut values = Vec::with_capacity(count);
        for first in (0..count).step_by(SIDE_BY_SIDE) {
            let offset = |k: usize| ((first + k) as f64 - 1.0).abs() / per_beta;
            values.extend(lobe.shares_in_disc::<SIDE_BY_SIDE>(std::array::from_fn(offset), 1.0));
        }
        Self { lobe, per_beta, values }
    }

    /// The shares at these `|beta|`.
    #[inline(always)]
    pub(super) fn at<const N: usize>(&self, offsets: [f64; N]) -> [f64; N] {
        if self.values.is_empty() {
            return self.lobe.shares_in_disc(offsets, 1.0);
        }
        let last = self.values.len() - 4;
        let mut place = [0.0; N];
        let mut points = [[0.0; N]; 4];
        for k in 0..N {
            let step = ((offsets[k] * self.per_beta) as u32 as usize).min(last);
            place[k] = step as f64;
            if let Some(around) = self.values.get(step..step + 4) {
                points.iter_mut().zip(around).for_each(|(points, value)| points[k] = *value);
            }
        }
        let mut shares = [0.0; N];
        for k in 0..N {
            let t = offsets[k] * self.per_beta - place[k];
            let (before, next, after) = (t + 1.0, t - 1.0, t - 2.0);
            let outer = t * next * (before * points[3][k] - after * points[0][k]);
            let inner = before * after * (next * points[1][k] - t * points[2][k]);
            shares[k] = outer * (1.0 / 6.0) + inner * 0.5;
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_the_closed_form() {
        for width in [0.003, 0.01, 0.0567, 0.3, 2.0] {
            let lobe = Lobe::KCorrelation { width };
            let leaving = Leaving::new(lobe, 1.52);
            for step in 0..=15_200 {
                let offset = f64::from(step) * 1e-4;
                let [found] = leaving.at([offset]);
                let expected = lobe.share_in_disc(offset, 1.0);
                assert!((found - expected).abs() < 1e-8, "b {width}, |beta| {offset}: {found} {expected}");
            }
        }
    }
}
