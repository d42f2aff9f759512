//! Crosstalk of a display with a colour filter at a height above its pixels.

use papilio_transport::spatial::Division;

use super::super::response::name_of_light;
use super::found::Measured;
use super::{BLACK, CrosstalkView, Figure, PAGE, add, flat, page, refined, state};
use crate::DisplayError;
use crate::filtered::{CELLS, Filtered, Lit};
use crate::meter::Meter;
use crate::run::{Control, Progress};
use crate::setup::{Setup, ViewPoint};

/// Light of one level.
struct Levelled {
    level: usize,
    /// Periods of one pixel and of two along x.
    lit: [Lit; 2],
    /// Irradiance of one pixel in each state, `[source][state][cell and wavelength]`.
    pages: Vec<Vec<Vec<f64>>>,
    /// Irradiance of two pixels in each pair of states.
    stripes: Vec<Vec<Vec<f64>>>,
    /// Pairs of states of stripes: the figure and the page beside it.
    pairs: Vec<[usize; 2]>,
    /// Lines on a page; `None` for sub-pixels that do not have the height of a pixel.
    lines: Option<Lines>,
}

/// A line in each state on a page, with a period of several pixels.
struct Lines {
    lit: Lit,
    /// States of the pixels of a period, by the state of the line.
    states: Vec<Vec<usize>>,
    /// Irradiance, `[source][state][cell and wavelength]`.
    irradiance: Vec<Vec<Vec<f64>>>,
}

/// How far beside a line cells are graded, in pixels: the windows next to it.
const BESIDE: f64 = 0.4;

/// Why some numbers are null.
const NO_LINE: &str = "adding computes a line below a colour filter for sub-pixels of the full height of the pixel (stripes); --solver monte-carlo computes others";
const NO_TEXT: &str = "text below a colour filter is computed by paths: it has no period of a few pixels, and light that the face returns \
    crosses it (--solver monte-carlo)";
const DIFFUSED: &str = "a diffuser above the colour filter blurs what is seen of it: its stripes and lines are computed by paths (--solver monte-carlo)";

/// Finest level: a further one takes ten times as long, and changes the numbers as much as this one.
const FINEST: usize = 1;

/// Computes all views.
pub(super) fn views(
    filtered: &Filtered<'_>,
    setup: &Setup,
    control: &Control<'_>,
) -> Result<Vec<CrosstalkView>, DisplayError> {
    let mut levels: Vec<Levelled> = Vec::new();
    let mut views = Vec::with_capacity(setup.views.len());
    for (number, view) in setup.views.iter().enumerate() {
        let at = |level: usize| {
            control.check()?;
            if levels.len() == level {
                levels.push(levelled(filtered, setup, level)?);
            }
            seen(filtered, setup, &levels[level], (number, view))
        };
        let mut found = refined(setup, view, (FINEST, 1.0), at, control)?;
        for pattern in &mut found.patterns {
            pattern.why_null = match pattern.name {
                Figure::Stripe | Figure::Line if filtered.is_diffused() => Some(DIFFUSED),
                Figure::Line if !filtered.is_of_stripes() => Some(NO_LINE),
                Figure::Text => Some(NO_TEXT),
                _ => pattern.why_null,
            };
        }
        views.push(found);
        (control.progress)(Progress::of_views(number + 1, setup.views.len()));
    }
    Ok(views)
}

/// Prepares a level.
fn levelled(filtered: &Filtered<'_>, setup: &Setup, level: usize) -> Result<Levelled, DisplayError> {
    let (page, black) = (page(setup), state(setup, BLACK));
    let lit = [filtered.lit(level, 1)?, filtered.lit(level, 2)?];
    let mut pairs: Vec<[usize; 2]> = (0..setup.states.len()).map(|state| [state, page]).collect();
    pairs.extend(black.map(|black| [page, black]));
    if filtered.is_diffused() {
        pairs.clear();
    }
    let (mut pages, mut stripes) = (Vec::new(), Vec::new());
    for source in 0..setup.sources.len() {
        let states = 0..setup.states.len();
        pages.push(states.map(|state| filtered.irradiance(&lit[0], source, &[state])).collect());
        stripes.push(pairs.iter().map(|pair| filtered.irradiance(&lit[1], source, pair)).collect());
    }
    let has_lines = filtered.is_of_stripes() && !filtered.is_diffused();
    let lines = has_lines.then(|| lines(filtered, setup, level)).transpose()?;
    Ok(Levelled { level, lit, pages, stripes, pairs, lines })
}

/// Prepares lines on a page.
fn lines(filtered: &Filtered<'_>, setup: &Setup, level: usize) -> Result<Lines, DisplayError> {
    let (page, pixels) = (page(setup), filtered.pixels_of_line(level));
    // The line is seen through its own windows: light changes most near the edges of the line.
    let width = 1.0 / pixels as f64;
    let division = Division {
        per_period: (filtered.sub_pixels() * pixels) << level,
        per_window: CELLS << level,
        near: [-BESIDE * width, (1.0 + BESIDE) * width],
    };
    let lit = filtered.lit_with_cells(level, pixels, &division)?;
    let of_state = |state: usize| std::iter::once(state).chain((1..pixels).map(|_| page)).collect();
    let states: Vec<Vec<usize>> = (0..setup.states.len()).map(of_state).collect();
    let of_source = |source: usize| {
        states.iter().map(|states| filtered.irradiance(&lit, source, states)).collect::<Vec<_>>()
    };
    let irradiance = (0..setup.sources.len()).map(of_source).collect();
    Ok(Lines { lit, states, irradiance })
}

/// Computes what a view sees.
fn seen(
    filtered: &Filtered<'_>,
    setup: &Setup,
    levelled: &Levelled,
    (number, view): (usize, &ViewPoint),
) -> Result<Measured, DisplayError> {
    let (meter, page) = (Meter::new(setup), page(setup));
    let (count, states) = (filtered.sub_pixels(), setup.states.len());
    let Levelled { level, lit: [one, two], pages, stripes, pairs, lines } = levelled;
    let leaving = filtered.leaving(one, view, *level)?;
    let leaving_pairs = filtered.leaving(two, view, *level)?;
    let leaving_lines = lines.as_ref().map(|lines| filtered.leaving(&lines.lit, view, *level)).transpose()?;
    let first = filtered.unfiltered(one, number);
    let mut seen = Measured::default();
    let mut colours = vec![[0.0; 3]; states];
    let mut columns = vec![[0.0; 3]; pairs.len()];
    let mut line = vec![[0.0; 3]; if lines.is_some() { states } else { 0 }];
    seen.from_faces = meter.without_pixel(&first);
    for light in meter.pixel_lights().iter().filter(|light| light.is_seen()) {
        let (source, weights) = (light.source, &light.weights);
        let first = &first[source];
        seen.names.push(name_of_light(setup, light));
        let lit = weights
            .each_ref()
            .map(|one| one.iter().zip(&first.via_pixel).map(|(weight, light)| weight * light).collect());
        for (state, colour) in colours.iter_mut().enumerate() {
            let rho = filtered.reflectance(&[state]);
            let mean = filtered.mean(one, &leaving, &pages[source][state], &rho);
            add(colour, flat::colour(&lit, &mean));
        }
        for ((pair, irradiance), colour) in pairs.iter().zip(&stripes[source]).zip(&mut columns) {
            // What passes the windows of the first pixel, over its half of the period.
            let rho = filtered.reflectance(pair);
            let mean = filtered.through(two, &leaving_pairs, irradiance, &rho, 0..count);
            add(colour, flat::colour(&lit, &mean).map(|light| 2.0 * light));
        }
        for (lines, leaving) in lines.iter().zip(&leaving_lines) {
            for ((of_state, irradiance), colour) in
                lines.states.iter().zip(&lines.irradiance[source]).zip(&mut line)
            {
                let rho = filtered.reflectance(of_state);
                let mean = filtered.through(&lines.lit, leaving, irradiance, &rho, 0..count);
                add(colour, flat::colour(&lit, &mean).map(|light| of_state.len() as f64 * light));
            }
        }
        let rho = filtered.reflectance(&[page]);
        let row = |window: usize| {
            let from = |sub_pixel: usize| {
                let irradiance = &pages[source][page];
                let part = filtered.part(one, &leaving, irradiance, &rho, (window, sub_pixel));
                flat::colour(&lit, &part)[1]
            };
            let mut row: Vec<f64> = (0..count).map(from).collect();
            row.push(0.0);
            row
        };
        seen.page.push((0..count).map(row).collect());
        let entered = |window: usize| -> Vec<f64> {
            let to = |sub_pixel: usize| {
                flat::colour(&lit, &filtered.arriving_part(one, source, (window, sub_pixel)))[1]
            };
            (0..count).map(to).collect()
        };
        seen.entered.push((0..=count).map(entered).collect());
    }
    // Stripes and lines are those of the plane of the filter.
    let is_blurred = filtered.is_diffused();
    seen.beside[Figure::Patch as usize] = state(setup, PAGE).map(|page| colours[page]);
    seen.beside[Figure::Stripe as usize] =
        columns.get(states).copied().filter(|_| state(setup, PAGE).is_some());
    seen.beside[Figure::Line as usize] = seen.beside[Figure::Patch as usize].filter(|_| lines.is_some());
    seen.figures[Figure::Patch as usize] = colours;
    if !is_blurred {
        seen.figures[Figure::Line as usize] = line;
        seen.figures[Figure::Stripe as usize] = columns[..states].to_vec();
    }
    Ok(seen)
}
