//! `[[lighting.environment]]`: light from all over the sky or the room.

use super::lighting::LightSpectrum;
use super::numbers::{
    Azimuth, CapEnd, Count, Elevation, FieldAngle, Horizon, Inclination, Latitude, Metres, Share,
};
use crate::grammar::{choice, kinds, table};
use crate::read::At;

kinds! {
    /// Light from many directions at once; its keys depend on `model`.
    Environment by "model" {
        /// A ring around the normal, of uniform radiance.
        Ring(Ring) = "ring",
        /// A part of the hemisphere, of uniform radiance.
        Cap(Cap) = "cap",
        /// The same at all azimuths: a table over inclination.
        Profile(Profile) = "profile",
        /// A CIE standard general sky.
        Sky(Sky) = "sky",
        /// A picture of the whole sphere.
        Map(Map) = "map",
        /// A distant luminaire, by its IES file.
        Luminaire(Luminaire) = "luminaire",
    }
}

table! {
    /// A ring of uniform radiance around the normal, such as a ring light.
    Ring {
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of the middle of the ring.
        theta_deg: Horizon,
        /// Full width of the ring; the whole ring is between 0 and 90 deg.
        width_deg: Horizon,
    }
}

table! {
    /// A part of the hemisphere of uniform radiance, around the normal or any other direction; the display's horizon ends it.
    Cap {
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of the axis; 0 is the normal.
        theta_deg: Inclination = Inclination(0.0),
        /// Azimuth of the axis.
        phi_deg: Azimuth = Azimuth(0.0),
        /// Angle from the axis where the cap begins.
        from_deg: FieldAngle = FieldAngle(0.0),
        /// Angle from the axis where the cap ends, above `from_deg`; the display's horizon ends it in any case.
        to_deg: CapEnd = CapEnd(180.0),
    }
}

choice! {
    /// What the first column of a profile is.
    ProfileAngles {
        /// From the normal.
        Inclination = "inclination",
        /// From the display's plane.
        Elevation = "elevation",
    }
}

table! {
    /// Light that is alike at all azimuths, its radiance linear between the rows of a table, dark beyond them.
    Profile {
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// A file of two columns: angle in degrees (0 to 90, rising) and relative radiance.
        file: String,
        /// What the angles of the file are.
        angles: ProfileAngles = ProfileAngles::Inclination,
    }
}

table! {
    /// A CIE standard general sky (ISO 15469).
    Sky {
        /// Fraction of `illuminance_lx` that comes from sky and ground.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Type of sky as in ISO 15469 (1 overcast, 5 uniform, 12 clear), or 16 for the traditional overcast sky.
        number: Count<1, 16>,
        /// Elevation of the sun above the horizon. Default: required, but for skies 1, 3, 5 and 16 without a sun.
        sun_elevation_deg: Option<Elevation>,
        /// Azimuth of the sun, counterclockwise seen from above, from the display's x axis.
        sun_azimuth_deg: Azimuth = Azimuth(0.0),
        /// Fraction of `illuminance_lx` that comes from the sun's disc, whose radius is 0.27 deg.
        sun_share: Share = Share(0.0),
        /// Relative spectrum of the sun's disc. Default: that of the lighting.
        sun_spectrum: Option<LightSpectrum>,
        /// Tilt of the display: at 0 it lies flat and faces the zenith, at 90 it is upright and faces azimuth -90 deg.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Reflectance of the ground, which a tilted display sees below the horizon.
        ground_reflectance: Share = Share(0.0),
    }
}

table! {
    /// A picture of the whole sphere, equirectangular, by radiance.
    Map {
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum of the map's white; not for a map of wavelengths. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// A Radiance picture (.hdr) or an OpenEXR file (.exr), equirectangular, twice as wide as high.
        file: String,
        /// Rotates the map counterclockwise seen from above; at 0 an upright display faces the middle of the map.
        rotate_deg: Azimuth = Azimuth(0.0),
        /// Tilt of the display: at 0 it lies flat and faces the top of the map, at 90 it is upright.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Parts of a map in colours that have measured spectra; a pixel in several regions belongs to the first. Default:
        /// none.
        regions: Vec<At<Region>> = Vec::new(),
    }
}

table! {
    /// A part of a map that has a spectrum of its own: its pixels keep their luminance, and lose their colour.
    Region {
        /// Relative spectrum of the region's light.
        spectrum: LightSpectrum,
        /// Elevations where the region begins and ends, above the horizon of the map.
        elevation_deg: Vec<At<Latitude>> = vec![At::at_large(Latitude(-90.0)), At::at_large(Latitude(90.0))],
        /// Azimuths where the region begins and ends, counterclockwise seen from above, from the display's x axis while
        /// `rotate_deg` is 0 (the middle of the map is at -90). The region rotates with the map.
        azimuth_deg: Vec<At<Azimuth>> = vec![At::at_large(Azimuth(-180.0)), At::at_large(Azimuth(180.0))],
    }
}

table! {
    /// A distant luminaire: a disc of the size of its opening, listed among the directed sources.
    Luminaire {
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// An IES LM-63 file, type C photometry.
        file: String,
        /// Elevation of the luminaire above the horizon, seen from the display.
        elevation_deg: Elevation,
        /// Azimuth of the luminaire, counterclockwise seen from above, from the display's x axis.
        azimuth_deg: Azimuth = Azimuth(0.0),
        /// Distance of the luminaire.
        distance_m: Metres,
        /// Azimuth of the luminaire's own plane C = 0.
        rotation_deg: Azimuth = Azimuth(0.0),
        /// Tilt of the display: at 0 it lies flat, at 90 it is upright and faces azimuth -90 deg.
        tilt_deg: FieldAngle = FieldAngle(0.0),
    }
}
