//! Conoscopic maps by adding: all directions of an ordinary panel at the level that a sample of directions
//! needs, those of general layers at the level that every direction needs.
//!
//! If all directed lights lie in one plane with the normal, directions that are mirror images in this plane
//! are equivalent and are computed once. Each thread holds the spectra of one direction at a time in memory.

use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_colour::Xyz;
use papilio_transport::Cone;
use papilio_transport::adding::{Kernel, error_over_difference};
use rayon::ThreadPool;

use super::memory::has_rings_apart;
use super::progress::{Progress, SAMPLE, part_of_pass};
use super::refine::{
    Refined, finest, largest, largest_of_states, of_levels, refine, row_errors, slowness, unresolved,
};
use super::saved::{Kind, row_number};
use super::{Control, Run, SavedRows, Unsaved, Workers, each};
use crate::cone::{ConeGrid, ConeLight, ConeResult, ConeView};
use crate::meter::Meter;
use crate::polarisation::{is_between_s_and_p, is_oblique};
use crate::scene::{DirectedLight, EnvironmentPart, Lighting, Scene, Standard, Stop};
use crate::setup::{ViewPoint, angle_index};
use crate::{DisplayError, Prepared, RowErrors};

/// Target of scenes that specify a number of paths instead of an error.
const DEFAULT_TARGET: f64 = 1e-3;

/// The warning of a scene with another observer.
const OF_1931: &str =
    "the colours of the maps are those of the CIE 1931 observer, and not of metrics.observer";

/// Returns the relative error to which tables and maps of a scene are computed.
pub(super) fn target(scene: &Scene) -> f64 {
    match scene.solver.stop {
        Stop::RelativeError { target, .. } => target,
        Stop::Paths(_) | Stop::Target(_) => DEFAULT_TARGET,
    }
}

/// Computes the view from all directions of a grid instead of the scene's own views, by adding
/// independently of the scene's method.
///
/// The scene's `relative_error` applies to Y in a sample of about twenty directions, which include the
/// normal, grazing directions and the mirror images of the lights; all others are computed at the
/// level that these need. With general layers it applies to Y in every direction.
///
/// # Errors
/// If the scene is invalid (including a field of view that reaches below the horizon), or the computation was
/// stopped.
pub fn cone(scene: &Scene, grid: ConeGrid, control: &Control<'_>) -> Result<ConeResult, DisplayError> {
    Prepared::empty().cone(scene, grid, control)
}

impl Prepared {
    /// Computes the maps of [`cone`] of a scene; the layers, pixels and lights of the scene before that are the
    /// same are not prepared again.
    ///
    /// # Errors
    /// Those of [`cone`].
    pub fn cone(
        &mut self,
        scene: &Scene,
        grid: ConeGrid,
        control: &Control<'_>,
    ) -> Result<ConeResult, DisplayError> {
        self.cone_resumed(scene, grid, control, &Unsaved)
    }

    /// Computes the same as [`cone`](Self::cone); rows that `saved` has are not computed, and others are saved there.
    ///
    /// # Errors
    /// Those of [`cone`].
    pub fn cone_resumed(
        &mut self,
        scene: &Scene,
        grid: ConeGrid,
        control: &Control<'_>,
        saved: &dyn SavedRows,
    ) -> Result<ConeResult, DisplayError> {
        if scene.display.filter().is_some() {
            return Err(DisplayError::FilterWithoutPlace);
        }
        let mut everywhere = scene.clone();
        // The map does not store spectra, and luminance needs the observer of 1931: so do its colours.
        everywhere.metrics.observer = Standard::Cie1931;
        // A port is that of one view.
        everywhere.lighting.port = None;
        everywhere.viewer.theta_deg.clone_from(&grid.theta_deg);
        everywhere.viewer.phi_deg.clone_from(&grid.phi_deg);
        let setup = self.setup_of_map(&everywhere, control)?;
        let [theta_deg, phi_deg] = grid.reference_deg;
        let reference = setup.view(theta_deg, phi_deg)?;
        let meter = Meter::new(setup);
        let mut workers = None;
        let pool = Workers::unless_one(&mut workers, control.threads)?;
        let survey = Survey {
            run: Run::new(setup, control, &meter),
            saved,
            equivalent: if setup.stack.base().is_azimuthal() {
                (0..grid.phi_deg.len()).collect()
            } else {
                equivalent_azimuths(&grid.phi_deg, &scene.lighting, scene.viewer.polariser_deg)
            },
            grid,
            reference,
            views_deg: scene.viewer.directions().map(|(theta, phi)| [theta, phi]).collect(),
            finest: finest(setup)?,
            angle_index: angle_index(scene)?,
        };
        let mut maps = survey.run(pool).unwrap_or(Err(DisplayError::Interrupted))?;
        if scene.metrics.observer != Standard::Cie1931 {
            maps.warnings.push(OF_1931.to_owned());
        }
        Ok(maps)
    }
}

/// A note if a scene has a stopping rule that a computation does not have, because it is always by adding:
/// what `is` computed.
pub fn always_by_adding(scene: &Scene, is: &str) -> Option<String> {
    let (key, what) = match scene.solver.stop {
        Stop::RelativeError { .. } => return None,
        Stop::Paths(_) => ("solver.paths", "counts paths of the Monte Carlo solver"),
        Stop::Target(_) => ("solver.target", "is a target of the Monte Carlo solver"),
    };
    Some(format!(
        "{is} computed by adding, to a relative error of {DEFAULT_TARGET}: {key} {what}; solver.relative_error is the target of both"
    ))
}

struct Survey<'a> {
    run: Run<'a>,
    /// Rows of an earlier computation, and where rows are saved.
    saved: &'a dyn SavedRows,
    grid: ConeGrid,
    /// Index of the first equivalent azimuth, for each azimuth.
    equivalent: Vec<usize>,
    /// View with which the colours of the others are compared.
    reference: ViewPoint,
    /// Directions of the scene's own views.
    views_deg: Vec<[f64; 2]>,
    /// Finest level that can be computed for the layers.
    finest: usize,
    /// Index of the medium of the angles.
    angle_index: f64,
}

/// Views of all computed directions, `[theta][phi]`.
struct Rows {
    views: Vec<Vec<ConeView>>,
    /// Relative errors of each state's Y.
    errors: OfStates<f64>,
    /// Whether each state's Y is too faint for adding.
    unresolved: OfStates<bool>,
    nodes: u64,
    /// False if a colour is not a number.
    is_finite: bool,
}

/// Tristimulus values of each direction and state.
type Colours = Vec<Vec<Xyz>>;

/// Of each inclination, azimuth and state.
type OfStates<T> = Vec<Vec<Vec<T>>>;

/// Tristimulus values of all directions at one level.
struct Level {
    reference: Vec<Xyz>,
    /// `[theta][phi]`, of the computed azimuths.
    rows: Vec<Colours>,
    nodes: u64,
}

impl Survey<'_> {
    /// `None` if it was stopped.
    fn run(self, pool: Option<&ThreadPool>) -> Option<Result<ConeResult, DisplayError>> {
        let target = target(self.run.scene);
        let [theta_deg, _] = self.grid.reference_deg;
        if !self.is_known(theta_deg) {
            return Some(Err(DisplayError::UnknownReference { theta_deg }));
        }
        let Rows { views: rows, errors, unresolved, nodes, is_finite } = match self.run.setup.stack.panel() {
            Some(_) => self.of_panel(target, pool)?,
            None => self.of_layers(target, pool)?,
        };
        if !is_finite {
            return Some(Err(DisplayError::NotFinite));
        }
        let computed = self.computed();
        let place = |phi: usize| computed.iter().position(|one| *one == self.equivalent[phi]);
        let places: Vec<usize> = (0..self.grid.phi_deg.len()).filter_map(place).collect();
        let known = self.known();
        let view = |theta: usize, phi: usize| match known.get(theta) {
            Some(true) => rows[theta][phi].clone(),
            _ => ConeView::unknown(self.run.setup.states.len()),
        };
        let error = |theta: usize, phi: usize| match known.get(theta) {
            Some(true) => {
                let errors = errors[theta][phi].iter().zip(&unresolved[theta][phi]);
                errors.map(|(error, unresolved)| if *unresolved { 0.0 } else { *error }).collect()
            }
            _ => vec![0.0; self.run.setup.states.len()],
        };
        let directions = || places.iter().flat_map(|phi| (0..rows.len()).map(move |theta| (theta, *phi)));
        let views = places.iter().flat_map(|phi| (0..rows.len()).map(|theta| view(theta, *phi))).collect();
        let by_adding = always_by_adding(self.run.scene, "the maps are");
        let mut warnings: Vec<String> =
            by_adding.into_iter().chain(self.mirror_images()).chain(self.blank(&known)).collect();
        let is_faint = |(theta, phi): (usize, usize)| -> Vec<bool> {
            unresolved[theta][phi].iter().map(|faint| *faint && known.get(theta) == Some(&true)).collect()
        };
        let faint: Vec<bool> = directions().flat_map(is_faint).collect();
        warnings.extend(too_faint(&faint));
        let relative: Vec<f64> = directions().flat_map(|(theta, phi)| error(theta, phi)).collect();
        let worst = relative.iter().copied().fold(0.0, largest);
        if worst > target {
            warnings.push(format!(
                "relative error {worst:.2e} instead of {target:.2e}: adding's finest level is reached"
            ));
        }
        Some(Ok(ConeResult {
            states: self.run.setup.states.clone(),
            views,
            lights: self.run.scene.lighting.directed.iter().map(light).collect(),
            views_deg: self.views_deg,
            nodes,
            discretisation_error: worst,
            row_errors: RowErrors { relative, target, allowed: None },
            warnings,
            reference_deg: self.grid.reference_deg,
            reference_white: self.run.meter.reference_white(),
            theta_deg: self.grid.theta_deg,
            phi_deg: self.grid.phi_deg,
        }))
    }

    /// Computes the directions of a panel. Its kernels resolve the lobes in all directions: the error of the
    /// sample applies to all of them.
    fn of_panel(&self, target: f64, pool: Option<&ThreadPool>) -> Option<Rows> {
        let mut kernel = Kernel::new(0);
        let sample = self.sample(target, &mut kernel)?;
        let (rows, nodes) = self.all(kernel, (sample.level, [SAMPLE, 1.0]), pool)?;
        let states = self.run.setup.states.len();
        let errors = rows.iter().map(|row| vec![vec![sample.error; states]; row.len()]).collect();
        let negative = |colours: &Vec<Xyz>| -> Vec<bool> { colours.iter().map(|xyz| xyz.y < 0.0).collect() };
        let unresolved = rows.iter().map(|row| row.iter().map(negative).collect()).collect();
        Some(self.rows((&rows, nodes), (sample.finer[0].clone(), errors, unresolved), pool))
    }

    /// Computes the directions of general layers. Light near the horizon may vary faster than in any sampled
    /// direction: each row is compared with that of the previous level. The light in the layers, which takes
    /// most of the time, is computed once for all directions, so that a sample of them would take as long as
    /// all.
    fn of_layers(&self, target: f64, pool: Option<&ThreadPool>) -> Option<Rows> {
        let setup = self.run.setup;
        let bound = error_over_difference(&setup.stack, &setup.sources);
        let computed = self.computed();
        let places = self.sampled().into_iter().filter_map(|view| {
            let (phi, theta) = (view / self.grid.theta_deg.len(), view % self.grid.theta_deg.len());
            computed.iter().position(|one| *one == phi).map(|place| (theta, place))
        });
        let places: Vec<(usize, usize)> = places.collect();
        let sample = |level: &Level| -> Vec<f64> {
            let sampled = places.iter().map(|(theta, place)| &level.rows[*theta][*place]);
            std::iter::once(&level.reference).chain(sampled).flatten().map(|xyz| xyz.y).collect()
        };
        let errors = |[finer, coarser]: [&Level; 2], before: Option<&Level>| {
            let all = [finer, coarser].map(sample);
            let before = before.map(sample);
            let times = bound.max(slowness(all.each_ref().map(Vec::as_slice), before.as_deref()));
            (of_levels(bound, all, before.as_deref()), self.row_errors([finer, coarser], times))
        };
        let error = |levels: [&Level; 2], before: Option<&Level>| {
            let (sampled, rows) = errors(levels, before);
            let finite = rows.into_iter().flatten().flatten().filter(|error| error.is_finite());
            finite.fold(sampled, largest)
        };
        let at = |level: usize| self.level(level, pool);
        let refined = refine(target, self.finest, bound, at, error, |_, _| {})?;
        refined.finished.then_some(())?;
        let (_, errors) = errors([&refined.finer, &refined.coarser], refined.before.as_ref());
        let (unresolved, of_reference) = unresolved_rows(&refined.finer, &refined.coarser, &errors);
        let Level { reference, rows, nodes } = &refined.finer;
        let reference = masked(reference, &of_reference);
        Some(self.rows((rows, *nodes), (reference, errors, unresolved), pool))
    }

    /// Computes the entries of these directions, compared with those of the reference direction; `unresolved` ones
    /// have no values.
    fn rows(
        &self,
        (rows, nodes): (&[Colours], u64),
        (reference, errors, unresolved): (Vec<Xyz>, OfStates<f64>, OfStates<bool>),
        pool: Option<&ThreadPool>,
    ) -> Rows {
        let is_finite = rows.iter().flatten().flatten().all(|xyz| xyz.x.is_finite() && xyz.y.is_finite());
        let mask = |(colours, unresolved): (&Vec<Xyz>, &Vec<bool>)| masked(colours, unresolved);
        let of_row = |(row, unresolved): (&Colours, &Vec<Vec<bool>>)| -> Colours {
            row.iter().zip(unresolved).map(mask).collect()
        };
        let resolved: Vec<Colours> = rows.iter().zip(&unresolved).map(of_row).collect();
        Rows { views: self.views(&resolved, &reference, pool), errors, unresolved, nodes, is_finite }
    }

    /// Computes all directions of general layers at a level; `None` if it was stopped.
    fn level(&self, level: usize, pool: Option<&ThreadPool>) -> Option<Level> {
        let part = part_of_pass(level as u32);
        let (mut rows, nodes) = self.all(Kernel::new(level as u32), (level, part), pool)?;
        let reference = rows.pop()?.pop()?;
        Some(Level { reference, rows, nodes })
    }

    /// Computes the relative error of each state's Y, `[theta][phi][state]`, at the finer of two levels.
    fn row_errors(&self, [finer, coarser]: [&Level; 2], times: f64) -> OfStates<f64> {
        let y = |colours: &Vec<Xyz>| -> Vec<f64> { colours.iter().map(|xyz| xyz.y).collect() };
        let all: Vec<Vec<f64>> = finer.rows.iter().flatten().map(y).collect();
        let most = largest_of_states(all.iter().map(Vec::as_slice), self.run.setup.states.len());
        let of = |(one, coarser): (&Vec<Xyz>, &Vec<Xyz>)| row_errors(&y(one), &y(coarser), &most, times);
        let of_row = |(row, coarser): (&Colours, &Colours)| row.iter().zip(coarser).map(of).collect();
        finer.rows.iter().zip(&coarser.rows).map(of_row).collect()
    }

    /// Computes the entries of these directions, compared with the reference direction.
    fn views(&self, rows: &[Colours], reference: &[Xyz], pool: Option<&ThreadPool>) -> Vec<Vec<ConeView>> {
        let mut rows: Vec<&Colours> = rows.iter().collect();
        let view = |colours: &Vec<Xyz>| self.run.meter.cone_view(colours, reference);
        each(pool, &mut rows, |(_, row)| row.iter().map(view).collect())
    }

    /// Returns for each inclination whether the uppermost scattering interface was measured there. Elsewhere,
    /// other light, such as the reflection of the front, does not represent the display.
    fn known(&self) -> Vec<bool> {
        self.grid.theta_deg.iter().map(|theta| self.is_known(*theta)).collect()
    }

    fn is_known(&self, theta_deg: f64) -> bool {
        let reach = self.run.setup.stack.known_within().unwrap_or(f64::INFINITY);
        self.angle_index * theta_deg.to_radians().sin() <= reach * (1.0 + 1e-9)
    }

    fn blank(&self, known: &[bool]) -> Option<String> {
        let last = self.grid.theta_deg.iter().zip(known).filter(|(_, known)| **known).map(|(theta, _)| theta);
        let last = last.copied().fold(0.0, f64::max);
        known.contains(&false).then(|| {
            format!(
                "there are no measurements beyond {last} deg: the maps are blank there, and values are omitted"
            )
        })
    }

    /// Returns one warning for all directions that look into the mirror image of a beam.
    fn mirror_images(&self) -> Option<String> {
        let specular = self.run.specular();
        let looking = self.run.looking_into(&specular).len();
        (looking > 0).then(|| {
            format!(
                "{looking} of {} directions look into the mirror image of a directed source: without radius_deg its \
                 radiance is not defined, and the maps do not show its image",
                self.run.setup.views.len()
            )
        })
    }

    /// Computes a sample of directions, the reference direction first; leaves the kernel that met the target
    /// in `kernel`.
    fn sample(&self, target: f64, kernel: &mut Kernel) -> Option<Refined<Colours>> {
        let setup = self.run.setup;
        let fields: Vec<Cone> = std::iter::once(self.reference.field)
            .chain(self.sampled().into_iter().map(|view| setup.views[view].field))
            .collect();
        let mut last = 0;
        let at = |level: usize| {
            if self.run.control.stopped() {
                return None;
            }
            last = level;
            *kernel = Kernel::new(level as u32);
            kernel
                .prepare_unless(&setup.stack, &fields, &setup.sources, self.run.control.stop)
                .then_some(())?;
            (0..fields.len()).map(|view| self.colours(kernel, view)).collect()
        };
        let bound = error_over_difference(&setup.stack, &setup.sources);
        let error = |levels: [&Colours; 2], before: Option<&Colours>| {
            of_levels(bound, levels.map(luminous), before.map(luminous).as_deref())
        };
        let refined =
            refine(target, self.finest, bound, at, error, |error, _| self.report_sample(error, target))?;
        // A level that fluctuates more than one before is computed, but not used.
        if refined.level != last {
            *kernel = Kernel::new(refined.level as u32);
        }
        Some(refined)
    }

    /// Computes the colours of a view; `None` if it was stopped.
    fn colours(&self, kernel: &Kernel, view: usize) -> Option<Vec<Xyz>> {
        let (stack, stop) = (&self.run.setup.stack, self.run.control.stop);
        let rho = match stack.panel() {
            // Without a ledger.
            Some(_) => kernel.seen(stack, view),
            None => kernel.estimate_unless(stack, view, stop)?.rho,
        };
        Some(self.run.meter.colours(&rho))
    }

    /// Reports the error of the sample.
    fn report_sample(&self, relative_error: f64, target: f64) {
        let progress = self.directions(0).with_error(relative_error, target).within([0.0, SAMPLE]);
        (self.run.control.progress)(progress);
    }

    /// Progress in the directions of the maps.
    fn directions(&self, done: usize) -> Progress<'static> {
        Progress { unit: "directions", ..Progress::of_views(done, self.run.setup.views.len()) }
    }

    /// Computes all inclinations at the selected azimuths, `[theta][phi]`; of general layers also, as a last
    /// row, the reference direction. Returns the colours and the number of nodes. `part` is the part of the
    /// progress that this is.
    fn all(
        &self,
        mut kernel: Kernel,
        (level, part): (usize, [f64; 2]),
        pool: Option<&ThreadPool>,
    ) -> Option<(Vec<Colours>, u64)> {
        let setup = self.run.setup;
        let computed = self.computed();
        let thetas = self.grid.theta_deg.len();
        // The operators of general layers are shared because they are expensive, and so is what all views of
        // a panel have in common. The rest of a panel's kernel is cheap: each inclination has its own.
        let shared = setup.stack.panel().is_none();
        let fields = |theta: usize| -> Vec<Cone> {
            let of_phi = |phi: &usize| setup.views[phi * thetas + theta].field;
            if theta < thetas { computed.iter().map(of_phi).collect() } else { vec![self.reference.field] }
        };
        // What all azimuths have in common then takes gigabytes.
        let one_by_one = has_rings_apart(setup);
        let count = thetas + usize::from(shared);
        let every: Vec<Cone> = (0..count).flat_map(fields).collect();
        let stop = self.run.control.stop;
        let states = setup.states.len();
        let known = |theta: usize| {
            let numbers = self.saved.find(row_number(Kind::Row, level, theta))?;
            row_of(&numbers, if theta < thetas { computed.len() } else { 1 }, states)
        };
        let mut rows: Vec<Option<(Colours, u64)>> = (0..count).map(known).collect();
        let ready = if rows.iter().all(Option::is_some) {
            true
        } else if shared {
            kernel = kernel.without_ledger();
            kernel.prepare_unless(&setup.stack, &every, &setup.sources, stop)
        } else {
            kernel.prepare_common(&setup.stack, &every, &setup.sources, stop)
        };
        ready.then_some(())?;
        let done = AtomicUsize::new(0);
        let row = |(theta, row): (usize, &mut Option<(Colours, u64)>)| {
            let report = || {
                let more = if theta < thetas { self.grid.phi_deg.len() } else { 0 };
                let done = done.fetch_add(more, Ordering::Relaxed) + more;
                (self.run.control.progress)(self.directions(done).within(part));
                Some(())
            };
            if row.is_some() {
                return report();
            }
            let fields = fields(theta);
            let colours = |kernel: &Kernel, view: usize| {
                if self.run.control.stopped() { None } else { self.colours(kernel, view) }
            };
            let (found, nodes) = if shared {
                let first = theta * computed.len();
                let found =
                    (0..fields.len()).map(|k| colours(&kernel, first + k)).collect::<Option<Colours>>()?;
                // Those of general layers are the same for all rows.
                (found, kernel.nodes() as u64)
            } else {
                let (mut found, mut nodes) = (Colours::new(), 0);
                for fields in fields.chunks(if one_by_one { 1 } else { fields.len().max(1) }) {
                    let mut own = kernel.unprepared();
                    own.prepare_part(&kernel, &setup.stack, fields, &setup.sources, stop).then_some(())?;
                    for k in 0..fields.len() {
                        found.push(colours(&own, k)?);
                    }
                    nodes += own.nodes() as u64;
                }
                (found, nodes)
            };
            self.saved.save(row_number(Kind::Row, level, theta), &numbers_of(&found, nodes));
            *row = Some((found, nodes));
            report()
        };
        each(pool, &mut rows, row).into_iter().collect::<Option<Vec<()>>>()?;
        let (rows, nodes): (Vec<_>, Vec<u64>) = rows.into_iter().flatten().unzip();
        let nodes = if shared { nodes.first().copied().unwrap_or(0) } else { nodes.into_iter().sum() };
        Some((rows, nodes))
    }

    /// Returns the azimuths that are computed; each other azimuth is equivalent to one of them.
    fn computed(&self) -> Vec<usize> {
        (0..self.equivalent.len()).filter(|phi| self.equivalent[*phi] == *phi).collect()
    }

    /// Returns the numbers of about twenty views: spread over the grid, and at the mirror images of sources.
    fn sampled(&self) -> Vec<usize> {
        let (thetas, azimuths) = (self.grid.theta_deg.len(), self.computed());
        if thetas == 0 || azimuths.is_empty() {
            return Vec::new();
        }
        let spread = |count: usize, parts: usize| (0..parts).map(move |k| k * (count - 1) / (parts - 1));
        let mut views: Vec<usize> = spread(thetas, 6)
            .flat_map(|theta| spread(azimuths.len(), 3).map(move |phi| (theta, phi)))
            .map(|(theta, phi)| azimuths[phi] * thetas + theta)
            .collect();
        for light in &self.run.scene.lighting.directed {
            let image = light.phi_deg + if light.theta_deg < 0.0 { 0.0 } else { 180.0 };
            let theta = nearest(&self.grid.theta_deg, |theta| (theta - light.theta_deg.abs()).abs());
            let phi = nearest(&self.grid.phi_deg, |phi| between(phi, image));
            views.push(self.equivalent[phi] * thetas + theta);
        }
        views.sort_unstable();
        views.dedup();
        views
    }
}

/// Returns the colours of the states, without those that are not resolved.
fn masked(colours: &[Xyz], unresolved: &[bool]) -> Vec<Xyz> {
    let nothing = Xyz { x: f64::NAN, y: f64::NAN, z: f64::NAN };
    colours.iter().zip(unresolved).map(|(xyz, unresolved)| if *unresolved { nothing } else { *xyz }).collect()
}

/// Returns which states adding does not resolve, `[theta][phi][state]` and of the reference direction, given the
/// finer of two levels and the relative errors of its rows.
fn unresolved_rows(finer: &Level, coarser: &Level, errors: &[Vec<Vec<f64>>]) -> (OfStates<bool>, Vec<bool>) {
    let y = |colours: &Vec<Xyz>| -> Vec<f64> { colours.iter().map(|xyz| xyz.y).collect() };
    let all: Vec<Vec<f64>> = finer.rows.iter().flatten().map(y).collect();
    let most = largest_of_states(all.iter().map(Vec::as_slice), finer.reference.len());
    let of_rows = unresolved(&all, &errors.concat(), &most);
    // The reference direction is beside the map: its difference is that of the levels.
    let [reference, before] = [&finer.reference, &coarser.reference].map(y);
    let of_reference =
        unresolved(std::slice::from_ref(&reference), &[row_errors(&reference, &before, &most, 1.0)], &most);
    let mut rest = of_rows.into_iter();
    let rows = finer.rows.iter().map(|row| rest.by_ref().take(row.len()).collect()).collect();
    (rows, of_reference.concat())
}

/// Returns one warning for all states and directions that adding does not resolve.
fn too_faint(unresolved: &[bool]) -> Option<String> {
    let count = unresolved.iter().filter(|unresolved| **unresolved).count();
    (count > 0).then(|| {
        format!(
            "{count} of {} values of Y are too faint for adding beside the brightest of their state: they are left out, with what depends on \
             them; solver.method = \"monte-carlo\" computes single views",
            unresolved.len()
        )
    })
}

/// All numbers of a row, to be saved.
fn numbers_of(row: &Colours, nodes: u64) -> Vec<f64> {
    let colours = row.iter().flatten().flat_map(|xyz| [xyz.x, xyz.y, xyz.z]);
    std::iter::once(nodes as f64).chain(colours).collect()
}

/// Reads [`numbers_of`] a row of this many directions and states; `None` if there are others.
fn row_of(numbers: &[f64], directions: usize, states: usize) -> Option<(Colours, u64)> {
    let (nodes, colours) = numbers.split_first()?;
    let (colours, rest) = colours.as_chunks::<3>();
    let all: Vec<Xyz> = colours.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z }).collect();
    let fits = rest.is_empty() && all.len() == directions * states && states > 0;
    fits.then(|| (all.chunks(states).map(<[Xyz]>::to_vec).collect(), *nodes as u64))
}

/// Returns Y of all states and directions.
fn luminous(colours: &Colours) -> Vec<f64> {
    colours.iter().flatten().map(|xyz| xyz.y).collect()
}

fn light(light: &DirectedLight) -> ConeLight {
    ConeLight {
        theta_deg: light.theta_deg,
        phi_deg: light.phi_deg,
        radius_deg: light.radius_deg.unwrap_or(0.0),
    }
}

/// Returns the first equivalent azimuth for each azimuth: the mirror image in the
/// plane of the lights, any azimuth without directed lights, or itself if the lights lie in several planes, an
/// environment or a polarised light along the normal depends on azimuth, or a polariser or light between s and p has
/// another mirror image.
fn equivalent_azimuths(phi_deg: &[f64], light: &Lighting, polariser_deg: Option<f64>) -> Vec<usize> {
    let mut parts = light.environment.iter().flat_map(|environment| &environment.parts);
    let is_polarised_from_above = |lamp: &DirectedLight| lamp.theta_deg == 0.0 && lamp.vibration.is_some();
    let is_turned = |part: &EnvironmentPart| !part.field.is_ring() || part.vibration.is_some();
    if parts.any(is_turned) || light.directed.iter().any(is_polarised_from_above) {
        return (0..phi_deg.len()).collect();
    }
    let mut vibrations = light.directed.iter().filter_map(|lamp| lamp.vibration.as_ref());
    let is_oblique = polariser_deg.is_some_and(is_oblique) || vibrations.any(is_between_s_and_p);
    let same = |a: f64, b: f64| between(a, b) < 1e-9;
    let mut planes = light.directed.iter().filter(|light| light.theta_deg != 0.0).map(|light| light.phi_deg);
    let Some(plane) = planes.next() else { return vec![0; phi_deg.len()] };
    let one_plane = planes.all(|phi| same(2.0 * phi, 2.0 * plane)) && !is_oblique;
    let first = |phi: f64| {
        let is_equivalent = |other: &f64| same(*other, phi) || (one_plane && same(*other, 2.0 * plane - phi));
        phi_deg.iter().position(is_equivalent).unwrap_or_default()
    };
    phi_deg.iter().map(|phi| first(*phi)).collect()
}

/// Returns the angle between two azimuths, degrees.
fn between(a_deg: f64, b_deg: f64) -> f64 {
    let turn = (a_deg - b_deg).rem_euclid(360.0);
    turn.min(360.0 - turn)
}

/// Returns the index of the value with the smallest distance.
fn nearest(values: &[f64], distance: impl Fn(f64) -> f64) -> usize {
    let mut best = 0;
    for (k, value) in values.iter().enumerate() {
        if distance(*value) < distance(values[best]) {
            best = k;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Vibration;
    use papilio_spectra::Spectrum;

    fn from(theta_deg: f64, phi_deg: f64) -> DirectedLight {
        let spectrum = Spectrum::from_values(vec![]).into();
        DirectedLight {
            theta_deg,
            phi_deg,
            share: 0.1,
            spectrum,
            radius_deg: None,
            normal_to_beam: false,
            vibration: None,
        }
    }

    #[test]
    fn equivalent_azimuths_are_mirror_images_in_the_plane_of_the_lights() {
        let through = |polariser_deg: Option<f64>, directed: &[DirectedLight]| {
            let (diffuse_spectrum, environment) = (Spectrum::from_values(vec![]).into(), vec![]);
            let directed = directed.to_vec();
            let light = Lighting {
                illuminance_lx: 1.0,
                diffuse: 0.0,
                diffuse_spectrum,
                directed,
                environment,
                front_light: None,
                port: None,
            };
            equivalent_azimuths(&[0.0, 90.0, 180.0, 270.0], &light, polariser_deg)
        };
        let looks = |directed: &[DirectedLight]| through(None, directed);
        assert_eq!(looks(&[]), [0, 0, 0, 0]);
        assert_eq!(looks(&[from(0.0, 33.0)]), [0, 0, 0, 0]);
        assert_eq!(looks(&[from(-20.0, 0.0)]), [0, 1, 2, 1]);
        assert_eq!(looks(&[from(20.0, 90.0), from(40.0, 270.0), from(0.0, 1.0)]), [0, 1, 0, 3]);
        assert_eq!(looks(&[from(20.0, 45.0)]), [0, 0, 2, 2]);
        assert_eq!(looks(&[from(20.0, 10.0)]), [0, 1, 2, 3]);
        assert_eq!(looks(&[from(20.0, 0.0), from(20.0, 90.0)]), [0, 1, 2, 3]);
        // Polarisers across or along the plane of the view are their own mirror images.
        assert_eq!(through(Some(90.0), &[from(20.0, 0.0)]), [0, 1, 2, 1]);
        assert_eq!(through(Some(30.0), &[from(20.0, 0.0)]), [0, 1, 2, 3]);
        assert_eq!(through(Some(30.0), &[]), [0, 0, 0, 0]);
        let polarised = |light: DirectedLight, angle_deg: f64| {
            let vibration = Vibration::Fixed { degree: 1.0, angle: angle_deg.to_radians() };
            DirectedLight { vibration: Some(vibration), ..light }
        };
        assert_eq!(looks(&[polarised(from(20.0, 0.0), 90.0)]), [0, 1, 2, 1]);
        assert_eq!(looks(&[polarised(from(20.0, 0.0), 45.0)]), [0, 1, 2, 3]);
        assert_eq!(looks(&[polarised(from(0.0, 0.0), 0.0)]), [0, 1, 2, 3]);
    }
}
