//! `[metrics]`: what is said of the colours.

use super::numbers::{AdaptingLuminance, Background};
use crate::grammar::{choice, table};
use crate::read::At;

table! {
    /// What is said of the colours.
    Metrics {
        /// Whose X, Y and Z. Default "1931".
        observer: Observer = Observer::Cie1931,
        /// Name of the state that the others are compared with. Default "white".
        reference_state: Option<String>,
        /// Whether to keep the reflectance factors under each light alone. Default false.
        spectra_by_light: bool = false,
        /// Whether to find the volume of the gamut in CIELAB, and its rings. Default false.
        gamut_volume: bool = false,
        /// Viewing conditions: also say what the states look like (CIECAM16). Default: none.
        appearance: Option<Appearance>,
    }
}

choice! {
    /// A CIE standard observer.
    Observer {
        /// Of 1931, 2 degrees.
        Cie1931 = "1931",
        /// Of 1964, 10 degrees.
        Cie1964 = "1964",
    }
}

table! {
    /// Viewing conditions of CIECAM16.
    Appearance {
        /// Luminance that the eye is adapted to, cd/m2, 0.01 to 1e6. Default: that of the background.
        adapting_luminance_cd_m2: Option<AdaptingLuminance>,
        /// Luminance of the background over that of a perfect white in the same light, 0.01 to 1. Default 0.2.
        background: Background = Background(0.2),
        /// What is around the display. Default "average".
        surround: Surround = Surround::Average,
    }
}

choice! {
    /// What is around a display.
    Surround {
        /// About as bright as the display.
        Average = "average",
        /// Less than a fifth as bright.
        Dim = "dim",
        /// Nothing.
        Dark = "dark",
    }
}
