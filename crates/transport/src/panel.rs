//! The ordinary panel, top to bottom: front of screen, a surface or one diffuser, clear glass, the base (the
//! pixel). Both solvers are fastest for it. A [`Stack`](crate::Stack) recognises it among any layers, by the
//! rule of [`PanelParts::recognised`].

use std::borrow::Cow;
use std::sync::Arc;

use papilio_optics::film::Polarisation;
use papilio_spectra::Spectrum;

use crate::layers::fresnel_of;
use crate::{Base, Component, Diffuser, FlatRun, Front, Interface, Layer, Medium, Mueller, WholeView};

/// A front of screen, one surface or diffuser, clear glass and a base, as a [`Stack`](crate::Stack) shows it.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Front of screen, in air.
    pub front: Front,
    /// Its components, outermost first.
    pub components: Vec<Component>,
    /// Interface between air and the medium.
    pub top: Top,
    /// The polarisation of the light, if it is one.
    pub polarisation: Option<Polarisation>,
    /// Whether front and face keep s and p apart in the light that they return to each other, above a pixel that mixes both.
    pub keeps_s_and_p: bool,
    /// The medium above the base.
    pub medium: Medium,
    /// Air below each component of the front of screen, outermost first, then the medium, mm.
    pub gaps_mm: Vec<f64>,
    /// The pixel.
    pub base: Base,
    /// Whether light is followed through a single pass of the panel only (Feng 2012, eq. 3-5).
    pub single_pass: bool,
    /// The pixel for polarised light, if it changes polarisation and the top is flat.
    pub mueller: Option<Arc<Mueller>>,
    /// What is polarised above it.
    pub whole: Option<WholeView>,
    /// Above such a pixel, several flat layers, in the place of front and top.
    pub run: Option<FlatRun>,
}

/// Interface between air and the medium.
#[derive(Debug, Clone)]
pub enum Top {
    /// An ideal antireflection interface: transmits |beta| <= 1 completely, reflects the rest completely.
    IdealAr,
    /// A bare surface of a solid of this index, unpolarised Fresnel.
    Fresnel(Spectrum),
    /// A diffuser, including its surfaces.
    Diffuser(Diffuser),
}

/// Approximations of Feng 2012, which exist for panels only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Approximation {
    /// Light is followed through a single pass of the panel (eq. 3-5), and the front of screen is combined to
    /// first order.
    pub single_pass: bool,
    /// The medium above the base has the directions of the air.
    pub unrefracted: bool,
}

impl Approximation {
    /// True if nothing is approximated.
    pub fn is_none(self) -> bool {
        self == Self::default()
    }
}

/// What any layers have to be for an ordinary panel, by layer from the top: its interface (`None`: one that
/// is not prepared yet), the index of the medium below it, and whether that medium neither absorbs nor
/// scatters.
pub type Described<'a> = (Option<&'a Interface>, &'a Spectrum, bool);

/// The parts of an ordinary panel among layers.
#[derive(Debug, Clone, PartialEq)]
pub struct PanelParts<'a> {
    /// Components of the front of screen, in air, outermost first.
    pub front: Vec<&'a Component>,
    /// The interface between air and the glass: a diffuser, or a flat face.
    pub face: &'a Interface,
}

impl<'a> PanelParts<'a> {
    /// Returns the parts of the panel that these layers are, above a pixel that does not scatter: components
    /// in air, then one face or one diffuser without a reflection of its own, then clear glass. `None` for
    /// all other layers.
    pub fn recognised(layers: impl IntoIterator<Item = Described<'a>>) -> Option<Self> {
        let mut front: Vec<_> = layers.into_iter().collect();
        let (face, _, glass_is_clear) = front.pop()?;
        // Between media of one index a bare interface is open.
        let faces = |face: &&Interface| {
            matches!(
                face,
                Interface::Diffuser(_)
                    | Interface::IdealAr
                    | Interface::Fresnel
                    | Interface::FresnelOf(_)
                    | Interface::Open
            )
        };
        let face = face.filter(faces).filter(|_| glass_is_clear)?;
        let component = |(interface, index, is_clear): Described<'a>| match interface {
            Some(Interface::Component(component)) if is_clear && index.iter().all(|n| *n == 1.0) => {
                Some(component)
            }
            _ => None,
        };
        Some(Self { front: front.into_iter().map(component).collect::<Option<_>>()?, face })
    }

    /// Returns the diffuser, if the face is one.
    pub fn diffuser(&self) -> Option<&'a Diffuser> {
        match self.face {
            Interface::Diffuser(diffuser) => Some(diffuser),
            _ => None,
        }
    }
}

impl Panel {
    /// The panel of these parts of layers; `glass` is the last of them.
    pub(crate) fn new(
        parts: &PanelParts<'_>,
        (layers, glass): (&[Layer], &Layer),
        base: Base,
        Approximation { single_pass, unrefracted }: Approximation,
    ) -> Self {
        let medium = &glass.medium;
        let index = medium.index();
        let components = parts.front.iter().map(|one| (&*one.reflectance, &*one.absorptance));
        Self {
            front: match single_pass {
                true => Front::first_order(base.bins(), components),
                false => Front::exact(base.bins(), components),
            },
            components: parts.front.iter().map(|one| (*one).clone()).collect(),
            top: match parts.face {
                Interface::Diffuser(diffuser) => Top::Diffuser(diffuser.clone()),
                Interface::IdealAr => Top::IdealAr,
                _ => Top::Fresnel(index.clone()),
            },
            polarisation: match parts.face {
                Interface::FresnelOf(polarisation) => Some(*polarisation),
                _ => None,
            },
            keeps_s_and_p: false,
            medium: match unrefracted {
                true => Medium::new(index.map(|_| 1.0)),
                false => medium.clone(),
            },
            gaps_mm: layers.iter().map(|layer| layer.thickness_mm).collect(),
            base,
            single_pass,
            mueller: None,
            whole: None,
            run: None,
        }
    }

    /// The panel of several flat layers above a mirror-like pixel that may change polarisation.
    pub(crate) fn below_run(run: FlatRun, medium: &Medium, base: Base) -> Self {
        Self {
            front: Front::none(base.bins()),
            components: Vec::new(),
            top: Top::Fresnel(medium.index().clone()),
            polarisation: None,
            keeps_s_and_p: false,
            medium: medium.clone(),
            gaps_mm: Vec::new(),
            base,
            single_pass: false,
            mueller: None,
            whole: None,
            run: Some(run),
        }
    }

    /// What front and face keep apart: s and p, or nothing but the polarisation of all light (`None`: unpolarised).
    pub(crate) fn polarisations(&self) -> &[Option<Polarisation>] {
        match self.keeps_s_and_p {
            true => &[Some(Polarisation::S), Some(Polarisation::P)],
            false => std::slice::from_ref(&self.polarisation),
        }
    }

    /// Returns the panel for light of each of them.
    pub(crate) fn of_each(&self) -> Vec<Cow<'_, Self>> {
        let of = |one: &Option<Polarisation>| match self.keeps_s_and_p {
            true => Cow::Owned(Self { polarisation: *one, keeps_s_and_p: false, ..self.clone() }),
            false => Cow::Borrowed(self),
        };
        self.polarisations().iter().map(of).collect()
    }

    /// Returns the reflectance of the face above a medium of this index, for s and p; if they are not kept apart, twice the
    /// mean of both, or that of the polarisation of the light. `beta` is 0 to 1.
    pub fn face_reflectances(&self, index: f64, beta: f64) -> [f64; 2] {
        let of = |polarisation| match self.top {
            Top::Fresnel(_) => fresnel_of(polarisation, [1.0, index], beta),
            Top::IdealAr | Top::Diffuser(_) => 0.0,
        };
        match self.keeps_s_and_p {
            true => [Polarisation::S, Polarisation::P].map(|one| of(Some(one))),
            false => [of(self.polarisation); 2],
        }
    }
}
