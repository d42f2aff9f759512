//! Colours against angle: what a state's colour in one view is to its colour in another.
//!
//! Views are compared last, when all are there. Errors carry what both views share: the difference
//! is taken anew at each level of adding, and with each replicate of both views left out in turn.

use super::levels::LevelError;
use super::metrics::{Colour, jackknife};
use crate::result::{State, StateMetrics, View};

/// A view's result, and the colours that other views are compared with.
#[derive(Debug, Clone)]
pub(crate) struct ViewSamples {
    pub(crate) view: View,
    /// Shape `[set][state]`: the reported colours, then those that tell their errors: the coarser
    /// level's, or those with each replicate left out.
    pub(super) colours: Vec<Vec<Colour>>,
    /// How errors follow from two levels; `None`: from replicates.
    pub(super) of_levels: Option<LevelError>,
}

/// The views, each compared with the first of least inclination; a view alone is compared with nothing.
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
            set(state, &differences, self.of_levels.as_ref());
        }
    }
}

/// Writes the u'v' distances and CIEDE2000 differences of all sets down as a value and its errors.
fn set(state: &mut State, differences: &[[Option<f64>; 2]], of_levels: Option<&LevelError>) {
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
