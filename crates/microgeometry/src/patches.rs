//! Patches of directions: bands of |beta|, each divided by azimuth.
//!
//! Azimuths are those of propagation, from x towards y. The first patch of a band has the azimuth 0 in its
//! middle.

use std::f64::consts::TAU;

use crate::bands::Bands;
use crate::{MicrogeometryError, Side};

/// Most patches: a kernel between them takes 62 MB in a file, 4 bytes each for light and error, and 300 MB
/// while it is balanced.
pub(crate) const MOST_PATCHES: usize = 2775;

/// Patches of directions on both sides of a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Patches {
    /// Bands of |beta| on both sides.
    pub bands: Bands,
    /// Patches of each band, equal steps of azimuth.
    azimuths: usize,
}

impl Patches {
    /// Patches of a number of azimuths in a turn.
    ///
    /// # Errors
    /// An odd number, for which the reverse of a patch is none; more patches than a kernel can hold.
    pub(crate) fn new(bands: Bands, azimuths: usize) -> Result<Self, MicrogeometryError> {
        let count = bands.count() * azimuths;
        if azimuths == 0 || !azimuths.is_multiple_of(2) || count > MOST_PATCHES {
            let most = MOST_PATCHES / bands.count();
            // Steps of azimuth that are whole degrees are easier to read.
            let finest = (1..=180).find(|deg| 180 % deg == 0 && 360 / deg <= most).unwrap_or(180);
            return Err(MicrogeometryError::Azimuths { azimuths, bands: bands.count(), finest });
        }
        Ok(Self { bands, azimuths })
    }

    /// Number of azimuths in a turn.
    pub fn azimuths(&self) -> usize {
        self.azimuths
    }

    /// Number of patches.
    pub fn count(&self) -> usize {
        self.bands.count() * self.azimuths
    }

    /// Azimuths in the middle of the patches of a band, degrees.
    pub fn phi_deg(&self) -> Vec<f64> {
        (0..self.azimuths).map(|at| 360.0 * at as f64 / self.azimuths as f64).collect()
    }

    /// Étendue of the directions of a patch per area of the surface.
    pub fn area(&self, patch: usize) -> f64 {
        self.bands.area(patch / self.azimuths) / self.azimuths as f64
    }

    /// The patch of a band that contains the azimuth of a direction, given by its parts along x and y.
    pub(crate) fn number(&self, band: usize, along: [f64; 2]) -> usize {
        let turn = along[1].atan2(along[0]) / TAU;
        let at = (turn.rem_euclid(1.0) * self.azimuths as f64).round() as usize;
        band * self.azimuths + at % self.azimuths
    }

    /// The patch of the same light that goes back: the opposite azimuth.
    pub(crate) fn reversed(&self, patch: usize) -> usize {
        let (band, at) = (patch / self.azimuths, patch % self.azimuths);
        band * self.azimuths + (at + self.azimuths / 2) % self.azimuths
    }

    /// The patch in which a flat face transmits this one, if both sides have its band.
    pub(crate) fn across(&self, patch: usize) -> Option<usize> {
        let (band, at) = (patch / self.azimuths, patch % self.azimuths);
        let (side, edges) = self.bands.band(band);
        let there = self.bands.number(side.other(), 0.5 * (edges[0] + edges[1]));
        let same = there < self.bands.count() && self.bands.band(there).1 == edges;
        same.then_some(there * self.azimuths + at)
    }

    /// Side and |beta| of a patch.
    pub fn band(&self, patch: usize) -> (Side, [f64; 2]) {
        self.bands.band(patch / self.azimuths)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patches(azimuths: usize) -> Patches {
        Patches::new(Bands::new([1.0, 1.5]), azimuths).unwrap()
    }

    #[test]
    fn patches_contain_their_azimuths_and_fill_their_band() {
        let patches = patches(24);
        for (deg, at) in [(0.0, 0), (7.4, 0), (7.6, 1), (-7.4, 0), (-7.6, 23), (180.0, 12), (270.0, 18)] {
            let (sin, cos) = f64::to_radians(deg).sin_cos();
            assert_eq!(patches.number(3, [0.2 * cos, 0.2 * sin]), 3 * 24 + at, "{deg}");
        }
        let sum: f64 = (0..24).map(|at| patches.area(3 * 24 + at)).sum();
        assert!((sum - patches.bands.area(3)).abs() < 1e-15);
        for patch in 0..patches.count() {
            let back = patches.reversed(patch);
            assert!(
                back != patch && patches.reversed(back) == patch && patches.band(back) == patches.band(patch)
            );
            if let Some(there) = patches.across(patch) {
                assert_eq!(patches.across(there), Some(patch));
                assert_ne!(patches.band(there).0, patches.band(patch).0);
            }
        }
        // All bands of air have one in the glass; those of trapped light have none.
        assert_eq!(
            (0..patches.count()).filter(|patch| patches.across(*patch).is_some()).count(),
            2 * 36 * 24
        );
        assert_eq!(patches.phi_deg()[6], 90.0);
    }

    /// Patches without a reverse, and kernels beyond the limit, are refused with the finest steps.
    #[test]
    fn impossible_azimuths_are_refused() {
        let of = |azimuths| Patches::new(Bands::new([1.0, 1.5]), azimuths);
        assert_eq!(of(30).unwrap().azimuths(), 30);
        for azimuths in [0, 7, 32, 72] {
            assert_eq!(of(azimuths), Err(MicrogeometryError::Azimuths { azimuths, bands: 92, finest: 12 }));
        }
    }
}
