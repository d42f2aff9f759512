//! Colour differences of a state between views.
//!
//! Views are compared after all of them are computed. The errors account for the correlation between the two
//! views: the difference is computed at each level of adding, or with each replicate of both views left out
//! in turn. By adding, it is at least what the smallest errors of X, Y and Z of both views change it by.

use super::levels::LevelError;
use super::metrics::{Colour, jackknife};
use crate::result::{State, StateMetrics, View};

/// Result of a view, and the colours with which other views are compared.
#[derive(Debug, Clone)]
pub(crate) struct ViewSamples {
    pub(crate) view: View,
    /// Shape `[set][state]`: the reported colours, followed by those from which their errors are computed,
    /// which are those of the coarser level, or those with each replicate left out.
    pub(super) colours: Vec<Vec<Colour>>,
    /// Error model of adding; `None`: errors are computed from replicates.
    pub(super) of_levels: Option<(LevelError, Changes)>,
}

/// Colours with X, Y or Z changed a little.
#[derive(Debug, Clone)]
pub(super) struct Changes {
    /// Shape `[component][state]`.
    pub(super) colours: [Vec<Colour>; 3],
    /// Ratio of the smallest error of X, Y and Z to this change.
    pub(super) per_change: f64,
}

/// Compares each view with the first view of smallest inclination; a single view is not compared.
pub(crate) fn against_angle(mut looked: Vec<ViewSamples>) -> Vec<View> {
    let inclination = |one: &ViewSamples| one.view.theta_deg.abs();
    let nearest = looked.iter().min_by(|a, b| inclination(a).total_cmp(&inclination(b)));
    if let Some(normal) = nearest.cloned().filter(|_| looked.len() > 1) {
        looked.iter_mut().for_each(|one| one.compare(&normal));
    }
    looked.into_iter().map(|one| one.view).collect()
}

impl ViewSamples {
    fn compare(&mut self, normal: &Self) {
        let least: Vec<[f64; 2]> =
            (0..self.view.states.0.len()).map(|state| self.least_errors(normal, state)).collect();
        for (s, (_, state)) in self.view.states.0.iter_mut().enumerate() {
            let differences =
                self.colours.iter().zip(&normal.colours).map(|(here, there)| here[s].differences(&there[s]));
            let differences: Vec<[Option<f64>; 2]> = differences.collect();
            store(state, &differences, self.of_levels.as_ref().map(|(errors, _)| (errors, least[s])));
        }
    }

    /// Returns what the smallest errors of X, Y and Z of both views change the differences of a state by.
    fn least_errors(&self, normal: &Self, state: usize) -> [f64; 2] {
        let mut least = [0.0; 2];
        if (self.view.theta_deg, self.view.phi_deg) == (normal.view.theta_deg, normal.view.phi_deg) {
            return least;
        }
        let own = [&self.colours[0][state], &normal.colours[0][state]];
        let value = own[0].differences(own[1]);
        let changes = [self, normal].map(|one| one.of_levels.as_ref().map(|(_, changes)| changes));
        for (view, changes) in changes.into_iter().enumerate().filter_map(|(k, one)| Some((k, one?))) {
            for colours in &changes.colours {
                let mut both = own;
                both[view] = &colours[state];
                let changed = both[0].differences(both[1]);
                for ((least, value), changed) in least.iter_mut().zip(value).zip(changed) {
                    *least += value.zip(changed).map_or(0.0, |(a, b)| changes.per_change * (b - a).abs());
                }
            }
        }
        least
    }
}

/// Stores the u'v' distances and CIEDE2000 differences of all sets as values and errors; `of_levels` has the smallest errors.
fn store(state: &mut State, differences: &[[Option<f64>; 2]], of_levels: Option<(&LevelError, [f64; 2])>) {
    let write = |metrics: &mut StateMetrics, [shift, delta_e]: [Option<f64>; 2]| {
        metrics.shift_with_angle_uv = shift;
        metrics.delta_E_2000_with_angle = delta_e;
    };
    let Some((value, others)) = differences.split_first() else { return };
    write(&mut state.value.metrics, *value);
    let standard = match of_levels {
        Some(_) => value.map(|value| value.map(|_| 0.0)),
        None => [0, 1].map(|k| jackknife(&mut others.iter().map(|other| other[k]))),
    };
    write(&mut state.standard_error.metrics, standard);
    if let (Some(errors), Some((of_levels, least)), [coarser]) =
        (&mut state.discretisation_error, of_levels, others)
    {
        let error = |k: usize| value[k].zip(coarser[k]).map(|(a, b)| of_levels.of(a, b).max(least[k]));
        write(&mut errors.metrics, [0, 1].map(error));
    }
}
