//! Adding: level after level until two of them agree.
//!
//! The difference between two levels is the error that is reported, the finer one's numbers are the
//! result. Views of an ordinary panel are independent: each has kernels of its own and stops
//! at its own level. Views through any layers share the operators of the layers, which cost
//! most: all of them are taken to the level that the worst one needs.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_transport::adding::Kernel;
use papilio_transport::{Cone, Estimate, Stack};
use rayon::ThreadPool;

use super::refine::{Refined, finest, largest, refine};
use super::{Control, Progress, Run, each};
use crate::DisplayError;
use crate::meter::Sample;
use crate::result::{RunResult, SolverReport};
use crate::scene::Stop;
use crate::setup::{Setup, ViewPoint};

/// Kernels that were prepared: for each group of views that share them, one of each level.
pub(crate) type Kernels = Vec<Levels>;

/// Kernels from the coarsest level on.
type Levels = Vec<Level>;

/// A kernel and the version of the setup that it was prepared for last; what was seen through it, and the
/// versions of setup and base that this was.
#[derive(Debug)]
pub(crate) struct Level {
    kernel: Kernel,
    version: Option<u64>,
    seen: Option<((u64, u64), Vec<Estimate>)>,
}

impl Level {
    fn new(level: u32) -> Self {
        Self { kernel: Kernel::new(level), version: None, seen: None }
    }

    /// What is seen of each source from these views; `None` if the run was stopped. Other spectra and illuminances
    /// need nothing new.
    fn seen(
        &mut self,
        setup: &Setup,
        views: &[ViewPoint],
        pool: Option<&ThreadPool>,
        control: &Control<'_>,
    ) -> Option<&[Estimate]> {
        let versions = (setup.version, setup.base_version);
        if self.seen.as_ref().is_none_or(|(of, _)| *of != versions) {
            // Its room serves again.
            self.seen = None;
            let kernel = self.kernel_for(setup, views, control)?;
            let mut seen = vec![None; views.len()];
            each(pool, &mut seen, |(view, seen)| {
                if !control.stopped() {
                    *seen = kernel.estimate_unless(&setup.stack, view, control.stop);
                }
            });
            self.seen = Some((versions, seen.into_iter().collect::<Option<_>>()?));
        }
        self.seen.as_ref().map(|(_, seen)| seen.as_slice())
    }

    /// The kernel, ready for these views of the setup; `None` if the run was stopped.
    fn kernel_for(&mut self, setup: &Setup, views: &[ViewPoint], control: &Control<'_>) -> Option<&Kernel> {
        // Operators of any layers know little of the base; a panel's kernel plans for it,
        // and sees for itself what it can keep.
        let serves = matches!(setup.stack, Stack::Layered(_))
            && self.version == Some(setup.version)
            && self.kernel.serves(&setup.stack);
        if !serves {
            let fields: Vec<Cone> = views.iter().map(|view| view.field).collect();
            self.version = None;
            if !self.kernel.prepare_unless(&setup.stack, &fields, &setup.sources, control.stop) {
                return None;
            }
            self.version = Some(setup.version);
        }
        Some(&self.kernel)
    }
}

/// Runs a scene, its views in parallel if there are threads for them.
pub(super) fn run(
    run: &Run<'_>,
    kernels: &mut Kernels,
    pool: Option<&ThreadPool>,
) -> Result<RunResult, DisplayError> {
    let views = &run.setup.views;
    let runner = Runner::new(run)?;
    let groups: Vec<Option<Group>> = match run.setup.stack {
        Stack::Panel(_) => {
            kernels.resize_with(views.len(), Vec::new);
            let one = |(view, levels): (usize, &mut Levels)| runner.look(levels, &views[view..=view], None);
            each(pool, kernels, one)
        }
        Stack::Layered(_) => {
            kernels.resize_with(1, Vec::new);
            kernels.iter_mut().map(|levels| runner.look(levels, views, pool)).collect()
        }
    };
    runner.result(&groups)
}

/// A kernel and the views that share it.
#[derive(Debug)]
pub(crate) struct Lens {
    pub(crate) kernel: Kernel,
    pub(crate) views: Range<usize>,
}

/// For each group of views that share one, the kernel at the level that meets the scene's target.
pub(super) fn lenses(run: &Run<'_>) -> Result<Vec<Lens>, DisplayError> {
    let runner = Runner::new(run)?;
    let views = &run.setup.views;
    let each = match run.setup.stack {
        Stack::Panel(_) => 1,
        Stack::Layered(_) => views.len(),
    };
    let lens = |(number, views): (usize, &[ViewPoint])| {
        let mut levels = Levels::new();
        let group = runner.look(&mut levels, views, None).filter(|group| group.samples.finished);
        let level = group.ok_or(DisplayError::Interrupted)?.samples.level;
        let first = number * each;
        Ok(Lens { kernel: levels.swap_remove(level).kernel, views: first..first + views.len() })
    };
    views.chunks(each.max(1)).enumerate().map(lens).collect()
}

struct Runner<'a> {
    run: &'a Run<'a>,
    target: f64,
    finest: usize,
    every_bin: bool,
    views_done: AtomicUsize,
}

/// What was seen of a group of views.
struct Group {
    samples: Refined<Vec<Sample>>,
    /// Of the finer level.
    nodes: usize,
}

impl<'a> Runner<'a> {
    fn new(run: &'a Run<'a>) -> Result<Self, DisplayError> {
        let Stop::RelativeError { target, every_bin } = run.scene.solver.stop else {
            return Err(DisplayError::NoPaths);
        };
        let finest = finest(&run.setup.stack)?;
        Ok(Self { run, target, finest, every_bin, views_done: AtomicUsize::new(0) })
    }

    /// Looks through finer and finer kernels; `None` if it was stopped before there were two.
    fn look(&self, levels: &mut Levels, views: &[ViewPoint], pool: Option<&ThreadPool>) -> Option<Group> {
        let at = |level| self.at_level(level, levels, views, pool);
        let samples = refine(
            self.target,
            self.finest,
            at,
            |levels, before| self.error(levels, before),
            |error, done| {
                self.tell(error, if done { views.len() } else { 0 });
            },
        )?;
        Some(Group { nodes: levels[samples.level].kernel.nodes(), samples })
    }

    /// What is seen through the kernel of this level; `None` if the run was stopped.
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
        for missing in levels.len()..=level {
            levels.push(Level::new(missing as u32));
        }
        let setup = self.run.setup;
        let seen = levels[level].seen(setup, views, pool, self.run.control)?;
        Some(seen.iter().map(|estimate| self.run.meter.sample(estimate)).collect())
    }

    /// The largest relative error of the views.
    fn error(&self, [finer, coarser]: [&Vec<Sample>; 2], before: Option<&Vec<Sample>>) -> f64 {
        let error = |view: usize| {
            let before = before.map(|before| &before[view]);
            self.run.meter.level_error([&finer[view], &coarser[view]], before, self.every_bin)
        };
        (0..finer.len()).map(error).fold(0.0, largest)
    }

    fn tell(&self, relative_error: f64, views_done: usize) {
        let done = self.views_done.fetch_add(views_done, Ordering::Relaxed) + views_done;
        (self.run.control.progress)(Progress {
            paths: None,
            share_of_paths: None,
            relative_error,
            target: Some(self.target),
            views_done: (done, self.run.setup.views.len()),
            so_far: None,
        });
    }

    fn result(&self, groups: &[Option<Group>]) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut views = Vec::new();
        let mut points = self.run.setup.views.iter();
        // In a panel a group that was not seen has one view; elsewhere there is but one group.
        for group in groups {
            let Some(group) = group else {
                points.next();
                continue;
            };
            let Refined { finer, coarser, before, .. } = &group.samples;
            for (view, ((finer, coarser), at)) in finer.iter().zip(coarser).zip(&mut points).enumerate() {
                if !finer.is_finite() {
                    return Err(DisplayError::NotFinite);
                }
                let before = before.as_ref().map(|before| &before[view]);
                views.push(self.run.meter.view_of_levels(at, [finer, coarser], before, &specular));
            }
        }
        if views.is_empty() {
            return Err(DisplayError::Interrupted);
        }
        let seen = || groups.iter().flatten();
        let solver = SolverReport {
            method: "adding".to_owned(),
            paths: None,
            nodes: Some(seen().map(|group| group.nodes as u64).sum()),
            degrees_of_freedom: 0,
            target: None,
            relative_error_reached: seen().map(|group| group.samples.error).fold(0.0, largest),
            interrupted: groups
                .iter()
                .any(|group| group.as_ref().is_none_or(|group| !group.samples.finished)),
        };
        Ok(self.run.result(views, solver, &specular, super::FINEST_REACHED))
    }
}
