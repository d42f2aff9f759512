//! Runs by adding: finer levels of discretisation until two successive levels agree.
//!
//! The result is that of the finer level, and the difference between the two levels is its reported error.
//! Views of an ordinary panel stop each at its own level; what does not depend on the view is prepared once
//! for each level. Views through general layers share the operators of the layers, which dominate the cost:
//! all of them are computed at the level that the worst view needs.
//!
//! **First answers.** A prepared display can first compute two coarser levels ([`Accuracy::First`]), whose
//! difference is its error in the same way. They do not change what the exact answer is: its levels begin at
//! 0.
//!
//! **Caches.** A [`Level`] keeps its kernel and its estimates between runs. The counters of
//! [`Setup`](crate::setup::Setup) (`version`, `base_version`) tell whether they are still valid.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use papilio_transport::adding::{FINEST, FIRST_LEVELS, Kernel, error_over_difference};
use papilio_transport::{Cone, Estimate};
use rayon::ThreadPool;

use super::refine::{Refined, finest, largest, refine, refine_or_fail};
use super::{Accuracy, Control, Progress, Run, each};
use crate::DisplayError;
use crate::meter::{Sample, SampleOfSums};
use crate::result::{RunResult, SolverReport};
use crate::scene::Stop;
use crate::setup::{Setup, ViewPoint};

/// Cached kernels of a display.
#[derive(Debug, Default)]
pub(crate) struct Kernels {
    /// Levels of each group of views that share kernels.
    groups: Vec<Levels>,
    /// For each level the data that all views of a panel share.
    common: Common,
}

/// Data that all views of a panel share, by level. Views are computed in parallel: the first one that needs a
/// level prepares its data, and the others wait for it.
#[derive(Debug)]
struct Common(Vec<Mutex<CommonLevel>>);

#[derive(Debug)]
struct CommonLevel {
    kernel: Kernel,
    /// `(version, base_version)` of the setup for which it was prepared.
    prepared_for: Option<(u64, u64)>,
}

impl Default for Common {
    fn default() -> Self {
        let level = |index| Mutex::new(CommonLevel { kernel: empty_kernel(index), prepared_for: None });
        Self((0..=(FIRST_LEVELS + FINEST) as usize).map(level).collect())
    }
}

impl Common {
    /// Returns the data of a level by its index in [`Levels`], prepared for a setup; `None` if the run was
    /// stopped.
    fn at(&self, index: usize, setup: &Setup, control: &Control<'_>) -> Option<Kernel> {
        let common = self.0.get(index)?;
        // A panic in another thread leaves a kernel that is not marked as prepared.
        let mut common = common.lock().unwrap_or_else(PoisonError::into_inner);
        let versions = (setup.version, setup.base_version);
        if common.prepared_for != Some(versions) {
            let views: Vec<Cone> = setup.views.iter().map(|view| view.field).collect();
            common.prepared_for = None;
            let ready = common.kernel.prepare_common(&setup.stack, &views, &setup.sources, control.stop);
            ready.then_some(())?;
            common.prepared_for = Some(versions);
        }
        Some(common.kernel.clone())
    }
}

impl Kernels {
    /// Removes everything.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }
}

/// Largest relative error of Y with which a first answer stops before its last level.
const FIRST_ERROR: f64 = 0.05;

/// Cached levels of a group of views, starting with the coarsest: those of a first answer, then level 0.
type Levels = Vec<Level>;

/// Returns an empty kernel of the level with this index in [`Levels`].
fn empty_kernel(index: usize) -> Kernel {
    let index = index as u32;
    match index.checked_sub(FIRST_LEVELS) {
        Some(level) => Kernel::new(level),
        None => Kernel::first(index),
    }
}

/// One level of discretisation: its kernel and the estimates computed with it.
#[derive(Debug)]
pub(crate) struct Level {
    /// Its index in [`Levels`].
    index: usize,
    kernel: Kernel,
    /// `Setup::version` for which the kernel was prepared; `None` before the first, or after an interrupted,
    /// preparation.
    prepared_for: Option<u64>,
    /// Estimates of all views, with the `(version, base_version)` of the setup for which they were computed.
    estimates: Option<((u64, u64), Vec<Estimate>)>,
}

impl Level {
    /// An empty level; `index` is that in [`Levels`].
    fn new(index: usize) -> Self {
        Self { index, kernel: empty_kernel(index), prepared_for: None, estimates: None }
    }

    /// Returns the estimates of these views, from the cache if neither version of the setup has changed;
    /// `None` if the run was stopped. A change of spectra and illuminances alone does not invalidate them.
    fn estimates(
        &mut self,
        (setup, common): (&Setup, &Common),
        views: &[ViewPoint],
        pool: Option<&ThreadPool>,
        control: &Control<'_>,
    ) -> Option<&[Estimate]> {
        let versions = (setup.version, setup.base_version);
        if self.estimates.as_ref().is_none_or(|(of, _)| *of != versions) {
            // Releases the memory before the new estimates are computed.
            self.estimates = None;
            let kernel = self.kernel_for((setup, common), views, control)?;
            let mut estimates = vec![None; views.len()];
            each(pool, &mut estimates, |(view, estimate)| {
                if !control.stopped() {
                    *estimate = kernel.estimate_unless(&setup.stack, view, control.stop);
                }
            });
            self.estimates = Some((versions, estimates.into_iter().collect::<Option<_>>()?));
        }
        self.estimates.as_ref().map(|(_, estimates)| estimates.as_slice())
    }

    /// Returns the kernel, prepared for these views of the setup; `None` if the run was stopped.
    fn kernel_for(
        &mut self,
        (setup, common): (&Setup, &Common),
        views: &[ViewPoint],
        control: &Control<'_>,
    ) -> Option<&Kernel> {
        let fields = || views.iter().map(|view| view.field).collect::<Vec<Cone>>();
        let (stack, sources) = (&setup.stack, &setup.sources);
        match stack.panel() {
            // The kernel depends on the base, and decides itself during the preparation what can be reused.
            Some(_) => {
                let common = common.at(self.index, setup, control)?;
                let ready = self.kernel.prepare_part(&common, stack, &fields(), sources, control.stop);
                ready.then_some(())?;
            }
            // Operators hardly depend on the base.
            None => {
                if self.prepared_for != Some(setup.version) || !self.kernel.serves(stack) {
                    self.prepared_for = None;
                    let ready = self.kernel.prepare_unless(stack, &fields(), sources, control.stop);
                    ready.then_some(())?;
                    self.prepared_for = Some(setup.version);
                }
            }
        }
        Some(&self.kernel)
    }
}

/// Runs a scene, with its views in parallel if there is a thread pool.
pub(super) fn run(
    run: &Run<'_>,
    kernels: &mut Kernels,
    pool: Option<&ThreadPool>,
) -> Result<RunResult, DisplayError> {
    let views = &run.setup.views;
    let Kernels { groups, common } = kernels;
    let runner = Runner::new(run, common, finest(run.setup)?)?;
    let groups: Vec<Option<Group>> = match run.setup.stack.panel() {
        Some(_) => {
            groups.resize_with(views.len(), Vec::new);
            let one = |(view, levels): (usize, &mut Levels)| runner.refine(levels, &views[view..=view], None);
            each(pool, groups, one)
        }
        None => {
            groups.resize_with(1, Vec::new);
            groups.iter_mut().map(|levels| runner.refine(levels, views, pool)).collect()
        }
    };
    runner.result(&groups)
}

/// Runs a scene whose samples of all views at a level do not come from kernels of its stack.
pub(super) fn run_levels(
    run: &Run<'_>,
    finest: usize,
    at: impl FnMut(usize) -> Result<Vec<SampleOfSums>, DisplayError>,
    nodes: impl Fn() -> u64,
) -> Result<RunResult, DisplayError> {
    let common = Common::default();
    let runner = Runner::new(run, &common, finest)?;
    let means = |level: &Vec<SampleOfSums>| level.iter().map(|one| one.mean.clone()).collect::<Vec<_>>();
    let error = |[finer, coarser]: [&Vec<SampleOfSums>; 2], before: Option<&Vec<SampleOfSums>>| {
        let of_levels = runner.error([&means(finer), &means(coarser)], before.map(means).as_ref());
        let of_sums = finer.iter().map(|one| run.meter.error_of_sums(one, runner.per_wavelength));
        of_sums.fold(of_levels, largest)
    };
    let views = run.setup.views.len();
    let report = |error, done| runner.report(error, if done { views } else { 0 });
    let found = refine_or_fail(runner.target, finest, runner.times(), at, error, report)?;
    let least = found.finer.iter().map(|one| run.meter.error_of_sums(one, false)).collect();
    let samples = Refined {
        finer: means(&found.finer),
        coarser: means(&found.coarser),
        before: found.before.as_ref().map(means),
        level: found.level,
        error: found.error,
        raised: found.raised,
        finished: found.finished,
    };
    runner.result(&[Some(Group { samples, nodes: nodes() as usize, least })])
}

/// Kernel of a group of views, with the range of these views.
#[derive(Debug)]
pub(crate) struct ViewGroupKernel {
    pub(crate) kernel: Kernel,
    pub(crate) views: Range<usize>,
}

/// Returns, for each group of views that share a kernel, the kernel at the level that meets the scene's
/// target.
pub(super) fn view_group_kernels(run: &Run<'_>) -> Result<Vec<ViewGroupKernel>, DisplayError> {
    let common = Common::default();
    let runner = Runner::new(run, &common, finest(run.setup)?)?;
    let views = &run.setup.views;
    let each = match run.setup.stack.panel() {
        Some(_) => 1,
        None => views.len(),
    };
    let group_kernel = |(number, views): (usize, &[ViewPoint])| {
        let mut levels = Levels::new();
        let group = runner.refine(&mut levels, views, None).filter(|group| group.samples.finished);
        let level = runner.begin + group.ok_or(DisplayError::Interrupted)?.samples.level;
        let first = number * each;
        Ok(ViewGroupKernel { kernel: levels.swap_remove(level).kernel, views: first..first + views.len() })
    };
    views.chunks(each.max(1)).enumerate().map(group_kernel).collect()
}

struct Runner<'a> {
    run: &'a Run<'a>,
    common: &'a Common,
    target: f64,
    /// Index in [`Levels`] of the coarsest level of this run.
    begin: usize,
    /// Number of the finest level, counted from that.
    finest: usize,
    per_wavelength: bool,
    views_done: AtomicUsize,
    /// The error that was reported last, as bits.
    last_error: AtomicU64,
}

/// Samples of a group of views.
struct Group {
    samples: Refined<Vec<Sample>>,
    /// Number of nodes of the finer level.
    nodes: usize,
    /// Least relative error of each view; none if that is 0.
    least: Vec<f64>,
}

impl<'a> Runner<'a> {
    fn new(run: &'a Run<'a>, common: &'a Common, finest: usize) -> Result<Self, DisplayError> {
        let Stop::RelativeError { target, per_wavelength } = run.scene.solver.stop else {
            return Err(DisplayError::NoPaths);
        };
        let first = FIRST_LEVELS as usize;
        let (begin, finest, target) = match run.accuracy {
            Accuracy::Exact => (first, finest, target),
            // The level, and the next coarser one for its error.
            Accuracy::Level(level) => ((first + level as usize).saturating_sub(1), 1, target),
            // Its last level is level 0.
            Accuracy::First => (0, first, target.max(FIRST_ERROR)),
        };
        let (views_done, last_error) = (AtomicUsize::new(0), AtomicU64::new(f64::INFINITY.to_bits()));
        Ok(Self { run, common, target, begin, finest, per_wavelength, views_done, last_error })
    }

    /// Computes finer levels until the target is met; `None` if stopped before two levels were computed.
    fn refine(&self, levels: &mut Levels, views: &[ViewPoint], pool: Option<&ThreadPool>) -> Option<Group> {
        let at = |level| self.at_level(level, levels, views, pool);
        let samples = refine(
            self.target,
            self.finest,
            self.times(),
            at,
            |levels, before| self.error(levels, before),
            |error, done| {
                self.report(error, if done { views.len() } else { 0 });
            },
        )?;
        let nodes = levels[self.begin + samples.level].kernel.nodes();
        Some(Group { nodes, samples, least: Vec::new() })
    }

    /// Computes the samples of these views at a level; `None` if the run was stopped.
    fn at_level(
        &self,
        level: usize,
        levels: &mut Levels,
        views: &[ViewPoint],
        pool: Option<&ThreadPool>,
    ) -> Option<Vec<Sample>> {
        if self.run.control.stopped() {
            return None;
        }
        let level = self.begin + level;
        for missing in levels.len()..=level {
            levels.push(Level::new(missing));
        }
        self.report_level(level);
        let setup = self.run.setup;
        let estimates = levels[level].estimates((setup, self.common), views, pool, self.run.control)?;
        Some(estimates.iter().map(|estimate| self.run.meter.sample(estimate)).collect())
    }

    /// Returns the largest relative error of all views.
    fn error(&self, [finer, coarser]: [&Vec<Sample>; 2], before: Option<&Vec<Sample>>) -> f64 {
        let error = |view: usize| {
            let before = before.map(|before| &before[view]);
            self.run.meter.level_error([&finer[view], &coarser[view]], before, self.per_wavelength)
        };
        (0..finer.len()).map(error).fold(0.0, largest)
    }

    /// Returns the smallest ratio of errors to differences of levels.
    fn times(&self) -> f64 {
        error_over_difference(&self.run.setup.stack, &self.run.setup.sources)
    }

    /// Reports the level that is computed now, which may take most of the time.
    fn report_level(&self, index: usize) {
        let done = self.views_done.load(Ordering::Relaxed);
        let level = Some(index.saturating_sub(FIRST_LEVELS as usize) as u32);
        let error = f64::from_bits(self.last_error.load(Ordering::Relaxed));
        let now = Progress { level, ..Progress::of_views(done, self.run.setup.views.len()) };
        (self.run.control.progress)(now.with_error(error, self.target));
    }

    /// Reports progress to the caller.
    fn report(&self, relative_error: f64, views_done: usize) {
        self.last_error.store(relative_error.to_bits(), Ordering::Relaxed);
        let done = self.views_done.fetch_add(views_done, Ordering::Relaxed) + views_done;
        let progress = Progress::of_views(done, self.run.setup.views.len());
        (self.run.control.progress)(progress.with_error(relative_error, self.target));
    }

    fn result(&self, groups: &[Option<Group>]) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut views = Vec::new();
        let mut points = self.run.setup.views.iter();
        // A group of a panel is a single view; general layers have one group.
        for group in groups {
            let Some(group) = group else {
                points.next();
                continue;
            };
            let Refined { finer, coarser, before, raised, .. } = &group.samples;
            for (view, ((finer, coarser), at)) in finer.iter().zip(coarser).zip(&mut points).enumerate() {
                if !finer.is_finite() {
                    return Err(DisplayError::NotFinite);
                }
                let before = before.as_ref().map(|before| &before[view]);
                let least = group.least.get(view).copied().unwrap_or(0.0);
                let seen = self.run.meter.view_of_levels(
                    at,
                    [finer, coarser],
                    (before, *raised),
                    (&specular, least),
                );
                views.push(seen);
            }
        }
        if views.is_empty() {
            return Err(DisplayError::Interrupted);
        }
        let computed = || groups.iter().flatten();
        let solver = SolverReport {
            method: "adding".to_owned(),
            chosen_because: None,
            paths: None,
            nodes: Some(computed().map(|group| group.nodes as u64).sum()),
            level: computed()
                .map(|group| (self.begin + group.samples.level).saturating_sub(FIRST_LEVELS as usize) as u32)
                .max(),
            degrees_of_freedom: 0,
            target: None,
            is_final: self.run.accuracy != Accuracy::First,
            relative_error_reached: computed().map(|group| group.samples.error).fold(0.0, largest),
            interrupted: groups
                .iter()
                .any(|group| group.as_ref().is_none_or(|group| !group.samples.finished)),
        };
        Ok(self.run.result(views, solver, &specular, super::FINEST_REACHED))
    }
}
