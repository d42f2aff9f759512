//! Crosstalk of a display with a colour filter at a height above its pixels.

use super::super::response::name_of_light;
use super::{BLACK, Colour, CrosstalkView, Figure, Measured, PAGE, assembled, flat, page, state};
use crate::DisplayError;
use crate::filtered::{Filtered, Lit};
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
}

/// Levels of discretisation.
const LEVELS: [usize; 2] = [0, 1];

/// Computes all views.
pub(super) fn views(
    filtered: &Filtered<'_>,
    setup: &Setup,
    control: &Control<'_>,
) -> Result<Vec<CrosstalkView>, DisplayError> {
    let of_level = |level: usize| {
        if control.stopped() {
            return Err(DisplayError::Interrupted);
        }
        levelled(filtered, setup, level)
    };
    let [coarse, fine] = LEVELS.map(of_level);
    let (coarse, fine) = (coarse?, fine?);
    let mut views = Vec::with_capacity(setup.views.len());
    for (number, view) in setup.views.iter().enumerate() {
        if control.stopped() {
            return Err(DisplayError::Interrupted);
        }
        let at = |level: &Levelled| seen(filtered, setup, level, (number, view));
        views.push(assembled(setup, view, &at(&coarse)?, &at(&fine)?));
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
    let (mut pages, mut stripes) = (Vec::new(), Vec::new());
    for source in 0..setup.sources.len() {
        let states = 0..setup.states.len();
        pages.push(states.map(|state| filtered.irradiance(&lit[0], source, &[state])).collect());
        stripes.push(pairs.iter().map(|pair| filtered.irradiance(&lit[1], source, pair)).collect());
    }
    Ok(Levelled { level, lit, pages, stripes, pairs })
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
    let Levelled { level, lit: [one, two], pages, stripes, pairs } = levelled;
    let leaving = filtered.leaving(one, view, *level)?;
    let leaving_pairs = filtered.leaving(two, view, *level)?;
    let first = filtered.unfiltered(one, number);
    let mut seen = Measured {
        names: Vec::new(),
        page: Vec::new(),
        entered: Vec::new(),
        figures: std::array::from_fn(|_| Vec::new()),
        beside: [None; 4],
        from_faces: [0.0; 3],
    };
    let mut colours = vec![[0.0; 3]; states];
    let mut columns = vec![[0.0; 3]; pairs.len()];
    let add = |sum: &mut Colour, more: Colour| (0..3).for_each(|k| sum[k] += more[k]);
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
    seen.beside[Figure::Patch as usize] = state(setup, PAGE).map(|page| colours[page]);
    seen.beside[Figure::Stripe as usize] =
        columns.get(states).copied().filter(|_| state(setup, PAGE).is_some());
    seen.figures[Figure::Patch as usize] = colours;
    seen.figures[Figure::Stripe as usize] = columns[..states].to_vec();
    Ok(seen)
}
