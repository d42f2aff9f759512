//! Colour patches of the states, as the reader would see them.

use papilio_display::result::{RunResult, State, View};

use crate::paint::Paint;
use crate::panel::SMALL;
use crate::style::{INK, SOFT, caption, fixed, is_self_lit, percent};
use crate::svg::{Anchor, Point, Svg, Text, shortened};

/// Patches in a row, at most.
const IN_A_ROW: usize = 8;
/// Height of the captions below a row of patches, px.
const CAPTIONS: f64 = 76.0;

/// Draws a patch for each state of a view, in sRGB.
///
/// The white of the page is a perfect white diffuser in the same light (adapted to D65 by the
/// CAT16), so that a patch is as dark relative to the page as the state is
/// relative to white paper in the same light. If a state is brighter than the screen can show, all
/// luminances are divided by the same number, which the figure states. If the front light is the only light,
/// the white of the page is the white of the display. Colours outside the gamut of the screen are clipped.
pub fn patches(result: &RunResult, view: &View, title: &str) -> String {
    let count = view.states.iter().count().max(1);
    let (width, side) = (40.0 + 104.0 * count.min(IN_A_ROW) as f64, 92.0);
    let below = 20.0 + height(view, side);
    let mut svg = Svg::new(width.max(420.0), below + 20.0).titled(&caption(title, view));
    draw(&mut svg, result, view, (20.0, 20.0), side);
    let note = match Paint::of(result, view).dimmed() {
        _ if is_self_lit(view) => "The white of the page is the white of the display.".to_owned(),
        None => "The white of the page is a perfect white in the same light.".to_owned(),
        Some(dimmed) => format!("Brighter than a perfect white in the same light: {dimmed}."),
    };
    svg.text((20.0, below + 6.0), &note, Text::new(11.0, SOFT));
    svg.finish()
}

/// Returns the height of all rows of patches that are `side` px wide.
pub(crate) fn height(view: &View, side: f64) -> f64 {
    view.states.iter().count().max(1).div_ceil(IN_A_ROW) as f64 * (side + CAPTIONS)
}

/// Draws the patches within a page, `side` px wide and 12 px apart.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, side: f64) {
    let paint = Paint::of(result, view);
    for (i, (name, state)) in view.states.iter().enumerate() {
        let (column, row) = ((i % IN_A_ROW) as f64, (i / IN_A_ROW) as f64);
        let corner = (origin.0 + column * (side + 12.0), origin.1 + row * (side + CAPTIONS));
        svg.rect(corner, (side, side), 4.0, &paint.colour(&state.value), "#d0d0d0");
        describe(svg, name, state, (corner.0 + side / 2.0, corner.1 + side), side);
    }
}

/// Writes the name, L* and Y. The error of Y has its own line, so that it does not touch the next patch's
/// text.
fn describe(svg: &mut Svg, name: &str, state: &State, (x, y): Point, side: f64) {
    let centred = |size, colour| Text::new(size, colour).anchor(Anchor::Middle);
    let (luminous, error) = percent(state.value.Y, state.standard_error.Y);
    svg.text((x, y + 17.0), &shortened(name, side, SMALL), centred(SMALL, INK).strong());
    let lightness = format!("L* {}", fixed(state.value.L_star.unwrap_or(f64::NAN), 1));
    svg.text((x, y + 32.0), &lightness, centred(11.0, INK));
    svg.text((x, y + 46.0), &format!("Y {luminous} %"), centred(11.0, INK));
    if let Some(error) = error {
        svg.text((x, y + 60.0), &format!("\u{b1} {error} %"), centred(11.0, INK));
    }
}
