//! A sample that is not infinite: a round one, in the middle of which light enters.

use papilio_sampling::warp;

use super::path::Path;
use super::tracer::Tracer;
use crate::walk::PathNumbers;

/// A round sample. Light that reaches its edge is lost: paths that do are marked, and traced as in an infinite sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RoundSample {
    /// Radius of the sample, mm.
    pub radius_mm: f64,
    /// Radius of the disc in its middle through which light enters, mm.
    pub spot_mm: f64,
}

impl Tracer<'_> {
    /// Chooses where a path enters a round sample.
    pub(super) fn place_in_sample(&self, numbers: &PathNumbers<'_>, path: &mut Path) {
        let Some(sample) = &self.sample else { return };
        let (x, y) = warp::uniform_disc(sample.spot_mm, numbers.beside_field());
        path.middle_mm = [path.entry_mm[0] - x, path.entry_mm[1] - y];
    }

    /// Marks a path that is beside the sample. Between two events it moves along a straight line, and a disc is convex: it
    /// is inside all the time if it is inside at all events.
    pub(super) fn watch_edge(&self, path: &mut Path) {
        let (Some(sample), Some([x, y])) = (&self.sample, path.place_mm.first()) else { return };
        let [middle_x, middle_y] = path.middle_mm;
        path.left_sample |= (x - middle_x).hypot(y - middle_y) > sample.radius_mm;
    }
}
