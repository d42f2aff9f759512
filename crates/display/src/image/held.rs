//! A picture that the panel holds: its states were decided in one light and view, and it is seen in others.

use papilio_colour::{Adaptation, Observer, Xyz};

use super::halftone::{self, Halftone, Panel};
use super::known::KnownLights;
use super::lamps::{LampImage, drawn_lamps};
use super::light::each_alone;
use super::rendering::{Rendered, Rendering, is_natural};
use super::search::REACH_OF_LAYERS;
use super::{ImageSettings, PictureSurround, SourceImage};
use crate::DisplayError;
use crate::palette::Palette;
use crate::polarisation::of_pages;
use crate::prepared::Prepared;
use crate::result::RunResult;
use crate::run::Control;
use crate::scene::Scene;
use crate::setup::Setup;
use crate::single_view::SingleView;
use crate::spatial::Blur;

/// A picture whose states are decided.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldPicture {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// State of each pixel, by its number in `names`; rows from the top.
    pub states: Vec<u8>,
    /// Names of the states.
    pub names: Vec<String>,
    /// What lies beyond the borders.
    pub surround: PictureSurround,
}

/// What the reader sees of a picture in each light of a room. In any mixture of these lights, each with a
/// factor, the reader sees the sum of their pictures, each with its factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Factors {
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// The picture in each light.
    pub lights: Vec<LightPicture>,
    /// X, Y, Z of a page of each state in all light, relative to a perfect white.
    pub pages: Vec<[f64; 3]>,
    /// Estimated error of X, Y, Z of a pixel.
    pub error: f64,
    /// Whether the light that layers return from each pixel to its neighbours is computed.
    pub neighbours_light: bool,
    /// Mirror images of lamps, which the pictures do not contain; their colours are those of the states of
    /// the picture, in all light. Collimated ones are those of small discs.
    pub lamps: Vec<LampImage>,
    /// Fraction of the panel in each state of the picture; without a halftone, that of a halftone with the
    /// same mean colour.
    pub coverage: Vec<f64>,
}

/// What the reader sees of a picture in one light of a room.
#[derive(Debug, Clone, PartialEq)]
pub struct LightPicture {
    /// Name of the light: `diffuse`, `directed.0`, `environment.0`, `front_light`.
    pub light: String,
    /// X, Y, Z of a perfect white in this light, relative to the Y of a perfect white in all light; 0 for a
    /// front light beside other light.
    pub white: [f64; 3],
    /// X, Y, Z of each pixel, relative to the same Y; rows from the top.
    pub pixels: Vec<[f32; 3]>,
}

/// A display in one light and view, for pictures.
pub(super) struct Lit {
    pub(super) setup: Setup,
    pub(super) view: SingleView,
    pub(super) result: RunResult,
    pub(super) palette: Palette,
    /// A perfect white.
    pub(super) white: Xyz,
}

/// A picture on its way to a display.
pub(super) struct Brought {
    pub(super) rendering: Rendering,
    pub(super) rendered: Rendered,
    /// Fraction of the pixels in drawings.
    pub(super) drawing_fraction: f64,
    /// The state of each pixel; none without a halftone.
    pub(super) states: Vec<u8>,
    /// Number of pixels at which colour was lost.
    pub(super) cut: usize,
}

impl Lit {
    /// Computes the colours of the states, in the order of the settings.
    pub(super) fn new(
        scene: &Scene,
        settings: &ImageSettings,
        prepared: &mut Prepared,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        let scene = &of_pages(scene)?;
        let view = SingleView::of(&scene.viewer, "a picture")?;
        let result = prepared.run(scene, control)?;
        let no_white = DisplayError::NoWhite { what: "a picture" };
        let palette = Palette::of(&result, 0).ok_or(no_white)?.with_states(&settings.states)?;
        let [x, y, z] = palette.white_XYZ;
        control.check()?;
        let setup = prepared.setup_of_views(scene, control)?.clone();
        Ok(Self { setup, view, result, palette, white: Xyz { x, y, z } })
    }
}

impl Lit {
    /// The first of several lights with colours of the states that are their means over all lights, each as an eye sees them that is
    /// adapted to a perfect white in its light.
    fn compromise(all: Vec<Self>) -> Result<Self, DisplayError> {
        let count = all.len() as f64;
        let mut lights = all.into_iter();
        let no_white = DisplayError::NoWhite { what: "a picture" };
        let mut first = lights.next().ok_or(no_white.clone())?;
        let mut sums = first.palette.pages();
        for other in lights {
            let adapted = Adaptation::between(other.white, first.white).ok_or(no_white.clone())?;
            for (sum, [x, y, z]) in sums.iter_mut().zip(other.palette.pages()) {
                let seen = adapted.apply(Xyz { x, y, z }).to_array();
                sum.iter_mut().zip(seen).for_each(|(sum, seen)| *sum += seen);
            }
        }
        for (colour, sum) in first.palette.colours.iter_mut().zip(sums) {
            [colour.X, colour.Y, colour.Z] = sum.map(|value| value / count);
        }
        Ok(first)
    }
}

impl Brought {
    /// Maps the colours of a picture to those of the display, and decides the states.
    pub(super) fn new(
        lit: &Lit,
        source: &SourceImage,
        settings: &ImageSettings,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        let mapping = (settings.intent, settings.space);
        let rendering = Rendering::new(&lit.palette, lit.white, mapping, source.pixels.len())?;
        let threads = control.thread_count();
        let drawing = settings.regions.drawing(source, is_natural(settings.intent), threads)?;
        let is_drawn = drawing.as_ref().map(|drawing| &drawing.is_drawn[..]);
        let mut rendered = {
            let picture = (&source.pixels[..], source.columns, is_drawn);
            rendering.rendered(picture, &settings.adjustments, settings.losses, threads)?
        };
        control.check()?;
        let spread = match settings.halftone {
            Halftone::RefinedErrorDiffusion | Halftone::DirectBinarySearch => {
                Blur::spread_of_white(&lit.setup, REACH_OF_LAYERS, control)?
            }
            _ => None,
        };
        let mut panel = Panel {
            columns: source.columns,
            palette: &lit.palette,
            rendering: &rendering,
            pixels_per_degree: super::pixels_per_degree(&lit.setup.scene),
            spread,
            drawn: None,
            neutral: settings.neutrals.of(&mut rendered.mapped, &rendering, &lit.palette, threads)?,
        };
        let mut drawing_fraction = 0.0;
        if let Some(drawing) = drawing {
            drawing_fraction = drawing.fraction();
            panel.drawn = Some(drawing.drawn(&mut rendered.mapped, &panel, control)?);
        }
        let (states, cut) = halftone::states(settings, &rendered.mapped, &panel, control)?;
        control.check()?;
        Ok(Self { rendering, rendered, drawing_fraction, states, cut })
    }
}

impl HeldPicture {
    /// Decides the states of a picture in the light and view of a scene, or in those of the settings' `prepared_for`. A display of one state
    /// shows it everywhere.
    ///
    /// # Errors
    /// As [`image`](super::image); if the settings have no halftone.
    pub fn new(
        scene: &Scene,
        source: &SourceImage,
        settings: &ImageSettings,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        Self::with(scene, source, settings, &mut Prepared::empty(), control)
    }

    /// [`new`](Self::new) with a prepared display, which is quicker for one that was computed before.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn with(
        scene: &Scene,
        source: &SourceImage,
        settings: &ImageSettings,
        prepared: &mut Prepared,
        control: &Control<'_>,
    ) -> Result<Self, DisplayError> {
        let size = source.size_on(scene)?;
        if let [only] = &scene.display.state_names()[..] {
            let (states, names) = (vec![0; size[0] * size[1]], vec![only.clone()]);
            return Ok(Self { size, states, names, surround: settings.surround });
        }
        if settings.halftone == Halftone::None && settings.given.is_none() {
            return Err(DisplayError::NoHalftone);
        }
        let lights = if settings.prepared_for.is_empty() {
            std::slice::from_ref(scene)
        } else {
            &settings.prepared_for[..]
        };
        let lit = control.within([0.0, 0.3], |control| {
            let lit = lights.iter().map(|scene| Lit::new(scene, settings, prepared, control));
            Lit::compromise(lit.collect::<Result<_, _>>()?)
        })?;
        let brought = control.within([0.3, 1.0], |control| Brought::new(&lit, source, settings, control))?;
        Ok(Self { size, states: brought.states, names: lit.palette.names(), surround: settings.surround })
    }

    /// Fraction of the pixels in each state.
    fn coverage(&self) -> Vec<f64> {
        let mut counts = vec![0_usize; self.names.len()];
        self.states.iter().for_each(|state| counts[usize::from(*state)] += 1);
        counts.into_iter().map(|count| count as f64 / self.states.len().max(1) as f64).collect()
    }

    /// Computes what the reader sees in each light of a scene, which may have another light, view or layers
    /// than that for which the states were decided, but must have these states.
    ///
    /// # Errors
    /// As [`run`](crate::run()); if the scene does not have exactly one view, a state does not exist, or the
    /// light has no colour.
    pub fn factors(&self, scene: &Scene, control: &Control<'_>) -> Result<Factors, DisplayError> {
        self.factors_of(scene, &mut Prepared::empty(), control)
    }

    /// [`factors`](Self::factors) with a prepared display, which is quicker for a series of scenes.
    ///
    /// # Errors
    /// Those of [`factors`](Self::factors).
    pub fn factors_of(
        &self,
        scene: &Scene,
        prepared: &mut Prepared,
        control: &Control<'_>,
    ) -> Result<Factors, DisplayError> {
        self.factors_with(scene, prepared, &mut KnownLights::default(), control)
    }

    /// [`factors_of`](Self::factors_of) with the lights of earlier scenes, which are not computed again.
    ///
    /// # Errors
    /// Those of [`factors`](Self::factors).
    pub fn factors_with(
        &self,
        scene: &Scene,
        prepared: &mut Prepared,
        known: &mut KnownLights,
        control: &Control<'_>,
    ) -> Result<Factors, DisplayError> {
        let settings = ImageSettings { states: self.names.clone(), ..ImageSettings::default() };
        let observer = Observer::of(scene.metrics.observer, &scene.grid)?;
        let all = Lit::new(scene, &settings, prepared, control)?;
        let total = observer.xyz(&all.result.illuminant.radiance_of_white).y;
        let alone = each_alone(scene);
        let is_front_light_alone = alone.iter().all(|one| one.is_front_light);
        let mut factors = Factors {
            size: self.size,
            lights: Vec::new(),
            pages: all.palette.pages(),
            error: 0.0,
            neighbours_light: false,
            lamps: drawn_lamps(&all.setup, &self.names, control)?,
            coverage: self.coverage(),
        };
        let known = known.of(self, &alone, &settings, prepared, control)?;
        for (one, (luminous, light)) in alone.iter().zip(known) {
            let share = luminous / total;
            let of_white = if one.is_front_light && !is_front_light_alone { 0.0 } else { share };
            factors.error += share * light.error;
            factors.neighbours_light |= light.neighbours_light;
            let pixels = light.pixels.iter().map(|pixel| pixel.map(|value| value * share as f32));
            let white = light.white.map(|value| value * of_white);
            factors.lights.push(LightPicture { light: one.light.clone(), white, pixels: pixels.collect() });
        }
        Ok(factors)
    }
}
