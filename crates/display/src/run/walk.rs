//! Runs by the Monte Carlo solver: rounds of paths on all threads until the target is met.
//!
//! Each view has [`REPLICATES`] replicates with independent random numbers. A round adds the
//! same number of paths to each replicate. Replicates do not share sums, so that the result does not
//! depend on the assignment of work to threads. Views are computed one after another, so that the sums of
//! only one view are in memory.

use papilio_sampling::SampleStream;
use papilio_transport::Top;
use papilio_transport::walk::{Replicate, Walk};
use rayon::prelude::*;

use super::rounds::{Confidence, Round, Rounds, meet, missed, paths_for_a_tenth};
use super::{Accuracy, Progress, REPLICATES, Run};
use crate::DisplayError;
use crate::meter::{LeastErrors, Sample, ViewSamples};
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

/// Largest number of paths of a view; a target that is not reached with them is missed.
pub(super) const MOST_PATHS: u64 = 1 << 31;

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
    let at = run.setup.views.get(view).ok_or(DisplayError::Interrupted)?;
    let mut work = Work::new(run, (view, at), &[], 0);
    work.round(work.next(0, f64::INFINITY))?;
    Ok(Pilot { paths: work.paths, relative_error: work.relative_error, least: work.least })
}

/// Returns the solver of a run by paths: a first answer has those of the first round, if the scene demands more.
pub(super) fn solver_of(run: &Run<'_>) -> Solver {
    let mut solver = run.solver.clone();
    let is_of_few = matches!(solver.stop, Stop::Paths(paths) if paths <= FIRST_PATHS);
    if run.accuracy == Accuracy::First && !is_of_few {
        solver.stop = Stop::Paths(FIRST_PATHS);
    }
    solver
}

/// Runs a scene on the threads of the current pool.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    let specular = run.specular();
    let mut done = Done::default();
    let mut interrupted = false;
    for view in run.setup.views.iter().enumerate() {
        let mut work = Work::new(run, view, &specular, done.paths);
        let confidence = Confidence::in_walk(&work.walk, work.least);
        interrupted = match meet(&run.solver.stop, MOST_PATHS, confidence, &mut work) {
            Ok(_) => false,
            Err(DisplayError::Interrupted) => true,
            Err(error) => return Err(error),
        };
        if !work.samples.is_empty() {
            done.add(&work)?;
        }
        if interrupted {
            break;
        }
    }
    if done.views.is_empty() {
        Err(DisplayError::Interrupted)
    } else {
        Ok(done.result(run, &specular, interrupted))
    }
}

/// Returns the number of all paths of a view after its next round; `missed` is the error over the target after
/// `paths` of them.
pub(super) fn paths_after_next(solver: &Solver, walk: &Walk<'_>, paths: u64, missed: f64) -> u64 {
    let so_far = paths / REPLICATES;
    let double = round_size(solver, so_far);
    // The error falls with the root of the number of paths. A larger step than needed costs less than
    // another round.
    let more = so_far as f64 * (LAST_ROUND * missed * missed - 1.0);
    let quarter = so_far / 4;
    let is_free =
        matches!(solver.stop, Stop::Paths(_)) || walk.prefers_powers_of_two() || so_far < 4 * FIRST_ROUND;
    let each =
        if is_free || !more.is_finite() { double } else { double.min((more as u64 / quarter + 1) * quarter) };
    paths + each * REPLICATES
}

/// Returns the number of paths that the next round adds to each replicate, which has `so_far`.
fn round_size(solver: &Solver, so_far: u64) -> u64 {
    let first = if solver.scattering == Strategy::Guided { FIRST_GUIDED_ROUND } else { FIRST_ROUND };
    let double = so_far.clamp(first, LARGEST_ROUND);
    match solver.stop {
        Stop::Paths(paths) => double.min(paths.div_ceil(REPLICATES) - so_far),
        Stop::RelativeError { .. } | Stop::Target(_) => double,
    }
}

/// Returns the smallest number of paths of a reliable standard error: each replicate is expected to meet the
/// least probable event once.
pub(super) fn least_paths(walk: &Walk<'_>) -> u64 {
    ((REPLICATES as f64 / walk.rarest()).ceil() as u64).min(MOST_PATHS)
}

/// Computation of one view.
struct Work<'a> {
    run: &'a Run<'a>,
    /// Number of the view, from 0.
    number: usize,
    at: &'a ViewPoint,
    specular: &'a [Vec<f64>],
    /// Paths of the views before.
    paths_before: u64,
    walk: Walk<'a>,
    /// Smallest number of paths of a reliable standard error.
    least: u64,
    replicates: Vec<Replicate>,
    /// Samples after the last complete round.
    samples: Vec<Sample>,
    paths: u64,
    relative_error: f64,
    /// Number of paths and ratio of error to tolerance of a target after each round; the ratio is infinite if
    /// the metric is not defined.
    missed: Vec<(u64, f64)>,
}

impl<'a> Work<'a> {
    fn new(
        run: &'a Run<'a>,
        (number, at): (usize, &'a ViewPoint),
        specular: &'a [Vec<f64>],
        paths_before: u64,
    ) -> Self {
        let walk = run.setup.walk(at, run.scene.solver.scattering);
        Self {
            run,
            number,
            at,
            specular,
            paths_before,
            least: least_paths(&walk),
            replicates: (0..REPLICATES).map(|_| walk.replicate()).collect(),
            walk,
            samples: Vec::new(),
            paths: 0,
            relative_error: f64::INFINITY,
            missed: Vec::new(),
        }
    }

    /// Returns the last ratio of error to tolerance of a target.
    fn missed_by(&self) -> f64 {
        self.missed.last().map_or(f64::INFINITY, |last| last.1)
    }

    /// Returns the smallest relative standard error: an event that none of n paths has met may have a
    /// probability of 1/n.
    fn least_error(&self) -> f64 {
        if self.paths < self.least { 1.0 / self.paths as f64 } else { 0.0 }
    }

    /// Returns the smallest standard errors; without a scatterer, the balance is a smooth sum over directions.
    fn least_errors(&self) -> LeastErrors {
        let stack = &self.run.setup.stack;
        let scatters = match stack.panel() {
            Some(panel) => matches!(panel.top, Top::Diffuser(_)),
            None => self.walk.rarest() < 1.0,
        };
        LeastErrors {
            relative: self.least_error(),
            paths: if scatters { self.paths } else { 0 },
            is_below_slabs: self.run.thick_slabs().is_some(),
        }
    }

    fn view(&self) -> ViewSamples {
        self.run.meter.view_of_replicates(self.at, &self.samples, self.least_errors(), self.specular)
    }

    /// Traces paths in small pieces, so that a stop takes effect at once.
    fn trace(
        &self,
        replicate: &mut Replicate,
        numbers: &SampleStream,
        count: u64,
    ) -> Result<(), DisplayError> {
        let mut left = count;
        while left > 0 {
            self.run.control.check()?;
            let piece = left.min(self.walk.batch().max(1024));
            self.walk.trace(replicate, numbers, piece);
            left -= piece;
        }
        Ok(())
    }
}

impl Rounds for Work<'_> {
    type Found = ();

    fn next(&self, paths: u64, missed: f64) -> u64 {
        paths_after_next(self.run.solver, &self.walk, paths, missed)
    }

    /// Adds a round; one that is stopped is discarded.
    fn round(&mut self, paths: u64) -> Result<Round<()>, DisplayError> {
        let solver = self.run.solver;
        let each = (paths - self.paths) / REPLICATES;
        let mut replicates = std::mem::take(&mut self.replicates);
        let traced: Result<(), DisplayError> = replicates
            .par_iter_mut()
            .enumerate()
            .map(|(replicate, state)| {
                let stream = self.number as u64 * REPLICATES + replicate as u64;
                self.trace(state, &SampleStream::new(solver.sampler, solver.seed, stream), each)
            })
            .collect();
        traced?;
        let estimates = self.walk.estimates(&replicates);
        self.replicates = replicates;
        let meter = self.run.meter;
        self.samples = estimates.par_iter().map(|estimate| meter.sample(estimate)).collect();
        self.paths = paths;
        let per_wavelength = matches!(solver.stop, Stop::RelativeError { per_wavelength: true, .. });
        self.relative_error = meter.standard_error(&self.samples, per_wavelength).max(self.least_error());
        let missed = match &solver.stop {
            Stop::Target(target) => target.missed_by(&self.view().view).unwrap_or(f64::INFINITY),
            stop => missed(stop, self.relative_error)?,
        };
        if matches!(solver.stop, Stop::Target(_)) {
            self.missed.push((paths, missed));
        }
        Ok(Round { found: (), missed, means: meter.luminous_means(&self.samples) })
    }

    fn report(&self, is_last: bool) {
        let (share, target) = match self.run.solver.stop {
            Stop::Paths(paths) => ((self.paths as f64 / paths as f64).min(1.0), None),
            // The error falls with the root of the number of paths.
            Stop::RelativeError { target, .. } => {
                ((target / self.relative_error).powi(2).min(1.0), Some(target))
            }
            // Estimated from the ratio of tolerance to error.
            Stop::Target(_) => ((1.0 / self.missed_by()).powi(2).min(1.0), None),
        };
        let so_far = || (self.number, self.view().view);
        (self.run.control.progress)(Progress {
            paths: Some(self.paths_before + self.paths),
            // A view that has met its target may need further paths.
            share_of_view: Some(if is_last { 0.0 } else { share.min(0.99) }),
            relative_error: Some(self.relative_error),
            target,
            so_far: Some(&so_far),
            ..Progress::of_views(self.number + usize::from(is_last), self.run.setup.views.len())
        });
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

impl Done {
    fn add(&mut self, work: &Work<'_>) -> Result<(), DisplayError> {
        if !work.samples.iter().all(Sample::is_finite) {
            return Err(DisplayError::NotFinite);
        }
        self.views.push(work.view());
        if work.paths < work.least {
            let (paths, least) = self.too_few.unwrap_or((work.paths, 0));
            self.too_few = Some((paths.min(work.paths), least.max(work.least)));
        }
        self.paths += work.paths;
        self.relative_error = self.relative_error.max(work.relative_error);
        self.missed = self.missed.max(work.missed_by());
        let more = paths_for_a_tenth(&work.missed, work.paths);
        self.paths_for_a_tenth.iter_mut().zip(more).for_each(|(sum, paths)| *sum += paths);
        Ok(())
    }

    fn result(self, run: &Run<'_>, specular: &[Vec<f64>], interrupted: bool) -> RunResult {
        let solver = SolverReport {
            method: "monte-carlo".to_owned(),
            chosen_because: None,
            paths: Some(self.paths),
            nodes: None,
            level: None,
            degrees_of_freedom: REPLICATES - 1,
            relative_error_reached: self.relative_error,
            target: matches!(run.solver.stop, Stop::Target(_)).then_some(TargetReport {
                error_over_tolerance: Some(self.missed).filter(|missed| missed.is_finite()),
                paths_for_a_tenth: self.paths_for_a_tenth,
            }),
            is_final: run.is_final(),
            interrupted,
        };
        let unreached = format!("that would take more than {MOST_PATHS} paths");
        let mut result = run.result(self.views, solver, specular, &unreached);
        if let Some((paths, least)) = self.too_few.filter(|_| run.is_final()) {
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
