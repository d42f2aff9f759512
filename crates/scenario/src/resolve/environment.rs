//! `[[lighting.environment]]`: light from many directions, as radiance fields.

use std::f64::consts::PI;
use std::sync::Arc;

use papilio_diagnostics::Diagnostic;
use papilio_display::environment::{Pose, Sky, cap as cap_field, profile};
use papilio_display::scene::{DirectedLight, Environment, EnvironmentPart, Field, Vibration};
use papilio_formats::{read_luminaire, read_profile};
use papilio_spectra::LightSpectrum;

use super::Resolver;
use crate::describe::environment::{self as describe, ProfileAngles};
use crate::describe::lighting::LightSpectrum as Described;
use crate::describe::numbers::{Elevation, Share};
use crate::mistake;
use crate::origin::Origin;
use crate::read::{Read, Spanned};

/// Smallest distance of the far field, in widths of the luminaire (the five-times rule: CIE 70-1987; IES
/// Lighting Handbook).
const FAR: f64 = 5.0;

/// Angular radius of the sun, degrees.
const SUN_RADIUS_DEG: f64 = 0.27;

impl describe::Environment {
    /// Share of the illuminance, without the sun's disc.
    pub(super) fn share(&self) -> &Spanned<Share> {
        match self {
            Self::Ring(ring) => &ring.share,
            Self::Cap(cap) => &cap.share,
            Self::Profile(profile) => &profile.share,
            Self::Sky(sky) => &sky.share,
            Self::Map(map) => &map.share,
            Self::Luminaire(luminaire) => &luminaire.share,
        }
    }

    fn spectrum(&self) -> &Spanned<Option<Described>> {
        match self {
            Self::Ring(ring) => &ring.spectrum,
            Self::Cap(cap) => &cap.spectrum,
            Self::Profile(profile) => &profile.spectrum,
            Self::Sky(sky) => &sky.spectrum,
            Self::Map(map) => &map.spectrum,
            Self::Luminaire(luminaire) => &luminaire.spectrum,
        }
    }
}

impl Resolver<'_> {
    /// Resolves environment `i`. The sun's disc and a luminaire become directed sources.
    pub(super) fn environment(
        &mut self,
        i: usize,
        environment: &describe::Environment,
        general: Option<&LightSpectrum>,
        directed: &mut Vec<DirectedLight>,
    ) -> Option<Environment> {
        let key = format!("lighting.environment.{i}");
        let spectrum = self.own_light(&format!("{key}.spectrum"), environment.spectrum(), general);
        let field = match environment {
            describe::Environment::Map(map) => return self.map(&key, map, spectrum),
            describe::Environment::Luminaire(luminaire) => {
                directed.push(self.luminaire(&key, luminaire, spectrum)?);
                return Some(Environment { parts: Vec::new() });
            }
            describe::Environment::Ring(ring) => self.ring(ring),
            describe::Environment::Cap(cap) => self.cap(cap),
            describe::Environment::Profile(profile) => self.profile(profile),
            describe::Environment::Sky(sky) => {
                if sky.sun_share.0 > 0.0 {
                    let spectrum = self.own_light(&format!("{key}.sun_spectrum"), &sky.sun_spectrum, general);
                    directed.extend(self.sun(sky, spectrum));
                }
                self.sky(sky)
            }
        };
        let share = environment.share().0;
        let vibration = match environment {
            describe::Environment::Sky(sky) => self.vibration(sky)?,
            _ => None,
        };
        let part = EnvironmentPart { field: Arc::new(field?), share, spectrum: spectrum?, vibration };
        Some(Environment { parts: vec![part] })
    }

    fn ring(&mut self, ring: &describe::Ring) -> Option<Field> {
        let (middle, half) = (ring.theta_deg.0, 0.5 * ring.width_deg.0);
        let edges = (middle - half, middle + half);
        if edges.0 < 0.0 || edges.1 > 90.0 {
            let at = ring.width_deg.origin.or_override([ring.theta_deg.origin]);
            let expected = "a ring between 0 and 90 deg whose end is above its start";
            self.errors.push(at, mistake::edges("ring", edges.0, edges.1, expected));
            return None;
        }
        Field::ring(edges.0, edges.1)
    }

    fn cap(&mut self, cap: &describe::Cap) -> Option<Field> {
        let (from, to) = (cap.from_deg.0, cap.to_deg.0);
        if from >= to {
            let at = cap.to_deg.origin.or_override([cap.from_deg.origin]);
            self.errors.push(at, mistake::edges("cap", from, to, "a cap whose end is above its start"));
            return None;
        }
        let field = cap_field(cap.theta_deg.0, cap.phi_deg.0, from, to);
        if field.is_none() {
            self.dark(cap.from_deg.origin.or_override([cap.to_deg.origin, cap.theta_deg.origin]));
        }
        field
    }

    fn profile(&mut self, table: &describe::Profile) -> Option<Field> {
        let mut points = self.data(&table.file.value, table.file.origin, read_profile)?;
        if table.angles.value == ProfileAngles::Elevation {
            points.iter_mut().for_each(|point| point.0 = 90.0 - point.0);
            points.reverse();
        }
        let field = profile(&points);
        if field.is_none() {
            self.dark(table.file.origin);
        }
        field
    }

    fn sky(&mut self, sky: &Spanned<describe::Sky>) -> Option<Field> {
        let number = u8::try_from(sky.number.0).ok()?;
        let sun = sky.sun_elevation_deg.value.map(|elevation| [elevation.0, sky.sun_azimuth_deg.0]);
        if Sky::has_sun(number) && sun.is_none() {
            let wrong = mistake::missing_key("sun_elevation_deg", Elevation::in_words());
            self.errors.push(sky.number.origin.or_override([sky.origin]), wrong);
            return None;
        }
        let pose = Pose { tilt_deg: sky.tilt_deg.0 };
        let field = Sky { number, sun, ground: sky.ground_reflectance.0 }.field(pose);
        if field.is_none() {
            self.dark(sky.tilt_deg.origin.or_override([sky.origin]));
        } else if pose.tilt_deg > 0.0 {
            self.notes.push(format!(
                "the display is tilted by {} deg: only sky above its plane contributes, and ground below the horizon by \
                 its reflectance ({}); the share is what falls on the display",
                pose.tilt_deg, sky.ground_reflectance.0
            ));
        }
        field
    }

    /// Resolves the polarisation of a sky; `None` after an error.
    fn vibration(&mut self, sky: &Spanned<describe::Sky>) -> Option<Option<Vibration>> {
        if sky.polarisation.0 == 0.0 {
            return Some(None);
        }
        let Some(elevation) = sky.sun_elevation_deg.value else {
            let mut wrong = mistake::missing_key("sun_elevation_deg", Elevation::in_words());
            let note = "light of a sky vibrates across the plane of the sun";
            wrong.diagnostic = wrong.diagnostic.note(note);
            self.errors.push(sky.polarisation.origin, wrong);
            return None;
        };
        let pose = Pose { tilt_deg: sky.tilt_deg.0 };
        let sun = pose.towards([elevation.0, sky.sun_azimuth_deg.0]);
        Some(Some(Vibration::Rayleigh { most: sky.polarisation.0, sun, zenith: pose.towards([90.0, 0.0]) }))
    }

    /// Resolves a luminaire: a disc of the size of its opening, in its direction.
    fn luminaire(
        &mut self,
        key: &str,
        luminaire: &Spanned<describe::Luminaire>,
        spectrum: Option<LightSpectrum>,
    ) -> Option<DirectedLight> {
        let light = self.data(&luminaire.file.value, luminaire.file.origin, read_luminaire)?;
        self.notes.extend(light.notes.iter().map(|note| format!("{key}: {note}")));
        let pose = Pose { tilt_deg: luminaire.tilt_deg.0 };
        let (theta_deg, phi_deg) = pose.sees([luminaire.elevation_deg.0, luminaire.azimuth_deg.0]);
        // Light towards the display leaves the luminaire at this angle from its nadir, in the opposite
        // azimuth.
        let from_nadir_deg = 90.0 - luminaire.elevation_deg.0;
        let turn_deg = luminaire.azimuth_deg.0 + 180.0 - luminaire.rotation_deg.0;
        let intensity = light.intensity(from_nadir_deg, turn_deg);
        let seen_m2 = light.opening.seen_m2(from_nadir_deg, turn_deg);
        let radius_deg = (seen_m2 / PI).sqrt().atan2(luminaire.distance_m.0).to_degrees();
        if theta_deg + radius_deg >= 90.0 {
            let at = luminaire
                .elevation_deg
                .origin
                .or_override([luminaire.tilt_deg.origin, luminaire.azimuth_deg.origin]);
            let reach = theta_deg + radius_deg;
            self.errors.push(
                at,
                mistake::below_horizon("luminaire", reach, ["its inclination", "the radius of its opening"]),
            );
            return None;
        }
        if intensity == 0.0 {
            self.dark(luminaire.file.origin);
            return None;
        }
        let lux = intensity * theta_deg.to_radians().cos() / luminaire.distance_m.0.powi(2);
        self.check_far(key, luminaire.distance_m.0, light.opening.longest_m());
        self.notes.push(format!(
            "{key}: the luminaire has {intensity:.1} cd towards the display, which are {lux:.2} lx there; these values are not used, `share` sets the level"
        ));
        Some(DirectedLight {
            theta_deg,
            phi_deg,
            share: luminaire.share.0,
            spectrum: spectrum?,
            radius_deg: (radius_deg > 0.0).then_some(radius_deg),
            normal_to_beam: false,
            vibration: None,
        })
    }

    /// Warns of a luminaire that is too close: its file is its far field, which is correct within 1 % from
    /// five times its opening (the illuminance of a Lambertian disc of diameter D at distance d is 1/(1 +
    /// (D/2d)^2) of the inverse square law).
    fn check_far(&mut self, key: &str, distance_m: f64, widest: f64) {
        if distance_m < FAR * widest {
            self.warnings.push(format!(
                "{key}: the luminaire is {distance_m} m away, less than five times its opening of {widest:.2} m: its file is its far \
                 field (IES and CIE measure it at five times the opening or more), and at this distance it is less uniform than a disc"
            ));
        }
    }

    /// Resolves the sun's disc.
    fn sun(
        &mut self,
        sky: &Spanned<describe::Sky>,
        spectrum: Option<LightSpectrum>,
    ) -> Option<DirectedLight> {
        let Some(elevation) = sky.sun_elevation_deg.value else {
            let wrong = mistake::missing_key("sun_elevation_deg", Elevation::in_words());
            self.errors.push(sky.sun_share.origin, wrong);
            return None;
        };
        let pose = Pose { tilt_deg: sky.tilt_deg.0 };
        let (theta_deg, phi_deg) = pose.sees([elevation.0, sky.sun_azimuth_deg.0]);
        if theta_deg + SUN_RADIUS_DEG >= 90.0 {
            let at =
                sky.sun_elevation_deg.origin.or_override([sky.tilt_deg.origin, sky.sun_azimuth_deg.origin]);
            let wrong = format!("the sun is {theta_deg:.2} deg from the display's normal");
            let expected = "its whole disc above the display's own horizon, less than 89.73 deg";
            self.errors.push(at, Diagnostic::new(wrong).expected(expected));
            return None;
        }
        Some(DirectedLight {
            theta_deg,
            phi_deg,
            share: sky.sun_share.0,
            spectrum: spectrum?,
            radius_deg: Some(SUN_RADIUS_DEG),
            normal_to_beam: false,
            vibration: None,
        })
    }

    fn dark(&mut self, at: Origin) {
        self.errors.push(at, mistake::dark_field());
    }

    /// Returns the light's own spectrum, or the general one.
    pub(super) fn own_light(
        &mut self,
        key: &str,
        own: &Spanned<Option<Described>>,
        general: Option<&LightSpectrum>,
    ) -> Option<LightSpectrum> {
        match &own.value {
            Some(light) => self.light(key, &Spanned { value: light.clone(), origin: own.origin }),
            None => general.cloned(),
        }
    }
}
