//! Drawings and photographs in one picture.
//!
//! Drawings are found by [`papilio_imaging::Areas`], or given. In a drawing, every pixel has one of the colours of
//! its flat areas: a pixel of text or of a line that lies between two of them takes the nearer one. A colour that is
//! that of an ink becomes this ink alone; any other gets the pattern of a mask, which is the same wherever the colour
//! is the same. Error diffusion and the search leave these pixels as they are.

use papilio_colour::{decoded_byte, encoded_byte};
use papilio_imaging::Areas;
use papilio_imaging::halftone::Mask;

use super::chunks::in_chunks;
use super::halftone::Panel;
use super::masks::masked;
use super::{SourceImage, colour};
use crate::DisplayError;
use crate::palette::{Palette, device_colour};
use crate::run::Control;

/// Which parts of a picture are drawings.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Regions {
    /// Found in natural and vivid pictures; with other intents, all is a photograph.
    #[default]
    Auto,
    /// All of it is a photograph.
    Photograph,
    /// All of it is a drawing.
    Drawing,
    /// Whether each pixel belongs to a drawing, by rows from the top.
    Given(Vec<bool>),
}

/// The parts of a picture that are drawings.
pub(super) struct Drawing {
    /// Whether each pixel belongs to it.
    pub(super) is_drawn: Vec<bool>,
    /// Encoded red, green and blue of the picture.
    colours: Vec<[u8; 3]>,
    columns: usize,
    /// Whether the area of one colour about each of its pixels is wider than a line, and whether it has as many pixels as a line.
    solid: Vec<bool>,
    long: Vec<bool>,
}

/// States of the pixels of drawings.
pub(super) struct Drawn {
    pub(super) states: Vec<Option<u8>>,
    pub(super) is_drawn: Vec<bool>,
}

/// Columns and rows of the mask of flat colours.
const MASK: usize = 16;

/// Largest difference of a component from the usual code of an ink, and from the display's own colour of it, of 255.
const OF_CODE: u8 = 8;
const OF_OWN: u8 = 2;

/// Difference of the components from which an own colour is no grey. Greys of the display are tones of the picture, too.
const CHROMATIC: u8 = 24;

/// Pixels around one of a line or of text in which its sides are looked for.
const NEAR: [usize; 2] = [2, 5];

/// Squared distance from the mixtures of two colours up to which a pixel is one of them.
const MIXTURE: f32 = 1024.0;

/// Pixels of an area without width that may be a line of its own colour.
const LINE: usize = 16;

impl Regions {
    /// The drawings of a picture, if it has any.
    pub(super) fn drawing(
        &self,
        source: &SourceImage,
        is_natural: bool,
        threads: usize,
    ) -> Result<Option<Drawing>, DisplayError> {
        let columns = source.columns;
        match self {
            Self::Photograph => return Ok(None),
            Self::Auto if !is_natural => return Ok(None),
            _ => {}
        }
        let mut colours = vec![[0; 3]; source.pixels.len()];
        in_chunks(threads, &mut colours, |first, colours| {
            for (to, pixel) in colours.iter_mut().zip(&source.pixels[first..]) {
                *to = colour(*pixel).linear_srgb().map(|value| encoded_byte(value.clamp(0.0, 1.0)));
            }
        });
        let areas = Areas::new(&colours, columns)?;
        let is_drawn = match self {
            Self::Given(is_drawn) if is_drawn.len() == colours.len() => is_drawn.clone(),
            Self::Given(is_drawn) => {
                return Err(DisplayError::Regions { pixels: is_drawn.len(), expected: colours.len() });
            }
            Self::Drawing => vec![true; colours.len()],
            _ => areas.drawing(),
        };
        if !is_drawn.contains(&true) {
            return Ok(None);
        }
        let [solid, long] = areas.solid_and_large(&is_drawn, LINE);
        Ok(Some(Drawing { is_drawn, colours, columns, solid, long }))
    }
}

/// What a pixel of a drawing shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    Ink(u8),
    /// The colour of this pixel.
    As(u32),
}

/// What a pixel with a colour of its own shows.
#[derive(Debug, Clone, Copy)]
enum Own {
    Ink(u8),
    Itself,
}

/// Colour of an ink in pictures.
struct Ink {
    state: u8,
    colour: [u8; 3],
    tolerance: u8,
}

impl Drawing {
    /// Fraction of the pixels.
    pub(super) fn fraction(&self) -> f64 {
        self.is_drawn.iter().filter(|one| **one).count() as f64 / self.is_drawn.len().max(1) as f64
    }

    /// The states of the pixels; the target of an ink becomes its colour.
    pub(super) fn drawn(
        &self,
        mapped: &mut [[f32; 3]],
        panel: &Panel<'_>,
        control: &Control<'_>,
    ) -> Result<Drawn, DisplayError> {
        let inks = inks(panel.palette);
        let shown = self.shown(&inks, mapped, panel);
        for (at, one) in shown.iter().enumerate() {
            if let Some(Shown::Ink(state)) = *one
                && inks.iter().any(|ink| ink.is(self.colours[at]))
            {
                mapped[at] = panel.rendering.states[usize::from(state)].map(|value| value as f32);
            }
        }
        // Photographs and inks need no pattern.
        let pattern = |at: usize| match shown[at] {
            Some(Shown::As(of)) => Some((mapped[of as usize], panel.is_few(of as usize))),
            _ => None,
        };
        let mut states = masked(&Mask::bayer(MASK)?, (mapped.len(), &pattern), panel, control)?;
        for (state, shown) in states.iter_mut().zip(&shown) {
            *state = match shown {
                Some(Shown::Ink(ink)) => Some(*ink),
                Some(Shown::As(_)) => *state,
                None => None,
            };
        }
        Ok(Drawn { states, is_drawn: self.is_drawn.clone() })
    }

    /// What each pixel of a drawing shows.
    fn shown(&self, inks: &[Ink], mapped: &[[f32; 3]], panel: &Panel<'_>) -> Vec<Option<Shown>> {
        let ink = |at: usize| inks.iter().find(|ink| ink.is(self.colours[at])).map(|ink| Own::Ink(ink.state));
        let own: Vec<Option<Own>> = (0..mapped.len())
            .map(|at| match self.is_drawn[at] {
                true => ink(at).or(self.solid[at].then_some(Own::Itself)),
                false => None,
            })
            .collect();
        let of = |at: usize| match own[at] {
            None if self.is_drawn[at] => {
                let near = NEAR.map(|reach| self.near(at, reach, &own));
                let near = near.iter().find(|near| !near.is_empty()).map_or(&[][..], Vec::as_slice);
                let closest = || Shown::Ink(panel.closest_state(at, mapped[at]) as u8);
                Some(self.side(at, near, inks, self.long[at]).unwrap_or_else(closest))
            }
            own => own.map(|own| own.at(at)),
        };
        (0..mapped.len()).map(of).collect()
    }

    /// The different colours around a pixel.
    fn near(&self, at: usize, reach: usize, own: &[Option<Own>]) -> Vec<([u8; 3], Shown)> {
        let (x, y) = (at % self.columns, at / self.columns);
        let rows = self.colours.len() / self.columns;
        let mut near: Vec<([u8; 3], Shown)> = Vec::new();
        for y in y.saturating_sub(reach)..(y + reach + 1).min(rows) {
            for x in x.saturating_sub(reach)..(x + reach + 1).min(self.columns) {
                let other = y * self.columns + x;
                if let Some(own) = own[other]
                    && near.iter().all(|(colour, _)| *colour != self.colours[other])
                {
                    near.push((self.colours[other], own.at(other)));
                }
            }
        }
        near
    }

    /// The nearer, in its light, of the two colours that a pixel is a mixture of: of two around it, or of one of them and an ink. A
    /// pixel that is half covered by a stroke is halfway in light, so that strokes keep their width.
    fn side(&self, at: usize, near: &[([u8; 3], Shown)], inks: &[Ink], is_long: bool) -> Option<Shown> {
        let pixel = self.colours[at];
        let mut best = (f32::INFINITY, None);
        let mut is_mixture = |a: ([u8; 3], Shown), b: ([u8; 3], Shown), more: f32| {
            let (distance, part) = from_mixtures(pixel, a.0, b.0);
            if distance + more < best.0 {
                let [here, one, other] = [pixel, a.0, b.0].map(luminance);
                let is_clear = (other - one).abs() > LIKE;
                let part = if is_clear { (here - one) / (other - one) } else { part };
                best = (distance + more, Some(if part < 0.5 { a.1 } else { b.1 }));
            }
        };
        for (number, one) in near.iter().enumerate() {
            near[number + 1..].iter().for_each(|other| is_mixture(*one, *other, 0.0));
        }
        for one in near {
            inks.iter().for_each(|ink| is_mixture(*one, (ink.colour, Shown::Ink(ink.state)), MIXTURE));
        }
        // A line between equal sides has a colour of its own.
        let is_between = best.0 <= MIXTURE && near.len() > 1;
        match best.1 {
            _ if is_long && !is_between => Some(Shown::As(at as u32)),
            None => near.first().map(|(_, shown)| *shown),
            side => side,
        }
    }
}

impl Own {
    /// The same of the pixel at this place.
    fn at(self, at: usize) -> Shown {
        match self {
            Self::Ink(state) => Shown::Ink(state),
            Self::Itself => Shown::As(at as u32),
        }
    }
}

impl Ink {
    fn is(&self, colour: [u8; 3]) -> bool {
        self.colour.iter().zip(colour).all(|(one, other)| one.abs_diff(other) <= self.tolerance)
    }
}

/// The usual codes of the states, and the colours that the display itself shows for chromatic ones and for those
/// without a code.
fn inks(palette: &Palette) -> Vec<Ink> {
    let colours = || palette.colours.iter().zip(0..=u8::MAX);
    let coded = colours().filter_map(|(one, state)| {
        Some(Ink { state, colour: device_colour(&one.state)?, tolerance: OF_CODE })
    });
    let own = colours().filter_map(|(one, state)| {
        let colour = one.srgb_relative?.map(|value| (255.0 * value.clamp(0.0, 1.0)).round() as u8);
        let is_chromatic = colour.iter().max()? - colour.iter().min()? >= CHROMATIC;
        let is_known = is_chromatic || device_colour(&one.state).is_none();
        is_known.then_some(Ink { state, colour, tolerance: OF_OWN })
    });
    coded.chain(own).collect()
}

/// Relative luminance of encoded red, green and blue.
fn luminance(colour: [u8; 3]) -> f32 {
    let [red, green, blue] = colour.map(decoded_byte);
    (0.2126 * red + 0.7152 * green + 0.0722 * blue) as f32
}

/// Difference of luminances from which two colours are told apart by their light.
const LIKE: f32 = 0.02;

/// Squared distance of a colour from the mixtures of two others, and the part of the second in the nearest one.
fn from_mixtures(colour: [u8; 3], one: [u8; 3], other: [u8; 3]) -> (f32, f32) {
    let [colour, one, other] = [colour, one, other].map(|colour| colour.map(f32::from));
    let along = [0, 1, 2].map(|k| other[k] - one[k]);
    let from = [0, 1, 2].map(|k| colour[k] - one[k]);
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let length = dot(along, along);
    let part = if length > 0.0 { (dot(from, along) / length).clamp(0.0, 1.0) } else { 0.0 };
    let rest = [0, 1, 2].map(|k| from[k] - part * along[k]);
    (dot(rest, rest), part)
}
