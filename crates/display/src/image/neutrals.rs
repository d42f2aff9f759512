//! Neutral colours by the display's black, white and greys alone: text and line drawings without coloured dots.
//!
//! **What.** A target whose chroma is less than [`CHROMA`] becomes the mixture of the display's white and black with the
//! same Y, and its pixel takes one of the states that are grey. In error diffusion, such a pixel keeps the luminance of the
//! error that is passed to it, and loses its colour.

use papilio_colour::{Lab, Xyz};

use super::chunks::in_chunks;
use super::colour;
use super::rendering::Rendering;
use crate::DisplayError;
use crate::palette::Palette;

/// Which states show neutral colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Neutrals {
    /// All: a mixture of coloured dots may be finer.
    #[default]
    All,
    /// Black, white and the greys of the display.
    BlackAndWhite,
}

/// The neutral pixels of a picture.
pub(super) struct Neutral {
    /// Whether each pixel is one.
    pub(super) pixels: Vec<bool>,
    /// Whether they may take each state.
    pub(super) allowed: Vec<bool>,
    /// From black to white, in X, Y, Z.
    pub(super) line: [f64; 3],
}

/// Chroma in CIELAB, relative to the mixture of white and black with the same Y, below which a target is neutral: it is
/// hardly seen as a colour. A state counts as a grey below the larger one.
const CHROMA: f64 = 3.0;
const CHROMA_OF_GREY: f64 = 8.0;
/// Chroma from which the darkest or lightest state is no black or white.
const COLOURED: f64 = 25.0;

impl Neutrals {
    /// The neutral pixels of a picture, whose targets become mixtures of white and black.
    pub(super) fn of(
        self,
        mapped: &mut [[f32; 3]],
        rendering: &Rendering,
        palette: &Palette,
        threads: usize,
    ) -> Result<Option<Neutral>, DisplayError> {
        if self == Self::All {
            return Ok(None);
        }
        let [black, white] = rendering.black_and_white();
        let chroma = |colour: Xyz, beside: Xyz| {
            let labs = [colour, beside].map(|one| one.lab(rendering.white));
            let [Some(Lab { a, b, .. }), Some(grey)] = labs else { return f64::INFINITY };
            (a - grey.a).hypot(b - grey.b)
        };
        let mixture = |y: f64| black + (white - black) * ((y - black.y) / (white.y - black.y));
        let states = rendering.states.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z });
        for (number, state) in states.clone().enumerate() {
            if (state == black || state == white) && chroma(state, rendering.white) >= COLOURED {
                let name = palette.colours[number].state.clone();
                return Err(DisplayError::NoNeutral { state: name });
            }
        }
        let allowed = states
            .map(|state| {
                let is_end = state == black || state == white;
                is_end || chroma(state, mixture(state.y)) < CHROMA_OF_GREY
            })
            .collect();
        let mut pixels = vec![false; mapped.len()];
        let grey = |target: [f32; 3]| mixture(colour(target).y.clamp(black.y, white.y));
        in_chunks(threads, &mut pixels, |first, pixels| {
            for (is_neutral, target) in pixels.iter_mut().zip(&mapped[first..]) {
                *is_neutral = chroma(colour(*target), grey(*target)) < CHROMA;
            }
        });
        for (target, _) in mapped.iter_mut().zip(&pixels).filter(|(_, is_neutral)| **is_neutral) {
            *target = grey(*target).to_array().map(|value| value as f32);
        }
        Ok(Some(Neutral { pixels, allowed, line: (white - black).to_array() }))
    }
}
