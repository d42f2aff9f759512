//! A state for each pixel of a picture.

use papilio_imaging::halftone::{ErrorDiffusion, FewStates, Mask};

use super::masks::masked;
use super::neutrals::Neutral;
use super::regions::Drawn;
use super::search::{REFINED, TO_THE_END, searched};
use super::{ImageSettings, Rendering, colour};
use crate::DisplayError;
use crate::palette::Palette;
use crate::run::Control;

/// How pixels with few states show many colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Halftone {
    /// Every pixel shows the mapped colour itself: a reference without halftone.
    None,
    /// Each pixel has the state closest to its colour: no pattern.
    Nearest,
    /// Each pixel is compared with Bayer's mask.
    Ordered,
    /// Each pixel is compared with a void-and-cluster mask.
    VoidAndCluster,
    /// The error of each pixel is passed on to its neighbours.
    ErrorDiffusion,
    /// Error diffusion, then three passes of the search of [`DirectBinarySearch`](Self::DirectBinarySearch), which
    /// removes worms and most of the visible pattern; error diffusion alone without a size of pixels.
    #[default]
    RefinedErrorDiffusion,
    /// Error diffusion, then changes of pixels as long as one lowers the visible error.
    DirectBinarySearch,
}

/// Columns and rows of Bayer's mask: 256 levels. The mask of 8 x 8 pixels has 64, whose steps are visible in
/// dark gradients.
const BAYER: usize = 16;

/// Columns and rows of the void-and-cluster mask: 4096 levels.
const VOID_AND_CLUSTER: usize = 64;

/// What a halftone depends on besides the picture and the settings.
pub(super) struct Panel<'a> {
    pub(super) columns: usize,
    pub(super) palette: &'a Palette,
    pub(super) rendering: &'a Rendering,
    /// Pixels in a degree of the visual angle, along x and y.
    pub(super) pixels_per_degree: Option<[f64; 2]>,
    /// Part of a pixel's light that is seen in each of its neighbours, `REACH_OF_LAYERS` pixels around it;
    /// `None` without blur.
    pub(super) spread: Option<Vec<f64>>,
    /// States of the pixels of drawings, except for `None` and `Nearest`.
    pub(super) drawn: Option<Drawn>,
    /// Pixels that take black, white and greys only.
    pub(super) neutral: Option<Neutral>,
}

impl Panel<'_> {
    /// Number of the state closest to the colour of a pixel, of those that it may take.
    pub(super) fn closest_state(&self, at: usize, wanted: [f32; 3]) -> usize {
        let few = self.neutral.as_ref().filter(|neutral| neutral.pixels[at]);
        self.rendering.closest_state(colour(wanted), |state| few.is_none_or(|few| few.allowed[state]))
    }

    /// Whether a pixel takes few states.
    pub(super) fn is_few(&self, at: usize) -> bool {
        self.neutral.as_ref().is_some_and(|neutral| neutral.pixels[at])
    }

    /// Whether a pixel belongs to a drawing.
    fn is_drawn(&self, at: usize) -> bool {
        self.drawn.as_ref().is_some_and(|drawn| drawn.is_drawn[at])
    }

    /// Which pixels take few states; empty: none does.
    pub(super) fn few(&self) -> &[bool] {
        self.neutral.as_ref().map_or(&[], |neutral| &neutral.pixels)
    }

    /// States with those of the drawings.
    fn with_drawings(&self, mut states: Vec<u8>) -> Vec<u8> {
        if let Some(drawn) = &self.drawn {
            let drawn = states.iter_mut().zip(&drawn.states);
            drawn.for_each(|(state, drawn)| *state = drawn.unwrap_or(*state));
        }
        states
    }
}

/// The state of each pixel, none without a halftone, and the number of pixels at which colour was lost.
pub(super) fn states(
    settings: &ImageSettings,
    mapped: &[[f32; 3]],
    panel: &Panel<'_>,
    control: &Control<'_>,
) -> Result<(Vec<u8>, usize), DisplayError> {
    if let Some(given) = &settings.given {
        let states = panel.palette.colours.len();
        let highest = given.iter().map(|state| usize::from(*state)).max().unwrap_or(0);
        if given.len() != mapped.len() || highest >= states {
            let (pixels, expected) = (given.len(), mapped.len());
            return Err(DisplayError::GivenStates { pixels, expected, highest, states });
        }
        return Ok((given.clone(), 0));
    }
    match settings.halftone {
        Halftone::None => Ok((Vec::new(), 0)),
        Halftone::Nearest => {
            let nearest = |(at, pixel): (usize, &[f32; 3])| panel.closest_state(at, *pixel) as u8;
            Ok((mapped.iter().enumerate().map(nearest).collect(), 0))
        }
        Halftone::Ordered | Halftone::VoidAndCluster => {
            let mask = match settings.halftone {
                Halftone::Ordered => Mask::bayer(BAYER)?,
                _ => Mask::void_and_cluster(VOID_AND_CLUSTER, settings.seed)?,
            };
            let target = |at: usize| (!panel.is_drawn(at)).then(|| (mapped[at], panel.is_few(at)));
            let states = masked(&mask, (mapped.len(), &target), panel, control)?;
            Ok((panel.with_drawings(states.into_iter().map(Option::unwrap_or_default).collect()), 0))
        }
        Halftone::ErrorDiffusion | Halftone::RefinedErrorDiffusion | Halftone::DirectBinarySearch => {
            let (kernel, scan, metric) = (settings.kernel, settings.scan, panel.rendering.metric());
            let diffusion = ErrorDiffusion { kernel, scan, metric, ..ErrorDiffusion::default() };
            let size @ [columns, _] = framed_size(mapped.len(), panel.columns);
            let row = framed(mapped, panel.columns);
            let drawn = panel.drawn.as_ref().map(|drawn| framed(&drawn.states, panel.columns));
            let fixed = drawn.as_ref().map(|row| row as &dyn Fn(usize, &mut [Option<u8>]));
            let marked =
                panel.neutral.as_ref().map(|neutral| (neutral, framed(&neutral.pixels, panel.columns)));
            let few = marked.as_ref().map(|(neutral, row)| FewStates {
                row,
                allowed: &neutral.allowed,
                line: neutral.line,
            });
            let found = diffusion.colours_beside(&row, (fixed, few), size, &panel.rendering.states)?;
            let states = without_frame(&found.states, columns, mapped.len());
            let cut = found.cut_pixels.min(mapped.len());
            let stages = match settings.halftone {
                Halftone::DirectBinarySearch => &TO_THE_END[..],
                Halftone::RefinedErrorDiffusion if panel.pixels_per_degree.is_some() => &REFINED,
                _ => return Ok((states, cut)),
            };
            Ok((searched(&states, mapped, panel, stages, control)?, cut))
        }
    }
}

/// Columns to the left and right, and rows above, that error diffusion begins with: there it has no errors
/// from neighbours yet, or loses them, and would draw a frame of another colour.
const FRAME: usize = 24;

/// Columns and rows of a picture with its frame.
fn framed_size(pixels: usize, columns: usize) -> [usize; 2] {
    [columns + 2 * FRAME, pixels / columns + FRAME]
}

/// Writes the rows of a picture between its mirror images at both sides and above.
fn framed<T: Copy>(pixels: &[T], columns: usize) -> impl Fn(usize, &mut [T]) {
    let rows = pixels.len() / columns;
    // Beyond a border, the picture continues as its mirror image.
    let mirrored = |at: isize, count: usize| {
        let at = at.rem_euclid(2 * count as isize) as usize;
        if at < count { at } else { 2 * count - 1 - at }
    };
    move |y: usize, into: &mut [T]| {
        let row = &pixels[mirrored(y as isize - FRAME as isize, rows) * columns..][..columns];
        for (x, into) in into.iter_mut().enumerate() {
            *into = row[mirrored(x as isize - FRAME as isize, columns)];
        }
    }
}

/// The states of a picture that was framed.
fn without_frame(states: &[u8], columns: usize, pixels: usize) -> Vec<u8> {
    let inside = columns - 2 * FRAME;
    let rows = states.chunks_exact(columns).skip(FRAME).map(|row| &row[FRAME..][..inside]);
    let found: Vec<u8> = rows.flatten().copied().collect();
    debug_assert_eq!(found.len(), pixels);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The frame of a picture is its mirror image, also of one that is smaller than the frame, and it is
    /// taken away again.
    #[test]
    fn frames_are_mirror_images() {
        for [columns, rows] in [[1, 1], [5, 3], [40, 30]] {
            let pixels: Vec<[f32; 3]> = (0..columns * rows).map(|k| [k as f32; 3]).collect();
            let row = framed(&pixels, columns);
            let [wide, high] = framed_size(pixels.len(), columns);
            let mut framed = vec![[0.0; 3]; wide * high];
            framed.chunks_exact_mut(wide).enumerate().for_each(|(y, line)| row(y, line));
            let first = &framed[FRAME * wide..][..wide];
            assert_eq!(first[FRAME - 1], first[FRAME]);
            let numbers: Vec<u8> = framed.iter().map(|pixel| (pixel[0] as usize % 256) as u8).collect();
            let back = without_frame(&numbers, wide, pixels.len());
            assert!(back.iter().enumerate().all(|(k, value)| usize::from(*value) == k % 256));
        }
    }
}
