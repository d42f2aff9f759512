//! Convergence studies of the Monte Carlo solver: standard error against paths and time, for all samplers and
//! strategies.
//!
//! The cost to a target is that of the rounds of a run ([`meet`]). A convergence curve has no stopping rule: its
//! numbers of paths are given, whatever the error, so that it traces them in turn.

use papilio_sampling::SampleStream;
use papilio_transport::walk::{Replicate, Walk};

use super::REPLICATES;
use super::rounds::{Confidence, Round, Rounds, meet, missed, slope};
use super::walk::{MOST_PATHS, least_paths, paths_after_next};
use super::{Control, Progress};
use crate::DisplayError;
use crate::meter::{Meter, Sample};
use crate::scene::{Sampler, Scene, Solver, Stop, Strategy};
use crate::setup::{Setup, ViewPoint};

/// Convergence of one sampler with one strategy.
#[derive(Debug, Clone, PartialEq)]
pub struct StudyCurve {
    /// Sample generator.
    pub sampler: Sampler,
    /// Strategy for drawing directions.
    pub strategy: Strategy,
    /// Time of the preparation before the first path, s.
    pub setup_s: f64,
    /// Points in the order of increasing numbers of paths.
    pub points: Vec<StudyPoint>,
}

/// Point of a convergence curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StudyPoint {
    /// Number of paths of all replicates.
    pub paths: u64,
    /// Time of the transport alone, s.
    pub transport_s: f64,
    /// Largest relative standard error of Y over all states.
    pub relative_error: f64,
}

impl StudyCurve {
    /// Returns the CPU time of the transport to a relative error, s: interpolated between points as a power
    /// of time; that of the first point if its error is small enough, `None` if that of the last is not.
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

    /// Returns the exponent p of `error = c paths^-p`, by least squares of the logarithms, and its standard
    /// error, from the uncertainty of each point's error (13 %); `None` unless there are two points.
    pub fn slope(&self) -> Option<(f64, f64)> {
        /// Standard error of the logarithm of a standard error with 31 degrees of freedom, `1/sqrt(2 * 31)`.
        const KNOWN_TO: f64 = 0.127;
        let positive = self.points.iter().filter(|point| point.relative_error > 0.0);
        let logs: Vec<(f64, f64)> =
            positive.map(|point| ((point.paths as f64).ln(), point.relative_error.ln())).collect();
        slope(&logs).map(|(slope, xx)| (-slope, KNOWN_TO / xx.sqrt()))
    }
}

/// Runs a convergence study of the scene's first view, for all samplers and strategies, on one thread, with
/// the numbers of paths in `paths` (ascending). `seconds` is a clock.
///
/// # Errors
/// If the scene is invalid, or the study was stopped.
pub fn study(
    scene: &Scene,
    paths: &[u64],
    seconds: &dyn Fn() -> f64,
    control: &Control<'_>,
) -> Result<Vec<StudyCurve>, DisplayError> {
    let setup = Setup::new(scene, control)?;
    let study = Study { setup: &setup, meter: Meter::new(&setup), paths, seconds, control };
    let at = setup.views.first().ok_or(DisplayError::Interrupted)?;
    let pairs = Sampler::ALL.into_iter().flat_map(|s| Strategy::ALL.into_iter().map(move |t| (s, t)));
    let pairs: Vec<_> = pairs.collect();
    let curve = |(number, (sampler, strategy)): (usize, &(Sampler, Strategy))| {
        let now = Progress { unit: "curves", ..Progress::of_views(number, pairs.len()) };
        (control.progress)(now);
        study.curve(at, *sampler, *strategy)
    };
    pairs.iter().enumerate().map(curve).collect()
}

/// Cost of the first view of a scene with the Monte Carlo solver on one thread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cost {
    /// Time of the preparation that does not depend on light or view, such as tables of the pixel's
    /// reflectance, s.
    pub tables_s: f64,
    /// Time of the preparation before the first path, such as that of a guide, s.
    pub setup_s: f64,
    /// Time of tracing paths, s.
    pub tracing_s: f64,
    /// Time of computing the spectra of all replicates from the sums of the paths, after each round, s.
    pub spectra_s: f64,
    /// Number of paths of all replicates.
    pub paths: u64,
}

/// Measures the cost of the scene's first view to a relative error of Y of all states, or of all wavelengths
/// of all states, in the rounds of a run, up to the most paths of a run. `seconds` is a clock.
///
/// # Errors
/// If the scene is invalid, or the computation was stopped.
pub fn cost(
    scene: &Scene,
    (target, per_wavelength): (f64, bool),
    seconds: &dyn Fn() -> f64,
    control: &Control<'_>,
) -> Result<Cost, DisplayError> {
    let started = seconds();
    let setup = Setup::new(scene, control)?;
    let meter = Meter::new(&setup);
    let at = setup.views.first().ok_or(DisplayError::Interrupted)?;
    let tables = seconds();
    let walk = setup.walk(at, scene.solver.scattering);
    let stop = Stop::RelativeError { target, per_wavelength };
    let cost = Cost {
        tables_s: tables - started,
        setup_s: seconds() - tables,
        tracing_s: 0.0,
        spectra_s: 0.0,
        paths: 0,
    };
    let mut rounds = Timed {
        solver: Solver { stop: stop.clone(), ..scene.solver.clone() },
        per_wavelength,
        meter,
        walk: &walk,
        replicates: (0..REPLICATES).map(|_| walk.replicate()).collect(),
        cost,
        seconds,
        control,
    };
    let confidence = Confidence::in_walk(&walk, least_paths(&walk));
    Ok(meet(&stop, MOST_PATHS, confidence, &mut rounds)?.0)
}

/// Rounds of a run on one thread, with the time that they take.
struct Timed<'a> {
    solver: Solver,
    per_wavelength: bool,
    meter: Meter<'a>,
    walk: &'a Walk<'a>,
    replicates: Vec<Replicate>,
    cost: Cost,
    seconds: &'a dyn Fn() -> f64,
    control: &'a Control<'a>,
}

impl Rounds for Timed<'_> {
    type Found = Cost;

    fn next(&self, paths: u64, missed: f64) -> u64 {
        paths_after_next(&self.solver, self.walk, paths, missed)
    }

    fn round(&mut self, paths: u64) -> Result<Round<Cost>, DisplayError> {
        let (solver, each) = (&self.solver, (paths - self.cost.paths) / REPLICATES);
        let started = (self.seconds)();
        for (stream, replicate) in self.replicates.iter_mut().enumerate() {
            self.control.check()?;
            let numbers = SampleStream::new(solver.sampler, solver.seed, stream as u64);
            self.walk.trace(replicate, &numbers, each);
        }
        let traced = (self.seconds)();
        let estimates = self.walk.estimates(&self.replicates);
        self.cost.tracing_s += traced - started;
        self.cost.spectra_s += (self.seconds)() - traced;
        self.cost.paths = paths;
        let samples: Vec<Sample> = estimates.iter().map(|estimate| self.meter.sample(estimate)).collect();
        let error = self.meter.standard_error(&samples, self.per_wavelength);
        let means = self.meter.luminous_means(&samples);
        Ok(Round { found: self.cost, missed: missed(&solver.stop, error)?, means })
    }
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
        // Point sets that are constructed once must not be part of a measured time.
        SampleStream::new(sampler, 0, 0).block(0, 0);
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
                self.control.check()?;
                let numbers = SampleStream::new(sampler, self.setup.scene.solver.seed, stream as u64);
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
    /// Prepares the Monte Carlo solver for a view.
    pub(super) fn walk(&self, at: &ViewPoint, strategy: Strategy) -> Walk<'_> {
        let illuminance: Vec<f64> = self.lights.iter().map(|light| light.illuminance_lx).collect();
        Walk::with_strategy(&self.stack, at.field, &self.sources, strategy, &illuminance)
    }
}
