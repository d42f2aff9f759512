//! Comparison of a simulated and a measured display: spectra as in Feng 2012, fig. 5.6, gamuts as in fig.
//! 5.7.

use papilio_display::compare::{
    Colour, Comparison, SIDES, SpectrumComparison, StateComparison, ViewComparison,
};

use crate::axis::Axis;
use crate::chromaticity;
use crate::diagram::Diagram;
use crate::labels::{EndLabel, end_labels};
use crate::overlay::legend;
use crate::panel::{Panel, SMALL};
use crate::place::Places;
use crate::style::{INK, degrees, joined, state_stroke};
use crate::svg::{Point, Stroke, Svg, Text};

/// Dash pattern of measured curves.
pub(crate) const MEASURED: &str = "6 3";
/// Half the width of a band, standard deviations.
const BAND: f64 = 2.0;
/// The panel of spectra, px.
const ORIGIN: Point = (70.0, 44.0);
const SIZE: Point = (540.0, 350.0);
/// The u'v' diagram, px.
const DIAGRAM: Point = (70.0, 44.0);
const WIDTH: f64 = 560.0;

/// Returns the states of a viewing direction, in order.
pub(crate) fn states_of<'a>(all: &'a Comparison, view: &ViewComparison) -> Vec<&'a StateComparison> {
    let (theta, phi) = (view.theta_deg, view.phi_deg);
    all.states.iter().filter(|one| one.theta_deg == theta && one.phi_deg == phi).collect()
}

pub(crate) fn caption(title: &str, view: &ViewComparison) -> String {
    let azimuth =
        if view.phi_deg == 0.0 { String::new() } else { format!(", azimuth {}", degrees(view.phi_deg)) };
    joined(&[title, &format!("viewed at {}{azimuth}", degrees(view.theta_deg))])
}

/// The edges of the bands of a spectrum.
pub(crate) fn sides(one: &SpectrumComparison) -> impl Iterator<Item = f64> {
    let of = |values: &[f64], deviations: &[f64]| -> Vec<f64> {
        let deviations = deviations.iter().copied().chain(std::iter::repeat(0.0));
        let both = values.iter().zip(deviations);
        both.flat_map(|(value, by)| [value - BAND * by, value + BAND * by]).collect()
    };
    let simulated = of(&one.simulated, &one.simulated_deviation);
    simulated.into_iter().chain(of(&one.measured, &one.measured_deviation))
}

/// Draws the simulated and measured reflectance factors of a viewing direction. Returns `None` if no spectrum
/// was measured there.
pub fn compared_spectra(all: &Comparison, view: &ViewComparison, title: &str) -> Option<String> {
    let states = states_of(all, view);
    let spectra: Vec<_> =
        states.iter().filter_map(|one| Some((&one.state, one.spectrum.as_ref()?))).collect();
    if spectra.is_empty() {
        return None;
    }
    let values = spectra.iter().flat_map(|(_, one)| sides(one));
    let y = Axis::covering(values.chain([0.0]), 6, "Reflectance factor");
    let nm = spectra.iter().flat_map(|(_, one)| one.wavelength_nm.iter().copied());
    let ends = [nm.clone().fold(f64::INFINITY, f64::min), nm.fold(f64::NEG_INFINITY, f64::max)];
    let mut svg = Svg::new(760.0, 460.0).titled(&caption(title, view));
    let panel = Panel { origin: ORIGIN, size: SIZE, x: Axis::between(&ends, 8, "Wavelength (nm)"), y };
    panel.draw(&mut svg);
    let mut labels = Vec::new();
    for (i, (name, one)) in spectra.iter().enumerate() {
        let stroke = Stroke::solid(&state_stroke(name, i).colour, 1.8);
        for (values, deviations) in
            [(&one.simulated, &one.simulated_deviation), (&one.measured, &one.measured_deviation)]
        {
            if !one.measured_deviation.is_empty() && deviations.iter().any(|deviation| *deviation > 0.0) {
                let at = |times: f64| {
                    let moved = values.iter().zip(deviations).map(|(value, by)| value + times * by);
                    panel.points(&one.wavelength_nm, &moved.collect::<Vec<f64>>())
                };
                let back = at(-BAND).into_iter().rev();
                svg.polygon(&at(BAND).into_iter().chain(back).collect::<Vec<Point>>(), &stroke.colour, 0.2);
            }
        }
        let points = panel.points(&one.wavelength_nm, &one.simulated);
        svg.polyline(&points, &stroke);
        let measured = panel.points(&one.wavelength_nm, &one.measured);
        svg.polyline(&measured, &stroke.clone().dashed(MEASURED));
        if let Some(&end) = points.iter().rev().find(|point| point.1.is_finite()) {
            labels.push(EndLabel { end, text: (*name).clone(), stroke, marks: false });
        }
    }
    end_labels(&mut svg, &panel, labels);
    legend(&mut svg, legend_entries());
    Some(svg.finish())
}

/// Draws the simulated and measured colours and gamuts of a viewing direction in the u'v' diagram.
pub fn compared_gamuts(all: &Comparison, view: &ViewComparison, title: &str) -> String {
    let states = states_of(all, view);
    let height = Diagram::Uv.height(WIDTH);
    let mut svg = Svg::new(WIDTH + 90.0, height + 130.0).titled(&caption(title, view));
    let panel = chromaticity::with_locus(&mut svg, Diagram::Uv, DIAGRAM, WIDTH);
    let uv = |colour: &Colour| Some((colour.u_prime?, colour.v_prime?));
    let mut triangles = Vec::new();
    for (side, dash) in SIDES.into_iter().zip(["", MEASURED]) {
        let at = |name: &str| uv(side(states.iter().find(|one| one.state == name)?));
        if let [Some(r), Some(g), Some(b)] = ["red", "green", "blue"].map(at) {
            panel.triangle(&mut svg, [r, g, b], &Stroke::solid(INK, 1.6).dashed(dash));
            triangles.push([r, g, b].map(|(u, v)| panel.at(u, v)));
        }
    }
    let points = |one: &StateComparison| SIDES.map(|side| uv(side(one)).map(|(u, v)| panel.at(u, v)));
    let marks = states.iter().flat_map(|one| points(one)).flatten();
    let mut places = Places::around(panel.origin, panel.size, marks);
    triangles.iter().for_each(|[a, b, c]| places.avoid(&[*a, *b, *c, *a]));
    for (i, one) in states.iter().enumerate() {
        let colour = state_stroke(&one.state, i).colour;
        let [simulated, measured] = points(one);
        if let Some(at) = simulated {
            svg.circle(at, 4.0, &colour, &Stroke::solid("#ffffff", 1.0));
        }
        if let Some(at) = measured {
            svg.circle(at, 4.0, "#ffffff", &Stroke::solid(&colour, 1.6));
        }
        if let Some((from, to)) = simulated.zip(measured) {
            svg.line(from, to, &Stroke::solid(&colour, 1.0));
        }
        if let Some(mark) = simulated.or(measured) {
            places.find(mark, &one.state, SMALL).write(&mut svg, &one.state, Text::new(SMALL, INK));
        }
    }
    legend(&mut svg, legend_entries());
    let percent = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.1}"));
    let [srgb, ebu] = [view.gamut_percent_srgb, view.gamut_percent_ebu].map(|sides| sides.map(percent));
    let note = format!(
        "gamut area in u\u{2032}v\u{2032}: {} % of sRGB, {} % of EBU simulated, {} % and {} % measured",
        srgb[0], ebu[0], srgb[1], ebu[1]
    );
    svg.text((panel.origin.0, panel.bottom() + 58.0), &note, Text::new(SMALL, INK));
    let marks = "discs: simulated, rings: measured";
    svg.text((panel.origin.0, panel.bottom() + 76.0), marks, Text::new(SMALL, INK));
    svg.finish()
}

pub(crate) fn legend_entries() -> impl Iterator<Item = (&'static str, Stroke)> {
    [("simulated", ""), ("measured", MEASURED)]
        .into_iter()
        .map(|(name, dash)| (name, Stroke::solid(INK, 1.8).dashed(dash)))
}
