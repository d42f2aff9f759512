//! The general display: any layers in any order, as interfaces and media in turn.
//!
//! Top to bottom: air, then for each layer its interface and the medium below it, then the
//! base under the last medium. Light exchanged between layers is followed through all orders,
//! light trapped by total internal reflection included. Every interface is an operator on
//! direction cosines; what reaches a medium beyond its index (`|beta| >= n`) does not enter it.

use papilio_optics::film::Coating;
use papilio_optics::lobe::Lobe;
use papilio_optics::rough::Rough;
use papilio_optics::scatter::Scatter;
use papilio_spectra::Spectrum;

use crate::skeleton::Going;
use crate::{Base, Medium, Panel, Reflector};

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
    /// A face given by its BSDF.
    Scatter(Box<ScatterFace>),
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

/// A scattering kernel and what it is multiplied by at each wavelength.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterKernel {
    /// What becomes of light, by direction.
    pub scatter: Scatter,
    /// The factor.
    pub factor: Spectrum,
}

/// A face given by its BSDF, faces of whatever it is included: light of the air disc
/// `|beta| <= 1` is scattered into the air disc, passes straight, or is absorbed in it. What it transmits may reach
/// beyond the air disc below it, and comes back from there.
///
/// All its ways are reciprocal: light that goes up takes the ways back of light that goes down,
/// and of a reflection both readings are averaged.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterFace {
    straight: Spectrum,
    /// `[down, up]`.
    transmission: Option<[ScatterKernel; 2]>,
    reflection: [Option<ScatterKernel>; 2],
    /// The radius of the disc that its kernels live in, if that is not the air's: they are then a
    /// pixel's.
    disc: Option<Spectrum>,
}

impl ScatterFace {
    /// A face that passes this share of light, per wavelength, without changing its direction,
    /// and absorbs the rest.
    pub fn new(straight: Spectrum) -> Self {
        Self { straight, transmission: None, reflection: [None, None], disc: None }
    }

    /// The same with light from above scattered through it like this.
    pub fn with_transmission(mut self, ScatterKernel { scatter, factor }: ScatterKernel) -> Self {
        let up = ScatterKernel { scatter: scatter.reversed(), factor: factor.clone() };
        self.transmission = Some([ScatterKernel { scatter, factor }, up]);
        self
    }

    /// The same with light from above scattered back like this.
    pub fn with_reflection_above(mut self, kernel: ScatterKernel) -> Self {
        self.reflection[0] = Some(kernel.reciprocal());
        self
    }

    /// The same with light from below scattered back like this.
    pub fn with_reflection_below(mut self, kernel: ScatterKernel) -> Self {
        self.reflection[1] = Some(kernel.reciprocal());
        self
    }

    /// A pixel under a medium of this index: what it does not send back it takes.
    pub(crate) fn pixel(kernel: ScatterKernel, index: &Spectrum) -> Self {
        let face = Self::new(index.map(|_| 0.0)).with_reflection_above(kernel);
        Self { disc: Some(index.clone()), ..face }
    }

    /// The radius of its disc, if it is a pixel.
    pub(crate) fn disc(&self, bin: usize) -> Option<f64> {
        self.disc.as_ref().map(|disc| disc[bin])
    }

    /// The share that passes straight, per wavelength.
    pub fn straight(&self) -> &Spectrum {
        &self.straight
    }

    /// What goes through, of light on its way down or up.
    pub(crate) fn through(&self, going: Going) -> Option<&ScatterKernel> {
        self.transmission.as_ref().map(|ways| &ways[going as usize])
    }

    /// What is sent back, of light on its way down or up.
    pub(crate) fn back(&self, going: Going) -> Option<&ScatterKernel> {
        self.reflection[going as usize].as_ref()
    }

    /// The least width of its kernels.
    pub(crate) fn width(&self) -> f64 {
        let disc = self.disc.as_ref().map_or(1.0, Spectrum::min);
        disc * self.kernels().map(|kernel| kernel.scatter.width()).fold(f64::INFINITY, f64::min)
    }

    /// Where its kernels jump but for the rim of the air disc, `|beta|`; one that ends at the normal itself, as a table of that
    /// incidence alone, leaves no interval before its end.
    pub(crate) fn edges(&self, bin: usize) -> impl Iterator<Item = f64> {
        let disc = self.disc(bin).unwrap_or(1.0);
        let edges = self.kernels().flat_map(|kernel| kernel.scatter.edges());
        edges.filter(|edge| *edge > 0.0).map(move |edge| edge * disc)
    }

    /// All kernels, of light from above.
    pub(crate) fn kernels(&self) -> impl Iterator<Item = &ScatterKernel> {
        self.through(Going::Down).into_iter().chain(self.reflection.iter().flatten())
    }
}

impl ScatterKernel {
    pub(crate) fn reciprocal(self) -> Self {
        Self { scatter: self.scatter.reciprocal(), ..self }
    }

    /// The share of light with this `|beta|` that is sent on, before the factor.
    pub(crate) fn total(&self, beta_length: f64) -> f64 {
        if beta_length <= self.scatter.discs()[0] { self.scatter.albedo_at(beta_length) } else { 0.0 }
    }
}

/// Where the first of some kernels ends within its disc.
fn least_edge<'a>(kernels: impl IntoIterator<Item = &'a ScatterKernel>) -> Option<f64> {
    let edges = kernels.into_iter().flat_map(|kernel| kernel.scatter.edges());
    edges.filter(|edge| *edge < 1.0).reduce(f64::min)
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
    /// The `|beta|` beyond which nothing is known of what is seen from above: where the table of the first thing that scatters
    /// ends. `None` if it goes on to the horizon.
    pub fn known_within(&self) -> Option<f64> {
        let Self::Layered(layered) = self else { return None };
        for Layer { interface, medium } in &layered.layers {
            match interface {
                Interface::Scatter(face) => {
                    let from_above = [face.through(Going::Down), face.back(Going::Down)];
                    return least_edge(from_above.into_iter().flatten());
                }
                Interface::Diffuser(_) | Interface::Rough(_) => return None,
                _ if medium.scattering().is_some() => return None,
                _ => {}
            }
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
}
