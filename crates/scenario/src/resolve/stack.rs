//! From a list of media and interfaces to layers: each an interface and the medium below it.

use papilio_display::scene::{Interface, Layer, Medium};
use papilio_spectra::{Grid, Spectrum};

use crate::error::Errors;
use crate::problem::Problem;
use crate::source::Origin;

/// Layers as they are put down, from the air.
pub(super) struct Stack {
    layers: Vec<Layer>,
    /// An interface that waits for the medium below it.
    waiting: Option<(Interface, Origin)>,
    /// Index of the lowest medium so far, and where it was given.
    above: (Spectrum, Origin),
    problems: Vec<(Origin, Problem)>,
}

impl Stack {
    pub(super) fn new(grid: &Grid) -> Self {
        let above = (Spectrum::constant(grid, 1.0), Origin::FILE);
        Self { layers: Vec::new(), waiting: None, above, problems: Vec::new() }
    }

    /// An interface. One that waits already lies in the medium above.
    pub(super) fn put(&mut self, interface: Interface, origin: Origin) {
        self.close();
        self.waiting = Some((interface, origin));
    }

    /// A medium, whose index is given at `index_at`; without an interface above it, a bare face stands
    /// where the index changes.
    pub(super) fn fill(&mut self, medium: Medium, index_at: Origin) {
        let (interface, origin) = self.waiting.take().unwrap_or((Interface::Fresnel, Origin::FILE));
        let (above, below) = (&self.above.0, &medium.index);
        let same = **above == **below;
        let problem = match &interface {
            Interface::Sheet(_) if !same => Some(Problem::SheetAtFace),
            Interface::Rough { .. } => match [above, below].into_iter().find(|index| !index.is_constant()) {
                Some(index) => Some(Problem::DispersiveFace { least: index.min(), largest: index.max() }),
                None => same.then_some(Problem::NoFace),
            },
            _ => None,
        };
        let at = origin.or_set([self.above.1, index_at]);
        self.problems.extend(problem.map(|problem| (at, problem)));
        let interface =
            if same && matches!(interface, Interface::Fresnel) { Interface::Open } else { interface };
        self.above = (medium.index.clone(), index_at);
        self.layers.push(Layer { interface, medium });
    }

    /// The layers; what does not fit together goes to `errors`.
    pub(super) fn finish(mut self, errors: &mut Errors) -> Vec<Layer> {
        self.close();
        self.problems.into_iter().for_each(|(origin, problem)| errors.push(origin, problem));
        self.layers
    }

    /// Puts what waits into the medium above it.
    fn close(&mut self) {
        if self.waiting.is_some() {
            let (index, at) = self.above.clone();
            let transmittance = index.map(|_| 1.0);
            self.fill(Medium { index, transmittance, scattering: None }, at);
        }
    }
}
