//! Adding: level after level until two of them agree.
//!
//! The difference between two levels is the error that is reported, the finer one's numbers are the
//! result. Views of an ordinary panel are independent: each has kernels of its own and stops
//! at its own level. Views through any layers share the operators of the layers, which cost
//! most: all of them are taken to the level that the worst one needs.

use std::sync::atomic::{AtomicUsize, Ordering};

use papilio_transport::adding::{FINEST, Kernel};
use papilio_transport::{Cone, Stack};
use rayon::ThreadPool;
use rayon::prelude::*;

use super::{Progress, Run};
use crate::DisplayError;
use crate::meter::Sample;
use crate::result::{RunResult, SolverReport, View};
use crate::scene::Stop;
use crate::setup::ViewPoint;

/// Kernels that were prepared: for each group of views that share them, one of each level.
pub(crate) type Kernels = Vec<Vec<Kernel>>;

/// Runs a scene, its views in parallel if there are threads for them.
pub(super) fn run(
    run: &Run<'_>,
    kernels: &mut Kernels,
    pool: Option<&ThreadPool>,
) -> Result<RunResult, DisplayError> {
    let Stop::RelativeError { target, every_bin } = run.scene.solver.stop else {
        return Err(DisplayError::NoPaths);
    };
    let views = &run.setup.views;
    let runner = Runner { run, target, every_bin, views_done: AtomicUsize::new(0) };
    let groups: Vec<Option<Group>> = match run.setup.stack {
        Stack::Panel(_) => {
            kernels.resize_with(views.len(), Vec::new);
            let one =
                |(view, levels): (usize, &mut Vec<Kernel>)| runner.look(levels, &views[view..=view], None);
            each(pool, kernels, one)
        }
        Stack::Layered(_) => {
            kernels.resize_with(1, Vec::new);
            kernels.iter_mut().map(|levels| runner.look(levels, views, pool)).collect()
        }
    };
    runner.result(&groups)
}

/// `f` of every item and its number, in their order.
fn each<T: Send, R: Send>(
    pool: Option<&ThreadPool>,
    items: &mut [T],
    f: impl Fn((usize, &mut T)) -> R + Sync + Send,
) -> Vec<R> {
    match pool {
        None => items.iter_mut().enumerate().map(f).collect(),
        Some(pool) => pool.install(|| items.par_iter_mut().enumerate().map(f).collect()),
    }
}

struct Runner<'a> {
    run: &'a Run<'a>,
    target: f64,
    every_bin: bool,
    views_done: AtomicUsize,
}

/// What was seen of a group of views: samples of two successive levels.
struct Group {
    finer: Vec<Sample>,
    coarser: Vec<Sample>,
    /// Of the finer level.
    nodes: usize,
    relative_error: f64,
    /// Not stopped before the target or the finest level was reached.
    finished: bool,
}

impl Runner<'_> {
    /// Looks through finer and finer kernels; `None` if it was stopped before there were two.
    fn look(
        &self,
        levels: &mut Vec<Kernel>,
        views: &[ViewPoint],
        pool: Option<&ThreadPool>,
    ) -> Option<Group> {
        let coarser = self.at_level(0, levels, views, pool)?;
        let finer = self.at_level(1, levels, views, pool)?;
        let mut group = Group { finer, coarser, nodes: 0, relative_error: 0.0, finished: false };
        for level in 1.. {
            group.nodes = levels[level].nodes();
            group.relative_error = self.difference(&group);
            // An error that is not a number will not become one.
            let enough = !(group.relative_error > self.target);
            group.finished = enough || level == FINEST as usize;
            self.tell(&group);
            if group.finished {
                break;
            }
            let Some(next) = self.at_level(level + 1, levels, views, pool) else { break };
            group.coarser = std::mem::replace(&mut group.finer, next);
        }
        Some(group)
    }

    /// What is seen through the kernel of this level; `None` if the run was stopped.
    fn at_level(
        &self,
        level: usize,
        levels: &mut Vec<Kernel>,
        views: &[ViewPoint],
        pool: Option<&ThreadPool>,
    ) -> Option<Vec<Sample>> {
        if self.run.control.stopped() {
            return None;
        }
        for missing in levels.len()..=level {
            levels.push(Kernel::new(missing as u32));
        }
        let setup = self.run.setup;
        let kernel = &mut levels[level];
        let fields: Vec<Cone> = views.iter().map(|view| view.field).collect();
        kernel.prepare(&setup.stack, &fields, &setup.sources);
        let kernel = &*kernel;
        let mut samples = vec![None; views.len()];
        each(pool, &mut samples, |(view, sample)| {
            if !self.run.control.stopped() {
                *sample = Some(self.run.meter.sample(&kernel.estimate(&setup.stack, view)));
            }
        });
        samples.into_iter().collect()
    }

    fn difference(&self, group: &Group) -> f64 {
        let pairs = group.finer.iter().zip(&group.coarser);
        let errors = pairs.map(|(finer, coarser)| self.run.meter.difference(finer, coarser, self.every_bin));
        errors.fold(0.0, f64::max)
    }

    fn tell(&self, group: &Group) {
        let more = if group.finished { group.finer.len() } else { 0 };
        let done = self.views_done.fetch_add(more, Ordering::Relaxed) + more;
        (self.run.control.progress)(Progress {
            paths: None,
            share_of_paths: None,
            relative_error: group.relative_error,
            target: Some(self.target),
            views_done: (done, self.run.setup.views.len()),
        });
    }

    fn result(&self, groups: &[Option<Group>]) -> Result<RunResult, DisplayError> {
        let specular = self.run.specular();
        let mut views: Vec<View> = Vec::new();
        let mut points = self.run.setup.views.iter();
        // In a panel a group that was not seen has one view; elsewhere there is but one group.
        for group in groups {
            let Some(group) = group else {
                points.next();
                continue;
            };
            for ((finer, coarser), at) in group.finer.iter().zip(&group.coarser).zip(&mut points) {
                if !finer.is_finite() {
                    return Err(DisplayError::NotFinite);
                }
                views.push(self.run.meter.view_of_levels(at, finer, coarser, &specular));
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
            relative_error_reached: seen().map(|group| group.relative_error).fold(0.0, f64::max),
            interrupted: groups.iter().any(|group| group.as_ref().is_none_or(|group| !group.finished)),
        };
        let unreached = "adding's finest level is reached; the walk (method = \"walk\") may get closer";
        Ok(self.run.result(views, solver, &specular, unreached))
    }
}
