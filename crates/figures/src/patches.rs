//! Colour patches of the states, as the reader would see them.

use papilio_display::result::{RunResult, State, View};

use crate::panel::SMALL;
use crate::style::{INK, SOFT, fixed, painted, with_error};
use crate::svg::{Anchor, Point, Svg, Text, shortened};

/// Patches in a row, at most.
const IN_A_ROW: usize = 8;

/// A patch for each state of a view, in sRGB.
///
/// The page's white is a perfect white in the same light (carried to D65 by a
/// Bradford adaptation), so a patch is as dark against the page as the state is
/// against paper in the room. Colours that no screen shows are clipped.
pub fn patches(result: &RunResult, view: &View) -> String {
    let count = view.states.iter().count().max(1);
    let (columns, rows) = (count.min(IN_A_ROW), count.div_ceil(IN_A_ROW));
    let (width, side) = (40.0 + 104.0 * columns as f64, 92.0);
    let mut svg = Svg::new(width.max(420.0), 40.0 + (side + 62.0) * rows as f64);
    draw(&mut svg, result, view, (20.0, 20.0), side);
    let note = "The page's white is a perfect white in the same light.";
    svg.text((20.0, 28.0 + (side + 62.0) * rows as f64), note, Text::new(11.0, SOFT));
    svg.finish()
}

/// The same in a page: patches `side` px wide, 12 px apart.
pub(crate) fn draw(svg: &mut Svg, result: &RunResult, view: &View, origin: Point, side: f64) {
    for (i, (name, state)) in view.states.iter().enumerate() {
        let (column, row) = ((i % IN_A_ROW) as f64, (i / IN_A_ROW) as f64);
        let corner = (origin.0 + column * (side + 12.0), origin.1 + row * (side + 62.0));
        let fill = painted(&state.value, &result.illuminant);
        svg.rect(corner, (side, side), 4.0, &fill, "#d0d0d0");
        caption(svg, name, state, (corner.0 + side / 2.0, corner.1 + side), side);
    }
}

fn caption(svg: &mut Svg, name: &str, state: &State, (x, y): Point, side: f64) {
    let centred = |size, colour| Text::new(size, colour).anchor(Anchor::Middle);
    svg.text((x, y + 17.0), &shortened(name, side, SMALL), centred(SMALL, INK).strong());
    let luminous = with_error(100.0 * state.value.Y, Some(100.0 * state.standard_error.Y), 1);
    svg.text((x, y + 32.0), &format!("Y {luminous} %"), centred(11.0, INK));
    svg.text(
        (x, y + 46.0),
        &format!("L* {}", fixed(state.value.L_star.unwrap_or(f64::NAN), 1)),
        centred(11.0, INK),
    );
}
