//! Marks of the states and the light in a chromaticity diagram.

use papilio_display::result::{RunResult, View};

use crate::diagram::{Coordinates, Diagram};
use crate::paint::Paint;
use crate::panel::{Panel, SMALL};
use crate::place::Places;
use crate::style::INK;
use crate::svg::{Point, Stroke, Svg, Text};

/// Sides of the windows that are enlarged, in units of the diagram.
const WINDOWS: [f64; 5] = [0.01, 0.02, 0.05, 0.08, 0.12];

/// The marks in a diagram.
#[derive(Debug)]
pub(crate) struct Marks {
    states: Vec<State>,
    light: Option<Coordinates>,
}

#[derive(Debug, Clone)]
struct State {
    name: String,
    at: Coordinates,
    error: Coordinates,
    fill: String,
}

/// A square part of the diagram.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Window {
    pub(crate) middle: Coordinates,
    pub(crate) side: f64,
}

impl Marks {
    /// Returns the marks of the states of a view and of the light that lie within the diagram
    /// (noise can move a black state out of it).
    pub(crate) fn of(result: &RunResult, view: &View, panel: &Panel, diagram: Diagram) -> Self {
        let paint = Paint::of(result, view);
        let inside = |(x, y): &Coordinates| panel.x.contains(*x) && panel.y.contains(*y);
        let states = view.states.iter().filter_map(|(name, state)| {
            Some(State {
                name: name.to_owned(),
                at: diagram.of_state(&state.value).filter(inside)?,
                error: diagram.of_state(&state.standard_error).unwrap_or((f64::NAN, f64::NAN)),
                fill: paint.colour(&state.value),
            })
        });
        let light = diagram.of_light(&result.illuminant);
        Self { states: states.collect(), light: Some(light).filter(inside) }
    }

    /// Returns the window around the marks, or around those of the states alone, if they are close enough
    /// together to be enlarged.
    pub(crate) fn crowded(&self) -> Option<Window> {
        let states = || self.states.iter().map(|state| state.at);
        window(states().chain(self.light)).or_else(|| window(states()))
    }

    /// Draws the marks that lie within a panel.
    pub(crate) fn draw_within(&self, svg: &mut Svg, panel: &Panel) {
        self.within(panel).draw(svg, panel);
    }

    fn within(&self, panel: &Panel) -> Self {
        let inside = |(x, y): &Coordinates| panel.x.contains(*x) && panel.y.contains(*y);
        let states = self.states.iter().filter(|state| inside(&state.at)).cloned().collect();
        Self { states, light: self.light.filter(inside) }
    }

    /// Draws discs and error crosses of the states, and above them the cross of the light, which a state
    /// would hide.
    pub(crate) fn draw(&self, svg: &mut Svg, panel: &Panel) {
        let line = Stroke::solid(INK, 1.2);
        for State { at, error, fill, .. } in &self.states {
            panel.error_bars(svg, &[at.0], &[at.1], &[error.1], &line);
            panel.error_bar_across(svg, *at, error.0, &line);
            let centre = panel.at(at.0, at.1);
            svg.circle(centre, 5.5, fill, &Stroke::solid("#ffffff", 3.0));
            svg.circle(centre, 5.5, fill, &line);
        }
        if let Some((x, y)) = self.light {
            let (x, y) = panel.at(x, y);
            // A white outline makes the cross visible on a dark disc.
            for stroke in [Stroke::solid("#ffffff", 3.6), Stroke::solid(INK, 1.4)] {
                svg.line((x - 5.0, y), (x + 5.0, y), &stroke);
                svg.line((x, y - 5.0), (x, y + 5.0), &stroke);
            }
        }
    }

    /// Draws the names, clear of each other and of the sides of the triangles.
    pub(crate) fn name(&self, svg: &mut Svg, panel: &Panel, triangles: &[Option<[Coordinates; 3]>]) {
        let at = |(x, y): Coordinates| panel.at(x, y);
        let here = self.within(panel);
        let states = here.states.iter().map(|state| (state.name.as_str(), at(state.at)));
        let marks: Vec<(&str, Point)> =
            here.light.map(|light| ("light", at(light))).into_iter().chain(states).collect();
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

/// Returns the window around points that are close together; `None` for a single point.
fn window(points: impl Iterator<Item = Coordinates> + Clone) -> Option<Window> {
    let range = |of: fn(Coordinates) -> f64| {
        let start = (f64::INFINITY, f64::NEG_INFINITY);
        points.clone().map(of).fold(start, |(min, max), v| (min.min(v), max.max(v)))
    };
    let (x, y) = (range(|at| at.0), range(|at| at.1));
    let extent = (x.1 - x.0).max(y.1 - y.0);
    let side = WINDOWS.into_iter().find(|side| *side >= 1.6 * extent)?;
    let middle = ((x.0 + x.1) / 2.0, (y.0 + y.1) / 2.0);
    (points.count() > 1).then_some(Window { middle, side })
}
