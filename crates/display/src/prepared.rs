//! Scenes one after the other, each from what is left of the last.

use crate::DisplayError;
use crate::result::RunResult;
use crate::run::{Control, Kernels, Workers, run_setup};
use crate::scene::Scene;
use crate::setup::Setup;

/// A display, its light and its views, prepared: what sweeps, optimisers and sliders hold.
///
/// [`run`](Self::run) takes any scene and computes anew only what has changed since the
/// last: the angular kernels of *adding* serve as long as layers, views and lights stay, the
/// film's reflectances as long as its layers and gaps stay. Results are those of
/// [`run`](crate::run()), to the last bit.
#[derive(Debug)]
pub struct Prepared {
    /// `None` after a scene that cannot be.
    setup: Option<Setup>,
    kernels: Kernels,
    workers: Option<Workers>,
}

impl Prepared {
    /// Prepared for scenes like this one.
    ///
    /// # Errors
    /// If the scene cannot be.
    pub fn new(scene: &Scene) -> Result<Self, DisplayError> {
        Ok(Self { setup: Some(Setup::new(scene)?), kernels: Kernels::default(), workers: None })
    }

    /// Runs a scene; interrupted, as [`run`](crate::run()) is.
    ///
    /// # Errors
    /// If the scene cannot be, or was stopped before there was anything to report.
    pub fn run(&mut self, scene: &Scene, control: &Control<'_>) -> Result<RunResult, DisplayError> {
        let setup = match self.setup.take() {
            Some(setup) => setup.renewed(scene)?,
            None => {
                self.kernels.clear();
                Setup::new(scene)?
            }
        };
        let setup = self.setup.insert(setup);
        run_setup(setup, control, &mut self.kernels, &mut self.workers)
    }
}
