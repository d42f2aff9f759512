//! Results of a solver: reflectance factors under each source alone, and an energy ledger.

use papilio_spectra::StateSpectra;

/// Result of a solver for one view.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Estimate {
    /// Reflectance factors by source, in the given order.
    pub rho: Vec<ReflectanceFactor>,
    /// Distribution of a unit beam from the view direction.
    pub ledger: Ledger,
}

/// Reflectance factor under one source alone; or, of a mirror image, its radiance relative to the source's.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReflectanceFactor {
    /// Light that has met the pixel.
    pub via_pixel: StateSpectra,
    /// Light reflected before it met the pixel, the same in all states; shape `[wavelength]`.
    pub front: Vec<f64>,
}

/// Fractions of a unit beam.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Ledger {
    /// Returned into the air.
    pub returned: StateSpectra,
    /// Absorbed in the front of screen.
    pub front: StateSpectra,
    /// Absorbed in the diffuser, or scattered beyond the disc of directions.
    pub diffuser: StateSpectra,
    /// Absorbed in the glass and other clear layers, coatings included.
    pub glass: StateSpectra,
    /// Absorbed in the active pixel.
    pub pixel: StateSpectra,
    /// Absorbed in the inactive area of the panel.
    pub inactive: StateSpectra,
    /// Not attributed: light that was not followed to its end.
    pub unaccounted: StateSpectra,
}

impl ReflectanceFactor {
    /// Returns the factor of a dark display.
    pub fn zeros(states: usize, wavelengths: usize) -> Self {
        Self { via_pixel: StateSpectra::zeros(states, wavelengths), front: vec![0.0; wavelengths] }
    }

    /// Returns all light, whether it has met the pixel or not.
    pub fn total(&self) -> StateSpectra {
        let mut total = self.via_pixel.clone();
        for row in total.rows_mut() {
            row.iter_mut().zip(&self.front).for_each(|(sum, front)| *sum += front);
        }
        total
    }

    /// Returns the weighted sum of two: of s and of p.
    pub(crate) fn mixed_with(&self, other: &Self, weights: [f64; 2]) -> Self {
        let front = self.front.iter().zip(&other.front).map(|(s, p)| sum_of([*s, *p], weights));
        Self { via_pixel: mixed(&self.via_pixel, &other.via_pixel, weights), front: front.collect() }
    }

    /// Multiplies it by a factor of each wavelength.
    pub(crate) fn scale(&mut self, factor: &[f64]) {
        let bins = factor.len();
        self.via_pixel.iter_mut().enumerate().for_each(|(k, value)| *value *= factor[k % bins]);
        self.front.iter_mut().zip(factor).for_each(|(value, factor)| *value *= factor);
    }

    /// Adds another one, times a weight.
    pub(crate) fn add(&mut self, other: &Self, weight: f64) {
        let add = |sum: &mut [f64], values: &[f64]| {
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        };
        add(&mut self.via_pixel, &other.via_pixel);
        add(&mut self.front, &other.front);
    }
}

impl Estimate {
    /// Returns the weighted sum of two estimates: of s and of p; `of_source` are the weights of each source, `weights`
    /// those of the ledger.
    pub(crate) fn mixed_with(&self, other: &Self, of_source: &[[f64; 2]], weights: [f64; 2]) -> Self {
        let pairs = self.rho.iter().zip(&other.rho).zip(of_source);
        let rho = pairs.map(|((one, other), weights)| one.mixed_with(other, *weights));
        Self { rho: rho.collect(), ledger: self.ledger.mixed_with(&other.ledger, weights) }
    }
}

impl Ledger {
    fn mixed_with(&self, other: &Self, weights: [f64; 2]) -> Self {
        let mixed = |one, other| mixed(one, other, weights);
        Self {
            returned: mixed(&self.returned, &other.returned),
            front: mixed(&self.front, &other.front),
            diffuser: mixed(&self.diffuser, &other.diffuser),
            glass: mixed(&self.glass, &other.glass),
            pixel: mixed(&self.pixel, &other.pixel),
            inactive: mixed(&self.inactive, &other.inactive),
            unaccounted: mixed(&self.unaccounted, &other.unaccounted),
        }
    }

    /// Returns an account of no light.
    pub fn zeros(states: usize, wavelengths: usize) -> Self {
        let zeros = || StateSpectra::zeros(states, wavelengths);
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

/// Returns the weighted sum of two of the same shape.
fn mixed(one: &StateSpectra, other: &StateSpectra, weights: [f64; 2]) -> StateSpectra {
    let mut sum = one.clone();
    sum.iter_mut().zip(other.iter()).for_each(|(sum, value)| *sum = sum_of([*sum, *value], weights));
    sum
}

/// Returns a weighted sum of s and p; exactly 0 where they cancel to rounding, as between crossed polarisers.
fn sum_of(both: [f64; 2], weights: [f64; 2]) -> f64 {
    let [s, p] = [both[0] * weights[0], both[1] * weights[1]];
    if (s + p).abs() <= 1e-13 * s.abs().max(p.abs()) { 0.0 } else { s + p }
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
