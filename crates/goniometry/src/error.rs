//! Why measured scattering could not be worked on.

use crate::fit::SPARE_CELLS;

/// What is wrong with measurements, or with a question about them.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GoniometryError {
    /// A fit needs more cells with light than it has parameters.
    #[error(
        "{cells} cells hold a value; a fit of {parameters} parameters needs {SPARE_CELLS} more than that"
    )]
    TooFewCells {
        /// Cells with a value.
        cells: usize,
        /// Parameters sought.
        parameters: usize,
    },
    /// A number is out of its range.
    #[error("{what} is {value} (expected {expected})")]
    OutOfRange {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// What was asked for needs a grid about the specular direction.
    #[error("only parts on a specular-centred grid (imaging spheres) can be {0}")]
    NotSpecular(&'static str),
    /// What a display shows needs more than patches of ten degrees or a list of directions.
    #[error("patches and listed pairs of directions are too coarse for a display: it needs a grid of angles")]
    NoGrid,
    /// A sample and a reference were not measured at the same directions.
    #[error("sample and reference have different {0}: measure both on one grid")]
    GridsDiffer(&'static str),
    /// There is nothing in the reference that could calibrate a part of the sample.
    #[error("the reference has no part for this way of light: {0:?}")]
    NoReference(crate::Way),
    /// A channel of the sample is missing in the reference.
    #[error("the reference has no channel {0:?}")]
    NoChannel(crate::Channel),
    /// Totals are to be the instrument's, and the file gives none.
    #[error("the file gives no total integrated scatter (TIS), or not for each rotation and incidence")]
    NoTis,
    /// No lobe that the instrument blurs looks like the file's.
    #[error("no lobe blurred by {width} gives the file's values: {:.0} % remain", 100.0 * misfit)]
    Blur {
        /// Width of the blur, direction cosines.
        width: f64,
        /// Root mean square difference, relative.
        misfit: f64,
    },
    /// The lobe cannot be tabulated.
    #[error(transparent)]
    Optics(#[from] papilio_optics::OpticsError),
}
