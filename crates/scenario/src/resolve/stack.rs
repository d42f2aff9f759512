//! Conversion of a list of media and interfaces to layers: each an interface and the medium below it.

use papilio_diagnostics::Diagnostic;
use papilio_display::scene::{Depolarisation, Interface, Layer, Length, Medium, Ready};
use papilio_spectra::{Grid, Spectrum};

use super::pixel::dispersive;
use super::reflection::wrong_total;
use crate::error::Errors;
use crate::origin::Origin;

/// A stack of layers that grows from the air downwards.
pub(super) struct Stack {
    layers: Vec<Layer>,
    /// An interface without a medium below it yet, and the thickness of the medium above it, should that
    /// continue below.
    waiting: Option<(Interface, Length, Origin)>,
    /// Depolarisation of the interfaces that are added.
    depolarisation: Depolarisation,
    /// That of the one without a medium below it yet.
    of_waiting: Depolarisation,
    /// Index of the lowest medium so far, and its place.
    above: (Spectrum, Origin),
    mistakes: Vec<(Origin, Diagnostic)>,
}

impl Stack {
    pub(super) fn new(grid: &Grid) -> Self {
        let above = (Spectrum::constant(grid, 1.0), Origin::FILE);
        let usual = Depolarisation::default;
        let [depolarisation, of_waiting] = [usual(), usual()];
        Self { layers: Vec::new(), waiting: None, depolarisation, of_waiting, above, mistakes: Vec::new() }
    }

    /// Sets the depolarisation of the interfaces that are added from now on.
    pub(super) fn depolarise(&mut self, depolarisation: Depolarisation) {
        self.depolarisation = depolarisation;
    }

    /// Adds an interface. An interface directly above it is then inside the medium above both, at the same
    /// place.
    pub(super) fn put(&mut self, interface: Interface, origin: Origin) {
        self.put_above(interface, Length::Mm(0.0), origin);
    }

    /// Adds an interface inside a medium that continues for this length below it, unless another medium
    /// follows.
    pub(super) fn put_above(&mut self, interface: Interface, below: Length, origin: Origin) {
        self.close();
        self.waiting = Some((interface, below, origin));
        self.of_waiting = self.depolarisation.clone();
    }

    /// Adds a medium of this thickness; `index_at` is the place of its index. Without an interface above it,
    /// there is a bare interface if the index changes.
    pub(super) fn fill(&mut self, medium: Medium, thickness: Length, index_at: Origin) {
        let (interface, _, origin) =
            self.waiting.take().unwrap_or((Ready::Fresnel.into(), Length::Mm(0.0), Origin::FILE));
        let (above, below) = (&self.above.0, &medium.index);
        let same = **above == **below;
        let wrong = match &interface {
            Interface::Ready(ready) if ready.lies_in_one_medium() && !same => Some(different_indices()),
            Interface::Rough { .. } => match [above, below].into_iter().find(|index| !index.is_constant()) {
                Some(index) => Some(dispersive("a medium next to this interface", index)),
                None => same.then(no_interface),
            },
            Interface::Ready(Ready::Reflecting(diffuser)) => wrong_total(diffuser, above, below),
            _ => None,
        };
        let at = origin.or_override([self.above.1, index_at]);
        self.mistakes.extend(wrong.map(|wrong| (at, wrong)));
        let interface =
            if same && interface == Ready::Fresnel.into() { Ready::Open.into() } else { interface };
        self.above = (medium.index.clone(), index_at);
        let depolarisation = std::mem::take(&mut self.of_waiting);
        self.layers.push(Layer { interface, medium, thickness, depolarisation });
    }

    /// Returns the layers; mistakes are added to `errors`.
    pub(super) fn finish(mut self, errors: &mut Errors) -> Vec<Layer> {
        self.close();
        self.mistakes.into_iter().for_each(|(origin, wrong)| errors.push(origin, wrong));
        self.layers
    }

    /// Places a last interface inside the medium above it.
    fn close(&mut self) {
        if let Some((_, below, _)) = &self.waiting {
            let (length, (index, at)) = (below.clone(), self.above.clone());
            self.fill(Medium::clear(index), length, at);
        }
    }
}

/// An interface that must lie in one medium, such as a component, between media of different index.
fn different_indices() -> Diagnostic {
    Diagnostic::new("this layer lies between media of different index")
        .expected("media of equal index above and below it")
        .hint(
            "put a layer below this one: an interface such as { kind = \"fresnel\" }, so that this layer lies in the medium \
             above; or a { kind = \"medium\" } of the same index as the medium above",
        )
}

/// Error: a rough interface between media of equal index.
fn no_interface() -> Diagnostic {
    Diagnostic::new("the media on both sides of this interface have the same index")
        .expected("two media of different index")
        .hint("add a { kind = \"medium\" } with another index below the interface, or remove the interface")
}
