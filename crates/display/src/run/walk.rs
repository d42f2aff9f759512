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
use crate::meter::Sample;
use crate::result::{RunResult, SolverReport, View};
use crate::scene::Stop;
use crate::setup::ViewPoint;

/// Independent replicates of each view; standard errors have one degree of freedom less.
pub(super) const REPLICATES: u64 = 32;

/// Paths of each replicate in the first round; rounds double the total from there.
const FIRST_ROUND: u64 = 256;

/// The most paths that a round adds to a replicate: how finely progress shows.
const LARGEST_ROUND: u64 = 1 << 14;

/// A target that is not reached with this many paths of a view is given up.
const MOST_PATHS: u64 = 1 << 31;

/// Runs a scene, on the threads of the pool that this is called in.
pub(super) fn run(run: &Run<'_>) -> Result<RunResult, DisplayError> {
    Runner { run }.run()
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
    relative_error: f64,
}

/// What has been seen so far.
#[derive(Default)]
struct Done {
    views: Vec<View>,
    paths: u64,
    relative_error: f64,
}

impl<'a> Runner<'a> {
    fn run(&self) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut done = Done::default();
        let mut interrupted = false;
        // One view after the other: only one view's sums are in memory.
        for (number, at) in self.run.setup.views.iter().enumerate() {
            let mut work = self.start(number, at);
            interrupted = !self.look(&mut work, &done);
            if !work.samples.is_empty() {
                if !work.samples.iter().all(Sample::is_finite) {
                    return Err(DisplayError::NotFinite);
                }
                done.views.push(self.run.meter.view_of_replicates(at, &work.samples, &specular));
                done.paths += work.paths;
                done.relative_error = done.relative_error.max(work.relative_error);
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
        Work { walk, number, replicates, samples: Vec::new(), paths: 0, relative_error: f64::INFINITY }
    }

    /// Adds rounds to a view until it is good enough; false if it was stopped before.
    fn look(&self, work: &mut Work<'_>, done: &Done) -> bool {
        while !self.is_enough(work) {
            if !self.round(work) {
                return false;
            }
            (self.run.control.progress)(self.progress(work, done));
        }
        true
    }

    /// Adds a round; false if it was stopped meanwhile, in which case nothing of it counts.
    fn round(&self, work: &mut Work<'_>) -> bool {
        let each = self.round_size(work.paths / REPLICATES);
        let (walk, number) = (&work.walk, work.number);
        let samples: Option<Vec<Sample>> = work
            .replicates
            .par_iter_mut()
            .enumerate()
            .map(|(replicate, state)| {
                let stream = number as u64 * REPLICATES + replicate as u64;
                let numbers = Numbers::new(self.run.scene.solver.sampler, self.run.scene.solver.seed, stream);
                self.trace(walk, state, &numbers, each)
            })
            .collect();
        let Some(samples) = samples else { return false };
        let every_bin = matches!(self.run.scene.solver.stop, Stop::RelativeError { every_bin: true, .. });
        work.relative_error = self.run.meter.standard_error(&samples, every_bin);
        work.samples = samples;
        work.paths += each * REPLICATES;
        true
    }

    /// Traces in pieces, so that a stop is heeded at once.
    fn trace(
        &self,
        walk: &Walk<'_>,
        replicate: &mut Replicate,
        numbers: &Numbers,
        count: u64,
    ) -> Option<Sample> {
        let mut left = count;
        while left > 0 {
            if self.run.control.stopped() {
                return None;
            }
            let piece = left.min(1024);
            walk.trace(replicate, numbers, piece);
            left -= piece;
        }
        Some(self.run.meter.sample(&walk.estimate(replicate)))
    }

    /// Paths that the next round adds to each replicate that has `so_far`.
    fn round_size(&self, so_far: u64) -> u64 {
        let double = so_far.clamp(FIRST_ROUND, LARGEST_ROUND);
        match self.run.scene.solver.stop {
            Stop::Paths(paths) => double.min(paths.div_ceil(REPLICATES) - so_far),
            Stop::RelativeError { .. } => double,
        }
    }

    fn is_enough(&self, work: &Work<'_>) -> bool {
        match self.run.scene.solver.stop {
            Stop::Paths(paths) => work.paths >= paths,
            Stop::RelativeError { target, .. } => work.relative_error <= target || work.paths >= MOST_PATHS,
        }
    }

    fn progress(&self, work: &Work<'_>, done: &Done) -> Progress {
        let (share_of_paths, target) = match self.run.scene.solver.stop {
            Stop::Paths(paths) => (Some((work.paths as f64 / paths as f64).min(1.0)), None),
            Stop::RelativeError { target, .. } => (None, Some(target)),
        };
        let views = done.views.len() + usize::from(self.is_enough(work));
        Progress {
            paths: Some(done.paths + work.paths),
            share_of_paths,
            relative_error: work.relative_error,
            target,
            views_done: (views, self.run.setup.views.len()),
        }
    }

    fn result(&self, done: Done, specular: &[Vec<f64>], interrupted: bool) -> RunResult {
        let solver = SolverReport {
            method: "walk".to_owned(),
            paths: Some(done.paths),
            nodes: None,
            degrees_of_freedom: REPLICATES - 1,
            relative_error_reached: done.relative_error,
            interrupted,
        };
        let unreached = format!("that would take more than {MOST_PATHS} paths");
        self.run.result(done.views, solver, specular, &unreached)
    }
}
