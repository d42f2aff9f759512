//! Runs a scene: rounds of paths on all threads until the numbers are good enough.
//!
//! Each view has [`REPLICATES`] replicates with numbers of their own. A round adds the
//! same number of paths to each; replicates never share sums, so the result does not
//! depend on which thread ran what. Views that have reached the target rest.

use std::sync::atomic::{AtomicBool, Ordering};

use papilio_sampling::Numbers;
use papilio_transport::Source;
use papilio_transport::walk::{Replicate, Walk, specular_image};
use rayon::prelude::*;

use crate::DisplayError;
use crate::meter::Meter;
use crate::prepare::{Prepared, ViewPoint};
use crate::result::{RunResult, SolverReport};
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
    /// Paths traced, over all views.
    pub paths: u64,
    /// Paths that will be traced, where that is known.
    pub paths_wanted: Option<u64>,
    /// The largest relative standard error so far.
    pub relative_error: f64,
    /// The target, where there is one.
    pub target: Option<f64>,
    /// Views that have reached it, of how many.
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
    at: &'a ViewPoint,
    walk: Walk<'a>,
    replicates: Vec<Replicate>,
    /// After the last whole round.
    samples: Vec<Sample>,
    paths: u64,
    relative_error: f64,
    done: bool,
}

impl<'a> Runner<'a> {
    fn run(&self) -> Result<RunResult, DisplayError> {
        let mut views: Vec<Work<'a>> = self.prepared.views.iter().map(|at| self.start(at)).collect();
        let mut interrupted = false;
        while views.iter().any(|view| !view.done) {
            if !self.round(&mut views) {
                interrupted = true;
                break;
            }
            (self.control.progress)(self.progress(&views));
        }
        if views.iter().any(|view| view.samples.is_empty()) {
            return Err(DisplayError::Interrupted);
        }
        Ok(self.result(&views, interrupted))
    }

    fn start(&self, at: &'a ViewPoint) -> Work<'a> {
        let walk = Walk::new(&self.prepared.stack, at.field, &self.prepared.sources);
        let replicates = (0..REPLICATES).map(|_| walk.replicate()).collect();
        Work {
            at,
            walk,
            replicates,
            samples: Vec::new(),
            paths: 0,
            relative_error: f64::INFINITY,
            done: false,
        }
    }

    /// Adds a round to every view that needs one; false if it was stopped meanwhile, in
    /// which case nothing of the round counts.
    fn round(&self, views: &mut [Work<'a>]) -> bool {
        for (number, view) in views.iter_mut().enumerate().filter(|(_, view)| !view.done) {
            let each = self.round_size(view.paths / REPLICATES);
            let walk = &view.walk;
            let samples: Option<Vec<Sample>> = view
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
            view.samples = samples;
            view.paths += each * REPLICATES;
            self.judge(view);
        }
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

    fn judge(&self, view: &mut Work<'_>) {
        let every_bin = matches!(self.scene.solver.stop, Stop::RelativeError { every_bin: true, .. });
        let error = self.meter.relative_error(&view.samples, every_bin);
        let enough = match self.scene.solver.stop {
            Stop::Paths(paths) => view.paths >= paths,
            Stop::RelativeError { target, .. } => error <= target,
        };
        view.done = enough || view.paths >= MOST_PATHS;
        view.relative_error = error;
    }

    fn progress(&self, views: &[Work<'_>]) -> Progress {
        let (paths_each, target) = match self.scene.solver.stop {
            Stop::Paths(paths) => (Some(paths), None),
            Stop::RelativeError { target, .. } => (None, Some(target)),
        };
        Progress {
            paths: views.iter().map(|view| view.paths).sum(),
            paths_wanted: paths_each.map(|paths| paths * views.len() as u64),
            relative_error: worst_error(views),
            target,
            views_done: (views.iter().filter(|view| view.done).count(), views.len()),
        }
    }

    fn result(&self, views: &[Work<'_>], interrupted: bool) -> RunResult {
        let beams: Vec<Vec<f64>> =
            self.prepared.sources[1..].iter().map(|source| self.image(source)).collect();
        let specular = self.meter.specular(&beams);
        let relative_error_reached = worst_error(views);
        RunResult {
            solver: SolverReport {
                method: "walk".to_owned(),
                paths: views.iter().map(|view| view.paths).sum(),
                degrees_of_freedom: REPLICATES - 1,
                relative_error_reached,
                interrupted,
            },
            wavelength_nm: self.scene.grid.wavelengths_nm(),
            illuminant: self.meter.illuminant(),
            views: views.par_iter().map(|view| self.meter.view(view.at, &view.samples, &specular)).collect(),
            warnings: self.warnings(&specular, interrupted, relative_error_reached),
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

    fn warnings(&self, specular: &[Vec<f64>], interrupted: bool, reached: f64) -> Vec<String> {
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
        if let Stop::RelativeError { target, .. } = self.scene.solver.stop
            && reached > target
        {
            let why = if interrupted { "interrupted" } else { "the limit of paths" };
            warnings.push(format!("relative error {reached:.2e} instead of {target:.2e}: {why}"));
        }
        warnings
    }

    /// True if the mirror image of a beam lies in the field of view.
    fn looks_into(&self, view: &ViewPoint, source: &Source) -> bool {
        matches!(source, Source::Beam(beta) if view.field.holds(*beta))
    }
}

fn worst_error(views: &[Work<'_>]) -> f64 {
    views.iter().map(|view| view.relative_error).fold(0.0, f64::max)
}
