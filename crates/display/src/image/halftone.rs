//! A state for each pixel of a picture.

use papilio_imaging::halftone::{ErrorDiffusion, Mask};

use super::masks::masked;
use super::search::searched;
use super::{ImageSettings, Rendering};
use crate::DisplayError;
use crate::palette::Palette;
use crate::run::Control;

/// How pixels with few states show many colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Halftone {
    /// Every pixel shows the mapped colour itself: a reference without halftone.
    None,
    /// Each pixel is compared with Bayer's mask.
    Ordered,
    /// Each pixel is compared with a void-and-cluster mask.
    VoidAndCluster,
    /// The error of each pixel is passed on to its neighbours.
    #[default]
    ErrorDiffusion,
    /// Error diffusion, then changes of pixels as long as one lowers the visible error.
    DirectBinarySearch,
}

/// Columns and rows of Bayer's mask: 256 levels. The mask of 8 x 8 pixels has 64, whose steps are visible in dark gradients.
const BAYER: usize = 16;

/// Columns and rows of the void-and-cluster mask: 4096 levels.
const VOID_AND_CLUSTER: usize = 64;

/// What a halftone depends on besides the picture and the settings.
pub(super) struct Panel<'a> {
    pub(super) columns: usize,
    pub(super) palette: &'a Palette,
    pub(super) rendering: &'a Rendering,
    /// Pixels in a degree of the visual angle, along x and y.
    pub(super) pixels_per_degree: Option<[f64; 2]>,
    /// Part of a pixel's light that is seen in each of its neighbours, `REACH_OF_LAYERS` pixels around it; `None` without blur.
    pub(super) spread: Option<Vec<f64>>,
}

/// The state of each pixel, none without a halftone, and the number of pixels at which colour was lost.
pub(super) fn states(
    settings: &ImageSettings,
    mapped: &[[f32; 3]],
    panel: &Panel<'_>,
    control: &Control<'_>,
) -> Result<(Vec<u8>, usize), DisplayError> {
    if let Some(given) = &settings.given {
        let states = panel.palette.colours.len();
        let highest = given.iter().map(|state| usize::from(*state)).max().unwrap_or(0);
        if given.len() != mapped.len() || highest >= states {
            let (pixels, expected) = (given.len(), mapped.len());
            return Err(DisplayError::GivenStates { pixels, expected, highest, states });
        }
        return Ok((given.clone(), 0));
    }
    match settings.halftone {
        Halftone::None => Ok((Vec::new(), 0)),
        Halftone::Ordered => Ok((masked(&Mask::bayer(BAYER)?, mapped, panel, control)?, 0)),
        Halftone::VoidAndCluster => {
            let mask = Mask::void_and_cluster(VOID_AND_CLUSTER, settings.seed)?;
            Ok((masked(&mask, mapped, panel, control)?, 0))
        }
        Halftone::ErrorDiffusion | Halftone::DirectBinarySearch => {
            let (kernel, scan, metric) = (settings.kernel, settings.scan, panel.rendering.metric());
            let diffusion = ErrorDiffusion { kernel, scan, metric, ..ErrorDiffusion::default() };
            let found = diffusion.colours(mapped, panel.columns, &panel.rendering.states)?;
            if settings.halftone == Halftone::ErrorDiffusion {
                return Ok((found.states, found.cut_pixels));
            }
            Ok((searched(&found.states, mapped, panel, control)?, found.cut_pixels))
        }
    }
}
