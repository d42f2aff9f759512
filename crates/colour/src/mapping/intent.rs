//! Choices of a gamut mapping.

use crate::{Viewing, Xyz};

/// What a picture on the display preserves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intent {
    /// Lightness of light tones, hue, and chroma as far as the hull allows; dark tones bend towards black.
    #[default]
    Natural,
    /// As natural, with darker dark tones and more chroma.
    Vivid,
    /// Colours relative to white and black; those outside the hull keep lightness and hue.
    Relative,
    /// Colours relative to a perfect white in the light; those outside the hull keep lightness and hue.
    Absolute,
    /// Colours relative to white and black; those outside the hull become the nearest of the hull.
    Clip,
}

/// Space in which hue and lightness are constant.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum MapSpace {
    /// [Oklab](crate::Oklab), after adaptation of the display's white to D65.
    #[default]
    Oklab,
    /// [CAM16-UCS](crate::Cam16Ucs) in these viewing conditions, with complete adaptation to the display's
    /// white.
    Cam16Ucs(Viewing),
}

/// Colours of a display to which those of a picture are relative, in one light and view and on one scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DisplayColours {
    /// The white state.
    pub white: Xyz,
    /// The black state.
    pub black: Xyz,
    /// A perfect white diffuser in the same light; for [`Intent::Absolute`].
    pub perfect_white: Xyz,
}
