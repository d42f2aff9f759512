//! What a solver answers: reflectance factors under each source alone, and a ledger of energy.

/// What a solver answers for one view.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// For each source, in the order they were given.
    pub rho: Vec<ReflectanceFactor>,
    /// Where a unit beam from the view direction ends.
    pub ledger: Ledger,
}

/// Reflectance factor under one source alone.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReflectanceFactor {
    /// Light that met the pixel; shape `[state][wavelength]`.
    pub via_pixel: Vec<f64>,
    /// Light reflected before it met the pixel, the same in all states; shape `[wavelength]`.
    pub front: Vec<f64>,
}

/// Fractions of a unit beam, per state and wavelength (shape `[state][wavelength]`).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ledger {
    /// Back into the room.
    pub returned: Vec<f64>,
    /// Absorbed in the front of screen.
    pub front: Vec<f64>,
    /// Absorbed in the diffuser, or beyond its lobe's reach.
    pub diffuser: Vec<f64>,
    /// Absorbed in the glass and other clear layers, coatings included.
    pub glass: Vec<f64>,
    /// Absorbed in the active pixel.
    pub pixel: Vec<f64>,
    /// Absorbed in the inactive share of the panel.
    pub inactive: Vec<f64>,
    /// Not followed to its end.
    pub unaccounted: Vec<f64>,
}

impl Ledger {
    pub(crate) fn zeros(len: usize) -> Self {
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
    /// Diffusers, scattering media and rough faces.
    Diffuser = 1,
    /// Clear media and coatings.
    Glass = 2,
    /// A pixel that scatters.
    Pixel = 3,
}
