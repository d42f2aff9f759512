//! Runs of scenes: the common part of both solvers. `walk` (Monte Carlo) adds rounds of paths, and `adding`
//! refines its level, until the target is met.

mod adding;
mod auto;
mod brdf;
mod cone;
mod filtered;
mod memory;
mod progress;
mod refine;
mod rounds;
mod saved;
mod study;
mod viewers;
mod walk;

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use papilio_optics::Beta;
use papilio_spectra::{Grid, StateSpectra};
use papilio_transport::{Source, specular_image, specular_image_of};
use rayon::ThreadPool;
use rayon::prelude::*;

pub(crate) use adding::{Kernels, ViewGroupKernel};
pub(crate) use auto::is_quick;
pub use auto::{Forecast, THICKEST_FOR_MONTE_CARLO, expected_seconds, forecast};
pub use brdf::{brdf, brdf_resumed, depends_on_azimuth};
pub use cone::{always_by_adding, cone};
pub use memory::{expected_bytes, expected_map_bytes, expected_view_bytes};
pub use progress::{Progress, ProgressFraction};
pub use refine::adding_seconds;
pub(crate) use refine::{Refined, finest, largest, level_error, refine_or_fail};
pub use rounds::REPLICATES;
pub(crate) use rounds::{PILOT, Round, missed, paths_from_round, until};
pub use saved::{SavedRows, Unsaved};
pub use study::{Cost, StudyCurve, StudyPoint, cost, study};
pub use viewers::{brdf_at_viewers, brdf_at_viewers_resumed};

use crate::filtered::Filtered;
use crate::meter::{Meter, ViewSamples, against_angle};
use crate::notes::notes;
use crate::polarisation;
use crate::readability::Reader;
use crate::result::{self, RunResult, SolverReport, View, XyzError};
use crate::scene::{Method, Scene, Solver, Stop};
use crate::setup::{Setup, ViewPoint};
use crate::{DisplayError, Prepared};

/// Explanation of why adding did not reach a target.
const FINEST_REACHED: &str = "adding's finest level is reached; the Monte Carlo solver (method = \"monte-carlo\") may reach a smaller error";

/// Largest estimated error of X, Y and Z by interpolation between wavelengths, relative to a perfect white or to the
/// state if it is brighter, that gives no warning.
const NEGLIGIBLE_ERROR: f64 = 1e-3;

/// Steps that a warning may suggest, nm.
const STEPS_NM: [f64; 6] = [20.0, 10.0, 5.0, 2.5, 2.0, 1.0];

/// Accuracy of an answer of a prepared display.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Accuracy {
    /// The target of the scene.
    Exact,
    /// Coarse, as soon as possible.
    First,
    /// At a given level of discretisation of adding, whatever the target; a display below a colour filter has
    /// its target.
    Level(u32),
}

/// Control of a run by its caller.
pub struct Control<'a> {
    /// Worker threads; `None`: one for each processor.
    pub threads: Option<usize>,
    /// Called after each round or level; from several threads if views are computed in parallel.
    pub progress: &'a (dyn Fn(Progress<'_>) + Sync),
    /// Set to true to stop the run; it then returns the results so far.
    pub stop: &'a AtomicBool,
}

impl Control<'_> {
    pub(crate) fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// # Errors
    /// [`DisplayError::Interrupted`] if the caller has stopped the computation.
    pub(crate) fn check(&self) -> Result<(), DisplayError> {
        if self.stopped() { Err(DisplayError::Interrupted) } else { Ok(()) }
    }

    /// Calls `compute` with a control that reports its progress as a part of this computation, from one
    /// fraction to another.
    pub fn within<T>(&self, part: [f64; 2], compute: impl FnOnce(&Control<'_>) -> T) -> T {
        let progress = |now: Progress<'_>| (self.progress)(now.within(part));
        compute(&Control { progress: &progress, ..*self })
    }

    /// Number of worker threads.
    pub(crate) fn thread_count(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    }
}

/// Runs a scene. For a series of scenes that differ little, use a [`Prepared`].
///
/// An interrupted run reports the views that are done and, if it has an estimate, the current
/// view.
///
/// # Errors
/// If the scene is invalid, or the run was stopped before its first estimate.
pub fn run(scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
    Prepared::new(scene, control)?.run(scene, control)
}

/// Pool of worker threads, kept as long as the requested number does not change.
#[derive(Debug)]
pub(crate) struct Workers {
    threads: usize,
    pool: ThreadPool,
}

impl Workers {
    /// Returns a pool of this many threads (0: one for each processor); `kept` is reused if it has the same
    /// number.
    pub(crate) fn wanted(kept: &mut Option<Self>, threads: usize) -> Result<&ThreadPool, DisplayError> {
        let workers = match kept.take() {
            Some(workers) if workers.threads == threads => workers,
            _ => {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
                Self { threads, pool: pool.map_err(|_| DisplayError::Threads { threads })? }
            }
        };
        Ok(&kept.insert(workers).pool)
    }

    /// Returns a pool of this many threads; `None` for one thread.
    pub(crate) fn unless_one(
        kept: &mut Option<Self>,
        threads: Option<usize>,
    ) -> Result<Option<&ThreadPool>, DisplayError> {
        if threads == Some(1) { Ok(None) } else { Self::wanted(kept, threads.unwrap_or(0)).map(Some) }
    }
}

/// Calls `f` with each item and its number; returns the results in order. Runs in parallel if there is a
/// pool.
pub(crate) fn each<T: Send, R: Send>(
    pool: Option<&ThreadPool>,
    items: &mut [T],
    f: impl Fn((usize, &mut T)) -> R + Sync + Send,
) -> Vec<R> {
    match pool {
        None => items.iter_mut().enumerate().map(f).collect(),
        Some(pool) => pool.install(|| items.par_iter_mut().enumerate().map(f).collect()),
    }
}

/// Computes something of each view of a setup, on all threads unless one by one. Reports each finished view;
/// what `compute` reports counts them, too.
///
/// # Errors
/// Those of `compute`; [`DisplayError::Interrupted`].
pub(crate) fn each_view<T: Send>(
    setup: &Setup,
    one_by_one: bool,
    control: &Control<'_>,
    compute: impl Fn(usize, &Control<'_>) -> Result<T, DisplayError> + Sync + Send,
) -> Result<Vec<T>, DisplayError> {
    let (mut workers, views) = (None, setup.views.len());
    let one_by_one = one_by_one || views == 1;
    let pool = if one_by_one { None } else { Workers::unless_one(&mut workers, control.threads)? };
    let done = AtomicUsize::new(0);
    let progress = |now: Progress<'_>| {
        (control.progress)(Progress { views_done: (done.load(Ordering::Relaxed), views), ..now });
    };
    let within = Control { progress: &progress, ..*control };
    let one = |(number, ()): (usize, &mut ())| {
        control.check()?;
        let found = compute(number, &within)?;
        (control.progress)(Progress::of_views(done.fetch_add(1, Ordering::Relaxed) + 1, views));
        Ok(found)
    };
    each(pool, &mut vec![(); views], one).into_iter().collect()
}

/// Runs the scene of a setup.
pub(crate) fn run_setup(
    setup: &Setup,
    accuracy: Accuracy,
    control: &Control<'_>,
    kernels: &mut Kernels,
    workers: &mut Option<Workers>,
) -> Result<RunResult, DisplayError> {
    let meter = Meter::new(setup);
    let run = Run { accuracy, ..Run::new(setup, control, &meter) };
    let solver = walk::solver_of(&run);
    let run_by_paths = Run { solver: &solver, ..run };
    if setup.scene.display.filter().is_some() {
        return filtered::run(&run, &run_by_paths);
    }
    let mut forecast = (setup.scene.solver.method == Method::Auto).then(|| auto::choose(&run)).transpose()?;
    let method = forecast.as_ref().map_or(setup.scene.solver.method, |forecast| forecast.cheaper);
    let mut result = match method {
        Method::MonteCarlo => {
            let pool = Workers::wanted(workers, control.threads.unwrap_or(0))?;
            pool.install(|| walk::run(&run_by_paths))
        }
        // Starting threads would cost more than computing a single view.
        Method::Adding | Method::Auto if setup.views.len() == 1 => adding::run(&run, kernels, None),
        Method::Adding | Method::Auto => {
            adding::run(&run, kernels, Workers::unless_one(workers, control.threads)?)
        }
    }?;
    if let Some(forecast) = &mut forecast
        && result.solver.paths.is_none()
        && accuracy == Accuracy::Exact
        && !result.solver.interrupted
        && let Some(reason) = auto::instead_of_adding(&run, result.solver.relative_error_reached)?
    {
        let pool = Workers::wanted(workers, control.threads.unwrap_or(0))?;
        let by_paths = pool.install(|| walk::run(&run_by_paths))?;
        if by_paths.solver.interrupted
            || by_paths.solver.relative_error_reached < result.solver.relative_error_reached
        {
            (result, forecast.reason) = (by_paths, reason);
        }
    }
    if let Some((kept, port)) = setup.kept.as_ref().zip(setup.scene.lighting.port) {
        // The brighter of diffuse light and the light of an environment.
        let brightest = |a: &usize, b: &usize| {
            setup.lights[*a].illuminance_lx.total_cmp(&setup.lights[*b].illuminance_lx)
        };
        if let Some(light) = (0..kept.len()).max_by(brightest) {
            let all = setup.scene.grid.wavelengths_nm();
            let bin =
                (0..all.len()).min_by(|a, b| (all[*a] - 550.0).abs().total_cmp(&(all[*b] - 550.0).abs()));
            result.notes.extend(bin.map(|bin| kept[light].note(port, (bin, all[bin]), &setup.states)));
        }
    }
    if let Some(forecast) = forecast {
        result.notes.push(format!("`auto` has chosen {}: {}", result.solver.method, forecast.reason));
        result.solver.chosen_because = Some(forecast.reason);
    }
    Ok(result)
}

/// Prepares kernels at the level that meets the scene's target, one for each group of views that share it.
pub(crate) fn prepared_kernels(
    setup: &Setup,
    control: &Control<'_>,
) -> Result<Vec<ViewGroupKernel>, DisplayError> {
    let meter = Meter::new(setup);
    adding::view_group_kernels(&Run::new(setup, control, &meter))
}

/// Input of a solver.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a> {
    pub(crate) scene: &'a Scene,
    /// The solver of the scene; of a first answer by Monte Carlo, with few paths.
    pub(crate) solver: &'a Solver,
    pub(crate) accuracy: Accuracy,
    pub(crate) control: &'a Control<'a>,
    pub(crate) setup: &'a Setup,
    pub(crate) meter: &'a Meter<'a>,
}

impl<'a> Run<'a> {
    /// Input for an exact answer.
    pub(crate) fn new(setup: &'a Setup, control: &'a Control<'a>, meter: &'a Meter<'a>) -> Self {
        let (scene, accuracy) = (&setup.scene, Accuracy::Exact);
        Self { scene, solver: &scene.solver, accuracy, control, setup, meter }
    }
}

impl Run<'_> {
    /// Whether an answer by paths is the one that the scene demands.
    fn is_final(&self) -> bool {
        self.solver.stop == self.scene.solver.stop
    }

    /// Computes the image luminance ratio of each directed source, `[state][light]`.
    fn specular(&self) -> Vec<Vec<f64>> {
        let directed = &self.setup.sources[1..][..self.scene.lighting.directed.len()];
        let images: Vec<StateSpectra> =
            directed.iter().enumerate().map(|(i, source)| self.image(1 + i, source)).collect();
        self.meter.specular(&images)
    }

    /// True if mirror images of directed sources in pixels below a filter are not known: those below general
    /// layers.
    fn misses_images_of_pixels(&self) -> bool {
        let directed = &self.setup.sources[1..][..self.scene.lighting.directed.len()];
        directed.iter().enumerate().any(|(i, source)| {
            let beta = source.direction().unwrap_or_default();
            let image = specular_image(&self.setup.stack, beta);
            image.via_pixel.iter().any(|pixel| *pixel > 0.0) && self.image_below_filter(1 + i, beta).is_none()
        })
    }

    /// Computes the specular reflectance for a directed source (for a disc, at its centre), given with its number.
    fn image(&self, number: usize, source: &Source) -> StateSpectra {
        let beta = source.direction().unwrap_or_default();
        let mut image = specular_image_of(&self.setup.stack, number, source);
        if self.scene.display.filter().is_some() {
            // A display with a filter has other states than its pixel.
            let nothing = || StateSpectra::zeros(self.setup.states.len(), image.front.len());
            image.via_pixel = self.image_below_filter(number, beta).unwrap_or_else(nothing);
        }
        image.total()
    }

    /// Mirror image of the beam of a source in pixels below a filter.
    fn image_below_filter(&self, number: usize, beta: Beta) -> Option<StateSpectra> {
        let filtered = Filtered::new(self.setup, self.control).ok()??;
        filtered.image(number, beta).ok()
    }

    /// Assembles the result; `unreached` explains why a target was not reached.
    fn result(
        &self,
        views: Vec<ViewSamples>,
        solver: SolverReport,
        specular: &[Vec<f64>],
        unreached: &str,
    ) -> RunResult {
        let mut warnings = self.mirror_images(specular);
        let reached = solver.relative_error_reached;
        if solver.interrupted {
            warnings.push(format!(
                "interrupted: {} of {} views, the last one not finished",
                views.len(),
                self.setup.views.len()
            ));
        } else if let Stop::RelativeError { target, .. } = self.scene.solver.stop
            && reached > target
            && solver.is_final
        {
            warnings.push(format!("relative error {reached:.2e} instead of {target:.2e}: {unreached}"));
        } else if let Some(target) = &solver.target {
            match target.error_over_tolerance {
                None => warnings.push("the metric of the target is not defined for this display".to_owned()),
                Some(over) if over > 1.0 => {
                    warnings.push(format!("the target is missed by a factor of {over:.2e}: {unreached}"));
                }
                Some(_) => {}
            }
        }
        let (views, reference_white) = (against_angle(views), self.meter.reference_white());
        let mut notes = notes(&views, reference_white);
        notes.extend(polarisation::notes(self.scene));
        notes.extend(self.setup.note_of_table());
        notes.extend(if solver.paths.is_some() { self.few_paths_below() } else { self.across_the_end() });
        warnings.extend(self.coarse_step(&views));
        RunResult {
            notes,
            solver,
            wavelength_nm: self.scene.grid.wavelengths_nm(),
            illuminant: self.meter.illuminant(),
            reference_white,
            primaries: crate::pixel::primaries(&self.scene.display.pixel),
            views,
            reader: reader(self.scene),
            warnings,
        }
    }

    /// Returns the optical thickness of slabs that few paths pass.
    fn thick_slabs(&self) -> Option<f64> {
        /// Optical thickness from which replicates without a path that passes were found.
        const THICK: f64 = 10.0;
        let slabs = self.scene.display.layers.iter().filter_map(|layer| layer.medium.scattering.as_ref());
        let thickness: f64 = slabs.map(|slab| slab.optical_thickness).sum();
        (thickness >= THICK).then_some(thickness)
    }

    /// Returns a note on Monte Carlo below thick slabs: replicates without a path that passes do not show it.
    fn few_paths_below(&self) -> Option<String> {
        let thickness = self.thick_slabs()?;
        Some(format!(
            "few paths pass slabs of an optical thickness of {thickness:.0}: of what lies below, such as the pixel's part of the energy \
             balance, less than 3 over the number of paths may be missed, which the standard errors there include; adding misses nothing"
        ))
    }

    /// Returns a note on adding if a field of view goes across the end of measured directions, where the light jumps:
    /// all levels have the same directions in it.
    fn across_the_end(&self) -> Option<String> {
        let end = self.setup.stack.known_within()?;
        let crosses = |view: &&ViewPoint| {
            let radius = view.field.axis_towards().length();
            let half = view.field.half_angle() * (1.0 - radius * radius).max(0.0).sqrt();
            (radius - end).abs() < half
        };
        let view = self.setup.views.iter().find(crosses)?;
        Some(format!(
            "the field of view at theta {} deg goes across the end of the diffuser's measured directions: adding's error does not contain that of the \
             jump there; solver.method = \"monte-carlo\" does, and a smaller viewer.field_deg avoids it",
            view.theta_deg
        ))
    }

    /// Returns a warning if the grid is too coarse for the light or for the reflectances, with a step that is fine enough: the error
    /// of linear interpolation is proportional to the square of the step.
    fn coarse_step(&self, views: &[View]) -> Option<String> {
        // What changes within a step had its warning when the scene was made.
        let is_known = self.scene.within_step.as_ref().is_some_and(|within| within.is_known());
        if is_known || self.scene.unresolved.iter().flatten().any(|error| *error > NEGLIGIBLE_ERROR) {
            return None;
        }
        let errors = views.iter().flat_map(|view| {
            let states = view.states.0.iter();
            states.filter_map(|(name, state)| {
                let XyzError { X, Y, Z } = state.interpolation_error?;
                let error = X.max(Y).max(Z);
                // The solver's target, too, is relative: a state that is brighter than white has a larger error.
                Some((error / state.value.Y.max(1.0), error, name, view.theta_deg))
            })
        });
        let (relative, error, name, theta) = errors.max_by(|a, b| a.0.total_cmp(&b.0))?;
        let (grid, step) = (self.scene.grid, self.scene.grid.step_nm());
        let is_fine = |finer: &f64| {
            *finer < step
                && relative * (finer / step).powi(2) <= NEGLIGIBLE_ERROR
                && Grid::new(grid.start_nm(), grid.stop_nm(), *finer).is_ok()
        };
        (relative > NEGLIGIBLE_ERROR).then(|| {
            let remedy = match STEPS_NM.into_iter().find(is_fine) {
                Some(finer) => format!("set spectrum.step_nm = {finer}"),
                None => "set spectrum.range_nm to integers and spectrum.step_nm = 1".to_owned(),
            };
            format!(
                "X, Y or Z of `{name}` at theta {theta} deg has an error of about {error:.4} relative to a perfect white, because light and \
                 reflectances are known only every {step} nm, and are linear between these wavelengths; {remedy}"
            )
        })
    }

    /// Returns warnings for views that look into the mirror image of a beam.
    fn mirror_images(&self, specular: &[Vec<f64>]) -> Vec<String> {
        let warning = |(light, view): (usize, &ViewPoint)| {
            format!(
                "the view at theta {} deg, phi {} deg looks into the mirror image of directed source {light} \
                 (theta {} deg): the radiance of a source without radius_deg is not defined, and its image is not part of \
                 the luminance; see `specular`, or specify radius_deg for the source",
                view.theta_deg, view.phi_deg, self.scene.lighting.directed[light].theta_deg
            )
        };
        self.looking_into(specular).into_iter().map(warning).collect()
    }

    /// Returns the collimated sources that the display mirrors, each with the views that look into its image.
    fn looking_into(&self, specular: &[Vec<f64>]) -> Vec<(usize, &ViewPoint)> {
        let directed = self.scene.lighting.directed.iter().enumerate();
        let mirrored = |light: usize| specular.iter().any(|by_light| by_light[light] > 0.0);
        let points = directed.filter(|(light, one)| one.radius_deg.is_none() && mirrored(*light));
        let views = |light: usize| {
            let source = &self.setup.sources[light + 1];
            self.setup.views.iter().filter(|view| looks_into(view, source)).map(move |view| (light, view))
        };
        points.flat_map(|(light, _)| views(light)).collect()
    }
}

/// Returns true if the mirror image of a beam is in the field of view.
fn looks_into(view: &ViewPoint, source: &Source) -> bool {
    matches!(source, Source::Beam(beta) if view.field.holds(*beta))
}

/// Reports the reader of a scene.
fn reader(scene: &Scene) -> result::Reader {
    let reader = Reader::of(scene);
    result::Reader {
        age_years: reader.age_years,
        text_height_mm: reader.text_height_mm,
        distance_mm: reader.distance_mm,
        detail_arcmin: reader.detail_arcmin(),
        cycles_per_degree: reader.cycles_per_degree(),
        is_described: scene.metrics.reader_age_years.is_some() || scene.metrics.text_height_mm.is_some(),
    }
}
