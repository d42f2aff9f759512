//! `[[lighting.environment]]`: light from many directions at once.

use super::lighting::LightSpectrum;
use super::numbers::{
    Azimuth, CapEnd, Count, Elevation, FieldAngle, Horizon, Inclination, Latitude, Metres, Share,
};
use crate::grammar::{choice, kinds, table};
use crate::read::Spanned;

kinds! {
    /// Light from many directions at once; its keys depend on `model`.
    Environment by "model" {
        /// A ring of uniform radiance around the normal.
        Ring(Ring) = "ring",
        /// A cap of uniform radiance.
        Cap(Cap) = "cap",
        /// A table of radiance over inclination, the same at all azimuths.
        Profile(Profile) = "profile",
        /// A CIE standard general sky.
        Sky(Sky) = "sky",
        /// A map of radiance over the whole sphere.
        Map(Map) = "map",
        /// A distant luminaire, given by its IES or EULUMDAT file.
        Luminaire(Luminaire) = "luminaire",
    }
}

table! {
    /// A ring of uniform radiance around the normal, such as a ring light.
    Ring {
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of the centre of the ring.
        theta_deg as "Inclination": Horizon,
        /// Full width of the ring, within 0 to 90 deg.
        width_deg as "Width": Horizon,
    }
}

table! {
    /// A cap of uniform radiance around the normal or any other direction, cut off at the horizon of the
    /// display.
    Cap {
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of the axis of the cap.
        theta_deg as "Inclination": Inclination = Inclination(0.0),
        /// Azimuth of the axis of the cap.
        phi_deg as "Azimuth": Azimuth = Azimuth(0.0),
        /// First angle of the cap from its axis.
        from_deg as "Inner radius": FieldAngle = FieldAngle(0.0),
        /// Last angle of the cap, above `from_deg`; the horizon also ends it.
        to_deg as "Outer radius": CapEnd = CapEnd(180.0),
    }
}

choice! {
    /// Angles of a profile.
    ProfileAngles {
        /// Angles are from the normal.
        Inclination = "inclination",
        /// Angles are from the display's plane.
        Elevation = "elevation",
    }
}

table! {
    /// Light that is the same at all azimuths. Its radiance is linear between the rows of a table, and 0
    /// beyond them.
    Profile {
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// A file with two columns: angle in degrees (0 to 90, increasing) and relative radiance (0 or more).
        file: String,
        /// Meaning of the angles of the file.
        angles: ProfileAngles = ProfileAngles::Inclination,
    }
}

table! {
    /// A CIE standard general sky (ISO 15469).
    Sky {
        /// Fraction of `illuminance_lx` from sky and ground, without the sun's disc.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Type of the sky: 1 to 15 of ISO 15469 (1 overcast, 5 uniform, 12 clear), 16 the traditional
        /// overcast sky.
        number as "CIE sky number": Count<1, 16>,
        /// Elevation of the sun above the horizon. Default: required, except for skies 1, 3, 5 and 16 without
        /// a sun.
        sun_elevation_deg: Option<Elevation>,
        /// Azimuth of the sun, counterclockwise seen from above, from the display's x axis.
        sun_azimuth_deg: Azimuth = Azimuth(0.0),
        /// Fraction of `illuminance_lx` from the sun's disc, whose radius is 0.27 deg.
        sun_share as "Light fraction of the sun": Share = Share(0.0),
        /// Relative spectrum of the sun's disc. Default: that of the lighting.
        sun_spectrum: Option<LightSpectrum>,
        /// Degree of linear polarisation p of the sky at 90 deg from the sun: about 0.75 for a clear one;
        /// elsewhere p sin^2/(1 + cos^2) of the angle from the sun (Rayleigh). The sun's disc and the ground
        /// are unpolarised.
        polarisation as "Polarisation of the sky": Share = Share(0.0),
        /// Tilt of the display: 0 is flat, facing the zenith; 90 is upright, facing azimuth -90 deg.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Reflectance of the ground that a tilted display sees below the horizon.
        ground_reflectance: Share = Share(0.0),
    }
}

table! {
    /// An equirectangular map of radiance over the whole sphere.
    Map {
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum of the map's white; not for a spectral map. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// A Radiance (.hdr) or OpenEXR (.exr) picture, equirectangular, twice as wide as high.
        file: String,
        /// Rotation of the map about the vertical, counterclockwise seen from above; at 0 an upright display
        /// faces its centre.
        rotate_deg: Azimuth = Azimuth(0.0),
        /// Tilt of the display: 0 is flat, facing the zenith; 90 is upright, facing azimuth -90 deg.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Regions of a colour map with spectra of their own; a pixel belongs to the first that contains it.
        /// Default: none.
        regions: Vec<Spanned<Region>> = Vec::new(),
    }
}

table! {
    /// A region of a map with a spectrum of its own: its pixels keep their luminance, but not their colour.
    Region {
        /// Relative spectrum of its light.
        spectrum: LightSpectrum,
        /// First and last elevation above the horizon of the map.
        elevation_deg: Vec<Spanned<Latitude>> = vec![Spanned::without_span(Latitude(-90.0)), Spanned::without_span(Latitude(90.0))],
        /// First and last azimuth of the region, counterclockwise seen from above, from the display's x axis;
        /// the centre of the map is at -90. The region rotates with the map.
        azimuth_deg: Vec<Spanned<Azimuth>> = vec![Spanned::without_span(Azimuth(-180.0)), Spanned::without_span(Azimuth(180.0))],
    }
}

table! {
    /// A distant luminaire: a disc of the size of its opening, reported among the directed sources.
    Luminaire {
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// An IES LM-63 file (.ies) or a EULUMDAT file (.ldt).
        file: String,
        /// Elevation above the horizon, seen from the display.
        elevation_deg: Elevation,
        /// Azimuth, counterclockwise seen from above, from the display's x axis.
        azimuth_deg: Azimuth = Azimuth(0.0),
        /// Distance.
        distance_m: Metres,
        /// Azimuth of its plane C = 0. Type A: of its axis. Type B: of the side to which its vertical angles are
        /// positive.
        rotation_deg: Azimuth = Azimuth(0.0),
        /// Tilt of the display: 0 is flat, facing the zenith; 90 is upright, facing azimuth -90 deg.
        tilt_deg: FieldAngle = FieldAngle(0.0),
    }
}
