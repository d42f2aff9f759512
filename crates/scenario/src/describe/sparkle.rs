//! `[sparkle]`: an antiglare face above the pixels.

use super::numbers::{CorrelationLength, Count, FaceSlope, InnerShare, Pupil, Thickness};
use crate::grammar::{forms, table};
use crate::read::Spanned;

table! {
    /// An antiglare face, for `papilio sparkle` only.
    Sparkle {
        /// Root mean square slope of the face along one axis; or `haze`.
        slope_rms as "Slope of the face": Option<FaceSlope>,
        /// Fraction of light along the normal that a plate with this face transmits beyond 2.5 deg; or
        /// `slope_rms`.
        haze: Option<InnerShare>,
        /// Distance at which the correlation of the heights exp(-r^2/xi^2) is 1/e, or several. Required with
        /// `slope_rms` or `haze`.
        correlation_um as "Correlation length": Option<CorrelationLengths>,
        /// Distance of face and pixels in the medium above the pixels, or several. Default: the media of the
        /// display below the face.
        gap_mm: Option<FaceGaps>,
        /// Diameter of the viewer's pupil at `viewer.distance_mm`, or of a camera's; 0 is a pinhole.
        pupil_mm as "Diameter of the pupil": Pupil = Pupil(4.0),
        /// Number of independent faces, with at least 1024 pixels together: fewer than 32 are larger, and
        /// take as long.
        replicates: Count<2, 4096> = Count(32),
    }
}

forms! {
    /// Correlation lengths: a number, or a list.
    CorrelationLengths, format!("{}, or a list", <CorrelationLength as crate::read::Read>::in_words()); {
        /// One face.
        One(CorrelationLength) if Value::Integer(_) | Value::Float(_),
        /// Several faces.
        List(Vec<Spanned<CorrelationLength>>) if Value::Array(_),
    }
}

forms! {
    /// Distances of face and pixels: a number, or a list.
    FaceGaps, format!("{}, or a list", <Thickness as crate::read::Read>::in_words()); {
        /// One distance.
        One(Thickness) if Value::Integer(_) | Value::Float(_),
        /// Several distances.
        List(Vec<Spanned<Thickness>>) if Value::Array(_),
    }
}
