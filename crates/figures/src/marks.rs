//! Marks of the states and the light in the u'v' diagram.

use papilio_colour::UvPrime;
use papilio_display::result::{RunResult, View};

use crate::paint::Paint;
use crate::panel::{Panel, SMALL};
use crate::place::Places;
use crate::style::INK;
use crate::svg::{Point, Stroke, Svg, Text};

/// Sides of the windows that are enlarged, in u' and v'.
const WINDOWS: [f64; 4] = [0.01, 0.02, 0.05, 0.08];

/// The marks in a diagram.
#[derive(Debug)]
pub(crate) struct Marks {
    states: Vec<State>,
    light: Option<UvPrime>,
}

#[derive(Debug)]
struct State {
    name: String,
    at: UvPrime,
    error: UvPrime,
    fill: String,
}

/// A square part of the diagram.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) middle: UvPrime,
    pub(crate) side: f64,
}

impl Marks {
    /// Returns the marks of the states of a view and of the light that lie within the diagram
    /// (noise can move a black state out of it).
    pub(crate) fn of(result: &RunResult, view: &View, diagram: &Panel) -> Self {
        let paint = Paint::of(result, view);
        let inside = |uv: &UvPrime| diagram.x.contains(uv.u) && diagram.y.contains(uv.v);
        let states = view.states.iter().filter_map(|(name, state)| {
            let (value, error) = (&state.value, &state.standard_error);
            Some(State {
                name: name.to_owned(),
                at: Some(UvPrime { u: value.u_prime?, v: value.v_prime? }).filter(inside)?,
                error: UvPrime { u: error.u_prime.unwrap_or(f64::NAN), v: error.v_prime.unwrap_or(f64::NAN) },
                fill: paint.colour(value),
            })
        });
        let light = UvPrime { u: result.illuminant.u_prime, v: result.illuminant.v_prime };
        Self { states: states.collect(), light: Some(light).filter(inside) }
    }

    /// Returns the window around the marks, if they are close enough together to be enlarged.
    pub(crate) fn crowded(&self) -> Option<Window> {
        let all = || self.states.iter().map(|state| state.at).chain(self.light);
        let range = |of: fn(UvPrime) -> f64| {
            let start = (f64::INFINITY, f64::NEG_INFINITY);
            all().map(of).fold(start, |(min, max), v| (min.min(v), max.max(v)))
        };
        let (u, v) = (range(|uv| uv.u), range(|uv| uv.v));
        let extent = (u.1 - u.0).max(v.1 - v.0);
        let side = WINDOWS.into_iter().find(|side| *side >= 1.6 * extent)?;
        let middle = UvPrime { u: (u.0 + u.1) / 2.0, v: (v.0 + v.1) / 2.0 };
        (all().count() > 1).then_some(Window { middle, side })
    }

    /// Draws discs and error crosses of the states, and above them the cross of the light, which a state would hide.
    pub(crate) fn draw(&self, svg: &mut Svg, panel: &Panel) {
        let line = Stroke::solid(INK, 1.2);
        for State { at, error, fill, .. } in &self.states {
            panel.error_bars(svg, &[at.u], &[at.v], &[error.v], &line);
            panel.error_bar_across(svg, (at.u, at.v), error.u, &line);
            let centre = panel.at(at.u, at.v);
            svg.circle(centre, 5.5, fill, &Stroke::solid("#ffffff", 3.0));
            svg.circle(centre, 5.5, fill, &line);
        }
        if let Some(light) = self.light {
            let (x, y) = panel.at(light.u, light.v);
            // A white outline makes the cross visible on a dark disc.
            for stroke in [Stroke::solid("#ffffff", 3.6), Stroke::solid(INK, 1.4)] {
                svg.line((x - 5.0, y), (x + 5.0, y), &stroke);
                svg.line((x, y - 5.0), (x, y + 5.0), &stroke);
            }
        }
    }

    /// Draws the names, clear of each other and of the sides of the triangles.
    pub(crate) fn name(&self, svg: &mut Svg, panel: &Panel, triangles: &[Option<[UvPrime; 3]>]) {
        let at = |uv: UvPrime| panel.at(uv.u, uv.v);
        let states = self.states.iter().map(|state| (state.name.as_str(), at(state.at)));
        let marks: Vec<(&str, Point)> =
            self.light.map(|uv| ("light", at(uv))).into_iter().chain(states).collect();
        let mut places = Places::around(panel.origin, panel.size, marks.iter().map(|(_, at)| *at));
        for triangle in triangles.iter().flatten() {
            let [a, b, c] = triangle.map(at);
            places.avoid(&[a, b, c, a]);
        }
        for (name, at) in marks {
            places.find(at, name, SMALL).write(svg, name, Text::new(SMALL, INK));
        }
    }
}
