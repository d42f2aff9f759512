//! `[viewer]`: where the reader looks from.

use super::numbers::{Azimuth, FieldAngle, Inclination, Millimetres};
use crate::grammar::{forms, number, table};
use crate::range::Range;
use crate::read::At;

table! {
    /// The views are the product of all theta and phi, theta fastest.
    Viewer {
        /// Inclination of the view.
        theta_deg: Inclinations = Inclinations::One(Inclination(0.0)),
        /// Azimuth of the view.
        phi_deg: Azimuths = Azimuths::One(Azimuth(0.0)),
        /// Full angle of the round field of view; it must not reach below the horizon.
        field_deg: FieldAngle = FieldAngle(0.1),
        /// Viewing distance; matters only where the display is not uniform.
        distance_mm: Millimetres = Millimetres(500.0),
        /// Age of the reader: how well text is read (docs/metrics.md).
        age_years: Option<Years>,
    }
}

forms! {
    /// Inclinations in degrees: a number, a list, or { from, to, step }.
    Inclinations, format!("{}, a list, or {{ from, to, step }}", Inclination::in_words()); {
        /// One view.
        One(Inclination) if Value::Integer(_) | Value::Float(_),
        /// Several.
        List(Vec<At<Inclination>>) if Value::Array(_),
        /// Evenly spaced.
        Range(AngleRange) if Value::Table(_),
    }
}

forms! {
    /// Azimuths in degrees: a number, a list, or { from, to, step }.
    Azimuths, format!("{}, a list, or {{ from, to, step }}", Azimuth::in_words()); {
        /// One view.
        One(Azimuth) if Value::Integer(_) | Value::Float(_),
        /// Several.
        List(Vec<At<Azimuth>>) if Value::Array(_),
        /// Evenly spaced.
        Range(AngleRange) if Value::Table(_),
    }
}

table! {
    /// Evenly spaced angles, both ends included where the steps reach them.
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
