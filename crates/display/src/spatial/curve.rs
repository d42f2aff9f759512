//! Luminous reflectance of a specular pixel against direction.

use papilio_spectra::sum_of_products;
use papilio_transport::{Base, Medium};

/// Number of steps over cos(theta) in the medium.
const STEPS: usize = 768;

/// Y of each state by `|beta|`, tabulated over cos(theta) in the medium, in which films are smooth.
#[derive(Debug, Clone)]
pub(super) struct Curves {
    index: f64,
    states: usize,
    /// `[node][state]`.
    values: Vec<f64>,
}

impl Curves {
    /// Tabulates the states of a base; `weights` are those of each wavelength.
    pub(super) fn new(base: &Base, medium: &Medium, index: f64, weights: &[f64]) -> Self {
        Self::of_quantities(base, medium, index, &[weights])
    }

    /// Tabulates several quantities of the states of a base, each with its weights: `[quantity][state]`, as
    /// if they were more states.
    pub(super) fn of_quantities<W: AsRef<[f64]>>(
        base: &Base,
        medium: &Medium,
        index: f64,
        weights: &[W],
    ) -> Self {
        let (states, bins) = (base.states(), base.bins());
        let mut spectra = vec![0.0; states * bins];
        let mut values = Vec::with_capacity((STEPS + 1) * states * weights.len());
        for node in 0..=STEPS {
            let cosine = node as f64 / STEPS as f64;
            base.reflectance(index * index * (1.0 - cosine * cosine), medium, &mut spectra);
            for weights in weights {
                values.extend(spectra.chunks_exact(bins).map(|row| sum_of_products(row, weights.as_ref())));
            }
        }
        Self { index, states: states * weights.len(), values }
    }

    /// Writes Y of each state at `|beta|^2`: cubic between the nodes.
    pub(super) fn at(&self, beta_squared: f64, y: &mut [f64]) {
        let cosine = (1.0 - beta_squared / (self.index * self.index)).max(0.0).sqrt();
        let place = cosine * STEPS as f64;
        let first = (place.floor() as usize).clamp(1, STEPS - 2) - 1;
        let t = place - (first + 1) as f64;
        let weights = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        y.fill(0.0);
        let rows = self.values[first * self.states..].chunks_exact(self.states);
        for (weight, row) in weights.iter().zip(rows) {
            y.iter_mut().zip(row).for_each(|(y, value)| *y += weight * value);
        }
    }
}
