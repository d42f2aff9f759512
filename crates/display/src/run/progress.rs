//! Progress of a computation, as its caller sees it.
//!
//! A computation reports what it knows: views that are done, the error of the current one, a part of several.
//! Reports arrive from several threads, and a computation may have passes whose number is not known before.
//! [`Progress::fraction`] is an estimate from one report alone; [`ProgressFraction`] is the largest of all
//! reports so far, so that what a caller shows never goes back.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::result::View;

/// Progress of a computation.
#[derive(Clone, Copy)]
pub struct Progress<'a> {
    /// Paths traced so far, over all views (Monte Carlo).
    pub paths: Option<u64>,
    /// Fraction of the current view's work that is done, if it is known.
    pub share_of_view: Option<f64>,
    /// The level of discretisation that is being computed (adding).
    pub level: Option<u32>,
    /// Largest relative error of Y in the current view, if it is estimated.
    pub relative_error: Option<f64>,
    /// Target of the relative error, if there is one.
    pub target: Option<f64>,
    /// Number of views that are done, and of all views.
    pub views_done: (usize, usize),
    /// What `views_done` counts, in the plural: `"views"`, `"directions"`.
    pub unit: &'static str,
    /// The part of the whole computation to which this report belongs, as fractions at its beginning and at
    /// its end.
    pub part: [f64; 2],
    /// Computes the number of the current view, from 0, and its result so far (Monte Carlo).
    pub so_far: Option<&'a dyn Fn() -> (usize, View)>,
}

impl Progress<'_> {
    /// Progress of a computation without paths, in which a number of views out of all are done.
    pub fn of_views(done: usize, all: usize) -> Self {
        Self {
            paths: None,
            share_of_view: None,
            level: None,
            relative_error: None,
            target: None,
            views_done: (done, all),
            unit: "views",
            part: [0.0, 1.0],
            so_far: None,
        }
    }

    /// Adds the largest relative error of the views that are being computed, and its target.
    pub(crate) fn with_error(self, relative_error: f64, target: f64) -> Self {
        Self { relative_error: Some(relative_error), target: Some(target), ..self }
    }

    /// The same as a part of a longer computation, from one fraction to another.
    pub fn within(self, [from, to]: [f64; 2]) -> Self {
        Self { part: self.part.map(|inside| from + inside * (to - from)), ..self }
    }

    /// Fraction of the whole computation that is done, from 0 to 1: an estimate from this report alone.
    pub fn fraction(&self) -> f64 {
        let (done, all) = self.views_done;
        let of_view = match (self.share_of_view, self.target, self.relative_error) {
            (Some(share), ..) => share,
            // Levels of adding, whose errors fall at least with the square of their work: two diffusers have done 0.28 of it where
            // this is 0.18, and 0.64 where it is 0.42. Paths state their part of the work.
            (None, Some(target), Some(error)) => (target / error).sqrt(),
            _ => 0.0,
        };
        // A complete view is already counted.
        let of_view = if of_view < 1.0 { of_view.max(0.0) } else { 0.0 };
        let inside = ((done as f64 + of_view) / all.max(1) as f64).clamp(0.0, 1.0);
        let [from, to] = self.part;
        from + inside * (to - from)
    }
}

/// The largest fraction that was reported so far, from 0. It never decreases, whatever the order of reports.
#[derive(Debug, Default)]
pub struct ProgressFraction(AtomicU64);

impl ProgressFraction {
    /// Takes a report into account; returns the fraction to show.
    pub fn advance(&self, fraction: f64) -> f64 {
        // Bits of numbers from 0 on are in the order of the numbers.
        let bits = fraction.clamp(0.0, 1.0).max(0.0).to_bits();
        f64::from_bits(self.0.fetch_max(bits, Ordering::Relaxed).max(bits))
    }
}

/// Fraction of a computation of many directions that is taken by the sample with which its level is found,
/// about.
pub(crate) const SAMPLE: f64 = 0.1;

/// The part of pass number `pass` (from 0) in a computation whose number of passes is not known: each fills
/// half of what is left.
pub(crate) fn part_of_pass(pass: u32) -> [f64; 2] {
    [pass, pass + 1].map(|passes| 1.0 - 0.5_f64.powi(passes as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fraction_to_show_never_decreases() {
        let shown = ProgressFraction::default();
        let found = [0.1, 0.5, 0.3, f64::NAN, -1.0, 0.6, 7.0, 0.2].map(|fraction| shown.advance(fraction));
        assert_eq!(found, [0.1, 0.5, 0.5, 0.5, 0.5, 0.6, 1.0, 1.0]);
    }

    #[test]
    fn fraction_of_a_report_lies_in_its_part() {
        let half = Progress { share_of_view: Some(0.5), ..Progress::of_views(1, 2) };
        assert_eq!(half.fraction(), 0.75);
        assert_eq!(half.within([0.5, 1.0]).fraction(), 0.875);
        // Parts of parts.
        assert_eq!(half.within([0.0, 0.5]).within([0.5, 1.0]).fraction(), 0.6875);
        assert_eq!(Progress::of_views(0, 1).with_error(0.04, 0.01).fraction(), 0.5);
        // A view that is done is counted once.
        assert_eq!(Progress::of_views(1, 2).with_error(0.005, 0.01).fraction(), 0.5);
        assert_eq!([0, 1, 2].map(part_of_pass), [[0.0, 0.5], [0.5, 0.75], [0.75, 0.875]]);
    }
}
