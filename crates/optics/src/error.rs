//! What can be wrong with a film, or with a question about one.

/// Why a film could not be made or evaluated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OpticsError {
    /// A refractive index that no passive medium has.
    #[error("n = {n}, k = {k} is not a refractive index (expected n >= 0 and k >= 0, not both zero)")]
    Index {
        /// Real part.
        n: f64,
        /// Imaginary part.
        k: f64,
    },
    /// The medium that the light comes from must be transparent.
    #[error("the incidence medium has n = {n} (expected a finite n > 0)")]
    Incidence {
        /// Its index.
        n: f64,
    },
    /// A thickness is negative or not finite.
    #[error("a layer of {nm} nm (expected 0 or more)")]
    Thickness {
        /// The thickness asked for.
        nm: f64,
    },
    /// A wavelength is not positive.
    #[error("a wavelength of {nm} nm (expected a finite number above 0)")]
    Wavelength {
        /// The wavelength asked for.
        nm: f64,
    },
    /// A direction that does not exist in the incidence medium.
    #[error("beta = {beta} (expected 0 <= beta < {limit})")]
    Beta {
        /// The beta asked for.
        beta: f64,
        /// The index of the incidence medium, or infinity.
        limit: f64,
    },
    /// Several layers follow the gap.
    #[error("{found} layers have the gap's thickness (expected one at most)")]
    Gaps {
        /// How many there are.
        found: usize,
    },
    /// A derivative by a layer that a film does not have.
    #[error("there is no layer number {layer} (the film has {layers}, counted from 0)")]
    NoLayer {
        /// Its number.
        layer: usize,
        /// How many there are.
        layers: usize,
    },
    /// A coating's layers have fixed thicknesses.
    #[error("a layer of a coating has the gap's thickness (expected a thickness in nm)")]
    CoatingGap,
    /// A coating's fringes over direction are too many to tabulate.
    #[error(
        "layer {layer} of the coating, of {thickness_nm} nm, makes {fringes} interference fringes over angle at {nm} nm, \
         more than are tabulated (expected films of 0.05 mm in all at most)"
    )]
    Fringes {
        /// The layer that makes the most, counted from 0.
        layer: usize,
        /// Its thickness.
        thickness_nm: f64,
        /// Their number, from the normal to the horizon in the layer.
        fringes: f64,
        /// The wavelength.
        nm: f64,
    },
    /// Two arrays do not fit each other.
    #[error("{what}: {found} values (expected {expected})")]
    Length {
        /// Which array.
        what: &'static str,
        /// How long it should be.
        expected: usize,
        /// How long it is.
        found: usize,
    },
    /// The nodes of a table are out of order or range.
    #[error("{what} (expected {expected})")]
    Axis {
        /// Which nodes.
        what: &'static str,
        /// What they should be.
        expected: &'static str,
    },
    /// A density that is none.
    #[error("density number {at} is {value} (expected a finite number, 0 or more)")]
    Density {
        /// Its number from 0 in the order given.
        at: usize,
        /// The value.
        value: f64,
    },
    /// A root mean square slope that no face has.
    #[error("a slope of {alpha} (expected .005 to 1)")]
    Slope {
        /// The slope asked for.
        alpha: f64,
    },
}
