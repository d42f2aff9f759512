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
use crate::meter::{Meter, Sample, jackknife, relative, spread};
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
#[derive(Debug, Clone, PartialEq)]
pub struct StudyPoint {
    /// Number of paths of all replicates.
    pub paths: u64,
    /// Time of the transport alone, s.
    pub transport_s: f64,
    /// Largest relative standard error of Y over all states.
    pub relative_error: f64,
    /// The same without each of the replicates.
    pub left_out: Vec<f64>,
}

impl StudyPoint {
    /// Creates a point from Y of each state in each replicate.
    fn new(paths: u64, transport_s: f64, luminous: &[Vec<f64>]) -> Self {
        let largest = |without: Option<usize>| {
            let kept = |of: &[f64]| {
                let all = of.iter().enumerate();
                spread(all.filter(|(replicate, _)| Some(*replicate) != without).map(|(_, y)| *y))
            };
            luminous.iter().map(|of| relative(kept(of))).fold(0.0, f64::max)
        };
        let replicates = luminous.first().map_or(0, Vec::len);
        let left_out = (0..replicates).map(|replicate| largest(Some(replicate))).collect();
        Self { paths, transport_s, relative_error: largest(None), left_out }
    }
}

impl StudyCurve {
    /// Returns the CPU time of the transport to a relative error, s: interpolated between points as a power
    /// of time; that of the first point if its error is small enough, `None` if that of the last is not.
    pub fn seconds_to(&self, error: f64) -> Option<f64> {
        let at = self.points.iter().position(|point| point.relative_error <= error)?;
        let after = &self.points[at];
        let Some(before) = at.checked_sub(1).map(|at| &self.points[at]) else {
            return Some(after.transport_s);
        };
        let share =
            (before.relative_error / error).ln() / (before.relative_error / after.relative_error).ln();
        Some(before.transport_s * (after.transport_s / before.transport_s).powf(share))
    }

    /// Returns the exponent p of `error = c paths^-p`, by least squares of the logarithms, and its standard error;
    /// `None` unless there are two points.
    ///
    /// The standard error is that of the jackknife over the replicates: they need not be Gaussian, and points
    /// of one curve share their first paths.
    pub fn slope(&self) -> Option<(f64, f64)> {
        let exponent = |error: &dyn Fn(&StudyPoint) -> f64| {
            let all = self.points.iter().map(|point| (point.paths as f64, error(point)));
            let positive = all.filter(|(_, error)| *error > 0.0);
            let logs: Vec<(f64, f64)> = positive.map(|(paths, error)| (paths.ln(), error.ln())).collect();
            slope(&logs).map(|(slope, _)| -slope)
        };
        let replicates = self.points.first()?.left_out.len();
        let mut left_out = (0..replicates).map(|replicate| exponent(&|point| point.left_out[replicate]));
        Some((exponent(&|point| point.relative_error)?, jackknife(&mut left_out)?))
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
    let setup = Setup::of_map(scene, control)?;
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
    let setup = Setup::of_map(scene, control)?;
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
            points.push(StudyPoint::new(
                each * REPLICATES,
                transport_s,
                &self.meter.luminous_values(&samples),
            ));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The exponent of a curve of nested means of independent numbers, and its standard error.
    fn slope_of(seed: u64, number: fn(f64) -> f64) -> (f64, f64) {
        let counts = [16, 64, 256];
        let mut of_points = vec![Vec::new(); counts.len()];
        for stream in 0..REPLICATES {
            let (random, mut sum) = (SampleStream::new(Sampler::Random, seed, stream), 0.0);
            for path in 1..=256 {
                sum += number(random.block(path, 0)[0]);
                if let Some(at) = counts.iter().position(|count| *count == path) {
                    of_points[at].push(sum / path as f64);
                }
            }
        }
        let point = |(count, means)| StudyPoint::new(count * REPLICATES, 0.0, &[means]);
        let points = counts.into_iter().zip(of_points).map(point).collect();
        let curve = StudyCurve { sampler: Sampler::Random, strategy: Strategy::Cosine, setup_s: 0.0, points };
        curve.slope().unwrap()
    }

    /// Returns the mean of the exponents over seeds, and the rms of their deviations from it in units of the
    /// stated standard errors, and in units of that of Gaussian numbers, `1/sqrt(2 * 31)`, of three points.
    fn judged(number: fn(f64) -> f64) -> (f64, [f64; 2]) {
        let found: Vec<(f64, f64)> = (0..100).map(|seed| slope_of(seed, number)).collect();
        let mean = found.iter().map(|(exponent, _)| exponent).sum::<f64>() / 100.0;
        let gaussian = 0.127 / (2.0_f64 * 4.0_f64.ln().powi(2)).sqrt();
        let rms = |error: &dyn Fn(f64) -> f64| {
            let squares = found.iter().map(|(exponent, stated)| ((exponent - mean) / error(*stated)).powi(2));
            (squares.sum::<f64>() / 99.0).sqrt()
        };
        (mean, [rms(&|stated| stated), rms(&|_| gaussian)])
    }

    /// Exponential numbers have the exponent 0.5. Numbers of infinite variance (index 1.5, thus 1/3 in the
    /// limit) scatter several times as much as Gaussian ones, and their errors say so.
    #[test]
    fn exponents_scatter_by_their_errors_with_light_and_heavy_tails() {
        let (mean, [stated, _]) = judged(|u| -u.ln());
        assert!((mean - 0.5).abs() < 0.02 && (0.8..1.3).contains(&stated), "{mean} {stated}");
        let (mean, [stated, gaussian]) = judged(|u| u.powf(-1.0 / 1.5));
        assert!((0.2..0.4).contains(&mean) && stated < 2.0 && gaussian > 3.0, "{mean} {stated} {gaussian}");
    }
}
