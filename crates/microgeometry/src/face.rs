//! The kernel of a surface as a layer: continuous kernels between rings of directions, for both solvers.
//!
//! Light between bands becomes light between the hats of [`Rings`], whose étendues differ a little, and is
//! balanced once more: the layer loses nothing and is reciprocal. Features narrower than a band are widened
//! to it.

use papilio_optics::scatter::{RingKernel, Rings, Scatter};

use crate::balance::balance;
use crate::bands::{AZIMUTHS, Bands};
use crate::{Kernel, MicrogeometryError, Side};

/// Light of a band, as a fraction of it, that counts as rounding: kernels are balanced to it.
const MOST_LOST: f64 = 1e-6;

/// The kernel of a surface: what a file keeps of it.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceTable {
    /// Index above and below.
    pub index: [f64; 2],
    /// Fraction of the light of a band that goes to each other one, `[from][to][azimuth]`, as in [`Kernel`].
    pub scattered: Vec<f64>,
    /// Fraction of the light of each band that is reflected as by a flat face.
    pub regular_reflected: Vec<f64>,
    /// Fraction of the light of each band that is transmitted as by a flat face.
    pub regular_transmitted: Vec<f64>,
}

/// A surface as kernels between rings.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceKernels {
    /// Transmission of light from above.
    pub through: Scatter,
    /// Reflection of light from above, and of light from below.
    pub reflection: [Scatter; 2],
    /// Rings above and below.
    pub rings: [Rings; 2],
    /// Regular reflectance of the rings above and below.
    pub reflected: [Vec<f64>; 2],
    /// Regular transmittance of the rings of the side with fewer of them.
    pub transmitted: Vec<f64>,
}

impl FaceTable {
    /// The table of a measured kernel.
    pub fn new(index: [f64; 2], kernel: &Kernel) -> Self {
        Self {
            index,
            scattered: kernel.scattered.clone(),
            regular_reflected: kernel.regular_reflected.clone(),
            regular_transmitted: kernel.regular_transmitted.clone(),
        }
    }

    /// A surface that reflects all light as a flat one does: the bands of any surface between these indices,
    /// without light in them.
    pub fn mirror(index: [f64; 2]) -> Self {
        let count = Bands::new(index).count();
        Self {
            index,
            scattered: vec![0.0; count * count * AZIMUTHS],
            regular_reflected: vec![1.0; count],
            regular_transmitted: vec![0.0; count],
        }
    }

    /// Edges of the bands of a side between these indices, `|beta|`.
    pub fn edges(&self, side: Side) -> Vec<f64> {
        Bands::new(self.index).edges(side).to_vec()
    }

    /// The surface as kernels between rings.
    ///
    /// # Errors
    /// A number of values that is not that of the bands; values that are not finite or negative; a kernel
    /// that loses light or is not reciprocal.
    pub fn kernels(&self) -> Result<FaceKernels, MicrogeometryError> {
        let bands = Bands::new(self.index);
        let count = bands.count();
        let lists = [
            ("scattered", &self.scattered, count * count * AZIMUTHS),
            ("regular_reflected", &self.regular_reflected, count),
            ("regular_transmitted", &self.regular_transmitted, count),
        ];
        for (name, values, expected) in lists {
            if values.len() != expected {
                return Err(MicrogeometryError::FaceLength { name, found: values.len(), expected });
            }
            if let Some(value) = values.iter().copied().find(|value| !(value.is_finite() && *value >= 0.0)) {
                let wanted = "finite, not negative";
                return Err(MicrogeometryError::NotANumber {
                    of: "the kernel of a face",
                    what: name,
                    value,
                    wanted,
                });
            }
        }
        self.lossless(count)?;
        self.reciprocal(&bands)?;
        let limits = [1.0, self.index[0], self.index[1]];
        let rings = Side::ALL.map(|side| Rings::new(bands.edges(side), &limits));
        let weights: Vec<f64> = rings.iter().flat_map(|rings| rings.weights().to_vec()).collect();
        let mut light = self.scattered.clone();
        for (from, row) in light.chunks_exact_mut(count * AZIMUTHS).enumerate() {
            for (to, cells) in row.chunks_exact_mut(AZIMUTHS).enumerate() {
                let scale = weights[from]
                    * (weights[to] * bands.area(from) / (weights[from] * bands.area(to))).sqrt();
                cells.iter_mut().for_each(|value| *value *= scale);
            }
        }
        let regular = self.regular_reflected.iter().zip(&self.regular_transmitted);
        let wanted: Vec<f64> =
            weights.iter().zip(regular).map(|(w, (r, t))| w * (1.0 - r - t).max(0.0)).collect();
        balance(&mut light, &wanted);
        let block = |from: Side, to: Side| {
            let rows = bands.of(from).flat_map(|i| {
                let weight = weights[i];
                let row =
                    &light[(i * count + bands.of(to).start) * AZIMUTHS..][..bands.of(to).len() * AZIMUTHS];
                row.iter().map(move |light| light / weight)
            });
            let [from, to] = [from, to].map(|side| rings[side as usize].clone());
            Scatter::from(RingKernel::new(from, to, AZIMUTHS, rows.collect()))
        };
        let part = |values: &[f64], side: Side| values[bands.of(side)].to_vec();
        let rarer = if self.index[0] <= self.index[1] { Side::Above } else { Side::Below };
        Ok(FaceKernels {
            through: block(Side::Above, Side::Below),
            reflection: Side::ALL.map(|side| block(side, side)),
            reflected: Side::ALL.map(|side| part(&self.regular_reflected, side)),
            transmitted: part(&self.regular_transmitted, rarer),
            rings,
        })
    }
    /// Refuses bands whose light does not add up to 1.
    fn lossless(&self, count: usize) -> Result<(), MicrogeometryError> {
        let regular = self.regular_reflected.iter().zip(&self.regular_transmitted);
        for (band, (row, (r, t))) in self.scattered.chunks_exact(count * AZIMUTHS).zip(regular).enumerate() {
            let sum = row.iter().sum::<f64>() + r + t;
            if (sum - 1.0).abs() > MOST_LOST {
                return Err(MicrogeometryError::FaceLoses { band, sum });
            }
        }
        Ok(())
    }

    /// Refuses scattered light that is not the same both ways, per étendue.
    fn reciprocal(&self, bands: &Bands) -> Result<(), MicrogeometryError> {
        let count = bands.count();
        let light = |from: usize, to: usize, azimuth: usize| {
            bands.area(from) * self.scattered[(from * count + to) * AZIMUTHS + azimuth]
        };
        for (from, to) in (0..count).flat_map(|from| (0..from).map(move |to| (from, to))) {
            for azimuth in 0..AZIMUTHS {
                let (there, back) = (light(from, to, azimuth), light(to, from, azimuth));
                if (there - back).abs() > MOST_LOST * bands.area(from).min(bands.area(to)) {
                    return Err(MicrogeometryError::FaceOneWay { from, to, there, back });
                }
            }
        }
        Ok(())
    }
}
