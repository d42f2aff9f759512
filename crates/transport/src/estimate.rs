//! Results of a solver: reflectance factors under each source alone, and an energy ledger.

/// Result of a solver for one view.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Reflectance factors by source, in the given order.
    pub rho: Vec<ReflectanceFactor>,
    /// Distribution of a unit beam from the view direction.
    pub ledger: Ledger,
}

/// Reflectance factor under one source alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReflectanceFactor {
    /// Light that has met the pixel; shape `[state][wavelength]`.
    pub via_pixel: Vec<f64>,
    /// Light reflected before it met the pixel, the same in all states; shape `[wavelength]`.
    pub front: Vec<f64>,
}

/// Fractions of a unit beam, per state and wavelength (shape `[state][wavelength]`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ledger {
    /// Returned into the air.
    pub returned: Vec<f64>,
    /// Absorbed in the front of screen.
    pub front: Vec<f64>,
    /// Absorbed in the diffuser, or scattered beyond the disc of directions.
    pub diffuser: Vec<f64>,
    /// Absorbed in the glass and other clear layers, coatings included.
    pub glass: Vec<f64>,
    /// Absorbed in the active pixel.
    pub pixel: Vec<f64>,
    /// Absorbed in the inactive area of the panel.
    pub inactive: Vec<f64>,
    /// Not attributed: light that was not followed to its end.
    pub unaccounted: Vec<f64>,
}

impl Ledger {
    /// Returns an account of no light. `len` is the number of states times that of wavelengths.
    pub fn zeros(len: usize) -> Self {
        let zeros = || vec![0.0; len];
        Self {
            returned: zeros(),
            front: zeros(),
            diffuser: zeros(),
            glass: zeros(),
            pixel: zeros(),
            inactive: zeros(),
            unaccounted: zeros(),
        }
    }
}

/// The account of the [`Ledger`] that light absorbed by a layer is added to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Account {
    /// Front-of-screen components.
    Front = 0,
    /// Diffusers, scattering media and rough interfaces.
    Diffuser = 1,
    /// Clear media and coatings.
    Glass = 2,
    /// A pixel that scatters.
    Pixel = 3,
}
