//! Light of each surface by the place where it leaves the pixels: sums over the directions that a view sees.
//!
//! A direction that a view sees shows the pixels, shifted by a vector: what a window or a pixel shows of
//! another is the area that they share. Areas are exact; only the directions are a sum. Areas have kinks where borders meet:
//! the scatter of several sums over other directions tells the error that they cause, and their mean is the result.

use std::collections::BTreeMap;

use papilio_transport::spatial::{PanelSpread, Part as Directions, Window};
use papilio_transport::{Base, Medium};

use super::super::curve::Curves;
use super::Colour;
use super::surfaces::Part;
use crate::scene::Matrix;

/// Pixels on each side of a pixel whose light is kept apart.
pub(super) const NEIGHBOURS: i64 = 24;
const SIDE: usize = 2 * NEIGHBOURS as usize + 1;

/// Windows of a pixel whose areas are the fractions of the colours.
pub(super) struct Windows {
    pitch_mm: [f64; 2],
    pub(super) all: Vec<Window>,
    /// Fraction of colours over the area, of each sub-pixel and of the inactive area.
    pub(super) scale: Vec<f64>,
}

/// What is seen of the surfaces through a pixel, in one light or all. Colours are X, Y and Z.
#[derive(Debug, Clone)]
pub(super) struct Gathered {
    /// Y of the page through each window from each sub-pixel and the inactive area, `[window][sub-pixel]`.
    pub(super) page: Vec<Vec<f64>>,
    /// Mean over a pixel of the light of each part: that of every second column, the own one included.
    pub(super) stripes: Vec<Colour>,
    /// That of the own column.
    pub(super) line: Vec<Colour>,
    /// That of each pixel around, `[row][column][part]`.
    pub(super) near: Vec<Colour>,
    /// That of pixels farther away, about which a front shows the pixels again; `[part]` by their column and row.
    pub(super) far: BTreeMap<[i64; 2], Vec<Colour>>,
}

/// What is gathered: all parts, and those of the page with their fractions.
pub(super) struct Wanted<'a> {
    pub(super) parts: &'a [Part],
    pub(super) page: &'a [Part],
}

impl Windows {
    pub(super) fn new(matrix: &Matrix) -> Self {
        let all: Vec<Window> = matrix.sub_pixels.iter().map(|one| one.window.clone()).collect();
        let ratio = |fraction: f64, area: f64| if area > 1e-9 { fraction / area } else { 0.0 };
        let covered: f64 = all.iter().map(Window::area).sum();
        let mut scale: Vec<f64> =
            matrix.sub_pixels.iter().map(|one| ratio(one.fraction, one.window.area())).collect();
        scale.push(ratio(matrix.inactive_fraction(), 1.0 - covered));
        Self { pitch_mm: matrix.pitch_mm, all, scale }
    }

    /// Window at a place of a pixel, or the number of windows between them; the place is in periods, below 1.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> usize {
        let holds = |range: [f64; 2], at: f64| (range[0]..range[1]).contains(&at);
        let holds = |window: &Window| window.rectangles.iter().any(|one| holds(one.x, x) && holds(one.y, y));
        self.all.iter().position(holds).unwrap_or(self.all.len())
    }

    /// Area of each window and of the inactive area, in pixels.
    pub(super) fn area_of_each(&self) -> Vec<f64> {
        let mut areas: Vec<f64> = self.all.iter().map(Window::area).collect();
        areas.push((1.0 - areas.iter().sum::<f64>()).max(0.0));
        areas
    }

    /// Area of each window and of the inactive area within `[x0, x1] x [y0, y1]`, scaled.
    fn areas(&self, [x, y]: [[f64; 2]; 2], out: &mut [f64]) {
        let common = |a: [f64; 2], b: [f64; 2]| (a[1].min(b[1]) - a[0].max(b[0])).max(0.0);
        let mut rest = (x[1] - x[0]) * (y[1] - y[0]);
        for ((out, window), scale) in out.iter_mut().zip(&self.all).zip(&self.scale) {
            let area: f64 = window.rectangles.iter().map(|one| common(one.x, x) * common(one.y, y)).sum();
            rest -= area;
            *out = area * scale;
        }
        out[self.all.len()] = rest.max(0.0) * self.scale[self.all.len()];
    }
}

/// Sums what is seen along the directions of a spread of the surfaces `base`, and the colours of pages of each state of `pages`, in
/// several sums over other directions. `weights` are those of the light at each wavelength in X, Y and Z.
pub(super) fn gather(
    spread: &PanelSpread,
    ([base, pages], medium): ([&Base; 2], &Medium),
    weights: &[Vec<f64>; 3],
    windows: &Windows,
    wanted: &Wanted<'_>,
) -> Vec<(Gathered, Vec<Colour>)> {
    let (count, parts) = (windows.all.len(), wanted.parts.len());
    let nothing = Gathered {
        page: vec![vec![0.0; count + 1]; count],
        stripes: vec![[0.0; 3]; parts],
        line: vec![[0.0; 3]; parts],
        near: vec![[0.0; 3]; SIDE * SIDE * parts],
        far: BTreeMap::new(),
    };
    let mut all = vec![(nothing, vec![[0.0; 3]; pages.states()]); Directions::SUMS];
    let mut lights = vec![[0.0; 3]; base.states()];
    let (mut of_surfaces, mut of_pages) = (vec![0.0; base.states()], vec![0.0; pages.states()]);
    let mut areas = vec![0.0; count + 1];
    let mut known = None::<([[Curves; 2]; 3], &Directions)>;
    for directions in spread.parts() {
        let same = known.take().filter(|(_, other)| other.is_weighted_like(directions));
        let curves = same.map(|(curves, _)| curves).unwrap_or_else(|| {
            let of = |base: &Base, weights: &[f64]| colour_curves(directions, (base, medium), weights);
            weights.each_ref().map(|weights| [base, pages].map(|base| of(base, weights)))
        });
        // Pixels about the place where these directions show each at its own.
        let about = directions.moved_mm();
        let about = about.map(|at_mm| [0, 1].map(|k| (-at_mm[k] / windows.pitch_mm[k]).round() as i64));
        for (number, (sums, colours)) in all.iter_mut().enumerate() {
            directions.each_sample_of(Some(number), |sample| {
                let beta_squared = sample.beta.squared();
                for (k, [curves, pages]) in curves.iter().enumerate() {
                    curves.at(beta_squared, &mut of_surfaces);
                    let pairs = lights.iter_mut().zip(&of_surfaces);
                    pairs.for_each(|(light, value)| light[k] = sample.weight * value);
                    pages.at(beta_squared, &mut of_pages);
                    let pairs = colours.iter_mut().zip(&of_pages);
                    pairs.for_each(|(colour, value)| colour[k] += sample.weight * value);
                }
                let shift = [0, 1].map(|k| -sample.place_mm[k] / windows.pitch_mm[k]);
                sums.add_page(windows, shift, &lights, wanted.page);
                sums.add_pixels(windows, (shift, about), &lights, wanted.parts, &mut areas);
            });
        }
        known = Some((curves, directions));
    }
    all
}

fn colour_curves(directions: &Directions, (base, medium): (&Base, &Medium), weights: &[f64]) -> Curves {
    let passed: Vec<f64> = weights.iter().zip(&*directions.through).map(|(weight, t)| weight * t).collect();
    Curves::new(base, medium, directions.index(), &passed)
}

impl Gathered {
    /// Adds what the windows show of a page that is shifted by `shift` periods.
    fn add_page(&mut self, windows: &Windows, shift: [f64; 2], lights: &[Colour], page: &[Part]) {
        let count = windows.all.len();
        for (seen, row) in windows.all.iter().zip(&mut self.page) {
            let mut rest = seen.area();
            if rest == 0.0 {
                continue;
            }
            let mut areas = [0.0; MOST_WINDOWS];
            for (area, source) in areas.iter_mut().zip(&windows.all) {
                *area = seen.overlap(source, shift);
                rest -= *area;
            }
            if let Some(area) = areas.get_mut(count) {
                *area = rest.max(0.0);
            }
            for part in page {
                let scaled = areas[part.sub_pixel] * windows.scale[part.sub_pixel] * part.fraction;
                row[part.sub_pixel] += scaled * lights[part.surface][1];
            }
        }
    }

    /// Adds what a whole pixel shows of the pixels around it, shifted by `shift` periods. Of pixels that are farther away, those
    /// around the pixel `about` are kept, or all.
    fn add_pixels(
        &mut self,
        windows: &Windows,
        (shift, about): ([f64; 2], Option<[i64; 2]>),
        lights: &[Colour],
        parts: &[Part],
        areas: &mut [f64],
    ) {
        let first = shift.map(f64::floor);
        let rest = [0, 1].map(|k| shift[k] - first[k]);
        // The shifted pixel covers the upper end of the first pixel and the lower end of the next.
        let sides = rest.map(|rest| [[rest, 1.0], [0.0, rest]]);
        for (row, column) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let extent = [sides[0][column], sides[1][row]];
            if extent.iter().any(|side| side[1] <= side[0]) {
                continue;
            }
            windows.areas(extent, areas);
            let pixel = [first[0] as i64 + column as i64, first[1] as i64 + row as i64];
            let is_near = pixel.iter().all(|at| at.abs() <= NEIGHBOURS);
            let is_about = |about: [i64; 2]| (0..2).all(|k| (pixel[k] - about[k]).abs() <= NEIGHBOURS);
            let is_far = !is_near && about.is_none_or(is_about);
            let mut around = match (is_near, is_far) {
                (true, _) => self.near.get_mut(cell(pixel) * parts.len()..),
                (_, true) => {
                    let far = self.far.entry(pixel).or_insert_with(|| vec![[0.0; 3]; parts.len()]);
                    Some(&mut far[..])
                }
                _ => None,
            };
            for (number, part) in parts.iter().enumerate() {
                let area = areas[part.sub_pixel];
                let light = lights[part.surface].map(|light| area * light);
                let add = |slot: &mut Colour| (0..3).for_each(|k| slot[k] += light[k]);
                if pixel[0] % 2 == 0 {
                    add(&mut self.stripes[number]);
                }
                if pixel[0] == 0 {
                    add(&mut self.line[number]);
                }
                if let Some(around) = &mut around {
                    add(&mut around[number]);
                }
            }
        }
    }

    /// Adds the light of another source.
    pub(super) fn add(&mut self, other: &Self) {
        for (pixel, more) in &other.far {
            let sums = self.far.entry(*pixel).or_insert_with(|| vec![[0.0; 3]; more.len()]);
            sums.iter_mut().zip(more).for_each(|(sum, more)| (0..3).for_each(|k| sum[k] += more[k]));
        }
        let rows = self.page.iter_mut().flatten().zip(other.page.iter().flatten());
        rows.for_each(|(sum, more)| *sum += more);
        for (sums, more) in [
            (&mut self.stripes, &other.stripes),
            (&mut self.line, &other.line),
            (&mut self.near, &other.near),
        ] {
            sums.iter_mut().zip(more).for_each(|(sum, more)| (0..3).for_each(|k| sum[k] += more[k]));
        }
    }
}

/// Largest number of sub-pixels, and the inactive area.
const MOST_WINDOWS: usize = 65;

/// Number of a pixel around, by its column and row.
pub(super) fn cell([column, row]: [i64; 2]) -> usize {
    (row + NEIGHBOURS) as usize * SIDE + (column + NEIGHBOURS) as usize
}
