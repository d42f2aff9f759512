//! `[measure]`: a virtual imaging sphere that measures the diffuser.

use super::Title;
use super::lighting::LightSpectrum;
use super::numbers::{Azimuth, Blur, Count, GridAngle, Horizon, Noise, NoiseFloor, Seed};
use super::viewer::{AngleRange, AngleStep};
use crate::grammar::{choice, forms, table};
use crate::read::Spanned;

table! {
    /// A virtual imaging sphere, for `papilio diffuser measure` only. The defaults are the grid of Feng 2012,
    /// section 3.3.
    Measure {
        /// Name of the sample. Default: that of the output file.
        sample: Option<Title>,
        /// Inclinations of the light, 0 to below 90.
        incidence_deg: GridAngles = uniform(75.0, 5.0),
        /// Azimuths about the specular direction, 0 to 180, both included.
        azimuth_deg: GridAngles = uniform(180.0, 10.0),
        /// Distances from the specular direction, 0 to at most 180.
        radial_deg: GridAngles = uniform(180.0, 2.0),
        /// Channels of the instrument.
        channels: Channels = Channels::Xyz,
        /// The light that weights the channels.
        light: LightSpectrum = LightSpectrum::Text("D65".to_owned()),
        /// Width b of the image of a collimated beam.
        blur: Blur = Blur(0.0),
        /// `true`: values integrate to the total of the sample; `false`: light that the blur moves beyond the
        /// horizon is lost.
        renormalise: bool = true,
        /// Standard deviation of the noise relative to the value.
        noise: Noise = Noise(0.0),
        /// Standard deviation of additional noise, the same for every value. Negative results become 0, as files have no others: the mean
        /// of dark values rises by up to 0.4 of it.
        noise_floor: NoiseFloor = NoiseFloor(0.0),
        /// Seed of the noise.
        seed: Seed = Count(0),
        /// No light is measured beyond this inclination.
        dark_beyond_deg: Horizon = Horizon(90.0),
    }
}

forms! {
    /// Angles of a grid, degrees: a list, or { from, to, step }.
    GridAngles, "a list of angles (degrees), or { from, to, step }"; {
        /// Listed angles.
        List(Vec<Spanned<GridAngle>>) if Value::Array(_),
        /// Uniformly spaced angles.
        Range(AngleRange) if Value::Table(_),
    }
}

choice! {
    /// Channels of the instrument.
    Channels {
        /// CIE X, Y and Z.
        Xyz = "xyz",
        /// One channel, weighted with V(lambda).
        Monochrome = "monochrome",
    }
}

/// Returns angles from 0 to `to`, uniformly spaced.
fn uniform(to: f64, step: f64) -> GridAngles {
    GridAngles::Range(AngleRange {
        from: Spanned::without_span(Azimuth(0.0)),
        to: Spanned::without_span(Azimuth(to)),
        step: Spanned::without_span(AngleStep(step)),
    })
}
