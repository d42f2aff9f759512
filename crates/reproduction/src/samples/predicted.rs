//! Prediction of a sample, and its comparison with the measurement.

use std::collections::BTreeSet;
use std::path::Path;

use papilio_design::measured::{add_metrics, add_tolerances};
use papilio_display::Control;
use papilio_display::compare::{
    Agreement, CompareError, Comparison, Measurement, Simulated, compare_measurement,
};
use papilio_formats::{DataFile, read_measurement};
use papilio_scenario::{ParameterisedScenario, Scenario, Tolerance};
use schemars::JsonSchema;
use serde::Serialize;

use super::brdf::{self, BrdfComparison};
use super::{AGREES, Case, Quantity, Sample};
use crate::ReproductionError;

/// Verdict on a sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub enum Verdict {
    /// Within the errors of the measurement and of the printed inputs.
    #[serde(rename = "agrees")]
    Agrees,
    /// Within these and the range of the inputs that were not printed.
    #[serde(rename = "within its unknowns")]
    WithinUnknowns,
    /// Outside both.
    #[serde(rename = "disagrees")]
    Disagrees,
}

impl Verdict {
    /// The verdict in words.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Agrees => "agrees",
            Self::WithinUnknowns => "within its unknowns",
            Self::Disagrees => "disagrees",
        }
    }
}

/// A sample, predicted and compared.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct Prediction {
    /// Its name.
    pub name: String,
    /// What it is.
    pub title: String,
    /// Who measured it.
    pub source: String,
    /// Licence of the numbers.
    pub licence: String,
    /// The printed inputs and their uncertainty, in words.
    pub inputs: String,
    /// What explains the verdict, in words.
    pub remark: String,
    /// The verdict; null if the measurement states no standard deviation.
    pub verdict: Option<Verdict>,
    /// Root mean square of predicted minus measured: of all reflectance factors, or of one metric; null for colours and for several
    /// metrics, whose units differ.
    pub rms: Option<f64>,
    /// What `rms` is of: `reflectance factor`, or the name of a metric.
    pub rms_of: String,
    /// Root mean square of z, with the errors of the measurement and of the printed inputs.
    pub z_rms: Option<f64>,
    /// The same with the inputs that were not printed; null if there are none.
    pub z_rms_with_unknowns: Option<f64>,
    /// Mean CIEDE2000 difference of the measured states; null without spectra or colours.
    pub delta_e_2000_mean: Option<f64>,
    /// Root mean square difference of the peaks of spectra, nm; null without peaks.
    pub peak_difference_rms_nm: Option<f64>,
    /// The inputs that were not printed, in words.
    pub unknowns: Vec<String>,
    /// Number of measured numbers with a standard deviation, of which `z_rms` is.
    pub judged: usize,
    /// What was measured and none of the displays has, with the reasons.
    pub not_compared: Vec<String>,
    /// The displays.
    pub cases: Vec<CasePrediction>,
}

/// One display of a sample.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct CasePrediction {
    /// Its name.
    pub name: String,
    /// Its comparison with the measurement, with the errors of the printed inputs.
    pub comparison: Comparison,
    /// Comparison of the BRDF of its pixel, if that was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub brdf: Option<BrdfComparison>,
}

/// Predicts a sample, and compares it with its measurement. Its files are in `folder`.
///
/// # Errors
/// If a file cannot be read, a scenario is invalid or cannot be computed, or nothing measured has a counterpart.
pub fn predict(
    sample: &Sample,
    folder: &Path,
    control: &Control<'_>,
) -> Result<Prediction, ReproductionError> {
    if sample.quantity == Quantity::Brdf {
        let cases = sample
            .cases
            .iter()
            .map(|case| brdf::predict_case(sample, case, folder))
            .collect::<Result<_, _>>()?;
        return Ok(judged(sample, cases, (&[], Vec::new())));
    }
    let file = DataFile::open(&folder.join(&sample.measured), &sample.measured)?;
    let measurement = read_measurement(&file)?.value;
    let mut cases = Vec::new();
    let mut with_unknowns = Vec::new();
    let mut lost: Option<Vec<Option<String>>> = None;
    for (number, case) in sample.cases.iter().enumerate() {
        let part = [number, number + 1].map(|done| done as f64 / sample.cases.len() as f64);
        let found = control.within(part, |control| predict_case(sample, case, folder, &measurement, control));
        let ([stated, widened], lost_here) = found?;
        lost = Some(match lost {
            Some(before) => {
                before.into_iter().zip(lost_here).map(|(before, here)| before.and(here)).collect()
            }
            None => lost_here,
        });
        cases.push(CasePrediction { name: case.name.clone(), comparison: stated, brdf: None });
        with_unknowns.push(widened);
    }
    let mut not_compared: Vec<String> = lost.unwrap_or_default().into_iter().flatten().collect();
    not_compared.dedup();
    Ok(judged(sample, cases, (&with_unknowns, not_compared)))
}

/// The reason for each measured state and metric, in this order, that a display does not have.
fn lost(simulated: &Simulated, measurement: &Measurement) -> Vec<Option<String>> {
    let states = measurement
        .states
        .iter()
        .map(|one| Measurement { states: vec![one.clone()], ..Measurement::default() });
    let metrics = measurement.metrics.iter();
    let metrics = metrics.map(|one| Measurement { metrics: vec![one.clone()], ..Measurement::default() });
    let reason = |one: Measurement| match compare_measurement(simulated, &one) {
        Ok(_) => None,
        Err(CompareError::Nothing { reasons }) => Some(reasons.join("; ")),
    };
    states.chain(metrics).map(reason).collect()
}

/// Judges the displays of a sample.
fn judged(
    sample: &Sample,
    cases: Vec<CasePrediction>,
    (with_unknowns, not_compared): (&[Comparison], Vec<String>),
) -> Prediction {
    let stated: Vec<&Comparison> = cases.iter().map(|case| &case.comparison).collect();
    let agreement = Agreement::together(stated.iter().filter_map(|one| one.agreement));
    let z_rms = agreement.map(|agreement| agreement.z_rms);
    let z_rms_with_unknowns = if sample.unknowns.is_empty() {
        None
    } else {
        Agreement::together(with_unknowns.iter().filter_map(|one| one.agreement))
            .map(|agreement| agreement.z_rms)
    };
    let verdict = z_rms.map(|z| match z_rms_with_unknowns {
        _ if z <= AGREES => Verdict::Agrees,
        Some(widened) if widened <= AGREES => Verdict::WithinUnknowns,
        _ => Verdict::Disagrees,
    });
    let of_brdf = mean(cases.iter().filter_map(|case| Some(case.brdf.as_ref()?.rms.powi(2))));
    let (rms, rms_of) = match of_brdf {
        Some(mean) => (Some(mean.sqrt()), "BRDF, relative".to_owned()),
        None => rms(&stated),
    };
    let states = || stated.iter().flat_map(|one| &one.states);
    let peaks = states().filter_map(|one| Some(one.simulated.peak_nm? - one.measured.peak_nm?));
    Prediction {
        name: sample.name.clone(),
        title: sample.title.clone(),
        source: sample.source.clone(),
        licence: sample.licence.clone(),
        inputs: sample.inputs.clone(),
        remark: sample.remark.clone(),
        verdict,
        rms,
        rms_of,
        z_rms,
        z_rms_with_unknowns,
        delta_e_2000_mean: mean(states().filter_map(|one| one.delta_E_2000)),
        peak_difference_rms_nm: mean(peaks.map(|off| off * off)).map(f64::sqrt),
        unknowns: sample.unknowns.iter().map(|one| one.what.clone()).collect(),
        judged: agreement.map_or(0, |agreement| agreement.count),
        not_compared,
        cases,
    }
}

/// Compares a display with the errors of the printed inputs, and with those of all inputs; with the reasons for what it does not have
/// ([`lost`]).
fn predict_case(
    sample: &Sample,
    case: &Case,
    folder: &Path,
    measurement: &Measurement,
    control: &Control<'_>,
) -> Result<([Comparison; 2], Vec<Option<String>>), ReproductionError> {
    let path = folder.join(&sample.scenario);
    let set: Vec<String> = case.set.iter().map(|(key, value)| format!("{key}={value}")).collect();
    let resolved = Scenario::load(&path, &set)?.resolve()?;
    let result = papilio_display::run(&resolved.scene, control)?;
    if result.solver.interrupted {
        return Err(papilio_display::DisplayError::Interrupted.into());
    }
    let no_light = || ReproductionError::List(format!("{}: there is no ambient light", sample.name));
    let mut simulated = Simulated::of(&result, &resolved.scene).ok_or_else(no_light)?;
    add_metrics(&mut simulated, measurement, ParameterisedScenario::load(&path, &set, &[])?, control.stop)?;
    let unknown = sample.unknowns.iter().map(|unknown| &unknown.tolerance);
    let printed: Vec<&toml::Table> = sample.tolerances.iter().collect();
    let all: Vec<&toml::Table> = printed.iter().copied().chain(unknown).collect();
    let compared = |keys: &[&toml::Table]| {
        let mut simulated: Simulated = simulated.clone();
        if !keys.is_empty() {
            add_inputs(&mut simulated, measurement, &path, &set, keys, control)?;
        }
        let nothing = |error| ReproductionError::List(format!("{}, {}: {error}", sample.measured, case.name));
        compare_measurement(&simulated, measurement).map_err(nothing)
    };
    let stated = compared(&printed)?;
    let widened = if sample.unknowns.is_empty() { stated.clone() } else { compared(&all)? };
    Ok(([stated, widened], lost(&simulated, measurement)))
}

/// Adds the standard deviations by the distributions of inputs.
fn add_inputs(
    simulated: &mut Simulated,
    measurement: &Measurement,
    path: &Path,
    set: &[String],
    keys: &[&toml::Table],
    control: &Control<'_>,
) -> Result<(), ReproductionError> {
    let keys: Vec<String> = keys.iter().map(|key| toml::Value::Table((*key).clone()).to_string()).collect();
    let tolerance = format!("tolerance={{ keys = [{}] }}", keys.join(", "));
    let tolerance = Tolerance::load(path, &[set, &[tolerance]].concat())?;
    let threads =
        control.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    Ok(add_tolerances(simulated, measurement, &tolerance, (threads, control.stop), &|_| {})?)
}

/// Root mean square difference of reflectance factors, or of the one metric if there are no spectra, and what it is of.
fn rms(all: &[&Comparison]) -> (Option<f64>, String) {
    let spectra = all.iter().flat_map(|one| &one.states).filter_map(|state| state.spectrum.as_ref());
    let of_spectra: Vec<f64> = spectra
        .flat_map(|one| one.simulated.iter().zip(&one.measured).map(|(ours, theirs)| (ours - theirs).powi(2)))
        .collect();
    if let Some(mean) = mean(of_spectra.into_iter()) {
        return (Some(mean.sqrt()), "reflectance factor".to_owned());
    }
    let metrics = || all.iter().flat_map(|one| &one.metrics);
    let name = |metric: &str| metric.rsplit('.').next().unwrap_or_default().to_owned();
    let names: BTreeSet<String> = metrics().map(|one| name(&one.metric)).collect();
    let squares = metrics().map(|one| (one.simulated - one.measured).powi(2));
    match Vec::from_iter(names).as_slice() {
        [] => (None, "colours".to_owned()),
        [one] => (mean(squares).map(f64::sqrt), one.clone()),
        several => (None, several.join(", ")),
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}
