//! Patterns of two states and text: means over a period, contrast of strokes.

use std::collections::BTreeSet;

use papilio_fourier::smooth;
use papilio_imaging::text::{Bitmap, Font, Setting, X_HEIGHT};
use schemars::JsonSchema;
use serde::Serialize;

use super::bounds::MOST_PIXELS;
use super::{Level, Response, Seen};
use crate::readability::Reader;
use crate::scene::Scene;

/// White pixels around text.
const MARGIN: usize = 4;

/// More of them where light is returned, in reaches of this light, at a coarse and at a fine level. The page
/// repeats, and the next copies darken the text: their part decreases with the fourth power of their
/// distance, so that the difference of both levels bounds it.
const MARGINS: [f64; 2] = [5.0, 8.0];

/// Factor of the margin for each halving of the cells.
const MORE_MARGIN: f64 = 1.5;

/// Largest margins, pixels, at both levels: where they hold, the levels still differ.
const MOST_MARGINS: [f64; 2] = [120.0, 200.0];

/// Pixels on each side of a stroke whose light a kernel adds, and their number.
const NEIGHBOURS: i64 = 24;
const SIDE: i64 = 2 * NEIGHBOURS + 1;

/// Patterns and text whose contrast is computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Patterns {
    /// Kinds of patterns.
    pub kinds: Vec<PatternKind>,
    /// State of one half of the area.
    pub on: String,
    /// State of the other half.
    pub off: String,
    /// Periods, mm.
    pub period_mm: Vec<f64>,
    /// Text of black on white pixels.
    pub text: String,
}

impl Default for Patterns {
    fn default() -> Self {
        Self {
            kinds: Vec::new(),
            on: "white".to_owned(),
            off: "black".to_owned(),
            period_mm: Vec::new(),
            text: "Papilio".to_owned(),
        }
    }
}

/// Kind of a pattern; half of its area is in either state.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum PatternKind {
    /// Stripes along y; they repeat along x.
    Stripes,
    /// Squares with sides of half a period.
    Checkerboard,
}

/// Mean over a period of a pattern.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the letters of the field's own symbols")]
pub struct PatternMean {
    /// Inclination of the view, degrees.
    pub theta_deg: f64,
    /// Azimuth of the view, degrees.
    pub phi_deg: f64,
    /// The pattern.
    pub kind: PatternKind,
    /// Its period, mm.
    pub period_mm: f64,
    /// Mean Y.
    pub mean_Y: f64,
    /// The same without the images of the room in flat faces.
    pub mean_Y_via_pixel: f64,
    /// Error of both.
    pub error: f64,
}

/// A pattern of two states.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pattern {
    pub(crate) kind: PatternKind,
    /// Period, mm; 0: the limit of fine patterns.
    pub(crate) period_mm: f64,
    /// Indices of the two states.
    pub(crate) states: [usize; 2],
}

/// Mean Y of a pattern via the pixel. To first order it is that of its states.
pub(super) fn mean(seen: &[Seen], pattern: Pattern, level: Level) -> f64 {
    let of_light = |seen: &Seen| {
        seen.response.pattern_mean(pattern, level).unwrap_or_else(|| {
            let y = seen.response.transfer(0, 0.0);
            pattern.states.iter().map(|state| 0.5 * y[*state].re).sum()
        })
    };
    seen.iter().map(of_light).sum()
}

/// Exponent n of Yule and Nielsen for which `(mean of Y^(1/n))^n` of two equal areas is the mean of a pattern. 1 for a mean that is
/// that of its states; `None` if there is none from 1 to 100.
pub(super) fn yule_nielsen(states: [f64; 2], mean: f64) -> Option<f64> {
    let of = |n: f64| states.iter().map(|y| 0.5 * y.max(0.0).powf(1.0 / n)).sum::<f64>().powf(n);
    let (mut low, mut high) = (1.0, 100.0);
    if !(mean <= of(low) * (1.0 + 1e-9) && mean >= of(high)) {
        return None;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if of(middle) > mean { low = middle } else { high = middle }
    }
    Some(0.5 * (low + high))
}

/// Why the contrast of a text is not computed: it has too many pixels. `None` if it fits.
pub(super) fn too_large(scene: &Scene, text: &str, pitch_mm: [f64; 2]) -> Option<String> {
    let height_mm = Reader::of(scene).text_height_mm;
    let [em_x, em_y] = pitch_mm.map(|pitch| height_mm / X_HEIGHT / pitch);
    let letters = text.lines().map(|line| line.chars().count()).max().unwrap_or(0);
    let pixels = letters as f64 * em_x * text.lines().count() as f64 * em_y;
    let most = MOST_PIXELS as f64;
    (pixels > most).then(|| {
        format!(
            "the contrast of text is not computed: at viewer.text_height_mm = {height_mm}, {text:?} has about {pixels:.1e} pixels (expected a \
             height of at most {:.2e} mm, for {most:.1e} pixels of this pitch)",
            height_mm * (most / pixels).sqrt()
        )
    })
}

/// Text on the pixels of a matrix; `None` if it is [`too_large`], or cannot be set.
pub(super) fn bitmap(scene: &Scene, text: &str, pitch_mm: [f64; 2]) -> Option<Bitmap> {
    if too_large(scene, text, pitch_mm).is_some() {
        return None;
    }
    let size_mm = Reader::of(scene).text_height_mm / X_HEIGHT;
    let per_inch = pitch_mm.map(|pitch| 25.4 / pitch);
    let setting = Setting { size_pt: size_mm * 72.0 / 25.4, per_inch, margin: MARGIN };
    Font::bundled().bitmap(text, setting).ok()
}

/// Y via the pixel in the middle of each stroke of black text on white; states are black and white.
pub(super) fn strokes(
    seen: &[Seen],
    bitmap: &Bitmap,
    pitch_mm: [f64; 2],
    states: [usize; 2],
    level: Level,
) -> Vec<f64> {
    let middles = bitmap.middles().strokes;
    let text = Text { bitmap, pitch_mm, middles: &middles };
    let mut sums = vec![0.0; middles.len()];
    for Seen { response, .. } in seen {
        let lights = response.text(&text, states, level).unwrap_or_else(|| {
            // A white page, less white and more black within black pixels.
            let [black, white] = states;
            let kernel = text.kernel(&**response);
            let page = response.transfer(0, 0.0)[white].re;
            let [more, less] = [black, white].map(|state| text.over_black(&kernel, state));
            more.iter().zip(less).map(|(more, less)| page + more - less).collect()
        });
        sums.iter_mut().zip(lights).for_each(|(sum, light)| *sum += light);
    }
    sums
}

/// Text whose strokes are seen.
pub(crate) struct Text<'a> {
    pub(super) bitmap: &'a Bitmap,
    pub(super) pitch_mm: [f64; 2],
    /// Numbers of the pixels in the middle of strokes.
    pub(super) middles: &'a [usize],
}

/// Light of a kernel from some pixels.
pub(super) struct Tile {
    /// The pixel in the middle.
    middle: [i64; 2],
    /// Rows from the bottom, `[state][cell]`.
    cells: Vec<Vec<f64>>,
}

impl Text<'_> {
    /// Light from pixels about the one that is seen, and about images of it.
    pub(super) fn kernel(&self, response: &dyn Response) -> Vec<Tile> {
        let peaks = response.peaks().into_iter().map(|peak| peak.at_mm);
        let mut tiles = BTreeSet::from([[0; 2]]);
        for at_mm in peaks.chain(response.images()) {
            let [x, y] = [0, 1].map(|axis| {
                let pixel = (at_mm[axis] / self.pitch_mm[axis]).round() as i64;
                [-1, 1].map(|side| (pixel + side * NEIGHBOURS / 2 + NEIGHBOURS).div_euclid(SIDE))
            });
            tiles.extend(x.iter().flat_map(|x| y.map(|y| [*x, y])));
        }
        // Beyond the text there is its page.
        let reaches = |tile: &[i64; 2]| {
            (0..2).all(|axis| SIDE * tile[axis].abs() - NEIGHBOURS < self.bitmap.count[axis] as i64)
        };
        let of_tile = |tile: [i64; 2]| {
            let middle = tile.map(|at| SIDE * at);
            let edges = |axis: usize| -> Vec<f64> {
                let pixels = middle[axis] - NEIGHBOURS..=middle[axis] + NEIGHBOURS + 1;
                pixels.map(|k| (k as f64 - 0.5) * self.pitch_mm[axis]).collect()
            };
            Tile { middle, cells: response.cells(&edges(0), &edges(1)) }
        };
        tiles.into_iter().filter(reaches).map(of_tile).collect()
    }

    /// The text on a larger page, to which light returns from `reach_mm` away, and the pixels in the middle of
    /// strokes there.
    pub(super) fn on_page(&self, reach_mm: f64, level: Level) -> (Bitmap, Vec<usize>) {
        let [reaches, most] = [MARGINS, MOST_MARGINS].map(|of| of[usize::from(level.is_fine)]);
        let margin_mm = reaches * MORE_MARGIN.powi(level.finer as i32) * reach_mm;
        let margin = self.pitch_mm.map(|pitch| (margin_mm / pitch).ceil().min(most) as usize);
        let count = [0, 1].map(|axis| smooth(self.bitmap.count[axis] + 2 * margin[axis]));
        let columns = self.bitmap.count[0];
        let moved = |pixel: &usize| (pixel / columns + margin[1]) * count[0] + pixel % columns + margin[0];
        let middles = self.middles.iter().map(moved).collect();
        (self.bitmap.on_page(margin, count), middles)
    }

    /// What a kernel shows of black pixels in the middle of each stroke.
    pub(super) fn over_black(&self, kernel: &[Tile], state: usize) -> Vec<f64> {
        let light: Vec<f64> = self.bitmap.black.iter().map(|black| f64::from(u8::from(*black))).collect();
        self.seen(kernel, state, &light)
    }

    /// What a kernel shows of the light of the pixels in the middle of each stroke; none comes from elsewhere.
    pub(super) fn seen(&self, kernel: &[Tile], state: usize, pixels: &[f64]) -> Vec<f64> {
        let [columns, rows] = self.bitmap.count.map(|count| count as i64);
        let one = |pixel: &usize| {
            let (x, y) = (*pixel as i64 % columns, *pixel as i64 / columns);
            let mut light = 0.0;
            for Tile { middle, cells } in kernel {
                for (cell, of_cell) in (0..SIDE * SIDE).zip(&cells[state]) {
                    // The cell at r shows the pixel at the place of the stroke less r.
                    let (at_x, at_y) = (
                        x - middle[0] - (cell % SIDE - NEIGHBOURS),
                        y - middle[1] - (cell / SIDE - NEIGHBOURS),
                    );
                    let inside = (0..columns).contains(&at_x) && (0..rows).contains(&at_y);
                    if inside {
                        light += of_cell * pixels[(at_y * columns + at_x) as usize];
                    }
                }
            }
            light
        };
        self.middles.iter().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Paper of 0.6 and 0.03, 50 %, fine: patches 0.362048 and 0.011837, mean 0.150298.
    #[test]
    fn clapper_yule_has_known_exponent() {
        let n = yule_nielsen([0.362_048, 0.011_837], 0.150_298).unwrap();
        assert!((n - 1.463).abs() < 5e-4, "{n}");
        let n = yule_nielsen([0.5, 0.1], 0.3).unwrap();
        assert!((n - 1.0).abs() < 1e-6);
        assert_eq!(yule_nielsen([0.5, 0.1], 0.31), None);
    }
}
