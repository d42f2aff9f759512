//! Predicted and measured metrics of a display, or of several: a panel for each metric, a row for each state.

use papilio_display::compare::MetricComparison;
use papilio_display::{label_from_name, metric_label};

use crate::axis::Axis;
use crate::panel::{Panel, SMALL};
use crate::style::INK;
use crate::svg::{Anchor, Stroke, Svg, Text, shortened, text_width};

/// Colour of simulated values.
const SIMULATED: &str = "#2b5fc7";
/// Half the length of a bar, standard deviations.
const BAR: f64 = 2.0;
/// Height of a row, width of a panel, and the space between and around panels, px.
const ROW: f64 = 26.0;
const WIDTH: f64 = 300.0;
const GAP: f64 = 36.0;
const TOP: f64 = 40.0;
/// Least width beside the names of rows: that of the legend.
const LEGEND: f64 = 440.0;
/// Largest width of the names of rows, px.
const NAMES: f64 = 220.0;

/// Draws simulated and measured metrics with bars of two standard deviations. Returns `None` if there are no metrics.
pub fn compared_metrics<'a>(
    all: impl IntoIterator<Item = &'a MetricComparison>,
    title: &str,
) -> Option<String> {
    let all: Vec<&MetricComparison> = all.into_iter().collect();
    let (mut metrics, mut rows) = (Vec::new(), Vec::new());
    for one in &all {
        let (row, metric) = parts(one);
        if !metrics.contains(&metric) {
            metrics.push(metric);
        }
        if !rows.contains(&row) {
            rows.push(row);
        }
    }
    if metrics.is_empty() {
        return None;
    }
    let longest = rows.iter().map(|row| text_width(row, SMALL)).fold(0.0, f64::max);
    let left = (longest + 24.0).clamp(44.0, NAMES);
    let block = ROW * rows.len() as f64;
    let width = left + metrics.len() as f64 * (WIDTH + GAP);
    let mut svg = Svg::new(width.max(left + LEGEND), TOP + block + 50.0).titled(title);
    marks(&mut svg, left);
    for (k, row) in rows.iter().enumerate() {
        let place = (left - 9.0, TOP + ROW * (k as f64 + 0.5) + 4.0);
        svg.text(place, &shortened(row, left - 14.0, SMALL), Text::new(SMALL, INK).anchor(Anchor::End));
    }
    for (number, metric) in metrics.iter().enumerate() {
        let own: Vec<&MetricComparison> = all.iter().copied().filter(|one| parts(one).1 == *metric).collect();
        let ends = own.iter().flat_map(|one| {
            let of = |value: f64, by: f64| [value - BAR * by, value + BAR * by];
            let simulated = of(one.simulated, one.simulated_deviation);
            simulated.into_iter().chain(of(one.measured, one.measured_deviation.unwrap_or(0.0)))
        });
        let name = metric_label(metric).unwrap_or_else(|| label_from_name(metric)).to_string();
        let panel = Panel {
            origin: (left + number as f64 * (WIDTH + GAP), TOP),
            size: (WIDTH, block),
            x: Axis::covering(ends, 5, &name),
            y: Axis::marked((0.0, rows.len() as f64), vec![], "", false),
        };
        panel.draw(&mut svg);
        for one in own {
            let row = rows.iter().position(|row| *row == parts(one).0).unwrap_or(0);
            let y = rows.len() as f64 - row as f64 - 0.5;
            mark(
                &mut svg,
                &panel,
                (one.measured, y - 0.18),
                one.measured_deviation.unwrap_or(0.0),
                INK,
                "#ffffff",
            );
            mark(&mut svg, &panel, (one.simulated, y + 0.18), one.simulated_deviation, SIMULATED, SIMULATED);
        }
    }
    Some(svg.finish())
}

/// The row and the metric: the name of the state, with the direction of the view unless that is the normal.
fn parts(one: &MetricComparison) -> (String, String) {
    let (state, metric) = one.metric.rsplit_once('.').unwrap_or(("", &one.metric));
    let view = match (one.theta_deg, one.phi_deg) {
        (0.0, _) => String::new(),
        (theta, 0.0) => format!("{theta} deg"),
        (theta, phi) => format!("{theta} deg, azimuth {phi} deg"),
    };
    let row = [state, &view].into_iter().filter(|part| !part.is_empty()).collect::<Vec<_>>().join(", ");
    (row, metric.to_owned())
}

fn mark(svg: &mut Svg, panel: &Panel, at: (f64, f64), deviation: f64, colour: &str, fill: &str) {
    panel.error_bar_across(svg, at, BAR * deviation, &Stroke::solid(colour, 1.4));
    svg.circle(panel.at(at.0, at.1), 4.0, fill, &Stroke::solid(colour, 1.6));
}

/// The legend.
fn marks(svg: &mut Svg, left: f64) {
    let y = TOP - 16.0;
    svg.circle((left + 5.0, y - 4.0), 4.0, SIMULATED, &Stroke::solid(SIMULATED, 1.6));
    svg.text((left + 15.0, y), "simulated", Text::new(SMALL, INK));
    svg.circle((left + 91.0, y - 4.0), 4.0, "#ffffff", &Stroke::solid(INK, 1.6));
    svg.text((left + 101.0, y), "measured", Text::new(SMALL, INK));
    svg.line((left + 168.0, y - 4.0), (left + 196.0, y - 4.0), &Stroke::solid(INK, 1.4));
    svg.text((left + 202.0, y), "\u{b1} two standard deviations", Text::new(SMALL, INK));
}
