//! The errors of a picture of states, correlated with the autocorrelations of the filters.

use std::ops::Range;

use pulp::NullaryFnOnce;

use super::costs::{AREA, Costs};
use super::filter::Correlation;

/// A picture, and the states that show it.
#[derive(Clone, Copy)]
pub(super) struct Shown<'a, const N: usize> {
    pub(super) wanted: &'a [[f32; N]],
    pub(super) columns: usize,
    pub(super) states: &'a [u8],
    /// Whether each pixel keeps its state; empty: none does.
    pub(super) fixed: &'a [bool],
    /// From `wanted` to the coordinates.
    pub(super) metric: [[f32; N]; N],
}

/// Some rows of a picture that are correlated, the first of them a multiple of [`AREA`]; the result is the error E of them,
/// and what each of their areas adds to the correlated errors.
pub(super) struct Correlate<'a, const N: usize> {
    pub(super) shown: Shown<'a, N>,
    pub(super) costs: &'a Costs<N>,
    pub(super) rows: Range<usize>,
    /// The coordinates of each row one after the other, each between margins of this width.
    pub(super) into: &'a mut [f32],
    pub(super) margin: usize,
}

impl<const N: usize> Shown<'_, N> {
    /// What is shown less what is wanted, of a row, by coordinates, each after a margin of its own; what is not finite is
    /// wanted as 0.
    #[inline(always)]
    fn errors(&self, costs: &Costs<N>, row: usize, into: &mut [Vec<f32>; N], margins: [usize; N]) {
        let pixels = row * self.columns..(row + 1) * self.columns;
        let both = self.wanted[pixels.clone()].iter().zip(&self.states[pixels]);
        for (x, (wanted, state)) in both.enumerate() {
            let shown = &costs.palette[usize::from(*state)];
            for k in 0..N {
                let mut along = 0.0;
                for (metric, wanted) in self.metric[k].iter().zip(wanted) {
                    along += metric * wanted;
                }
                into[k][margins[k] + x] = shown[k] - if along.is_finite() { along } else { 0.0 };
            }
        }
    }

    /// Adds the errors of a row in one coordinate to the sums of its areas, but for those of fixed pixels, which others
    /// need not make good.
    #[inline(always)]
    fn add_to_areas(&self, areas: &mut [[f32; N]], k: usize, errors: &[f32], row: usize) {
        let fixed = self.fixed.get(row * self.columns..).unwrap_or(&[]);
        for (number, (area, errors)) in areas.iter_mut().zip(errors.chunks(AREA)).enumerate() {
            area[k] += match fixed.get(number * AREA..) {
                None | Some([]) => errors.iter().sum::<f32>(),
                Some(fixed) => {
                    errors.iter().zip(fixed).map(|(error, fixed)| if *fixed { 0.0 } else { *error }).sum()
                }
            };
        }
    }
}

impl<const N: usize> NullaryFnOnce for Correlate<'_, N> {
    type Output = (f64, Vec<[f32; N]>);

    #[inline(always)]
    fn call(self) -> (f64, Vec<[f32; N]>) {
        let Self { shown, costs, rows, into, margin } = self;
        let (columns, all) = (shown.columns, shown.wanted.len() / shown.columns);
        let stride = columns + 2 * margin;
        let reaches = costs.correlations.each_ref().map(|one| one.reach);
        let across = reaches.map(|[across, _]| across);
        let most = reaches.iter().fold(0, |most, [_, down]| most.max(*down));
        // Rows of errors, until what is correlated with them is complete.
        let mut errors: Vec<[Vec<f32>; N]> =
            (0..=most).map(|_| across.map(|across| vec![0.0; columns + 2 * across])).collect();
        let mut line = vec![0.0; columns];
        let mut sums = [0.0; N];
        let wide = columns.div_ceil(AREA);
        let mut areas = vec![[0.0_f32; N]; wide * rows.len().div_ceil(AREA)];
        for from in rows.start.saturating_sub(most)..(rows.end + most).min(all) {
            let padded = &mut errors[from % (most + 1)];
            shown.errors(costs, from, padded, across);
            if rows.contains(&from) {
                let areas = &mut areas[(from - rows.start) / AREA * wide..][..wide];
                for k in 0..N {
                    shown.add_to_areas(areas, k, &padded[k][across[k]..][..columns], from);
                }
            }
            for (k, correlation) in costs.correlations.iter().enumerate() {
                let [_, down] = correlation.reach;
                let reached = from.saturating_sub(down).max(rows.start)..(from + down + 1).min(rows.end);
                if reached.is_empty() {
                    continue;
                }
                if let Some([along, _]) = &correlation.factors {
                    filter(&mut line, &padded[k], along);
                }
                for to in reached {
                    let at = ((to - rows.start) * N + k) * stride + margin;
                    add(
                        &mut into[at..][..columns],
                        correlation,
                        from as isize - to as isize,
                        &line,
                        &padded[k],
                    );
                }
            }
            // Rows that no later one reaches.
            let end = if from + 1 == all { all } else { (from + 1).saturating_sub(most) };
            for row in (from.saturating_sub(most)..end).filter(|row| rows.contains(row)) {
                for (k, sum) in sums.iter_mut().enumerate() {
                    let correlated = &into[((row - rows.start) * N + k) * stride + margin..][..columns];
                    *sum += sum_of_products(&errors[row % (most + 1)][k][across[k]..][..columns], correlated);
                }
            }
        }
        let mut error: f64 = sums.iter().sum();
        for area in &mut areas {
            for (sum, weight) in area.iter_mut().zip(costs.of_areas) {
                error += f64::from(weight * *sum * *sum);
                *sum *= weight;
            }
        }
        (error, areas)
    }
}

/// Adds what a row contributes to another, `down` rows above it: of its filtered line, or of the row itself.
#[inline(always)]
fn add(into: &mut [f32], correlation: &Correlation, down: isize, line: &[f32], padded: &[f32]) {
    if let Some([_, along_y]) = &correlation.factors {
        let weight = along_y[correlation.reach[1].wrapping_add_signed(down)];
        into.iter_mut().zip(line).for_each(|(sum, value)| *sum += weight * value);
        return;
    }
    for (x, weight) in correlation.row(down).iter().enumerate() {
        into.iter_mut().zip(&padded[x..]).for_each(|(sum, error)| *sum += weight * error);
    }
}

/// Sum of products in double precision. Several sums do not wait for each other.
#[inline(always)]
fn sum_of_products(one: &[f32], other: &[f32]) -> f64 {
    let mut sums = [0.0_f64; 16];
    for (one, other) in one.chunks(sums.len()).zip(other.chunks(sums.len())) {
        for ((sum, one), other) in sums.iter_mut().zip(one).zip(other) {
            *sum += f64::from(one * other);
        }
    }
    sums.iter().sum()
}

/// Filters a row that has zeros on both sides.
#[inline(always)]
fn filter(line: &mut [f32], padded: &[f32], weights: &[f32]) {
    line.fill(0.0);
    for (x, weight) in weights.iter().enumerate() {
        line.iter_mut().zip(&padded[x..]).for_each(|(sum, error)| *sum += weight * error);
    }
}
