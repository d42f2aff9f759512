//! Gradients with respect to the base's table, from gradients with respect to the reflectance factors.

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
