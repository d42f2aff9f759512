//! The palette of a display: the colours of its states in one light and view, in the coordinates that pictures and dithering need.

use papilio_colour::{Lab, Xy, Xyz};
use schemars::JsonSchema;
use serde::Serialize;

use crate::DisplayError;
use crate::result::{Named, RunResult, State, StateValues, XyzError};
use crate::run::{Control, run};
use crate::scene::Scene;
use crate::single_view::{LightSummary, SingleView};

/// Computes the colours of all states in the light of a scene, and in other rooms: names, and scenes with the same states.
///
/// # Errors
/// As [`run`](crate::run); if the scene does not have exactly one view, or a light has no colour.
pub fn palette(
    scene: &Scene,
    rooms: &[(String, &Scene)],
    control: &Control<'_>,
) -> Result<PaletteResult, DisplayError> {
    let view = SingleView::of(&scene.viewer, "a palette")?;
    let of = |result: &RunResult| Palette::of(result, 0).ok_or(DisplayError::NoWhite { what: "a palette" });
    let part = |number: usize| [number, number + 1].map(|lights| lights as f64 / (1 + rooms.len()) as f64);
    let here = control.within(part(0), |control| run(scene, control))?;
    let palette = of(&here)?;
    let (light, mut warnings) = (LightSummary::of(scene, &here), here.warnings);
    let (mut in_rooms, mut lights) = (Vec::new(), Vec::new());
    for (number, (name, scene)) in rooms.iter().enumerate() {
        let result = control.within(part(number + 1), |control| run(scene, control))?;
        let there = of(&result)?;
        let light = RoomLight { light: LightSummary::of(scene, &result), white_XYZ: there.white_XYZ };
        lights.push((name.clone(), light));
        in_rooms.push((name.clone(), there.into_room(&palette)));
        warn_of_room(&mut warnings, name, &result.warnings);
    }
    Ok(PaletteResult { light, view, palette, rooms: Named(in_rooms), room_lights: Named(lights), warnings })
}

/// Adds those warnings of a room that are not among those of the scenario's own light, with its name.
pub fn warn_of_room(warnings: &mut Vec<String>, room: &str, there: &[String]) {
    let new: Vec<_> = there.iter().filter(|one| !warnings.contains(one)).collect();
    let new: Vec<_> = new.into_iter().map(|one| format!("in the light of {room}: {one}")).collect();
    warnings.extend(new);
}

/// Result of [`palette`].
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct PaletteResult {
    /// The light.
    pub light: LightSummary,
    /// The view.
    pub view: SingleView,
    /// The colours.
    #[serde(flatten)]
    pub palette: Palette,
    /// Colours in other rooms, by name and state.
    pub rooms: Named<Room>,
    /// The lights of the rooms, by name.
    pub room_lights: Named<RoomLight>,
    /// Warnings.
    pub warnings: Vec<String>,
}

/// The light of another room.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as palette.json spells them")]
pub struct RoomLight {
    /// The light.
    pub light: LightSummary,
    /// X, Y and Z of a perfect white in it, to which the colours of the room are relative; Y = 1.
    pub white_XYZ: [f64; 3],
}

/// Colours of all states of a view.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as palette.json spells them")]
pub struct Palette {
    /// X, Y and Z of a perfect white in the light; Y = 1.
    pub white_XYZ: [f64; 3],
    /// Colours, in the order of the states.
    pub colours: Vec<PaletteColour>,
}

/// The colour of a state.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as palette.json spells them")]
pub struct PaletteColour {
    /// Name of the state.
    pub state: String,
    /// Tristimulus value relative to a perfect white in the light.
    pub X: f64,
    /// Tristimulus value: the luminance factor.
    pub Y: f64,
    /// Tristimulus value.
    pub Z: f64,
    /// CIELAB lightness L*, relative to the same white as in `result.json` (`metrics.white`).
    pub L_star: Option<f64>,
    /// CIELAB a*.
    pub a_star: Option<f64>,
    /// CIELAB b*.
    pub b_star: Option<f64>,
    /// Oklab L, a and b of the colour adapted to D65; a perfect white has L = 1.
    pub oklab: Option<[f64; 3]>,
    /// sRGB, encoded, 0 to 1, of the colour adapted to D65; a perfect white is 1, 1, 1. A colour that is too bright has the largest values of
    /// its chromaticity, and then negative ones are 0, as in `seen.png`.
    pub srgb: Option<[f64; 3]>,
    /// The same with the display's white as the white: the state `white`, or else the brightest one, is 1, 1, 1.
    pub srgb_relative: Option<[f64; 3]>,
    /// `srgb` as #rrggbb.
    pub hex: Option<String>,
    /// Errors.
    pub error: PaletteErrors,
    /// Estimated errors of X, Y and Z because lights and reflectances are known only at the wavelengths of the grid, as in
    /// `result.json`; only if its step is above 1 nm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolation_error: Option<XyzError>,
}

/// Standard or discretisation errors of a colour.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, JsonSchema)]
#[allow(non_snake_case, reason = "the field's own letters, as palette.json spells them")]
pub struct PaletteErrors {
    /// Of X.
    pub X: f64,
    /// Of Y.
    pub Y: f64,
    /// Of Z.
    pub Z: f64,
    /// Of L*.
    pub L_star: Option<f64>,
    /// Of a*.
    pub a_star: Option<f64>,
    /// Of b*.
    pub b_star: Option<f64>,
}

/// A colour in another room.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct RoomColour {
    /// The colour in the light of the room.
    #[serde(flatten)]
    pub colour: PaletteColour,
    /// CIEDE2000 difference from the colour in the scenario's light, each relative to the white of its own light.
    pub delta_e_2000: Option<f64>,
}

/// Colours of the states in another room, by state.
pub type Room = Named<RoomColour>;

impl Palette {
    /// Returns the colours of a view; `None` if there is no such view, or the light has no colour.
    pub fn of(result: &RunResult, view: usize) -> Option<Self> {
        let states = &result.views.get(view)?.states;
        let light = Xy { x: result.illuminant.x, y: result.illuminant.y };
        let white = light.with_luminance(1.0)?;
        let display = states.get("white").map(xyz);
        let brightest = || states.0.iter().map(|(_, state)| xyz(state)).max_by(|a, b| a.y.total_cmp(&b.y));
        let paper = display.or_else(brightest).filter(|paper| paper.y > 0.0);
        let colours = states.0.iter().map(|(name, state)| PaletteColour::new(name, state, white, paper));
        Some(Self { white_XYZ: white.to_array(), colours: colours.collect() })
    }

    /// Returns the palette with only these states, in this order; all, if none is named.
    ///
    /// # Errors
    /// If a state does not exist.
    pub fn with_states(mut self, names: &[String]) -> Result<Self, DisplayError> {
        if !names.is_empty() {
            let find = |name: &String| {
                let known = self.colours.iter().find(|one| one.state == *name).cloned();
                known.ok_or_else(|| DisplayError::NoSuchQuantity {
                    what: format!("state {name}"),
                    quantity: "picture",
                })
            };
            self.colours = names.iter().map(find).collect::<Result<_, _>>()?;
        }
        Ok(self)
    }

    /// Returns the names of the states.
    pub fn names(&self) -> Vec<String> {
        self.colours.iter().map(|one| one.state.clone()).collect()
    }

    /// Returns X, Y, Z of each state, relative to a perfect white.
    pub fn pages(&self) -> Vec<[f64; 3]> {
        self.colours.iter().map(|one| [one.X, one.Y, one.Z]).collect()
    }

    /// Returns the largest error of X, Y or Z of a state.
    pub fn error(&self) -> f64 {
        let largest = |one: &PaletteColour| one.error.X.max(one.error.Y).max(one.error.Z);
        self.colours.iter().map(largest).fold(0.0, f64::max)
    }

    /// Returns this palette as that of a room, with differences from `other`.
    pub fn into_room(self, other: &Self) -> Room {
        let colours = self.colours.into_iter().map(|colour| {
            let here = other.colours.iter().find(|here| here.state == colour.state);
            let lab = |one: &PaletteColour| Some(Lab { l: one.L_star?, a: one.a_star?, b: one.b_star? });
            let delta_e_2000 =
                here.and_then(lab).zip(lab(&colour)).map(|(here, there)| here.delta_e_2000(there));
            (colour.state.clone(), RoomColour { colour, delta_e_2000 })
        });
        Named(colours.collect())
    }
}

impl PaletteColour {
    fn new(name: &str, state: &State, white: Xyz, paper: Option<Xyz>) -> Self {
        let value = &state.value;
        let of = |white: Xyz| xyz(state).adapted_to_d65(white);
        let seen = of(white);
        let relative = paper.and_then(|paper| of(paper * (1.0 / paper.y)).map(|seen| seen * (1.0 / paper.y)));
        let srgb = seen.map(Xyz::srgb_encoded);
        Self {
            state: name.to_owned(),
            X: value.X,
            Y: value.Y,
            Z: value.Z,
            L_star: value.L_star,
            a_star: value.a_star,
            b_star: value.b_star,
            oklab: seen.map(|seen| seen.oklab()).map(|oklab| [oklab.l, oklab.a, oklab.b]),
            srgb,
            srgb_relative: relative.map(Xyz::srgb_encoded),
            hex: srgb.map(hex),
            error: PaletteErrors::new(state),
            interpolation_error: state.interpolation_error,
        }
    }
}

impl PaletteErrors {
    fn new(state: &State) -> Self {
        let both = [Some(&state.standard_error), state.discretisation_error.as_ref()];
        let largest = |of: fn(&StateValues) -> Option<f64>| {
            both.iter().flatten().filter_map(|one| of(one)).reduce(f64::max)
        };
        Self {
            X: largest(|one| Some(one.X)).unwrap_or(0.0),
            Y: largest(|one| Some(one.Y)).unwrap_or(0.0),
            Z: largest(|one| Some(one.Z)).unwrap_or(0.0),
            L_star: largest(|one| one.L_star),
            a_star: largest(|one| one.a_star),
            b_star: largest(|one| one.b_star),
        }
    }
}

fn xyz(state: &State) -> Xyz {
    Xyz { x: state.value.X, y: state.value.Y, z: state.value.Z }
}

/// Returns encoded components, 0 to 1, as bytes.
pub fn bytes(srgb: [f64; 3]) -> [u8; 3] {
    srgb.map(|value| (255.0 * value).round() as u8)
}

/// Returns encoded components as #rrggbb.
pub fn hex(srgb: [f64; 3]) -> String {
    let [r, g, b] = bytes(srgb);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// What a panel is sent for states with usual names; other states are sent the colour that is seen.
const DEVICE: [(&str, [u8; 3]); 9] = [
    ("black", [0, 0, 0]),
    ("white", [255, 255, 255]),
    ("red", [255, 0, 0]),
    ("green", [0, 255, 0]),
    ("blue", [0, 0, 255]),
    ("yellow", [255, 255, 0]),
    ("cyan", [0, 255, 255]),
    ("magenta", [255, 0, 255]),
    ("orange", [255, 128, 0]),
];

/// Returns the usual code of a state, pure red for `red`; `None` for other names.
pub fn device_colour(state: &str) -> Option<[u8; 3]> {
    DEVICE.iter().find(|(name, _)| *name == state).map(|(_, colour)| *colour)
}
