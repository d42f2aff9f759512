//! Gamut rings: the gamut volume in CIELAB as areas in a plane (IDMS 1.1).

use std::f64::consts::TAU;

use papilio_colour::{CORNERS, Corners, HUES, RINGS, Xy, Xyz};
use papilio_display::result::{ReferenceWhite, RunResult, View};

use crate::axis::Axis;
use crate::panel::{Panel, SMALL};
use crate::style::{INK, caption, ramp};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};

/// The panel, px.
const ORIGIN: Point = (80.0, 44.0);
const SIDE: f64 = 480.0;

/// Draws the gamut rings of a view whose gamut volume was requested. The area within each ring, in each hue, is the
/// volume below the lightness of the ring. Returns `None` if the result has no volume.
pub fn gamut_rings(result: &RunResult, view: &View, title: &str) -> Option<String> {
    let volume = view.metrics.gamut_volume_cielab.filter(|volume| volume.is_finite())?;
    let white = match result.reference_white {
        ReferenceWhite::Perfect => {
            Xy { x: result.illuminant.x, y: result.illuminant.y }.with_luminance(1.0)?
        }
        ReferenceWhite::Display => {
            let white = &view.states.get("white")?.value;
            Xyz { x: white.X, y: white.Y, z: white.Z }
        }
    };
    let mut corners = Corners { xyz: [white; 8] };
    for (corner, name) in corners.xyz.iter_mut().zip(CORNERS) {
        let value = &view.states.get(name)?.value;
        *corner = Xyz { x: value.X, y: value.Y, z: value.Z };
    }
    let rings = corners.solid(white)?.rings();
    let reach = rings.iter().flatten().copied().fold(1.0, f64::max);
    let axis = |title| Axis::covering([-reach, reach], 6, title);
    let mut svg = Svg::new(ORIGIN.0 + SIDE + 130.0, ORIGIN.1 + SIDE + 70.0).titled(&caption(title, view));
    let panel = Panel {
        origin: ORIGIN,
        size: (SIDE, SIDE),
        x: axis("towards a* (ring)"),
        y: axis("towards b* (ring)"),
    };
    panel.draw(&mut svg);
    for (k, ring) in rings.iter().enumerate().rev() {
        let stroke = Stroke::solid(&ramp(k as f64 / RINGS as f64), if k + 1 == RINGS { 2.0 } else { 1.2 });
        let at = |(hue, radius): (usize, &f64)| {
            let (sin, cos) = (TAU * (hue as f64 + 0.5) / HUES as f64).sin_cos();
            panel.at(radius * cos, radius * sin)
        };
        svg.outline(&ring.iter().enumerate().map(at).collect::<Vec<_>>(), &stroke);
        let y = ORIGIN.1 + 14.0 + 18.0 * (RINGS - 1 - k) as f64;
        let left = panel.right() + 16.0;
        svg.line((left, y - 4.0), (left + 24.0, y - 4.0), &stroke);
        let name = format!("L* {}", (k + 1) * 100 / RINGS);
        svg.text((left + 30.0, y), &name, Text::new(SMALL, INK));
    }
    let note = format!("volume {volume:.0} (sRGB: 819000)");
    svg.text((panel.right(), ORIGIN.1 - 8.0), &note, Text::new(SMALL, INK).anchor(Anchor::End));
    Some(svg.finish())
}
