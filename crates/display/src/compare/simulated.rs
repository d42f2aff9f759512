//! The simulated side of a comparison from a result in memory.

use papilio_colour::Xyz;

use super::pairs::named;
use super::{Measured, MeasuredMetric, Simulated, SimulatedState, SimulatedView, StateDeviation, view_at};
use crate::result::{RunResult, State, StateValues, View};
use crate::scene::Scene;

impl Simulated {
    /// The simulated display of a run of a scene; `None` without ambient light, in which there are no
    /// reflectance factors.
    pub fn of(result: &RunResult, scene: &Scene) -> Option<Self> {
        let view = |view: &View| {
            let states = view.states.iter().map(|(name, state)| of_state(name, state));
            let states = states.collect::<Option<Vec<_>>>()?;
            let (theta_deg, phi_deg) = (view.theta_deg, view.phi_deg);
            Some(SimulatedView { theta_deg, phi_deg, states, metrics: Vec::new() })
        };
        Some(Self {
            grid: scene.grid,
            radiance_of_white: result.illuminant.radiance_of_white.clone(),
            observer: scene.metrics.observer,
            views: result.views.iter().map(view).collect::<Option<_>>()?,
        })
    }

    /// Number of the view and name of the state that a measured state is compared with; `None` if there is
    /// none.
    pub fn counterpart(&self, measured: &Measured) -> Option<(usize, &str)> {
        let direction = measured.theta_deg.map(|theta_deg| [theta_deg, measured.phi_deg]);
        let (number, view) = view_at(self, direction).ok()?;
        Some((number, named(view, &measured.state)?.name.as_str()))
    }

    /// Number of the view that a measured metric is compared with; `None` if there is none.
    pub fn view_of_metric(&self, metric: &MeasuredMetric) -> Option<usize> {
        view_at(self, metric.theta_deg.map(|theta_deg| [theta_deg, metric.phi_deg]))
            .ok()
            .map(|(number, _)| number)
    }
}

fn of_state(name: &str, state: &State) -> Option<SimulatedState> {
    let [noise, levels] = [Some(&state.standard_error), state.discretisation_error.as_ref()];
    let both = |get: &dyn Fn(&StateValues) -> Option<f64>| {
        let [noise, levels] = [noise, levels].map(|errors| errors.and_then(get).unwrap_or(0.0));
        noise.hypot(levels)
    };
    let factor = state.value.reflectance_factor.clone()?;
    let at = |bin: usize| both(&|errors| errors.reflectance_factor.as_ref()?.get(bin).copied());
    Some(SimulatedState {
        name: name.to_owned(),
        deviation: StateDeviation {
            reflectance_factor: (0..factor.len()).map(at).collect(),
            xyz: [both(&|e| Some(e.X)), both(&|e| Some(e.Y)), both(&|e| Some(e.Z))],
            lab: [both(&|e| e.L_star), both(&|e| e.a_star), both(&|e| e.b_star)],
        },
        reflectance_factor: factor,
        xyz: Xyz { x: state.value.X, y: state.value.Y, z: state.value.Z },
    })
}
