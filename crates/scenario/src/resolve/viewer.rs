//! Where the reader looks from.

use papilio_display::scene::Viewer;

use super::Resolver;
use crate::describe::viewer::{self as describe, AngleRange, Azimuths, Inclinations};
use crate::problem::Problem;
use crate::source::Origin;

/// More views than this make a result that nobody can open.
const MOST_VIEWS: usize = 5000;

impl Resolver<'_> {
    pub(super) fn viewer(&mut self, viewer: &describe::Viewer) -> Option<Viewer> {
        let origin = viewer.theta_deg.origin;
        let theta_deg = match &viewer.theta_deg.value {
            Inclinations::One(theta) => Some(vec![theta.0]),
            Inclinations::List(list) => self.listed(list.iter().map(|theta| theta.0).collect(), origin),
            Inclinations::Range(range) => self.inclinations(range, origin),
        };
        let origin = viewer.phi_deg.origin;
        let phi_deg = match &viewer.phi_deg.value {
            Azimuths::One(phi) => Some(vec![phi.0]),
            Azimuths::List(list) => self.listed(list.iter().map(|phi| phi.0).collect(), origin),
            Azimuths::Range(range) => self.spaced(range, origin),
        };
        let (theta_deg, phi_deg) = (theta_deg?, phi_deg?);
        let count = theta_deg.len() * phi_deg.len();
        if count > MOST_VIEWS {
            self.err(&viewer.theta_deg, too_many(count as f64));
        }
        let field_deg = viewer.field_deg.0;
        let reach = theta_deg.iter().fold(0.0, |most: f64, theta| most.max(theta.abs())) + 0.5 * field_deg;
        if reach >= 90.0 {
            self.err(&viewer.field_deg, Problem::BelowHorizon { theta_deg: reach });
        }
        Some(Viewer { theta_deg, phi_deg, field_deg, distance_mm: viewer.distance_mm.0 })
    }

    fn listed(&mut self, angles: Vec<f64>, origin: Origin) -> Option<Vec<f64>> {
        if angles.is_empty() {
            self.errors.push(origin, Problem::EmptyList);
            return None;
        }
        Some(angles)
    }

    fn inclinations(&mut self, range: &AngleRange, origin: Origin) -> Option<Vec<f64>> {
        for end in [&range.from, &range.to] {
            if end.0.abs() >= 90.0 {
                let expected = "a number between -90 and 90 (degrees)";
                self.err(end, Problem::OutOfRange { value: end.0, expected });
                return None;
            }
        }
        self.spaced(range, origin)
    }

    /// `from`, `from + step`, ... up to `to`, with a millionth of a step to spare.
    fn spaced(&mut self, range: &AngleRange, origin: Origin) -> Option<Vec<f64>> {
        let (from, to, step) = (range.from.0, range.to.0, range.step.0);
        if from > to {
            self.errors.push(origin, Problem::Range { from, to, step });
            return None;
        }
        let steps = ((to - from) / step + 1e-6).floor();
        if steps + 1.0 > MOST_VIEWS as f64 {
            self.errors.push(origin, too_many(steps + 1.0));
            return None;
        }
        Some((0..=steps as usize).map(|i| (from + step * i as f64).min(to)).collect())
    }
}

fn too_many(count: f64) -> Problem {
    Problem::TooMany { what: "views", count, limit: MOST_VIEWS }
}
