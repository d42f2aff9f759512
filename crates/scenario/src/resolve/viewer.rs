//! `[viewer]`: the views.

use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};

use papilio_diagnostics::{Diagnostic, number};
use papilio_display::scene::Viewer;

use super::Resolver;
use crate::describe::numbers::Inclination;
use crate::describe::viewer::{
    self as describe, AngleRange, Azimuths, Inclinations, NamedPolariser, Polariser,
};
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// Largest number of views: larger results are too large to open.
const MOST_VIEWS: usize = 5000;

/// The field of view of a viewer that states none, degrees.
const DEFAULT_FIELD_DEG: f64 = 0.1;

impl Resolver<'_> {
    pub(super) fn viewer(&mut self, viewer: &describe::Viewer) -> Option<Viewer> {
        let theta_deg = match &viewer.theta_deg.value {
            Inclinations::One(theta) => Some(vec![theta.0]),
            Inclinations::List(list) => self.listed(list, |theta| theta.0, viewer.theta_deg.origin),
            Inclinations::Range(range) => self.inclinations(range, viewer.theta_deg.origin),
        };
        let phi_deg = match &viewer.phi_deg.value {
            Azimuths::One(phi) => Some(vec![phi.0]),
            Azimuths::List(list) => self.listed(list, |phi| phi.0, viewer.phi_deg.origin),
            Azimuths::Range(range) => self.spaced("viewer.phi_deg", range, viewer.phi_deg.origin),
        };
        let (theta_deg, phi_deg) = (theta_deg?, phi_deg?);
        let count = theta_deg.len() * phi_deg.len();
        if count > MOST_VIEWS {
            let at = viewer.theta_deg.origin.or_override([viewer.phi_deg.origin]);
            self.errors.push(at, mistake::too_many("views", count as f64, MOST_VIEWS));
        }
        let aperture = viewer.numerical_aperture.as_ref().map(|aperture| aperture.0);
        if aperture.is_some() && viewer.field_deg.0 != DEFAULT_FIELD_DEG {
            let wrong =
                mistake::not_with("numerical_aperture", "`field_deg`: one of them is the cone of the meter");
            self.errors.push(viewer.numerical_aperture.origin, wrong);
        }
        let field_deg = aperture.map_or(viewer.field_deg.0, |aperture| 2.0 * aperture.asin().to_degrees());
        let reach = theta_deg.iter().fold(0.0, |most: f64, theta| most.max(theta.abs())) + 0.5 * field_deg;
        if reach >= 90.0 {
            let (field, half) = match aperture {
                Some(_) => (viewer.numerical_aperture.origin, "the half angle of numerical_aperture"),
                None => (viewer.field_deg.origin, "half of field_deg"),
            };
            let at = field.or_override([viewer.theta_deg.origin]);
            self.errors.push(at, mistake::below_horizon("cone", reach, ["theta_deg", half]));
        }
        self.note_equal_directions(&theta_deg, &phi_deg);
        let distance_mm = viewer.distance_mm.0;
        let polariser_deg = viewer.polariser.as_ref().map(|polariser| match polariser {
            Polariser::Angle(angle) => angle.0,
            Polariser::Named(NamedPolariser::P) => 0.0,
            Polariser::Named(NamedPolariser::S) => 90.0,
        });
        Some(Viewer {
            theta_deg,
            phi_deg,
            field_deg,
            numerical_aperture: aperture,
            polariser_deg,
            distance_mm,
        })
    }

    /// Adds a note if views have one direction: phi 0 and 360 deg, or theta -30 and 30 deg at phi 0 and 180 deg.
    fn note_equal_directions(&mut self, theta_deg: &[f64], phi_deg: &[f64]) {
        let views = || phi_deg.iter().flat_map(|&phi| theta_deg.iter().map(move |&theta| [theta, phi]));
        let mut first = HashMap::new();
        let (mut equal, mut example) = (0, None);
        for [theta, phi] in views() {
            // At the normal, the azimuth turns what is s and p only.
            let turned = if theta < 0.0 { phi + 180.0 } else { phi };
            let direction = [theta.abs(), turned.rem_euclid(360.0)].map(|angle| (angle * 1e6).round() as i64);
            match first.entry(direction) {
                Entry::Vacant(place) => _ = place.insert([theta, phi]),
                Entry::Occupied(place) => {
                    equal += 1;
                    example.get_or_insert([*place.get(), [theta, phi]]);
                }
            }
        }
        if let Some([[theta, phi], [other_theta, other_phi]]) = example {
            self.notes.push(format!(
                "viewer: {equal} of {} views have the direction of another view: theta {} deg, phi {} deg is theta {} deg, phi {} deg",
                theta_deg.len() * phi_deg.len(),
                number(other_theta),
                number(other_phi),
                number(theta),
                number(phi)
            ));
        }
    }

    /// Returns the angles of a list, which must contain each once.
    pub(super) fn listed<T>(
        &mut self,
        list: &[Spanned<T>],
        angle: fn(&T) -> f64,
        origin: Origin,
    ) -> Option<Vec<f64>> {
        if list.is_empty() {
            self.errors.push(origin, mistake::empty_list());
            return None;
        }
        let mut seen = HashSet::new();
        for item in list.iter().filter(|item| !seen.insert(angle(item).to_bits())) {
            self.err(item, mistake::listed_twice(&angle(item).to_string()));
        }
        Some(list.iter().map(|item| angle(item)).collect())
    }

    fn inclinations(&mut self, range: &AngleRange, origin: Origin) -> Option<Vec<f64>> {
        for end in [&range.from, &range.to] {
            if end.0.abs() >= 90.0 {
                self.err(end, mistake::out_of_range(end.0, Inclination::in_words()));
                return None;
            }
        }
        self.spaced("viewer.theta_deg", range, origin)
    }

    /// Returns `from`, `from + step`, ... up to `to`, with a tolerance of 1e-6 steps.
    pub(super) fn spaced(&mut self, key: &str, range: &AngleRange, origin: Origin) -> Option<Vec<f64>> {
        let (from, to, step) = (range.from.0, range.to.0, range.step.0);
        let origin = origin.or_override([range.from.origin, range.to.origin, range.step.origin]);
        if from > to {
            let wrong = Diagnostic::new(format!("the range from {from} to {to} in steps of {step} is empty"));
            self.errors.push(origin, wrong.expected("from <= to and a step above 0"));
            return None;
        }
        let steps = ((to - from) / step + 1e-6).floor();
        if steps + 1.0 > MOST_VIEWS as f64 {
            let what = if key.starts_with("viewer") { "views" } else { "angles" };
            self.errors.push(origin, mistake::too_many(what, steps + 1.0, MOST_VIEWS));
            return None;
        }
        let last = (from + step * steps).min(to);
        if to - last > 1e-6 * step {
            self.notes.push(format!(
                "{key}: steps of {step} deg from {from} deg end at {} deg, before {to} deg",
                tidy(last)
            ));
        }
        Some((0..=steps as usize).map(|i| (from + step * i as f64).min(to)).collect())
    }
}
