//! A state for each pixel of a picture.

use papilio_imaging::halftone::ErrorDiffusion;

use super::{ImageSettings, Rendering};
use crate::DisplayError;

/// How pixels with few states show many colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Halftone {
    /// Every pixel shows the mapped colour itself: a reference without halftone.
    None,
    /// The error of each pixel is passed on to its neighbours.
    #[default]
    ErrorDiffusion,
}

/// The state of each pixel, none without a halftone, and the number of pixels at which colour was lost.
pub(super) fn states(
    settings: &ImageSettings,
    mapped: &[[f32; 3]],
    columns: usize,
    rendering: &Rendering,
) -> Result<(Vec<u8>, usize), DisplayError> {
    match settings.halftone {
        Halftone::None => Ok((Vec::new(), 0)),
        Halftone::ErrorDiffusion => {
            let (kernel, scan, metric) = (settings.kernel, settings.scan, rendering.metric());
            let diffusion = ErrorDiffusion { kernel, scan, metric, ..ErrorDiffusion::default() };
            let found = diffusion.colours(mapped, columns, &rendering.states)?;
            Ok((found.states, found.cut_pixels))
        }
    }
}
