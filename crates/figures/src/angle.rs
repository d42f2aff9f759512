//! Metrics against the viewing angle.

use papilio_display::result::{RunResult, State, StateValues, View};

use crate::axis::Axis;
use crate::labels::{EndLabel, end_labels, labels_inside};
use crate::panel::Panel;
use crate::style::{INK, degrees, joined, state_stroke};
use crate::svg::{Point, Stroke, Svg, finite};

/// A quantity drawn against the viewing angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleMetric {
    /// Luminance factor Y of every state.
    Reflectance,
    /// Contrast ratio: Y of white over Y of black.
    Contrast,
    /// Gamut area: % of sRGB and of EBU in u'v', and of NTSC in xy.
    Gamut,
    /// u'v' distance of every state from its colour at the smallest |theta|.
    ColourShift,
    /// Peak wavelength of the states that drive one sub-pixel.
    Peak,
}

impl AngleMetric {
    /// All metrics.
    pub const ALL: [Self; 5] =
        [Self::Reflectance, Self::Contrast, Self::Gamut, Self::ColourShift, Self::Peak];

    /// Returns the name used in file names: `reflectance`, `contrast`, `gamut`, `colour_shift`, `peak`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Reflectance => "reflectance",
            Self::Contrast => "contrast",
            Self::Gamut => "gamut",
            Self::ColourShift => "colour_shift",
            Self::Peak => "peak",
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Reflectance => "Luminance factor Y",
            Self::Contrast => "Contrast ratio",
            Self::Gamut => "Gamut area (% of)",
            Self::ColourShift => "Colour shift \u{394}u\u{2032}v\u{2032}",
            Self::Peak => "Peak wavelength (nm)",
        }
    }
}

/// Ratio of the largest to the smallest Y above which the axis is logarithmic.
const WIDE: f64 = 30.0;
/// Larger step of the peak wavelength between neighbouring angles (nm): a different peak has become the
/// highest.
const OTHER_ORDER_NM: f64 = 40.0;
/// Smallest upper end of the axis of u'v' distances, which are hardly visible below it. A display of constant
/// colour is then a flat line instead of rounding errors.
const UNSEEN_SHIFT: f64 = 0.005;

/// A value and its standard error.
type ValueAndError = (Option<f64>, Option<f64>);

/// A curve: angles, values and standard errors; NaN for undefined values.
#[derive(Debug)]
struct Series {
    name: String,
    stroke: Stroke,
    points: Vec<[f64; 3]>,
}

impl Series {
    /// Returns the angles (0), values (1) or errors (2).
    fn column(&self, i: usize) -> Vec<f64> {
        self.points.iter().map(|point| point[i]).collect()
    }

    /// Returns the points of the curve on the page.
    fn page_points(&self, panel: &Panel) -> Vec<Point> {
        self.points.iter().map(|[theta, value, _]| panel.at(*theta, *value)).collect()
    }
}

/// Draws a metric against the inclination of the view, with bars of one standard
/// error where they are visible. With several azimuths, the first is drawn.
/// Returns `None` if the metric is undefined at all angles (a gamut without primaries).
pub fn against_angle(result: &RunResult, metric: AngleMetric, title: &str) -> Option<String> {
    let azimuth = result.views.first()?.phi_deg;
    let mut views: Vec<&View> = result.views.iter().filter(|view| view.phi_deg == azimuth).collect();
    views.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
    let mut series = series(&views, metric, &result.primaries);
    series.retain(|one| one.points.iter().any(|[_, value, _]| value.is_finite()));
    if series.is_empty() {
        return None;
    }
    let one_of_several = views.len() < result.views.len() || azimuth != 0.0;
    let azimuth = if one_of_several { format!("azimuth {}", degrees(azimuth)) } else { String::new() };
    let mut svg = Svg::new(700.0, 420.0).titled(&joined(&[title, &azimuth]));
    let panel = Panel {
        origin: (76.0, 24.0),
        size: (470.0, 330.0),
        x: Axis::covering(views.iter().map(|view| view.theta_deg), 7, "Viewing angle (deg)"),
        y: value_axis(&series, metric),
    };
    draw(&mut svg, &panel, &series, metric);
    Some(svg.finish())
}

fn value_axis(series: &[Series], metric: AngleMetric) -> Axis {
    let points = || series.iter().flat_map(|s| &s.points).filter(|[_, value, _]| value.is_finite());
    if metric == AngleMetric::Reflectance {
        let values: Vec<f64> = points().map(|point| point[1]).collect();
        if let Some(axis) = Axis::logarithmic_beyond(WIDE, &values, metric.title()) {
            return axis;
        }
    }
    let extent = points().flat_map(|[_, value, error]| {
        let error = if error.is_finite() { *error } else { 0.0 };
        // An error bar alone does not extend the axis to negative values.
        [(value - error).max(value.min(0.0)), value + error]
    });
    let at_least: &[f64] = match metric {
        AngleMetric::Peak => &[],
        AngleMetric::ColourShift => &[0.0, UNSEEN_SHIFT],
        _ => &[0.0],
    };
    Axis::covering(extent.chain(at_least.iter().copied()), 6, metric.title())
}

fn draw(svg: &mut Svg, panel: &Panel, series: &[Series], metric: AngleMetric) {
    panel.draw(svg);
    let curves: Vec<Vec<Point>> = series.iter().map(|one| one.page_points(panel)).collect();
    let (mut outside, mut inside, mut lines, mut barred) = (vec![], vec![], vec![], false);
    for (one, points) in series.iter().zip(&curves) {
        let pieces = pieces(points, &one.column(1), metric);
        for piece in &pieces {
            svg.polyline(piece, &one.stroke);
        }
        if points.len() <= 40 {
            for &point in points {
                svg.circle(point, 2.6, &one.stroke.colour, &Stroke::solid("#ffffff", 0.8));
            }
        }
        barred |= panel.error_bars(svg, &one.column(0), &one.column(1), &one.column(2), &one.stroke);
        let (end, reaches_last_angle) = end_of(points, &pieces);
        let label = EndLabel { end, text: one.name.clone(), stroke: one.stroke.clone(), marks: false };
        if reaches_last_angle {
            outside.push(label)
        } else {
            inside.push(label)
        }
        lines.extend(pieces);
    }
    if barred {
        panel.note(svg, "bars: \u{b1} one standard error");
    }
    end_labels(svg, panel, outside);
    labels_inside(svg, panel, &inside, &lines);
}

/// Splits a curve where it is discontinuous. A line between peaks of two orders of interference would suggest
/// peaks in between, which do not exist.
fn pieces<'a>(points: &'a [Point], values: &[f64], metric: AngleMetric) -> Vec<&'a [Point]> {
    let jump = |i: &usize| {
        let step = (values[*i] - values[i - 1]).abs();
        !step.is_finite() || (metric == AngleMetric::Peak && step > OTHER_ORDER_NM)
    };
    let mut cuts: Vec<usize> = (1..points.len()).filter(jump).collect();
    cuts.insert(0, 0);
    cuts.push(points.len());
    cuts.windows(2).map(|cut| &points[cut[0]..cut[1]]).collect()
}

/// Returns the position of a curve's label (the end of its longest piece), and whether that is the last
/// angle.
fn end_of(points: &[Point], pieces: &[&[Point]]) -> (Point, bool) {
    let longest = pieces.iter().max_by_key(|piece| piece.len());
    let drawn = longest.and_then(|piece| piece.iter().rev().find(|point| finite(**point)));
    let end = drawn.copied().unwrap_or((f64::NAN, f64::NAN));
    (end, points.last().is_some_and(|last| last.0 == end.0))
}

fn series(views: &[&View], metric: AngleMetric, primaries: &[String]) -> Vec<Series> {
    let of_view = |name: &str, stroke, value: fn(&View) -> ValueAndError| Series {
        name: name.to_owned(),
        stroke,
        points: views.iter().map(|view| point(view.theta_deg, value(view))).collect(),
    };
    let ink = || Stroke::solid(INK, 2.0);
    match metric {
        AngleMetric::Contrast => {
            vec![of_view("white / black", ink(), |v| {
                (v.metrics.contrast_ratio, v.standard_error.contrast_ratio)
            })]
        }
        AngleMetric::Gamut => vec![
            of_view("sRGB, u\u{2032}v\u{2032}", ink(), |v| {
                (v.metrics.gamut_percent_srgb, v.standard_error.gamut_percent_srgb)
            }),
            of_view("EBU, u\u{2032}v\u{2032}", ink().dashed("1.5 3"), |v| {
                (v.metrics.gamut_percent_ebu, v.standard_error.gamut_percent_ebu)
            }),
            of_view("NTSC, xy", ink().dashed("6 3"), |v| {
                (v.metrics.gamut_percent_ntsc_xy, v.standard_error.gamut_percent_ntsc_xy)
            }),
        ],
        AngleMetric::Reflectance => by_state(views, |state, _| value_and_error(state, |v| Some(v.Y))),
        AngleMetric::Peak => {
            let mut all = by_state(views, |state, _| value_and_error(state, |v| v.peak_nm));
            // The peak of a mixture of sub-pixels jumps between those of its parts.
            all.retain(|one| primaries.contains(&one.name));
            all
        }
        AngleMetric::ColourShift => by_state(views, shift),
    }
}

fn point(theta: f64, (value, error): ValueAndError) -> [f64; 3] {
    [theta, value.unwrap_or(f64::NAN), error.unwrap_or(f64::NAN)]
}

fn value_and_error(state: &State, pick: fn(&StateValues) -> Option<f64>) -> ValueAndError {
    (pick(&state.value), pick(&state.standard_error))
}

/// Returns a curve for each state; `value` also gets the same state in the view of smallest |theta|.
fn by_state(views: &[&View], value: fn(&State, &State) -> ValueAndError) -> Vec<Series> {
    let smallest = views.iter().min_by(|a, b| a.theta_deg.abs().total_cmp(&b.theta_deg.abs()));
    let Some(smallest) = smallest else { return vec![] };
    let curve = |(i, (name, reference)): (usize, (&str, &State))| {
        let at = |view: &&View| {
            let state = view.states.get(name)?;
            Some(point(view.theta_deg, value(state, reference)))
        };
        Series {
            name: name.to_owned(),
            stroke: state_stroke(name, i),
            points: views.iter().filter_map(at).collect(),
        }
    };
    smallest.states.iter().enumerate().map(curve).collect()
}

/// Returns the u'v' distance between a state at two angles. The error assumes that the two views are
/// independent.
fn shift(state: &State, reference: &State) -> ValueAndError {
    let uv = |v: &StateValues| Some((v.u_prime?, v.v_prime?));
    let (Some(here), Some(there)) = (uv(&state.value), uv(&reference.value)) else { return (None, None) };
    let (du, dv) = (here.0 - there.0, here.1 - there.1);
    let distance = du.hypot(dv);
    let error = |s: &State| {
        uv(&s.standard_error).map(|(su, sv)| ((du * su).powi(2) + (dv * sv).powi(2)) / distance.powi(2))
    };
    let error = error(state).zip(error(reference)).map(|(a, b)| (a + b).sqrt());
    (Some(distance), error)
}
