//! The simulated side of a comparison with a measurement: its metrics, and the standard deviations that the
//! tolerances of its inputs cause.
//!
//! **Method.** The displays of the `[tolerance]`, [`SAMPLES`] of them, are computed as in a tolerance analysis;
//! the standard deviation of each compared number over them is that of the inputs. It has a relative standard
//! error of about 5 %, less where the number depends on the inputs linearly.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_display::compare::{Measurement, Quantity as MeasuredQuantity, Simulated, SimulatedMetric};
use papilio_display::scene::Metric;
use papilio_scenario::{NamedQuantity, ParameterisedScenario, Tolerance};

use crate::parallel::in_parallel;
use crate::search::was_stopped;
use crate::tolerance::{Draw, Production};
use crate::{Condition, DesignError, Evaluator, Quantity, Study};

/// Number of displays of which the standard deviations are computed.
pub const SAMPLES: usize = 256;

/// What a quantity belongs to: the view, and the state by its index.
#[derive(Debug, Clone, PartialEq)]
enum Place {
    Factor { view: usize, state: usize, bin: usize },
    Xyz { view: usize, state: usize, component: usize },
    Lab { view: usize, state: usize, component: usize },
    Metric { view: usize, name: String },
}

/// Adds the measured metrics of a scenario to the simulated display, with their numerical errors if those are
/// known. Metrics that are not defined are omitted.
///
/// # Errors
/// If the scenario cannot be computed.
pub fn add_metrics(
    simulated: &mut Simulated,
    measurement: &Measurement,
    scenario: ParameterisedScenario,
    stop: &AtomicBool,
) -> Result<(), DesignError> {
    let metrics = metrics(simulated, measurement);
    if metrics.is_empty() {
        return Ok(());
    }
    let study = |quantities| Study {
        conditions: vec![Condition { name: String::new(), varied: scenario.clone() }],
        variables: Vec::new(),
        quantities,
    };
    let found = Evaluator::new(Arc::new(study(named(&metrics))), stop).evaluate_with_errors(&[]);
    let values = found.map_err(|error| {
        error_of_metric(error, simulated, measurement, |one| {
            Evaluator::new(Arc::new(study(vec![one])), stop).of_pixels(&[]).err()
        })
    })?;
    for ((place, _), [value, error]) in metrics.into_iter().zip(values) {
        if let (Place::Metric { view, name }, Some(value)) = (place, value) {
            let standard_deviation = error.unwrap_or(0.0);
            simulated.views[view].metrics.push(SimulatedMetric { name, value, standard_deviation });
        }
    }
    Ok(())
}

/// Adds the standard deviations by the tolerances of the inputs to those of the simulated display.
///
/// # Errors
/// If a display cannot be computed, or the computation was stopped.
pub fn add_tolerances(
    simulated: &mut Simulated,
    measurement: &Measurement,
    tolerance: &Tolerance,
    (threads, stop): (usize, &AtomicBool),
    progress: &(dyn Fn(usize) + Sync),
) -> Result<(), DesignError> {
    let all: Vec<(Place, Quantity)> =
        states(simulated, measurement).into_iter().chain(metrics(simulated, measurement)).collect();
    let production = Production::new(tolerance);
    let study = Study { quantities: named(&all), ..(**production.study()).clone() };
    let evaluator = Evaluator::new(Arc::new(study), stop);
    // The first display prepares what the others share.
    let mut first = evaluator.worker();
    first.evaluate(&production.plan().display(0, Draw::Own))?;
    let rows = in_parallel(
        threads,
        SAMPLES,
        progress,
        || first.worker(),
        |evaluator, row| evaluator.evaluate(&production.plan().display(row as u64, Draw::Own)),
    )?;
    for (k, (place, _)) in all.iter().enumerate() {
        let values: Vec<f64> = rows.iter().filter_map(|row| row[k]).collect();
        let count = values.len() as f64;
        if count < 2.0 {
            continue;
        }
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        add(simulated, place, (squares / (count - 1.0)).sqrt());
    }
    Ok(())
}

fn add(simulated: &mut Simulated, place: &Place, deviation: f64) {
    let at = match place {
        Place::Factor { view, state, bin } => {
            simulated.views[*view].states[*state].deviation.reflectance_factor.get_mut(*bin)
        }
        Place::Xyz { view, state, component } => {
            simulated.views[*view].states[*state].deviation.xyz.get_mut(*component)
        }
        Place::Lab { view, state, component } => {
            simulated.views[*view].states[*state].deviation.lab.get_mut(*component)
        }
        Place::Metric { view, name } => {
            let found = simulated.views[*view].metrics.iter_mut().find(|one| one.name == *name);
            found.map(|one| &mut one.standard_deviation)
        }
    };
    if let Some(at) = at {
        *at = at.hypot(deviation);
    }
}

/// Error of measured metrics: that of the first one that `error_of` cannot compute, with its name and its place.
pub(crate) fn error_of_metric(
    error: DesignError,
    simulated: &Simulated,
    measurement: &Measurement,
    error_of: impl Fn(NamedQuantity) -> Option<DesignError>,
) -> DesignError {
    if was_stopped(&error) {
        return error;
    }
    let others = measurement.metrics.iter().filter_map(|one| Some((one, one.metric.source().command()?)));
    let first = others.into_iter().find_map(|(one, command)| {
        let view = simulated.view_of_metric(one)?;
        let quantity = Quantity::Metric { view, state: one.state.clone(), metric: one.metric };
        let error = error_of(NamedQuantity { name: String::new(), condition: 0, quantity })?;
        Some((error, one.name(), command, one.place.clone()))
    });
    match first {
        None => error,
        Some((DesignError::Scenario(errors), metric, command, place)) => errors
            .with_note(&format!("the measured metric `{metric}` (of `papilio {command}`) needs it: {place}"))
            .into(),
        Some((error, metric, command, place)) => {
            DesignError::MeasuredMetric { error: Box::new(error), metric, command, place }
        }
    }
}

fn named(all: &[(Place, Quantity)]) -> Vec<NamedQuantity> {
    let named = |(_, quantity): &(Place, Quantity)| NamedQuantity {
        name: String::new(),
        condition: 0,
        quantity: quantity.clone(),
    };
    all.iter().map(named).collect()
}

/// Quantities of the measured states, each once.
fn states(simulated: &Simulated, measurement: &Measurement) -> Vec<(Place, Quantity)> {
    let mut all: Vec<(Place, Quantity)> = Vec::new();
    for measured in &measurement.states {
        let Some((view, name)) = simulated.counterpart(measured) else { continue };
        let Some(state) = simulated.views[view].states.iter().position(|one| one.name == name) else {
            continue;
        };
        let metric = |metric| Quantity::Metric { view, state: Some(name.to_owned()), metric };
        let three =
            |metrics: [Metric; 3], place: fn(usize, usize, usize) -> Place| -> Vec<(Place, Quantity)> {
                let numbered = metrics.into_iter().enumerate();
                numbered.map(|(component, one)| (place(view, state, component), metric(one))).collect()
            };
        let found = match measured.quantity {
            MeasuredQuantity::Spectrum(_) => (0..simulated.grid.len())
                .map(|bin| {
                    let quantity = Quantity::ReflectanceFactor { view, state: name.to_owned(), bin };
                    (Place::Factor { view, state, bin }, quantity)
                })
                .collect(),
            MeasuredQuantity::Xyz(_) => three([Metric::X, Metric::Y, Metric::Z], |view, state, component| {
                Place::Xyz { view, state, component }
            }),
            MeasuredQuantity::Lab(_) => {
                three([Metric::L_star, Metric::a_star, Metric::b_star], |view, state, component| Place::Lab {
                    view,
                    state,
                    component,
                })
            }
        };
        if !all.iter().any(|(place, _)| Some(place) == found.first().map(|(place, _)| place)) {
            all.extend(found);
        }
    }
    all
}

/// Quantities of the measured metrics, each once.
fn metrics(simulated: &Simulated, measurement: &Measurement) -> Vec<(Place, Quantity)> {
    let mut all: Vec<(Place, Quantity)> = Vec::new();
    for metric in &measurement.metrics {
        let Some(view) = simulated.view_of_metric(metric) else { continue };
        let has_state = |name: &String| simulated.views[view].states.iter().any(|one| one.name == *name);
        if !metric.state.as_ref().is_none_or(has_state) {
            continue;
        }
        let quantity = Quantity::Metric { view, state: metric.state.clone(), metric: metric.metric };
        let place = Place::Metric { view, name: metric.name() };
        if !all.iter().any(|(known, _)| *known == place) {
            all.push((place, quantity));
        }
    }
    all
}
