//! Gamut mapping: which colour of a display stands for a colour of a source picture.
//!
//! **What.** In two steps. The *target* sets the picture's white and black to those of the display:
//!
//! - [`Intent::Natural`], [`Intent::Vivid`]: CAT16 from D65 to the display's white W; in [`MapSpace`],
//!   lightness passes a [`Tone`], which leaves light tones where they are and bends towards the lightness of
//!   the black; chroma and hue are kept, relative to the mixture of white and black with this lightness.
//! - [`Intent::Relative`], [`Intent::Clip`]: CAT16 to W, then for each of X, Y, Z `K + (1 - K/W) XYZ`: white
//!   becomes W, and black becomes K.
//! - [`Intent::Absolute`]: CAT16 to a perfect white in the same light: colours keep the luminance factor of
//!   the page.
//!
//! The *mapping* then changes colours outside the hull of the display's states, and no others:
//!
//! - Relative and absolute: constant lightness and hue in [`MapSpace`]; chroma is reduced until the colour is
//!   in the hull.
//! - Natural and vivid: the nearest colour of the hull in [`MapSpace`], differences of hue counting three times, or twice in a plane
//!   ([`GamutMapping::closest`]).
//! - Clip: the nearest colour of the hull, in X, Y, Z relative to white ([`StateHull::nearest`]).
//!
//! Hue and chroma are relative to grey, or, where the hull has no grey of this lightness (a bluish black), to
//! its nearest colour on the way from the mixture of white and black. A hull in a plane, as of black, white
//! and one ink, has only two hues: there, Y is constant and the nearest colour of the plane is taken. On a
//! line, the mixture of white and black with the same Y.
//!
//! **Parameters.** The hull, its white and black, and a perfect white, in one light and view and on one
//! scale.
//!
//! **Range.** Any source colours, also outside the source space. The result is always in the hull, within
//! 1e-9.
//!
//! **Source.** Morovič, *Color Gamut Mapping* (Wiley, 2008); black point compensation: ISO 18619:2015, here
//! with the colour of black. The constant hue of Oklab or CAM16-UCS instead of CIELAB avoids purple blues.

mod closest;
mod intent;
mod lattice;
mod several;
mod source;
mod space;
mod table;
#[cfg(test)]
mod tests;
mod tone;

pub use intent::{DisplayColours, Intent, MapSpace};
pub use lattice::ClosestLattice;
pub use several::{Placed, SEVERAL};
pub use source::SourceSpace;
pub use table::{GamutTable, TableError};
pub use tone::Tone;

use crate::matrix::{Matrix, cross, dot, times};
use crate::states::StateHull;
use crate::{Adaptation, ColourError, D65_WHITE, Xyz};
use several::Matrices;
use space::Space;

/// Steps of a bisection: the border of the hull is found to 2^-32 of the way.
const STEPS: usize = 32;
/// Number of greys between black and white, whose lightness increases about uniformly.
const GREYS: usize = 256;

/// Mapping of source colours to colours of a display.
#[derive(Debug, Clone)]
pub struct GamutMapping {
    intent: Intent,
    hull: StateHull,
    display: DisplayColours,
    space: Space,
    source: Matrix,
    adaptation: Adaptation,
    /// Lightness and colour of the greys of the hull, from black to white.
    greys: Vec<(f64, Xyz)>,
    /// The same of the mixtures of black and white.
    mixtures: Vec<(f64, Xyz)>,
    /// Of Oklab, for many colours at once.
    matrices: Option<Matrices>,
}

impl GamutMapping {
    /// Prepares the mapping.
    ///
    /// # Errors
    ///
    /// [`ColourError::WhiteAndBlack`] unless white and black are in the hull and white is larger in X, Y and
    /// Z, and positive.
    pub fn new(
        hull: StateHull,
        display: DisplayColours,
        source: SourceSpace,
        intent: Intent,
        space: MapSpace,
    ) -> Result<Self, ColourError> {
        let DisplayColours { white, black, perfect_white } = display;
        let refused = ColourError::WhiteAndBlack { white: white.y, black: black.y };
        let larger = white.to_array().into_iter().zip(black.to_array()).all(|(white, black)| white > black);
        let contained = [white, black].iter().all(|colour| hull.contains_within(*colour, 1e-6));
        let reference = if intent == Intent::Absolute { perfect_white } else { white };
        let adaptation = Adaptation::between(D65_WHITE, reference);
        let (Some(adaptation), true) = (adaptation, larger && contained) else { return Err(refused) };
        let space = Space::new(space, reference).ok_or(refused)?;
        let source = source.matrix();
        let (greys, mixtures) = (Vec::new(), Vec::new());
        let mut mapping =
            Self { intent, hull, display, space, source, adaptation, greys, mixtures, matrices: None };
        mapping.greys = (0..=GREYS).map(|step| mapping.grey(step)).collect();
        mapping.mixtures = (0..=GREYS).map(|step| mapping.mixture(step)).collect();
        mapping.matrices = mapping.matrices();
        Ok(mapping)
    }

    /// The hull into which colours are mapped.
    pub fn hull(&self) -> &StateHull {
        &self.hull
    }

    /// The mapped colour of a linear colour of the source space; in the hull.
    pub fn map(&self, linear_rgb: [f64; 3]) -> Xyz {
        self.map_xyz(self.source_xyz(linear_rgb))
    }

    /// The target of a linear colour of the source space, before mapping.
    pub fn target(&self, linear_rgb: [f64; 3]) -> Xyz {
        self.target_xyz(self.source_xyz(linear_rgb))
    }

    fn source_xyz(&self, linear_rgb: [f64; 3]) -> Xyz {
        let [x, y, z] = times(&self.source, linear_rgb);
        Xyz { x, y, z }
    }

    /// The target of X, Y, Z relative to D65 (Y = 1 for white), before mapping. That of natural and vivid
    /// intents is that of relative.
    pub fn target_xyz(&self, source: Xyz) -> Xyz {
        let adapted = self.adaptation.apply(source);
        if self.intent == Intent::Absolute {
            return adapted;
        }
        let [white, black] = [self.display.white, self.display.black].map(Xyz::to_array);
        let adapted = adapted.to_array();
        let [x, y, z] = [0, 1, 2].map(|k| black[k] + (1.0 - black[k] / white[k]) * adapted[k]);
        Xyz { x, y, z }
    }

    /// The mapped colour of X, Y, Z relative to D65 (Y = 1 for white); in the hull. A colour that is not
    /// finite becomes black.
    pub fn map_xyz(&self, source: Xyz) -> Xyz {
        let target = self.target_xyz(source);
        if !target.to_array().iter().all(|value| value.is_finite()) {
            return self.display.black;
        }
        let mapped = match self.intent {
            Intent::Clip => target,
            Intent::Natural | Intent::Vivid => self.natural(source),
            Intent::Relative | Intent::Absolute => self.with_less_chroma(target),
        };
        if self.hull.contains(mapped) { mapped } else { self.hull.nearest(mapped, self.display.white) }
    }

    /// Reduces the chroma of a colour outside the hull.
    fn with_less_chroma(&self, target: Xyz) -> Xyz {
        if self.hull.contains(target) {
            return target;
        }
        if self.hull.dimensions() < 3 {
            return self.in_plane(target);
        }
        let to = self.space.coordinates(target);
        let grey = self.grey_of(to[0]);
        let from = self.space.coordinates(grey);
        self.on_the_way(from, to, &self.hull, grey).1
    }

    /// Finds the part of the way between two colours at which a hull ends, and the colour there; `start` is
    /// the colour of `from`.
    fn on_the_way(&self, from: [f64; 3], to: [f64; 3], hull: &StateHull, start: Xyz) -> (f64, Xyz) {
        let at = |part: f64| self.space.xyz([0, 1, 2].map(|k| from[k] + part * (to[k] - from[k])));
        let inside = |colour: &Xyz| hull.contains_within(*colour, 1e-10);
        if let Some(end) = at(1.0).filter(inside) {
            return (1.0, end);
        }
        let (mut low, mut high, mut colour) = (0.0, 1.0, start);
        for _ in 0..STEPS {
            let middle = 0.5 * (low + high);
            match at(middle).filter(inside) {
                Some(found) => (low, colour) = (middle, found),
                None => high = middle,
            }
        }
        (low, colour)
    }

    /// Mixture of black and white at a step, moved towards grey as far as the hull allows, with its
    /// lightness.
    fn grey(&self, step: usize) -> (f64, Xyz) {
        let (lightness, mixture) = self.mixture(step);
        let from = self.space.coordinates(mixture);
        let inner = 0 < step && step < GREYS && self.hull.dimensions() == 3;
        let grey =
            if inner { self.on_the_way(from, [from[0], 0.0, 0.0], &self.hull, mixture).1 } else { mixture };
        (lightness, grey)
    }

    /// Mixture of black and white at a step, with its lightness.
    fn mixture(&self, step: usize) -> (f64, Xyz) {
        let part = (step as f64 / GREYS as f64).powi(3);
        let mixture = self.display.black + (self.display.white - self.display.black) * part;
        (self.space.coordinates(mixture)[0], mixture)
    }

    /// Grey of the hull with this lightness, or its black or white.
    fn grey_of(&self, lightness: f64) -> Xyz {
        at_lightness(&self.greys, lightness)
    }

    /// Colour of a flat hull with the same Y, if there is one.
    fn in_plane(&self, target: Xyz) -> Xyz {
        let DisplayColours { white, black, .. } = self.display;
        let part = ((target.y - black.y) / (white.y - black.y)).clamp(0.0, 1.0);
        let grey = black + (white - black) * part;
        let Some(normal) = self.hull.plane() else { return grey };
        // Along this line in the plane, Y is constant; the distance is that relative to white.
        let line = cross(normal, [0.0, 1.0, 0.0]);
        let weighted = [line[0] / white.x.powi(2), 0.0, line[2] / white.z.powi(2)];
        let size = dot(line, weighted);
        if size < 1e-18 {
            return grey;
        }
        let along = dot((target - grey).to_array(), weighted) / size;
        let [x, y, z] = line.map(|part| along * part);
        grey + Xyz { x, y, z } * self.hull.part_inside(grey, Xyz { x, y, z })
    }
}

/// The colour of this lightness between those of a table, or its first or last one.
fn at_lightness(table: &[(f64, Xyz)], lightness: f64) -> Xyz {
    let next = table.partition_point(|(one, _)| *one < lightness).clamp(1, table.len() - 1);
    let ((below, dark), (above, light)) = (table[next - 1], table[next]);
    let part = ((lightness - below) / (above - below)).clamp(0.0, 1.0);
    dark * (1.0 - part) + light * part
}
