//! The picture of `[image]` on the pixels of the panel: a file, a page of text, or a test pattern.

use std::sync::{Arc, Mutex, PoisonError};

use papilio_colour::D65_WHITE;
use papilio_diagnostics::Diagnostic;
use papilio_display::image::SourceImage;
use papilio_display::readability::DEFAULT_TEXT_HEIGHT_MM;
use papilio_display::scene::Scene;
use papilio_formats::{
    DataFile, FormatError, LARGEST_PICTURE_FILE, MOST_PICTURE_PIXELS, RgbSpace, SourcePicture, Warned,
    read_picture,
};
use papilio_imaging::text::{Font, X_HEIGHT};
use papilio_imaging::{Fit, TestPattern, fitted};

use super::Resolver;
use crate::describe::File;
use crate::describe::image::{Image, SourceSpace};
use crate::library::{MemoryFile, sha256};
use crate::mistake;
use crate::origin::Origin;

/// Margin of a page over its width.
const MARGIN: f64 = 0.06;

/// Largest part of the page for a photograph, along its longer side.
const PHOTOGRAPH: f64 = 0.5;

/// Space between a photograph and text, in ems.
const GAP: f64 = 1.2;

/// Largest number of spokes of a star.
const MOST_SPOKES: f64 = 3600.0;

/// Millimetres in a point.
const POINT_MM: f64 = 25.4 / 72.0;

/// Largest number of pixels of a picture that is kept after it was read.
const MOST_KEPT_PIXELS: usize = 1 << 24;

/// The picture that was read last in this process: the designs of a study show the same one.
static LAST: Mutex<Option<Arc<FilePicture>>> = Mutex::new(None);

/// A picture that was read from a file.
pub(super) struct FilePicture {
    /// SHA-256 of the file.
    sha256: String,
    space: SourceSpace,
    picture: SourcePicture,
    warnings: Vec<String>,
    /// The last number of pixels that was requested, and the picture on them if it was requested again: it takes as much memory as the result.
    fitted: Mutex<Option<FittedPicture>>,
}

struct FittedPicture {
    to: [usize; 2],
    fit: Fit,
    pixels: Option<Vec<[f32; 3]>>,
}

impl FilePicture {
    /// Reads a picture, unless it is the last one that was read.
    fn read(file: &MemoryFile, space: SourceSpace) -> Result<Arc<Self>, FormatError> {
        let last = || LAST.lock().unwrap_or_else(PoisonError::into_inner);
        let is_it = |last: &&Arc<Self>| last.space == space && last.sha256 == file.sha256();
        if let Some(last) = last().as_ref().filter(is_it) {
            return Ok(Arc::clone(last));
        }
        let rgb = match space {
            SourceSpace::Srgb => RgbSpace::srgb(),
            SourceSpace::DisplayP3 => RgbSpace::display_p3(),
            SourceSpace::Rec2020 => RgbSpace::rec_2020(),
        };
        let Warned { value: picture, warnings } = read_picture(file.file(), &rgb)?;
        let is_kept = picture.columns() * picture.rows() <= MOST_KEPT_PIXELS;
        let sha256 = file.sha256().to_owned();
        let read = Arc::new(Self { sha256, space, picture, warnings, fitted: Mutex::new(None) });
        *last() = is_kept.then(|| Arc::clone(&read));
        Ok(read)
    }

    fn fitted(&self, to: [usize; 2], fit: Fit) -> Vec<[f32; 3]> {
        let mut kept = self.fitted.lock().unwrap_or_else(PoisonError::into_inner);
        let last = kept.as_ref().filter(|kept| (kept.to, kept.fit) == (to, fit));
        if let Some(pixels) = last.and_then(|kept| kept.pixels.as_ref()) {
            return pixels.clone();
        }
        let is_again = last.is_some();
        let size = [self.picture.columns(), self.picture.rows()];
        let pixels = fitted(size, |row| self.picture.row(row), to, fit, white());
        let is_kept = is_again && pixels.len() <= MOST_KEPT_PIXELS;
        *kept = Some(FittedPicture { to, fit, pixels: is_kept.then(|| pixels.clone()) });
        pixels
    }
}

/// Number of columns and rows of a picture in a file. It is kept, so that a scenario with it does not read it again.
///
/// # Errors
/// As [`read_picture`].
pub fn picture_size(file: DataFile) -> Result<[usize; 2], FormatError> {
    let read = FilePicture::read(&MemoryFile::new(file), SourceSpace::Srgb)?;
    Ok([read.picture.columns(), read.picture.rows()])
}

/// A picture before it is fitted to the panel.
pub(super) enum Photograph<'a> {
    File(Arc<FilePicture>),
    /// X, Y, Z of a picture in memory.
    Given(&'a SourceImage),
}

impl Photograph<'_> {
    fn size(&self) -> [usize; 2] {
        match self {
            Self::File(file) => [file.picture.columns(), file.picture.rows()],
            Self::Given(picture) => [picture.columns, picture.pixels.len() / picture.columns.max(1)],
        }
    }

    fn fitted(&self, to: [usize; 2], fit: Fit) -> Vec<[f32; 3]> {
        match self {
            Self::File(file) => file.fitted(to, fit),
            Self::Given(picture) => {
                let row = |row: usize| picture.pixels[row * picture.columns..][..picture.columns].to_vec();
                fitted(self.size(), row, to, fit, white())
            }
        }
    }
}

fn white() -> [f32; 3] {
    D65_WHITE.to_array().map(|value| value as f32)
}

/// Number and size of the pixels of the panel.
struct Pixels {
    count: [usize; 2],
    pitch_mm: [f64; 2],
}

/// A rectangle of pixels, from the upper left corner of the panel.
#[derive(Clone, Copy)]
struct Area {
    at: [usize; 2],
    count: [usize; 2],
}

impl Resolver<'_> {
    /// The picture on the pixels of the panel; `given` is used instead of a file.
    pub(super) fn picture(
        &mut self,
        image: &Image,
        file: &File,
        scene: &Scene,
        given: Option<&SourceImage>,
    ) -> Option<SourceImage> {
        let matrix = scene.display.matrix.as_ref();
        let pixels =
            matrix.and_then(|matrix| Some(Pixels { count: matrix.pixels?, pitch_mm: matrix.pitch_mm }));
        let key = file.display.matrix.value.as_ref().map(|matrix| matrix.pixels.origin);
        let fits = |resolver: &mut Self, count: [usize; 2], at: Origin| {
            let all = count[0].saturating_mul(count[1]);
            if all > MOST_PICTURE_PIXELS {
                let wrong = mistake::too_many("pixels of a picture", all as f64, MOST_PICTURE_PIXELS);
                resolver.errors.push(key.unwrap_or(at), wrong);
            }
            all <= MOST_PICTURE_PIXELS
        };
        if let Some(pattern) = image.pattern.value {
            let at = image.pattern.origin;
            if image.file.value.is_some() || image.text.value.is_some() || given.is_some() {
                let other = if image.text.value.is_some() { "a text" } else { "a picture" };
                let wrong = Diagnostic::new(format!("there are a test pattern and {other}"));
                let wrong =
                    wrong.expected("one of `pattern`, `file` and `text`; `file` and `text` are a page");
                self.errors.push(at, wrong.hint("remove `pattern` or the other keys"));
                return None;
            }
            let pixels = self.needed(pixels, at, "a test pattern")?;
            return if fits(self, pixels.count, at) { self.pattern(image, pattern.0, &pixels) } else { None };
        }
        let photograph = match (given, &image.file.value) {
            (Some(given), _) => {
                let values: Vec<u8> =
                    given.pixels.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
                self.inputs.insert("picture in memory".to_owned(), sha256(&values));
                Some(Photograph::Given(given))
            }
            (None, Some(name)) => Some(Photograph::File(self.photograph(image, name)?)),
            (None, None) => None,
        };
        match (&image.text.value, photograph) {
            (Some(text), photograph) => {
                let pixels = self.needed(pixels, image.text.origin, "a page of text")?;
                if !fits(self, pixels.count, image.text.origin) {
                    return None;
                }
                let height_mm = scene.metrics.text_height_mm.unwrap_or(DEFAULT_TEXT_HEIGHT_MM);
                let default = height_mm / X_HEIGHT / POINT_MM;
                let size_pt = image.text_size_pt.value.as_ref().map_or(default, |size| size.0);
                self.page(image.text.origin, text, size_pt, &pixels, photograph.as_ref())
            }
            (None, Some(photograph)) => {
                let to = pixels.map_or(photograph.size(), |pixels| pixels.count);
                if !fits(self, to, image.file.origin) {
                    return None;
                }
                Some(SourceImage { columns: to[0], pixels: photograph.fitted(to, image.fit.0) })
            }
            (None, None) => {
                let mut wrong = mistake::missing_key(
                    "file",
                    "a picture, PNG, JPEG, SVG, OpenEXR or Radiance; or a `text` or `pattern`",
                );
                wrong.diagnostic = wrong
                    .diagnostic
                    .hint("papilio image SCENARIO PICTURE, or file = \"picture.png\" in [image]");
                self.errors.push(file.image.origin, wrong);
                None
            }
        }
    }

    /// Number of columns and rows of the picture before it is fitted; `None` for texts, pages and test patterns.
    pub(super) fn size_of_picture(
        &mut self,
        image: &Image,
        given: Option<&SourceImage>,
    ) -> Option<[usize; 2]> {
        if image.text.value.is_some() || image.pattern.value.is_some() {
            return None;
        }
        match (given, &image.file.value) {
            (Some(given), _) => Some(Photograph::Given(given).size()),
            (None, Some(name)) => {
                // It was read before, with its warnings.
                let known = self.warnings.len();
                let photograph = self.photograph(image, name);
                self.warnings.truncate(known);
                Some(Photograph::File(photograph?).size())
            }
            (None, None) => None,
        }
    }

    /// The pixels of the panel, which a text or pattern needs.
    fn needed(&mut self, pixels: Option<Pixels>, at: Origin, what: &str) -> Option<Pixels> {
        if pixels.is_none() {
            let wrong = Diagnostic::new(format!(
                "{what} needs the number and size of the pixels of the panel, `display.matrix.pixels` and `ppi`"
            ));
            let hint = "for example [display.matrix] with ppi = 300 and pixels = [1264, 1680]";
            self.errors.push(at, wrong.hint(hint));
        }
        pixels
    }

    fn photograph(&mut self, image: &Image, name: &str) -> Option<Arc<FilePicture>> {
        let origin = image.file.origin;
        let opened = self.open_within(name, origin, LARGEST_PICTURE_FILE)?;
        match FilePicture::read(&opened, image.source_space.value) {
            Ok(picture) => {
                self.warnings.extend(picture.warnings.iter().map(|warning| format!("{name}: {warning}")));
                Some(picture)
            }
            Err(error) => {
                self.errors.push_data(origin, error);
                None
            }
        }
    }

    fn pattern(&mut self, image: &Image, pattern: TestPattern, pixels: &Pixels) -> Option<SourceImage> {
        let Pixels { count, pitch_mm } = *pixels;
        let period = image.period_mm.value.as_ref().map(|period| period.0);
        let at = image.period_mm.origin;
        match (pattern, period) {
            (TestPattern::SlantedEdge, Some(_)) => {
                let wrong = Diagnostic::new("a slanted edge has no period");
                self.errors.push(at, wrong.hint("remove `period_mm`, or use pattern = \"stripes\""));
                return None;
            }
            (TestPattern::Siemens, Some(period))
                if TestPattern::spokes(count, pitch_mm, period) > MOST_SPOKES =>
            {
                let wrong =
                    mistake::out_of_range(period, format!("a period with at most {MOST_SPOKES} spokes"));
                self.errors.push(at, wrong);
                return None;
            }
            _ => {}
        }
        if let Some(period) = period {
            self.warnings.extend(hidden_pattern(pattern, period, count, pitch_mm));
        }
        let period = period.unwrap_or_else(|| pattern.usual_period_mm(count, pitch_mm));
        let black = pattern.black(count, pitch_mm, period);
        let mut pixels = vec![white(); black.len()];
        darken(&mut pixels, &black);
        Some(SourceImage { columns: count[0], pixels })
    }

    /// A page of text, with a photograph above it, or on its left where the panel is wide.
    fn page(
        &mut self,
        at: Origin,
        text: &str,
        size_pt: f64,
        pixels: &Pixels,
        photograph: Option<&Photograph<'_>>,
    ) -> Option<SourceImage> {
        let Pixels { count, pitch_mm } = *pixels;
        if text.trim().is_empty() {
            self.warnings.push("image.text has no letters: its part of the page is white".to_owned());
        }
        let lines: String = text.lines().collect();
        let missing: Vec<char> = Font::bundled().missing(&lines);
        if !missing.is_empty() {
            self.errors.push(at, mistake::no_glyphs(&missing));
            return None;
        }
        let margin_mm = MARGIN * count[0] as f64 * pitch_mm[0];
        let margin = [0, 1].map(|k| ((margin_mm / pitch_mm[k]).round() as usize).min((count[k] - 1) / 2));
        let inner = Area { at: margin, count: [0, 1].map(|k| count[k] - 2 * margin[k]) };
        let mut page = vec![white(); count[0] * count[1]];
        let mut block = inner;
        if let Some(photograph) = photograph {
            let size_mm = [0, 1].map(|k| count[k] as f64 * pitch_mm[k]);
            let along = usize::from(size_mm[0] <= size_mm[1]);
            let placed = beside(inner, photograph.size(), pitch_mm, along);
            paste(&mut page, count[0], placed, &photograph.fitted(placed.count, Fit::Stretch));
            let used = (placed.count[along] + (GAP * size_pt * POINT_MM / pitch_mm[along]).round() as usize)
                .min(inner.count[along]);
            block.at[along] += used;
            block.count[along] -= used;
        }
        if block.count.contains(&0) {
            return Some(SourceImage { columns: count[0], pixels: page });
        }
        let per_inch = pitch_mm.map(|pitch| 25.4 / pitch);
        let set = match Font::bundled().block(text, size_pt, per_inch, block.count) {
            Ok(set) => set,
            Err(error) => {
                self.errors.push(at, Diagnostic::new(error.to_string()));
                return None;
            }
        };
        if set.left_out > 0 {
            self.warnings.push(format!(
                "image.text: {} of {} lines do not fit below each other on the panel and are left out (a smaller image.text_size_pt than {size_pt:.1} \
                 has more lines)",
                set.left_out, set.lines
            ));
        }
        for (y, row) in set.coverage.chunks_exact(block.count[0]).enumerate() {
            darken(&mut page[(block.at[1] + y) * count[0] + block.at[0]..][..block.count[0]], row);
        }
        Some(SourceImage { columns: count[0], pixels: page })
    }
}

/// Why stripes, squares or spokes of this period are not seen on the panel; `None` if they are.
fn hidden_pattern(
    pattern: TestPattern,
    period_mm: f64,
    count: [usize; 2],
    pitch_mm: [f64; 2],
) -> Option<String> {
    // Stripes repeat along x only.
    let axes = if pattern == TestPattern::Stripes { 0..1 } else { 0..2 };
    let pitch = axes.clone().map(|k| pitch_mm[k]).fold(0.0, f64::max);
    let size = axes.map(|k| count[k] as f64 * pitch_mm[k]).fold(0.0, f64::max);
    let shown = format!("image.period_mm = {period_mm}");
    let rounded = |mm: f64| (1e6 * mm).round() / 1e6;
    if period_mm < 2.0 * pitch * (1.0 - 1e-9) {
        let place = if pattern == TestPattern::Siemens { " of the star at its rim" } else { "" };
        Some(format!(
            "{shown} is below two pixels ({} mm): the pixels cannot show the period{place}, and have the mean of black and white or beats",
            rounded(2.0 * pitch)
        ))
    } else if pattern != TestPattern::Siemens && period_mm >= 2.0 * size {
        Some(format!("half of {shown} is wider than the panel ({} mm): all of it is black", rounded(size)))
    } else {
        None
    }
}

/// Place of a photograph at the beginning of an area along an axis, as wide as the area across it, or as long
/// as is permitted.
fn beside(area: Area, size: [usize; 2], pitch_mm: [f64; 2], along: usize) -> Area {
    let across = 1 - along;
    let room = [0, 1].map(|k| area.count[k] as f64 * pitch_mm[k]);
    let scale = (room[across] / size[across] as f64).min(PHOTOGRAPH * room[along] / size[along] as f64);
    let count =
        [0, 1].map(|k| ((scale * size[k] as f64 / pitch_mm[k]).round() as usize).clamp(1, area.count[k]));
    let mut at = area.at;
    if along == 1 {
        at[0] += (area.count[0] - count[0]) / 2;
    }
    Area { at, count }
}

fn paste(page: &mut [[f32; 3]], columns: usize, area: Area, pixels: &[[f32; 3]]) {
    for (y, row) in pixels.chunks_exact(area.count[0]).enumerate() {
        page[(area.at[1] + y) * columns + area.at[0]..][..area.count[0]].copy_from_slice(row);
    }
}

/// Covers pixels by fractions of black.
fn darken(pixels: &mut [[f32; 3]], black: &[f32]) {
    for (pixel, black) in pixels.iter_mut().zip(black) {
        *pixel = pixel.map(|value| value * (1.0 - black));
    }
}
