//! Errors of films, interfaces and scatterers.

/// Reason why a film or scatterer could not be built or evaluated.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum OpticsError {
    /// A refractive index that is impossible for a passive medium.
    #[error("n = {n}, k = {k} is not a refractive index (expected n >= 0 and k >= 0, not both zero)")]
    Index {
        /// Real part.
        n: f64,
        /// Imaginary part.
        k: f64,
    },
    /// The medium of the incident light must be transparent.
    #[error("the incidence medium has n = {n} (expected a finite n > 0)")]
    Incidence {
        /// Its index.
        n: f64,
    },
    /// A thickness is negative or not finite.
    #[error("a layer of {nm} nm (expected 0 or more)")]
    Thickness {
        /// Given thickness.
        nm: f64,
    },
    /// A wavelength is not positive.
    #[error("a wavelength of {nm} nm (expected a finite number above 0)")]
    Wavelength {
        /// Given wavelength.
        nm: f64,
    },
    /// A direction that does not exist in the incidence medium.
    #[error("beta = {beta} (expected 0 <= beta < {limit})")]
    Beta {
        /// Given beta.
        beta: f64,
        /// The index of the incidence medium, or infinity.
        limit: f64,
    },
    /// Several layers follow the gap.
    #[error("{found} layers have the gap's thickness (expected one at most)")]
    Gaps {
        /// Number of these layers.
        found: usize,
    },
    /// A derivative by a layer that the film does not have.
    #[error("there is no layer number {layer} (the film has {layers}, counted from 0)")]
    NoLayer {
        /// Number of the layer.
        layer: usize,
        /// Number of layers of the film.
        layers: usize,
    },
    /// A layer of a coating without a fixed thickness.
    #[error("a layer of a coating has the gap's thickness (expected a thickness in nm)")]
    CoatingGap,
    /// A coating with too many fringes over direction to tabulate.
    #[error(
        "layer {layer} of the coating, of {thickness_nm} nm, makes {fringes} interference fringes over angle at {nm} nm, \
         and its table over direction would need more than {most} panels (expected fewer or wider fringes: a thinner layer, or mirrors around it \
         that reflect less)",
        most = crate::film::Coating::MOST_PANELS
    )]
    Fringes {
        /// Layer with the most fringes, counted from 0.
        layer: usize,
        /// Its thickness.
        thickness_nm: f64,
        /// Number of fringes, from the normal to the horizon in the layer.
        fringes: f64,
        /// The wavelength.
        nm: f64,
    },
    /// Two arrays of different length.
    #[error("{what}: {found} values (expected {expected})")]
    Length {
        /// Name of the array.
        what: &'static str,
        /// Expected length.
        expected: usize,
        /// Actual length.
        found: usize,
    },
    /// Nodes of a table that are out of order or range.
    #[error("{what} (expected {expected})")]
    Axis {
        /// Name of the nodes.
        what: &'static str,
        /// Expected order or range.
        expected: &'static str,
    },
    /// An invalid density.
    #[error("density number {at} is {value} (expected a finite number, 0 or more)")]
    Density {
        /// Its number, counted from 0 in the given order.
        at: usize,
        /// The value.
        value: f64,
    },
    /// A root mean square slope that is out of range.
    #[error("a slope of {alpha} (expected 0.005 to 1)")]
    Slope {
        /// Given slope.
        alpha: f64,
    },
}
