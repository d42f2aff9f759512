//! Crosstalk by Monte Carlo: all layers and lights of the [walk with places](crate::spatial::walk), with
//! standard errors.
//!
//! The own ray of a path meets the pixels anywhere in a column. The first meeting of the path, followed back
//! from the viewer, is the sub-pixel that the light left; through a filter, the window is where the path
//! passed it before. Figures are patterns of the pixels, seen through all orders. What enters through a
//! filter is followed back from the pixels.
//!
//! Errors are those of a jackknife: each number is computed with each of the replicates left out in turn.

use papilio_imaging::text::Bitmap;
use papilio_transport::walk::places::{Entry, Estimate, Meeting, Pattern, What};

use super::super::patterns;
use super::super::response::name_of_light;
use super::super::walk::Placed;
use super::found::{Measured, assembled};
use super::places::Windows;
use super::surfaces::Surfaces;
use super::{BLACK, Colour, CrosstalkView, Figure, PAGE, largest_error, page, state};
use crate::DisplayError;
use crate::meter::{PRIMARIES, jackknife};
use crate::run::{Control, Round, each_view, missed, paths_from_round, until};
use crate::scene::Matrix;
use crate::setup::{Setup, ViewPoint};

/// Most paths of a view.
const MOST_PATHS: u64 = 1 << 24;

/// What all views have in common.
struct Scenes<'a> {
    setup: &'a Setup,
    panel: Placed<'a>,
    pitch_mm: [f64; 2],
    windows: Windows,
    /// True if the windows are those of a filter.
    has_filter: bool,
    /// Reflecting surfaces of each state in each window and between them, with the fractions that they cover:
    /// `[state][window]`.
    shown: Vec<Vec<Vec<(usize, f64)>>>,
    /// States whose figures are measured.
    figures: Vec<usize>,
    /// Text, and the pixels in the middle of its strokes.
    text: Option<(Bitmap, Vec<usize>)>,
    /// Lights that are seen: their numbers and names.
    lights: Vec<(usize, String)>,
}

/// Computes all views.
pub(super) fn views(
    setup: &Setup,
    matrix: &Matrix,
    text: &str,
    control: &Control<'_>,
) -> Result<Vec<CrosstalkView>, DisplayError> {
    let scenes = Scenes::new(setup, matrix, text)?;
    each_view(setup, true, control, |number, control| scenes.view(number, control))
}

impl<'a> Scenes<'a> {
    fn new(setup: &'a Setup, matrix: &Matrix, text: &str) -> Result<Self, DisplayError> {
        let scene = &setup.scene;
        let windows = Windows::new(matrix);
        let (other_base, shown) = match &matrix.filter {
            Some(filter) => {
                // Below each part of the filter a state of the pixel, black between them.
                let of_state = |state: &crate::scene::FilterState| {
                    let below = state.pixel_states.iter().map(|below| vec![(*below, 1.0)]);
                    below.chain([Vec::new()]).collect()
                };
                (None, filter.states.iter().map(of_state).collect())
            }
            None => {
                let surfaces = Surfaces::new(setup, matrix)?;
                let shown = surfaces.shown(&windows);
                (Some((surfaces.base, surfaces.both)), shown)
            }
        };
        let panel = Placed::new(setup)?;
        let panel = match other_base {
            Some((base, both)) => panel.above(base, both)?,
            None => panel,
        };
        let text = patterns::bitmap(scene, text, matrix.pitch_mm).and_then(|bitmap| {
            let strokes = bitmap.middles().strokes;
            (!strokes.is_empty()).then_some((bitmap, strokes))
        });
        let lights = panel.lights.iter().enumerate().filter(|(_, light)| light.is_seen());
        let lights = lights.map(|(number, light)| (number, name_of_light(setup, light))).collect();
        let figures = PRIMARIES.into_iter().chain([BLACK]).filter_map(|name| state(setup, name));
        Ok(Self {
            figures: figures.collect(),
            pitch_mm: matrix.pitch_mm,
            has_filter: matrix.filter.is_some(),
            setup,
            panel,
            windows,
            shown,
            text,
            lights,
        })
    }

    fn view(&self, number: usize, control: &Control<'_>) -> Result<CrosstalkView, DisplayError> {
        let (view, before) = (&self.setup.views[number], self.panel.traced());
        let stop = &self.setup.scene.solver.stop;
        let passes = 1 + u64::from(self.has_filter);
        let (found, _) = until(stop, MOST_PATHS, |paths| {
            let left = paths_from_round(stop, paths, passes);
            let found =
                self.panel.with_share(before, left, control, |control| self.found(view, paths, control));
            let (found, others) = found?;
            let means = self.luminous_means(&found, &others);
            let found = assembled(self.setup, view, &found, &others.iter().collect::<Vec<_>>());
            let missed = missed(stop, largest_error(&found).1)?;
            Ok(Round { found, missed, means })
        })?;
        Ok(found)
    }

    /// Y of the pages of states and its standard error.
    fn luminous_means(&self, found: &Measured, others: &[Measured]) -> Vec<(f64, f64)> {
        let of = |state: &usize| {
            let y = |one: &Measured| one.figures[Figure::Patch as usize][*state][1];
            (y(found), jackknife(&mut others.iter().map(|one| Some(y(one)))).unwrap_or(0.0))
        };
        self.figures.iter().map(of).collect()
    }

    /// Light of all replicates, and of all but each.
    fn found(
        &self,
        view: &ViewPoint,
        paths: u64,
        control: &Control<'_>,
    ) -> Result<(Measured, Vec<Measured>), DisplayError> {
        let page = Page::new(self);
        let estimates = self.panel.trace(view, What::Pattern(&page), paths, control)?;
        let mut parts: Vec<Vec<f64>> = estimates.iter().map(|one| page.numbers(one)).collect();
        if self.has_filter {
            let count = self.lights.len() * page.windows() * (page.windows() + 1);
            let add = |entry: &Entry<'_>, sums: &mut [f64]| page.enters(entry, sums);
            let entered = self.panel.entries(&page, (paths, count), control, add)?;
            parts.iter_mut().zip(entered).for_each(|(numbers, entered)| numbers.extend(entered));
        }
        let of = |left: Option<usize>| {
            let kept = parts.iter().enumerate().filter(|(k, _)| Some(*k) != left);
            let weight = 1.0 / kept.clone().count() as f64;
            let mut mean = vec![0.0; parts[0].len()];
            for (_, numbers) in kept {
                mean.iter_mut().zip(numbers).for_each(|(mean, number)| *mean += weight * number);
            }
            page.measured(&mean)
        };
        Ok((of(None), (0..parts.len()).map(|left| of(Some(left))).collect()))
    }
}

/// Figures on a page, and the page by window and sub-pixel: the images of one view.
///
/// Image 0 is the page. Then follow each figure in its states, the page beside a black stripe, and the light
/// of the page by window and sub-pixel.
struct Page<'a> {
    scenes: &'a Scenes<'a>,
    /// State of the page, and black.
    page: usize,
    black: Option<usize>,
}

impl<'a> Page<'a> {
    fn new(scenes: &'a Scenes<'a>) -> Self {
        let setup = &scenes.setup;
        Self { scenes, page: page(setup), black: state(setup, BLACK) }
    }

    /// Number of windows.
    fn windows(&self) -> usize {
        self.scenes.windows.all.len()
    }

    /// Window at a place, or the number of windows between them.
    fn window_at(&self, place_mm: [f64; 2]) -> usize {
        self.scenes.windows.at([0, 1].map(|k| (place_mm[k] / self.scenes.pitch_mm[k]).rem_euclid(1.0)))
    }

    /// Column and row of a place.
    fn cell(&self, place_mm: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|k| (place_mm[k] / self.scenes.pitch_mm[k]).floor() as i64)
    }

    /// The figures there are.
    fn figures(&self) -> impl Iterator<Item = Figure> + use<> {
        let has_text = self.scenes.text.is_some();
        Figure::ALL.into_iter().filter(move |figure| has_text || *figure != Figure::Text)
    }

    /// True where a figure is black, by the places of a meeting and of the own ray.
    fn is_figure(&self, figure: Figure, [x, y]: [i64; 2], own: [i64; 2]) -> bool {
        match figure {
            Figure::Patch => true,
            Figure::Stripe => (x - own[0]) % 2 == 0,
            Figure::Line => x == own[0],
            Figure::Text => self.scenes.text.as_ref().is_some_and(|(bitmap, strokes)| {
                // Each column of the period is a stroke.
                let stroke = strokes[own[0].rem_euclid(strokes.len() as i64) as usize] as i64;
                let [columns, rows] = bitmap.count.map(|count| count as i64);
                let (x, y) = (stroke % columns + x - own[0], stroke / columns + y - own[1]);
                (0..columns).contains(&x)
                    && (0..rows).contains(&y)
                    && bitmap.black[(y * columns + x) as usize]
            }),
        }
    }

    /// Number of images before those of the page by window and sub-pixel.
    fn before_parts(&self) -> usize {
        1 + self.figures().count() * self.scenes.figures.len() + usize::from(self.black.is_some())
    }

    /// Linear numbers of a replicate, as [`measured`](Self::measured) reads them.
    fn numbers(&self, estimate: &Estimate) -> Vec<f64> {
        let Scenes { panel, lights, .. } = self.scenes;
        let mut numbers = panel.without_pixel(estimate).to_vec();
        for image in 0..self.before_parts() {
            let mut sum = [0.0; 3];
            lights.iter().for_each(|(light, _)| super::add(&mut sum, panel.colour(estimate, *light, image)));
            numbers.extend(sum);
        }
        let parts = self.before_parts()..self.images();
        for (light, _) in lights {
            numbers.extend(parts.clone().map(|image| panel.colour(estimate, *light, image)[1]));
        }
        numbers
    }

    /// Adds Y of light that enters to the sums of its light, window and sub-pixel.
    fn enters(&self, entry: &Entry<'_>, sums: &mut [f64]) {
        let (count, Scenes { panel, lights, .. }) = (self.windows(), self.scenes);
        let Some(light) = lights.iter().position(|(light, _)| *light == entry.source) else { return };
        let sub_pixel = self.window_at(entry.place_mm);
        if sub_pixel == count {
            return;
        }
        let [_, weights, _] = &panel.lights[entry.source].weights;
        let values = || weights.iter().zip(entry.light).map(|(weight, light)| weight * light);
        let slot = |place: &[f64; 2]| (light * (count + 1) + self.window_at(*place)) * count + sub_pixel;
        match entry.passed_mm {
            [place] => sums[slot(place)] += values().sum::<f64>(),
            places => places.iter().zip(values()).for_each(|(place, value)| sums[slot(place)] += value),
        }
    }

    /// Light from linear numbers.
    fn measured(&self, numbers: &[f64]) -> Measured {
        let Scenes { setup, lights, figures, .. } = self.scenes;
        let mut rest = numbers;
        let mut next = |count: usize| {
            let (first, others) = rest.split_at(count);
            rest = others;
            first
        };
        let colour = |numbers: &[f64]| -> Colour { [numbers[0], numbers[1], numbers[2]] };
        let mut measured = Measured { from_faces: colour(next(3)), ..Measured::default() };
        let page = colour(next(3));
        for figure in self.figures() {
            let mut colours = vec![[0.0; 3]; setup.states.len()];
            figures.iter().for_each(|state| colours[*state] = colour(next(3)));
            measured.figures[figure as usize] = colours;
            measured.beside[figure as usize] = Some(page);
        }
        if self.black.is_some() {
            measured.beside[Figure::Stripe as usize] = Some(colour(next(3)));
        }
        if state(setup, PAGE).is_none() {
            measured.beside = [None; 4];
        }
        let count = self.windows();
        let mut matrix = |rows: usize, columns: usize| -> Vec<Vec<f64>> {
            (0..rows).map(|_| next(columns).to_vec()).collect()
        };
        measured.page = lights.iter().map(|_| matrix(count, count + 1)).collect();
        if self.scenes.has_filter {
            measured.entered = lights.iter().map(|_| matrix(count + 1, count)).collect();
        }
        measured.names = lights.iter().map(|(_, name)| name.clone()).collect();
        measured
    }
}

impl Pattern for Page<'_> {
    fn images(&self) -> usize {
        self.before_parts() + self.windows() * (self.windows() + 1)
    }

    fn period_mm(&self) -> [f64; 2] {
        let [x, y] = self.scenes.pitch_mm;
        let columns = self.scenes.text.as_ref().map_or(1, |(_, strokes)| strokes.len());
        [columns as f64 * x, y]
    }

    fn shows(&self, place_mm: [f64; 2], covered: &mut dyn FnMut(usize, usize, f64)) {
        let [own_mm, own_at_filter_mm, passed_mm] = [place_mm; 3];
        let meeting = Meeting { place_mm, own_mm, own_at_filter_mm, passed_mm, is_first: true };
        self.shows_at(&meeting, covered);
    }

    fn shows_at(&self, meeting: &Meeting, covered: &mut dyn FnMut(usize, usize, f64)) {
        let (here, count) = (self.window_at(meeting.place_mm), self.windows());
        let at = self.cell(meeting.place_mm);
        let own = self.cell(meeting.own_at_filter_mm);
        let mut image = 0;
        let mut show = |state: usize, image: usize| {
            for (surface, fraction) in &self.scenes.shown[state][here] {
                covered(image, *surface, *fraction);
            }
        };
        let mut next = |state: usize| {
            show(state, image);
            image += 1;
        };
        next(self.page);
        for figure in self.figures() {
            let on = self.is_figure(figure, at, own);
            self.scenes.figures.iter().for_each(|state| next(if on { *state } else { self.page }));
        }
        if let Some(black) = self.black {
            next(if self.is_figure(Figure::Stripe, at, own) { self.page } else { black });
        }
        let seen = self.window_at(meeting.passed_mm);
        match meeting.is_first {
            true if seen < count => show(self.page, image + seen * (count + 1) + here),
            true => {}
            false => (image..image + count * (count + 1)).for_each(|image| show(self.page, image)),
        }
    }
}
