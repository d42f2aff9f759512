//! The general display: any layers in any order, as interfaces and media in turn.
//!
//! Top to bottom: air, then for each layer its interface and the medium below it, then the base under the last
//! medium. Light is followed through all orders of inter-reflection, including light trapped by total internal
//! reflection. Every interface is an operator on direction cosines; light with `|beta| >= n` does not enter a medium
//! of index n.

use crate::layers::{LayerKind, least_edge};
use crate::{Approximation, Base, Interface, Medium, Panel, PanelParts, Reflector};

/// A display of any layers.
#[derive(Debug, Clone)]
pub struct Layered {
    /// Top to bottom.
    pub layers: Vec<Layer>,
    /// The pixel, under the last layer's medium.
    pub base: Base,
}

impl Layered {
    /// Returns interfaces and media in turn, top to bottom, each with the media above and below it. A medium
    /// has itself on both sides; the first interface has `None`, air, above.
    pub(crate) fn elements(&self) -> impl Iterator<Item = (&dyn LayerKind, [Option<&Medium>; 2])> {
        let above = std::iter::once(None).chain(self.layers.iter().map(|layer| Some(&layer.medium)));
        self.layers.iter().zip(above).flat_map(|(Layer { interface, medium }, above)| {
            let medium_itself: &dyn LayerKind = medium;
            [(interface.kind(), [above, Some(medium)]), (medium_itself, [Some(medium); 2])]
        })
    }

    /// True if all layers are the same at every wavelength; the pixel may have colour.
    pub(crate) fn is_grey(&self) -> bool {
        let key = |bin: usize| {
            let mut key = Vec::new();
            self.elements().for_each(|(kind, _)| kind.spectral_key(bin, &mut key));
            key
        };
        let first = key(0);
        (1..self.base.bins()).all(|bin| key(bin) == first)
    }
}

/// An interface and the medium below it.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Between the medium above (air over the first layer) and `medium`.
    pub interface: Interface,
    /// Below the interface.
    pub medium: Medium,
}

/// A display in either form; both are made from layers.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one stack, not many")]
pub enum Stack {
    /// The ordinary panel.
    Panel(Panel),
    /// Any layers.
    Layered(Layered),
}

/// An approximation for panels was requested of other layers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotAPanel;

impl Stack {
    /// Returns the stack of these layers over a pixel: the ordinary panel that they are, or else general layers.
    ///
    /// # Errors
    /// [`NotAPanel`] if an approximation is requested of layers that are no panel.
    pub fn new(layers: Vec<Layer>, base: Base, approximation: Approximation) -> Result<Self, NotAPanel> {
        let described = layers.iter().map(|Layer { interface, medium }| {
            let is_clear = medium.transmittance().is_none() && medium.scattering().is_none();
            (Some(interface), medium.index(), is_clear)
        });
        let scatters = matches!(base.reflector, Reflector::Scattering(_));
        if let Some(parts) = PanelParts::recognised(described).filter(|_| !scatters)
            && let Some(glass) = layers.last()
        {
            return Ok(Self::Panel(Panel::new(&parts, &glass.medium, base, approximation)));
        }
        approximation.is_none().then_some(Self::Layered(Layered { layers, base })).ok_or(NotAPanel)
    }

    /// The `|beta|` beyond which the appearance from above is unknown: where the table of the first scatterer ends. `None`
    /// if it extends to the horizon.
    pub fn known_within(&self) -> Option<f64> {
        let Self::Layered(layered) = self else { return None };
        if let Some(first) = layered.elements().map(|(kind, _)| kind).find(|kind| kind.scatters()) {
            return first.known_within();
        }
        let Reflector::Scattering(states) = &layered.base.reflector else { return None };
        let index = layered.layers.last().map_or(1.0, |layer| layer.medium.index().min());
        least_edge(states).map(|edge| index * edge)
    }

    /// The pixel.
    pub fn base(&self) -> &Base {
        match self {
            Self::Panel(panel) => &panel.base,
            Self::Layered(layered) => &layered.base,
        }
    }

    /// Returns the pixel for modification; whether it scatters must not change.
    pub fn base_mut(&mut self) -> &mut Base {
        match self {
            Self::Panel(panel) => &mut panel.base,
            Self::Layered(layered) => &mut layered.base,
        }
    }
}
