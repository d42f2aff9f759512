//! The colours of the states, for a screen.

use papilio_colour::{Xy, Xyz};
use papilio_display::result::{Illuminant, RunResult, StateValues, View};

use crate::style::is_self_lit;
use crate::svg::hex;

/// A channel less than this above 1 is not seen to be clipped.
const CLIPPED: f64 = 1.005;

/// How the states of a view are painted.
///
/// A screen's white stands for the perfect white, unless a state is brighter
/// than that (near a lamp's mirror image): then all states are dimmed alike,
/// or they would be blank. Where the front light is all the light, the display's own white is the screen's.
#[derive(Debug)]
pub(crate) struct Paint {
    white: Option<Xyz>,
    divisor: f64,
    /// Whether that is because a state is brighter than the perfect white.
    is_dimmed: bool,
}

impl Paint {
    /// For all states of a view.
    pub(crate) fn of(result: &RunResult, view: &View) -> Self {
        if let Some(own) = own_white(view) {
            return Self { white: Some(own * (1.0 / own.y)), divisor: own.y, is_dimmed: false };
        }
        let Illuminant { x, y, .. } = result.illuminant;
        let mut paint = Self { white: Xy { x, y }.with_luminance(1.0), divisor: 1.0, is_dimmed: false };
        let channels = view.states.iter().flat_map(|(_, state)| paint.seen(&state.value).linear_srgb());
        // Y is a mean of the channels, so no channel above 1 means no Y above 1.
        let brightest = channels.filter(|channel| channel.is_finite()).fold(0.0, f64::max);
        if brightest > CLIPPED {
            (paint.divisor, paint.is_dimmed) = (brightest, true);
        }
        paint
    }

    /// The colour of a state as it looks in its light.
    pub(crate) fn colour(&self, state: &StateValues) -> String {
        hex((self.seen(state) * (1.0 / self.divisor)).srgb_clipped())
    }

    /// By what luminances are divided, as text, if they are.
    pub(crate) fn dimmed(&self) -> Option<String> {
        let decimals = if self.divisor < 2.0 { 2 } else { 1 };
        self.is_dimmed.then(|| format!("shown at 1/{:.decimals$}", self.divisor))
    }

    /// A state's colour, seen against D65.
    fn seen(&self, state: &StateValues) -> Xyz {
        let seen = Xyz { x: state.X, y: state.Y, z: state.Z };
        self.white.and_then(|white| seen.adapted_to_d65(white)).unwrap_or(seen)
    }
}

/// The white of a display that is lit by its front light alone.
fn own_white(view: &View) -> Option<Xyz> {
    let white = &view.states.get("white").filter(|_| is_self_lit(view))?.value;
    let seen = Xyz { x: white.X, y: white.Y, z: white.Z };
    (seen.y > 0.0 && seen.y.is_finite()).then_some(seen)
}
