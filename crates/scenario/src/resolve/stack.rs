//! From a list of media and interfaces to layers: each an interface and the medium below it.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Interface, Layer, Medium, Ready};
use papilio_spectra::{Grid, Spectrum};

use super::pixel::dispersive;
use crate::error::Errors;
use crate::origin::Origin;

/// Layers as they are put down, from the air.
pub(super) struct Stack {
    layers: Vec<Layer>,
    /// An interface that waits for the medium below it.
    waiting: Option<(Interface, Origin)>,
    /// Index of the lowest medium so far, and where it was given.
    above: (Spectrum, Origin),
    mistakes: Vec<(Origin, Diagnostic)>,
}

impl Stack {
    pub(super) fn new(grid: &Grid) -> Self {
        let above = (Spectrum::constant(grid, 1.0), Origin::FILE);
        Self { layers: Vec::new(), waiting: None, above, mistakes: Vec::new() }
    }

    /// An interface. One that waits already lies in the medium above.
    pub(super) fn put(&mut self, interface: Interface, origin: Origin) {
        self.close();
        self.waiting = Some((interface, origin));
    }

    /// A medium, whose index is given at `index_at`; without an interface above it, a bare face stands
    /// where the index changes.
    pub(super) fn fill(&mut self, medium: Medium, index_at: Origin) {
        let (interface, origin) = self.waiting.take().unwrap_or((Ready::Fresnel.into(), Origin::FILE));
        let (above, below) = (&self.above.0, &medium.index);
        let same = **above == **below;
        let wrong = match &interface {
            Interface::Ready(ready) if ready.lies_in_one_medium() && !same => Some(sheet_at_face()),
            Interface::Rough { .. } => match [above, below].into_iter().find(|index| !index.is_constant()) {
                Some(index) => Some(dispersive("a medium beside this face", index)),
                None => same.then(no_face),
            },
            _ => None,
        };
        let at = origin.or_override([self.above.1, index_at]);
        self.mistakes.extend(wrong.map(|wrong| (at, wrong)));
        let interface =
            if same && interface == Ready::Fresnel.into() { Ready::Open.into() } else { interface };
        self.above = (medium.index.clone(), index_at);
        self.layers.push(Layer { interface, medium });
    }

    /// The layers; what does not fit together goes to `errors`.
    pub(super) fn finish(mut self, errors: &mut Errors) -> Vec<Layer> {
        self.close();
        self.mistakes.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
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

/// A sheet between media of different index: which of them it is in makes a difference.
fn sheet_at_face() -> Diagnostic {
    Diagnostic::new("this sheet lies between media of different index").hint(
        "put a layer below the sheet: a face such as { kind = \"fresnel\" }, and the sheet is in the medium above it; or a \
         { kind = \"medium\" } of the same index as above",
    )
}

/// A rough face without a step of the index.
fn no_face() -> Diagnostic {
    Diagnostic::new("the media on both sides of this face have the same index")
        .expected("two media of different index")
        .hint("put a { kind = \"medium\" } of another index below the face, or remove the face")
}
