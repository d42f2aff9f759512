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
        /// "indoor", "office", "iec-directional", ...: fills lighting and viewer; keys that are given override it. Default: none.
        preset: Option<Preset>,
        /// Illuminance that the shares refer to, in the display plane, 1e-6 to 1e9 lx, or 0 beside a front light. Default 500, or
        /// 0 where a front light is all the light that is given. "from-map": so many that the scenario's one map makes on the display
        /// what its own numbers say.
        illuminance_lx: Option<Illuminance>,
        /// Relative spectrum of all light that has none of its own. Default "D65".
        spectrum: LightSpectrum = LightSpectrum::Text("D65".to_owned()),
        /// Share that comes alike from the whole hemisphere, 0 to 1. Default 1, or 0 where other light is given.
        diffuse: Option<Share>,
        /// Directed sources. Default: none.
        directed: Vec<At<Directed>> = Vec::new(),
        /// Light from many directions at once: rings, skies. Default: none.
        environment: Vec<At<Environment>> = Vec::new(),
        /// A light guide below the front of screen. Default: none.
        front_light: Option<FrontLight>,
    }
}

table! {
    /// A clear light guide below the front of screen and above all other layers.
    FrontLight {
        /// What it sends down, lx on the layer below the front of screen, beside `illuminance_lx`.
        illuminance_lx: Lux,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Directions of what it sends down: two columns, inclination in degrees (0 to 90, rising) and relative radiance,
        /// alike at all azimuths; or an IES file (.ies), its nadir the display's normal and its plane C = 0 along x. Over an
        /// ordinary panel's diffuser alone. Default: diffuse.
        distribution: Option<String>,
        /// Share of all its light that it sends up, diffusely: 0 to .99. Default 0.
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
        /// Inclination, degrees, between -90 and 90; negative: towards phi + 180.
        theta_deg: Inclination,
        /// Azimuth, degrees, -360 to 360. Default 0.
        phi_deg: Azimuth = Azimuth(0.0),
        /// Share of `illuminance_lx`, 0 to 1.
        share: Share,
        /// Relative spectrum. Default: that of the lighting.
        spectrum: Option<LightSpectrum>,
        /// Angular radius of a round source of even radiance, degrees. Default: none, collimated.
        radius_deg: Option<AngularRadius>,
        /// True: the share is measured across the beam; cos(theta) of it falls on the display. Default false.
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
        /// Peak wavelength of an LED, nm.
        led_nm: Option<Wavelength>,
        /// Width of the LED, nm: 1/.92 of its full width at half maximum.
        width_nm: Option<Wavelength>,
        /// Correlated colour temperature of CIE daylight, K, 4000 to 25000.
        daylight_K: Option<DaylightKelvin>,
        /// Temperature of a black body, K, 500 to 100000.
        planck_K: Option<Kelvin>,
        /// Weight in a list. Default 1.
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
