//! Crosstalk of a display with a colour filter at a height above its pixels.

use super::super::response::name_of_light;
use super::found::{Levelled, Measured};
use super::{BLACK, CrosstalkView, Figure, PAGE, add, flat, page, refined, state};
use crate::DisplayError;
use crate::filtered::{Filtered, Period, Sum};
use crate::meter::Meter;
use crate::run::{Control, Progress};
use crate::setup::Setup;

/// Periods of one level.
struct Periods {
    /// One pixel.
    page: Period,
    /// Two pixels along x, and a line on a page, where these are computed.
    stripes: Option<Period>,
    line: Option<Period>,
}

/// Why some numbers are null.
const NO_LINE: &str = "adding computes a line below a colour filter for sub-pixels of the full height of the pixel (stripes); solver.method = \"monte-carlo\" computes others";
const NO_TEXT: &str = "text below a colour filter is computed by paths: it has no period of a few pixels, and light that the face returns \
    crosses it (solver.method = \"monte-carlo\")";
const DIFFUSED: &str = "a diffuser above the colour filter blurs what is seen of it: its stripes and lines are computed by paths (solver.method = \"monte-carlo\")";

/// Finest level: a further one takes ten times as long, and changes the numbers as much as this one.
const FINEST: usize = 1;

/// Computes all views.
pub(super) fn views(
    filtered: &Filtered<'_>,
    setup: &Setup,
    control: &Control<'_>,
) -> Result<Vec<CrosstalkView>, DisplayError> {
    let mut levels: Vec<Periods> = Vec::new();
    let mut views = Vec::with_capacity(setup.views.len());
    for (number, view) in setup.views.iter().enumerate() {
        let at = |level: usize| {
            control.check()?;
            if levels.len() == level {
                levels.push(periods(filtered, level)?);
            }
            let sums = filtered.sums().into_iter();
            let sums = sums.map(|sum| seen(filtered, setup, (&levels[level], sum), number));
            Ok(Levelled::of_sums(&sums.collect::<Result<Vec<_>, DisplayError>>()?))
        };
        let mut found = refined(setup, view, (FINEST, 1.0), at, control)?;
        for pattern in &mut found.patterns {
            pattern.why_null = match pattern.name {
                Figure::Stripe | Figure::Line if filtered.is_diffused() => Some(DIFFUSED),
                Figure::Line if !filtered.has_lines() => Some(NO_LINE),
                Figure::Text => Some(NO_TEXT),
                _ => pattern.why_null,
            };
        }
        views.push(found);
        (control.progress)(Progress::of_views(number + 1, setup.views.len()));
    }
    Ok(views)
}

/// Prepares a level. Stripes and lines are those of the plane of the filter, which a diffuser above it blurs.
fn periods(filtered: &Filtered<'_>, level: usize) -> Result<Periods, DisplayError> {
    let is_sharp = !filtered.is_diffused();
    let stripes = is_sharp.then(|| filtered.period(level, 2)).transpose()?;
    let line = (is_sharp && filtered.has_lines()).then(|| filtered.line(level)).transpose()?;
    Ok(Periods { page: filtered.period(level, 1)?, stripes, line })
}

/// Computes what a view sees in a sum.
fn seen(
    filtered: &Filtered<'_>,
    setup: &Setup,
    (periods, sum): (&Periods, Sum),
    number: usize,
) -> Result<Measured, DisplayError> {
    let (meter, page, black) = (Meter::new(setup), page(setup), state(setup, BLACK));
    let (count, states) = (filtered.sub_pixels(), setup.states.len());
    let of_states = |period: &dyn Fn(usize) -> Vec<usize>| (0..states).map(period).collect::<Vec<_>>();
    let pages = filtered.seen(
        (&periods.page, sum),
        number,
        &of_states(&|state| vec![state]),
        filtered.of_first_pixel(&periods.page),
    )?;
    let figures = |period: &Option<Period>, others: &[Vec<usize>]| {
        let Some(period) = period else { return Ok(None) };
        // What leaves through the first pixel, over its part of the period.
        let on_page =
            |state: usize| (0..period.columns()).map(|pixel| if pixel == 0 { state } else { page }).collect();
        let states = [of_states(&on_page), others.to_vec()].concat();
        let seen = filtered.seen((period, sum), number, &states, filtered.of_first_pixel(period))?;
        Ok::<_, DisplayError>(Some((seen, vec![[0.0; 3]; states.len()], period.columns() as f64)))
    };
    let page_beside_black: Vec<Vec<usize>> = black.map(|black| vec![page, black]).into_iter().collect();
    let mut stripes = figures(&periods.stripes, &page_beside_black)?;
    let mut lines = figures(&periods.line, &[])?;
    let mut seen = Measured { from_faces: meter.without_pixel(&pages.unfiltered), ..Measured::default() };
    let mut colours = vec![[0.0; 3]; states];
    for light in meter.pixel_lights().iter().filter(|light| light.is_seen()) {
        let (source, weights) = (light.source, &light.weights);
        seen.names.push(name_of_light(setup, light));
        for (state, colour) in colours.iter_mut().enumerate() {
            add(colour, flat::colour(weights, &pages.shown[source].all(state)));
        }
        for (figures, colours, columns) in [&mut stripes, &mut lines].into_iter().flatten() {
            for (number, colour) in colours.iter_mut().enumerate() {
                let light = flat::colour(weights, &figures.shown[source].all(number));
                add(colour, light.map(|light| *columns * light));
            }
        }
        let row = |window: usize| {
            let from = |sub_pixel: usize| pages.shown[source].part(page, window, sub_pixel);
            let mut row: Vec<f64> = (0..count).map(|own| flat::colour(weights, from(own))[1]).collect();
            row.push(0.0);
            row
        };
        seen.page.push((0..count).map(row).collect());
        // Light that enters as a Lambertian page sends it to the view.
        let first = &pages.unfiltered[source].via_pixel;
        let y = |light: Vec<f64>| {
            let light: Vec<f64> =
                light.iter().zip(first.iter()).map(|(light, first)| light * first).collect();
            flat::colour(weights, &light)[1]
        };
        let entered = filtered.arriving_parts((&periods.page, sum), source)?;
        seen.entered.push(entered.into_iter().map(|row| row.into_iter().map(y).collect()).collect());
    }
    let page_colour = state(setup, PAGE).map(|page| colours[page]);
    seen.beside[Figure::Patch as usize] = page_colour;
    seen.figures[Figure::Patch as usize] = colours;
    if let Some((_, mut columns, _)) = stripes {
        seen.beside[Figure::Stripe as usize] = page_colour.and(columns.get(states).copied());
        columns.truncate(states);
        seen.figures[Figure::Stripe as usize] = columns;
    }
    if let Some((_, line, _)) = lines {
        seen.beside[Figure::Line as usize] = page_colour;
        seen.figures[Figure::Line as usize] = line;
    }
    Ok(seen)
}
