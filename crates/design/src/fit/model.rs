//! Measured numbers, and what predicts them.

use papilio_colour::{Observer, Xyz};
use papilio_display::compare::{
    Measured, Measurement, Quantity as MeasuredQuantity, Simulated, SimulatedMetric, StandardDeviation,
};
use papilio_display::scene::Metric;
use papilio_spectra::Grid;

use super::interpolation::weights;
use super::wavelengths::Wavelengths;
use crate::{DesignError, NamedQuantity, Quantity};

/// A measured number.
#[derive(Debug, Clone, PartialEq)]
pub struct Observation {
    /// State, or name of the metric.
    pub name: String,
    /// Direction of the simulated view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the simulated view, degrees.
    pub phi_deg: f64,
    /// `reflectance_factor`, `X`, `Y`, `Z`, `L_star`, `a_star`, `b_star`, or `metric`.
    pub quantity: &'static str,
    /// Wavelength of a reflectance factor, nm, as measured.
    pub wavelength_nm: Option<f64>,
    /// Measured value.
    pub value: f64,
    /// Its standard deviation, if the measurement states it.
    pub standard_deviation: Option<f64>,
    /// Number of the spectrum, the colour or the metric to which it belongs, from 0.
    pub series: usize,
    prediction: Prediction,
}

/// A number with its noun, and its verb.
pub(super) fn counted(count: usize, one: &str, several: &str) -> (String, &'static str) {
    match count {
        1 => (format!("1 {one}"), "is"),
        _ => (format!("{count} {several}"), "are"),
    }
}

/// Kinds of numbers, each with its own unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unit {
    /// Reflectance factors, X, Y, Z.
    Fraction,
    /// CIELAB.
    Lab,
    /// That of a metric.
    Metric,
}

/// What predicts a number: indices are those of the model's quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Prediction {
    /// Spectrum that begins at a quantity, at a wavelength, nm.
    Factor { first: usize, nm: f64 },
    /// X, Y or Z, which begin at a quantity.
    Xyz { first: usize, component: usize },
    /// L\*, a\* or b\* of X, Y, Z, which begin at a quantity.
    Lab { first: usize, component: usize },
    /// A metric.
    Metric { at: usize },
}

/// Errors of a meter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Meter {
    pub(super) wavelength_offset_nm: f64,
    pub(super) scale: f64,
}

impl Default for Meter {
    fn default() -> Self {
        Self { wavelength_offset_nm: 0.0, scale: 1.0 }
    }
}

/// Measured numbers of a display, with the quantities that predict them.
#[derive(Debug, Clone)]
pub struct Model {
    /// Measured numbers.
    pub observations: Vec<Observation>,
    /// What was not used.
    pub notes: Vec<String>,
    pub(super) quantities: Vec<NamedQuantity>,
    /// Measured wavelengths within the range of the scenario that are not used, because of the offset.
    pub(super) dropped: usize,
    /// Names and views of measured metrics that the display does not have.
    pub(super) undefined: Vec<(String, usize)>,
    /// Grid of the predicted spectra.
    grid: Grid,
    /// Condition under which spectra are computed.
    condition_of_spectra: usize,
    /// White in the light of the display, Y = 1.
    white: Xyz,
}

impl Model {
    /// Model of a measurement.
    ///
    /// # Errors
    /// If a metric has no standard deviation; if one is so small or large that its weight is not a number.
    pub(super) fn new(
        simulated: &Simulated,
        measurement: &Measurement,
        wavelengths: &Wavelengths,
    ) -> Result<Self, DesignError> {
        let observer = Observer::of(simulated.observer, &simulated.grid)
            .map_err(|error| DesignError::Fit { reason: error.to_string() })?;
        let white = observer.xyz(&simulated.radiance_of_white);
        let mut model = Self {
            observations: Vec::new(),
            notes: Vec::new(),
            quantities: Vec::new(),
            dropped: 0,
            undefined: Vec::new(),
            grid: wavelengths.of_spectra,
            condition_of_spectra: usize::from(wavelengths.of_spectra != simulated.grid),
            white: white * (1.0 / white.y),
        };
        let mut series = 0;
        for measured in &measurement.states {
            let Some((view, state)) = simulated.counterpart(measured) else { continue };
            let before = model.observations.len();
            model.add_state(measured, (simulated, view, state), wavelengths, series);
            series += usize::from(model.observations.len() > before);
        }
        for metric in &measurement.metrics {
            let Some(view) = simulated.view_of_metric(metric) else { continue };
            let has = |state: &String| simulated.views[view].states.iter().any(|one| one.name == *state);
            if metric.state.as_ref().is_some_and(|state| !has(state)) {
                model.undefined.push((metric.name(), view));
                continue;
            }
            let Some(deviation) = metric.standard_deviation else {
                let reason = format!(
                    "the metric `{}` ({}) has no standard deviation, which a fit needs",
                    metric.name(),
                    metric.place
                );
                return Err(DesignError::Fit { reason });
            };
            let quantity = Quantity::Metric { view, state: metric.state.clone(), metric: metric.metric };
            let at = model.quantity(quantity);
            model.observations.push(Observation {
                name: metric.name(),
                theta_deg: simulated.views[view].theta_deg,
                phi_deg: simulated.views[view].phi_deg,
                quantity: "metric",
                wavelength_nm: None,
                value: metric.value,
                standard_deviation: Some(deviation),
                series,
                prediction: Prediction::Metric { at },
            });
            series += 1;
        }
        model.remove_copies();
        match model.observations.iter().find(|one| !one.has_weight()) {
            Some(one) => {
                let (deviation, value) = (one.standard_deviation.unwrap_or_default(), one.value);
                let reason = format!(
                    "the standard deviation of {}, {deviation:e} of the value {value}, gives no usable weight (expected {LEAST_DEVIATION:e} to \
                     {MOST_DEVIATION:e}, and at least {LEAST_DEVIATION:e} of the value)",
                    one.in_words()
                );
                Err(DesignError::Fit { reason })
            }
            None => Ok(model),
        }
    }

    /// Removes series all of whose numbers another one has, too: a table that is listed twice, or a part of it. Equal readings have
    /// the same errors, so that they count once; a standard deviation that only one of them states holds for both.
    fn remove_copies(&mut self) {
        let mut series: Vec<Vec<Observation>> = Vec::new();
        for one in std::mem::take(&mut self.observations) {
            match series.last_mut().filter(|last| last[0].series == one.series) {
                Some(last) => last.push(one),
                None => series.push(vec![one]),
            }
        }
        let mut kept: Vec<Vec<Observation>> = Vec::new();
        let mut copies: Vec<String> = Vec::new();
        for mut one in series {
            let whole = kept.iter().position(|other| is_within(&one, other));
            let part = kept.iter().position(|other| is_within(other, &one));
            let Some(at) = whole.or(part) else {
                kept.push(one);
                continue;
            };
            if whole.is_none() {
                std::mem::swap(&mut kept[at], &mut one);
            }
            let name = one[0].in_words_of_series();
            copies.extend((!copies.contains(&name)).then_some(name));
            for copied in &one {
                let same = kept[at].iter_mut().filter(|other| other.is_same_reading_as(copied));
                same.for_each(|other| {
                    other.standard_deviation = other.standard_deviation.or(copied.standard_deviation);
                });
            }
        }
        let renumbered = |(number, all): (usize, Vec<Observation>)| {
            all.into_iter().map(move |one| Observation { series: number, ..one })
        };
        self.observations = kept.into_iter().enumerate().flat_map(renumbered).collect();
        if !copies.is_empty() {
            self.notes.push(format!(
                "measured more than once with the same numbers, which count once: {}",
                copies.join(", ")
            ));
        }
    }

    /// Removes the metrics that have no value.
    pub(super) fn remove_undefined(&mut self, values: &[Option<f64>]) {
        let view = |at: usize| self.quantities[at].quantity.view();
        let undefined = self.observations.iter().filter_map(|one| match one.prediction {
            Prediction::Metric { at } if values[at].is_none() => Some((one.name.clone(), view(at))),
            _ => None,
        });
        self.undefined.extend(undefined.collect::<Vec<_>>());
        self.observations
            .retain(|one| !matches!(one.prediction, Prediction::Metric { at } if values[at].is_none()));
    }

    /// Forgets the standard deviations that the measurement states, except those of metrics.
    pub(super) fn forget_deviations(&mut self) {
        let others = self.observations.iter_mut().filter(|one| one.unit() != Unit::Metric);
        others.for_each(|one| one.standard_deviation = None);
    }

    /// Adds the values of the measured metrics to a simulated display.
    pub(super) fn add_metrics(&self, simulated: &mut Simulated, values: &[Option<f64>]) {
        for one in &self.observations {
            let Prediction::Metric { at } = one.prediction else { continue };
            let (Some(value), view) = (values[at], self.quantities[at].quantity.view()) else { continue };
            let (name, standard_deviation) = (one.name.clone(), 0.0);
            simulated.views[view].metrics.push(SimulatedMetric { name, value, standard_deviation });
        }
    }

    /// Adds the numbers of a state.
    fn add_state(
        &mut self,
        measured: &Measured,
        (simulated, view, state): (&Simulated, usize, &str),
        wavelengths: &Wavelengths,
        series: usize,
    ) {
        let (theta_deg, phi_deg) = (simulated.views[view].theta_deg, simulated.views[view].phi_deg);
        let observation = |quantity, wavelength_nm, value, standard_deviation, prediction| Observation {
            name: state.to_owned(),
            theta_deg,
            phi_deg,
            quantity,
            wavelength_nm,
            value,
            standard_deviation,
            series,
            prediction,
        };
        let of_colour = match &measured.standard_deviation {
            Some(StandardDeviation::Colour(deviations)) => deviations.map(Some),
            _ => [None; 3],
        };
        match &measured.quantity {
            MeasuredQuantity::Spectrum(spectrum) => {
                let deviations = match &measured.standard_deviation {
                    Some(StandardDeviation::Spectrum(deviations)) => Some(deviations.values()),
                    _ => None,
                };
                let first = self.spectrum(view, state);
                let points = spectrum.wavelengths_nm().iter().zip(spectrum.values()).enumerate();
                let (own, outside): (Vec<_>, Vec<_>) =
                    points.partition(|(_, (nm, _))| wavelengths.is_own(**nm));
                let (inside, dropped): (Vec<_>, Vec<_>) =
                    own.into_iter().partition(|(_, (nm, _))| wavelengths.is_predicted(**nm));
                self.dropped += dropped.len();
                let at = match simulated.views.len() {
                    1 => String::new(),
                    _ => format!(" at theta {theta_deg} deg"),
                };
                let range = |grid: &Grid| format!("{} to {} nm", grid.start_nm(), grid.stop_nm());
                let mut note = |count: usize, why: String| {
                    if count > 0 {
                        let (wavelengths, are) = counted(count, "wavelength", "wavelengths");
                        self.notes.push(format!("{wavelengths} of `{state}`{at} {are} not used: {why}"));
                    }
                };
                note(outside.len(), format!("outside {}", range(&wavelengths.own)));
                let reach = range(&wavelengths.of_spectra);
                note(
                    dropped.len(),
                    format!("with the offset outside {reach}, as far as the data of the scenario reach"),
                );
                for (index, (nm, value)) in inside {
                    let deviation = deviations.and_then(|all| all.get(index).copied());
                    let prediction = Prediction::Factor { first, nm: *nm };
                    self.observations.push(observation(
                        "reflectance_factor",
                        Some(*nm),
                        *value,
                        deviation,
                        prediction,
                    ));
                }
            }
            MeasuredQuantity::Xyz(xyz) => {
                let first = self.colour(view, state);
                for (component, (name, value)) in
                    ["X", "Y", "Z"].into_iter().zip([xyz.x, xyz.y, xyz.z]).enumerate()
                {
                    let prediction = Prediction::Xyz { first, component };
                    self.observations.push(observation(name, None, value, of_colour[component], prediction));
                }
            }
            MeasuredQuantity::Lab(lab) => {
                let first = self.colour(view, state);
                for (component, (name, value)) in
                    ["L_star", "a_star", "b_star"].into_iter().zip([lab.l, lab.a, lab.b]).enumerate()
                {
                    let prediction = Prediction::Lab { first, component };
                    self.observations.push(observation(name, None, value, of_colour[component], prediction));
                }
            }
        }
    }

    /// First of the quantities of a spectrum, which are added if they are not there.
    fn spectrum(&mut self, view: usize, state: &str) -> usize {
        let at = |bin| Quantity::ReflectanceFactor { view, state: state.to_owned(), bin };
        let first = self.quantity(at(0));
        if first + 1 == self.quantities.len() {
            (1..self.grid.len()).for_each(|bin| self.push(at(bin)));
        }
        first
    }

    /// First of the quantities X, Y, Z of a state, which are added if they are not there.
    fn colour(&mut self, view: usize, state: &str) -> usize {
        let at = |metric| Quantity::Metric { view, state: Some(state.to_owned()), metric };
        let all = [Metric::X, Metric::Y, Metric::Z].map(at);
        let known = self
            .quantities
            .windows(3)
            .position(|three| three.iter().zip(&all).all(|(known, one)| known.quantity == *one));
        known.unwrap_or_else(|| {
            let first = self.quantities.len();
            all.into_iter().for_each(|one| self.push(one));
            first
        })
    }

    fn quantity(&mut self, quantity: Quantity) -> usize {
        let known = self.quantities.iter().position(|known| known.quantity == quantity);
        known.unwrap_or_else(|| {
            self.push(quantity);
            self.quantities.len() - 1
        })
    }

    fn push(&mut self, quantity: Quantity) {
        let condition = match quantity {
            Quantity::ReflectanceFactor { .. } => self.condition_of_spectra,
            _ => 0,
        };
        self.quantities.push(NamedQuantity { name: String::new(), condition, quantity });
    }

    /// Predicts all numbers from the values of the quantities; `None` if one of them is not defined.
    pub(super) fn predict(&self, values: &[Option<f64>], meter: Meter) -> Option<Vec<f64>> {
        self.observations.iter().map(|one| self.predicted(one, values, meter)).collect()
    }

    fn predicted(&self, one: &Observation, values: &[Option<f64>], meter: Meter) -> Option<f64> {
        let xyz = |first: usize| {
            let [x, y, z] = [0, 1, 2].map(|k| values[first + k].map(|value| meter.scale * value));
            Some(Xyz { x: x?, y: y?, z: z? })
        };
        match one.prediction {
            Prediction::Factor { first, nm } => {
                let at = (nm + meter.wavelength_offset_nm - self.grid.start_nm()) / self.grid.step_nm();
                let (bin, weights) = weights(at, self.grid.len())?;
                let near = weights.iter().zip(&values[first + bin..]);
                let factor: Option<f64> = near.map(|(weight, value)| Some(weight * (*value)?)).sum();
                Some(meter.scale * factor?)
            }
            Prediction::Xyz { first, component } => {
                let xyz = xyz(first)?;
                Some([xyz.x, xyz.y, xyz.z][component])
            }
            Prediction::Lab { first, component } => {
                let lab = xyz(first)?.lab(self.white)?;
                Some([lab.l, lab.a, lab.b][component])
            }
            Prediction::Metric { at } => values[at],
        }
    }
}

/// Whether a series has all numbers of another one.
fn is_within(part: &[Observation], whole: &[Observation]) -> bool {
    part.iter().all(|one| whole.iter().any(|other| one.is_same_reading_as(other)))
}

/// Smallest and largest standard deviation; the smallest also relative to the value.
const LEAST_DEVIATION: f64 = 1e-12;
const MOST_DEVIATION: f64 = 1e12;

impl Observation {
    /// Whether the stated standard deviation gives a usable weight.
    fn has_weight(&self) -> bool {
        let least = LEAST_DEVIATION * self.value.abs().max(1.0);
        self.standard_deviation.is_none_or(|deviation| (least..=MOST_DEVIATION).contains(&deviation))
    }

    /// The number in words: what it is, and of what.
    fn in_words(&self) -> String {
        let at = self.wavelength_nm.map_or(String::new(), |nm| format!(" at {nm} nm"));
        match self.unit() {
            Unit::Metric => format!("the metric `{}`", self.name),
            _ => format!("`{}` of `{}`{at}", self.quantity, self.name),
        }
    }

    /// What its series is: a state, with its direction, or a metric.
    fn in_words_of_series(&self) -> String {
        match self.unit() {
            Unit::Metric => self.name.clone(),
            _ => format!("{} at theta {} deg", self.name, self.theta_deg),
        }
    }

    /// Whether both are the same number of the same quantity.
    fn is_same_reading_as(&self, other: &Self) -> bool {
        self.prediction == other.prediction && self.value == other.value
    }

    /// Kind of the number.
    pub(super) fn unit(&self) -> Unit {
        match self.prediction {
            Prediction::Factor { .. } | Prediction::Xyz { .. } => Unit::Fraction,
            Prediction::Lab { .. } => Unit::Lab,
            Prediction::Metric { .. } => Unit::Metric,
        }
    }
}
