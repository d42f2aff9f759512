//! Natural pictures: the tone, contrast and chroma of a photograph for a panel whose black is light.
//!
//! **What.** Lightness is split into a base, which follows edges, and detail. The base passes the tone curve of
//! the display's black ([`papilio_colour::mapping::Tone`]); detail keeps its contrast, or gains some, so that
//! shadows keep theirs where the curve is flat. Chroma is multiplied. White, black and all neutrals between them
//! stay neutral: mixtures of the display's white and black.
//!
//! **Chosen for each picture**, unless the user does: the fraction of its tones that are darker than the
//! display's black, `d`, makes the tone curve sharper, and raises the contrast of detail to `1.15 + 0.25 d` and chroma to `1.05 + 0.1 d`. A picture
//! in which most pixels equal their neighbours (a drawing, a chart) has no base: each colour has one tone, and flat
//! areas stay flat. White pixels, such as the margins of a picture on a panel, do not count. A photograph without any light tone is exposed for more light.

use std::borrow::Cow;

use papilio_colour::mapping::GamutMapping;
use papilio_colour::{Adaptation, D65_WHITE, Observer, Xyz};
use papilio_imaging::guided;
use papilio_spectra::{Grid, daylight, planck};
use schemars::JsonSchema;
use serde::Serialize;

use super::chunks::in_chunks;
use super::colour;
use crate::DisplayError;

/// Exposure, contrast, saturation and white balance of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Adjustments {
    /// Exposure in stops; `None`: 0, or more for a natural picture without light tones.
    pub exposure: Option<f64>,
    /// Factor on the contrast of detail in natural and vivid pictures; `None`: chosen for the picture.
    pub contrast: Option<f64>,
    /// Factor on chroma in natural and vivid pictures; `None`: chosen for the picture.
    pub saturation: Option<f64>,
    /// Correlated colour temperature of the light that becomes white, K; `None`: D65, as the picture states.
    pub white_balance_k: Option<f64>,
}

/// What was chosen for a natural or vivid picture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct Rendition {
    /// Exposure in stops.
    pub exposure: f64,
    /// Factor on the contrast of detail.
    pub contrast: f64,
    /// Factor on chroma.
    pub saturation: f64,
    /// Correlated colour temperature of the light that became white, K; null: as the picture states.
    pub white_balance_k: Option<f64>,
    /// Fraction of the pixels that are darker than the display's black.
    pub below_black_fraction: f64,
    /// Whether the picture is a drawing: most of its pixels equal their neighbours.
    pub is_drawing: bool,
}

/// A picture after exposure and white balance.
pub(super) struct AdjustedSource {
    /// Its pixels, unless they are those of the source.
    pub(super) pixels: Option<Vec<[f32; 3]>>,
    exposure: f64,
    is_drawing: bool,
}

/// Contrast and chroma of vivid pictures.
const VIVID: [f64; 2] = [1.5, 1.25];

/// Radius of the base, of the width of the picture, and the square of the differences of lightness that it
/// smooths.
const RADIUS: f64 = 0.03;
const EPSILON: f64 = 0.01;

/// Fraction of the pixels that equal their right and lower neighbours, from which a picture is a drawing.
const FLAT: f64 = 0.5;

/// Largest difference of X, Y, Z of equal pixels: far below a step of 8 bits, of which the smallest is 3e-4.
const SAME: f32 = 1e-5;

/// Brightest tones of a photograph that are left out when its exposure is decided.
const HIGHLIGHTS: f64 = 0.005;
/// Light of the largest primary, 1 for white, that the other tones should reach, and below which a photograph
/// is exposed for more light.
const EXPOSED: f64 = 0.9;
const UNDEREXPOSED: f64 = 0.5;
/// Largest exposure that is chosen, stops.
const MOST_STOPS: f64 = 2.0;

/// Colour temperature from which the light of a white balance is a phase of daylight, below it a black body.
const DAYLIGHT_FROM_K: f64 = 5000.0;

impl Adjustments {
    /// Applies exposure and white balance.
    pub(super) fn of_source(
        &self,
        pixels: &[[f32; 3]],
        columns: usize,
        is_natural: bool,
    ) -> Result<AdjustedSource, DisplayError> {
        let is_drawing = is_natural && flat_fraction(pixels, columns) >= FLAT;
        let chosen = || if is_natural && !is_drawing { missing_stops(pixels) } else { 0.0 };
        let exposure = self.exposure.unwrap_or_else(chosen);
        let mut adjusted = Cow::Borrowed(pixels);
        if let Some(kelvin) = self.white_balance_k {
            let balance = balance_from(kelvin)?;
            let of = |pixel: &[f32; 3]| balance.apply(colour(*pixel)).to_array().map(|one| one as f32);
            adjusted = Cow::Owned(pixels.iter().map(of).collect());
        }
        if exposure != 0.0 {
            let factor = exposure.exp2() as f32;
            adjusted = Cow::Owned(adjusted.iter().map(|pixel| pixel.map(|one| one * factor)).collect());
        }
        let pixels = match adjusted {
            Cow::Borrowed(_) => None,
            Cow::Owned(pixels) => Some(pixels),
        };
        Ok(AdjustedSource { pixels, exposure, is_drawing })
    }

    /// Lightness and chromatic coordinates that the display should show, before gamut mapping.
    pub(super) fn targets(
        &self,
        mapping: &GamutMapping,
        pixels: &[[f32; 3]],
        columns: usize,
        vivid: bool,
        adjusted: &AdjustedSource,
        threads: usize,
    ) -> Result<(Vec<[f32; 3]>, Rendition), DisplayError> {
        let black = mapping.lightness_of_black();
        let limited = |pixel: &[f32; 3]| {
            let [lightness, a, b] = mapping.appearance(colour(*pixel));
            [if lightness > 0.0 { lightness.min(1.0) } else { 0.0 }, a, b].map(|one| one as f32)
        };
        let mut targets = vec![[0.0; 3]; pixels.len()];
        in_chunks(threads, &mut targets, |first, targets| {
            targets.iter_mut().zip(&pixels[first..]).for_each(|(target, pixel)| *target = limited(pixel));
        });
        let lightness: Vec<f32> = targets.iter().map(|target| target[0]).collect();
        let below = lightness.iter().filter(|one| f64::from(**one) < black).count();
        let toned = pixels.iter().filter(|pixel| !is_white(pixel)).count();
        let below_black_fraction = below as f64 / toned.max(1) as f64;
        let is_drawing = adjusted.is_drawing;
        let [contrast, saturation] = match (vivid, is_drawing) {
            (true, _) => VIVID,
            (false, true) => [1.0, 1.0],
            (false, false) => [1.15 + 0.25 * below_black_fraction, 1.05 + 0.1 * below_black_fraction],
        };
        let rendition = Rendition {
            exposure: adjusted.exposure,
            contrast: self.contrast.unwrap_or(contrast),
            saturation: self.saturation.unwrap_or(saturation),
            white_balance_k: self.white_balance_k,
            below_black_fraction,
            is_drawing,
        };
        let radius = (RADIUS * columns as f64).round().max(1.0) as usize;
        let base = if is_drawing { lightness } else { guided(&lightness, columns, radius, EPSILON)? };
        let shades = Shades::new(mapping, below_black_fraction);
        in_chunks(threads, &mut targets, |first, targets| {
            for (target, base) in targets.iter_mut().zip(&base[first..]) {
                let [lightness, a, b] = target.map(f64::from);
                let base = f64::from(*base).clamp(0.0, 1.0);
                let shown = shades.tone(base) + rendition.contrast * (lightness - base);
                let [lightness, grey_a, grey_b] = shades.grey(shown.clamp(black, 1.0));
                let chroma = [a, b].map(|one| rendition.saturation * one);
                *target = [lightness, grey_a + chroma[0], grey_b + chroma[1]].map(|one| one as f32);
            }
        });
        Ok((targets, rendition))
    }
}

/// The tone curve by lightness, and the mixtures of white and black by their own: between the steps they are
/// straight to 1e-7.
struct Shades {
    tones: Vec<f64>,
    greys: Vec<[f64; 3]>,
    black: f64,
}

impl Shades {
    const STEPS: usize = 8192;

    fn new(mapping: &GamutMapping, below_black_fraction: f64) -> Self {
        let (tone, black) = (mapping.tone(below_black_fraction), mapping.lightness_of_black());
        let part = |step: usize| step as f64 / Self::STEPS as f64;
        let grey = |step: usize| mapping.beside_grey([black + part(step) * (1.0 - black), 0.0, 0.0]);
        let tones = (0..=Self::STEPS).map(|step| tone.lightness(part(step))).collect();
        Self { tones, greys: (0..=Self::STEPS).map(grey).collect(), black }
    }

    /// Step below a part of the range, and the part of the next one.
    fn place(part: f64) -> (usize, f64) {
        let place = part.clamp(0.0, 1.0) * Self::STEPS as f64;
        let step = (place as usize).min(Self::STEPS - 1);
        (step, place - step as f64)
    }

    fn tone(&self, lightness: f64) -> f64 {
        let (step, part) = Self::place(lightness);
        self.tones[step] * (1.0 - part) + self.tones[step + 1] * part
    }

    /// Coordinates of the mixture of white and black.
    fn grey(&self, lightness: f64) -> [f64; 3] {
        let (step, part) = Self::place((lightness - self.black) / (1.0 - self.black));
        let (below, above) = (self.greys[step], self.greys[step + 1]);
        [0, 1, 2].map(|k| below[k] * (1.0 - part) + above[k] * part)
    }
}

/// Fraction of the pixels, without white ones, that equal their right and lower neighbours; 1 if all are white.
fn flat_fraction(pixels: &[[f32; 3]], columns: usize) -> f64 {
    let rows = pixels.len() / columns.max(1);
    // A picture that was scaled has the rounding of its weights.
    let is_like = |one: [f32; 3], other: [f32; 3]| one.iter().zip(other).all(|(a, b)| (a - b).abs() < SAME);
    let is_flat =
        |at: &usize| is_like(pixels[*at], pixels[at + 1]) && is_like(pixels[*at], pixels[at + columns]);
    let inner = (0..rows.saturating_sub(1))
        .flat_map(|y| (0..columns.saturating_sub(1)).map(move |x| y * columns + x));
    let (mut toned, mut flat) = (0_usize, 0_usize);
    for at in inner.filter(|at| !is_white(&pixels[*at])) {
        toned += 1;
        flat += usize::from(is_flat(&at));
    }
    if toned == 0 { 1.0 } else { flat as f64 / toned as f64 }
}

/// Whether a pixel is the white of the picture, to half a step of 8 bits.
fn is_white(pixel: &[f32; 3]) -> bool {
    pixel.iter().zip(D65_WHITE.to_array()).all(|(one, white)| f64::from(*one) > 0.995 * white)
}

/// Stops by which the light tones of a photograph are too dark; 0 where they are light enough.
fn missing_stops(pixels: &[[f32; 3]]) -> f64 {
    let largest = |pixel: &[f32; 3]| colour(*pixel).linear_srgb().into_iter().fold(0.0, f64::max);
    let mut light: Vec<f64> = pixels.iter().map(largest).collect();
    let at = ((1.0 - HIGHLIGHTS) * light.len().saturating_sub(1) as f64).round() as usize;
    if light.is_empty() {
        return 0.0;
    }
    let light = *light.select_nth_unstable_by(at, f64::total_cmp).1;
    if light > 0.0 && light < UNDEREXPOSED { (EXPOSED / light).log2().min(MOST_STOPS) } else { 0.0 }
}

/// Adaptation from the light of this colour temperature to D65.
fn balance_from(kelvin: f64) -> Result<Adaptation, DisplayError> {
    let light = |grid: &Grid| {
        if kelvin < DAYLIGHT_FROM_K { planck(kelvin, grid) } else { daylight(kelvin, grid) }
    };
    let white = || {
        let grid = Grid::new(380.0, 780.0, 5.0).ok()?;
        let Xyz { x, y, z } = Observer::new(&grid).ok()?.xyz(&light(&grid).ok()?);
        Adaptation::between(Xyz { x: x / y, y: 1.0, z: z / y }, D65_WHITE)
    };
    white().ok_or(DisplayError::NoWhite { what: "a white balance" })
}
