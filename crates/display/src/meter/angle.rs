//! Colour differences of a state between views.
//!
//! Views are compared after all of them are computed. The errors account for the correlation between the two
//! views: the difference is computed at each level of adding, or with each replicate of both views left out
//! in turn.

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
    pub(super) of_levels: Option<LevelError>,
}

/// Compares each view with the first view of smallest inclination; a single view is not compared.
pub(crate) fn against_angle(mut looked: Vec<ViewSamples>) -> Vec<View> {
    let inclination = |one: &ViewSamples| one.view.theta_deg.abs();
    let nearest = looked.iter().min_by(|a, b| inclination(a).total_cmp(&inclination(b)));
    if let Some(normal) = nearest.map(|one| one.colours.clone()).filter(|_| looked.len() > 1) {
        looked.iter_mut().for_each(|one| one.compare(&normal));
    }
    looked.into_iter().map(|one| one.view).collect()
}

impl ViewSamples {
    fn compare(&mut self, normal: &[Vec<Colour>]) {
        for (s, (_, state)) in self.view.states.0.iter_mut().enumerate() {
            let differences =
                self.colours.iter().zip(normal).map(|(here, there)| here[s].differences(&there[s]));
            let differences: Vec<[Option<f64>; 2]> = differences.collect();
            store(state, &differences, self.of_levels.as_ref());
        }
    }
}

/// Stores the u'v' distances and CIEDE2000 differences of all sets as values and errors.
fn store(state: &mut State, differences: &[[Option<f64>; 2]], of_levels: Option<&LevelError>) {
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
    if let (Some(errors), Some(of_levels), [coarser]) = (&mut state.discretisation_error, of_levels, others) {
        let error = |k: usize| value[k].zip(coarser[k]).map(|(a, b)| of_levels.of(a, b));
        write(&mut errors.metrics, [0, 1].map(error));
    }
}
