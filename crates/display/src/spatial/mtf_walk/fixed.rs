//! Lines and text on the pixels, seen at the middles of lines and strokes: one image each.

use papilio_imaging::text::Bitmap;
use papilio_transport::walk::places::Pattern;

use crate::spatial::LineContrast;
use crate::spatial::mtf::Frame;
use crate::spatial::patterns;

/// Most middles of strokes that are seen.
const MOST_STROKES: usize = 256;

/// Images: lines, strokes of black text on white, the white and the black page, and half of the area of each
/// in the finest pattern.
pub(super) struct Fixed {
    white: usize,
    black: usize,
    pitch_mm: [f64; 2],
    /// Axis that the line is across, states of line and surround, and half of its width, mm; in the order of
    /// [`LineContrast`].
    lines: Vec<(usize, [usize; 2], f64)>,
    text: Option<Bitmap>,
    /// Numbers of the pixels in the middle of strokes.
    strokes: Vec<usize>,
}

impl Fixed {
    /// `None` without the states white and black.
    pub(super) fn new(frame: &Frame<'_>) -> Option<Self> {
        let (white, black) = (frame.number("white")?, frame.number("black")?);
        let mut lines = Vec::new();
        for axis in [0, 1] {
            for states in [[white, black], [black, white]] {
                lines.extend(frame.lines(axis).map(|width| (axis, states, 0.5 * width)));
            }
        }
        let text = frame
            .pitch_mm
            .and_then(|pitch| patterns::bitmap(&frame.setup.scene, &frame.patterns.text, pitch));
        let strokes = text.as_ref().map_or_else(Vec::new, |bitmap| bitmap.middles().strokes);
        // Each is an image, whose spectra paths carry: of large text every few are enough.
        let step = strokes.len().div_ceil(MOST_STROKES).max(1);
        let strokes = strokes.into_iter().step_by(step).collect();
        let pitch_mm = frame.pitch_mm.unwrap_or([1.0; 2]);
        Some(Self { white, black, pitch_mm, lines, text, strokes })
    }

    /// Y of the white and the black page and of the finest pattern.
    fn pages(&self, y: &[f64]) -> [f64; 3] {
        let first = self.lines.len() + self.strokes.len();
        [y[first], y[first + 1], y[first + 2]]
    }

    /// Contrast of lines, from Y of the images; `faces` is added to each.
    pub(super) fn line_contrast(&self, y: &[f64], faces: f64) -> LineContrast {
        let [white, black, _] = self.pages(y);
        let mut contrast = LineContrast::default();
        for (slot, ((_, [_, surround], _), middle)) in contrast.all_mut().zip(self.lines.iter().zip(y)) {
            let far = if *surround == self.white { white } else { black };
            *slot = Some(((middle - far) / (middle + far + 2.0 * faces)).abs());
        }
        contrast
    }

    /// Smallest and median contrast of strokes.
    pub(super) fn text_contrast(&self, y: &[f64], faces: f64) -> Option<[f64; 2]> {
        let [page, ..] = self.pages(y);
        let strokes = &y[self.lines.len()..][..self.strokes.len()];
        let mut all: Vec<f64> =
            strokes.iter().map(|stroke| (page - stroke) / (page + stroke + 2.0 * faces)).collect();
        all.sort_by(f64::total_cmp);
        Some([*all.first()?, all[all.len() / 2]])
    }

    /// Exponent of Yule and Nielsen of the finest pattern.
    pub(super) fn yule_nielsen(&self, y: &[f64]) -> Option<f64> {
        let [white, black, mean] = self.pages(y);
        patterns::yule_nielsen([white, black], mean)
    }

    /// The state that an image of text shows at a place relative to the middle of a stroke.
    fn of_text(&self, bitmap: &Bitmap, middle: usize, place_mm: [f64; 2]) -> usize {
        let [columns, rows] = bitmap.count.map(|count| count as i64);
        let from = [middle as i64 % columns, middle as i64 / columns];
        let [x, y] = [0, 1].map(|k| from[k] + (place_mm[k] / self.pitch_mm[k] + 0.5).floor() as i64);
        let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
        if inside && bitmap.black[(y * columns + x) as usize] { self.black } else { self.white }
    }
}

impl Pattern for Fixed {
    fn images(&self) -> usize {
        self.lines.len() + self.strokes.len() + 3
    }

    fn period_mm(&self) -> [f64; 2] {
        [0.0; 2]
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        for (image, (axis, [line, surround], half)) in self.lines.iter().enumerate() {
            covered(image, if place_mm[*axis].abs() < *half { *line } else { *surround }, 1.0);
        }
        let mut next = self.lines.len();
        if let Some(bitmap) = &self.text {
            for middle in &self.strokes {
                covered(next, self.of_text(bitmap, *middle, place_mm), 1.0);
                next += 1;
            }
        }
        covered(next, self.white, 1.0);
        covered(next + 1, self.black, 1.0);
        covered(next + 2, self.white, 0.5);
        covered(next + 2, self.black, 0.5);
    }
}
