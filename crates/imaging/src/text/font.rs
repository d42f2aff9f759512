//! Outlines of a font.

use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use super::Bitmap;
use super::area::Areas;
use crate::ImagingError;

/// File of the font Roboto Regular: Latin, Greek and Cyrillic letters (Apache License 2.0).
pub const ROBOTO: &[u8] = include_bytes!("../../fonts/Roboto-Regular.ttf");

/// File of the font Roboto Bold, with the same letters (Apache License 2.0).
pub const ROBOTO_BOLD: &[u8] = include_bytes!("../../fonts/Roboto-Bold.ttf");

/// Largest number of pixels of a text.
const MOST_PIXELS: f64 = 1e8;

/// How text is set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Size of the em in points of 1/72 inch.
    pub size_pt: f64,
    /// Number of pixels in an inch, along x and y.
    pub per_inch: [f64; 2],
    /// Number of white pixels around the text.
    pub margin: usize,
}

/// A font of outlines (TrueType or OpenType).
#[derive(Debug, Clone)]
pub struct Font {
    bytes: std::borrow::Cow<'static, [u8]>,
}

impl Font {
    /// Returns the bundled font: Roboto Regular, with Latin, Greek and Cyrillic letters.
    pub fn bundled() -> Self {
        Self { bytes: ROBOTO.into() }
    }

    /// Returns the font of a file, the first one of a collection.
    ///
    /// # Errors
    /// [`ImagingError::Font`] if the bytes are not a font.
    pub fn new(bytes: Vec<u8>) -> Result<Self, ImagingError> {
        let font = Self { bytes: bytes.into() };
        font.reader().map(|_| ()).map(|()| font)
    }

    pub(super) fn reader(&self) -> Result<FontRef<'_>, ImagingError> {
        FontRef::from_index(&self.bytes, 0).map_err(|error| ImagingError::Font(error.to_string()))
    }

    /// Returns the pixels of a text, black where at least half of their area is covered. `\n` begins a new
    /// line.
    ///
    /// # Errors
    /// [`ImagingError`]: a character without a glyph, a size or resolution that is not above 0, or too many pixels.
    pub fn bitmap(&self, text: &str, setting: Setting) -> Result<Bitmap, ImagingError> {
        let (count, coverage) = self.coverage(text, setting)?;
        let black = coverage.into_iter().map(|covered| covered >= 0.5).collect();
        let em = setting.per_inch.map(|pixels| (setting.size_pt / 72.0 * pixels).ceil() as usize);
        Ok(Bitmap { count, black, em })
    }

    /// Returns the fraction of each pixel that the outlines cover, row by row from the bottom, and the number
    /// of columns and rows.
    ///
    /// The base line of the lowest line is the lower edge of a row of pixels; text begins at the left edge of
    /// a column.
    ///
    /// # Errors
    /// As [`Self::bitmap`].
    pub fn coverage(&self, text: &str, setting: Setting) -> Result<([usize; 2], Vec<f64>), ImagingError> {
        checked(setting.size_pt, setting.per_inch, [1.0; 2])?;
        let font = self.reader()?;
        let metrics = font.metrics(Size::unscaled(), LocationRef::default());
        let per_unit =
            setting.per_inch.map(|pixels| setting.size_pt / 72.0 * pixels / f64::from(metrics.units_per_em));
        let height = f64::from(metrics.ascent - metrics.descent + metrics.leading);
        let below = (f64::from(-metrics.descent) * per_unit[1]).ceil();
        let lines: Vec<Vec<_>> =
            text.lines().map(|line| self.letters(&font, line)).collect::<Result<_, _>>()?;
        let width = |line: &Vec<(_, f64)>| line.iter().map(|(_, advance)| advance).sum::<f64>();
        let widest = lines.iter().map(width).fold(0.0, f64::max);
        let margin = setting.margin as f64;
        let above = height * lines.len().saturating_sub(1) as f64 + f64::from(metrics.ascent);
        let size = [(widest * per_unit[0]).ceil(), (above * per_unit[1]).ceil() + below];
        let size = size.map(|size| (size + 2.0 * margin).max(1.0));
        checked(setting.size_pt, setting.per_inch, size)?;
        let count = size.map(|size| size as usize);
        let mut areas = Areas::new(count);
        for (above, line) in lines.iter().rev().enumerate() {
            let origin = [margin, margin + below + above as f64 * height * per_unit[1]];
            Self::draw(&font, line.iter().copied(), origin, per_unit, &mut areas)?;
        }
        Ok((count, areas.coverage()))
    }

    /// Returns the characters of a text for which the font has no glyph, each once, in their order; spaces and control characters do not count.
    pub fn missing(&self, text: &str) -> Vec<char> {
        let Ok(font) = self.reader() else { return Vec::new() };
        let charmap = font.charmap();
        let mut missing = Vec::new();
        for one in text.chars().filter(|one| !one.is_whitespace() && !one.is_control()) {
            if charmap.map(one).is_none() && !missing.contains(&one) {
                missing.push(one);
            }
        }
        missing
    }

    /// Adds the outlines of glyphs, one after the other at their advances, to the areas.
    pub(super) fn draw(
        font: &FontRef<'_>,
        glyphs: impl Iterator<Item = (GlyphId, f64)>,
        mut origin: [f64; 2],
        per_unit: [f64; 2],
        areas: &mut Areas,
    ) -> Result<(), ImagingError> {
        let outlines = font.outline_glyphs();
        for (glyph, advance) in glyphs {
            let mut pen = Pen { areas: &mut *areas, origin, per_unit };
            if let Some(outline) = outlines.get(glyph) {
                let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
                outline.draw(settings, &mut pen).map_err(|error| ImagingError::Font(error.to_string()))?;
            }
            origin[0] += advance * per_unit[0];
        }
        Ok(())
    }

    /// Glyphs of a line with their advances, in units of the font.
    pub(super) fn letters(
        &self,
        font: &FontRef<'_>,
        line: &str,
    ) -> Result<Vec<(GlyphId, f64)>, ImagingError> {
        let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
        let charmap = font.charmap();
        let glyph = |character: char| {
            let glyph = charmap.map(character).ok_or(ImagingError::Glyph(character))?;
            Ok((glyph, f64::from(metrics.advance_width(glyph).unwrap_or(0.0))))
        };
        line.chars().map(glyph).collect()
    }
}

/// Fails unless a text has a size and a resolution, and fits into memory.
pub(super) fn checked(size_pt: f64, per_inch: [f64; 2], count: [f64; 2]) -> Result<(), ImagingError> {
    let [x, y] = per_inch;
    for (what, value) in [("size_pt", size_pt), ("ppi", x), ("ppi", y)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(ImagingError::Range { what, value });
        }
    }
    let pixels = count[0] * count[1];
    if pixels > MOST_PIXELS { Err(ImagingError::TooLarge { pixels, most: MOST_PIXELS }) } else { Ok(()) }
}

/// Moves outlines from units of the font to pixels.
struct Pen<'a> {
    areas: &'a mut Areas,
    origin: [f64; 2],
    per_unit: [f64; 2],
}

impl Pen<'_> {
    fn place(&self, x: f32, y: f32) -> [f64; 2] {
        let at = [f64::from(x), f64::from(y)];
        [0, 1].map(|k| self.origin[k] + at[k] * self.per_unit[k])
    }
}

impl OutlinePen for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        self.areas.move_to(self.place(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.areas.line_to(self.place(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.areas.quadratic_to(self.place(cx, cy), self.place(x, y));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.areas.cubic_to([self.place(ax, ay), self.place(bx, by)], self.place(x, y));
    }

    fn close(&mut self) {
        self.areas.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTING: Setting = Setting { size_pt: 10.0, per_inch: [300.0, 300.0], margin: 5 };

    /// The lower-case l of Roboto is a rectangle of 186 by 1536 units of 2048 in an em: 3.78 by 31.25 pixels.
    #[test]
    fn stem_is_rectangle_of_known_size() {
        let (count, coverage) = Font::bundled().coverage("l", SETTING).unwrap();
        let em = 10.0 / 72.0 * 300.0;
        let (width, height) = (em * 186.0 / 2048.0, em * 0.75);
        let area: f64 = coverage.iter().sum();
        assert!((area - width * height).abs() < 1e-6 * area, "{area} {}", width * height);
        let row = &coverage[count[0] * (count[1] / 2)..][..count[0]];
        assert!((row.iter().sum::<f64>() - width).abs() < 1e-9);
    }

    #[test]
    fn text_is_as_wide_as_its_advances() {
        let font = Font::bundled();
        let [one, two] = ["o", "oo"].map(|text| font.coverage(text, SETTING).unwrap());
        let ink = |coverage: &[f64]| coverage.iter().sum::<f64>();
        assert!((ink(&two.1) - 2.0 * ink(&one.1)).abs() < 1e-2);
        assert_eq!(one.0[1], two.0[1]);
        // Twice the resolution along x alone: twice the ink.
        let wide = Setting { per_inch: [600.0, 300.0], ..SETTING };
        assert!((ink(&font.coverage("o", wide).unwrap().1) - 2.0 * ink(&one.1)).abs() < 2e-2);
        // Lines are above each other, the first on top.
        let lines = font.bitmap("l\n.", SETTING).unwrap();
        let black = |row: usize| (0..lines.count[0]).any(|column| lines.black[row * lines.count[0] + column]);
        let rows: Vec<usize> = (0..lines.count[1]).filter(|row| black(*row)).collect();
        assert!(rows.len() > 30 && rows[0] < 25 && rows[4] > rows[0] + 4, "{rows:?}");
    }

    #[test]
    fn impossible_texts_are_refused() {
        let font = Font::bundled();
        assert_eq!(font.bitmap("a\u{4e00}", SETTING), Err(ImagingError::Glyph('\u{4e00}')));
        for size_pt in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let setting = Setting { size_pt, ..SETTING };
            assert!(matches!(font.bitmap("a", setting), Err(ImagingError::Range { what: "size_pt", .. })));
        }
        let huge = Setting { size_pt: 1e9, ..SETTING };
        assert!(matches!(font.bitmap("a", huge), Err(ImagingError::TooLarge { .. })));
        assert!(matches!(Font::new(b"not a font".to_vec()), Err(ImagingError::Font(_))));
        // Nothing to draw is a white picture.
        assert!(font.bitmap("", SETTING).unwrap().black.iter().all(|black| !black));
    }
}
