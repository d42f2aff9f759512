//! Crosstalk: matrices of shares as coloured squares with numbers.

use papilio_display::spatial::{CrosstalkResult, CrosstalkView};

use crate::colour_map::viridis;
use crate::panel::SMALL;
use crate::style::{INK, degrees, fixed, joined};
use crate::svg::{Anchor, Point, Svg, Text, shortened};

/// Side of a square, px, and of a whole matrix with many.
const SQUARE: f64 = 76.0;
const MOST: f64 = 420.0;
/// Room for names on the left of a matrix and above it, px.
const NAMES: f64 = 96.0;
const HEAD: f64 = 92.0;
/// Shares above this are printed in black on a light ground.
const LIGHT: f64 = 0.6;

/// Draws, for each view, the fractions of the light that is seen through each window by the sub-pixel that it
/// left, and, with a filter, those of the light that reaches each sub-pixel by the window through which it
/// entered. Returns names of files, without ending, and figures.
pub fn crosstalk(result: &CrosstalkResult, title: &str) -> Vec<(String, String)> {
    let several = result.views.len() > 1;
    let one = |view: &CrosstalkView| {
        let at =
            if several { papilio_display::view_in_name(view.theta_deg, view.phi_deg) } else { String::new() };
        (format!("crosstalk{at}"), of_view(result, view, title))
    };
    result.views.iter().map(one).collect()
}

fn of_view(result: &CrosstalkResult, view: &CrosstalkView, title: &str) -> String {
    let count = result.subpixels.len();
    let side = SQUARE.min(MOST / count.max(1) as f64);
    let size = side * count as f64;
    let matrices = 1 + usize::from(view.shares.in_.is_some());
    let width = (NAMES + size + 24.0) * matrices as f64 + 20.0;
    let azimuth =
        if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {}", degrees(view.phi_deg)) };
    let caption = joined(&[title, &format!("viewed at {}{azimuth}", degrees(view.theta_deg))]);
    let mut svg = Svg::new(width.max(420.0), HEAD + size + 24.0).titled(&caption);
    let drawn = Matrix { names: &result.subpixels, side };
    let out = ["Seen through each window (row):", "by the sub-pixel that it left (column)"];
    drawn.draw(&mut svg, (NAMES, HEAD), &view.shares.out, out);
    if let Some(shares) = &view.shares.in_ {
        let left = 2.0 * NAMES + size + 24.0;
        let entered = ["Light that reaches each sub-pixel (row):", "by the window where it entered (column)"];
        drawn.draw(&mut svg, (left, HEAD), shares, entered);
    }
    svg.finish()
}

struct Matrix<'a> {
    names: &'a [String],
    side: f64,
}

impl Matrix<'_> {
    fn draw(&self, svg: &mut Svg, (left, top): Point, shares: &[Vec<f64>], caption: [&str; 2]) {
        let side = self.side;
        for (line, text) in caption.into_iter().enumerate() {
            svg.text(
                (left - NAMES + 14.0, top - 66.0 + 16.0 * line as f64),
                text,
                Text::new(SMALL, INK).strong(),
            );
        }
        for (i, (name, row)) in self.names.iter().zip(shares).enumerate() {
            let middle = |k: usize| side * (k as f64 + 0.5);
            let own = shortened(name, NAMES - 24.0, SMALL);
            let style = Text::new(SMALL, INK).anchor(Anchor::End);
            svg.text((left - 8.0, top + middle(i) + 4.0), &own, style);
            let own = shortened(name, side, SMALL);
            let style = Text::new(SMALL, INK).anchor(Anchor::Middle);
            svg.text((left + middle(i), top - 10.0), &own, style);
            for (j, share) in row.iter().enumerate() {
                let at = (left + side * j as f64, top + side * i as f64);
                svg.rect(at, (side, side), 0.0, &viridis(share.clamp(0.0, 1.0)), "none");
                let ink = if *share > LIGHT { INK } else { "#ffffff" };
                let style = Text::new(SMALL, ink).anchor(Anchor::Middle);
                svg.text((left + middle(j), top + middle(i) + 4.0), &fixed(*share, 3), style);
            }
        }
    }
}
