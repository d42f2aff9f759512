//! The space in which hue is constant, relative to a white of the display.

use super::MapSpace;
use crate::matrix::Matrix;
use crate::{Adaptation, Cam16Ucs, Oklab, Xyz};

/// Conversions between colours of the display and lightness and two chromatic coordinates; the white has no
/// chroma.
#[derive(Debug, Clone)]
pub(super) struct Space {
    /// Complete adaptation to the white of the model.
    to_model: Adaptation,
    from_model: Adaptation,
    /// CAM16-UCS, or Oklab.
    cam16: Option<Cam16Ucs>,
}

impl Space {
    /// Prepares a space; `None` unless the white is positive.
    pub(super) fn new(space: MapSpace, white: Xyz) -> Option<Self> {
        let (neutral, cam16) = match space {
            // The white of the rounded matrices, which differs from D65 by 1e-4.
            MapSpace::Oklab => (Oklab { l: 1.0, a: 0.0, b: 0.0 }.xyz(), None),
            // To an equal-energy white, the model adapts completely.
            MapSpace::Cam16Ucs(viewing) => {
                let neutral = Xyz { x: 1.0, y: 1.0, z: 1.0 };
                (neutral, Some(Cam16Ucs::new(neutral, &viewing)?))
            }
        };
        let to_model = Adaptation::between(white, neutral)?;
        Some(Self { to_model, from_model: Adaptation::between(neutral, white)?, cam16 })
    }

    /// The matrices to and from the X, Y, Z of Oklab; `None` in another space.
    pub(super) fn oklab_matrices(&self) -> Option<[Matrix; 2]> {
        self.cam16.is_none().then(|| [*self.to_model.matrix(), *self.from_model.matrix()])
    }

    /// Lightness and two chromatic coordinates; of a colour outside the model, those of black.
    pub(super) fn coordinates(&self, colour: Xyz) -> [f64; 3] {
        let adapted = self.to_model.apply(colour);
        if let Some(model) = &self.cam16 {
            return model.coordinates(adapted).unwrap_or([0.0; 3]);
        }
        let Oklab { l, a, b } = adapted.oklab();
        [l, a, b]
    }

    /// The colour of coordinates, if there is one.
    pub(super) fn xyz(&self, [l, a, b]: [f64; 3]) -> Option<Xyz> {
        let adapted = match &self.cam16 {
            Some(model) => model.xyz([l, a, b])?,
            None => Oklab { l, a, b }.xyz(),
        };
        Some(self.from_model.apply(adapted))
    }
}
