//! The ordinary panel, for which both solvers are fastest: recognised among any layers.

use papilio_spectra::Spectrum;

use super::{Diffuser, Display, Interface, Layer, Pixel, Ready};

/// Ordinary panel, top to bottom: front of screen, surface or diffuser, clear glass.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Front-of-screen components in air, outermost first.
    pub front: Vec<FrontComponent>,
    /// The diffuser between air and glass, including its surfaces; `None`: a bare panel.
    pub diffuser: Option<Diffuser>,
    /// The glass.
    pub glass: Glass,
}

/// Front-of-screen component, with the same reflectance from both sides and at all angles.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontComponent {
    /// Specular reflectance, 0 to 1.
    pub reflectance: Spectrum,
    /// Absorptance, 0 to 1; the sum with the reflectance is at most 1.
    pub absorptance: Spectrum,
}

/// Glass between the surface and the pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Glass {
    /// Refractive index, at least 1.
    pub index: Spectrum,
    /// Surface towards the air; not used below a diffuser, which has its own surfaces.
    pub surface: Surface,
}

/// Interface between air and glass of a bare panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Surface {
    /// Ideal antireflection interface: transmits all light with |beta| <= 1 and totally reflects light with |beta| > 1.
    IdealAr,
    /// Bare interface: Fresnel reflectance of unpolarised light.
    Fresnel,
}

impl Panel {
    /// Returns the panel that these layers are: components in air, one face or diffuser without a reflection of its own,
    /// clear glass, and a pixel that does not scatter. `None` for all other layers.
    pub(super) fn recognised(display: &Display) -> Option<Self> {
        let (last, front) = display.layers.split_last()?;
        if matches!(display.pixel, Pixel::Scattering(_)) || !last.medium.is_clear() {
            return None;
        }
        let front = front.iter().map(FrontComponent::recognised).collect::<Option<_>>()?;
        let Interface::Ready(face) = &last.interface else { return None };
        let (diffuser, surface) = match face {
            Ready::Diffuser(diffuser) => (Some(diffuser.clone()), Surface::IdealAr),
            Ready::IdealAr => (None, Surface::IdealAr),
            // Between media of one index a bare interface is none.
            Ready::Fresnel | Ready::Open => (None, Surface::Fresnel),
            _ => return None,
        };
        Some(Self { front, diffuser, glass: Glass { index: last.medium.index.clone(), surface } })
    }
}

impl FrontComponent {
    /// Returns the component above air that a layer is.
    fn recognised(layer: &Layer) -> Option<Self> {
        let Interface::Ready(Ready::Component(component)) = &layer.interface else { return None };
        let is_air = layer.medium.is_clear() && layer.medium.index.iter().all(|index| *index == 1.0);
        let (reflectance, absorptance) = (component.reflectance.clone(), component.absorptance.clone());
        is_air.then_some(Self { reflectance, absorptance })
    }
}
