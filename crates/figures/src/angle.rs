//! Metrics against the viewing angle.

use papilio_display::result::{RunResult, State, StateValues, View};

use crate::panel::{Axis, EndLabel, Panel, end_labels};
use crate::style::{INK, state_stroke};
use crate::svg::{Point, Stroke, Svg};

/// What is drawn against the viewing angle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleMetric {
    /// Luminous reflectance factor Y of every state.
    Reflectance,
    /// White's Y over black's.
    Contrast,
    /// Gamut area, % of sRGB and of EBU.
    Gamut,
    /// u'v' distance of every state from where it is at the smallest angle.
    ColourShift,
    /// Peak wavelength of every state that has one.
    Peak,
}

impl AngleMetric {
    /// All of them.
    pub const ALL: [Self; 5] =
        [Self::Reflectance, Self::Contrast, Self::Gamut, Self::ColourShift, Self::Peak];

    /// A name for files: `reflectance`, `contrast`, `gamut`, `colour_shift`, `peak`.
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
            Self::Reflectance => "Luminous reflectance factor Y",
            Self::Contrast => "Contrast ratio",
            Self::Gamut => "Gamut area in u\u{2032}v\u{2032} (%)",
            Self::ColourShift => "Colour shift \u{394}u\u{2032}v\u{2032}",
            Self::Peak => "Peak wavelength (nm)",
        }
    }
}

/// A value and its standard error.
type Measured = (Option<f64>, Option<f64>);

/// One curve: angles, values and standard errors; NaN where something is not defined.
#[derive(Debug)]
struct Series {
    name: String,
    stroke: Stroke,
    points: Vec<[f64; 3]>,
}

/// A metric against the inclination of the view, with bars of one standard
/// error where they can be seen. Of several azimuths the first is drawn.
pub fn against_angle(result: &RunResult, metric: AngleMetric) -> String {
    let mut views: Vec<&View> = result.views.iter().collect();
    if let Some(first) = result.views.first() {
        views.retain(|view| view.phi_deg == first.phi_deg);
    }
    views.sort_by(|a, b| a.theta_deg.total_cmp(&b.theta_deg));
    let series = series(&views, metric);
    let mut svg = Svg::new(700.0, 420.0);
    draw(&mut svg, &series, metric, views.iter().map(|view| view.theta_deg));
    svg.finish()
}

fn draw(svg: &mut Svg, series: &[Series], metric: AngleMetric, thetas: impl Iterator<Item = f64>) {
    let defined = series.iter().flat_map(|s| &s.points).filter(|[_, value, _]| value.is_finite());
    let extent = defined.flat_map(|[_, value, error]| {
        let error = if error.is_finite() { *error } else { 0.0 };
        // An error bar alone is no reason to show negative values.
        [(value - error).max(value.min(0.0)), value + error]
    });
    let from_zero = (metric != AngleMetric::Peak).then_some(0.0);
    let panel = Panel {
        origin: (76.0, 24.0),
        size: (470.0, 330.0),
        x: Axis::covering(thetas, 7, "Viewing angle (deg)"),
        y: Axis::covering(extent.chain(from_zero), 6, metric.title()),
    };
    panel.draw(svg);
    let (mut labels, mut barred) = (vec![], false);
    for one in series {
        let column = |i: usize| -> Vec<f64> { one.points.iter().map(|point| point[i]).collect() };
        let (theta, value, error) = (column(0), column(1), column(2));
        let points: Vec<Point> = panel.points(&theta, &value);
        svg.polyline(&points, &one.stroke);
        if points.len() <= 40 {
            for &point in &points {
                svg.circle(point, 2.6, &one.stroke.colour, &Stroke::solid("#ffffff", 0.8));
            }
        }
        barred |= panel.error_bars(svg, &theta, &value, &error, &one.stroke);
        if let Some(&end) = points.iter().rev().find(|point| point.1.is_finite()) {
            labels.push(EndLabel { end, text: one.name.clone(), stroke: one.stroke.clone() });
        }
    }
    if barred {
        panel.note(svg, "bars: \u{b1} one standard error");
    }
    end_labels(svg, &panel, labels);
}

fn series(views: &[&View], metric: AngleMetric) -> Vec<Series> {
    let whole = |name: &str, stroke, value: fn(&View) -> Measured| Series {
        name: name.to_owned(),
        stroke,
        points: views.iter().map(|view| point(view.theta_deg, value(view))).collect(),
    };
    let ink = || Stroke::solid(INK, 2.0);
    match metric {
        AngleMetric::Contrast => {
            vec![whole("white : black", ink(), |v| (v.contrast_ratio, v.standard_error.contrast_ratio))]
        }
        AngleMetric::Gamut => vec![
            whole("of sRGB", ink(), |v| (v.gamut_percent_srgb, v.standard_error.gamut_percent_srgb)),
            whole("of EBU", ink().dashed("1.5 3"), |v| {
                (v.gamut_percent_ebu, v.standard_error.gamut_percent_ebu)
            }),
        ],
        AngleMetric::Reflectance => by_state(views, |state, _| both(state, |v| Some(v.Y))),
        AngleMetric::Peak => by_state(views, |state, _| both(state, |v| v.peak_nm)),
        AngleMetric::ColourShift => by_state(views, shift),
    }
}

fn point(theta: f64, (value, error): Measured) -> [f64; 3] {
    [theta, value.unwrap_or(f64::NAN), error.unwrap_or(f64::NAN)]
}

fn both(state: &State, pick: fn(&StateValues) -> Option<f64>) -> Measured {
    (pick(&state.value), pick(&state.standard_error))
}

/// A curve for each state of the first view; `value` also gets the state as seen at the smallest angle.
fn by_state(views: &[&View], value: fn(&State, &State) -> Measured) -> Vec<Series> {
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
    let mut series: Vec<Series> = smallest.states.iter().enumerate().map(curve).collect();
    series.retain(|one| one.points.iter().any(|[_, value, _]| value.is_finite()));
    series
}

/// u'v' distance between a state and itself at another angle; the error takes the two views as independent.
fn shift(state: &State, reference: &State) -> Measured {
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
