//! Errors in spectral data.

/// Error of a grid, a table or a material.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpectraError {
    /// The three numbers do not define a grid.
    #[error(
        "{start_nm} to {stop_nm} nm in steps of {step_nm} nm is not a grid (expected 0 < start < stop and an integer number of steps, at most {} points)",
        crate::Grid::MAX_LEN
    )]
    Grid {
        /// Requested first wavelength.
        start_nm: f64,
        /// Requested last wavelength.
        stop_nm: f64,
        /// Requested step.
        step_nm: f64,
    },
    /// A table needs at least two points.
    #[error("a table needs at least two points, this one has {points}")]
    TooFewPoints {
        /// Number of points.
        points: usize,
    },
    /// NaN or infinity in a table.
    #[error("point {} of the table is not a finite number", point + 1)]
    NotFinite {
        /// Zero-based index.
        point: usize,
    },
    /// Wavelengths must ascend.
    #[error("the wavelengths must ascend; point {} does not", point + 1)]
    NotAscending {
        /// Zero-based index.
        point: usize,
    },
    /// A wavelength outside the range of a table or model.
    #[error("{nm} nm is outside the data, which range from {first} to {last} nm")]
    OutsideTable {
        /// Requested wavelength.
        nm: f64,
        /// First wavelength of the data.
        first: f64,
        /// Last wavelength of the data.
        last: f64,
    },
    /// A parameter outside the range of a model.
    #[error("{quantity} must lie between {first} and {last}, not {value}")]
    OutsideModel {
        /// Name of the parameter, with its unit.
        quantity: &'static str,
        /// Requested value.
        value: f64,
        /// Smallest allowed value.
        first: f64,
        /// Largest allowed value.
        last: f64,
    },
    /// Unknown name of a material or illuminant.
    #[error("there is no {kind} named `{name}`")]
    UnknownName {
        /// "material" or "illuminant".
        kind: &'static str,
        /// Requested name.
        name: String,
    },
    /// A refractive index that is impossible for a passive medium.
    #[error("n = {n}, k = {k} is not a refractive index (expected n >= 0 and k >= 0, not both zero)")]
    NoIndex {
        /// Real part.
        n: f64,
        /// Imaginary part.
        k: f64,
    },
    /// An unknown number of a dispersion formula.
    #[error("there is no dispersion formula {number} (expected 1 to 9)")]
    FormulaNumber {
        /// Requested number.
        number: u8,
    },
    /// Wrong number of coefficients of a dispersion formula.
    #[error("dispersion formula {number} takes {expected} coefficients, not {found}")]
    FormulaCoefficients {
        /// Number of the formula.
        number: u8,
        /// Expected number of coefficients.
        expected: &'static str,
        /// Number of coefficients found.
        found: usize,
    },
    /// A dispersion formula has a pole or gives a negative n^2.
    #[error("dispersion formula {number} gives no index at {nm} nm")]
    FormulaUndefined {
        /// Number of the formula.
        number: u8,
        /// Requested wavelength.
        nm: f64,
    },
    /// A model by parameters has a pole or gives no index.
    #[error("{model} = {value} at {nm} nm, which gives no refractive index")]
    ModelUndefined {
        /// Name of the model, and of its quantity.
        model: &'static str,
        /// Requested wavelength.
        nm: f64,
        /// Value of the quantity.
        value: f64,
    },
    /// Empty range: first and last wavelength in the wrong order, or no overlap of the tables of n and k.
    #[error("no wavelength has both n and k: the shared range would be {first} to {last} nm")]
    NoRange {
        /// First wavelength of the common range.
        first: f64,
        /// Last wavelength of the common range.
        last: f64,
    },
}
