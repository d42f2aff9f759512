//! Pictures on a display: which state each pixel gets, and what the reader sees of them in this light and view.
//!
//! The steps, each a function of its own, in linear light throughout:
//!
//! | step | function |
//! |---|---|
//! | the picture on the pixels of the panel, before | [`papilio_imaging::fitted`] |
//! | its white and black become those of the display in this light and view, and colours that no mixture of states has are mapped | `rendering.rs`, natural pictures also `natural.rs` |
//! | drawings in it: flat colours, text and lines | `regions.rs` |
//! | neutral colours by black and white alone | `neutrals.rs` |
//! | a state for each pixel | `halftone.rs`, `masks.rs`, `search.rs`, [`papilio_imaging::halftone`] |
//! | what the layers above the pixels make of them | `stack.rs`, [`picture`](crate::spatial::picture) |
//! | pixels below a colour filter | `filter.rs` |
//! | each part of the panel in its own direction | `perspective.rs` |
//! | mirror images of round lamps | `lamps.rs` |
//! | how far that is from the picture | `differences.rs` |
//! | the same picture in other light, light by light | `held.rs`, `light.rs`, `known.rs` |
//! | a picture without halftone, in its exact colours | `exact.rs` |
//! | several samples in a pixel: sub-pixels at their places | `samples.rs` |
//!
//! Rows of all pictures begin at the top. Colours are X, Y, Z relative to a perfect white in the same light.

mod chunks;
mod differences;
mod exact;
mod filter;
mod halftone;
mod held;
mod known;
mod lamps;
mod light;
mod masks;
mod memo;
mod natural;
mod neutrals;
mod perspective;
mod regions;
mod rendering;
mod samples;
mod search;
mod stack;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod tests_of_natural;
#[cfg(test)]
mod tests_of_neutrals;
#[cfg(test)]
mod tests_of_regions;
mod tone_shift;

use std::f64::consts::PI;

use chunks::{in_chunks, mean};
pub use differences::PictureDifferences;
pub use exact::exact;
pub use halftone::Halftone;
use held::{Brought, Lit};
pub use held::{Factors, HeldPicture, LightPicture};
pub use known::KnownLights;
pub use lamps::LampImage;
use memo::Memo;
pub use natural::{Adjustments, Rendition};
pub use neutrals::Neutrals;
pub use papilio_colour::ScreenSpace;
use papilio_colour::mapping::{Intent, MapSpace};
use papilio_colour::pictures::{AffineMap, MappedPicture};
use papilio_colour::{Adaptation, D65_WHITE, Xyz, displayed, encoded_byte};
use papilio_imaging::halftone::{DiffusionKernel, Scan};
use perspective::Eye;
pub use regions::Regions;
use rendering::{Rendered, Rendering};
use schemars::JsonSchema;
use serde::Serialize;
use stack::{Picture, Seen};

use crate::DisplayError;
pub use crate::metrics::ImageMetrics;
use crate::palette::Palette;
use crate::prepared::Prepared;
use crate::result::Named;
use crate::run::Control;
use crate::scene::{Scene, Stop};
use crate::single_view::{LightSummary, SingleView};
use crate::spatial::sharpness;
pub use crate::spatial::{PictureSurround, Sharpness};

/// A picture with as many pixels as the display.
#[derive(Debug, Clone, PartialEq)]
pub struct SourceImage {
    /// Number of pixels in a row.
    pub columns: usize,
    /// X, Y, Z of each pixel under D65, Y = 1 of white.
    pub pixels: Vec<[f32; 3]>,
}

/// How a picture is brought to a panel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ImageSettings {
    /// What becomes of its white and black, and of colours that the display cannot show.
    pub intent: Intent,
    /// Space in which colours that the display cannot show keep their hue.
    pub space: MapSpace,
    /// Exposure, contrast, saturation and white balance.
    pub adjustments: Adjustments,
    /// Which parts are drawings.
    pub regions: Regions,
    /// Which states show neutral colours.
    pub neutrals: Neutrals,
    /// How pixels with few states show many colours.
    pub halftone: Halftone,
    /// Weights of error diffusion.
    pub kernel: DiffusionKernel,
    /// Order of the pixels of error diffusion.
    pub scan: Scan,
    /// Seed of the void-and-cluster mask.
    pub seed: u64,
    /// States that are used; empty: all.
    pub states: Vec<String>,
    /// What lies beyond the borders.
    pub surround: PictureSurround,
    /// Whether each part of the panel is seen in its own direction, by an eye at `viewer.distance_mm`; otherwise all of it in that of the view.
    pub perspective: bool,
    /// Displays in the lights and the view for which the states of the pixels are decided: a compromise, if there are several. Empty: those in
    /// which the picture is seen.
    pub prepared_for: Vec<Scene>,
    /// Whether the loss of each step is computed, [`ImageNumbers::losses`].
    pub losses: bool,
    /// Samples along each side of a pixel in [`ImageResult::seen`]; up to 1: one for each pixel, without sub-pixels.
    pub samples_per_pixel: usize,
    /// State of each pixel by its number in `states`, instead of a halftone.
    pub given: Option<Vec<u8>>,
}

/// How a picture is shown on a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Screen {
    /// What is white.
    pub white: ScreenWhite,
    /// Colour space.
    pub space: ScreenSpace,
}

/// What is white, 255, 255, 255, in the picture for a screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ScreenWhite {
    /// A perfect white in the light.
    #[default]
    Perfect,
    /// The white of the display.
    Display,
}

/// A picture on a display.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageResult {
    /// Number of columns and rows of the panel.
    pub size: [usize; 2],
    /// State of each pixel, by its number in [`ImageNumbers::states`]; empty without a halftone.
    pub states: Vec<u8>,
    /// From the picture after exposure and white balance to X, Y, Z with the white and black of the display.
    target: AffineMap,
    /// The picture after exposure and white balance, if they change it.
    adjusted: Option<Vec<[f32; 3]>>,
    /// X, Y, Z of each pixel in the gamut of the display: what a halftone should show.
    pub mapped: Vec<[f32; 3]>,
    /// X, Y, Z of each sample as the reader sees it, rows from the top: [`seen_size`](Self::seen_size). Numbers are those of one sample for
    /// each pixel.
    pub seen: Vec<[f32; 3]>,
    /// Samples along each side of a pixel, 1 or more.
    pub samples_per_pixel: usize,
    /// Encoded red, green and blue of `seen` in the colour space of the screen, adapted to D65; what is brighter than its white is as bright as
    /// it can be with the same hue.
    pub on_screen: Vec<[u8; 3]>,
    /// From the light of the display to D65.
    to_d65: Adaptation,
    /// The colour space of the screen.
    pub space: ScreenSpace,
    /// Luminance of a perfect white in the light, cd/m2.
    pub white_cd_m2: f32,
    /// Numbers.
    pub numbers: ImageNumbers,
    /// Colours of the states, in the same order: for the palette of a file.
    pub palette: Palette,
}

/// Numbers of a picture on a display.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as image.json spells them")]
pub struct ImageNumbers {
    /// The light.
    pub light: LightSummary,
    /// The view.
    pub view: SingleView,
    /// Number of columns and rows.
    pub size: [usize; 2],
    /// States, in the order of states.png.
    pub states: Vec<String>,
    /// Fraction of the pixels in each state; null without a halftone.
    pub coverage: Option<Named<f64>>,
    /// Fraction of the pixels whose colour no mixture of states has.
    pub out_of_gamut_fraction: f64,
    /// Error of the mapping of such colours by a table, CIEDE2000, 95th percentile; null if each pixel was mapped.
    pub mapping_error_delta_e_2000: Option<f64>,
    /// Fraction of the pixels in drawings: flat colours, text and lines, which have no error diffusion.
    pub drawing_fraction: f64,
    /// What was chosen for a natural or vivid picture; null for other intents.
    pub rendition: Option<Rendition>,
    /// Fraction of the pixels at which error diffusion lost colour, because the error exceeded its limit: 0 in most pictures, up to 0.2 where
    /// large areas have colours at the border of the gamut.
    pub cut_fraction: f64,
    /// Fraction of the pixels that a screen cannot show in seen.png, which are clipped.
    pub clipped_fraction: f64,
    /// Mean X, Y, Z of what is seen.
    pub mean_XYZ: [f64; 3],
    /// Pixels in a degree of the visual angle; null without [display.matrix].
    pub pixels_per_degree: Option<f64>,
    /// Differences from the picture itself, as a good screen beside the display shows it to a reader adapted to the display's white: its white
    /// is that white, its black is 0. No display reaches 0 where the picture is darker than its black.
    pub against_photograph: PictureDifferences,
    /// Differences from the picture with the white and black of this display in linear light, before gamut mapping: the target of the relative
    /// intent.
    pub against_source: PictureDifferences,
    /// Differences from the picture after tone and gamut mapping: what the halftone should show.
    pub against_mapped: PictureDifferences,
    /// What each step changes; present if it was requested, and the size of the pixels is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub losses: Option<Losses>,
    /// Sharpness of the white of the display; null without [display.matrix] and the thickness of the layers, below a colour filter, and of a table that depends on azimuth.
    pub sharpness: Option<Sharpness>,
    /// Whether the light that layers return from each pixel to its neighbours is computed.
    pub neighbours_light: bool,
    /// Estimated error of X, Y, Z of a pixel that is seen.
    pub error: f64,
    /// Warnings.
    pub warnings: Vec<String>,
    /// The same states in the light of other rooms, if they were requested.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub rooms: Vec<ImageInRoom>,
}

/// What each step between a photograph and what is seen of it changes: S-CIELAB, mean, against the picture before the step.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Losses {
    /// Exposure, tone and chroma: against the photograph.
    pub tone: f64,
    /// Gamut mapping.
    pub gamut: f64,
    /// A state for each pixel.
    pub halftone: f64,
    /// Layers above the pixels: blur, and light from neighbours.
    pub layers: f64,
}

/// Numbers of a picture in the light of another room.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct ImageInRoom {
    /// Name of the room.
    pub room: String,
    /// The numbers.
    #[serde(flatten)]
    pub numbers: ImageNumbers,
}

/// Brings a picture to a display, and computes what the reader sees.
///
/// # Errors
/// As [`run`](crate::run()); if the scene does not have exactly one view, a state does not exist, the light has no colour, or the picture has not as many
/// pixels as the display.
pub fn image(
    scene: &Scene,
    source: &SourceImage,
    settings: &ImageSettings,
    screen: Screen,
    control: &Control<'_>,
) -> Result<ImageResult, DisplayError> {
    let size = source.size_on(scene)?;
    let mut prepared = Prepared::empty();
    let held;
    let is_decided = settings.given.is_some() || settings.halftone == Halftone::None;
    let settings = if settings.prepared_for.is_empty() || is_decided {
        settings
    } else {
        let given = control.within([0.0, 0.3], |control| {
            HeldPicture::with(scene, source, settings, &mut prepared, control).map(|held| held.states)
        })?;
        held = ImageSettings { given: Some(given), ..settings.clone() };
        &held
    };
    let lit = control.within([0.3, 0.4], |control| Lit::new(scene, settings, &mut prepared, control))?;
    let Brought { rendering, rendered, drawing_fraction, states, cut } =
        control.within([0.4, 0.6], |control| Brought::new(&lit, source, settings, control))?;
    let Rendered { adjusted, toned, mapped, inside, table_error, rendition } = rendered;
    let to_screen =
        Adaptation::between(lit.white, D65_WHITE).ok_or(DisplayError::NoWhite { what: "a picture" })?;
    let picture = Picture { size, states: &states, wholes: &[] };
    let Seen { pixels: seen, error, between_places, neighbours_light } = match states.is_empty() {
        true => Seen {
            pixels: mapped.clone(),
            error: lit.palette.error(),
            between_places: 0.0,
            neighbours_light: false,
        },
        false => control.within([0.6, 0.8], |control| seen_by_reader(&lit, picture, settings, control))?,
    };
    control.check()?;
    let shown_as = match screen.white {
        ScreenWhite::Perfect => to_screen,
        ScreenWhite::Display => Adaptation::between(rendering.white, D65_WHITE).unwrap_or(to_screen),
    };
    let fraction = |number: usize| number as f64 / seen.len() as f64;
    let per_degree = pixels_per_degree(scene).map(|[along_x, _]| along_x);
    let compared = per_degree.filter(|per_degree| *per_degree <= MOST_PER_DEGREE);
    let threads = control.thread_count();
    let target = rendering.wanted();
    let wanted = MappedPicture { pixels: adjusted.as_deref().unwrap_or(&source.pixels), map: target };
    let [against_source, against_mapped] = PictureDifferences::against(
        &seen,
        [wanted, mapped[..].into()],
        size[0],
        lit.white,
        compared,
        threads,
    )?;
    let photograph = MappedPicture { pixels: &source.pixels, map: rendering.photograph() };
    let [against_photograph] =
        PictureDifferences::against(&seen, [photograph], size[0], rendering.white, compared, threads)?;
    let losses = if settings.losses
        && let Some(per_degree) = compared
    {
        let pages =
            lit.palette.pages().into_iter().map(|page| page.map(|value| value as f32)).collect::<Vec<_>>();
        let halftone: Vec<[f32; 3]> = states.iter().map(|state| pages[usize::from(*state)]).collect();
        let halftone = if states.is_empty() { &mapped } else { &halftone };
        let step = |after: &[[f32; 3]], before: MappedPicture<'_>| {
            let [one] = PictureDifferences::against(
                after,
                [before],
                size[0],
                rendering.white,
                Some(per_degree),
                threads,
            )?;
            Ok::<_, DisplayError>(one.scielab_mean.unwrap_or_default())
        };
        Some(Losses {
            tone: step(&toned, photograph)?,
            gamut: step(&mapped, toned[..].into())?,
            halftone: step(halftone, mapped[..].into())?,
            layers: step(&seen, halftone[..].into())?,
        })
    } else {
        None
    };
    drop(toned);
    let mut warnings = lit.result.warnings.clone();
    if error > LARGE_ERROR {
        let reason = if between_places > 0.5 * error {
            "the light changes much from one part of the panel to the next; image.perspective = false shows all of it in one direction"
        } else {
            "light that the layers return to it is that of a page of its state, other states and a mask beside it return more or less"
        };
        warnings
            .push(format!("X, Y or Z of a pixel may be wrong by {error:.2} of a perfect white: {reason}"));
    }
    if let Stop::RelativeError { target, .. } = scene.solver.stop
        && error > target
    {
        warnings.push(format!(
            "solver.relative_error = {target} is the target of the colours of pages: X, Y or Z of a pixel of the picture may be wrong by {error:.1e} of a \
             perfect white"
        ));
    }
    let samples_per_pixel = settings.samples_per_pixel.max(1);
    let sampled = match (samples_per_pixel, states.is_empty()) {
        (1, _) => None,
        (count, true) => Some(samples::repeated(&seen, size[0], count)),
        (count, false) => Some(
            control.within([0.8, 1.0], |control| samples::seen(&lit, picture, count, settings, control))?,
        ),
    };
    let sharpness = sharpness(&lit.setup, control)?;
    let Lit { view, result, palette, .. } = lit;
    let shown = sampled.as_ref().unwrap_or(&seen);
    let OnScreen { bytes: on_screen, clipped } = OnScreen::of(shown, &shown_as, screen.space, threads);
    let numbers = ImageNumbers {
        light: LightSummary::of(scene, &result),
        view,
        size,
        states: palette.names(),
        coverage: (!states.is_empty()).then(|| coverage(&palette, &states)),
        out_of_gamut_fraction: fraction(seen.len() - inside),
        mapping_error_delta_e_2000: table_error,
        drawing_fraction,
        rendition,
        cut_fraction: fraction(cut),
        clipped_fraction: clipped as f64 / shown.len() as f64,
        mean_XYZ: mean(threads, &seen),
        pixels_per_degree: per_degree,
        against_photograph,
        against_source,
        against_mapped,
        losses,
        sharpness,
        neighbours_light,
        error,
        warnings,
        rooms: Vec::new(),
    };
    let white_cd_m2 = (scene.lighting.illuminance_lx / PI) as f32;
    let space = screen.space;
    let seen = sampled.unwrap_or(seen);
    Ok(ImageResult {
        size,
        states,
        target,
        adjusted,
        mapped,
        seen,
        samples_per_pixel,
        on_screen,
        to_d65: to_screen,
        space,
        white_cd_m2,
        numbers,
        palette,
    })
}

/// What is seen, for a screen.
struct OnScreen {
    /// Encoded red, green and blue.
    bytes: Vec<[u8; 3]>,
    /// Number of samples that the screen cannot show.
    clipped: usize,
}

impl OnScreen {
    /// `shown_as` adapts X, Y, Z to what is white on the screen.
    fn of(seen: &[[f32; 3]], shown_as: &Adaptation, space: ScreenSpace, threads: usize) -> Self {
        let on_screen = |sample: [f32; 3]| {
            let shown = space.linear(shown_as.apply(colour(sample)));
            let is_clipped = shown.iter().any(|value| !(-CLIPPED..=1.0 + CLIPPED).contains(value));
            (displayed(shown).map(encoded_byte), is_clipped)
        };
        let mut bytes = vec![[0; 3]; seen.len()];
        let clipped = in_chunks(threads, &mut bytes, |first, bytes| {
            let (mut memo, mut clipped) = (Memo::new(), 0);
            for (bytes, sample) in bytes.iter_mut().zip(&seen[first..]) {
                let is_clipped;
                (*bytes, is_clipped) = memo.of(*sample, on_screen);
                clipped += usize::from(is_clipped);
            }
            clipped
        });
        Self { bytes, clipped: clipped.into_iter().sum() }
    }
}

impl ImageResult {
    /// Number of columns and rows of [`seen`](Self::seen) and [`on_screen`](Self::on_screen).
    pub fn seen_size(&self) -> [usize; 2] {
        self.size.map(|pixels| pixels * self.samples_per_pixel)
    }

    /// Gives back the memory of what was wanted: [`mapped`](Self::mapped) is empty, and [`wanted`](Self::wanted) that of a picture
    /// without exposure and white balance.
    pub fn forget_targets(&mut self) {
        (self.mapped, self.adjusted) = (Vec::new(), None);
    }

    /// X, Y, Z of each pixel that are wanted: the picture, whose pixels these are, with the white and black of the display.
    pub fn wanted(&self, source: &SourceImage) -> Vec<[f32; 3]> {
        let pixels = self.adjusted.as_deref().unwrap_or(&source.pixels);
        let wanted = |pixel: &[f32; 3]| self.target.apply(colour(*pixel)).to_array().map(|one| one as f32);
        pixels.iter().map(wanted).collect()
    }

    /// Adaptation of what is seen to D65.
    pub fn to_d65(&self) -> &Adaptation {
        &self.to_d65
    }

    /// A function that returns linear red, green and blue of a sample of [`seen`](Self::seen) with sRGB's primaries, adapted to D65, a perfect
    /// white 1; not clipped.
    pub fn linear(&self) -> impl FnMut(usize) -> [f32; 3] {
        let mut memo = Memo::new();
        move |sample| {
            memo.of(self.seen[sample], |seen| {
                self.to_d65.apply(colour(seen)).linear_srgb().map(|value| value as f32)
            })
        }
    }
}

impl ImageNumbers {
    /// Metrics of the picture, which compare it with the picture itself, and with its target before and after gamut mapping.
    pub fn metrics(&self) -> ImageMetrics {
        let (photograph, source) = (&self.against_photograph, &self.against_source);
        let mapped = &self.against_mapped;
        ImageMetrics {
            photograph_delta_e_2000_mean: Some(photograph.delta_e_2000_mean),
            photograph_scielab_mean: photograph.scielab_mean,
            photograph_scielab_p95: photograph.scielab_p95,
            photograph_flip_mean: photograph.flip_mean,
            delta_e_2000_mean: Some(source.delta_e_2000_mean),
            delta_e_2000_p95: Some(source.delta_e_2000_p95),
            scielab_mean: source.scielab_mean,
            scielab_p95: source.scielab_p95,
            flip_mean: source.flip_mean,
            mapped_tone_shift_percent: Some(mapped.tone_shift_percent),
            mapped_tone_shift_delta_e_2000: Some(mapped.tone_shift_delta_e_2000),
            out_of_gamut_fraction: Some(self.out_of_gamut_fraction),
            clipped_fraction: Some(self.clipped_fraction),
        }
    }
}

impl SourceImage {
    /// Number of columns and rows, which must be those of the display.
    fn size_on(&self, scene: &Scene) -> Result<[usize; 2], DisplayError> {
        let own = [self.columns, self.pixels.len() / self.columns.max(1)];
        let size = scene.display.matrix.as_ref().and_then(|matrix| matrix.pixels).unwrap_or(own);
        if size != own || own.contains(&0) || own[0] * own[1] != self.pixels.len() {
            return Err(DisplayError::PictureSize { picture: own, display: size });
        }
        Ok(size)
    }
}

/// What the reader sees of a picture of states, in one direction or in perspective.
fn seen_by_reader(
    lit: &Lit,
    picture: Picture<'_>,
    settings: &ImageSettings,
    control: &Control<'_>,
) -> Result<Seen, DisplayError> {
    match Eye::before(&lit.setup.scene, picture.size).filter(|_| settings.perspective) {
        Some(eye) => eye.seen(lit, picture, settings, control),
        None => stack::seen((&lit.setup, &lit.palette), picture, settings.surround, control),
    }
}

/// Largest number of pixels in a degree at which pictures are compared as the eye sees them, which resolves about 60:
/// filters of more pixels take much memory and time.
const MOST_PER_DEGREE: f64 = 3000.0;

/// Pixels in a degree of the visual angle along x and y; `None` without the size of the pixels.
fn pixels_per_degree(scene: &Scene) -> Option<[f64; 2]> {
    let per_degree =
        |pitch_mm: f64| papilio_colour::pictures::pixels_per_degree(1e3 * pitch_mm, scene.viewer.distance_mm);
    scene.display.matrix.as_ref().map(|matrix| matrix.pitch_mm.map(per_degree))
}

/// Error of what is seen, relative to a perfect white, from which on it is a warning.
const LARGE_ERROR: f64 = 0.02;

/// Light of a screen's primaries beyond 0 and 1 that counts as rounding.
const CLIPPED: f64 = 1e-3;

fn coverage(palette: &Palette, states: &[u8]) -> Named<f64> {
    let mut counts = vec![0_usize; palette.colours.len()];
    states.iter().for_each(|state| counts[usize::from(*state)] += 1);
    let fractions = counts.into_iter().map(|count| count as f64 / states.len() as f64);
    Named(palette.colours.iter().map(|colour| colour.state.clone()).zip(fractions).collect())
}

fn colour([x, y, z]: [f32; 3]) -> Xyz {
    Xyz { x: x.into(), y: y.into(), z: z.into() }
}
