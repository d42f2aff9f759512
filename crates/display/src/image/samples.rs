//! Several samples in each pixel: sub-pixels at their places.
//!
//! Each pixel is divided into equal cells. A cell shows the sub-pixels and the inactive area by the fractions
//! that they have in it: the panel becomes one of smaller pixels, whose states are the cells of all states,
//! and its picture is computed as any other.

use super::held::Lit;
use super::stack::{self, Picture};
use super::{ImageSettings, seen_by_reader};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::{FilmState, Matrix, Pixel, Rectangle, Scene, SubPixelWindow, Window};
use crate::setup::Setup;

/// Most samples of a picture: as many as pixels of a file.
const MOST: usize = 64_000_000;

/// Most different cells of all states: their numbers are bytes.
const MOST_CELLS: usize = 256;

/// Difference of areas in two cells that counts as rounding.
const ROUNDING: f64 = 1e-9;

/// A panel whose pixels are divided into cells.
struct Divided {
    scene: Scene,
    /// State of the divided panel in each cell of each state, rows from the top.
    cells: Vec<Vec<u8>>,
    /// For each state of the divided panel, that of the whole pixel.
    wholes: Vec<usize>,
}

/// What the reader sees of the states of all pixels, with `per_pixel` x `per_pixel` samples in each.
pub(super) fn seen(
    lit: &Lit,
    picture: Picture<'_>,
    per_pixel: usize,
    settings: &ImageSettings,
    control: &Control<'_>,
) -> Result<Vec<[f32; 3]>, DisplayError> {
    let Lit { setup: Setup { scene, .. }, palette, .. } = lit;
    let samples = per_pixel * per_pixel * picture.states.len();
    if samples > MOST {
        return Err(DisplayError::TooManySamples { per_pixel, samples, most: MOST });
    }
    if scene.display.filter().is_some() {
        let what = "samples in pixels below a colour filter".to_owned();
        return Err(DisplayError::PlacesNotComputed { what, key: "image.samples_per_pixel".to_owned() });
    }
    let divided = Divided::new(scene, per_pixel)?;
    let numbers = stack::numbers(&scene.display.state_names(), palette);
    let mut states = Vec::with_capacity(samples);
    for line in picture.states.chunks_exact(picture.size[0]) {
        for row in 0..per_pixel {
            let cells =
                |state: &u8| &divided.cells[numbers[usize::from(*state)]][row * per_pixel..][..per_pixel];
            states.extend(line.iter().flat_map(cells));
        }
    }
    let size = picture.size.map(|pixels| per_pixel * pixels);
    // All states of the divided panel are needed, not only those of the palette.
    let settings = ImageSettings { states: Vec::new(), ..settings.clone() };
    let mut prepared = Prepared::of(lit.setup.clone());
    let lit =
        control.within([0.0, 0.3], |control| Lit::new(&divided.scene, &settings, &mut prepared, control))?;
    let picture = Picture { size, states: &states, wholes: &divided.wholes };
    Ok(control.within([0.3, 1.0], |control| seen_by_reader(&lit, picture, &settings, control))?.pixels)
}

/// A picture with each pixel repeated `per_pixel` times in both directions.
pub(super) fn repeated(pixels: &[[f32; 3]], columns: usize, per_pixel: usize) -> Vec<[f32; 3]> {
    let line = |line: &[[f32; 3]]| -> Vec<[f32; 3]> {
        line.iter().flat_map(|pixel| std::iter::repeat_n(*pixel, per_pixel)).collect()
    };
    pixels.chunks_exact(columns).flat_map(|pixels| line(pixels).repeat(per_pixel)).collect()
}

impl Divided {
    fn new(scene: &Scene, per_pixel: usize) -> Result<Self, DisplayError> {
        let mut divided = scene.clone();
        if let Some(matrix) = &mut divided.display.matrix {
            let whole = Window::from_rectangle(Rectangle::WHOLE);
            let cell = SubPixelWindow { name: "cell".to_owned(), fraction: 1.0, window: whole };
            matrix.pitch_mm = matrix.pitch_mm.map(|pitch| pitch / per_pixel as f64);
            matrix.pixels = matrix.pixels.map(|pixels| pixels.map(|count| count * per_pixel));
            matrix.sub_pixels = vec![cell];
        }
        let known = scene.display.state_names().len();
        let (Pixel::Film(film), Some(matrix)) = (&mut divided.display.pixel, &scene.display.matrix) else {
            // The places of sub-pixels are not known: all cells of a state are alike.
            let cells = (0..known).map(|state| vec![state as u8; per_pixel * per_pixel]).collect();
            return Ok(Self { scene: divided, cells, wholes: Vec::new() });
        };
        let (kinds, kind_of_cell) = kinds_of_cells(matrix, per_pixel);
        // The states of whole pixels come first: light that layers return is that of pages of them.
        let count = known * (1 + kinds.len());
        if count > MOST_CELLS {
            return Err(DisplayError::TooManyCells { per_pixel, cells: count, most: MOST_CELLS });
        }
        let of_kind = |state: usize, kind: usize| known + state * kinds.len() + kind;
        let of_state = |state| kind_of_cell.iter().map(|kind| of_kind(state, *kind) as u8).collect();
        let cells = (0..known).map(of_state).collect();
        let parts: Vec<FilmState> = film
            .states
            .iter()
            .flat_map(|state| {
                kinds.iter().enumerate().map(|(kind, areas)| FilmState {
                    name: format!("{}, cell {kind}", state.name),
                    drives: state.drives.clone(),
                    areas: Some(areas.clone()),
                })
            })
            .collect();
        film.states.extend(parts);
        let wholes = (0..known).chain((0..known * kinds.len()).map(|part| part / kinds.len())).collect();
        Ok(Self { scene: divided, cells, wholes })
    }
}

/// Areas of the sub-pixels in cells that differ, and the number of these areas for each cell of a pixel, rows
/// from the top.
fn kinds_of_cells(matrix: &Matrix, per_pixel: usize) -> (Vec<Vec<f64>>, Vec<usize>) {
    let coverage = |one: &SubPixelWindow| {
        // The area of a window differs a little from the fraction with which colours are computed.
        let scale = if one.fraction > 0.0 { one.fraction / one.window.area() } else { 0.0 };
        let mut cells = one.window.coverage([per_pixel; 2]);
        cells.iter_mut().for_each(|covered| *covered *= scale);
        cells
    };
    let covered: Vec<Vec<f64>> = matrix.sub_pixels.iter().map(coverage).collect();
    let (mut kinds, mut of_cell) = (Vec::<Vec<f64>>::new(), Vec::new());
    for row in (0..per_pixel).rev() {
        for column in 0..per_pixel {
            let areas: Vec<f64> = covered.iter().map(|cells| cells[row * per_pixel + column]).collect();
            let is_same = |kind: &Vec<f64>| kind.iter().zip(&areas).all(|(a, b)| (a - b).abs() < ROUNDING);
            of_cell.push(kinds.iter().position(is_same).unwrap_or(kinds.len()));
            if of_cell.last() == Some(&kinds.len()) {
                kinds.push(areas);
            }
        }
    }
    (kinds, of_cell)
}
