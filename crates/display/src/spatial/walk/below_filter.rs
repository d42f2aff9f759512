//! Patterns of a display with a colour filter.

use papilio_transport::walk::places::{FilterPlane, Meeting, Pattern};

use crate::scene::FilterState;

/// A pattern of states of a display with a filter, about the view's own ray, which is anywhere below the
/// filter: below each window the state that the pixel has there, black between them.
pub(super) struct BelowFilter<'a> {
    pub(super) plane: &'a FilterPlane,
    pub(super) states: &'a [FilterState],
    pub(super) pattern: &'a dyn Pattern,
}

/// Most periods of a pattern over which the own rays of paths are distributed.
const MOST_PERIODS: u32 = 1000;

impl BelowFilter<'_> {
    /// Length over which own rays are distributed along an axis: whole periods of the pattern that are whole
    /// periods of the filter, or very many.
    fn whole_periods(&self, axis: usize) -> f64 {
        let (own, filter) = (self.pattern.period_mm()[axis], self.plane.period_mm[axis]);
        let fits = |periods: &u32| {
            let over = f64::from(*periods) * own / filter;
            over >= 0.5 && (over - over.round()).abs() < 1e-6
        };
        match own > 0.0 {
            true => f64::from((1..=MOST_PERIODS).find(fits).unwrap_or(MOST_PERIODS)) * own,
            false => filter,
        }
    }
}

impl Pattern for BelowFilter<'_> {
    fn images(&self) -> usize {
        self.pattern.images()
    }

    fn period_mm(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.whole_periods(axis))
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        let own_mm = [0.0; 2];
        self.shows_at(
            &Meeting { place_mm, own_mm, own_at_filter_mm: own_mm, passed_mm: own_mm, is_first: true },
            covered,
        );
    }

    fn shows_at(&self, meeting: &Meeting, covered: &mut dyn FnMut(usize, usize, f64)) {
        let Some(window) = self.plane.window_at(meeting.place_mm) else { return };
        let mut below = |image: usize, state: usize, fraction: f64| {
            covered(image, self.states[state].pixel_states[window], fraction);
        };
        // A pattern without a period is about the own ray.
        let periods = self.pattern.period_mm();
        let from = |axis: usize| if periods[axis] > 0.0 { 0.0 } else { meeting.own_mm[axis] };
        self.pattern.shows([0, 1].map(|axis| meeting.place_mm[axis] - from(axis)), &mut below);
    }
}
