//! `[lighting]`: its sources, and the sum of their shares.

use std::sync::Arc;

use papilio_diagnostics::Diagnostic;
use papilio_display::environment::{Sheet, luminous_sheet, profile};
use papilio_display::scene::{DirectedLight, Environment, Field, FrontLight, Lighting, Port, Vibration};
use papilio_formats::{Luminaire, is_luminaire, read_luminaire, read_profile};
use papilio_spectra::LightSpectrum;

use super::Resolver;
use super::maps::MapLight;
use crate::describe::environment::Environment as Described;
use crate::describe::lighting::{self as describe, Illuminance};
use crate::describe::numbers::{Lux, Share};
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Read, Spanned};

impl Resolver<'_> {
    pub(super) fn lighting(&mut self, lighting: &Spanned<describe::Lighting>) -> Option<Lighting> {
        self.limit(&lighting.directed, "sources", lighting.directed.len(), 256)?;
        self.limit(&lighting.environment, "environments", lighting.environment.len(), 64)?;
        if !matches!(&lighting.illuminance_lx.value, Some(Illuminance::Lux(lux)) if lux.0 == 0.0) {
            self.check_shares(lighting);
        } else {
            self.check_front_light_alone(lighting);
        }
        let general = self.light("lighting.spectrum", &lighting.spectrum);
        let sources = lighting.directed.iter().enumerate();
        let directed: Vec<_> =
            sources.map(|(i, source)| self.directed(i, source, general.as_ref())).collect();
        let mut directed = directed.into_iter().collect::<Option<Vec<_>>>();
        let mut suns = Vec::new();
        let environments = lighting.environment.iter().enumerate();
        let environment: Vec<_> =
            environments.map(|(i, one)| self.environment(i, one, general.as_ref(), &mut suns)).collect();
        directed.iter_mut().for_each(|directed| directed.append(&mut suns));
        let front_light = match &lighting.front_light.value {
            Some(guide) => Some(self.front_light(guide, general.as_ref())?),
            None => None,
        };
        let port = self.port(lighting)?;
        let directed = directed?;
        if port.is_some() && !(directed.is_empty() && front_light.is_none()) {
            let wrong = Diagnostic::new("light from a lamp does not come from the wall of a sphere");
            let expected = "lighting.preset = \"d8-included\" or \"d8-excluded\", or other light without lamps beside `port_mm`";
            self.err(&lighting.port_mm, wrong.expected(expected));
            return None;
        }
        Some(Lighting {
            port,
            front_light,
            illuminance_lx: self.illuminance_lx(lighting)?,
            diffuse: lighting.diffuse.map_or(0.0, |share| share.0),
            diffuse_spectrum: general?,
            directed,
            // Luminaires are among the directed sources.
            environment: environment.into_iter().filter(|one| !is_empty(one)).collect::<Option<_>>()?,
        })
    }

    /// Resolves the port of a sphere, if there is one.
    fn port(&mut self, lighting: &describe::Lighting) -> Option<Option<Port>> {
        let sample_mm = lighting.sample_mm.value.as_ref().map(|sample| sample.0);
        let spot_mm = lighting.spot_mm.value.as_ref().map(|spot| spot.0);
        let Some(port_mm) = lighting.port_mm.value.as_ref().map(|port| port.0) else {
            let beside = "`port_mm` beside it";
            if spot_mm.is_some() {
                let wrong = Diagnostic::new("`spot_mm` is the part of a port that the meter sees");
                self.err(&lighting.spot_mm, wrong.expected(beside));
            }
            if sample_mm.is_some() {
                let wrong = Diagnostic::new("`sample_mm` is the size of a sample at the port of a sphere");
                self.err(&lighting.sample_mm, wrong.expected(beside));
            }
            return (spot_mm.is_none() && sample_mm.is_none()).then_some(None);
        };
        let smaller = sample_mm.filter(|sample| *sample < port_mm);
        let (most, of) = smaller.map_or((port_mm, "port"), |sample| (sample, "sample"));
        let spot_mm = spot_mm.unwrap_or(most);
        if spot_mm > most {
            let wrong =
                mistake::out_of_range(spot_mm, format!("at most the diameter of the {of}, {most} mm"));
            self.err(&lighting.spot_mm, wrong);
            return None;
        }
        Some(Some(Port { port_mm, spot_mm, sample_mm }))
    }

    fn illuminance_lx(&mut self, lighting: &describe::Lighting) -> Option<f64> {
        let at = lighting.illuminance_lx.origin;
        match lighting.illuminance_lx.value.as_ref()? {
            Illuminance::Lux(lux) => Some(lux.0),
            Illuminance::ByMap(_) => match self.maps[..] {
                [MapLight { lux, share }] if share > 0.0 => {
                    let illuminance_lx = lux / share;
                    let is_usual = (1e-6..=1e9).contains(&illuminance_lx);
                    if is_usual {
                        self.notes.push(format!(
                            "lighting.illuminance_lx is {illuminance_lx:.2} lx, from the absolute values of the map"
                        ));
                    } else {
                        let expected =
                            "a map whose absolute values correspond to 1e-6 to 1e9 lx on the display";
                        self.errors.push(at, mistake::out_of_range(illuminance_lx, expected));
                    }
                    is_usual.then_some(illuminance_lx)
                }
                _ => {
                    let is_map = |one: &&Spanned<Described>| matches!(one.value, Described::Map(_));
                    // A map that cannot be read is an error of its own.
                    if lighting.environment.iter().filter(is_map).count() > self.maps.len() {
                        return None;
                    }
                    let wrong = match self.maps.len() {
                        1 => "the share of the map is 0".to_owned(),
                        maps => format!("\"from-map\" needs one map, and there are {maps}"),
                    };
                    let expected = "one [[lighting.environment]] with model = \"map\" and a share above 0";
                    self.errors.push(at, Diagnostic::new(wrong).expected(expected));
                    None
                }
            },
        }
    }

    fn front_light(
        &mut self,
        guide: &describe::FrontLight,
        general: Option<&LightSpectrum>,
    ) -> Option<FrontLight> {
        let spectrum = self.own_light("lighting.front_light.spectrum", &guide.spectrum, general);
        let field = match &guide.distribution.value {
            Some(name) => Some(Arc::new(self.distribution(name, guide.distribution.origin)?)),
            None => None,
        };
        let up = guide.upward_leak.0;
        Some(FrontLight {
            illuminance_lx: guide.illuminance_lx.0,
            spectrum: spectrum?,
            field,
            upward_over_downward: up / (1.0 - up),
        })
    }

    /// Resolves the directions of the downward light of a front light.
    fn distribution(&mut self, name: &str, origin: Origin) -> Option<Field> {
        // By the content: any name is accepted.
        let read = |file: &_| {
            Ok(if is_luminaire(file) {
                Distribution::Luminaire(read_luminaire(file)?)
            } else {
                Distribution::Profile(read_profile(file)?)
            })
        };
        let field = match self.data(name, origin, read)? {
            Distribution::Luminaire(light) => {
                self.notes.extend(light.notes.iter().map(|note| format!("lighting.front_light: {note}")));
                if light.intensity(180.0, 0.0) > 0.0 || light.intensity(135.0, 0.0) > 0.0 {
                    self.notes.push(format!(
                        "lighting.front_light: the upward light of {name} is ignored; upward_leak sets it"
                    ));
                }
                luminous_sheet(Guide(light))
            }
            Distribution::Profile(points) => profile(&points),
        };
        if field.is_none() {
            self.errors.push(origin, mistake::dark_field());
        }
        field
    }

    /// Checks that there is a front light if there is no ambient light, and notes that results then have
    /// another meaning.
    fn check_front_light_alone(&mut self, lighting: &Spanned<describe::Lighting>) {
        if lighting.front_light.is_none() {
            let expected = format!("{}; 0 is allowed only with a front light", Lux::in_words());
            self.errors.push(lighting.illuminance_lx.origin, mistake::out_of_range(0.0, expected));
            return;
        }
        self.notes.push(
            "the front light is the only light: there are no reflectance factors; X, Y and Z are relative to a perfect white \
             under it, L* a* b* to the screen's own white"
                .to_owned(),
        );
    }

    fn directed(
        &mut self,
        i: usize,
        source: &describe::Directed,
        general: Option<&LightSpectrum>,
    ) -> Option<DirectedLight> {
        let radius_deg = source.radius_deg.map(|radius| radius.0);
        let reach = source.theta_deg.0.abs() + radius_deg.unwrap_or(0.0);
        if radius_deg.is_some() && reach >= 90.0 {
            let at = source.radius_deg.origin.or_override([source.theta_deg.origin]);
            self.errors.push(at, mistake::below_horizon("cone", reach, ["theta_deg", "radius_deg"]));
        }
        let spectrum = self.own_light(&format!("lighting.directed.{i}.spectrum"), &source.spectrum, general);
        Some(DirectedLight {
            theta_deg: source.theta_deg.0,
            phi_deg: source.phi_deg.0,
            share: source.share.0,
            spectrum: spectrum?,
            radius_deg,
            normal_to_beam: source.normal_to_beam.value,
            vibration: source
                .polarisation
                .as_ref()
                .map(|lamp| Vibration::Fixed { degree: lamp.degree.0, angle: lamp.angle_deg.0.to_radians() }),
        })
    }

    /// Checks that all shares sum to 1. The error is at the last share that the user gave
    /// (one of a `--set` before one of the file), and suggests a value for another one.
    fn check_shares(&mut self, lighting: &describe::Lighting) {
        let diffuse = lighting.diffuse.map_or(0.0, |share| share.0);
        let mut shares = vec![("lighting.diffuse".to_owned(), diffuse, lighting.diffuse.origin)];
        for (i, source) in lighting.directed.iter().enumerate() {
            shares.push((format!("lighting.directed.{i}.share"), source.share.0, source.share.origin));
        }
        for (i, environment) in lighting.environment.iter().enumerate() {
            let mut add = |key: &str, share: &Spanned<Share>| {
                shares.push((format!("lighting.environment.{i}.{key}"), share.0, share.origin));
            };
            add("share", environment.share());
            if let Described::Sky(sky) = &environment.value {
                add("sun_share", &sky.sun_share);
            }
        }
        let sum: f64 = shares.iter().map(|(_, share, _)| share).sum();
        if (sum - 1.0).abs() <= 1e-6 {
            return;
        }
        // Shares of a preset have the place of the preset, and so have defaults.
        let is_given = |origin: Origin| origin != lighting.preset.origin;
        let given = (0..shares.len()).filter(|&i| is_given(shares[i].2));
        let wrong = given.max_by_key(|&i| shares[i].2.source).unwrap_or(0);
        let needed = |i: usize| 1.0 - (sum - shares[i].1);
        let others = (0..shares.len()).rev().filter(|&i| i != wrong);
        let mended = others.chain([wrong]).find(|&i| (0.0..=1.0).contains(&needed(i))).unwrap_or(wrong);
        let (remedy, value) = (&shares[mended].0, needed(mended));
        let hint =
            (0.0..=1.0).contains(&value).then(|| format!("{remedy}={} would make the sum 1", tidy(value)));
        let mistake = mistake::sum("the shares of the light", sum, "1").hint_if(hint);
        self.errors.push(shares[wrong].2, mistake);
    }
}

/// Distribution of the light of a guide.
enum Distribution {
    Luminaire(Luminaire),
    Profile(Vec<(f64, f64)>),
}

/// A light guide with the intensities of a luminaire, whose nadir is the display's normal.
#[derive(Debug)]
struct Guide(Luminaire);

/// Largest number of angles of a table at which integrals are subdivided.
const MOST_ANGLES: usize = 90;

impl Sheet for Guide {
    fn intensity(&self, theta_deg: f64, phi_deg: f64) -> f64 {
        self.0.intensity(theta_deg, phi_deg)
    }

    fn edges(&self) -> Vec<([f64; 3], f64)> {
        self.0.edges(MOST_ANGLES).into_iter().map(|edge| (edge.centre, edge.radius_deg)).collect()
    }
}

fn is_empty(environment: &Option<Environment>) -> bool {
    environment.as_ref().is_some_and(|environment| environment.parts.is_empty())
}
