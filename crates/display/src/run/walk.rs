//! Runs by the Monte Carlo solver: rounds of paths on all threads until the target is met.
//!
//! Each view has [`REPLICATES`] replicates with independent random numbers. A round adds the
//! same number of paths to each replicate. Replicates do not share sums, so that the result does not
//! depend on the assignment of work to threads. Views are computed one after another, so that the sums of
//! only one view are in memory.

use papilio_sampling::SampleStream;
use papilio_transport::walk::{Replicate, Walk};
use rayon::prelude::*;

use super::rounds::paths_for_a_tenth;
use super::{Progress, REPLICATES, Run};
use crate::DisplayError;
use crate::meter::{Sample, ViewSamples};
use crate::result::{RunResult, SolverReport, TargetReport};
use crate::scene::{Solver, Stop, Strategy};
use crate::setup::ViewPoint;

/// Paths of each replicate in the first round; each further round doubles the total. With guiding, fewer
/// paths contain the same information.
const FIRST_ROUND: u64 = 64;
const FIRST_GUIDED_ROUND: u64 = 16;

/// Largest number of paths that a round adds to a replicate, which limits the time between progress reports.
const LARGEST_ROUND: u64 = 1 << 14;

/// Number of paths after the last round over that for which the error is expected to meet the target.
const LAST_ROUND: f64 = 1.15;

/// A change of Y by more than this many standard errors in a round contradicts the standard error.
const UNEXPECTED: f64 = 4.0;

/// Largest number of paths of a view; a target that is not reached with them is missed.
const MOST_PATHS: u64 = 1 << 31;

/// Number of paths of a view after the first round.
pub(super) const FIRST_PATHS: u64 = FIRST_ROUND * REPLICATES;

/// Standard error of a view after its first round.
pub(super) struct Pilot {
    pub(super) paths: u64,
    /// Largest relative standard error of Y, and of wavelengths if the target applies to them.
    pub(super) relative_error: f64,
    /// Smallest number of paths of a reliable standard error.
    pub(super) least: u64,
}

/// Traces the first round of a view.
pub(super) fn pilot(run: &Run<'_>, view: usize) -> Result<Pilot, DisplayError> {
    let runner = Runner { run };
    let mut work = runner.start(view, run.setup.views.get(view).ok_or(DisplayError::Interrupted)?);
    if !runner.round(&mut work) {
        return Err(DisplayError::Interrupted);
    }
    Ok(Pilot { paths: work.paths, relative_error: work.relative_error, least: work.confidence.least })
}

/// Runs a scene on the threads of the current pool.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    Runner { run }.run()
}

/// Returns the number of paths that the next round adds to each replicate, which has `so_far`.
pub(super) fn round_size(solver: &Solver, so_far: u64) -> u64 {
    let first = if solver.scattering == Strategy::Guided { FIRST_GUIDED_ROUND } else { FIRST_ROUND };
    let double = so_far.clamp(first, LARGEST_ROUND);
    match solver.stop {
        Stop::Paths(paths) => double.min(paths.div_ceil(REPLICATES) - so_far),
        Stop::RelativeError { .. } | Stop::Target(_) => double,
    }
}

/// Check of whether the spread of a view's replicates is a reliable standard error.
///
/// All replicates may miss light that few paths meet; their spread then does not include it. A view therefore
/// needs a number of paths that is given by the least probable event of the solver, and a further round must
/// confirm the result of an earlier one within its errors.
pub(super) struct Confidence {
    /// Smallest number of paths.
    least: u64,
    /// False if the estimate has no noise.
    is_random: bool,
    /// Y of each state after the last round, and its standard error.
    before: Vec<(f64, f64)>,
    confirmed: bool,
}

impl Confidence {
    pub(super) fn new(walk: &Walk<'_>) -> Self {
        let rarest = walk.rarest();
        // Each replicate is expected to meet the least probable event once.
        let least = ((REPLICATES as f64 / rarest).ceil() as u64).min(MOST_PATHS);
        Self { least, is_random: rarest < 1.0, before: Vec::new(), confirmed: false }
    }

    /// Confidence for rounds that trace all paths again: two successive rounds must agree.
    pub(super) fn of_two_rounds() -> Self {
        Self { least: 0, is_random: true, before: Vec::new(), confirmed: false }
    }

    /// Adds the Y of each state after a round, with their standard errors.
    pub(super) fn add(&mut self, now: Vec<(f64, f64)>) {
        let expected = |((now, _), (before, error)): (&(f64, f64), &(f64, f64))| {
            (now - before).abs() <= UNEXPECTED * error + 1e-12 * before.abs()
        };
        self.confirmed = !self.before.is_empty() && now.iter().zip(&self.before).all(expected);
        self.before = now;
    }

    /// Returns true if this number of paths, and their results, suffice to stop.
    pub(super) fn holds(&self, paths: u64) -> bool {
        paths >= self.least && (self.confirmed || !self.is_random)
    }

    /// Returns the smallest relative standard error of a view with this number of paths: an event that none
    /// of n paths has met may have a probability of 1/n.
    fn least_error(&self, paths: u64) -> f64 {
        if paths < self.least { 1.0 / paths as f64 } else { 0.0 }
    }
}

struct Runner<'a> {
    run: &'a Run<'a>,
}

/// State of the computation of one view.
struct Work<'a> {
    walk: Walk<'a>,
    /// Number of the view, from 0.
    number: usize,
    replicates: Vec<Replicate>,
    /// Samples after the last complete round.
    samples: Vec<Sample>,
    paths: u64,
    confidence: Confidence,
    relative_error: f64,
    /// Number of paths and ratio of error to tolerance of a target after each round; the ratio is infinite if
    /// the metric is not defined.
    missed: Vec<(u64, f64)>,
}

impl Work<'_> {
    /// Returns the last ratio of error to tolerance of a target.
    fn missed_by(&self) -> f64 {
        self.missed.last().map_or(f64::INFINITY, |last| last.1)
    }
}

/// Results of the completed views.
#[derive(Default)]
struct Done {
    views: Vec<ViewSamples>,
    paths: u64,
    relative_error: f64,
    missed: f64,
    paths_for_a_tenth: [f64; 2],
    /// Smallest number of paths of views with too few, and the largest number that was needed.
    too_few: Option<(u64, u64)>,
}

impl<'a> Runner<'a> {
    fn run(&self) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut done = Done::default();
        let mut interrupted = false;
        for (number, at) in self.run.setup.views.iter().enumerate() {
            let mut work = self.start(number, at);
            interrupted = !self.refine(&mut work, at, &specular, &done);
            if !work.samples.is_empty() {
                if !work.samples.iter().all(Sample::is_finite) {
                    return Err(DisplayError::NotFinite);
                }
                done.views.push(self.view(&work, at, &specular));
                if work.paths < work.confidence.least {
                    let (paths, least) = done.too_few.unwrap_or((work.paths, 0));
                    done.too_few = Some((paths.min(work.paths), least.max(work.confidence.least)));
                }
                done.paths += work.paths;
                done.relative_error = done.relative_error.max(work.relative_error);
                done.missed = done.missed.max(work.missed_by());
                let more = paths_for_a_tenth(&work.missed, work.paths);
                done.paths_for_a_tenth.iter_mut().zip(more).for_each(|(sum, paths)| *sum += paths);
            }
            if interrupted {
                break;
            }
        }
        if done.views.is_empty() {
            Err(DisplayError::Interrupted)
        } else {
            Ok(self.result(done, &specular, interrupted))
        }
    }

    fn start(&self, number: usize, at: &'a ViewPoint) -> Work<'a> {
        let walk = self.run.setup.walk(at, self.run.scene.solver.scattering);
        let replicates = (0..REPLICATES).map(|_| walk.replicate()).collect();
        Work {
            confidence: Confidence::new(&walk),
            walk,
            number,
            replicates,
            samples: Vec::new(),
            paths: 0,
            relative_error: f64::INFINITY,
            missed: Vec::new(),
        }
    }

    /// Adds rounds to a view until the stopping criterion is met; returns false if it was stopped before.
    fn refine(&self, work: &mut Work<'_>, at: &ViewPoint, specular: &[Vec<f64>], done: &Done) -> bool {
        while !self.is_enough(work) {
            if !self.round(work) {
                return false;
            }
            if let Stop::Target(target) = &self.run.scene.solver.stop {
                let view = self.view(work, at, specular).view;
                work.missed.push((work.paths, target.missed_by(&view).unwrap_or(f64::INFINITY)));
            }
            let so_far = || (work.number, self.view(work, at, specular).view);
            (self.run.control.progress)(Progress { so_far: Some(&so_far), ..self.progress(work, done) });
        }
        true
    }

    fn view(&self, work: &Work<'_>, at: &ViewPoint, specular: &[Vec<f64>]) -> ViewSamples {
        let least = work.confidence.least_error(work.paths);
        self.run.meter.view_of_replicates(at, &work.samples, least, specular)
    }

    /// Adds a round; returns false if it was stopped, in which case the round is discarded.
    fn round(&self, work: &mut Work<'_>) -> bool {
        let each = self.next_round(work);
        let (walk, number) = (&work.walk, work.number);
        let traced: Option<()> = work
            .replicates
            .par_iter_mut()
            .enumerate()
            .map(|(replicate, state)| {
                let stream = number as u64 * REPLICATES + replicate as u64;
                let numbers =
                    SampleStream::new(self.run.scene.solver.sampler, self.run.scene.solver.seed, stream);
                self.trace(walk, state, &numbers, each)
            })
            .collect();
        if traced.is_none() {
            return false;
        }
        let estimates = walk.estimates(&work.replicates);
        let samples: Vec<Sample> =
            estimates.par_iter().map(|estimate| self.run.meter.sample(estimate)).collect();
        let per_wavelength =
            matches!(self.run.scene.solver.stop, Stop::RelativeError { per_wavelength: true, .. });
        work.relative_error = self.run.meter.standard_error(&samples, per_wavelength);
        work.confidence.add(self.run.meter.luminous_means(&samples));
        work.samples = samples;
        work.paths += each * REPLICATES;
        work.relative_error = work.relative_error.max(work.confidence.least_error(work.paths));
        true
    }

    /// Returns the number of paths that the next round adds to each replicate.
    fn next_round(&self, work: &Work<'_>) -> u64 {
        let so_far = work.paths / REPLICATES;
        let double = round_size(&self.run.scene.solver, so_far);
        if work.walk.prefers_powers_of_two() || so_far < 4 * FIRST_ROUND {
            return double;
        }
        let ratio = match &self.run.scene.solver.stop {
            Stop::Paths(_) => return double,
            Stop::RelativeError { target, .. } => work.relative_error / target,
            Stop::Target(_) => work.missed_by(),
        };
        // The error falls with the root of the number of paths. A larger step than needed costs less than
        // another round.
        let more = so_far as f64 * (LAST_ROUND * ratio * ratio - 1.0);
        let quarter = so_far / 4;
        if more.is_finite() { double.min((more as u64 / quarter + 1) * quarter) } else { double }
    }

    /// Traces paths in small pieces, so that a stop takes effect at once.
    fn trace(
        &self,
        walk: &Walk<'_>,
        replicate: &mut Replicate,
        numbers: &SampleStream,
        count: u64,
    ) -> Option<()> {
        let mut left = count;
        while left > 0 {
            if self.run.control.stopped() {
                return None;
            }
            let piece = left.min(walk.batch().max(1024));
            walk.trace(replicate, numbers, piece);
            left -= piece;
        }
        Some(())
    }

    fn is_enough(&self, work: &Work<'_>) -> bool {
        match self.run.scene.solver.stop {
            Stop::Paths(paths) => work.paths >= paths,
            Stop::RelativeError { target, .. } => {
                work.paths >= MOST_PATHS
                    || (work.relative_error <= target && work.confidence.holds(work.paths))
            }
            // More paths do not make a metric defined.
            Stop::Target(_) if work.missed_by().is_infinite() => work.paths > 0,
            Stop::Target(_) => {
                work.paths >= MOST_PATHS || (work.missed_by() <= 1.0 && work.confidence.holds(work.paths))
            }
        }
    }

    fn progress(&self, work: &Work<'_>, done: &Done) -> Progress<'static> {
        let is_enough = self.is_enough(work);
        let (share_of_view, target) = match self.run.scene.solver.stop {
            Stop::Paths(paths) => (Some((work.paths as f64 / paths as f64).min(1.0)), None),
            // The error falls with the root of the number of paths.
            Stop::RelativeError { target, .. } => {
                (Some((target / work.relative_error).powi(2).min(1.0)), Some(target))
            }
            // Estimated from the ratio of tolerance to error.
            Stop::Target(_) => (Some((1.0 / work.missed_by()).powi(2).min(1.0)), None),
        };
        let views = done.views.len() + usize::from(is_enough);
        // A view that has met its target may need further paths.
        let share_of_view = share_of_view.filter(|_| !is_enough).map(|share| share.min(0.99));
        Progress {
            paths: Some(done.paths + work.paths),
            share_of_view: share_of_view.or(Some(0.0)),
            relative_error: Some(work.relative_error),
            target,
            ..Progress::of_views(views, self.run.setup.views.len())
        }
    }

    fn result(&self, done: Done, specular: &[Vec<f64>], interrupted: bool) -> RunResult {
        let solver = SolverReport {
            method: "monte-carlo".to_owned(),
            chosen_because: None,
            paths: Some(done.paths),
            nodes: None,
            degrees_of_freedom: REPLICATES - 1,
            relative_error_reached: done.relative_error,
            target: matches!(self.run.scene.solver.stop, Stop::Target(_)).then_some(TargetReport {
                error_over_tolerance: Some(done.missed).filter(|missed| missed.is_finite()),
                paths_for_a_tenth: done.paths_for_a_tenth,
            }),
            is_final: true,
            interrupted,
        };
        let unreached = format!("that would take more than {MOST_PATHS} paths");
        let mut result = self.run.result(done.views, solver, specular, &unreached);
        if let Some((paths, least)) = done.too_few {
            result.warnings.push(format!(
                "{paths} paths per view are too few: some light of this scene is met by only one path in {}, and all \
                 replicates may miss it (expected at least {least} paths); standard errors are set to at \
                 least 1/{paths} of each value",
                least.div_ceil(REPLICATES)
            ));
        }
        result
    }
}
