//! Evaluation of many film pixels under fixed layers, for optimisations and tolerance analyses.
//!
//! **What.** [`Designs`] keeps the angular kernel of one display (layers, lights, views) and evaluates other
//! film pixels with it: a table of the film's reflectances, one product with the kernel, and the colours.
//! This is a complete computation, as exact as a run; only the second level of a run, from which its error is
//! estimated, is missing.
//!
//! **Level.** The level at which a run of the scene's own pixel meets its `relative_error`: the finer of the
//! two levels that a run compares. The error is that of the level, about that of the first pixel. An
//! optimisation ends with a run of its result.
//!
//! **Nodes over angle.** If all quantities are colours, the film is tabulated on as many nodes as X, Y and Z
//! need (`angles`, `pixel::weighted`), with an error of at most 1e-5 of Y. Otherwise the table is that of a
//! run ([`TABLE_ERROR`](crate::pixel::TABLE_ERROR)), and the values are identical to those of
//! [`run`](crate::run()) if that reaches the same level.
//!
//! **Reproducibility.** Each design is computed on the nodes that its own film needs, independently of
//! earlier designs: the order of designs does not affect the values. Where a film needs other nodes, the
//! values change by at most the error of the table. The peak of a flat spectrum is reported, too: only a
//! second level shows whether a spectrum is flat within its errors.

mod angles;
mod derivatives;
mod differences;
mod parameter;
mod quantity;

use std::cell::OnceCell;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

use papilio_transport::adding::Kernel;
use papilio_transport::{Cone, Reflector, Stack};

use angles::{ColourTable, ColourViews};
pub use derivatives::Derivatives;
pub use parameter::Parameter;
pub use quantity::Quantity;

use crate::DisplayError;
use crate::meter::{Meter, Sample, ViewScalars};
use crate::pixel::film::{Mixture, polarised_tables, tabulated};
use crate::result::StateValues;
use crate::run::{Control, ViewGroupKernel, prepared_kernels};
use crate::scene::{FilmPixel, Method, Metric, Pixel, Scene, Stop};
use crate::setup::Setup;

/// Evaluator of film pixels for one display, with fixed layers, lights and views.
///
/// A clone shares the kernels: use one clone for each thread.
#[derive(Debug, Clone)]
pub struct Designs {
    setup: Arc<Setup>,
    quantities: Arc<[Quantity]>,
    /// Stack of the setup with the last pixel as its base.
    stack: Stack,
    /// Groups of views that share kernels.
    groups: Vec<ViewGroup>,
    /// Views of quantities that are all colours; `None` if they need the nodes of all light.
    colours: Option<ColourViews>,
    /// The last pixel on the nodes for colours, if it has them; then it is not in the stack.
    table: Option<ColourTable>,
}

/// Kernels of a group of views at one level, one for each set of table nodes, the most recently used first.
#[derive(Debug, Clone)]
struct ViewGroup {
    views: Range<usize>,
    kernels: VecDeque<Arc<Kernel>>,
}

/// Largest number of kernels that are kept; films need few sets of nodes.
const MOST_KERNELS: usize = 8;

impl Designs {
    /// Prepares the kernels at the level that meets the scene's target for the scene's own pixel.
    ///
    /// # Errors
    /// If the scene is invalid, has no film pixel or is not solved by adding to a relative error; if a view
    /// or state of a quantity does not exist; if the preparation was stopped.
    pub fn new(scene: &Scene, quantities: &[Quantity], control: &Control<'_>) -> Result<Self, DisplayError> {
        let Pixel::Film(_) = &scene.display.pixel else { return Err(DisplayError::NotAFilm) };
        if scene.solver.method == Method::MonteCarlo
            || !matches!(scene.solver.stop, Stop::RelativeError { .. })
        {
            return Err(DisplayError::NotByAdding);
        }
        let setup = Setup::new(scene, control)?;
        quantities.iter().try_for_each(|one| one.check(setup.views.len(), &setup.states))?;
        let group =
            |ViewGroupKernel { kernel, views }| ViewGroup { views, kernels: [Arc::new(kernel)].into() };
        let groups: Vec<ViewGroup> = prepared_kernels(&setup, control)?.into_iter().map(group).collect();
        let stack = setup.stack.clone();
        let colours = ColourViews::new(&setup, &groups, quantities)?;
        Ok(Self {
            setup: Arc::new(setup),
            quantities: quantities.into(),
            stack,
            groups,
            colours,
            table: None,
        })
    }

    /// Computes the quantities of another pixel with the same states, in their order; `None` if one is not
    /// defined.
    ///
    /// # Errors
    /// If the film is invalid or its states differ.
    pub fn evaluate(&mut self, film: &FilmPixel) -> Result<Vec<Option<f64>>, DisplayError> {
        self.replace_pixel(film, Mixture::new)?;
        let setup = Arc::clone(&self.setup);
        let meter = Meter::new(&setup);
        let mut values = vec![None; self.quantities.len()];
        for view in 0..setup.views.len() {
            if self.quantities.iter().all(|quantity| quantity.view() != view) {
                continue;
            }
            let observed = self.observe(&meter, view)?;
            for (value, quantity) in values.iter_mut().zip(&*self.quantities) {
                if quantity.view() == view {
                    *value = observed.value(&meter, quantity);
                }
            }
        }
        Ok(values)
    }

    /// Replaces the pixel below the layers; returns the mixture of its gaps.
    fn replace_pixel(
        &mut self,
        film: &FilmPixel,
        mixture: impl Fn(&FilmPixel) -> Result<Mixture, DisplayError>,
    ) -> Result<Mixture, DisplayError> {
        if !film.states.iter().map(|state| &state.name).eq(&self.setup.states) {
            return Err(DisplayError::OtherStates);
        }
        let scene = &self.setup.scene;
        let mixture = mixture(film)?;
        let index = scene.display.index_above_pixel();
        if let Some(colours) = &mut self.colours {
            self.table = colours.table(film, (&scene.grid, index), &mixture)?;
            if self.table.is_some() {
                return Ok(mixture);
            }
        }
        let known = match &self.stack.base().reflector {
            Reflector::Specular(table) => Some(&table.nodes),
            _ => None,
        };
        let table = |nodes, values| Reflector::Specular(mixture.table(nodes, values, film));
        if self.stack.polarised_bases().is_some() {
            let (nodes, [mean, s, p]) = polarised_tables(film, &scene.grid, index, &mixture.gaps_nm, known)?;
            for (one, values) in self.stack.polarised_bases_mut().into_iter().flatten().zip([s, p]) {
                one.reflector = table(nodes.clone(), values);
            }
            self.stack.set_reflector(table(nodes, mean));
        } else {
            let (nodes, values) = tabulated(film, &scene.grid, index, &mixture.gaps_nm, known)?;
            self.stack.set_reflector(table(nodes, values));
        }
        Ok(mixture)
    }

    /// Computes the sample and the metrics of the last pixel in a view.
    fn observe(&mut self, meter: &Meter<'_>, view: usize) -> Result<DesignObservation, DisplayError> {
        let (setup, stack) = (&self.setup, &self.stack);
        let Some(group) = self.groups.iter_mut().find(|group| group.views.contains(&view)) else {
            return Err(DisplayError::Interrupted);
        };
        let colours = self.colours.as_ref().zip(self.table.as_ref());
        let seen = match colours.and_then(|(colours, table)| colours.seen(view, table)) {
            Some(seen) => seen,
            None => {
                let number = view - group.views.start;
                group.kernel_for(setup, stack).seen(stack, number)
            }
        };
        let sample = meter.sample_without_ledger(&seen);
        if !sample.is_finite() {
            return Err(DisplayError::NotFinite);
        }
        let shifts = |metric| matches!(metric, Some(Metric::peak_shift_nm | Metric::average_peak_shift_nm));
        let bare = if self.quantities.iter().any(|quantity| shifts(quantity.metric())) {
            meter.bare_peaks(&setup.views[view], stack.base())
        } else {
            vec![None; setup.states.len()]
        };
        let scalars = meter.scalars(&sample, &bare);
        let spectra = vec![OnceCell::new(); setup.states.len()];
        Ok(DesignObservation { sample, scalars, spectra })
    }
}

impl ViewGroup {
    /// Returns a kernel that is valid for this stack; prepares one if necessary.
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

/// Sample and metrics of a pixel in one view.
struct DesignObservation {
    sample: Sample,
    scalars: ViewScalars,
    /// Reflectance factor of each state, computed when first requested; `None` without ambient light.
    spectra: Vec<OnceCell<Option<Vec<f64>>>>,
}

impl DesignObservation {
    /// Returns the value of a quantity; `None` if it is not defined.
    fn value(&self, meter: &Meter<'_>, quantity: &Quantity) -> Option<f64> {
        let Some(name) = quantity.state() else {
            return quantity.metric()?.of_view(&self.scalars.together);
        };
        let state = meter.state_named(name)?;
        let factor =
            || self.spectra[state].get_or_init(|| meter.reflectance_factor(state, &self.sample.0)).as_ref();
        if let Quantity::ReflectanceFactor { bin, .. } = quantity {
            return factor()?.get(*bin).copied();
        }
        let mut values = StateValues::of_scalars(&self.scalars.states[state]);
        match quantity {
            Quantity::SpectrumDistance { .. } => {
                values.reflectance_factor = factor().cloned();
            }
            Quantity::Metric { metric: Metric::R_hemi, .. } => {
                values.R_hemi = meter.under_diffuse(state, &self.sample);
            }
            _ => {}
        }
        quantity.of_state(&values)
    }
}
