//! Paragraphs of text, broken into lines that fit a rectangle of pixels.
//!
//! Lines are broken at spaces, as late as possible, and words that are wider than a line anywhere; the right
//! edge is ragged. `\n` begins a paragraph, whose first line is indented by an em where it follows another
//! one. Base lines are 1.35 em apart.

use skrifa::instance::{LocationRef, Size};
use skrifa::{GlyphId, MetadataProvider};

use super::Font;
use super::area::Areas;
use super::font::checked;
use crate::ImagingError;

/// Distance of base lines over the em.
const LEADING: f64 = 1.35;

/// Text in a rectangle of pixels.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// Fraction of each pixel that the outlines cover, row by row from the top.
    pub coverage: Vec<f32>,
    /// Number of lines of the whole text.
    pub lines: usize,
    /// Number of lines, the last ones, that do not fit.
    pub left_out: usize,
}

/// A character with its glyph and advance, in units of the font.
type Letter = (char, GlyphId, f64);

/// A line with its indentation, in units of the font.
struct Line<'a> {
    letters: &'a [Letter],
    indent: f64,
}

impl Font {
    /// Sets paragraphs of `size_pt` points of 1/72 inch in a rectangle of `count` = columns and rows with
    /// `per_inch` pixels in an inch along x and y. Text begins at the left and upper edge.
    ///
    /// # Errors
    /// [`ImagingError`]: a character without a glyph, a size or resolution that is not above 0, or too many pixels.
    pub fn block(
        &self,
        text: &str,
        size_pt: f64,
        per_inch: [f64; 2],
        count: [usize; 2],
    ) -> Result<Block, ImagingError> {
        checked(size_pt, per_inch, count.map(|count| count as f64))?;
        let font = self.reader()?;
        let metrics = font.metrics(Size::unscaled(), LocationRef::default());
        let em = f64::from(metrics.units_per_em);
        let per_unit = per_inch.map(|pixels| size_pt / 72.0 * pixels / em);
        let width = count[0] as f64 / per_unit[0];
        let paragraphs: Vec<Vec<Letter>> = text
            .lines()
            .map(|paragraph| {
                let letters = self.letters(&font, paragraph)?.into_iter();
                Ok(paragraph
                    .chars()
                    .zip(letters)
                    .map(|(one, (glyph, advance))| (one, glyph, advance))
                    .collect())
            })
            .collect::<Result<_, ImagingError>>()?;
        let mut lines = Vec::new();
        let mut follows = false;
        for paragraph in &paragraphs {
            let indent = if follows { em.min(0.5 * width) } else { 0.0 };
            wrap(paragraph, width, indent, &mut lines);
            follows = !paragraph.is_empty();
        }
        let [ascent, descent] = [metrics.ascent, -metrics.descent].map(|part| f64::from(part) * per_unit[1]);
        let leading = LEADING * em * per_unit[1];
        let room = (count[1] as f64 - ascent - descent) / leading;
        let shown = if room < 0.0 { 0 } else { lines.len().min(room as usize + 1) };
        let mut areas = Areas::new(count);
        for (at, line) in lines.iter().take(shown).enumerate() {
            let glyphs = line.letters.iter().map(|(_, glyph, advance)| (*glyph, *advance));
            let origin = [line.indent * per_unit[0], count[1] as f64 - ascent - at as f64 * leading];
            Self::draw(&font, glyphs, origin, per_unit, &mut areas)?;
        }
        let upwards = areas.coverage();
        let rows = upwards.chunks_exact(count[0].max(1)).rev();
        let coverage = rows.flatten().map(|covered| *covered as f32).collect();
        Ok(Block { coverage, lines: lines.len(), left_out: lines.len() - shown })
    }
}

/// Breaks a paragraph into lines; one without letters is an empty line.
fn wrap<'a>(letters: &'a [Letter], width: f64, indent: f64, lines: &mut Vec<Line<'a>>) {
    let (mut start, mut indent) = (0, indent);
    loop {
        let (mut sum, mut space) = (indent, None);
        let mut end = letters.len();
        for (at, (letter, _, advance)) in letters.iter().enumerate().skip(start) {
            if *letter == ' ' {
                space = Some(at);
            }
            sum += advance;
            // A space may hang over the edge; a line has one letter at least.
            if sum > width && *letter != ' ' && at > start {
                end = space.filter(|space| *space > start).unwrap_or(at);
                break;
            }
        }
        lines.push(Line { letters: &letters[start..end], indent });
        indent = 0.0;
        start = end + letters[end..].iter().take_while(|(letter, ..)| *letter == ' ').count();
        if start >= letters.len() {
            break;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PER_INCH: [f64; 2] = [150.0; 2];

    fn block(text: &str, count: [usize; 2]) -> Block {
        Font::bundled().block(text, 10.0, PER_INCH, count).unwrap()
    }

    /// Sum of the coverage of the rows of each line: base lines are 1.35 em apart.
    fn ink(block: &Block, columns: usize) -> Vec<f32> {
        let leading = (10.0 / 72.0 * 150.0 * 1.35) as usize;
        block.coverage.chunks(columns * leading).map(|rows| rows.iter().sum()).collect()
    }

    #[test]
    fn lines_are_broken_at_spaces_and_keep_all_letters() {
        let text = "the quick brown fox jumps over the lazy dog";
        let wide = block(text, [1000, 60]);
        let narrow = block(text, [120, 300]);
        assert_eq!((wide.lines, wide.left_out, narrow.left_out), (1, 0, 0));
        assert!((4..8).contains(&narrow.lines), "{}", narrow.lines);
        let sum = |block: &Block| block.coverage.iter().sum::<f32>();
        assert!((sum(&wide) - sum(&narrow)).abs() < 0.02 * sum(&wide), "no letter is cut at an edge");
        assert!(narrow.coverage.iter().all(|covered| (0.0..=1.0).contains(covered)));
        // The first line is at the top.
        let lines = ink(&narrow, 120);
        assert!(lines[0] > 50.0 && lines[lines.len() - 1] == 0.0, "{lines:?}");
    }

    #[test]
    fn long_words_are_broken_and_lines_that_do_not_fit_are_counted() {
        let found = block(&"m".repeat(40), [100, 60]);
        assert!(found.lines > 5 && found.left_out == found.lines - 2, "{} {}", found.lines, found.left_out);
        let none = block("a", [100, 10]);
        assert_eq!((none.lines, none.left_out), (1, 1));
        assert!(none.coverage.iter().all(|covered| *covered == 0.0));
        let narrow = block("ab c", [1, 400]);
        assert_eq!((narrow.lines, narrow.left_out), (3, 0));
    }

    /// A second paragraph is indented by an em, after an empty line it is not.
    #[test]
    fn paragraphs_begin_with_an_indentation() {
        let first = |text: &str, line: usize| {
            let found = block(text, [200, 200]);
            let em = 10.0 / 72.0 * 150.0;
            let top = (line as f64 * 1.35 * em) as usize;
            let row =
                |row: usize| found.coverage[row * 200..][..200].iter().position(|covered| *covered > 0.5);
            (top..top + 20).filter_map(row).min().unwrap()
        };
        let indent = first("l\nl", 1) - first("l\nl", 0);
        assert!((20..=21).contains(&indent), "{indent}");
        assert_eq!(first("l\n\nl", 2), first("l\nl", 0));
    }

    #[test]
    fn impossible_blocks_are_refused() {
        let font = Font::bundled();
        assert_eq!(font.block("\u{4e00}", 10.0, PER_INCH, [9, 9]), Err(ImagingError::Glyph('\u{4e00}')));
        assert!(matches!(font.block("a", 0.0, PER_INCH, [9, 9]), Err(ImagingError::Range { .. })));
        assert!(matches!(font.block("a", 1.0, PER_INCH, [1 << 20; 2]), Err(ImagingError::TooLarge { .. })));
        assert_eq!(font.block("", 10.0, PER_INCH, [9, 9]).unwrap().lines, 0);
    }
}
