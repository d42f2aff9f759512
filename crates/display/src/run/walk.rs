//! The walk: rounds of paths on all threads until the numbers are good enough.
//!
//! Each view has [`REPLICATES`] replicates with numbers of their own. A round adds the
//! same number of paths to each; replicates never share sums, so the result does not
//! depend on which thread ran what. Views are computed one after the other: the sums of
//! one are in memory.

use papilio_sampling::Numbers;
use papilio_transport::walk::{Replicate, Walk};
use rayon::prelude::*;

use super::{Progress, Run};
use crate::DisplayError;
use crate::meter::{ViewSamples, Sample};
use crate::result::{RunResult, SolverReport, TargetReport};
use crate::scene::{Solver, Stop, Strategy};
use crate::setup::ViewPoint;

/// Independent replicates of each view; standard errors have one degree of freedom less.
pub(super) const REPLICATES: u64 = 32;

/// Paths of each replicate in the first round; rounds double the total from there. A guided path knows
/// as much as several.
const FIRST_ROUND: u64 = 64;
const FIRST_GUIDED_ROUND: u64 = 16;

/// The most paths that a round adds to a replicate: how finely progress shows.
const LARGEST_ROUND: u64 = 1 << 14;

/// A round that changes a Y by more than so many of its standard errors was not expected by them.
const UNEXPECTED: f64 = 4.0;

/// A target that is not reached with this many paths of a view is given up.
const MOST_PATHS: u64 = 1 << 31;

/// Runs a scene, on the threads of the pool that this is called in.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    Runner { run }.run()
}

/// Paths that the next round adds to each replicate that has `so_far`.
pub(super) fn round_size(solver: &Solver, so_far: u64) -> u64 {
    let first = if solver.scattering == Strategy::Guided { FIRST_GUIDED_ROUND } else { FIRST_ROUND };
    let double = so_far.clamp(first, LARGEST_ROUND);
    match solver.stop {
        Stop::Paths(paths) => double.min(paths.div_ceil(REPLICATES) - so_far),
        Stop::RelativeError { .. } | Stop::Target(_) => double,
    }
}

/// Whether the spread of a view's replicates can be believed.
///
/// Light that few paths meet may be missed by every replicate; their spread then says nothing of it. So
/// there are as many paths as what is least probable in the walk asks for, and a further round has to
/// confirm what an earlier one said, to within its errors.
pub(super) struct Confidence {
    least: u64,
    something_random: bool,
    /// Y of every state after the last round, and its standard error.
    before: Vec<(f64, f64)>,
    confirmed: bool,
}

impl Confidence {
    pub(super) fn new(walk: &Walk<'_>) -> Self {
        let rarest = walk.rarest();
        // Each replicate should have met it.
        let least = ((REPLICATES as f64 / rarest).ceil() as u64).min(MOST_PATHS);
        Self { least, something_random: rarest < 1.0, before: Vec::new(), confirmed: false }
    }

    /// Takes note of a round's Y of every state and their standard errors.
    pub(super) fn add(&mut self, now: Vec<(f64, f64)>) {
        let expected = |((now, _), (before, error)): (&(f64, f64), &(f64, f64))| {
            (now - before).abs() <= UNEXPECTED * error + 1e-12 * before.abs()
        };
        self.confirmed = !self.before.is_empty() && now.iter().zip(&self.before).all(expected);
        self.before = now;
    }

    /// True if so many paths, and what they found, suffice for a stop.
    pub(super) fn holds(&self, paths: u64) -> bool {
        paths >= self.least && (self.confirmed || !self.something_random)
    }

    /// The least relative standard error that a view of so many paths may claim: what none of n paths has met may
    /// have a probability of 1/n.
    fn least_error(&self, paths: u64) -> f64 {
        if paths < self.least { 1.0 / paths as f64 } else { 0.0 }
    }
}

struct Runner<'a> {
    run: &'a Run<'a>,
}

/// A view in work.
struct Work<'a> {
    walk: Walk<'a>,
    /// Its number, from 0.
    number: usize,
    replicates: Vec<Replicate>,
    /// After the last whole round.
    samples: Vec<Sample>,
    paths: u64,
    confidence: Confidence,
    relative_error: f64,
    /// Of a target, after each round: paths, and the error over the tolerance; infinite if there is no
    /// such metric.
    missed: Vec<(u64, f64)>,
}

impl Work<'_> {
    /// The error over the tolerance of a target.
    fn missed_by(&self) -> f64 {
        self.missed.last().map_or(f64::INFINITY, |last| last.1)
    }

    /// Paths that a tenth of a target's error would take: as it fell with paths, by least squares over the
    /// logarithms, and at the worst.
    fn paths_for_a_tenth(&self) -> [f64; 2] {
        let logs = self.missed.iter().filter(|(_, missed)| *missed > 0.0 && missed.is_finite());
        let logs: Vec<(f64, f64)> = logs.map(|(paths, missed)| ((*paths as f64).ln(), missed.ln())).collect();
        let n = logs.len().max(1) as f64;
        let (x, y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
        let xx: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let xy: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        // Few rounds know little: slopes that no method has are not believed.
        let power = if xx > 0.0 { (-xy / xx).clamp(0.5, 1.5) } else { 0.5 };
        [10.0_f64.powf(1.0 / power), 100.0].map(|times| times * self.paths as f64)
    }
}

/// What has been seen so far.
#[derive(Default)]
struct Done {
    views: Vec<ViewSamples>,
    paths: u64,
    relative_error: f64,
    missed: f64,
    paths_for_a_tenth: [f64; 2],
    /// The least paths of a view that had fewer than it should, and what it should have had.
    too_few: Option<(u64, u64)>,
}

impl<'a> Runner<'a> {
    fn run(&self) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut done = Done::default();
        let mut interrupted = false;
        // One view after the other: only one view's sums are in memory.
        for (number, at) in self.run.setup.views.iter().enumerate() {
            let mut work = self.start(number, at);
            interrupted = !self.look(&mut work, at, &specular, &done);
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
                let more = work.paths_for_a_tenth();
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

    /// Adds rounds to a view until it is good enough; false if it was stopped before.
    fn look(&self, work: &mut Work<'_>, at: &ViewPoint, specular: &[Vec<f64>], done: &Done) -> bool {
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

    /// Adds a round; false if it was stopped meanwhile, in which case nothing of it counts.
    fn round(&self, work: &mut Work<'_>) -> bool {
        let each = round_size(&self.run.scene.solver, work.paths / REPLICATES);
        let (walk, number) = (&work.walk, work.number);
        let traced: Option<()> = work
            .replicates
            .par_iter_mut()
            .enumerate()
            .map(|(replicate, state)| {
                let stream = number as u64 * REPLICATES + replicate as u64;
                let numbers = Numbers::new(self.run.scene.solver.sampler, self.run.scene.solver.seed, stream);
                self.trace(walk, state, &numbers, each)
            })
            .collect();
        if traced.is_none() {
            return false;
        }
        let estimates = walk.estimates(&work.replicates);
        let samples: Vec<Sample> =
            estimates.par_iter().map(|estimate| self.run.meter.sample(estimate)).collect();
        let every_bin = matches!(self.run.scene.solver.stop, Stop::RelativeError { every_bin: true, .. });
        work.relative_error = self.run.meter.standard_error(&samples, every_bin);
        work.confidence.add(self.run.meter.luminous_means(&samples));
        work.samples = samples;
        work.paths += each * REPLICATES;
        work.relative_error = work.relative_error.max(work.confidence.least_error(work.paths));
        true
    }

    /// Traces in pieces, so that a stop is heeded at once.
    fn trace(&self, walk: &Walk<'_>, replicate: &mut Replicate, numbers: &Numbers, count: u64) -> Option<()> {
        let mut left = count;
        while left > 0 {
            if self.run.control.stopped() {
                return None;
            }
            let piece = left.min(1024);
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
            // More paths do not make a metric that is not there.
            Stop::Target(_) if work.missed_by().is_infinite() => work.paths > 0,
            Stop::Target(_) => {
                work.paths >= MOST_PATHS || (work.missed_by() <= 1.0 && work.confidence.holds(work.paths))
            }
        }
    }

    fn progress(&self, work: &Work<'_>, done: &Done) -> Progress<'static> {
        let (share_of_paths, target) = match self.run.scene.solver.stop {
            Stop::Paths(paths) => (Some((work.paths as f64 / paths as f64).min(1.0)), None),
            Stop::RelativeError { target, .. } => (None, Some(target)),
            // The share of paths that the error over the tolerance tells.
            Stop::Target(_) => (Some((1.0 / work.missed_by()).min(1.0)), None),
        };
        let views = done.views.len() + usize::from(self.is_enough(work));
        Progress {
            paths: Some(done.paths + work.paths),
            share_of_paths,
            relative_error: work.relative_error,
            target,
            views_done: (views, self.run.setup.views.len()),
            so_far: None,
        }
    }

    fn result(&self, done: Done, specular: &[Vec<f64>], interrupted: bool) -> RunResult {
        let solver = SolverReport {
            method: "monte-carlo".to_owned(),
            paths: Some(done.paths),
            nodes: None,
            degrees_of_freedom: REPLICATES - 1,
            relative_error_reached: done.relative_error,
            target: matches!(self.run.scene.solver.stop, Stop::Target(_)).then_some(TargetReport {
                error_over_tolerance: Some(done.missed).filter(|missed| missed.is_finite()),
                paths_for_a_tenth: done.paths_for_a_tenth,
            }),
            interrupted,
        };
        let unreached = format!("that would take more than {MOST_PATHS} paths");
        let mut result = self.run.result(done.views, solver, specular, &unreached);
        if let Some((paths, least)) = done.too_few {
            result.warnings.push(format!(
                "{paths} paths a view are too few: here some light is met by one path in {}, and all replicates may \
                 miss it (expected {least} paths or more); standard errors are \
                 held at 1/{paths} of each value",
                least.div_ceil(REPLICATES)
            ));
        }
        result
    }
}
