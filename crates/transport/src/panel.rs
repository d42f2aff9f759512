//! The ordinary panel, top to bottom: front of screen, a surface or one diffuser, clear glass, the base (the
//! pixel). Both solvers are fastest for it; any other order of layers is a [`Layered`](crate::Layered)
//! display.

use papilio_spectra::Spectrum;

use crate::{Base, Diffuser, Front, Medium};

/// A front of screen, one surface or diffuser, clear glass and a base.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Front of screen, in air.
    pub front: Front,
    /// Interface between air and the medium.
    pub top: Top,
    /// The medium above the base.
    pub medium: Medium,
    /// The pixel.
    pub base: Base,
    /// Whether light is followed through a single pass of the panel only (Feng 2012, eq. 3-5).
    pub single_pass: bool,
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
