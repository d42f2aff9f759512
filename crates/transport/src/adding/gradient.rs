//! Gradients with respect to the base's table, from gradients with respect to what is seen.

/// How a number changes with the table of a specular base; shapes are the table's own.
#[derive(Debug, Clone, PartialEq)]
pub struct TableGradient {
    /// With each basis reflectance, `[node][basis][wavelength]`.
    pub basis: Vec<f64>,
    /// With the fraction of each basis in each state, `[state][basis]`.
    pub mixture: Vec<f64>,
    /// With what every state reflects besides, `[wavelength]`.
    pub common: Vec<f64>,
}
