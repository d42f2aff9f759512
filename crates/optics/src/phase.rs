//! Phase functions of scattering media.

/// Henyey-Greenstein.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HenyeyGreenstein {
    /// Mean cosine of the scattering angle, -1 to 1 (both excluded).
    pub anisotropy: f64,
}
