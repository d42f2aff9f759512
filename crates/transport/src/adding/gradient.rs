//! What the result takes from the base's table: gradients with respect to it, and the light on its nodes.

/// Derivatives of a number by the table of a specular base; shapes are those of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct TableGradient {
    /// By each basis reflectance, `[node][basis][wavelength]`.
    pub basis: Vec<f64>,
    /// By the fraction of each basis in each state, `[state][basis]`.
    pub mixture: Vec<f64>,
    /// By the common reflectance of all states, `[wavelength]`.
    pub common: Vec<f64>,
}

/// Light that a view sees after one reflection by the base, as weights on the nodes of the base's table; for a dispersive
/// medium, at one of the indices between which results are interpolated.
#[derive(Debug, Clone, PartialEq)]
pub struct FirstPass {
    /// Weights on the nodes, `[source][node]`.
    pub rows: Vec<Vec<f64>>,
    /// Factor of the sums of weighted reflectances, `[wavelength]`: the transmittance of front and diffuser on both ways,
    /// and the weight of the index.
    pub through: Vec<f64>,
}
