//! How sharp a display is: modulation transfer, edges, and the kernel as a picture.

use papilio_display::spatial::{MtfResult, MtfState, MtfView};

use crate::axis::Axis;
use crate::colour_map::viridis;
use crate::file_names;
use crate::labels::{EndLabel, end_labels};
use crate::panel::{Panel, SMALL};
use crate::style::{INK, SOFT, degrees, joined, state_stroke};
use crate::svg::{Anchor, Point, Stroke, Svg, Text};

/// Size of a panel and distance between two, px.
const PANEL: Point = (360.0, 300.0);
const LEFT: f64 = 70.0;
const TOP: f64 = 34.0;
const APART: f64 = 60.0;
/// Room for the labels at the ends of curves, px.
const LABELS: f64 = 150.0;

/// Side of the picture of a kernel, px, and its smallest value relative to the largest.
const PICTURE: f64 = 455.0;
const FAINTEST: f64 = 1e-5;

/// Returns the figures of a result with the names of their files, without ending.
pub fn of_mtf(result: &MtfResult, title: &str) -> Vec<(String, String)> {
    let mut all = Vec::new();
    for view in &result.views {
        let at = if result.views.len() > 1 {
            papilio_display::view_in_name(view.theta_deg, view.phi_deg)
        } else {
            String::new()
        };
        let caption = caption(title, view);
        all.push((format!("mtf{at}"), transfer(result, view, &caption)));
        let with_places: Vec<(&str, &MtfState)> =
            view.states.iter().filter(|(_, state)| state.kernel.cells > 0).collect();
        if !with_places.is_empty() {
            all.push((format!("edges{at}"), edges(result, view, &caption)));
        }
        let files = file_names(with_places.iter().map(|(name, _)| *name), "kernel-", &at);
        for ((name, state), file) in with_places.into_iter().zip(files) {
            all.push((file, kernel(result, name, state, &caption)));
        }
    }
    all
}

fn caption(title: &str, view: &MtfView) -> String {
    let azimuth =
        if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {}", degrees(view.phi_deg)) };
    joined(&[title, &format!("viewed at {}{azimuth}", degrees(view.theta_deg))])
}

/// Page with a panel for each axis.
fn pair(title: &str, draw: impl Fn(&mut Svg, usize, Point) -> (Panel, Vec<EndLabel>)) -> String {
    let width = LEFT + 2.0 * PANEL.0 + APART + LABELS;
    let mut svg = Svg::new(width, TOP + PANEL.1 + 52.0).titled(title);
    for axis in [0, 1] {
        let origin = (LEFT + axis as f64 * (PANEL.0 + APART), TOP);
        let (panel, labels) = draw(&mut svg, axis, origin);
        let name = ["along x", "along y"][axis];
        svg.text((origin.0, origin.1 - 10.0), name, Text::new(SMALL, INK).strong());
        if axis == 1 {
            end_labels(&mut svg, &panel, labels);
        }
    }
    svg.finish()
}

/// Modulation transfer of each state along x and y.
fn transfer(result: &MtfResult, view: &MtfView, title: &str) -> String {
    let frequencies = &result.frequency_per_mm;
    let end = frequencies.last().copied().unwrap_or(1.0);
    pair(title, |svg, axis, origin| {
        let y = Axis::exact(0.0, 1.0, 5, if axis == 0 { "Modulation transfer" } else { "" });
        let x = Axis::exact(0.0, end, 6, "Spatial frequency (cycles per mm)");
        let panel = Panel { origin, size: PANEL, x, y };
        panel.draw(svg);
        let nyquist = result.nyquist_per_mm.map(|nyquist| (nyquist[axis], "Nyquist"));
        for (at, name) in nyquist.into_iter().chain(result.eye_limit_per_mm.map(|limit| (limit, "eye"))) {
            if at < end {
                // Next to each other, the two names are on different sides.
                let nyquist = result.nyquist_per_mm.map(|nyquist| nyquist[axis]);
                let other = if name == "eye" { nyquist } else { result.eye_limit_per_mm };
                let is_left = other.is_some_and(|other| at < other);
                mark(svg, &panel, at, name, if is_left { Anchor::End } else { Anchor::Start });
            }
        }
        let mut labels = Vec::new();
        for (number, (name, state)) in view.states.iter().enumerate() {
            let otf = if axis == 0 { &state.otf.otf_x } else { &state.otf.otf_y };
            let points: Vec<Point> =
                frequencies.iter().zip(otf).map(|(f, [re, im])| panel.at(*f, re.hypot(*im))).collect();
            let stroke = state_stroke(name, number);
            svg.polyline(&points, &stroke);
            let end = points.last().copied().unwrap_or((f64::NAN, f64::NAN));
            labels.push(EndLabel { end, text: name.to_owned(), stroke, marks: false });
        }
        (panel, labels)
    })
}

/// Vertical line with a name above the panel.
fn mark(svg: &mut Svg, panel: &Panel, at: f64, name: &str, anchor: Anchor) {
    let x = panel.at(at, panel.y.min()).0;
    svg.line((x, panel.origin.1), (x, panel.bottom()), &Stroke::solid(SOFT, 1.4).dashed("4 3"));
    svg.text((x, panel.origin.1 - 6.0), name, Text::new(11.0, "#777777").anchor(anchor));
}

/// Profile of an edge, dark on the left, for each state along x and y.
fn edges(result: &MtfResult, view: &MtfView, title: &str) -> String {
    let half = view.states.iter().map(|(_, state)| 0.5 * state.kernel.cell_um * state.kernel.cells as f64);
    let half = half.fold(0.0, f64::max);
    pair(title, |svg, axis, origin| {
        let y = Axis::exact(0.0, 1.0, 5, if axis == 0 { "Light, relative to far inside" } else { "" });
        let x = Axis::exact(-half, half, 6, "Distance from the edge (μm)");
        let panel = Panel { origin, size: PANEL, x, y };
        panel.draw(svg);
        if let Some(pitch) = result.pitch_um {
            let (x, y) = (panel.at(-0.5 * pitch[axis], 0.0).0, panel.at(0.5 * pitch[axis], 0.0).0);
            [x, y].iter().for_each(|x| {
                svg.line((*x, panel.origin.1), (*x, panel.bottom()), &Stroke::solid(SOFT, 1.0).dashed("2 3"));
            });
            let style = Text::new(11.0, "#777777").anchor(Anchor::Middle);
            svg.text((0.5 * (x + y), panel.origin.1 - 6.0), "1 pixel", style);
        }
        let mut labels = Vec::new();
        for (number, (name, state)) in view.states.iter().enumerate() {
            let Some(table) = state.spread.iter().find(|table| table.light == "all" && table.axis == axis)
            else {
                continue;
            };
            let places = table.position_um.iter().zip(&table.edge_spread);
            let all: Vec<(f64, f64)> = places.map(|(x, y)| (*x, *y)).collect();
            let points: Vec<Point> = within(&all, half).into_iter().map(|(x, y)| panel.at(x, y)).collect();
            let stroke = state_stroke(name, number);
            svg.polyline(&points, &stroke);
            let end = points.last().copied().unwrap_or((f64::NAN, f64::NAN));
            labels.push(EndLabel { end, text: name.to_owned(), stroke, marks: false });
        }
        (panel, labels)
    })
}

/// Points of a line within `half` of 0, and where it leaves this range.
fn within(points: &[(f64, f64)], half: f64) -> Vec<(f64, f64)> {
    let mut inside = Vec::new();
    for pair in points.windows(2) {
        let ((x0, y0), (x1, y1)) = (pair[0], pair[1]);
        let at = |x: f64| (x, y0 + (y1 - y0) * (x - x0) / (x1 - x0));
        inside.extend((x0 < -half && x1 > -half).then(|| at(-half)));
        inside.extend((x0.abs() <= half).then_some((x0, y0)));
        inside.extend((x0 < half && x1 > half).then(|| at(half)));
    }
    inside
}

/// Kernel of a state on a logarithmic scale of colours, with bars of a round length and of a pixel.
fn kernel(result: &MtfResult, name: &str, state: &MtfState, title: &str) -> String {
    let kernel = &state.kernel;
    let mut svg =
        Svg::new(PICTURE + 190.0, PICTURE + 70.0).titled(&joined(&[title, &format!("kernel of {name}")]));
    let origin = (20.0, 16.0);
    let most = kernel.fractions.iter().copied().fold(0.0, f64::max);
    let side = PICTURE / kernel.cells.max(1) as f64;
    let level = |fraction: f64| {
        if most > 0.0 && fraction > 0.0 { 1.0 - (fraction / most).log10() / FAINTEST.log10() } else { 0.0 }
    };
    for (cell, fraction) in kernel.fractions.iter().enumerate() {
        let (column, row) = (cell % kernel.cells, cell / kernel.cells);
        let x = origin.0 + side * column as f64;
        let y = origin.1 + side * (kernel.cells - 1 - row) as f64;
        // A little larger, so that no seams are visible.
        let corners = [(x, y), (x + side + 0.4, y), (x + side + 0.4, y + side + 0.4), (x, y + side + 0.4)];
        svg.polygon(&corners, &viridis(level(*fraction).clamp(0.0, 1.0)), 1.0);
    }
    let px_per_um = side / kernel.cell_um;
    let bottom = origin.1 + PICTURE;
    let length = round_length(0.3 * PICTURE / px_per_um);
    bar(&mut svg, (origin.0, bottom + 18.0), length * px_per_um, &format!("{length} μm"));
    if let Some([pitch, _]) = result.pitch_um {
        bar(&mut svg, (origin.0 + 0.5 * PICTURE, bottom + 18.0), pitch * px_per_um, "1 pixel");
    }
    legend(&mut svg, (origin.0 + PICTURE + 28.0, origin.1 + 14.0), most);
    let outside = format!("outside: {:.1} %", 100.0 * kernel.outside.max(0.0));
    svg.text((origin.0 + PICTURE + 28.0, bottom - 4.0), &outside, Text::new(SMALL, INK));
    svg.finish()
}

/// Horizontal bar with a text below it.
fn bar(svg: &mut Svg, (x, y): Point, length: f64, text: &str) {
    let stroke = Stroke::solid(INK, 2.0);
    svg.line((x, y), (x + length, y), &stroke);
    for end in [x, x + length] {
        svg.line((end, y - 4.0), (end, y + 4.0), &stroke);
    }
    svg.text((x, y + 20.0), text, Text::new(SMALL, INK));
}

/// The largest of 1, 2 and 5 times a power of ten that is at most this length.
fn round_length(length: f64) -> f64 {
    let power = 10.0_f64.powf(length.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|step| step * power).find(|round| *round <= length).unwrap_or(power)
}

/// Scale of colours, as the fraction of the light in a cell.
fn legend(svg: &mut Svg, (x, y): Point, most: f64) {
    const STEPS: usize = 60;
    const HEIGHT: f64 = 240.0;
    let step = HEIGHT / STEPS as f64;
    for k in 0..STEPS {
        let top = y + step * k as f64;
        let corners = [(x, top), (x + 16.0, top), (x + 16.0, top + step + 0.4), (x, top + step + 0.4)];
        svg.polygon(&corners, &viridis(1.0 - (k as f64 + 0.5) / STEPS as f64), 1.0);
    }
    svg.text((x, y - 8.0), "light in a cell", Text::new(SMALL, INK));
    let decades = -FAINTEST.log10();
    for k in 0..=decades as i32 {
        let value = 100.0 * most * 10.0_f64.powi(-k);
        let at = y + HEIGHT * f64::from(k) / decades + 4.0;
        let text = if value >= 0.01 { format!("{value:.2} %") } else { format!("{value:.0e} %") };
        svg.text((x + 22.0, at), &text, Text::new(SMALL, INK));
    }
}
