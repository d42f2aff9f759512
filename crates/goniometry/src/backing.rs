//! The medium behind a foil in a display, and its effect on a measurement of the foil in air.

use crate::kernel::Lamination;

/// Medium behind a foil that was measured in air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Backing {
    /// Air, as in the measurement.
    Air,
    /// Glass; the measurement is used unchanged and includes the foil's back surface.
    Glass {
        /// Smallest index of the glass.
        index: f64,
    },
    /// Glass in optical contact: the foil's back surface to air is absent.
    Laminated {
        /// Mean index of the glass.
        index: f64,
    },
}

impl Backing {
    /// Returns the correction of the foil's transmission.
    pub fn lamination(self) -> Option<Lamination> {
        match self {
            Self::Laminated { index } => Some(Lamination { index }),
            Self::Air | Self::Glass { .. } => None,
        }
    }

    /// Largest |beta| of light behind the foil that the measurement describes. Only a foil whose measurement
    /// is used unchanged may send light beyond the horizon of the air.
    pub fn reach(self) -> f64 {
        match self {
            Self::Glass { index } => index,
            Self::Air | Self::Laminated { .. } => 1.0,
        }
    }
}
