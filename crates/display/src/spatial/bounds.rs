//! Numbers of cells and pixels of figures, within bounds of time and memory.
//!
//! Light that layers return comes back from a few thicknesses away: cells are a part of the thickness, as
//! long as there are not too many. Under a thinner medium they stay as large as they are: light returns to
//! the cell itself, and the irradiance tends to `1/(1 - rho A(0))`.

use papilio_imaging::text::Bitmap;

use super::Level;

/// Most cells of a figure in the plane and along a line, at the coarse one of two levels and at the finer
/// one.
const IN_PLANE: [u32; 2] = [16, 18];
const ALONG_LINE: [u32; 2] = [14, 16];

/// Most pixels of a text.
pub(super) const MOST_PIXELS: usize = 1 << 20;

fn most(powers: [u32; 2], level: Level) -> usize {
    1 << (powers[usize::from(level.is_fine)] + level.finer)
}

/// Number of cells across each pixel of a text, of a width of at most `widest_mm` if they fit.
pub(super) fn parts_of_pixels(
    bitmap: &Bitmap,
    pitch_mm: [f64; 2],
    widest_mm: f64,
    level: Level,
) -> [usize; 2] {
    let fit = (most(IN_PLANE, level) as f64 / (bitmap.count[0] * bitmap.count[1]) as f64).sqrt();
    pitch_mm.map(|pitch| (pitch / widest_mm).ceil().min(fit).max(1.0) as usize)
}

/// Number of cells of a length that repeats in the plane, of at most `widest_mm` if they fit.
pub(super) fn cells_across(length_mm: f64, widest_mm: f64, level: Level) -> usize {
    (length_mm / widest_mm).ceil().min((most(IN_PLANE, level) as f64).sqrt()) as usize
}

/// Number of cells along a line, a power of two: `wanted`, if they fit.
pub(super) fn cells_along(wanted: f64, level: Level) -> usize {
    (wanted.min(most(ALONG_LINE, level) as f64) as usize).next_power_of_two()
}
