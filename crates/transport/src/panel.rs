//! The ordinary panel, top to bottom: front of screen, then a face or one diffuser, then
//! clear glass, then the base (the pixel). Both solvers are fastest for it; any other order of
//! layers is a [`Layered`](crate::Layered) display.

use papilio_spectra::Spectrum;

use crate::{Base, Diffuser, Front, Medium};

/// A front of screen, one face or diffuser, clear glass and a base.
#[derive(Debug, Clone)]
pub struct Panel {
    /// Front of screen, in air.
    pub front: Front,
    /// What stands between air and the medium.
    pub top: Top,
    /// The medium above the base.
    pub medium: Medium,
    /// The pixel.
    pub base: Base,
    /// Light is not followed into a second pass through the panel (Feng 2012, eq. 3-5).
    pub single_pass: bool,
}

/// What stands between air and the medium.
#[derive(Debug, Clone)]
pub enum Top {
    /// A perfect antireflection face: passes |beta| <= 1 whole, reflects the rest whole.
    Coated,
    /// A bare face of a solid of this index, unpolarised Fresnel.
    Fresnel(Spectrum),
    /// A diffuser, its faces included.
    Diffuser(Diffuser),
}
