//! Why a spread cannot be computed.

use std::fmt;

/// Reason why the spread of a panel cannot be computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpreadError {
    /// Several components of the front of screen at different heights above a flat face may reflect light to the pixel; their
    /// common reflectance does not tell how much each of them does.
    SeveralFronts,
    /// Light goes to and fro between components of the front of screen too often to be followed.
    ManyWays,
    /// The pixel scatters by a kernel of its own.
    ScatteringPixel,
    /// Light does not refract at a face of another index than the glass: places are not defined.
    Unrefracted,
}

impl fmt::Display for SpreadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::SeveralFronts => {
                "several components of the front of screen between the pixel and a reflection (expected one with a gap); the \
                 Monte Carlo solver follows light between them"
            }
            Self::ManyWays => {
                "components of the front of screen between which light goes to and fro too often (expected products of the reflectances \
                 of two of them below 0.9)"
            }
            Self::ScatteringPixel => {
                "a pixel that scatters by a kernel of its own (expected a mirror or a Lambertian pixel)"
            }
            Self::Unrefracted => {
                "a face whose index is not that of the glass (expected the same index)"
            }
        })
    }
}

impl std::error::Error for SpreadError {}
