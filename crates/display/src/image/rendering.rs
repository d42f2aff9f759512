//! From the colours of a picture to colours of a display in its light and view.
//!
//! - *relative*: the white of the picture becomes the white of the display, its black that of the display: after adaptation from D65 to the
//!   display's white W, with the display's black K, `XYZ' = K + (1 - K/W) XYZ` in each of X, Y and Z.
//! - *absolute*: the white of the picture is a perfect white in the light. Luminances are those of the page, and light colours are cut.
//!
//! Colours that no mixture of the states has are replaced by the nearest one that some mixture has, in X/X_W, Y/Y_W, Z/Z_W.

use papilio_colour::states::StateHull;
use papilio_colour::{Adaptation, D65_WHITE, Xyz};

use super::colour;
use crate::DisplayError;
use crate::palette::{Palette, PaletteColour};

/// What becomes of the white and black of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Intent {
    /// They become those of the display.
    #[default]
    Relative,
    /// Its white is a perfect white in the light, its black has no light.
    Absolute,
}

/// Colours of a display for the colours of a picture.
pub(super) struct Rendering {
    adaptation: Adaptation,
    /// What is added, and the factor, for each of X, Y and Z.
    black: [f64; 3],
    gain: [f64; 3],
    pub(super) white: Xyz,
    hull: StateHull,
    /// X, Y, Z of the states.
    pub(super) states: Vec<[f64; 3]>,
    /// Largest error of the X, Y, Z of a state.
    pub(super) error: f64,
}

impl Rendering {
    pub(super) fn new(
        palette: &Palette,
        to_light: &Adaptation,
        intent: Intent,
    ) -> Result<Self, DisplayError> {
        let states: Vec<[f64; 3]> = palette.colours.iter().map(|one| [one.X, one.Y, one.Z]).collect();
        let find = |name: &str| palette.colours.iter().position(|one| one.state == name);
        let by_light = |most: bool| {
            let all = 0..states.len();
            let order = |a: &usize, b: &usize| states[*a][1].total_cmp(&states[*b][1]);
            if most { all.max_by(order) } else { all.min_by(order) }.unwrap_or(0)
        };
        let [white, black] = [
            find("white").unwrap_or_else(|| by_light(true)),
            find("black").unwrap_or_else(|| by_light(false)),
        ];
        let (white, black) = (states[white], states[black]);
        let whole = Xyz { x: white[0], y: white[1], z: white[2] };
        let (adaptation, black, gain) = match intent {
            Intent::Relative => {
                let to_display = Adaptation::between(D65_WHITE, whole)
                    .ok_or(DisplayError::NoWhite { what: "a picture" })?;
                (to_display, black, [0, 1, 2].map(|k| 1.0 - black[k] / white[k]))
            }
            Intent::Absolute => (*to_light, [0.0; 3], [1.0; 3]),
        };
        let points: Vec<Xyz> = states.iter().map(|[x, y, z]| Xyz { x: *x, y: *y, z: *z }).collect();
        let largest = |one: &PaletteColour| one.error.X.max(one.error.Y).max(one.error.Z);
        Ok(Self {
            adaptation,
            black,
            gain,
            white: whole,
            hull: StateHull::new(&points)?,
            error: palette.colours.iter().map(largest).fold(0.0, f64::max),
            states,
        })
    }

    /// Coordinates in which error diffusion searches the nearest state: lightness, red-green and blue-yellow, relative to the white.
    ///
    /// Of weights of red-green from 0.25 to 4 (blue-yellow: 0.4 of it), 1 has the smallest mean S-CIELAB difference for three photographs on
    /// six inks (5.41, 3.55, 4.34; unscaled X, Y, Z: 5.95 for the first). The mean colour is the same with any weights.
    pub(super) fn metric(&self) -> [[f64; 3]; 3] {
        let [x, y, z] = self.white.to_array().map(|value| 1.0 / value);
        [[0.0, y, 0.0], [x, -y, 0.0], [0.0, BLUE_YELLOW * y, -BLUE_YELLOW * z]]
    }

    /// The colour that the display should show, whether or not it can.
    pub(super) fn wanted(&self, pixel: [f32; 3]) -> [f32; 3] {
        let adapted = self.adaptation.apply(colour(pixel)).to_array();
        [0, 1, 2].map(|k| (self.black[k] + self.gain[k] * adapted[k]) as f32)
    }

    /// The colour that the display can show, and whether it is the same.
    pub(super) fn mapped(&self, pixel: [f32; 3]) -> ([f32; 3], bool) {
        let wanted = colour(pixel);
        if self.hull.contains_within(wanted, INSIDE) {
            return (pixel, true);
        }
        let nearest = self.hull.nearest(wanted, self.white);
        (nearest.to_array().map(|value| value as f32), false)
    }
}

/// Weight of blue-yellow differences of states over that of red-green ones.
const BLUE_YELLOW: f64 = 0.4;

/// Distance from the hull, relative to its size, that rounding to 32 bits may cause.
const INSIDE: f64 = 1e-6;
