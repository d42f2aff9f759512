//! `[lighting]`: diffuse and directed light.

use super::environment::Environment;
use super::numbers::{
    AngularRadius, Azimuth, DaylightKelvin, Inclination, Kelvin, Leak, Lux, RoomLux, Share, Wavelength,
    Weight,
};
use crate::grammar::{choice, forms, table};
use crate::read::At;

table! {
    /// The room's light; all shares sum to 1.
    Lighting {
        /// A ready-made light and viewer (docs/light.md). Keys that are given override it.
        preset: Option<Preset>,
        /// Illuminance in the display plane, to which all fractions of the light refer; `"from-map"` takes it from the
        /// scenario's one map. Default: `500`, or `0` where a front light is all the light there is.
        illuminance_lx: Option<Illuminance>,
        /// Relative spectrum of all light that has none of its own.
        spectrum: LightSpectrum = LightSpectrum::Text("D65".to_owned()),
        /// Fraction of the light that comes from the whole hemisphere with uniform radiance. Default: `1`, or `0` where
        /// other light is given.
        diffuse: Option<Share>,
        /// Directed sources. Default: none.
        directed: Vec<At<Directed>> = Vec::new(),
        /// Light from many directions at once: rings, skies, maps. Default: none.
        environment: Vec<At<Environment>> = Vec::new(),
        /// A light guide below the front of screen.
        front_light: Option<FrontLight>,
    }
}

table! {
    /// A clear light guide below the front of screen and above all other layers.
    FrontLight {
        /// What the guide sends down, on the layer below the front of screen; it adds to the light of the room.
        illuminance_lx: Lux,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Directions of what the guide sends down: a file of two columns, inclination in degrees (0 to 90, rising) and
        /// relative radiance, the same at all azimuths; or an IES file (.ies), whose nadir is the display's normal and
        /// whose plane C = 0 is along x. Only above the diffuser of an ordinary panel. Default: diffuse.
        distribution: Option<String>,
        /// Fraction of all its light that the guide sends up, diffusely.
        upward_leak: Leak = Leak(0.0),
    }
}

forms! {
    /// The illuminance of the room, lx, or "from-map".
    Illuminance, format!("{}, or \"from-map\"", RoomLux::in_words()); {
        /// So many lx.
        Lux(RoomLux) if Value::Integer(_) | Value::Float(_),
        /// By a map's own numbers.
        ByMap(ByMap) if Value::Text(_),
    }
}

choice! {
    /// Where the illuminance comes from.
    ByMap {
        /// The map's numbers are W/(m2 sr), 179 lm/W in colours.
        FromMap = "from-map",
    }
}

choice! {
    /// Ready-made light and viewer.
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
        /// 10 000 lx diffuse, 100 000 lx across the beam at -45 deg; viewer along the normal.
        DaylightReadability = "daylight-readability",
        /// At -40 deg; viewer at 30 deg.
        IecDirectional = "iec-directional",
        /// A ring at 35 deg, 10 deg wide; viewer at 20 deg.
        IecRing = "iec-ring",
        /// Diffuse; viewer at 8 deg.
        IecHemispherical = "iec-hemispherical",
        /// Diffuse; viewer at 8 deg.
        D8Included = "d8-included",
        /// From everywhere but 5 deg around the viewer's mirror image; viewer at 8 deg.
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
        /// Inclination; below 0: towards phi + 180.
        theta_deg: Inclination,
        /// Azimuth.
        phi_deg: Azimuth = Azimuth(0.0),
        /// Fraction of `illuminance_lx`.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Angular radius of a round source of uniform radiance; the source must not reach below the horizon. Default:
        /// none, collimated light.
        radius_deg: Option<AngularRadius>,
        /// `true`: the fraction is measured across the beam, and cos(theta) of it falls on the display.
        normal_to_beam: bool = false,
    }
}

forms! {
    /// A relative spectrum of light: the name of a CIE illuminant, a two-column file, a model, or a list of models that add up.
    LightSpectrum, "the name of an illuminant, a spectrum file, { led_nm, width_nm }, or a list of such"; {
        /// A name first, else a file, relative to the scenario.
        Text(String) if Value::Text(_),
        /// One model.
        One(LightModel) if Value::Table(_),
        /// Several, each with its weight.
        Sum(Vec<At<LightModel>>) if Value::Array(_),
    }
}

table! {
    /// A model of light: an LED (Ohno 2005), CIE daylight, or a black body. LEDs are 1 at
    /// their peak, the others 1 at 560 nm, before the weight.
    LightModel {
        /// Peak wavelength of an LED.
        led_nm: Option<Wavelength>,
        /// Width of the LED; its full width at half maximum is 0.92 of this.
        width_nm: Option<Wavelength>,
        /// Correlated colour temperature of CIE daylight.
        daylight_K: Option<DaylightKelvin>,
        /// Temperature of a black body.
        planck_K: Option<Kelvin>,
        /// Weight in a list.
        weight: Weight = Weight(1.0),
    }
}

impl Lighting {
    /// Fills in `illuminance_lx` and `diffuse`, and forgets the preset, which has done its work.
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
