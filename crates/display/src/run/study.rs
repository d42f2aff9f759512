//! Standard errors of the walk against paths and cost, for every sampler and strategy.

use papilio_sampling::Numbers;
use papilio_transport::walk::Walk;

use super::Control;
use super::walk::{Confidence, REPLICATES, round_size};
use crate::DisplayError;
use crate::meter::{Meter, Sample};
use crate::scene::{Sampler, Scene, Strategy};
use crate::setup::{Setup, ViewPoint};

/// A sampler with a strategy, and how it came on.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyCurve {
    /// Where its numbers came from.
    pub sampler: Sampler,
    /// How directions were drawn.
    pub strategy: Strategy,
    /// What was made before the first path, seconds.
    pub setup_s: f64,
    /// Ever more paths.
    pub points: Vec<StudyPoint>,
}

/// So many paths, and how good they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyPoint {
    /// Paths, all replicates together.
    pub paths: u64,
    /// Transport alone, seconds.
    pub transport_s: f64,
    /// The largest standard error of Y over its value, of all states.
    pub relative_error: f64,
}

impl StudyCurve {
    /// CPU time of transport to a relative error: between the points around it as a power of time;
    /// that of the first point if it is good enough, `None` if the last is not.
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        let at = self.points.iter().position(|point| point.relative_error <= error)?;
        let after = self.points[at];
        let Some(before) = at.checked_sub(1).map(|at| self.points[at]) else {
            return Some(after.transport_s);
        };
        let share =
            (before.relative_error / error).ln() / (before.relative_error / after.relative_error).ln();
        Some(before.transport_s * (after.transport_s / before.transport_s).powf(share))
    }

    /// The exponent p of `error = c paths^-p`, by least squares over the logarithms, and its standard
    /// error as what each point knows of its error (13 %) has it; `None` without two points.
    pub fn slope(&self) -> Option<(f64, f64)> {
        /// Of the logarithm of a standard error with 31 degrees of freedom, `1/sqrt(2 * 31)`.
        const KNOWN_TO: f64 = 0.127;
        let positive = self.points.iter().filter(|point| point.relative_error > 0.0);
        let logs: Vec<(f64, f64)> =
            positive.map(|point| ((point.paths as f64).ln(), point.relative_error.ln())).collect();
        let n = logs.len() as f64;
        let (x, y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
        let xx: f64 = logs.iter().map(|p| (p.0 - x).powi(2)).sum();
        let xy: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
        (xx > 0.0).then(|| (-xy / xx, KNOWN_TO / xx.sqrt()))
    }
}

/// Follows the walk from the scene's first view, for every sampler and strategy, on one thread:
/// each number of paths in `paths` (ascending) in turn. `seconds` is a clock.
///
/// # Errors
/// If the scene cannot be, or was stopped.
pub fn study(
    scene: &Scene,
    paths: &[u64],
    seconds: &dyn Fn() -> f64,
    control: &Control<'_>,
) -> Result<Vec<StudyCurve>, DisplayError> {
    let setup = Setup::new(scene)?;
    let study = Study { setup: &setup, meter: Meter::new(&setup), paths, seconds, control };
    let at = setup.views.first().ok_or(DisplayError::Interrupted)?;
    let pairs = Sampler::ALL.into_iter().flat_map(|s| Strategy::ALL.into_iter().map(move |t| (s, t)));
    pairs.map(|(sampler, strategy)| study.curve(at, sampler, strategy)).collect()
}

/// What a scene takes the walk, on one thread, from its first view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// All that does not depend on light or view: tables of the pixel's reflectance among it. Seconds.
    pub tables_s: f64,
    /// What is made before the first path: of a guided walk the guide. Seconds.
    pub setup_s: f64,
    /// Paths, seconds.
    pub tracing_s: f64,
    /// Spectra of all replicates from the sums of the paths, after each round. Seconds.
    pub spectra_s: f64,
    /// All replicates together.
    pub paths: u64,
}

/// Follows the walk from the scene's first view to this relative error of Y of every state, or of every bin of
/// every state, by rounds as a run would. `seconds` is a clock.
///
/// # Errors
/// If the scene cannot be, or was stopped.
pub fn cost(
    scene: &Scene,
    (target, every_bin): (f64, bool),
    seconds: &dyn Fn() -> f64,
    control: &Control<'_>,
) -> Result<Cost, DisplayError> {
    let started = seconds();
    let setup = Setup::new(scene)?;
    let meter = Meter::new(&setup);
    let at = setup.views.first().ok_or(DisplayError::Interrupted)?;
    let tables = seconds();
    let walk = setup.walk(at, scene.solver.scattering);
    let mut confidence = Confidence::new(&walk);
    let mut replicates: Vec<_> = (0..REPLICATES).map(|_| walk.replicate()).collect();
    let mut cost = Cost {
        tables_s: tables - started,
        setup_s: seconds() - tables,
        tracing_s: 0.0,
        spectra_s: 0.0,
        paths: 0,
    };
    while !control.stopped() {
        let started = seconds();
        let each = round_size(&scene.solver, cost.paths / REPLICATES);
        for (stream, replicate) in replicates.iter_mut().enumerate() {
            let numbers = Numbers::new(scene.solver.sampler, scene.solver.seed, stream as u64);
            walk.trace(replicate, &numbers, each);
        }
        let traced = seconds();
        let estimates = walk.estimates(&replicates);
        cost.tracing_s += traced - started;
        cost.spectra_s += seconds() - traced;
        cost.paths += each * REPLICATES;
        let samples: Vec<Sample> = estimates.iter().map(|estimate| meter.sample(estimate)).collect();
        confidence.add(meter.luminous_means(&samples));
        if meter.standard_error(&samples, every_bin) <= target && confidence.holds(cost.paths) {
            return Ok(cost);
        }
    }
    Err(DisplayError::Interrupted)
}

struct Study<'a> {
    setup: &'a Setup,
    meter: Meter<'a>,
    paths: &'a [u64],
    seconds: &'a dyn Fn() -> f64,
    control: &'a Control<'a>,
}

impl Study<'_> {
    fn curve(
        &self,
        at: &ViewPoint,
        sampler: Sampler,
        strategy: Strategy,
    ) -> Result<StudyCurve, DisplayError> {
        // Sets that are made once must not count as anyone's.
        Numbers::new(sampler, 0, 0).block(0, 0);
        let started = (self.seconds)();
        let walk = self.setup.walk(at, strategy);
        let setup_s = (self.seconds)() - started;
        let mut replicates: Vec<_> = (0..REPLICATES).map(|_| walk.replicate()).collect();
        let mut transport_s = 0.0;
        let mut points = Vec::with_capacity(self.paths.len());
        for &paths in self.paths {
            let each = paths / REPLICATES;
            let started = (self.seconds)();
            for (stream, replicate) in replicates.iter_mut().enumerate() {
                if self.control.stopped() {
                    return Err(DisplayError::Interrupted);
                }
                let numbers = Numbers::new(sampler, self.setup.scene.solver.seed, stream as u64);
                let left = each - replicate.paths();
                walk.trace(replicate, &numbers, left);
            }
            transport_s += (self.seconds)() - started;
            let samples: Vec<Sample> =
                walk.estimates(&replicates).iter().map(|estimate| self.meter.sample(estimate)).collect();
            let relative_error = self.meter.standard_error(&samples, false);
            points.push(StudyPoint { paths: each * REPLICATES, transport_s, relative_error });
        }
        Ok(StudyCurve { sampler, strategy, setup_s, points })
    }
}

impl Setup {
    /// The walk from a view.
    pub(super) fn walk(&self, at: &ViewPoint, strategy: Strategy) -> Walk<'_> {
        let illuminance: Vec<f64> = self.lights.iter().map(|light| light.illuminance_lx).collect();
        Walk::with_strategy(&self.stack, at.field, &self.sources, strategy, &illuminance)
    }
}
