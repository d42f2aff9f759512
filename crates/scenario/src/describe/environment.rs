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
        /// An even ring around the normal.
        Ring(Ring) = "ring",
        /// An even part of the hemisphere.
        Cap(Cap) = "cap",
        /// Alike at all azimuths, by a table over inclination.
        Profile(Profile) = "profile",
        /// A CIE standard general sky.
        Sky(Sky) = "sky",
        /// A picture of the whole sphere.
        Map(Map) = "map",
        /// A luminaire by its IES file, far away.
        Luminaire(Luminaire) = "luminaire",
    }
}

table! {
    /// An even ring around the normal, such as a ring light.
    Ring {
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of the middle of the ring, above 0, at most 90 deg.
        theta_deg: Horizon,
        /// Full width of the ring, degrees: all of it lies between 0 and 90 deg.
        width_deg: Horizon,
    }
}

table! {
    /// An even part of the hemisphere around the normal, or around any other direction; the display's horizon ends it.
    Cap {
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Inclination of its axis, degrees, between -90 and 90. Default 0, the normal.
        theta_deg: Inclination = Inclination(0.0),
        /// Azimuth of its axis, degrees. Default 0.
        phi_deg: Azimuth = Azimuth(0.0),
        /// Angle from the axis where it begins, degrees. Default 0.
        from_deg: FieldAngle = FieldAngle(0.0),
        /// Angle from the axis where it ends, above `from_deg`, at most 180 deg. Default 180: at the horizon.
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
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Two columns: angle in degrees, 0 to 90, and relative radiance.
        file: String,
        /// What the angles are. Default "inclination", from the normal.
        angles: ProfileAngles = ProfileAngles::Inclination,
    }
}

table! {
    /// A CIE standard general sky (ISO 15469).
    Sky {
        /// Share of `illuminance_lx` that comes from sky and ground, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// 1 to 15 as in ISO 15469 (1 overcast, 5 uniform, 12 clear); 16: the traditional overcast sky.
        number: Count<1, 16>,
        /// Elevation of the sun above the horizon, above 0, at most 90 deg; skies 1, 3, 5 and 16 need none.
        sun_elevation_deg: Option<Elevation>,
        /// Azimuth of the sun, counterclockwise seen from above, from the display's x axis, degrees. Default 0.
        sun_azimuth_deg: Azimuth = Azimuth(0.0),
        /// Share of `illuminance_lx` that comes from the sun's disc, of radius .27 deg. Default 0.
        sun_share: Share = Share(0.0),
        /// Relative spectrum of the sun's disc. Default: that of the lighting.
        sun_spectrum: Option<LightSpectrum>,
        /// 0: the display lies flat and faces the zenith; 90: it stands upright and faces azimuth -90 deg. Default 0.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Reflectance of the ground, 0 to 1: what a tilted display sees below the horizon. Default 0.
        ground_reflectance: Share = Share(0.0),
    }
}

table! {
    /// A picture of the whole sphere, equirectangular, by radiance.
    Map {
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum of the map's white; none beside a map of wavelengths. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// A Radiance picture (.hdr) or an OpenEXR file (.exr), twice as wide as high.
        file: String,
        /// Turns the world counterclockwise, seen from above, degrees. Default 0: an upright display faces the
        /// middle of the map.
        rotate_deg: Azimuth = Azimuth(0.0),
        /// 0: the display lies flat and faces the top of the map; 90: it stands upright. Default 0.
        tilt_deg: FieldAngle = FieldAngle(0.0),
        /// Parts of a picture in colours whose spectrum was measured; where several hold a pixel, the first. Default: none.
        regions: Vec<At<Region>> = Vec::new(),
    }
}

table! {
    /// A part of a map that has a spectrum of its own: its pixels keep their luminance, and lose their colour.
    Region {
        /// Relative spectrum of its light.
        spectrum: LightSpectrum,
        /// Elevations where it begins and ends, degrees above the horizon of the map. Default [-90, 90].
        elevation_deg: Vec<At<Latitude>> = vec![At::at_large(Latitude(-90.0)), At::at_large(Latitude(90.0))],
        /// Azimuths where it begins and ends, counterclockwise seen from above, degrees from the display's x axis while
        /// `rotate_deg` is 0 (the middle of the map is -90); the region turns with the map. Default [-180, 180].
        azimuth_deg: Vec<At<Azimuth>> = vec![At::at_large(Azimuth(-180.0)), At::at_large(Azimuth(180.0))],
    }
}

table! {
    /// A luminaire far away: a disc of its opening's size, listed among the directed sources.
    Luminaire {
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// IES LM-63, type C photometry.
        file: String,
        /// Elevation of the luminaire above the horizon, as the display sees it, above 0, at most 90 deg.
        elevation_deg: Elevation,
        /// Its azimuth, counterclockwise seen from above, from the display's x axis, degrees. Default 0.
        azimuth_deg: Azimuth = Azimuth(0.0),
        /// Its distance, m.
        distance_m: Metres,
        /// Azimuth of its own plane C = 0, degrees. Default 0.
        rotation_deg: Azimuth = Azimuth(0.0),
        /// 0: the display lies flat; 90: it stands upright and faces azimuth -90 deg. Default 0.
        tilt_deg: FieldAngle = FieldAngle(0.0),
    }
}
