//! A fit from its starting points to its report.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use papilio_display::DisplayError;
use papilio_display::compare::{IN_PERCENT, Measurement, Simulated, compare_measurement};
use papilio_scenario::{Fit, FitDeviations, FitTarget, FitVariable};

use super::levenberg_marquardt::{Minimum, descend};
use super::model::{Model, Unit};
use super::problem::{CommonDeviations, Problem, display_values, values};
use super::profile::{End, ends as ends_of};
use super::report::{Estimated, FitReport, FittedVariable, Residual, Starts};
use super::statistics::{rms, runs, student};
use super::undetermined::{Determined, determined, with_spanning};
use crate::measured::error_of_metric;
use crate::parallel::in_parallel;
use crate::search::random_point;
use crate::{Condition, DesignError, Evaluator, NamedQuantity, Study, Values, Variable};

/// Points of which the best one is a start, other than the scenario's own.
const POINTS_PER_START: u64 = 8;
/// Most times that standard deviations are estimated, or a better minimum is found at an end of an interval.
const MOST_ROUNDS: usize = 10;
/// Standard deviation of the first round for numbers that state none.
const FIRST: CommonDeviations = CommonDeviations { fraction: 0.01, lab: 1.0 };
/// Chi-square over the degrees of freedom below which residuals are too small for the stated errors to be too small.
const SMALL: f64 = 0.25;
/// Normal quantiles of 68.3 and 95 %.
const QUANTILES: [f64; 2] = [1.0, 1.959_963_985];
/// Distance from a bound that counts as being there, in widths of the bounds.
const AT_BOUND: f64 = 1e-6;
/// Chi-squares that differ by less belong to the same minimum.
const SAME: f64 = 0.01;
/// Part of the work in the descents from all starts, and part of the rest in a round of intervals.
const OF_STARTS: f64 = 0.5;
const OF_ROUND: f64 = 0.9;
/// Standard deviations of chi-square above its degrees of freedom, and its ratio to them, beyond which the model is noted not to
/// describe the data.
const FAR_ABOVE: f64 = 6.0;
const TIMES: f64 = 3.0;
/// Runs that are fewer than this, in standard deviations, are noted.
const FEW_RUNS: f64 = -3.0;

/// Hint for measured states without a counterpart.
const SAME_NAMES: &str =
    "the names of states must equal those of the scenario, and angles must agree to within 1 deg";

/// A fit that is ready to run.
pub struct Fitting<'stop> {
    spec: Fit,
    hash: String,
    model: Model,
    evaluator: Evaluator<'stop>,
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
        let mut evaluator = Evaluator::new(Arc::new(study(&spec, Vec::new())), stop);
        let result = evaluator.hold_level(&own)?;
        let scene = spec.varied.scenario(&evaluator.study().values(&own)?)?.resolve()?.scene;
        let mut simulated = Simulated::of(&result, &scene).ok_or_else(|| DesignError::Fit {
            reason: "all light comes from the front light, so there are no reflectance factors to fit"
                .to_owned(),
        })?;
        let of_offset = spec.variables.iter().find(|one| one.target == FitTarget::WavelengthOffset);
        let offsets = of_offset.map_or([0.0; 2], |one| one.bounds);
        let mut model = Model::new(&simulated, measurement, offsets)?;
        if spec.deviations == FitDeviations::Residuals {
            model.forget_deviations();
        }
        let mut evaluator = Evaluator::new(Arc::new(study(&spec, model.quantities.clone())), stop);
        evaluator.hold_level(&own)?;
        let known = evaluator.evaluate(&own).map_err(|error| {
            error_of_metric(error, &simulated, measurement, |one| {
                let alone = study(&spec, vec![one]);
                Evaluator::new(Arc::new(alone), stop).of_pixels(&own).err()
            })
        })?;
        model.add_metrics(&mut simulated, &known);
        let compared = compare_measurement(&simulated, measurement)
            .map_err(|error| DesignError::Fit { reason: format!("{error}\n  = help: {SAME_NAMES}") })?;
        if compared.looks_like_percent() {
            model.notes.push(IN_PERCENT.to_owned());
        }
        model.notes.splice(
            0..0,
            compared
                .left_out
                .into_iter()
                .filter(|note| !note.starts_with("not measured") && !note.starts_with("colours are")),
        );
        let (numbers, variables) = (model.observations.len(), spec.variables.len());
        let priors = spec.variables.iter().filter(|one| one.prior.is_some()).count();
        if numbers + priors < variables {
            let reason = format!("{numbers} measured numbers cannot determine {variables} variables");
            return Err(DesignError::Fit { reason });
        }
        let hash = spec.hash_with(&format!("{:?}", model.observations));
        Ok(Self { spec, hash, model, evaluator })
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
        let mut common = FIRST;
        let found = self.starts(common, threads, progress)?;
        let converged: Vec<&Minimum> = found.iter().flatten().filter(|one| one.has_converged).collect();
        let best = converged.iter().copied().min_by(|a, b| a.chi_square.total_cmp(&b.chi_square)).cloned();
        let Some(mut best) = best else { return Ok(None) };
        let same = (SAME).max(1e-6 * best.chi_square);
        let starts = Starts {
            count: self.spec.starts,
            converged: converged.len(),
            best: converged.iter().filter(|one| one.chi_square <= best.chi_square + same).count(),
        };
        let mut done = OF_STARTS;
        for _ in 0..MOST_ROUNDS {
            (best, common) = self.refined(best, common)?;
            // A better minimum needs another round, so that each leaves a part.
            let until = done + OF_ROUND * (1.0 - done);
            let of_round = |fraction: f64, words: &str| progress(done + fraction * (until - done), words);
            let found = self.intervals(&best, common, threads, &of_round)?;
            done = until;
            match found {
                Intervals::Found { ends, undetermined } => {
                    return self.report(&best, common, starts, (&ends, &undetermined)).map(Some);
                }
                Intervals::Better(point) => best.point = point,
            }
        }
        Ok(None)
    }

    fn problem(&self, common: CommonDeviations) -> Problem<'_, 'stop> {
        Problem {
            model: &self.model,
            variables: &self.spec.variables,
            evaluator: self.evaluator.worker(),
            common,
        }
    }

    /// Descends from every start.
    fn starts(
        &self,
        common: CommonDeviations,
        threads: usize,
        progress: &FitProgress<'_>,
    ) -> Result<Vec<Option<Minimum>>, DesignError> {
        let count = self.spec.starts;
        let words = |done: usize| {
            progress(OF_STARTS * done as f64 / count as f64, &format!("{done} of {count} starts"))
        };
        in_parallel(
            threads,
            count,
            words,
            || self.problem(common),
            |problem, start| {
                let point = self.start(problem, start)?;
                descend(problem, &point, &vec![false; point.len()], None)
            },
        )
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
        for _ in 0..MOST_ROUNDS {
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
        let all = problem.residual_count() as f64;
        // Each residual has lost the same part of a degree of freedom to the variables.
        let left = (1.0 - best.point.len() as f64 / all).max(1.0 / all);
        // Numbers of a display have errors of about a tenth of these: an exact simulation can be fitted, too.
        const LEAST: CommonDeviations = CommonDeviations { fraction: 1e-6, lab: 1e-4 };
        let of = |unit: Unit, now: f64, least: f64| {
            let pairs = self.model.observations.iter().zip(&best.residuals);
            let unstated: Vec<f64> = pairs
                .filter(|(one, _)| one.standard_deviation.is_none() && one.unit() == unit)
                .map(|(_, residual)| residual * residual)
                .collect();
            match unstated.len() {
                0 => now,
                count => (now * (unstated.iter().sum::<f64>() / (count as f64 * left)).sqrt()).max(least),
            }
        };
        CommonDeviations {
            fraction: of(Unit::Fraction, problem.common.fraction, LEAST.fraction),
            lab: of(Unit::Lab, problem.common.lab, LEAST.lab),
        }
    }

    fn has_unstated(&self, unit: Unit) -> bool {
        self.model.observations.iter().any(|one| one.standard_deviation.is_none() && one.unit() == unit)
    }

    fn degrees_of_freedom(&self) -> i64 {
        let priors = self.spec.variables.iter().filter(|one| one.prior.is_some()).count();
        (self.model.observations.len() + priors) as i64 - self.spec.variables.len() as i64
    }

    /// Intervals of all determined variables, `[variable][probability][side]`.
    fn intervals(
        &self,
        best: &Minimum,
        common: CommonDeviations,
        threads: usize,
        progress: &FitProgress<'_>,
    ) -> Result<Intervals, DesignError> {
        let Determined { undetermined, covariance } = determined(&best.jacobian);
        let n = best.point.len();
        let is_estimated = self.has_unstated(Unit::Fraction) || self.has_unstated(Unit::Lab);
        let freedom = self.degrees_of_freedom().max(3) as f64;
        let quantiles = QUANTILES.map(|z| if is_estimated { student(z, freedom) } else { z });
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
                ends_of(problem, best, (variable, side), (quantiles, deviation))
            },
        )?;
        let mut ends = vec![None; n];
        for ((variable, side), both) in tasks.into_iter().zip(found) {
            for (probability, end) in both.into_iter().enumerate() {
                match end {
                    End::Better(point) => return Ok(Intervals::Better(point)),
                    End::At(u) => {
                        let interval = ends[variable].get_or_insert([[0.0; 2]; 2]);
                        interval[probability][usize::from(side > 0.0)] = u;
                    }
                }
            }
        }
        let spanning: Vec<usize> =
            (0..n).filter(|k| ends[*k].is_some_and(|ends: [[f64; 2]; 2]| ends[1] == [0.0, 1.0])).collect();
        spanning.iter().for_each(|k| ends[*k] = None);
        Ok(Intervals::Found { ends, undetermined: with_spanning(undetermined, &spanning, &covariance) })
    }

    fn report(
        &self,
        best: &Minimum,
        common: CommonDeviations,
        starts: Starts,
        (ends, undetermined): (&[Ends], &[Vec<usize>]),
    ) -> Result<FitReport, DesignError> {
        let (variables, n) = (&self.spec.variables, best.point.len());
        let covariance = determined(&best.jacobian).covariance;
        let fitted = values(variables, &best.point);
        let error = |k: usize| covariance[k * n + k].sqrt();
        let variable = |(k, one): (usize, &FitVariable)| {
            let [from, to] = one.bounds;
            let at = |u: f64| from + u * (to - from);
            let is_known = ends[k].is_some();
            FittedVariable {
                key: one.name.clone(),
                keys: one.paths().map(str::to_owned).collect(),
                compensated_by: one.compensated_by().map(str::to_owned),
                value: is_known.then_some(fitted[k]),
                best: fitted[k],
                standard_error: is_known.then(|| error(k) * (to - from)),
                interval_68: ends[k].map(|ends| ends[0].map(at)),
                interval_95: ends[k].map(|ends| ends[1].map(at)),
                at_bound: best.point[k] <= AT_BOUND || best.point[k] >= 1.0 - AT_BOUND,
                bounds: one.bounds,
                start: one.own,
                prior: one.prior,
            }
        };
        let correlation = |i: usize, k: usize| {
            let known = ends[i].is_some() && ends[k].is_some();
            known.then(|| (covariance[i * n + k] / (error(i) * error(k))).clamp(-1.0, 1.0))
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
        let mut notes = self.model.notes.clone();
        notes.extend(self.remarks(best.chi_square, &runs, starts));
        Ok(FitReport {
            title: self.spec.title.clone(),
            hash: self.hash.clone(),
            variables: variables.iter().enumerate().map(variable).collect(),
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
            notes,
            residuals,
        })
    }

    /// Bayesian information criterion; a standard deviation from the residuals is one more variable.
    fn bic(&self, best: &Minimum, common: CommonDeviations) -> f64 {
        let units = [(Unit::Fraction, common.fraction), (Unit::Lab, common.lab)];
        let mut logarithms = 0.0;
        let mut variables = best.point.len();
        for (unit, deviation) in units.into_iter().filter(|(unit, _)| self.has_unstated(*unit)) {
            let all = self.model.observations.iter();
            let count = all.filter(|one| one.standard_deviation.is_none() && one.unit() == unit).count();
            logarithms += 2.0 * count as f64 * deviation.ln();
            variables += 1;
        }
        best.chi_square + logarithms + variables as f64 * (self.model.observations.len() as f64).ln()
    }

    /// Remark on a chi-square far above its degrees of freedom, where all standard deviations are stated.
    fn misfit(&self, chi_square: f64) -> Option<String> {
        let freedom = self.degrees_of_freedom();
        let [all, most] = [freedom as f64, freedom as f64 + FAR_ABOVE * (2.0 * freedom as f64).sqrt()];
        let is_stated = !self.has_unstated(Unit::Fraction) && !self.has_unstated(Unit::Lab);
        (is_stated && freedom > 0 && chi_square > most && chi_square > TIMES * all).then(|| {
            format!(
                "chi-square, {chi_square:.0}, is far above {freedom} degrees of freedom: the model does not describe the data within the \
                 stated standard deviations, and the intervals are too narrow"
            )
        })
    }

    /// Remarks on the result.
    fn remarks(&self, chi_square: f64, runs: &Option<super::Runs>, starts: Starts) -> Vec<String> {
        let is_small = chi_square < SMALL * self.degrees_of_freedom().max(1) as f64;
        let systematic = runs.filter(|runs| runs.z < FEW_RUNS && !is_small).map(|runs| {
            format!(
                "the residuals have {} runs of one sign, independent errors have {:.0} (z = {:.1}): the model or the measurement differs \
                 systematically, and the intervals are too narrow",
                runs.count, runs.expected, runs.z
            )
        });
        let lonely = (starts.best == 1 && starts.count > 2).then(|| {
            format!(
                "only one of {} starts has found this minimum: use more starts (fit.starts) or narrower bounds",
                starts.count
            )
        });
        let outside = self.spec.variables.iter().filter_map(|one| {
            let own = one.own.filter(|own| !(one.bounds[0]..=one.bounds[1]).contains(own))?;
            Some(format!("{}: the scenario's own value, {own}, is outside the bounds", one.name))
        });
        outside.chain(self.misfit(chi_square)).chain(systematic).chain(lonely).collect()
    }
}

/// Ends of the intervals of a variable, `[probability][side]`, in the unit cube; `None` if the data do not
/// determine it.
type Ends = Option<[[f64; 2]; 2]>;

/// Ends of intervals, in the unit cube, of the variables that the data determine; or a better minimum.
enum Intervals {
    /// With the groups of variables that the data do not determine.
    Found {
        ends: Vec<Ends>,
        undetermined: Vec<Vec<usize>>,
    },
    Better(Vec<f64>),
}

fn in_bounds(variable: &FitVariable, value: f64) -> f64 {
    let [from, to] = variable.bounds;
    ((value - from) / (to - from)).clamp(0.0, 1.0)
}

/// Study of the variables of the display.
fn study(spec: &Fit, quantities: Vec<NamedQuantity>) -> Study {
    let variable = |one: &FitVariable| match &one.target {
        FitTarget::Keys(keys) => {
            Some(Variable { name: one.name.clone(), keys: keys.clone(), values: Values::Number })
        }
        FitTarget::WavelengthOffset | FitTarget::Scale => None,
    };
    Study {
        conditions: vec![Condition { name: String::new(), varied: spec.varied.clone() }],
        variables: spec.variables.iter().filter_map(variable).collect(),
        quantities,
    }
}
