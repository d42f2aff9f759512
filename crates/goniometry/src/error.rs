//! Errors in the evaluation of measured scattering.

use crate::fit::SPARE_CELLS;

/// Error of a measurement or its evaluation.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GoniometryError {
    /// A fit needs more cells with light than it has parameters.
    #[error(
        "{cells} cells hold a value above 0; a fit of {parameters} parameters needs {SPARE_CELLS} more than that"
    )]
    TooFewCells {
        /// Cells with a value.
        cells: usize,
        /// Number of fitted parameters.
        parameters: usize,
    },
    /// A number is out of its range.
    #[error("{what} is {value} (expected {expected})")]
    OutOfRange {
        /// Name of the number.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Its range.
        expected: &'static str,
    },
    /// The operation needs a grid about the specular direction.
    #[error("only parts on a specular-centred grid (imaging spheres) can be {0}")]
    NotSpecular(&'static str),
    /// The measurement is too coarse for a display: patches of 10 deg, or few listed pairs.
    #[error(
        "patches, and fewer than 12 different listed pairs of directions, are too coarse for a display: measure more directions"
    )]
    NoGrid,
    /// Sample and reference were not measured on the same directions.
    #[error("sample and reference have different {0}: measure both on one grid")]
    GridsDiffer(&'static str),
    /// The reference has no part for the scatter mode of a part of the sample.
    #[error("the reference has no part for {0}")]
    NoReference(crate::ScatterMode),
    /// A channel of the sample is missing in the reference.
    #[error("the reference has no channel {0}")]
    NoChannel(crate::Channel),
    /// Totals should be normalised to the instrument's TIS, but the file gives none.
    #[error("the file gives no total integrated scatter (TIS), or not for each rotation and incidence")]
    NoTis,
    /// Totals should be normalised to the instrument's TIS, which is in per cent.
    #[error("the total integrated scatter (TIS) of the file is in per cent")]
    TisInPercent,
    /// A level was stated for a part without any light at its smallest incidence.
    #[error("the file has no light at its smallest incidence, and no level can be given to it")]
    NoLight,
    /// Deconvolution failed: no lobe reproduces the file's values when blurred.
    #[error("no lobe blurred by {width} gives the file's values: {:.0} % remain", 100.0 * misfit)]
    Blur {
        /// Width of the blur, in direction cosines.
        width: f64,
        /// Root mean square difference, relative.
        misfit: f64,
    },
    /// The lobe cannot be tabulated.
    #[error(transparent)]
    Optics(#[from] papilio_optics::OpticsError),
}
