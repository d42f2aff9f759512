//! `[metrics]`: colorimetric settings.

use papilio_display::scene::{ReferenceWhite, Standard, Surround};

use super::numbers::{AdaptingLuminance, Background};
use crate::grammar::{choice, table};
use crate::read::Spanned;
use crate::word::Word;

table! {
    /// Colorimetric settings.
    Metrics {
        /// CIE standard observer for X, Y and Z.
        observer: Word<Standard> = Word(Standard::Cie1931),
        /// White of CIELAB, CIELUV, colour differences and the gamut volume.
        white: Word<ReferenceWhite> = Word(ReferenceWhite::Perfect),
        /// Name of the state with which the others are compared. Default: `"white"`, if there is one.
        reference_state: Option<String>,
        /// Whether to report the reflectance factors in each light separately.
        spectra_by_light: bool = false,
        /// Whether to compute the volume of the gamut in CIELAB, and its rings.
        gamut_volume: bool = false,
        /// Viewing conditions for the appearance of the states (CIECAM16), which is then computed too.
        appearance: Option<Appearance>,
    }
}

choice! {
    for ReferenceWhite {
        /// A perfect white diffuser in the same light.
        Perfect = "perfect",
        /// The state `white` of the display, in the same view and light.
        Display = "display",
    }
}

choice! {
    for Standard {
        /// CIE 1931, 2 degrees.
        Cie1931 = "1931",
        /// CIE 1964, 10 degrees.
        Cie1964 = "1964",
    }
}

table! {
    /// Viewing conditions of CIECAM16.
    Appearance {
        /// Luminance to which the eye is adapted. Default: that of the background.
        adapting_luminance_cd_m2: Option<AdaptingLuminance>,
        /// Luminance of the background over that of a perfect white in the same light.
        background: Background = Background(0.2),
        /// Surround of the display.
        surround: Word<Surround> = Word(Surround::Average),
    }
}

choice! {
    for Surround {
        /// A surround about as bright as the display.
        Average = "average",
        /// A surround less than a fifth as bright.
        Dim = "dim",
        /// A dark surround.
        Dark = "dark",
    }
}
