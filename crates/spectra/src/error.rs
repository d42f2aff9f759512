//! What can be wrong with spectral data.

/// Why a grid, a table or a material could not be made or sampled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpectraError {
    /// The three numbers do not make a grid.
    #[error(
        "{start_nm} to {stop_nm} nm in steps of {step_nm} nm is not a grid (expected 0 < start < stop and a whole number of steps, at most {} points)",
        crate::Grid::MAX_LEN
    )]
    Grid {
        /// First wavelength asked for.
        start_nm: f64,
        /// Last wavelength asked for.
        stop_nm: f64,
        /// Step asked for.
        step_nm: f64,
    },
    /// A table needs at least two points.
    #[error("a table needs at least two points, this one has {points}")]
    TooFewPoints {
        /// How many there are.
        points: usize,
    },
    /// NaN or infinity in a table.
    #[error("point {} of the table is not a finite number", point + 1)]
    NotFinite {
        /// Zero-based position.
        point: usize,
    },
    /// Wavelengths must ascend.
    #[error("the wavelengths must ascend, point {} does not", point + 1)]
    NotAscending {
        /// Zero-based position.
        point: usize,
    },
    /// A table or model is asked for a wavelength that it does not have.
    #[error("{nm} nm is outside the data, which reach from {first} to {last} nm")]
    OutsideTable {
        /// The wavelength asked for.
        nm: f64,
        /// Where the data begin.
        first: f64,
        /// Where they end.
        last: f64,
    },
    /// A parameter that a model is not made for.
    #[error("{quantity} must lie between {first} and {last}, not {value}")]
    OutsideModel {
        /// What it is, with its unit.
        quantity: &'static str,
        /// What was asked for.
        value: f64,
        /// Smallest value allowed.
        first: f64,
        /// Largest value allowed.
        last: f64,
    },
    /// No material or illuminant of that name.
    #[error("there is no {kind} named `{name}`")]
    UnknownName {
        /// "material" or "illuminant".
        kind: &'static str,
        /// What was asked for.
        name: String,
    },
    /// A refractive index that no passive medium has.
    #[error("n = {n}, k = {k} is not a refractive index (expected n >= 0 and k >= 0, not both zero)")]
    NoIndex {
        /// Real part.
        n: f64,
        /// Imaginary part.
        k: f64,
    },
    /// A dispersion formula is not one of the nine.
    #[error("there is no dispersion formula {number} (expected 1 to 9)")]
    FormulaNumber {
        /// The number asked for.
        number: u8,
    },
    /// A dispersion formula has too few or too many coefficients.
    #[error("dispersion formula {number} takes {expected} coefficients, not {found}")]
    FormulaCoefficients {
        /// The formula's number.
        number: u8,
        /// How many it takes.
        expected: &'static str,
        /// How many there are.
        found: usize,
    },
    /// A dispersion formula has a pole, or gives a negative square.
    #[error("dispersion formula {number} gives no index at {nm} nm")]
    FormulaUndefined {
        /// The formula's number.
        number: u8,
        /// The wavelength asked for.
        nm: f64,
    },
    /// The data hold nowhere: an empty range, or n and k known at different wavelengths.
    #[error("no wavelength has both n and k: the shared range would be {first} to {last} nm")]
    NoRange {
        /// Where the shared range would begin.
        first: f64,
        /// Where it would end.
        last: f64,
    },
}
