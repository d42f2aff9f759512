//! `[lighting]`: diffuse light, directed sources, environments and a front light.

use super::environment::Environment;
use super::numbers::{
    AngularRadius, Azimuth, DaylightKelvin, Inclination, Kelvin, Leak, LedPeak, LedWidth, Lux, Millimetres,
    RoomLux, Share, Weight,
};
use super::viewer::PolariserAngle;
use crate::grammar::{choice, forms, table};
use crate::read::Spanned;

table! {
    /// The light on the display; `diffuse` and all shares sum to 1.
    Lighting {
        /// A preset of lighting and viewer (docs/light.md); keys of the scenario override it.
        preset as "Lighting preset": Option<Preset>,
        /// Illuminance of the display plane, to which all shares refer; `"from-map"`: the absolute value of
        /// the scenario's one map. Default: `500`, or `0` if a front light is the only light.
        illuminance_lx: Option<Illuminance>,
        /// Relative spectrum of all light without a spectrum of its own.
        spectrum as "Spectrum of the light": LightSpectrum = LightSpectrum::Text("D65".to_owned()),
        /// Fraction of `illuminance_lx` that is uniform over the hemisphere. Default: `1`, or `0` if other
        /// light is given.
        diffuse as "Diffuse fraction": Option<Share>,
        /// Directed sources. Default: none.
        directed: Vec<Spanned<Directed>> = Vec::new(),
        /// Light from many directions at once: rings, skies, maps, luminaires. Default: none.
        environment: Vec<Spanned<Environment>> = Vec::new(),
        /// A front light: a light guide below the front of screen.
        front_light: Option<FrontLight>,
        /// Diameter of the port of an integrating sphere, for its edge loss (docs/light.md). One view, and
        /// light without lamps. Default: the port is wide.
        port_mm as "Diameter of the port": Option<Millimetres>,
        /// Diameter of the spot that the meter sees, in the middle of the port. Default: that of the port, or of a smaller sample.
        spot_mm as "Diameter of the spot": Option<Millimetres>,
        /// Diameter of a round sample in the middle of the port: light that reaches its edge is lost. Default: the sample is larger
        /// than the port by what light travels inside it.
        sample_mm as "Diameter of the sample": Option<Millimetres>,
    }
}

table! {
    /// A clear light guide below the front of screen and above all other layers.
    FrontLight {
        /// Illuminance of the layer below the front of screen by the guide, beside the ambient light.
        illuminance_lx: Lux,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Light that the guide emits downwards: a file of inclination in degrees (0 to 90, increasing) and
        /// relative radiance, or an IES or EULUMDAT file (.ies, .ldt), its nadir along the normal and C = 0
        /// along x. Only above a diffuser of the model k-correlation or lambertian, without `reflection`. Default: diffuse.
        distribution: Option<String>,
        /// Fraction of its light that the guide emits upwards, diffusely.
        upward_leak: Leak = Leak(0.0),
    }
}

forms! {
    /// The illuminance by ambient light, lx, or "from-map".
    Illuminance, format!("{}, or \"from-map\"", RoomLux::in_words()); {
        /// A value, lx.
        Lux(RoomLux) if Value::Integer(_) | Value::Float(_),
        /// The illuminance of a map's absolute values.
        ByMap(ByMap) if Value::Text(_),
    }
}

choice! {
    /// Source of the illuminance.
    ByMap {
        /// The values of the map are W/(m2 sr); those of a colour map have 179 lm/W.
        FromMap = "from-map",
    }
}

choice! {
    /// Presets of lighting and viewer.
    Preset {
        /// Half diffuse, half at -20 deg; viewer at 8 deg; 500 lx.
        Indoor = "indoor",
        /// 20 % diffuse, 80 % at -35 deg; viewer at 20 deg; 100 000 lx.
        Sunny = "sunny",
        /// Diffuse; viewer at 8 deg; 10 000 lx.
        Overcast = "overcast",
        /// 60 lx diffuse, 40 lx at -35 deg; viewer along the normal.
        LivingRoom = "living-room",
        /// 300 lx diffuse, 200 lx at -35 deg; viewer along the normal.
        Office = "office",
        /// 15 000 lx diffuse, 65 000 lx at -45 deg; viewer along the normal.
        Daylight = "daylight",
        /// 100 000 lx at -45 deg; viewer along the normal.
        FullSun = "full-sun",
        /// 10 000 lx diffuse, 100 000 lx (on a plane across the beam) at -45 deg; viewer along the normal.
        DaylightReadability = "daylight-readability",
        /// At -40 deg; viewer at 30 deg.
        IecDirectional = "iec-directional",
        /// A ring at 35 deg, 10 deg wide; viewer at 20 deg.
        IecRing = "iec-ring",
        /// Diffuse; viewer at 8 deg.
        IecHemispherical = "iec-hemispherical",
        /// Diffuse; viewer at 8 deg.
        D8Included = "d8-included",
        /// From the whole hemisphere except 5 deg around the viewer's mirror image; viewer at 8 deg.
        D8Excluded = "d8-excluded",
        /// At 45 deg; viewer along the normal.
        FortyFive = "45-0",
        /// At 30 deg; viewer along the normal.
        Thirty = "30-0",
    }
}

table! {
    /// A directed source.
    Directed {
        /// Inclination; a negative value is at phi + 180.
        theta_deg as "Inclination": Inclination,
        /// Azimuth.
        phi_deg as "Azimuth": Azimuth = Azimuth(0.0),
        /// Fraction of `illuminance_lx`.
        share as "Light fraction": Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Angular radius of a disc of uniform radiance above the horizon. Default: none: collimated light.
        radius_deg as "Angular radius": Option<AngularRadius>,
        /// `true`: the share is that of a plane perpendicular to the beam; the display receives it times
        /// cos(theta).
        normal_to_beam: bool = false,
        /// Linear polarisation of the source, such as a reflection or a screen. Default: unpolarised.
        polarisation: Option<LampPolarisation>,
    }
}

table! {
    /// Partly linearly polarised light.
    LampPolarisation {
        /// Degree of linear polarisation.
        degree as "Degree of polarisation": Share = Share(1.0),
        /// Angle of its electric field from the plane of incidence, counter-clockwise as seen from the lamp: 0 is p, 90 is
        /// s.
        angle_deg as "Angle of polarisation": PolariserAngle,
    }
}

forms! {
    /// A relative spectrum of light: the name of a CIE illuminant, a file with two columns, a model, or a sum
    /// of models.
    LightSpectrum, "the name of an illuminant, a spectrum file, { led_nm, width_nm }, or a list of such"; {
        /// The name of an illuminant, or else a file, relative to the folder of the scenario.
        Text(String) if Value::Text(_),
        /// One model.
        One(LightModel) if Value::Table(_),
        /// A sum of models, each with its weight.
        Sum(Vec<Spanned<LightModel>>) if Value::Array(_),
    }
}

table! {
    /// A model of light: an LED (Ohno 2005), CIE daylight, or a black body. Before the weight, an LED is 1 at
    /// its peak, the others are 1 at 560 nm.
    LightModel {
        /// Peak wavelength of an LED.
        led_nm as "Peak of the LED": Option<LedPeak>,
        /// Width of the LED; its full width at half maximum is 0.92 of it.
        width_nm as "Width of the LED": Option<LedWidth>,
        /// Correlated colour temperature of CIE daylight.
        daylight_K as "Colour temperature of daylight": Option<DaylightKelvin>,
        /// Temperature of a black body.
        planck_K as "Temperature of the black body": Option<Kelvin>,
        /// Weight in a list of models.
        weight: Weight = Weight(1.0),
    }
}

impl Lighting {
    /// Fills in `illuminance_lx` and `diffuse`, and removes the preset, whose keys are already in place.
    pub(super) fn complete(&mut self) {
        self.preset.value = None;
        let no_other = self.directed.is_empty() && self.environment.is_empty();
        let no_diffuse = self.diffuse.is_none_or(|share| share.0 == 0.0);
        let is_dark = self.front_light.is_some() && no_other && no_diffuse;
        let usual = Illuminance::Lux(RoomLux(if is_dark { 0.0 } else { 500.0 }));
        self.illuminance_lx.value.get_or_insert(usual);
        self.diffuse.value.get_or_insert(Share(if no_other { 1.0 } else { 0.0 }));
    }
}
