//! Runs a scene: rounds of paths on all threads until the numbers are good enough.
//!
//! Each view has [`REPLICATES`] replicates with numbers of their own. A round adds the
//! same number of paths to each; replicates never share sums, so the result does not
//! depend on which thread ran what. Views are computed one after the other: the sums of
//! one are in memory.

use std::sync::atomic::{AtomicBool, Ordering};

use papilio_sampling::Numbers;
use papilio_transport::walk::{Replicate, Walk};
use papilio_transport::{Source, specular_image};
use rayon::prelude::*;

use crate::DisplayError;
use crate::meter::Meter;
use crate::prepare::{Prepared, ViewPoint};
use crate::result::{RunResult, SolverReport, View};
use crate::sample::Sample;
use crate::scene::{Scene, Stop};

/// Independent replicates of each view; standard errors have one degree of freedom less.
const REPLICATES: u64 = 32;

/// Paths of each replicate in the first round; rounds double the total from there.
const FIRST_ROUND: u64 = 256;

/// The most paths that a round adds to a replicate: how finely progress shows.
const LARGEST_ROUND: u64 = 1 << 14;

/// A target that is not reached with this many paths of a view is given up.
const MOST_PATHS: u64 = 1 << 31;

/// How far a run has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Paths traced, over all views so far (walk).
    pub paths: Option<u64>,
    /// The part of the current view's paths that is done, where that is known.
    pub share_of_paths: Option<f64>,
    /// The largest relative error of Y in the current view.
    pub relative_error: f64,
    /// The target, where there is one.
    pub target: Option<f64>,
    /// Views that are done, of how many.
    pub views_done: (usize, usize),
}

/// How a run talks to its caller.
pub struct Control<'a> {
    /// Worker threads; `None`: one for each processor.
    pub threads: Option<usize>,
    /// Called after each round.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Set it to end the run with what is there.
    pub stop: &'a AtomicBool,
}

/// Runs a scene.
///
/// Interrupted, it reports the views that are done and, if it has been seen at all, the one
/// in work.
///
/// # Errors
/// If the scene cannot be, or was stopped before there was anything to report.
pub fn run(scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
    let threads = control.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|_| DisplayError::Threads { threads })?;
    pool.install(|| {
        let prepared = Prepared::new(scene)?;
        let meter = Meter::new(&prepared, scene.grid);
        Runner { scene, control, prepared: &prepared, meter: &meter }.run()
    })
}

struct Runner<'a> {
    scene: &'a Scene,
    control: &'a Control<'a>,
    prepared: &'a Prepared,
    meter: &'a Meter<'a>,
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
        let images: Vec<Vec<f64>> =
            self.prepared.sources[1..].iter().map(|source| self.image(source)).collect();
        let specular = self.meter.specular(&images);
        let mut done = Done::default();
        let mut interrupted = false;
        // One view after the other: only one view's sums are in memory.
        for (number, at) in self.prepared.views.iter().enumerate() {
            let mut work = self.start(number, at);
            interrupted = !self.look(&mut work, &done);
            if !work.samples.is_empty() {
                if !work.samples.iter().all(Sample::is_finite) {
                    return Err(DisplayError::NotFinite);
                }
                done.views.push(self.meter.view(at, &work.samples, &specular));
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
        let walk = Walk::new(&self.prepared.stack, at.field, &self.prepared.sources);
        let replicates = (0..REPLICATES).map(|_| walk.replicate()).collect();
        Work { walk, number, replicates, samples: Vec::new(), paths: 0, relative_error: f64::INFINITY }
    }

    /// Adds rounds to a view until it is good enough; false if it was stopped before.
    fn look(&self, work: &mut Work<'_>, done: &Done) -> bool {
        while !self.is_enough(work) {
            if !self.round(work) {
                return false;
            }
            (self.control.progress)(self.progress(work, done));
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
                let numbers = Numbers::new(self.scene.solver.sampler, self.scene.solver.seed, stream);
                self.trace(walk, state, &numbers, each)
            })
            .collect();
        let Some(samples) = samples else { return false };
        let every_bin = matches!(self.scene.solver.stop, Stop::RelativeError { every_bin: true, .. });
        work.relative_error = self.meter.relative_error(&samples, every_bin);
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
            if self.control.stop.load(Ordering::Relaxed) {
                return None;
            }
            let piece = left.min(1024);
            walk.trace(replicate, numbers, piece);
            left -= piece;
        }
        Some(self.meter.sample(&walk.estimate(replicate)))
    }

    /// Paths that the next round adds to each replicate that has `so_far`.
    fn round_size(&self, so_far: u64) -> u64 {
        let double = so_far.clamp(FIRST_ROUND, LARGEST_ROUND);
        match self.scene.solver.stop {
            Stop::Paths(paths) => double.min(paths.div_ceil(REPLICATES) - so_far),
            Stop::RelativeError { .. } => double,
        }
    }

    fn is_enough(&self, work: &Work<'_>) -> bool {
        match self.scene.solver.stop {
            Stop::Paths(paths) => work.paths >= paths,
            Stop::RelativeError { target, .. } => work.relative_error <= target || work.paths >= MOST_PATHS,
        }
    }

    fn progress(&self, work: &Work<'_>, done: &Done) -> Progress {
        let (share_of_paths, target) = match self.scene.solver.stop {
            Stop::Paths(paths) => (Some((work.paths as f64 / paths as f64).min(1.0)), None),
            Stop::RelativeError { target, .. } => (None, Some(target)),
        };
        let views = done.views.len() + usize::from(self.is_enough(work));
        Progress {
            paths: Some(done.paths + work.paths),
            share_of_paths,
            relative_error: work.relative_error,
            target,
            views_done: (views, self.prepared.views.len()),
        }
    }

    fn result(&self, done: Done, specular: &[Vec<f64>], interrupted: bool) -> RunResult {
        RunResult {
            solver: SolverReport {
                method: "walk".to_owned(),
                paths: Some(done.paths),
                nodes: None,
                degrees_of_freedom: REPLICATES - 1,
                relative_error_reached: done.relative_error,
                interrupted,
            },
            wavelength_nm: self.scene.grid.wavelengths_nm(),
            illuminant: self.meter.illuminant(),
            warnings: self.warnings(specular, interrupted, &done),
            views: done.views,
        }
    }

    /// The specular reflectance for a directed source (for a disc, at its middle).
    fn image(&self, source: &Source) -> Vec<f64> {
        let beta = match source {
            Source::Diffuse => papilio_optics::Beta::default(),
            Source::Beam(beta) => *beta,
            Source::Disc(cone) => -cone.axis_towards(),
        };
        let image = specular_image(&self.prepared.stack, beta);
        image.base.iter().zip(image.front.iter().cycle()).map(|(base, front)| base + front).collect()
    }

    fn warnings(&self, specular: &[Vec<f64>], interrupted: bool, done: &Done) -> Vec<String> {
        let mut warnings = Vec::new();
        for (light, directed) in self.scene.lighting.directed.iter().enumerate() {
            let mirrored = specular.iter().any(|by_light| by_light[light] > 0.0);
            if directed.radius_deg.is_some() || !mirrored {
                continue;
            }
            for view in &self.prepared.views {
                if self.looks_into(view, &self.prepared.sources[light + 1]) {
                    warnings.push(format!(
                        "the view at theta {} deg, phi {} deg looks into the mirror image of directed source {light} \
                         (theta {} deg): a source without radius_deg has no radiance, its image is not part of the \
                         luminance; see `specular`, or give the source a radius_deg",
                        view.theta_deg, view.phi_deg, directed.theta_deg
                    ));
                }
            }
        }
        if interrupted {
            warnings.push(format!(
                "interrupted: {} of {} views, the last one not finished",
                done.views.len(),
                self.prepared.views.len()
            ));
        } else if let Stop::RelativeError { target, .. } = self.scene.solver.stop
            && done.relative_error > target
        {
            let reached = done.relative_error;
            warnings.push(format!("relative error {reached:.2e} instead of {target:.2e}: that would take more than {MOST_PATHS} paths"));
        }
        warnings
    }

    /// True if the mirror image of a beam lies in the field of view.
    fn looks_into(&self, view: &ViewPoint, source: &Source) -> bool {
        matches!(source, Source::Beam(beta) if view.field.holds(*beta))
    }
}
