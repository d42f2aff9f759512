//! Light that a front above a diffuser returns to mirror-like pixels: each meeting with the surface of its own place.
//!
//! **What.** Light with m meetings has the product of the reflectances of the surfaces at their places, by direction and
//! wavelength, through all orders. Patches, stripes, lines and text say which state each pixel has, windows which surface is where
//! in a pixel, so that light that meets the same sub-pixel again counts as such.
//!
//! **How.** The chains of directions are those of `meetings.rs`; each is seen from [`PLACES`] places of a pixel and of strokes.
//! Light of pixels that are mixed uniformly is known exactly: sums over chains are scaled to that of the brighter state, and what a figure
//! has of each state adds what its own mixed page differs by.
//!
//! **Error.** The coarse level and a third result have other chains, and fewer; the larger difference is the error.

use papilio_sampling::SampleStream;
use papilio_transport::{Source, Top};

use super::super::Level;
use super::super::meetings::{Air, Chain, Points, Way, each_number};
use super::super::response::Lit;
use super::flat::colour;
use super::frame::Frame;
use super::measure::Figures;
use super::{BLACK, Colour, Figure, add, state};
use crate::DisplayError;
use crate::meter::PRIMARIES;

/// Places of a pixel from which each chain is seen, and the numbers of a chain that say where they are.
const PLACES: usize = 8;
const BLOCK: u32 = 30;

/// Steps of the places of a pixel along x, y and through strokes: a lattice.
const STEPS: [f64; 3] = [1.0 / PLACES as f64, 3.0 / PLACES as f64, 5.0 / PLACES as f64];

/// Chains of the first level, and natural digits in which there are twice as many.
const CHAINS: f64 = 2048.0;
const DIGITS: f64 = 9.0;
const DIGITS_OF_TWICE: f64 = 2.0;

/// Less returned light than this does not count.
const NOTHING: f64 = 1e-9;

/// Light that returns, in one light or all.
pub(super) struct Returned {
    /// Y of the page through each window from each sub-pixel and the inactive area, `[window][sub-pixel]`.
    pub(super) page: Vec<Vec<f64>>,
    /// Colours of each state as a figure on the page, `[figure][state]`.
    figures: [Vec<Colour>; 4],
    /// Of the page as stripes on black.
    beside_black: Option<Colour>,
}

/// A figure of a state on a page of another.
struct Image {
    figure: Figure,
    states: [usize; 2],
    /// Light of all chains, and the sums of its parts by figure and page, each with the light of both as mixed pages.
    light: Colour,
    of_figure: f64,
    of_both: f64,
}

/// Where a chain meets the pixels: the window, and which figures are there.
struct Meeting {
    window: usize,
    is_figure: [bool; 4],
}

/// Reflectances along a chain.
struct Row {
    bins: usize,
    states: usize,
    /// Of the surfaces, `[meeting][surface][wavelength]`.
    surfaces: Vec<f64>,
    /// Of the states at the places of meetings, `[meeting][state][wavelength]`.
    here: Vec<f64>,
    /// Of all meetings, `[wavelength]`.
    product: Vec<f64>,
}

impl Returned {
    /// Adds light of another source.
    pub(super) fn add(&mut self, other: &Self) {
        let rows = self.page.iter_mut().flatten().zip(other.page.iter().flatten());
        rows.for_each(|(sum, more)| *sum += more);
        let colours = self.figures.iter_mut().flatten().zip(other.figures.iter().flatten());
        colours.for_each(|(sum, more)| add(sum, *more));
        self.beside_black = self.beside_black.zip(other.beside_black).map(|(mut sum, more)| {
            add(&mut sum, more);
            sum
        });
    }

    /// Adds the light of a figure to that which meets the pixels once.
    pub(super) fn add_to(&self, figure: Figure, (colours, beside): &mut Figures, page: usize) {
        let returned = &self.figures[figure as usize];
        colours.iter_mut().zip(returned).for_each(|(sum, more)| add(sum, *more));
        let of_page = self.figures[Figure::Patch as usize][page];
        let more = self.beside_black.filter(|_| figure == Figure::Stripe).unwrap_or(of_page);
        beside.iter_mut().for_each(|sum| add(sum, more));
    }
}

impl Frame<'_> {
    /// Light that a front returns: that of mixed pages in all orders, less that which meets them once, by chains. `all` is the light
    /// of pages, `[state][wavelength]`, `once` the colours of that which meets them once.
    pub(super) fn returned(
        &self,
        lit: Lit<'_>,
        (source, index): (&Source, f64),
        weights: &[Vec<f64>; 3],
        (all, once): (&[f64], &[Colour]),
    ) -> Result<Returned, DisplayError> {
        let bins = self.setup.scene.grid.len();
        let exact: Vec<Colour> = all
            .chunks_exact(bins)
            .zip(once)
            .map(|(all, once)| {
                let all = colour(weights, all);
                [0, 1, 2].map(|k| (all[k] - once[k]).max(0.0))
            })
            .collect();
        let over =
            exact.iter().zip(once).map(|(more, once)| if once[1] > 0.0 { more[1] / once[1] } else { 0.0 });
        let most = over.fold(0.0, f64::max);
        let mut chains = Chains::new(self, exact);
        if let (Top::Diffuser(diffuser), true) = (&lit.panel.top, most > NOTHING) {
            let air = Air::new(lit, &weights[1])?;
            let way = Way {
                view: &lit.view.field,
                source,
                diffuser,
                index,
                glass_mm: lit.thickness_mm(),
                air: &air,
                kept: 1.0,
            };
            chains.follow(lit, &way, weights, &points(lit.level, most / (1.0 + most)));
        }
        Ok(chains.found())
    }
}

fn points(level: Level, returned: f64) -> Points {
    let count = CHAINS * ((level.digits - DIGITS) / DIGITS_OF_TWICE).exp2();
    let (part, stream) = match level {
        Level { is_other: true, .. } => (0.25, 2),
        Level { is_fine, .. } => (1.0, u64::from(!is_fine)),
    };
    Points { count: (part * count) as usize, stream, returned }
}

/// Sums over chains.
struct Chains<'a> {
    frame: &'a Frame<'a>,
    /// Middles of strokes.
    strokes: Vec<usize>,
    /// Surfaces in each window and between them with their fractions, `[state][window]`.
    shown: Vec<Vec<Vec<(usize, f64)>>>,
    /// Surfaces of each state over all of a pixel, `[state][surface]`.
    mixed: Vec<Vec<f64>>,
    /// Light of mixed pages: what is exact, and that of chains, `[state]`.
    exact: Vec<Colour>,
    of_chains: Vec<Colour>,
    images: Vec<Image>,
    /// `[window][sub-pixel]`
    page: Vec<Vec<f64>>,
}

impl<'a> Chains<'a> {
    fn new(frame: &'a Frame<'a>, exact: Vec<Colour>) -> Self {
        let (setup, count) = (frame.setup, frame.windows.all.len());
        let strokes = frame.text.as_ref().map(|bitmap| bitmap.middles().strokes).unwrap_or_default();
        let black = state(setup, BLACK);
        let states: Vec<usize> =
            PRIMARIES.into_iter().filter_map(|name| state(setup, name)).chain(black).collect();
        let mut pairs = vec![(Figure::Patch, [frame.page; 2])];
        for figure in Figure::ALL.into_iter().filter(|figure| *figure != Figure::Text || !strokes.is_empty())
        {
            pairs.extend(states.iter().map(|state| (figure, [*state, frame.page])));
        }
        pairs.extend(black.map(|black| (Figure::Stripe, [frame.page, black])));
        let image =
            |(figure, states)| Image { figure, states, light: [0.0; 3], of_figure: 0.0, of_both: 0.0 };
        let shown = frame.surfaces.shown(&frame.windows);
        let surfaces = frame.surfaces.base.states();
        let mixed = |windows: &Vec<Vec<(usize, f64)>>| {
            let mut sum = vec![0.0; surfaces];
            for (here, area) in windows.iter().zip(frame.windows.area_of_each()) {
                here.iter().for_each(|(surface, fraction)| sum[*surface] += area * fraction);
            }
            sum
        };
        Self {
            frame,
            mixed: shown.iter().map(mixed).collect(),
            of_chains: vec![[0.0; 3]; exact.len()],
            exact,
            shown,
            strokes,
            images: pairs.into_iter().map(image).collect(),
            page: vec![vec![0.0; count + 1]; count],
        }
    }

    fn follow(&mut self, lit: Lit<'_>, way: &Way<'_>, weights: &[Vec<f64>; 3], points: &Points) {
        let (panel, base) = (lit.panel, &self.frame.surfaces.base);
        let (bins, surfaces, states) = (base.bins(), base.states(), self.shown.len());
        let passes = |bin: usize| panel.front.transmittance[bin] * way.diffuser.transmittance[bin];
        let kept = |bin: usize| panel.front.reflectance_below[bin] * way.diffuser.transmittance[bin].powi(2);
        let mut row = Row { bins, states, surfaces: Vec::new(), here: Vec::new(), product: vec![0.0; bins] };
        let (mut chain, mut places, mut meetings) = (Chain::default(), Vec::new(), Vec::new());
        for (number, count, numbers) in each_number(points) {
            let light = weights.each_ref().map(|weights| -> Vec<f64> {
                let of_bin =
                    |bin: usize| weights[bin] * passes(bin).powi(2) * kept(bin).powi(number as i32 - 1);
                (0..bins).map(of_bin).collect()
            });
            row.surfaces.resize(number * surfaces * bins, 0.0);
            row.here.resize(number * states * bins, 0.0);
            for point in 0..count as u64 {
                let weight = chain.follow(way, number, &numbers, point) / count as f64;
                if weight <= 0.0 {
                    continue;
                }
                for (beta, out) in chain.at_pixel().zip(row.surfaces.chunks_exact_mut(surfaces * bins)) {
                    base.reflectance(beta.squared(), &panel.medium, out);
                    out.iter_mut().for_each(|rho| *rho = rho.max(0.0));
                }
                // A factor of the first meeting is one of all.
                row.surfaces[..surfaces * bins].chunks_exact_mut(bins).for_each(|rho| chain.colour(way, rho));
                places.clear();
                chain.each_place(way, |place_mm| places.push(place_mm));
                // As mixed pages.
                row.set(number, |state, _| self.mixed[state].iter().copied().enumerate());
                let mixed: Vec<Colour> = (0..states)
                    .map(|state| row.colour(&light, number, |_| state).map(|value| weight * value))
                    .collect();
                self.of_chains.iter_mut().zip(&mixed).for_each(|(sum, more)| add(sum, *more));
                for place in 0..PLACES {
                    let own = self.meet(place, (&numbers, point), &places, &mut meetings);
                    row.set(number, |state, meeting| {
                        self.shown[state][meetings[meeting].window].iter().copied()
                    });
                    self.see(&mut row, &light, weight / PLACES as f64, (own, &meetings), &mixed);
                }
            }
        }
    }

    /// Writes the meetings of a chain that is seen at a place of a pixel; returns the window there.
    fn meet(
        &self,
        place: usize,
        (numbers, point): (&SampleStream, u64),
        places: &[[f64; 2]],
        meetings: &mut Vec<Meeting>,
    ) -> usize {
        let Frame { windows, matrix, text, .. } = self.frame;
        let [x, y, stroke, _] = numbers.block(point, BLOCK);
        let at = |first: f64, k: usize| (first + place as f64 * STEPS[k]).fract();
        let own = [at(x, 0), at(y, 1)];
        let stroke = (at(stroke, 2) * self.strokes.len() as f64) as usize;
        let stroke = self.strokes.get(stroke).map(|stroke| *stroke as i64);
        meetings.clear();
        for place_mm in places {
            // Light goes from a place to the opposite one about the place where it is seen.
            let at = [0, 1].map(|k| own[k] - place_mm[k] / matrix.pitch_mm[k]);
            let [column, row] = at.map(|at| at.floor() as i64);
            let is_stroke = text.as_ref().zip(stroke).is_some_and(|(bitmap, stroke)| {
                let [columns, rows] = bitmap.count.map(|count| count as i64);
                let (x, y) = (stroke % columns + column, stroke / columns + row);
                let inside = (0..columns).contains(&x) && (0..rows).contains(&y);
                inside && bitmap.black[(y * columns + x) as usize]
            });
            let is_figure = Figure::ALL.map(|figure| match figure {
                Figure::Patch => true,
                Figure::Stripe => column % 2 == 0,
                Figure::Line => column == 0,
                Figure::Text => is_stroke,
            });
            meetings.push(Meeting { window: windows.at(at.map(|at| at.rem_euclid(1.0))), is_figure });
        }
        windows.at(own)
    }

    /// Adds what is seen of a chain with these meetings.
    fn see(
        &mut self,
        row: &mut Row,
        light: &[Vec<f64>; 3],
        weight: f64,
        (own, meetings): (usize, &[Meeting]),
        mixed: &[Colour],
    ) {
        let number = meetings.len();
        let mut of_pages: Vec<Option<Colour>> = vec![None; mixed.len()];
        let mut page_of = |row: &mut Row, state: usize| {
            *of_pages[state]
                .get_or_insert_with(|| row.colour(light, number, |_| state).map(|value| weight * value))
        };
        for image in &mut self.images {
            let [figure, page] = image.states;
            let is_figure = |meeting: usize| meetings[meeting].is_figure[image.figure as usize];
            let inside = (0..number).filter(|meeting| is_figure(*meeting)).count();
            let seen = match inside {
                0 => page_of(row, page),
                _ if inside == number => page_of(row, figure),
                _ => row
                    .colour(light, number, |meeting| if is_figure(meeting) { figure } else { page })
                    .map(|value| weight * value),
            };
            add(&mut image.light, seen);
            let both = mixed[figure][1] + mixed[page][1];
            image.of_figure += both * inside as f64 / number as f64;
            image.of_both += both;
        }
        if let Some(windows) = self.page.get_mut(own) {
            windows[meetings[0].window] += page_of(row, self.frame.page)[1];
        }
    }

    fn found(self) -> Returned {
        let states = self.exact.len();
        // Light of the brighter state is scaled to what is exact.
        let scale = |[figure, page]: [usize; 2], k: usize| {
            let brighter = if self.of_chains[page][k] > self.of_chains[figure][k] { page } else { figure };
            let chains = self.of_chains[brighter][k];
            if chains > 0.0 { self.exact[brighter][k] / chains } else { 0.0 }
        };
        let mut figures = [0, 1, 2, 3].map(|_| vec![[0.0; 3]; states]);
        let mut beside_black = None;
        for image in &self.images {
            let part = if image.of_both > 0.0 { image.of_figure / image.of_both } else { 1.0 };
            let colour = [0, 1, 2].map(|k| {
                let scale = scale(image.states, k);
                let [first, second] =
                    image.states.map(|state| self.exact[state][k] - scale * self.of_chains[state][k]);
                scale * image.light[k] + part * first + (1.0 - part) * second
            });
            match image.states {
                [figure, page] if page == self.frame.page || image.figure == Figure::Patch => {
                    figures[image.figure as usize][figure] = colour;
                }
                _ => beside_black = Some(colour),
            }
        }
        let scale = scale([self.frame.page; 2], 1);
        let mut page = self.page;
        page.iter_mut().flatten().for_each(|light| *light *= scale);
        Returned { page, figures, beside_black }
    }
}

impl Row {
    /// Sets the reflectances of states at the meetings from the surfaces there.
    fn set<S: Iterator<Item = (usize, f64)>>(
        &mut self,
        meetings: usize,
        surfaces: impl Fn(usize, usize) -> S,
    ) {
        let Self { bins, states, surfaces: all, here, .. } = self;
        let each = all.len() / meetings;
        for (number, out) in here.chunks_exact_mut(*bins).enumerate() {
            let (meeting, state) = (number / *states, number % *states);
            out.fill(0.0);
            for (surface, fraction) in surfaces(state, meeting) {
                let rho = &all[meeting * each + surface * *bins..][..*bins];
                out.iter_mut().zip(rho).for_each(|(sum, rho)| *sum += fraction * rho);
            }
        }
    }

    /// Light whose meetings are with these states.
    fn colour(&mut self, light: &[Vec<f64>; 3], meetings: usize, state: impl Fn(usize) -> usize) -> Colour {
        let Self { bins, states, here, product, .. } = self;
        let of = |meeting: usize| &here[(meeting * *states + state(meeting)) * *bins..][..*bins];
        product.copy_from_slice(of(0));
        for meeting in 1..meetings {
            product.iter_mut().zip(of(meeting)).for_each(|(product, rho)| *product *= rho);
        }
        colour(light, product)
    }
}
