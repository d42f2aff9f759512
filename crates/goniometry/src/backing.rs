//! What is behind a film in a display, and what that does to a measurement of the film in air.

use crate::kernel::Lamination;

/// What is behind a film that was measured in air.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Backing {
    /// Air, as in the measurement.
    Air,
    /// Glass, and the measurement counts as it stands: it includes the film's back face.
    Glass {
        /// Smallest index of the glass.
        index: f64,
    },
    /// Glass that the film touches: its back face in air is gone.
    Laminated {
        /// Mean index of the glass.
        index: f64,
    },
}

impl Backing {
    /// What has to be taken out of the film's transmission.
    pub fn lamination(self) -> Option<Lamination> {
        match self {
            Self::Laminated { index } => Some(Lamination { index }),
            Self::Air | Self::Glass { .. } => None,
        }
    }

    /// Up to which |beta| light travels behind the film, as far as the measurement describes it: only a film that counts
    /// as it stands may send light beyond the horizon of the air.
    pub fn reach(self) -> f64 {
        match self {
            Self::Glass { index } => index,
            Self::Air | Self::Laminated { .. } => 1.0,
        }
    }
}
