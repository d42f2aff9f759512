//! Screen colours of the states.

use papilio_colour::{Xy, Xyz};
use papilio_display::result::{Illuminant, RunResult, StateValues, View};

use crate::style::is_self_lit;
use crate::svg::hex;

/// Largest channel value for which clipping is not visible.
const CLIPPED: f64 = 1.005;

/// Conversion of the states of a view to screen colours.
///
/// The white of the screen represents the perfect white diffuser, unless a state is brighter
/// (near the mirror image of a source). Then the luminances of all states are divided by the same number;
/// otherwise they would be clipped to white. If the front light is the only light, the white of the screen
/// represents the white of the display.
#[derive(Debug)]
pub(crate) struct Paint {
    white: Option<Xyz>,
    divisor: f64,
    /// Whether a state is brighter than the perfect white diffuser.
    is_dimmed: bool,
}

impl Paint {
    /// Creates the conversion for all states of a view.
    pub(crate) fn of(result: &RunResult, view: &View) -> Self {
        if let Some(own) = own_white(view) {
            return Self { white: Some(own * (1.0 / own.y)), divisor: own.y, is_dimmed: false };
        }
        let Illuminant { x, y, .. } = result.illuminant;
        let mut paint = Self { white: Xy { x, y }.with_luminance(1.0), divisor: 1.0, is_dimmed: false };
        let channels = view.states.iter().flat_map(|(_, state)| paint.adapted(&state.value).linear_srgb());
        // Y is a mean of the channels: if no channel exceeds 1, Y does not exceed 1 either.
        let brightest = channels.filter(|channel| channel.is_finite()).fold(0.0, f64::max);
        if brightest > CLIPPED {
            (paint.divisor, paint.is_dimmed) = (brightest, true);
        }
        paint
    }

    /// Returns the colour of a state as it appears in its light.
    pub(crate) fn colour(&self, state: &StateValues) -> String {
        hex((self.adapted(state) * (1.0 / self.divisor)).srgb_clipped())
    }

    /// Returns a text with the divisor of the luminances, if they are divided.
    pub(crate) fn dimmed(&self) -> Option<String> {
        let decimals = if self.divisor < 2.0 { 2 } else { 1 };
        self.is_dimmed.then(|| format!("shown at 1/{:.decimals$}", self.divisor))
    }

    /// Returns the colour of a state, adapted to D65.
    fn adapted(&self, state: &StateValues) -> Xyz {
        let xyz = Xyz { x: state.X, y: state.Y, z: state.Z };
        self.white.and_then(|white| xyz.adapted_to_d65(white)).unwrap_or(xyz)
    }
}

/// Returns the white of a display whose only light is its front light.
fn own_white(view: &View) -> Option<Xyz> {
    let white = &view.states.get("white").filter(|_| is_self_lit(view))?.value;
    let xyz = Xyz { x: white.X, y: white.Y, z: white.Z };
    (xyz.y > 0.0 && xyz.y.is_finite()).then_some(xyz)
}
