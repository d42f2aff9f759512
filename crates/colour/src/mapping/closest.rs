//! Natural pictures: colours by lightness, chroma and hue relative to the white, and the nearest of the hull.
//!
//! Coordinates are lightness and two chromatic ones, in units of the white's lightness, in the space of the
//! mapping.

use super::{GamutMapping, Intent, Tone, at_lightness};
use crate::matrix::{Matrix, dot, times};
use crate::states::nearest_weights;
use crate::{D65_WHITE, Xyz};

/// Steepness of the tone curve of natural and of vivid pictures: tones this much lighter than the black, and more,
/// stay where they are. For photographs on six and seven inks (black 0.42), S-CIELAB differences from the photograph
/// are smallest, within 1 %, from 14 to 40, on four greys (black 0.49) from 22 on; with 9, which makes all tones
/// below the middle lighter, they are 4 to 5 % larger. Detail in shadows decreases with the steepness.
const NATURAL: f64 = 30.0;
const VIVID: f64 = 45.0;

/// Least sharpness: below a dark black the curve is as smooth, relative to it, as this.
const LEAST_SHARPNESS: f64 = 4.0;

/// How much a difference across the hue counts, over that of lightness and chroma. With 1, orange becomes
/// yellow or red; 3 has 4 % smaller hue errors than 2 for photographs on six inks. A hull in a plane has only two hues:
/// with 3, black, white and red would show orange as grey.
const ACROSS: f64 = 3.0;
const ACROSS_PLANE: f64 = 2.0;

/// Largest number of steps towards the nearest colour; 3 to 6 are usual.
const STEPS: usize = 16;

/// A step for derivatives, relative to white.
const SMALL: f64 = 1e-6;

impl GamutMapping {
    /// Coordinates of X, Y, Z relative to D65 (Y = 1 for white) when the picture's white is the display's. On a
    /// display without colours, the lightness is that of the grey with the same Y, as in black and white photography:
    /// Oklab's lightness of a blue is larger.
    pub fn appearance(&self, source: Xyz) -> [f64; 3] {
        let [lightness, a, b] = self.coordinates(self.adaptation.apply(source));
        if self.hull.dimensions() > 1 {
            return [lightness, a, b];
        }
        let grey = self.adaptation.apply(D65_WHITE * source.y);
        [self.coordinates(grey)[0], a, b]
    }

    /// The tone curve of the intent, natural or vivid. Where the display has fewer tones above its black than below, it
    /// is less steep: else most of a picture would be black.
    pub fn tone(&self) -> Tone {
        let black = self.lightness_of_black();
        let steepness = if self.intent == Intent::Vivid { VIVID } else { NATURAL };
        Tone::new(black, (steepness * black).max(LEAST_SHARPNESS).min(steepness * (1.0 - black)))
    }

    /// Lightness of the display's black, 1 for its white.
    pub fn lightness_of_black(&self) -> f64 {
        self.coordinates(self.display.black)[0]
    }

    /// Coordinates of the colour whose chroma and hue, relative to the mixture of white and black of the same
    /// lightness, are these: without chroma, it is that mixture.
    pub fn beside_grey(&self, [lightness, a, b]: [f64; 3]) -> [f64; 3] {
        let [grey, grey_a, grey_b] = self.coordinates(at_lightness(&self.mixtures, lightness * self.unit()));
        [grey, grey_a + a, grey_b + b]
    }

    /// The colour of coordinates, if the hull contains it.
    pub fn contained(&self, coordinates: [f64; 3]) -> Option<Xyz> {
        self.xyz(coordinates).filter(|colour| self.hull.contains(*colour))
    }

    /// The colour of the hull closest to coordinates: the one with the least sum of squared differences in
    /// lightness, in chroma and, with a weight of 9 (4 in a plane), across the hue. Newton's method with the best mixture of
    /// states in each step, which is a convex problem (Wolfe, as for [`nearest`](crate::states::StateHull::nearest)).
    pub fn closest(&self, target: [f64; 3]) -> Xyz {
        if let Some(colour) = self.contained(target) {
            return colour;
        }
        let [lightness, a, b] = target;
        let chroma = a.hypot(b);
        let (cos, sin) = if chroma > 0.0 { (a / chroma, b / chroma) } else { (1.0, 0.0) };
        let across = if self.hull.dimensions() == 3 { ACROSS } else { ACROSS_PLANE };
        let rows: Matrix = [[1.0, 0.0, 0.0], [0.0, cos, sin], [0.0, -across * sin, across * cos]];
        let away = |colour: Xyz| {
            let here = self.coordinates(colour);
            times(&rows, [0, 1, 2].map(|k| here[k] - target[k]))
        };
        let grey = at_lightness(&self.mixtures, lightness * self.unit());
        let unit = self.unit();
        let from = self.space.coordinates(grey);
        let mut here = self.on_the_way(from, target.map(|one| one * unit), &self.hull, grey).1;
        let mut off = away(here);
        for _ in 0..STEPS {
            let next = self.best_mixture(here, off, &away);
            let Some((found, less)) = shortened(here, next, dot(off, off), &away) else { break };
            let gained = dot(off, off) - dot(less, less);
            (here, off) = (found, less);
            if gained < 1e-10 {
                break;
            }
        }
        here
    }

    /// The mixture of states with the least difference, where it is linear about a colour.
    fn best_mixture(&self, here: Xyz, off: [f64; 3], away: &impl Fn(Xyz) -> [f64; 3]) -> Xyz {
        let white = self.display.white.to_array();
        let slope = |k: usize| {
            let mut moved = here.to_array();
            moved[k] += SMALL * white[k];
            let [x, y, z] = moved;
            let moved = away(Xyz { x, y, z });
            [0, 1, 2].map(|i| (moved[i] - off[i]) / (SMALL * white[k]))
        };
        let slopes = [slope(0), slope(1), slope(2)];
        let there = |state: &Xyz| {
            let step = (*state - here).to_array();
            [0, 1, 2].map(|i| off[i] + (0..3).map(|k| slopes[k][i] * step[k]).sum::<f64>())
        };
        let states = self.hull.states();
        let points: Vec<[f64; 3]> = states.iter().map(there).collect();
        let nothing = Xyz { x: 0.0, y: 0.0, z: 0.0 };
        nearest_weights(&points).iter().fold(nothing, |sum, (state, weight)| sum + states[*state] * *weight)
    }

    /// The colour on the display of X, Y, Z relative to D65, each colour by itself.
    pub(super) fn natural(&self, source: Xyz) -> Xyz {
        let [lightness, a, b] = self.appearance(source);
        self.closest(self.beside_grey([self.tone().lightness(lightness), a, b]))
    }

    /// Coordinates of a colour of the display.
    pub fn coordinates(&self, colour: Xyz) -> [f64; 3] {
        self.space.coordinates(colour).map(|one| one / self.unit())
    }

    /// The colour of coordinates, on the display or not; `None` if there is none.
    pub fn xyz(&self, coordinates: [f64; 3]) -> Option<Xyz> {
        self.space.xyz(coordinates.map(|one| one * self.unit()))
    }

    /// Lightness of the white in the space of the mapping.
    pub(super) fn unit(&self) -> f64 {
        self.mixtures.last().map_or(1.0, |(lightness, _)| *lightness)
    }
}

/// The first of the whole step, its half and so on that lowers the squared difference, with its difference.
fn shortened(here: Xyz, next: Xyz, square: f64, away: &impl Fn(Xyz) -> [f64; 3]) -> Option<(Xyz, [f64; 3])> {
    let mut part = 1.0;
    for _ in 0..10 {
        let found = here + (next - here) * part;
        let off = away(found);
        if dot(off, off) < square {
            return Some((found, off));
        }
        part *= 0.5;
    }
    None
}
