//! A small picture of Lambertian pixels: the mean of Y over each pixel of an ordinary panel, Y in the middle of
//! each pixel below general layers, as adding has it.

use papilio_display::scene::Scene;
use papilio_display::spatial::walk::pattern;
use papilio_display::spatial::{Picture, Precision, picture};
use papilio_display::{Control, DisplayError};
use papilio_transport::walk::places::{Pattern, SeenFrom};

use super::numbers::{Number, Numbers};

/// Columns and rows, and the state of each pixel, rows from the bottom: white is the first one.
const COUNT: [usize; 2] = [4, 3];
const STATES: [u8; 12] = [0, 1, 1, 0, 0, 0, 1, 0, 1, 0, 1, 1];

/// Gauss's rule of five points on a length of 1 about the middle.
const GAUSS_AT: [f64; 5] =
    [-0.453_089_922_969_332, -0.269_234_655_052_841_5, 0.0, 0.269_234_655_052_841_5, 0.453_089_922_969_332];
const GAUSS_WEIGHTS: [f64; 5] = [
    0.118_463_442_528_094_5,
    0.239_314_335_249_683_2,
    0.284_444_444_444_444_4,
    0.239_314_335_249_683_2,
    0.118_463_442_528_094_5,
];

/// What `papilio image` computes.
pub(super) fn by_adding(scene: &Scene, control: &Control<'_>) -> Result<Numbers, DisplayError> {
    let shown = Picture { count: COUNT, states: STATES.to_vec() };
    let found = picture(scene, &shown, Precision::FAST, control)?;
    let number = |seen: &[f32; 3]| Number { value: [f64::from(seen[1]), 0.0], error: found.error };
    Ok(named(found.views[0].iter().map(number)))
}

/// The same by paths.
pub(super) fn by_paths(scene: &Scene, paths: u64, control: &Control<'_>) -> Result<Numbers, DisplayError> {
    let pitch_mm = scene.display.matrix.as_ref().map_or([1.0; 2], |matrix| matrix.pitch_mm);
    let place = |at: usize| [(at % COUNT[0]) as f64 * pitch_mm[0], (at / COUNT[0]) as f64 * pitch_mm[1]];
    // Points of a Gaussian rule along each axis, in pixels from the middle, and their weights: light changes
    // within lengths of a tenth of a pixel.
    let (at, weights): (&[f64], &[f64]) = match scene.display.panel() {
        Some(_) => (&GAUSS_AT, &GAUSS_WEIGHTS),
        None => (&[0.0], &[1.0]),
    };
    let offsets: Vec<[f64; 2]> = at.iter().flat_map(|y| at.iter().map(move |x| [*x, *y])).collect();
    let weights: Vec<f64> = weights.iter().flat_map(|y| weights.iter().map(move |x| x * y)).collect();
    let of_pixel = |pixel: usize| {
        let middle = place(pixel);
        offsets.iter().map(move |offset| [0, 1].map(|k| middle[k] + offset[k] * pitch_mm[k]))
    };
    let places_mm: Vec<[f64; 2]> = (0..STATES.len()).flat_map(of_pixel).collect();
    let seen_from = SeenFrom { pattern: &Repeated { pitch_mm }, places_mm: &places_mm };
    let view = pattern(scene, &seen_from, paths, control)?.remove(0);
    let number = |places: &[papilio_display::spatial::walk::Mean]| {
        let mean = |of: fn(&papilio_display::spatial::walk::Mean) -> f64| -> f64 {
            places.iter().zip(&weights).map(|(seen, weight)| weight * of(seen)).sum()
        };
        // The places of a pixel are seen by the same paths: their errors are added.
        let error = mean(|seen| seen.standard_error).hypot(view.front.standard_error);
        Number { value: [mean(|seen| seen.value) + view.front.value, 0.0], error }
    };
    Ok(named(view.via_pixel.chunks(weights.len()).map(number)))
}

fn named(numbers: impl Iterator<Item = Number>) -> Numbers {
    numbers.enumerate().map(|(k, number)| (format!("picture {k}"), number)).collect()
}

/// The picture again and again; the middle of the first pixel is the origin.
struct Repeated {
    pitch_mm: [f64; 2],
}

impl Pattern for Repeated {
    fn images(&self) -> usize {
        1
    }

    fn period_mm(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        let [column, row] = [0, 1].map(|axis| {
            let pixel = (place_mm[axis] / self.pitch_mm[axis] + 0.5).floor() as i64;
            pixel.rem_euclid(COUNT[axis] as i64) as usize
        });
        covered(0, usize::from(STATES[row * COUNT[0] + column]), 1.0);
    }
}
