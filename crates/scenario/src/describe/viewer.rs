//! `[viewer]`: the viewing directions, and the reader.

use super::numbers::{Azimuth, FieldAngle, Inclination, InnerShare, Millimetres};
use crate::grammar::{choice, forms, number, table};
use crate::range::Range;
use crate::read::Spanned;

table! {
    /// The views: all combinations of theta and phi; theta varies fastest.
    Viewer {
        /// Inclination of the view, or several.
        theta_deg as "Viewing angle": Inclinations = Inclinations::One(Inclination(0.0)),
        /// Azimuth of the view, or several.
        phi_deg as "Azimuth of the view": Azimuths = Azimuths::One(Azimuth(0.0)),
        /// Full angle of the round field of view, above the horizon.
        field_deg as "Field of view": FieldAngle = FieldAngle(0.1),
        /// Numerical aperture of a microscope's objective, instead of `field_deg`: a uniform mean over the
        /// pupil, in diffuse light alone.
        numerical_aperture as "Numerical aperture": Option<InnerShare>,
        /// Polariser before the eye, such as sunglasses: `"s"`, `"p"`, or the angle of the light that it
        /// passes from the plane of incidence, counter-clockwise as seen by the viewer (docs/light.md).
        polariser as "Angle of the polariser (deg)": Option<Polariser>,
        /// Viewing distance; it determines the angle of text (docs/readability.md), not the colours.
        distance_mm as "Viewing distance": Millimetres = Millimetres(500.0),
        /// Age of the reader of black text (docs/readability.md); 25 if only the text is described.
        age_years as "Age of the reader": Option<Years>,
        /// Height of the lower-case x of the text; 1.6 mm if only the reader is described.
        text_height_mm as "Height of the lower-case x": Option<Millimetres>,
    }
}

forms! {
    /// The light that a polariser passes.
    Polariser, format!("\"s\", \"p\", or {}", PolariserAngle::in_words()); {
        /// From the plane of incidence.
        Angle(PolariserAngle) if Value::Integer(_) | Value::Float(_),
        /// One of the two that a flat face keeps.
        Named(NamedPolariser) if Value::Text(_),
    }
}

choice! {
    /// The polarisations that flat faces keep.
    NamedPolariser {
        /// Perpendicular to the plane of incidence.
        S = "s",
        /// In the plane of incidence.
        P = "p",
    }
}

number!(
    /// Angle of a polariser, degrees.
    PolariserAngle, Range::from_to(-180.0, 180.0).unit("degrees")
);

forms! {
    /// Inclinations in degrees: a number, a list, or { from, to, step }.
    Inclinations, format!("{}, a list, or {{ from, to, step }}", Inclination::in_words()); {
        /// One view.
        One(Inclination) if Value::Integer(_) | Value::Float(_),
        /// Several views.
        List(Vec<Spanned<Inclination>>) if Value::Array(_),
        /// Uniformly spaced views.
        Range(AngleRange) if Value::Table(_),
    }
}

forms! {
    /// Azimuths in degrees: a number, a list, or { from, to, step }.
    Azimuths, format!("{}, a list, or {{ from, to, step }}", Azimuth::in_words()); {
        /// One view.
        One(Azimuth) if Value::Integer(_) | Value::Float(_),
        /// Several views.
        List(Vec<Spanned<Azimuth>>) if Value::Array(_),
        /// Uniformly spaced views.
        Range(AngleRange) if Value::Table(_),
    }
}

table! {
    /// Uniformly spaced angles, including both ends if the steps reach them.
    AngleRange {
        /// First angle.
        from: Azimuth,
        /// Last angle.
        to: Azimuth,
        /// Step.
        step: AngleStep,
    }
}

number!(
    /// Age of a reader.
    Years, Range::from_to(20.0, 75.0).unit("years")
);
number!(
    /// A step of angles, degrees.
    AngleStep, Range::above_0_to(360.0).unit("degrees")
);
