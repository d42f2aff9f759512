//! The palette of a display: a patch for each state, in the scenario's light and in other rooms.

use papilio_display::palette::{PaletteColour, PaletteResult, bytes};

use crate::style::{INK, fixed};
use crate::svg::{Svg, Text, hex, shortened};

/// Size of a patch, and the space to the next, px.
const WIDTH: f64 = 104.0;
const HEIGHT: f64 = 72.0;
const SPACE: f64 = 8.0;
/// Left of the patches: names of rooms, px.
const NAMES: f64 = 148.0;
/// Above the patches: names of states, px.
const HEAD: f64 = 34.0;
/// Below a patch: its numbers, px.
const NUMBERS: f64 = 38.0;

/// Returns the figure of `papilio palette` with its name: patches on a perfect white in each light.
pub fn of_palette(result: &PaletteResult, title: &str) -> Vec<(String, String)> {
    let PaletteResult { palette, rooms, .. } = result;
    let states = palette.colours.len();
    let rows = 1 + rooms.0.len();
    let width = NAMES + (WIDTH + SPACE) * states as f64 + 16.0;
    let height = HEAD + (HEIGHT + NUMBERS) * rows as f64 + 26.0;
    let mut svg = Svg::new(width, height).titled(title);
    for (column, colour) in palette.colours.iter().enumerate() {
        let name = shortened(&colour.state, WIDTH, 13.0);
        svg.text((left(column), HEAD - 10.0), &name, Text::new(13.0, INK).strong());
        patch(&mut svg, (column, 0), colour, None);
    }
    row_name(&mut svg, 0, "this light");
    for (row, (name, room)) in rooms.0.iter().enumerate() {
        row_name(&mut svg, row + 1, name);
        for (column, colour) in palette.colours.iter().enumerate() {
            if let Some(there) = room.get(&colour.state) {
                patch(&mut svg, (column, row + 1), &there.colour, there.delta_e_2000);
            }
        }
    }
    let note = "Adapted to each light; a perfect white in it would be as white as this page. ΔE: CIEDE2000 from this light.";
    svg.text((16.0, height - 10.0), &shortened(note, width - 32.0, 12.0), Text::new(12.0, INK));
    vec![("palette".to_owned(), svg.finish())]
}

fn left(column: usize) -> f64 {
    NAMES + (WIDTH + SPACE) * column as f64
}

fn top(row: usize) -> f64 {
    HEAD + (HEIGHT + NUMBERS) * row as f64
}

fn row_name(svg: &mut Svg, row: usize, name: &str) {
    svg.text((16.0, top(row) + HEIGHT / 2.0), &shortened(name, NAMES - 24.0, 13.0), Text::new(13.0, INK));
}

fn patch(svg: &mut Svg, (column, row): (usize, usize), colour: &PaletteColour, difference: Option<f64>) {
    let Some(srgb) = colour.srgb else { return };
    svg.rect((left(column), top(row)), (WIDTH, HEIGHT), 2.0, &hex(bytes(srgb)), "#c8c8c8");
    let lab = [colour.L_star, colour.a_star, colour.b_star]
        .map(|value| value.map_or("-".to_owned(), |value| fixed(value.round() + 0.0, 0)));
    let line = |svg: &mut Svg, number: f64, text: &str| {
        svg.text((left(column), top(row) + HEIGHT + 14.0 + 15.0 * number), text, Text::new(11.0, INK));
    };
    line(svg, 0.0, &format!("L*a*b* {}", lab.join(" ")));
    if let Some(difference) = difference {
        line(svg, 1.0, &format!("ΔE {}", fixed(difference, 1)));
    }
}
