//! Extent of the computation of recycled light: fineness of the grid, azimuthal orders, terms of the series.

use papilio_optics::lobe::Lobe;

use super::Pass;
use crate::Nodes;

/// Width from which on the grid has the lobe itself, at every level.
pub(in super::super) const NARROWEST: f64 = 0.035;

/// Extent of the computation of recycled light.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Plan {
    /// Natural digits of the whole result.
    pub(super) digits: f64,
    /// Natural digits by which a pass weakens the light, rounded down to halves.
    pub(super) weakening: f64,
    /// Terms of the reflectance in orders 2, 3, ... of the series; none: the series is summed for each
    /// column.
    pub(super) terms: Vec<usize>,
    /// Azimuthal orders.
    pub(super) orders: usize,
    /// Natural digits of recycled light.
    pub(super) recycled_digits: f64,
    /// Width of the lobe on the grid.
    pub(super) width: f64,
    /// Under a lobe narrower than [`NARROWEST`] (see [`narrow`](super::narrow)).
    pub(super) narrow: Option<NarrowPlan>,
}

/// Extent of the computation under a narrow lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NarrowPlan {
    /// Number of orders 2, 3, ... of the series.
    pub(super) orders: usize,
    /// Natural digits of its nodes.
    pub(super) digits: f64,
    /// Exact passes: order 2 of the series, and order 3 if it matters. None if there are no directed sources,
    /// the table has kinks, or there is a grid with the lobe itself and the later orders matter too much to
    /// be extrapolated.
    pub(super) exact: [Option<ExactPlan>; 2],
    /// How the error of the closed form is extrapolated from the exact orders.
    pub(super) extrapolation: Extrapolation,
    /// Whether there are fields.
    pub(super) has_fields: bool,
    /// Whether there is a grid, from which light without exact passes is corrected.
    pub(super) has_grid: bool,
}

/// Extent of one exact order of the series.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ExactPlan {
    /// Natural digits of its light.
    pub(super) digits: f64,
    /// Terms of the reflectance.
    pub(super) terms: usize,
}

/// Ratio of order j of the series to its closed form, from that of an exact order, by its exponent: rules
/// that differ from level to level, so that the differences of levels show their error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Extrapolation {
    /// 0: the closed form itself. Where the next level has one exact order more, its difference is then the
    /// error of the closed form, and not by chance much smaller.
    None,
    /// 1: the same ratio.
    Constant,
    /// j - 1: each further pass has the same effect.
    Geometric,
    /// (2 j² + 1)/9: proportional to the variance of the direction in which light meets the base, for paths
    /// that spread steadily from the view to the source.
    Spread,
}

impl Extrapolation {
    /// Returns the rule for the level with this number of digits; `is_next_exact`: it is the first level, and
    /// the next one has one exact order more.
    fn at(digits: f64, is_next_exact: bool) -> Self {
        match ((digits - DIGITS_OF_SECOND_LEVEL) / DIGITS_A_LEVEL).round() as i32 {
            // The two levels of a first answer.
            ..0 if digits < DIGITS_OF_FIRST_ANSWERS[0] => Self::None,
            ..0 if digits < DIGITS_OF_FIRST_ANSWERS[1] => Self::Constant,
            ..0 if is_next_exact => Self::None,
            ..0 => Self::Constant,
            level if level % 2 == 0 => Self::Geometric,
            _ => Self::Spread,
        }
    }

    /// Returns the ratio of order `j` to its closed form from that of the last exact order: a power. Where light
    /// is lost, the ratio decreases less than a power: between two directions on the rim itself, 1/n of the light
    /// of n passes remains (Sparre Andersen 1953: a random walk of n steps that returns to its level stays on one
    /// side of it with this probability).
    pub(super) fn extrapolated(self, ratio: f64, j: usize, last: usize) -> f64 {
        let exponent = self.exponent(j, last);
        if exponent == 0.0 {
            1.0
        } else if ratio < 1.0 {
            ratio / (ratio + exponent * (1.0 - ratio))
        } else if exponent == exponent.trunc() {
            ratio.powi(exponent as i32)
        } else {
            ratio.powf(exponent)
        }
    }

    /// Returns the exponent for order `j`, relative to that of the last exact order, 2 or more.
    fn exponent(self, j: usize, last: usize) -> f64 {
        let of = |j: usize| {
            let j = j as f64;
            match self {
                Self::None | Self::Constant => 1.0,
                Self::Geometric => j - 1.0,
                Self::Spread => ((2.0 * j * j + 1.0) / 9.0).min(2.0 * (j - 1.0)),
            }
        };
        if self == Self::None { 0.0 } else { of(j) / of(last) }
    }
}

/// Number of terms below which a polynomial does not follow the oscillations of a film's reflectance over
/// angle at all: about half its phase, 9 rad for a gap of 280 nm at 380 nm.
const TERMS_OF_SWINGS: f64 = 5.0;
/// The same of exact passes under strong fronts: with fewer terms, the error of light that meets the base
/// more than once decreases slowly and irregularly.
const TERMS_UNDER_STRONG_FRONTS: f64 = 12.0;
/// Natural digits gained by each further term of the reflectance (films, over 0 to 90 deg).
const DIGITS_A_TERM: f64 = 1.2;
/// The same for tables with kinks.
const DIGITS_A_KINK: f64 = 0.5;
/// Largest number of coefficients of a form.
const MOST_COEFFICIENTS: usize = 12_000;

impl Plan {
    /// Plans for light of which only the fraction `strength` remains from pass to pass; `reach` is the
    /// largest `sqrt(|beta_v| |beta_l|)` of a view and a directed source; the others say whether there are
    /// points of light, and fields. `None` if no light is sent back.
    pub(in super::super) fn new(
        pass: &Pass<'_>,
        strength: f64,
        (reach, has_points, has_fields): (Option<f64>, bool, bool),
    ) -> Option<Self> {
        let digits = pass.digits;
        let weakening = (-2.0 * strength.min(1.0).ln()).floor() / 2.0;
        if strength <= 0.0 || weakening > digits {
            return None;
        }
        let needed = (digits - weakening).max(LEAST_DIGITS);
        let (terms, recycled_digits) = (Vec::new(), needed);
        let mut plan =
            Self { digits, weakening, terms, orders: 1, recycled_digits, width: WIDEST, narrow: None };
        match pass.diffuser.lobe {
            Lobe::KCorrelation { width } if width < NARROWEST => {
                let of = |may_have_grid| plan.narrow(pass.table, [has_points, has_fields], may_have_grid);
                let without_grid = Self { narrow: Some(of(false)), terms: vec![1], ..plan.clone() };
                plan.narrow = Some(of(true));
                if !plan.has_grid() {
                    return Some(without_grid);
                }
                plan.recycled_digits = (needed - plan.digits_less()).max(LEAST_DIGITS);
                plan.width = width;
                plan.fit(pass, reach);
                // Exact passes are better than a grid for a wider lobe.
                if plan.width > width && without_grid.narrow.is_some_and(|narrow| narrow.exact[0].is_some()) {
                    return Some(without_grid);
                }
            }
            Lobe::KCorrelation { width } => {
                plan.width = width.min(WIDEST);
                plan.fit(pass, reach);
            }
            Lobe::Lambertian => {}
        }
        plan.terms = plan.forms(pass.table).unwrap_or_default();
        Some(plan)
    }

    /// Plans for a narrow lobe; `may_have_grid`: also for light that exact passes could represent.
    fn narrow(&self, table: &Nodes, [has_points, has_fields]: [bool; 2], may_have_grid: bool) -> NarrowPlan {
        let is_directed = has_points || has_fields;
        let is_late = self.digits > DIGITS_WITHOUT_THREE;
        let has_three = |digits: f64| digits > DIGITS_OF_TWO + 2.0 * self.weakening;
        let count = if is_late && has_three(self.digits) { 3 } else { 2 };
        let is_extrapolated = !may_have_grid
            || self.digits < DIGITS_OF_GRID
            || self.digits <= DIGITS_OF_EXTRAPOLATION + f64::from(count) * self.weakening;
        let exact = |order: i32| {
            let weaker = f64::from(order - 2) * self.weakening;
            let digits =
                (self.digits - self.weakening - DIGITS_LESS_OF_CORRECTION).min(0.7 * self.digits - 3.5);
            // The two levels of a first answer differ here, too: otherwise they agree on the same error.
            let least = (SHARE_OF_EXACT * self.digits).min(MOST_OF_LEAST);
            let digits = (digits.max(least) - weaker).max(LEAST_DIGITS);
            let terms = match table {
                Nodes::Constant => 1,
                Nodes::Cosines(_) | Nodes::CosinePanels(_) => {
                    let more = (digits - DIGITS_LESS_OF_TERMS).max(0.0) / DIGITS_A_TERM;
                    let swings = if has_three(DIGITS_OF_SECOND_LEVEL) {
                        TERMS_UNDER_STRONG_FRONTS
                    } else {
                        TERMS_OF_SWINGS
                    };
                    1 + (more + swings).ceil() as usize
                }
                // Kinks are not smooth enough for interpolation.
                Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_) | Nodes::Azimuthal(..) => return None,
            };
            (is_directed && is_extrapolated && order <= count).then_some(ExactPlan { digits, terms })
        };
        let exact = [exact(2), exact(3)];
        let orders = (self.digits / self.weakening.max(0.5) - 1.0).ceil().clamp(1.0, MOST_ORDERS);
        NarrowPlan {
            orders: (orders as usize).max(exact.iter().flatten().count()),
            digits: 0.75 * (self.digits - self.weakening) + 1.0,
            extrapolation: Extrapolation::at(self.digits, has_three(DIGITS_OF_SECOND_LEVEL)),
            exact,
            has_fields,
            has_grid: is_directed && exact[0].is_none() && self.digits > DIGITS_WITHOUT_GRID,
        }
    }

    /// Returns the natural digits that the grid may have less than the whole result.
    fn digits_less(&self) -> f64 {
        let finer = 0.5 * (self.digits - DIGITS_OF_SECOND_LEVEL).max(0.0);
        if self.narrow.is_some() { DIGITS_LESS_OF_CORRECTION + finer } else { 0.0 }
    }

    /// Returns whether there is a grid.
    pub(super) fn has_grid(&self) -> bool {
        self.narrow.is_none_or(|narrow| narrow.has_grid)
    }

    /// Reduces the digits, then widens the lobe, until the grid is small enough; a finer level has a larger
    /// one.
    fn fit(&mut self, pass: &Pass<'_>, reach: Option<f64>) {
        let mut most = MOST_ELEMENTS * (self.digits / 7.0).exp();
        if self.narrow.is_some() {
            let finer = (self.digits - DIGITS_OF_SECOND_LEVEL) / 1.8;
            let stronger = (WEAK - self.weakening).max(0.0);
            most = most.min(MOST_ELEMENTS_OF_CORRECTION * (finer + stronger).exp());
        }
        self.orders = self.orders_for(pass, reach);
        while self.size(pass) > most && self.width < WIDEST {
            if self.recycled_digits > FEWEST_DIGITS_ON_A_LARGE_GRID {
                self.recycled_digits -= 0.5;
            } else {
                self.width *= 1.02;
            }
            self.orders = self.orders_for(pass, reach);
        }
    }

    /// Returns the digits of the grid. Away from a narrow lobe's peak, light is fainter than at the peak, by
    /// the cube of the distance; the error of the grid is not.
    pub(super) fn grid_digits(&self) -> f64 {
        self.recycled_digits + 3.0 * (WIDTH_WITHOUT_PEAK / self.width).ln().max(0.0)
    }

    pub(super) fn orders_for(&self, pass: &Pass<'_>, reach: Option<f64>) -> usize {
        let lobes = if pass.straight() > 0.0 { 2.0 } else { 4.0 };
        1 + reach.map_or(0, |reach| rounded_up(self.grid_digits() * reach / (lobes * self.width)))
    }

    /// Returns the approximate number of elements of the lobe between the nodes of the grid.
    fn size(&self, pass: &Pass<'_>) -> f64 {
        let nodes = 0.4 * self.grid_digits() / self.width;
        nodes * nodes * pass.index * self.orders as f64
    }

    /// Returns the number of azimuthal orders that order `k + 2` of the series needs: fewer where less light
    /// remains.
    pub(super) fn orders_of(&self, k: usize) -> usize {
        let left = (self.digits - (k + 1) as f64 * self.weakening) / (self.digits - self.weakening).max(1e-9);
        let orders = ((self.orders - 1) as f64 * left).ceil().max(0.0) as usize;
        (1 + orders).min(self.orders)
    }

    /// Returns the number of terms of each order, if forms are not too large.
    fn forms(&self, table: &Nodes) -> Option<Vec<usize>> {
        // Under a narrow lobe, every kink of the table counts where the light passes.
        if self.narrow.is_some() && matches!(table, Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_)) {
            return None;
        }
        let mut terms = Vec::new();
        let mut size = 0_usize;
        for k in 2_i32.. {
            let mut left = self.digits - self.digits_less() - f64::from(k - 1) * self.weakening;
            if self.narrow.is_some() && terms.is_empty() {
                left = left.max(1.0);
            }
            if left < 0.0 {
                return Some(terms);
            }
            let count = match table {
                Nodes::Constant => 1,
                Nodes::Cosines(_) | Nodes::CosinePanels(_) => {
                    1 + (left / DIGITS_A_TERM + left.min(1.0) * TERMS_OF_SWINGS).ceil() as usize
                }
                Nodes::AnglesInMedium(_) | Nodes::AnglesInAir(_) | Nodes::Azimuthal(..) => {
                    1 + (left / DIGITS_A_KINK).ceil() as usize
                }
            };
            size = size.saturating_add(count.saturating_pow(k as u32));
            if size > MOST_COEFFICIENTS || k > 30 {
                return None;
            }
            terms.push(count);
        }
        None
    }
}

/// Largest number of elements of the lobe on a grid, before a factor that grows with the digits (about five
/// at the coarsest level) ...
const MOST_ELEMENTS: f64 = 6e5;
/// ... in at least this number of natural digits, if necessary with a wider lobe.
const FEWEST_DIGITS_ON_A_LARGE_GRID: f64 = 6.0;
/// Width from which on the recycled light of a lobe is nearly the same in all directions.
const WIDTH_WITHOUT_PEAK: f64 = 0.08;
/// Width of the lobe for which the coarsest grid is made.
const WIDEST: f64 = 1.0;

/// Largest number of elements on a grid that corrects the light of a narrow lobe, at the second level; seven
/// times as many at each further one, and in proportion more if a pass weakens the light less than this.
const MOST_ELEMENTS_OF_CORRECTION: f64 = 3e5;
const WEAK: f64 = 4.0;
/// Natural digits of the coarsest level, at which there is no such grid.
const DIGITS_WITHOUT_GRID: f64 = 12.0;
/// Natural digits of the second level.
const DIGITS_OF_SECOND_LEVEL: f64 = 15.0;
/// Natural digits below which levels are the first, or the second, of a first answer.
const DIGITS_OF_FIRST_ANSWERS: [f64; 2] = [7.8, 10.25];
/// Natural digits of each further level.
const DIGITS_A_LEVEL: f64 = 3.5;
/// Natural digits that the correction needs less than the light that it corrects, at the second level; half
/// of the digits of each further one are added.
const DIGITS_LESS_OF_CORRECTION: f64 = 4.0;
/// Natural digits that the terms of exact passes need less than these: only their difference from the closed
/// form is computed with terms.
const DIGITS_LESS_OF_TERMS: f64 = 5.5;
/// Natural digits up to which the orders after the exact ones are extrapolated, if passes did not weaken
/// them. Beyond, all orders are those of the grid, from the fourth level on, if it can have the lobe itself.
const DIGITS_OF_EXTRAPOLATION: f64 = 10.5;
const DIGITS_OF_GRID: f64 = 20.0;
/// Natural digits up to which order 2 alone is exact, if passes did not weaken the others; always at the
/// first level, so that its error is the larger one.
const DIGITS_OF_TWO: f64 = 8.0;
const DIGITS_WITHOUT_THREE: f64 = 13.0;
/// Largest number of orders under a narrow lobe; the rest is a geometric series.
const MOST_ORDERS: f64 = 24.0;

/// Natural digits of the exact passes, as a fraction of all, at the levels of a first answer; finer levels
/// have more.
const SHARE_OF_EXACT: f64 = 0.5;
const MOST_OF_LEAST: f64 = 4.5;

/// Smallest number of natural digits of recycled light.
const LEAST_DIGITS: f64 = 3.0;

/// Rounds up to the next of 4, 6, 8, 12, 16, 24, ..., so that the kernels remain valid when a source moves.
fn rounded_up(orders: f64) -> usize {
    let mut step = 4_usize;
    while (step as f64) < orders {
        step += if step.is_power_of_two() { step / 2 } else { step / 3 };
    }
    step
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Diffuser;

    /// From [`NARROWEST`] on the grid has the lobe itself, at every level and for all directions; well
    /// below, it does not.
    #[test]
    fn only_narrow_lobes_are_widened() {
        for (level, index, regular_fraction) in
            [(0.0, 1.5, 0.0), (0.0, 2.0, 0.3), (1.0, 1.5, 0.3), (3.0, 1.7, 0.0)]
        {
            let planned = |width: f64| {
                let lobe = Lobe::KCorrelation { width };
                let diffuser = Diffuser { lobe, transmittance: vec![1.0].into(), regular_fraction };
                let table = &Nodes::Constant;
                let pass = Pass { diffuser: &diffuser, table, index, digits: 11.5 + 3.5 * level };
                Plan::new(&pass, 0.9, (Some(1.0), false, true)).map(|plan| plan.width)
            };
            assert_eq!(planned(NARROWEST), Some(NARROWEST), "{level} {index} {regular_fraction}");
            assert!(planned(0.004) > Some(0.01), "{level} {index} {regular_fraction}");
        }
    }
}
