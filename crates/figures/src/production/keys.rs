//! Scatter plot of the displays that meet the limits and of those that do not.

use super::{BAD, GOOD, PANEL};
use crate::axis::Axis;
use crate::overlay::legend;
use crate::panel::Panel;
use crate::svg::{Stroke, Svg, finite};

/// Largest number of marks; more would cover each other.
const MAX_MARKS: usize = 3000;

/// Draws the displays of a tolerance analysis over two keys, in one colour if they meet all limits and in
/// another if not. `points` holds the values of both keys, and whether the display meets all limits.
pub fn pass_fail_scatter(keys: [&str; 2], points: &[([f64; 2], bool)], title: &str) -> String {
    let along = |k: usize| points.iter().map(move |(at, _)| at[k]);
    let x = Axis::covering(along(0), 8, keys[0]);
    let y = Axis::covering(along(1), 6, keys[1]);
    // The note is below the legend.
    let origin = (PANEL.0.0, PANEL.0.1 + 24.0);
    let panel = Panel { origin, size: PANEL.1, x, y };
    let mut svg = Svg::new(680.0, 444.0).titled(title);
    panel.draw(&mut svg);
    // Displays that fail are usually few; they are drawn last to be visible.
    let shown = &points[..points.len().min(MAX_MARKS)];
    for passing in [true, false] {
        for (at, _) in shown.iter().filter(|(_, good)| *good == passing) {
            let at = panel.at(at[0], at[1]);
            if finite(at) {
                let (colour, radius) = if passing { (GOOD, 1.6) } else { (BAD, 2.2) };
                svg.circle(at, radius, colour, &Stroke::solid("none", 0.0));
            }
        }
    }
    if points.len() > shown.len() {
        panel.note(&mut svg, &format!("first {MAX_MARKS} of {} displays", points.len()));
    }
    legend(
        &mut svg,
        [("meets all limits", Stroke::solid(GOOD, 5.0)), ("misses a limit", Stroke::solid(BAD, 5.0))]
            .into_iter(),
    );
    svg.finish()
}
