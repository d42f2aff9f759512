//! Many pixels under layers that stay: what searches and tolerances evaluate.
//!
//! **What.** [`Designs`] keeps the angular kernel of one display (layers, lights, views) and answers other film
//! pixels through it: a table of the film's reflectances, one product with the kernel, colours. That is a
//! complete design, exact in all that a run is exact in; it lacks only a run's second level, which tells the error.
//!
//! **Which level.** That at which a run of the scene's own pixel meets its `relative_error`, the finer of the two that a
//! run compares. A design has the very numbers that [`run`](crate::run()) reports where that takes it to the same level; its
//! error is that of the level, about the first pixel's. A search ends with a run of what it found.
//!
//! **Which numbers.** Every design is computed on the nodes that its own film needs, whatever came before: the order of
//! designs changes nothing. Where a film begins to need other nodes the numbers step by no more than the table's
//! error ([`TABLE_ERROR`](crate::pixel::TABLE_ERROR)). A peak is reported however flat the spectrum is: only a second level tells what is
//! flat within its errors.

mod derivatives;
mod differences;
mod parameter;
mod quantity;

use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use papilio_transport::adding::Kernel;
use papilio_transport::{Cone, Reflector, Stack};

pub use derivatives::Derivatives;
pub use parameter::Parameter;
pub use quantity::Quantity;

use crate::DisplayError;
use crate::meter::{Meter, Sample, ViewScalars};
use crate::pixel::film::{Mixture, tabulated};
use crate::result::StateValues;
use crate::run::{Control, Lens, prepared_lenses};
use crate::scene::{FilmPixel, Method, Metric, Pixel, Scene, Stop};
use crate::setup::{Setup, base_of, base_under};

/// The pixels of one display: layers, lights and views stay, the film changes.
///
/// A clone shares the kernels: one for each thread.
#[derive(Debug, Clone)]
pub struct Designs {
    setup: Arc<Setup>,
    quantities: Arc<[Quantity]>,
    /// The setup's, over the last pixel.
    stack: Stack,
    /// For each group of views that share kernels.
    lenses: Vec<Kernels>,
}

/// Kernels of one level, for the nodes of one table and another, the last used first.
#[derive(Debug, Clone)]
struct Kernels {
    views: Range<usize>,
    kernels: VecDeque<Arc<Kernel>>,
}

/// Films need few sets of nodes.
const MOST_KERNELS: usize = 8;

impl Designs {
    /// Prepares the kernels at the level that meets the scene's target for this scene's own pixel.
    ///
    /// # Errors
    /// If the scene cannot be, has no film pixel or is not solved by adding to a relative error; if there is no view or state of a
    /// quantity; if it was stopped.
    pub fn new(scene: &Scene, quantities: &[Quantity], control: &Control<'_>) -> Result<Self, DisplayError> {
        let Pixel::Film(_) = &scene.display.pixel else { return Err(DisplayError::NotAFilm) };
        if scene.solver.method != Method::Adding || !matches!(scene.solver.stop, Stop::RelativeError { .. }) {
            return Err(DisplayError::NotByAdding);
        }
        let setup = Setup::new(scene)?;
        quantities.iter().try_for_each(|one| one.check(setup.views.len(), &setup.states))?;
        let lens = |Lens { kernel, views }| Kernels { views, kernels: [Arc::new(kernel)].into() };
        let lenses = prepared_lenses(&setup, control)?.into_iter().map(lens).collect();
        let stack = setup.stack.clone();
        Ok(Self { setup: Arc::new(setup), quantities: quantities.into(), stack, lenses })
    }

    /// The quantities of another pixel of the same states, in their order; `None` where one is not defined.
    ///
    /// # Errors
    /// If the film cannot be, or has other states.
    pub fn evaluate(&mut self, film: &FilmPixel) -> Result<Vec<Option<f64>>, DisplayError> {
        self.take(film, Mixture::new)?;
        let setup = Arc::clone(&self.setup);
        let meter = Meter::new(&setup);
        let mut values = vec![None; self.quantities.len()];
        for view in 0..setup.views.len() {
            if self.quantities.iter().all(|quantity| quantity.view() != view) {
                continue;
            }
            let seen = self.look(&meter, view)?;
            for (value, quantity) in values.iter_mut().zip(&*self.quantities) {
                if quantity.view() == view {
                    *value = seen.value(&meter, quantity);
                }
            }
        }
        Ok(values)
    }

    /// Puts a pixel under the layers, a mixture of its gaps.
    fn take(
        &mut self,
        film: &FilmPixel,
        mixture: impl Fn(&FilmPixel) -> Result<Mixture, DisplayError>,
    ) -> Result<Mixture, DisplayError> {
        if !film.states.iter().map(|state| &state.name).eq(&self.setup.states) {
            return Err(DisplayError::OtherStates);
        }
        let scene = &self.setup.scene;
        let mixture = mixture(film)?;
        let base = base_of(&mut self.stack);
        let known = match &base.reflector {
            Reflector::Specular(table) => Some(&table.nodes),
            _ => None,
        };
        let index = scene.display.index_above_pixel();
        let (nodes, values) = tabulated(film, &scene.grid, index, &mixture.gaps_nm, known)?;
        base.reflector = Reflector::Specular(mixture.table(nodes, values, film));
        Ok(mixture)
    }

    /// What is seen of the last pixel.
    fn look(&mut self, meter: &Meter<'_>, view: usize) -> Result<Seen, DisplayError> {
        let (setup, stack) = (&self.setup, &self.stack);
        let Some(lens) = self.lenses.iter_mut().find(|lens| lens.views.contains(&view)) else {
            return Err(DisplayError::Interrupted);
        };
        let number = view - lens.views.start;
        let sample = meter.sample_without_ledger(&lens.kernel_for(setup, stack).seen(stack, number));
        if !sample.is_finite() {
            return Err(DisplayError::NotFinite);
        }
        let shifts = |metric| matches!(metric, Some(Metric::peak_shift_nm | Metric::average_peak_shift_nm));
        let bare = if self.quantities.iter().any(|quantity| shifts(quantity.metric())) {
            meter.bare_peaks(&setup.views[view], base_under(stack))
        } else {
            vec![None; setup.states.len()]
        };
        let scalars = meter.scalars(&sample, &bare);
        Ok(Seen { sample, scalars })
    }
}

impl Kernels {
    /// One that serves this stack.
    fn kernel_for(&mut self, setup: &Setup, stack: &Stack) -> &Kernel {
        match self.kernels.iter().position(|kernel| kernel.serves(stack)) {
            Some(0) => {}
            Some(found) => self.kernels.swap(0, found),
            None => {
                let fields: Vec<Cone> =
                    setup.views[self.views.clone()].iter().map(|view| view.field).collect();
                let mut kernel = self.kernels[0].unprepared();
                kernel.prepare(stack, &fields, &setup.sources);
                self.kernels.truncate(MOST_KERNELS - 1);
                self.kernels.push_front(Arc::new(kernel));
            }
        }
        &self.kernels[0]
    }
}

/// What is seen of a pixel from one view.
struct Seen {
    sample: Sample,
    scalars: ViewScalars,
}

impl Seen {
    fn value(&self, meter: &Meter<'_>, quantity: &Quantity) -> Option<f64> {
        let Some(name) = quantity.state() else {
            return quantity.metric()?.of_view(&self.scalars.together);
        };
        let state = meter.state_named(name)?;
        let mut values = StateValues::of_scalars(&self.scalars.states[state]);
        match quantity {
            Quantity::SpectrumDistance { .. } => {
                values.reflectance_factor = meter.reflectance_factor(state, &self.sample.0);
            }
            Quantity::Metric { metric: Metric::R_hemi, .. } => {
                values.R_hemi = meter.under_diffuse(state, &self.sample);
            }
            _ => {}
        }
        quantity.of_state(&values)
    }
}
