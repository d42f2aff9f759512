//! Pictures in single lights that are known already: another mixture of lights needs no computation.

use std::sync::Arc;

use papilio_colour::Observer;
use papilio_fourier::StatePicture;

use super::ImageSettings;
use super::held::{HeldPicture, Lit};
use super::light::Alone;
use super::stack::{Layers, Picture, Several};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::Scene;

/// Light that kernels may miss, relative to a perfect white. It is less than what the 16-bit numbers lose in
/// which the server sends a picture (5e-4 of each value), and takes two thirds of the shapes, and so of the
/// time, of 1e-5.
const MISSED: f64 = 1e-4;

/// Largest number of lights.
const MOST: usize = 8;

/// What is seen of a picture in single lights, of which the least recently used are removed first: a series
/// of scenes whose lights change one by one, or only in their illuminance, is quicker with it.
#[derive(Debug, Default)]
pub struct KnownLights {
    /// The picture to which the lights belong.
    picture: Option<HeldPicture>,
    /// The transform of the picture.
    transform: Option<Arc<StatePicture>>,
    lights: Vec<KnownLight>,
}

/// What is seen in a light, relative to a perfect white in it.
#[derive(Debug)]
pub(super) struct KnownLight {
    /// Display, view and light.
    of: Scene,
    /// Luminance of a perfect white over the illuminance.
    luminous: f64,
    /// X, Y, Z of a perfect white.
    pub(super) white: [f64; 3],
    pub(super) error: f64,
    pub(super) neighbours_light: bool,
    pub(super) pixels: Vec<[f32; 3]>,
}

impl KnownLights {
    /// Computes the lights that are not known; then all of them are, each with the luminance of a perfect
    /// white in it.
    pub(super) fn of(
        &mut self,
        picture: &HeldPicture,
        alone: &[Alone],
        settings: &ImageSettings,
        prepared: &mut Prepared,
        control: &Control<'_>,
    ) -> Result<Vec<(f64, &KnownLight)>, DisplayError> {
        if self.picture.as_ref() != Some(picture) {
            *self = Self { picture: Some(picture.clone()), ..Self::default() };
        }
        let wanted: Vec<(Scene, f64)> = alone.iter().map(Alone::with_unit_illuminance).collect();
        let missing = alone.iter().zip(&wanted).filter(|(_, (of, _))| self.position(of).is_none());
        let missing: Vec<(&Alone, &(Scene, f64))> = missing.collect();
        if let Some((first, _)) = missing.first() {
            let observer = Observer::of(first.scene.metrics.observer, &first.scene.grid)?;
            let lit = missing.iter().map(|(one, _)| Lit::new(&one.scene, settings, prepared, control));
            let lit = lit.collect::<Result<Vec<Lit>, DisplayError>>()?;
            let lit_by: Vec<_> = lit.iter().map(|lit| (&lit.setup, &lit.palette)).collect();
            let several = Several { missed: MISSED, without_lamps: true, by_paths: false };
            let shown = Picture { size: picture.size, states: &picture.states, wholes: &[] };
            let layers =
                Layers::new(&lit_by, shown, picture.surround, several, &mut self.transform, control)?;
            let found: Vec<KnownLight> = missing
                .iter()
                .zip(&lit)
                .zip(layers.seen_in_each())
                .map(|(((_, (of, lux)), lit), seen)| KnownLight {
                    of: of.clone(),
                    luminous: observer.xyz(&lit.result.illuminant.radiance_of_white).y / lux,
                    white: lit.white.to_array(),
                    error: seen.error,
                    neighbours_light: seen.neighbours_light,
                    pixels: seen.pixels,
                })
                .collect();
            self.lights.extend(found);
        }
        for (of, _) in &wanted {
            if let Some(at) = self.position(of) {
                let used = self.lights.remove(at);
                self.lights.push(used);
            }
        }
        let most = MOST.max(wanted.len());
        self.lights.drain(..self.lights.len().saturating_sub(most));
        let known = |(of, lux): &(Scene, f64)| {
            let light = self.position(of).map(|at| &self.lights[at])?;
            Some((lux * light.luminous, light))
        };
        wanted.iter().map(known).collect::<Option<_>>().ok_or(DisplayError::NoWhite { what: "a picture" })
    }

    fn position(&self, of: &Scene) -> Option<usize> {
        self.lights.iter().position(|light| light.of == *of)
    }
}
