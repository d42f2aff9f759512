//! Computation of a series of scenes that reuses results of the previous scene.

use crate::DisplayError;
use crate::result::RunResult;
use crate::run::{Accuracy, Control, Kernels, Workers, is_quick, run_setup};
use crate::scene::Scene;
use crate::setup::{Setup, Towards};

/// Prepared display with its light and views, for sweeps, optimisations and interactive programs.
///
/// [`run`](Self::run) accepts any scene and recomputes only the parts that have changed since the
/// previous one: the angular kernels of *adding* are reused as long as layers, views and sources stay the
/// same, and the film's reflectances as long as its layers and gaps stay the same. Results are bit-identical
/// to those of [`run`](crate::run()).
#[derive(Debug)]
pub struct Prepared {
    /// `None` before the first scene, and after an invalid one.
    setup: Option<Setup>,
    kernels: Kernels,
    workers: Option<Workers>,
}

impl Prepared {
    /// Prepares the computation of scenes similar to this one.
    ///
    /// # Errors
    /// If the scene is invalid, or the preparation was stopped.
    pub fn new(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        Ok(Self::of(Setup::towards(scene, Towards::Views, control)?))
    }

    /// A series of scenes similar to this one.
    pub(crate) fn of(setup: Setup) -> Self {
        Self { setup: Some(setup), ..Self::empty() }
    }

    /// A series of scenes of which none is prepared yet.
    pub fn empty() -> Self {
        Self { setup: None, kernels: Kernels::default(), workers: None }
    }

    /// Runs a scene; an interrupted run returns the same as [`run`](crate::run()).
    ///
    /// # Errors
    /// If the scene is invalid, or the run was stopped before its first estimate.
    pub fn run(&mut self, scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
        self.answer(scene, Accuracy::Exact, control)
    }

    /// Computes a first answer, whatever the target of the scene (`is_final` of its solver is false): by adding, from two or three coarse
    /// levels of discretisation, with the difference of the last two as its error; by Monte Carlo, from the first round of paths, with
    /// standard errors. A following [`run`](Self::run) of the same scene has the same result as without it.
    ///
    /// Where the exact answer takes little work (estimated from counts), it is the exact one; so is that below a colour filter by adding.
    ///
    /// # Errors
    /// As for [`run`](Self::run).
    pub fn first(&mut self, scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
        self.answer(scene, Accuracy::First, control)
    }

    /// Runs a scene at a level of discretisation of adding, whatever its target: that of an earlier run
    /// ([`SolverReport::level`](crate::result::SolverReport::level)). Between scenes that differ little, the errors of one
    /// level differ little, too: for finite differences.
    ///
    /// # Errors
    /// As for [`run`](Self::run).
    pub fn run_at_level(
        &mut self,
        scene: &Scene,
        level: u32,
        control: &Control<'_>,
    ) -> Result<RunResult, DisplayError> {
        self.answer(scene, Accuracy::Level(level.max(1)), control)
    }

    /// The scene, prepared.
    pub(crate) fn setup(&mut self, scene: &Scene, control: &Control<'_>) -> Result<&Setup, DisplayError> {
        self.setup_towards(scene, Towards::All, control)
    }

    /// The scene, prepared for what is seen from any direction.
    pub(crate) fn setup_of_map(
        &mut self,
        scene: &Scene,
        control: &Control<'_>,
    ) -> Result<&Setup, DisplayError> {
        self.setup_towards(scene, Towards::Map, control)
    }

    /// The scene, prepared for its views and the mirror images of its lamps.
    pub(crate) fn setup_of_views(
        &mut self,
        scene: &Scene,
        control: &Control<'_>,
    ) -> Result<&Setup, DisplayError> {
        self.setup_towards(scene, Towards::Views, control)
    }

    fn setup_towards(
        &mut self,
        scene: &Scene,
        towards: Towards,
        control: &Control<'_>,
    ) -> Result<&Setup, DisplayError> {
        let setup = match self.setup.take() {
            Some(setup) => setup.renewed_towards(scene, towards, control)?,
            None => {
                self.kernels.clear();
                Setup::towards(scene, towards, control)?
            }
        };
        Ok(self.setup.insert(setup))
    }

    fn answer(
        &mut self,
        scene: &Scene,
        accuracy: Accuracy,
        control: &Control<'_>,
    ) -> Result<RunResult, DisplayError> {
        self.setup_towards(scene, Towards::Views, control)?;
        let Self { setup: Some(setup), kernels, workers } = self else {
            return Err(DisplayError::Interrupted);
        };
        let accuracy =
            if accuracy == Accuracy::First && is_quick(setup) { Accuracy::Exact } else { accuracy };
        run_setup(setup, accuracy, control, kernels, workers)
    }
}
