//! Colour patches of the states, as the reader would see them.

use papilio_display::result::{RunResult, State, View};

use crate::paint::Paint;
use crate::panel::SMALL;
use crate::style::{INK, SOFT, caption, fixed, is_self_lit, percent};
use crate::svg::{Anchor, Point, Svg, Text, shortened};

/// Patches in a row, at most.
const IN_A_ROW: usize = 8;
/// What a row needs below its patches, px.
const CAPTIONS: f64 = 76.0;

/// A patch for each state of a view, in sRGB.
///
/// The page's white is a perfect white in the same light (carried to D65 by a
/// Bradford adaptation), so a patch is as dark against the page as the state is
/// against paper in the room. If a state is brighter than a screen can show, all
/// are dimmed alike, and the figure says by how much. Where the front light is all the light, the page is as white as the
/// display's white. Colours that no screen
/// shows are clipped.
pub fn patches(result: &RunResult, view: &View, title: &str) -> String {
    let count = view.states.iter().count().max(1);
    let (width, side) = (40.0 + 104.0 * count.min(IN_A_ROW) as f64, 92.0);
    let below = 20.0 + height(view, side);
    let mut svg = Svg::new(width.max(420.0), below + 20.0).titled(&caption(title, view));
    draw(&mut svg, result, view, (20.0, 20.0), side);
    let note = match Paint::of(result, view).dimmed() {
        _ if is_self_lit(view) => "The page's white is the display's own.".to_owned(),
        None => "The page's white is a perfect white in the same light.".to_owned(),
        Some(dimmed) => format!("Brighter than a perfect white in the same light: {dimmed}."),
    };
    svg.text((20.0, below + 6.0), &note, Text::new(11.0, SOFT));
    svg.finish()
}

/// Height of all rows of patches `side` px wide.
pub(crate) fn height(view: &View, side: f64) -> f64 {
    view.states.iter().count().max(1).div_ceil(IN_A_ROW) as f64 * (side + CAPTIONS)
}

/// The same in a page: patches `side` px wide, 12 px apart.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, side: f64) {
    let paint = Paint::of(result, view);
    for (i, (name, state)) in view.states.iter().enumerate() {
        let (column, row) = ((i % IN_A_ROW) as f64, (i / IN_A_ROW) as f64);
        let corner = (origin.0 + column * (side + 12.0), origin.1 + row * (side + CAPTIONS));
        svg.rect(corner, (side, side), 4.0, &paint.colour(&state.value), "#d0d0d0");
        describe(svg, name, state, (corner.0 + side / 2.0, corner.1 + side), side);
    }
}

/// Name, L* and Y; the error of Y has a line of its own, or it would touch the neighbour's.
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
