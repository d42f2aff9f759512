//! The general display: any layers in any order, as interfaces and media in turn.
//!
//! Top to bottom: air, then for each layer its interface and the medium below it, then the
//! base under the last medium. Light exchanged between layers is followed through all orders,
//! light trapped by total internal reflection included. Every interface is an operator on
//! direction cosines; what reaches a medium beyond its index (`|beta| >= n`) does not enter it.

use papilio_optics::film::Coating;
use papilio_optics::lobe::Lobe;
use papilio_optics::rough::Rough;
use papilio_spectra::Spectrum;

use crate::{Base, Medium, Panel};

/// A display of any layers.
#[derive(Debug, Clone)]
pub struct Layered {
    /// Top to bottom.
    pub layers: Vec<Layer>,
    /// The pixel, under the last layer's medium.
    pub base: Base,
}

/// An interface and the medium below it.
#[derive(Debug, Clone)]
pub struct Layer {
    /// Between the medium above (air over the first layer) and `medium`.
    pub interface: Interface,
    /// Below the interface.
    pub medium: Medium,
}

/// What stands between two media.
#[derive(Debug, Clone)]
pub enum Interface {
    /// Nothing: the media have the same index.
    Open,
    /// A perfect antireflection face: what both media can carry passes whole, the rest is reflected whole.
    Coated,
    /// A bare face, unpolarised Fresnel.
    Fresnel,
    /// A front-of-screen component in a medium: mirrors and absorbs these shares at every angle,
    /// alike from both sides. The media have the same index.
    Sheet {
        /// Share mirrored, per wavelength.
        reflectance: Spectrum,
        /// Share absorbed, per wavelength.
        absorptance: Spectrum,
    },
    /// Coherent thin films.
    Coating(Coating),
    /// A diffuser given by its BTDF, its faces included.
    Diffuser(Diffuser),
    /// A rough face between two media of constant index.
    Rough(Rough),
}

/// A diffuser given by its BTDF: it reflects nothing; what its lobe sends beyond the index of the
/// medium there, above (1 in air) or below, is absorbed in it.
#[derive(Debug, Clone)]
pub struct Diffuser {
    /// Angular shape of the scattered part.
    pub lobe: Lobe,
    /// T, straight-through included, per wavelength.
    pub transmittance: Spectrum,
    /// Share of the transmitted light that keeps its direction.
    pub straight_through: f64,
}

/// A display in either form.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant, reason = "there is one stack, not many")]
pub enum Stack {
    /// The ordinary panel.
    Panel(Panel),
    /// Any layers.
    Layered(Layered),
}

impl Stack {
    /// The pixel.
    pub fn base(&self) -> &Base {
        match self {
            Self::Panel(panel) => &panel.base,
            Self::Layered(layered) => &layered.base,
        }
    }
}
