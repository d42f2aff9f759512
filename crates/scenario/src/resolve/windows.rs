//! Rectangles of the sub-pixels of `[display.matrix]`: from a layout, from the scenario or from a file.

use papilio_diagnostics::{Diagnostic, Place};
use papilio_display::scene::{Rectangle, SubPixelWindow, Window, rows, stripes};
use papilio_formats::{NamedRectangle, read_windows};

use super::Resolver;
use super::film::no_sub_pixel;
use crate::describe::matrix::{Layout, Matrix};
use crate::describe::numbers::Fraction;
use crate::mistake::{self, tidy};
use crate::origin::Origin;
use crate::read::{Named, Spanned};

/// Largest difference between the area of a sub-pixel's rectangles and its area in the pixel.
const AREA_TOLERANCE: f64 = 1e-3;
/// Overlap of rectangles that is a rounding error.
const ROUNDING: f64 = 1e-9;
/// Largest number of rectangles.
const MOST_RECTANGLES: usize = 1024;

/// Sub-pixels of which windows are wanted.
pub(super) struct SubPixels {
    pub(super) names: Vec<String>,
    /// Fractions of the active area; `None`: those of the rectangles.
    pub(super) areas: Option<Vec<f64>>,
    pub(super) fill_factor: f64,
    /// The table of their names.
    pub(super) table: &'static str,
    /// Places of their areas.
    pub(super) causes: Vec<Origin>,
}

/// A rectangle, the number of its sub-pixel, and its place in the text.
struct SubPixelRectangle {
    sub_pixel: usize,
    rectangle: Rectangle,
    origin: Origin,
    /// Its place in a file of rectangles.
    file: Option<Place>,
}

impl SubPixels {
    fn number(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// Fraction of the active area of each sub-pixel; the same for all, if only rectangles could tell.
    fn areas(&self) -> Vec<f64> {
        let equal = || vec![1.0 / self.names.len() as f64; self.names.len()];
        self.areas.clone().unwrap_or_else(equal)
    }

    fn with_windows(&self, windows: Vec<Window>, areas: Option<&[f64]>) -> Vec<SubPixelWindow> {
        let windows = self.names.iter().zip(windows).enumerate();
        let placed = windows.map(|(i, (name, window))| SubPixelWindow {
            name: name.clone(),
            fraction: areas.map_or_else(|| window.area(), |areas| areas[i] * self.fill_factor),
            window,
        });
        placed.collect()
    }
}

impl Resolver<'_> {
    /// Resolves the rectangles of all sub-pixels.
    pub(super) fn windows(&mut self, matrix: &Matrix, sub_pixels: &SubPixels) -> Option<Vec<SubPixelWindow>> {
        let (subpixel, file) = (&matrix.subpixel, &matrix.subpixel_file);
        let given = [
            (matrix.layout.is_some(), matrix.layout.origin),
            (subpixel.is_some(), subpixel.origin),
            (file.is_some(), file.origin),
        ];
        let given: Vec<Origin> = given.into_iter().filter(|(given, _)| *given).map(|(_, at)| at).collect();
        if let [first, .., _] = given[..] {
            let keys = "`layout`, `subpixel` and `subpixel_file`";
            let wrong = Diagnostic::new(format!("more than one of {keys} is given"));
            let at = first.or_override(given.iter().copied());
            self.errors.push(at, wrong.expected(format!("at most one of {keys}")));
            return None;
        }
        let (placed, at) = match (&subpixel.value, &file.value) {
            (Some(named), _) => (self.rectangles(named, sub_pixels)?, subpixel.origin),
            (None, Some(name)) => (self.rectangles_of_file(name, file.origin, sub_pixels)?, file.origin),
            (None, None) => {
                let value = matrix.layout.value.unwrap_or(Layout::Stripe);
                let windows = self.arranged(&Spanned { value, origin: matrix.layout.origin }, sub_pixels)?;
                let areas = sub_pixels.areas();
                return Some(sub_pixels.with_windows(windows, Some(&areas)));
            }
        };
        self.check_rectangles(&placed, at)?;
        let mut windows = vec![Window::default(); sub_pixels.names.len()];
        placed.iter().for_each(|one| windows[one.sub_pixel].rectangles.push(one.rectangle));
        let first = |sub_pixel: usize| placed.iter().find(|one| one.sub_pixel == sub_pixel)?.file.clone();
        self.check_areas(&windows, sub_pixels, at, first)?;
        Some(sub_pixels.with_windows(windows, sub_pixels.areas.as_deref()))
    }

    /// Arranges the sub-pixels of a pixel.
    fn arranged(&mut self, layout: &Spanned<Layout>, sub_pixels: &SubPixels) -> Option<Vec<Window>> {
        let (areas, fill_factor) = (sub_pixels.areas(), sub_pixels.fill_factor);
        let count = areas.len();
        let cell = |i: usize| (i, areas[i]);
        let cells = match layout.value {
            Layout::Stripe => return Some(stripes(&areas, fill_factor)),
            Layout::Single if count == 1 => vec![vec![cell(0)]],
            Layout::Single => return self.refuse_layout(layout, sub_pixels, "a single sub-pixel"),
            Layout::Quad if count == 3 => vec![vec![cell(0), cell(1)], vec![cell(2)]],
            Layout::Quad if count == 4 => vec![vec![cell(0), cell(1)], vec![cell(2), cell(3)]],
            Layout::Quad => return self.refuse_layout(layout, sub_pixels, "three or four sub-pixels"),
            Layout::PenTile => match self.numbers(["red", "green", "blue"], sub_pixels) {
                Some([red, green, blue]) => {
                    let half = (green, 0.5 * areas[green]);
                    vec![vec![cell(red), half], vec![half, cell(blue)]]
                }
                None => return self.refuse_layout(layout, sub_pixels, "the sub-pixels red, green and blue"),
            },
            Layout::Rgbw => match self.numbers(["red", "green", "blue", "white"], sub_pixels) {
                Some([red, green, blue, white]) => {
                    vec![vec![cell(red), cell(green)], vec![cell(blue), cell(white)]]
                }
                None => {
                    let needs = "the sub-pixels red, green, blue and white";
                    return self.refuse_layout(layout, sub_pixels, needs);
                }
            },
        };
        Some(rows(&cells, count, fill_factor))
    }

    /// Returns the numbers of these sub-pixels, if the pixel has these and no others.
    fn numbers<const N: usize>(&self, names: [&str; N], sub_pixels: &SubPixels) -> Option<[usize; N]> {
        let found = names.map(|name| sub_pixels.number(name));
        if sub_pixels.names.len() != N || found.contains(&None) {
            return None;
        }
        Some(found.map(Option::unwrap_or_default))
    }

    fn refuse_layout<T>(
        &mut self,
        layout: &Spanned<Layout>,
        sub_pixels: &SubPixels,
        needs: &str,
    ) -> Option<T> {
        let wrong = Diagnostic::new(format!("this layout needs {needs}"))
            .note(format!(
                "the sub-pixels are {}: those of {}",
                sub_pixels.names.join(", "),
                sub_pixels.table
            ))
            .hint("choose another layout, or give the rectangles of each sub-pixel as `subpixel`");
        self.errors.push(layout.origin.or_override(sub_pixels.causes.iter().copied()), wrong);
        None
    }

    fn rectangles(
        &mut self,
        named: &Named<Vec<Spanned<Vec<Spanned<Fraction>>>>>,
        sub_pixels: &SubPixels,
    ) -> Option<Vec<SubPixelRectangle>> {
        let mut placed = Vec::new();
        let mut wrong = false;
        for item in &named.0 {
            let Some(sub_pixel) = sub_pixels.number(&item.name) else {
                self.errors.push(item.name_origin, unknown(&item.name, sub_pixels));
                wrong = true;
                continue;
            };
            for corners in &item.value.value {
                match self.rectangle(corners) {
                    Some(rectangle) => {
                        placed.push(SubPixelRectangle {
                            sub_pixel,
                            rectangle,
                            origin: corners.origin,
                            file: None,
                        });
                    }
                    None => wrong = true,
                }
            }
        }
        (!wrong).then_some(placed)
    }

    fn rectangle(&mut self, corners: &Spanned<Vec<Spanned<Fraction>>>) -> Option<Rectangle> {
        let [x0, y0, x1, y1] = corners.as_slice() else {
            self.err(corners, mistake::another_length("a list of four, [x0, y0, x1, y1]"));
            return None;
        };
        let rectangle = Rectangle { x: [x0.0, x1.0], y: [y0.0, y1.0] };
        if x0.0 >= x1.0 || y0.0 >= y1.0 {
            let wrong = Diagnostic::new("this rectangle has no area")
                .expected("[x0, y0, x1, y1] with x0 below x1, and y0 below y1");
            self.err(corners, wrong);
            return None;
        }
        Some(rectangle)
    }

    fn rectangles_of_file(
        &mut self,
        name: &str,
        origin: Origin,
        sub_pixels: &SubPixels,
    ) -> Option<Vec<SubPixelRectangle>> {
        let rows = self.data(name, origin, read_windows)?;
        let mut unknown_names: Vec<&str> = Vec::new();
        let mut placed = Vec::new();
        for NamedRectangle { name, corners: [x0, y0, x1, y1], place } in &rows {
            match sub_pixels.number(name) {
                Some(sub_pixel) => {
                    let rectangle = Rectangle { x: [*x0, *x1], y: [*y0, *y1] };
                    placed.push(SubPixelRectangle {
                        sub_pixel,
                        rectangle,
                        origin,
                        file: Some(place.clone()),
                    });
                }
                None if !unknown_names.contains(&name.as_str()) => {
                    unknown_names.push(name);
                    self.errors.push_in_file(origin, unknown(name, sub_pixels), Some(place.clone()));
                }
                None => {}
            }
        }
        unknown_names.is_empty().then_some(placed)
    }

    /// Refuses rectangles that overlap.
    fn check_rectangles(&mut self, placed: &[SubPixelRectangle], at: Origin) -> Option<()> {
        if placed.len() > MOST_RECTANGLES {
            self.errors.push(at, mistake::too_many("rectangles", placed.len() as f64, MOST_RECTANGLES));
            return None;
        }
        for (i, one) in placed.iter().enumerate() {
            let other = placed[..i].iter().find(|other| one.rectangle.overlap(&other.rectangle) > ROUNDING);
            if let Some(other) = other {
                let [one_text, other_text] = [one, other].map(|placed| written(&placed.rectangle));
                let wrong = Diagnostic::new(format!("the rectangles {other_text} and {one_text} overlap"))
                    .expected("rectangles that do not overlap");
                self.errors.push_in_file(one.origin.or_override([other.origin]), wrong, one.file.clone());
                return None;
            }
        }
        Some(())
    }

    /// Refuses windows whose areas are not those of the pixel; `file` is the place of the first rectangle of
    /// a sub-pixel in a file.
    fn check_areas(
        &mut self,
        windows: &[Window],
        sub_pixels: &SubPixels,
        at: Origin,
        file: impl Fn(usize) -> Option<Place>,
    ) -> Option<()> {
        let Some(areas) = &sub_pixels.areas else { return Some(()) };
        let written = at;
        let at = at.or_override(sub_pixels.causes.iter().copied());
        let mut right = Some(());
        for (number, ((name, window), area)) in sub_pixels.names.iter().zip(windows).zip(areas).enumerate() {
            let (found, wanted) = (window.area(), area * sub_pixels.fill_factor);
            if (found - wanted).abs() > AREA_TOLERANCE + ROUNDING {
                let found = tidy(found);
                let wrong = Diagnostic::new(format!("the rectangles of `{name}` cover {found} of the pixel"))
                    .expected(format!("{} within 0.001: its area times the fill factor", tidy(wanted)));
                self.errors.push_in_file(at, wrong, file(number).filter(|_| at == written));
                right = None;
            }
        }
        right
    }
}

fn unknown(name: &str, sub_pixels: &SubPixels) -> mistake::Mistake {
    no_sub_pixel(name, sub_pixels.table, &sub_pixels.names)
}

/// A rectangle as a scenario has it.
fn written(rectangle: &Rectangle) -> String {
    let Rectangle { x: [x0, x1], y: [y0, y1] } = rectangle;
    format!("[{x0}, {y0}, {x1}, {y1}]")
}
