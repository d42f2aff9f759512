//! A fit from its starting points to its report.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_display::DisplayError;
use papilio_display::compare::{IN_PERCENT, MeasuredMetric, Measurement, Simulated, compare_measurement};
use papilio_scenario::{Fit, FitDeviations, FitTarget, FitVariable, ParameterisedScenario};

use super::levenberg_marquardt::{Minimum, descend};
use super::model::{Model, Unit, counted};
use super::problem::{CommonDeviations, Problem, display_values, values};
use super::profile::{End, ends as ends_of, is_at_bound};
use super::report::{Estimated, FitReport, FittedVariable, Residual, Starts};
use super::statistics::{self, rms, runs};
use super::undetermined::{Determined, determined, with_spanning};
use super::wavelengths::Wavelengths;
use crate::measured::error_of_metric;
use crate::parallel::in_parallel;
use crate::search::random_point;
use crate::{Condition, DesignError, Evaluator, NamedQuantity, Study, Values, Variable};

/// Points of which the best one is a start, other than the scenario's own.
const POINTS_PER_START: u64 = 8;
/// Most times that a better minimum is found at an end of an interval.
const MOST_ROUNDS: usize = 10;
/// Most times that standard deviations are estimated.
const MOST_ESTIMATES: usize = 30;
/// Standard deviation of the first round for numbers that state none.
const FIRST: CommonDeviations = CommonDeviations { fraction: 0.01, lab: 1.0 };
/// The smallest. Numbers of a display have errors of about a tenth of these: an exact simulation can be fitted, too.
const LEAST: CommonDeviations = CommonDeviations { fraction: 1e-6, lab: 1e-4 };
/// Difference of -2 ln L above which a minimum is another one.
const BETTER: f64 = 0.1;
/// Normal quantiles of 68.3 and 95 %.
const QUANTILES: [f64; 2] = [1.0, 1.959_963_985];
/// Chi-squares that differ by less belong to the same minimum.
const SAME: f64 = 0.01;
/// Length of an interval over that without bounds below which bounds have cut it.
const CUT: f64 = 0.95;
/// Correlation above which a variable whose interval another one cuts is one with it.
const CORRELATED: f64 = 0.9;
/// Part of the work in the descents from all starts, and part of the rest in a round of intervals.
const OF_STARTS: f64 = 0.5;
const OF_ROUND: f64 = 0.9;
/// Hint for measured states without a counterpart.
const SAME_NAMES: &str =
    "the names of states must equal those of the scenario, and angles must agree to within 1 deg";

/// A fit that is ready to run.
pub struct Fitting<'stop> {
    pub(super) spec: Fit,
    hash: String,
    pub(super) model: Model,
    evaluator: Evaluator<'stop>,
    /// Warnings of the scenario and of its own display.
    warnings: Vec<String>,
}

/// Progress of a fit: the fraction that is done, and words.
pub type FitProgress<'a> = dyn Fn(f64, &str) + Sync + 'a;

impl<'stop> Fitting<'stop> {
    /// Prepares a fit: computes the scenario's own display and finds what predicts each measured number.
    ///
    /// # Errors
    /// If the display cannot be computed by adding; if nothing that was measured has a counterpart, or there are
    /// fewer numbers than variables; a metric without standard deviation.
    pub fn new(spec: Fit, measurement: &Measurement, stop: &'stop AtomicBool) -> Result<Self, DesignError> {
        let start: Vec<f64> = spec.variables.iter().map(|one| one.start).collect();
        let own = display_values(&spec.variables, &start);
        let mut evaluator = Evaluator::new(Arc::new(study(&spec, None, Vec::new())), stop);
        let result = evaluator.hold_level(&own)?;
        let paths = evaluator.study().values(&own)?;
        let resolved = spec.varied.scenario(&paths)?.resolve()?;
        let (scene, mut warnings) = (resolved.scene, resolved.warnings);
        result.warnings.iter().for_each(|one| add_once(&mut warnings, one));
        let mut simulated = Simulated::of(&result, &scene).ok_or_else(|| DesignError::Fit {
            reason: "all light comes from the front light, so there are no reflectance factors to fit"
                .to_owned(),
        })?;
        let (wavelengths, widened) =
            Wavelengths::of(&spec, (&paths, &scene.lighting), &simulated, measurement);
        let mut model = Model::new(&simulated, measurement, &wavelengths)?;
        if spec.deviations == FitDeviations::Residuals {
            model.forget_deviations();
        }
        let of_all = study(&spec, widened, model.quantities.clone());
        let mut evaluator = Evaluator::new(Arc::new(of_all), stop);
        evaluator.hold_level(&own)?;
        let known = evaluator.evaluate(&own).map_err(|error| {
            by_adding(error_of_metric(error, &simulated, measurement, |one| {
                let alone = study(&spec, None, vec![one]);
                Evaluator::new(Arc::new(alone), stop).of_pixels(&own).err()
            }))
        })?;
        model.add_metrics(&mut simulated, &known);
        model.remove_undefined(&known);
        compare_notes(&mut model, &simulated, measurement)?;
        let (numbers, variables) = (model.observations.len(), spec.variables.len());
        let priors = spec.variables.iter().filter(|one| one.prior.is_some()).count();
        if numbers + priors < variables {
            let (numbers, _) = counted(numbers, "measured number", "measured numbers");
            let names: Vec<&str> = model.undefined.iter().map(|(name, _)| name.as_str()).collect();
            let unused = match names.is_empty() {
                true => String::new(),
                false => format!(" (not defined in this display: {})", names.join(", ")),
            };
            let reason = format!("{numbers} cannot determine {variables} variables{unused}");
            return Err(DesignError::Fit { reason });
        }
        let hash = spec.hash_with(&format!("{:?}", model.observations));
        Ok(Self { spec, hash, model, evaluator, warnings })
    }

    /// Fit as read from the scenario.
    pub fn spec(&self) -> &Fit {
        &self.spec
    }

    /// SHA-256 of the fit, of its scenario, of the scenario's files, and of the measured numbers.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// Notes on the measurement and on what is not used of it.
    pub fn notes(&self) -> &[String] {
        &self.model.notes
    }

    /// Warnings of the scenario and of its own display.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Values of the paths of the scenario, in order, for values of the variables.
    ///
    /// # Errors
    /// If a value is not finite.
    pub fn settings(&self, values: &[f64]) -> Result<Vec<(String, serde_json::Value)>, DesignError> {
        let design = display_values(&self.spec.variables, values);
        let settings = self.evaluator.study().settings(&design)?;
        Ok(settings.into_iter().map(|(path, value)| (path.to_owned(), value)).collect())
    }

    /// Runs the fit on threads; the result does not depend on their number. `None` if no start led to a
    /// minimum.
    ///
    /// # Errors
    /// If a display cannot be computed, or the fit was interrupted.
    pub fn run(&self, threads: usize, progress: &FitProgress<'_>) -> Result<Option<FitReport>, DesignError> {
        let Some((mut best, mut common, starts)) = self.minimum(threads, progress)? else { return Ok(None) };
        let mut done = OF_STARTS;
        for round in 1..=MOST_ROUNDS {
            (best, common) = self.refined(best, common)?;
            // A better minimum needs another round, so that each leaves a part.
            let until = done + OF_ROUND * (1.0 - done);
            let of_round = |fraction: f64, words: &str| progress(done + fraction * (until - done), words);
            let found = self.intervals(&best, common, (threads, round == MOST_ROUNDS), &of_round)?;
            done = until;
            match found {
                Intervals::Found { ends, undetermined } => {
                    let best = self.kept(best, common, &undetermined)?;
                    return self.report(&best, common, starts, (&ends, &undetermined)).map(Some);
                }
                Intervals::Better(point) => best.point = point,
            }
        }
        Ok(None)
    }

    pub(super) fn problem(&self, common: CommonDeviations) -> Problem<'_, 'stop> {
        Problem {
            model: &self.model,
            variables: &self.spec.variables,
            evaluator: self.evaluator.worker(),
            common,
        }
    }

    /// The minimum of the largest likelihood, with the standard deviations that follow from the residuals.
    ///
    /// Priors make two solutions possible: data of large errors, which the priors outweigh, and data of small errors, which outweigh
    /// the priors. Both are computed.
    fn minimum(
        &self,
        threads: usize,
        progress: &FitProgress<'_>,
    ) -> Result<Option<(Minimum, CommonDeviations, Starts)>, DesignError> {
        let is_unstated = self.has_unstated(Unit::Fraction) || self.has_unstated(Unit::Lab);
        let has_prior = self.spec.variables.iter().any(|one| one.prior.is_some());
        let begun: &[CommonDeviations] = if is_unstated && has_prior { &[FIRST, LEAST] } else { &[FIRST] };
        let mut found: Option<(Minimum, CommonDeviations, Starts)> = None;
        for (number, common) in begun.iter().enumerate() {
            let of_all = |fraction: f64, words: &str| {
                progress(OF_STARTS * (number as f64 + fraction) / begun.len() as f64, words)
            };
            let Some((best, starts)) = self.starts(*common, threads, &of_all)? else { continue };
            let (best, common) = self.refined(best, *common)?;
            let unlikely = |best: &Minimum, common| best.chi_square + self.of_deviations(common);
            let is_better = found.as_ref().is_none_or(|(other, of_other, _)| {
                unlikely(&best, common) < unlikely(other, *of_other) - BETTER
            });
            if is_better {
                found = Some((best, common, starts));
            }
        }
        Ok(found)
    }

    /// Descends from every start; the best minimum, if any led to one.
    fn starts(
        &self,
        common: CommonDeviations,
        threads: usize,
        progress: &FitProgress<'_>,
    ) -> Result<Option<(Minimum, Starts)>, DesignError> {
        let count = self.spec.starts;
        let words = |done: usize| progress(done as f64 / count as f64, &format!("{done} of {count} starts"));
        let found = in_parallel(
            threads,
            count,
            words,
            || self.problem(common),
            |problem, start| {
                let point = self.start(problem, start)?;
                descend(problem, &point, &vec![false; point.len()], None)
            },
        )?;
        let converged: Vec<&Minimum> = found.iter().flatten().filter(|one| one.has_converged).collect();
        let best = converged.iter().copied().min_by(|a, b| a.chi_square.total_cmp(&b.chi_square)).cloned();
        let Some(best) = best else { return Ok(None) };
        let same = (SAME).max(1e-6 * best.chi_square);
        let starts = Starts {
            count,
            converged: converged.len(),
            best: converged.iter().filter(|one| one.chi_square <= best.chi_square + same).count(),
        };
        Ok(Some((best, starts)))
    }

    /// Starting point: the scenario's own values, or the best of several points within the bounds.
    fn start(&self, problem: &mut Problem<'_, '_>, start: usize) -> Result<Vec<f64>, DesignError> {
        let variables = &self.spec.variables;
        if start == 0 {
            return Ok(variables.iter().map(|one| in_bounds(one, one.start)).collect());
        }
        let first = (start as u64 - 1) * POINTS_PER_START;
        let mut best: Option<(f64, Vec<f64>)> = None;
        for number in first..first + POINTS_PER_START {
            let point = random_point(self.spec.seed, 0, number, variables.len());
            let residuals = problem.residuals(&point)?;
            let chi_square = residuals.map_or(f64::INFINITY, |all| all.iter().map(|one| one * one).sum());
            if best.as_ref().is_none_or(|(least, _)| chi_square < *least) {
                best = Some((chi_square, point));
            }
        }
        Ok(best.map(|(_, point)| point).unwrap_or_default())
    }

    /// Minimises again with the standard deviations that follow from the residuals, until these do not change.
    fn refined(
        &self,
        mut best: Minimum,
        mut common: CommonDeviations,
    ) -> Result<(Minimum, CommonDeviations), DesignError> {
        for _ in 0..MOST_ESTIMATES {
            let mut problem = self.problem(common);
            let held = vec![false; best.point.len()];
            best = descend(&mut problem, &best.point, &held, None)?.unwrap_or(best);
            let next = self.estimated(&problem, &best);
            let change =
                (next.fraction / common.fraction - 1.0).abs().max((next.lab / common.lab - 1.0).abs());
            common = next;
            if change < 1e-3 {
                // Chi-square with the last estimate.
                let mut problem = self.problem(common);
                best = descend(&mut problem, &best.point, &held, None)?.unwrap_or(best);
                break;
            }
        }
        Ok((best, common))
    }

    /// Standard deviations of numbers that state none; unchanged if there are none.
    fn estimated(&self, problem: &Problem<'_, '_>, best: &Minimum) -> CommonDeviations {
        let covariance = determined(&best.jacobian).covariance;
        let leverages = statistics::leverages(&best.jacobian, &covariance);
        let of = |unit: Unit, now: f64, least: f64| {
            let all = self.model.observations.iter().zip(best.residuals.iter().zip(&leverages));
            let unstated = all
                .filter(|(one, _)| one.standard_deviation.is_none() && one.unit() == unit)
                .map(|(_, of)| of);
            let (count, squares, freedom) = unstated.fold((0, 0.0, 0.0), |(count, squares, freedom), of| {
                (count + 1, squares + of.0 * of.0, freedom + 1.0 - of.1)
            });
            match count {
                0 => now,
                _ => (now * (squares / f64::max(freedom, 1.0)).sqrt()).max(least),
            }
        };
        CommonDeviations {
            fraction: of(Unit::Fraction, problem.common.fraction, LEAST.fraction),
            lab: of(Unit::Lab, problem.common.lab, LEAST.lab),
        }
    }

    pub(super) fn has_unstated(&self, unit: Unit) -> bool {
        self.model.observations.iter().any(|one| one.standard_deviation.is_none() && one.unit() == unit)
    }

    pub(super) fn degrees_of_freedom(&self) -> i64 {
        let priors = self.spec.variables.iter().filter(|one| one.prior.is_some()).count();
        (self.model.observations.len() + priors) as i64 - self.spec.variables.len() as i64
    }

    /// Intervals of all determined variables; in the last round, whether or not there is a better minimum.
    fn intervals(
        &self,
        best: &Minimum,
        common: CommonDeviations,
        (threads, is_last): (usize, bool),
        progress: &FitProgress<'_>,
    ) -> Result<Intervals, DesignError> {
        let Determined { undetermined, covariance } = determined(&best.jacobian);
        let n = best.point.len();
        // Variables that priors or numbers with standard deviations determine have more degrees of freedom.
        let is_unstated = |residual: usize| {
            self.model.observations.get(residual).is_some_and(|one| one.standard_deviation.is_none())
        };
        let freedom = statistics::freedom(&best.jacobian, &covariance, is_unstated);
        let quantiles_of = |variable: usize| QUANTILES.map(|z| freedom[variable].quantile(z));
        let tasks: Vec<(usize, f64)> = (0..n)
            .filter(|k| !undetermined.iter().flatten().any(|other| other == k))
            .flat_map(|k| [(k, -1.0), (k, 1.0)])
            .collect();
        let count = tasks.len();
        let words = |done: usize| {
            progress(done as f64 / count.max(1) as f64, &format!("{done} of {count} ends of intervals"))
        };
        let found = in_parallel(
            threads,
            count,
            words,
            || self.problem(common),
            |problem, task| {
                let (variable, side) = tasks[task];
                let deviation = covariance[variable * n + variable].sqrt();
                ends_of(problem, best, (variable, side), (quantiles_of(variable), deviation, is_last))
            },
        )?;
        let mut ends: Vec<Ends> = vec![None; n];
        for ((variable, side), both) in tasks.into_iter().zip(found) {
            let side = usize::from(side > 0.0);
            let deviation = covariance[variable * n + variable].sqrt();
            let interval = ends[variable].get_or_insert_default();
            for (probability, end) in both.into_iter().enumerate() {
                let (u, cut_by) = match end {
                    End::Better(point) => return Ok(Intervals::Better(point)),
                    End::At(u, cut_by) => (u, cut_by),
                };
                let free = quantiles_of(variable)[probability] * deviation;
                let is_shorter = (u - best.point[variable]).abs() < CUT * free;
                let cuts = cut_by.into_iter().filter(|other| *other == variable || is_shorter);
                interval.cut_by[probability][side] = cuts.collect();
                interval.ends[probability][side] = u;
            }
        }
        let undetermined = self.with_cut(&mut ends, undetermined, &covariance);
        Ok(Intervals::Found { ends, undetermined })
    }

    /// Adds variables to the undetermined groups, without their intervals: those whose intervals span their bounds, if no prior
    /// determines them, and those that only the bounds of such a variable limit.
    fn with_cut(
        &self,
        ends: &mut [Ends],
        undetermined: Vec<Vec<usize>>,
        covariance: &[f64],
    ) -> Vec<Vec<usize>> {
        let n = ends.len();
        let spans = |k: &usize| {
            let one = &self.spec.variables[*k];
            let is_known = one.prior.is_some_and(|[_, sigma]| sigma < one.bounds[1] - one.bounds[0]);
            !is_known && ends[*k].as_ref().is_some_and(|one| one.ends[1] == [0.0, 1.0])
        };
        let spanning: Vec<usize> = (0..n).filter(spans).collect();
        let correlation = |i: usize, k: usize| {
            covariance[i * n + k] / (covariance[i * n + i] * covariance[k * n + k]).sqrt()
        };
        let is_cut = |k: &usize| {
            let Some(one) = &ends[*k] else { return false };
            let cuts = |other: &&usize| {
                one.cut_by[1].iter().any(|side| side.contains(other))
                    && correlation(*k, **other).abs() > CORRELATED
            };
            spanning.contains(k) || spanning.iter().any(|other| cuts(&other))
        };
        let all: Vec<usize> = (0..n).filter(is_cut).collect();
        all.iter().for_each(|k| ends[*k] = None);
        with_spanning(undetermined, &all, covariance)
    }

    fn report(
        &self,
        best: &Minimum,
        common: CommonDeviations,
        starts: Starts,
        (ends, undetermined): (&[Ends], &[Vec<usize>]),
    ) -> Result<FitReport, DesignError> {
        let (variables, n) = (&self.spec.variables, best.point.len());
        let Determined { covariance, undetermined: without_number } = determined(&best.jacobian);
        let fitted = values(variables, &best.point);
        let error = |k: usize| covariance[k * n + k].sqrt();
        let variable = |(k, one): (usize, &FitVariable)| {
            let [from, to] = one.bounds;
            let at = |u: f64| from + u * (to - from);
            let is_known = ends[k].is_some();
            let interval = |probability: usize| ends[k].as_ref().map(|one| one.ends[probability].map(at));
            let cut_by = ends[k].as_ref().map_or(Vec::new(), Interval::cut_by);
            FittedVariable {
                key: one.name.clone(),
                keys: one.paths().map(str::to_owned).collect(),
                compensated_by: one.compensated_by().map(str::to_owned),
                value: is_known.then_some(fitted[k]),
                best: fitted[k],
                standard_error: is_known.then(|| error(k) * (to - from)),
                interval_68: interval(0),
                interval_95: interval(1),
                at_bound: is_at_bound(best.point[k]),
                cut_by: cut_by.into_iter().map(|other| variables[other].name.clone()).collect(),
                bounds: one.bounds,
                start: one.own,
                prior: one.prior,
            }
        };
        let correlation = |i: usize, k: usize| {
            let is_without = |k: usize| without_number.iter().flatten().any(|other| *other == k);
            (!is_without(i) && !is_without(k))
                .then(|| (covariance[i * n + k] / (error(i) * error(k))).clamp(-1.0, 1.0))
        };
        let mut problem = self.problem(common);
        let predicted =
            problem.predictions(&best.point)?.ok_or(DesignError::Display(DisplayError::NotFinite))?;
        let residuals: Vec<Residual> = self
            .model
            .observations
            .iter()
            .zip(&predicted)
            .enumerate()
            .map(|(index, (one, predicted))| Residual {
                name: one.name.clone(),
                theta_deg: one.theta_deg,
                phi_deg: one.phi_deg,
                quantity: one.quantity,
                wavelength_nm: one.wavelength_nm,
                measured: one.value,
                standard_deviation: problem.deviation(index),
                predicted: *predicted,
                series: one.series,
            })
            .collect();
        let differences: Vec<f64> = residuals.iter().map(|one| one.predicted - one.measured).collect();
        let estimated = Estimated {
            reflectance_factor: self.has_unstated(Unit::Fraction).then_some(common.fraction),
            lab: self.has_unstated(Unit::Lab).then_some(common.lab),
        };
        let runs = runs(&self.model, &differences);
        let fitted_variables: Vec<FittedVariable> = variables.iter().enumerate().map(variable).collect();
        let mut notes = self.model.notes.clone();
        notes.extend(self.remarks(best, &fitted_variables, &runs, starts));
        Ok(FitReport {
            title: self.spec.title.clone(),
            hash: self.hash.clone(),
            variables: fitted_variables,
            correlations: (0..n).map(|i| (0..n).map(|k| correlation(i, k)).collect()).collect(),
            undetermined: undetermined
                .iter()
                .map(|group| group.iter().map(|k| variables[*k].name.clone()).collect())
                .collect(),
            chi_square: best.chi_square,
            degrees_of_freedom: self.degrees_of_freedom(),
            observations: residuals.len(),
            residual_rms: rms(&self.model, &differences, Unit::Fraction)
                .or_else(|| rms(&self.model, &differences, Unit::Lab)),
            estimated_deviation: estimated,
            runs,
            bic: self.bic(best, common),
            starts,
            warnings: self.warnings.iter().cloned().chain(self.without_weights(best)).collect(),
            notes,
            residuals,
        })
    }

    /// Bayesian information criterion; a standard deviation from the residuals is one more variable.
    fn bic(&self, best: &Minimum, common: CommonDeviations) -> f64 {
        let of_residuals = [Unit::Fraction, Unit::Lab].into_iter().filter(|unit| self.has_unstated(*unit));
        let variables = best.point.len() + of_residuals.count();
        best.chi_square
            + self.of_deviations(common)
            + variables as f64 * (self.model.observations.len() as f64).ln()
    }

    /// Part of -2 ln L by the standard deviations from the residuals.
    fn of_deviations(&self, common: CommonDeviations) -> f64 {
        let all = self.model.observations.iter().filter(|one| one.standard_deviation.is_none());
        let of = |unit: Unit| match unit {
            Unit::Lab => common.lab,
            Unit::Fraction | Unit::Metric => common.fraction,
        };
        all.map(|one| 2.0 * of(one.unit()).ln()).sum()
    }
}

/// Intervals of a variable, `[probability][side]`.
#[derive(Debug, Clone, Default)]
pub(super) struct Interval {
    /// Their ends, in the unit cube.
    ends: [[f64; 2]; 2],
    /// Variables whose bounds cut them there.
    cut_by: [[Vec<usize>; 2]; 2],
}

impl Interval {
    /// All variables whose bounds cut an interval.
    fn cut_by(&self) -> Vec<usize> {
        let mut all: Vec<usize> = self.cut_by.iter().flatten().flatten().copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// Intervals of a variable; `None` if the data do not determine it.
type Ends = Option<Interval>;

/// Ends of intervals, in the unit cube, of the variables that the data determine; or a better minimum.
enum Intervals {
    /// With the groups of variables that the data do not determine.
    Found {
        ends: Vec<Ends>,
        undetermined: Vec<Vec<usize>>,
    },
    Better(Vec<f64>),
}

fn add_once(all: &mut Vec<String>, one: &str) {
    if all.iter().all(|known| known != one) {
        all.push(one.to_owned());
    }
}

pub(super) fn in_bounds(variable: &FitVariable, value: f64) -> f64 {
    let [from, to] = variable.bounds;
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// Adds notes on what was measured and is not used.
fn compare_notes(
    model: &mut Model,
    simulated: &Simulated,
    measurement: &Measurement,
) -> Result<(), DesignError> {
    let undefined = &model.undefined;
    let is_defined = |one: &&MeasuredMetric| {
        let view = simulated.view_of_metric(one);
        view.is_none_or(|view| !undefined.contains(&(one.name(), view)))
    };
    let defined = Measurement {
        states: measurement.states.clone(),
        metrics: measurement.metrics.iter().filter(is_defined).cloned().collect(),
    };
    let mut names: Vec<&str> = undefined.iter().map(|(name, _)| name.as_str()).collect();
    names.dedup();
    let unused = (!names.is_empty()).then(|| {
        format!(
            "not used, because this display has no states or keys that define them (docs/metrics.md): {}",
            names.join(", ")
        )
    });
    if let (Some(unused), true) = (&unused, defined.states.is_empty() && defined.metrics.is_empty()) {
        return Err(DesignError::Fit { reason: format!("nothing is left to fit\n  {unused}") });
    }
    let compared = compare_measurement(simulated, &defined)
        .map_err(|error| DesignError::Fit { reason: format!("{error}\n  = help: {SAME_NAMES}") })?;
    const OF_COLOURS: [&str; 4] = ["not measured", "colours are", "no contrast", "no gamut"];
    let is_of_fit = |note: &&String| OF_COLOURS.iter().all(|of_colours| !note.starts_with(of_colours));
    model.notes.splice(0..0, compared.left_out.iter().filter(is_of_fit).cloned().chain(unused));
    if compared.looks_like_percent() {
        model.notes.push(IN_PERCENT.to_owned());
    }
    Ok(())
}

/// Error of a display that only the other solver computes: a fit cannot use that one.
fn by_adding(error: DesignError) -> DesignError {
    let reason = |what: &str, key: &str| {
        format!(
            "a fit uses the adding solver, which does not compute the places of light for {what} (see `{key}`)"
        )
    };
    match error {
        DesignError::MeasuredMetric { error, metric, command, place } => {
            let error = match *error {
                DesignError::Display(DisplayError::PlacesByPaths { what, key }) => {
                    let help = "leave this metric out of the measurement; `papilio compare` compares it";
                    Box::new(DesignError::Fit {
                        reason: format!("{}\n  = help: {help}", reason(&what, &key)),
                    })
                }
                other => Box::new(other),
            };
            DesignError::MeasuredMetric { error, metric, command, place }
        }
        DesignError::Display(DisplayError::PlacesByPaths { what, key }) => {
            DesignError::Fit { reason: reason(&what, &key) }
        }
        other => other,
    }
}

/// Study of the variables of the display; `widened` is the scenario of the spectra, if it is another one.
fn study(spec: &Fit, widened: Option<ParameterisedScenario>, quantities: Vec<NamedQuantity>) -> Study {
    let variable = |one: &FitVariable| match &one.target {
        FitTarget::Keys(keys) => {
            Some(Variable { name: one.name.clone(), keys: keys.clone(), values: Values::Number })
        }
        FitTarget::WavelengthOffset | FitTarget::Scale => None,
    };
    Study {
        conditions: std::iter::once(spec.varied.clone())
            .chain(widened)
            .map(|varied| Condition { name: String::new(), varied })
            .collect(),
        variables: spec.variables.iter().filter_map(variable).collect(),
        quantities,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refused_layers_are_not_sent_to_the_other_solver() {
        let refused =
            || DisplayError::PlacesByPaths { what: "layers".to_owned(), key: "display.layers".to_owned() };
        let of_metric = DesignError::MeasuredMetric {
            error: Box::new(refused().into()),
            metric: "white.f50_x_per_mm".to_owned(),
            command: "mtf",
            place: "m.csv:2:1".to_owned(),
        };
        for error in [refused().into(), of_metric] {
            assert!(error.to_string().contains("monte-carlo"));
            let ours = by_adding(error).to_string();
            assert!(!ours.contains("monte-carlo") && ours.contains("a fit uses the adding solver"), "{ours}");
        }
    }
}
