//! Spectrum of a light on the grid of a computation, with its own finer spectrum.
//!
//! A light without narrow lines is represented by its values at the wavelengths of the grid, and linear between
//! them. A light with lines narrower than the step of the grid is represented by its means over 1 nm, at integer
//! wavelengths. Its values on the grid are then means over bands of the grid, so that the sum over the grid
//! is that of the light. Colours are computed from the means over 1 nm
//! (`papilio_colour::Observer::of_light`).
//!
//! Any light may have its own spectrum at integer wavelengths, from which the error of sums over the grid is
//! estimated.
//!
//! **Means over bands.** The mean at a wavelength of the grid is weighted by the triangle that is 1 there and
//! 0 at the neighbours: the weight with which linear interpolation uses this wavelength.

use std::ops::Deref;
use std::sync::Arc;

use crate::{Grid, SpectraError, Spectrum, Tabulated};

/// Spectrum of a light, relative or in a unit.
#[derive(Debug, Clone, PartialEq)]
pub struct LightSpectrum {
    on_grid: Spectrum,
    every_nm: Option<Arc<EveryNm>>,
    /// Whether the values on the grid are means over its bands.
    has_lines: bool,
}

/// A light at every nanometre.
#[derive(Debug, Clone, PartialEq)]
pub struct EveryNm {
    /// Integer wavelengths within the grid of the computation, nm.
    pub grid: Grid,
    /// Value, or mean over 1 nm, at each of them.
    pub values: Spectrum,
}

impl LightSpectrum {
    /// Light with lines, from its means over 1 nm within `grid`.
    ///
    /// # Errors
    /// If `means` does not have a value at each integer wavelength of `grid` (see [`Grid::integers`]).
    pub fn with_lines(grid: &Grid, means: Spectrum) -> Result<Self, SpectraError> {
        let own = grid.integers()?;
        if means.len() != own.len() {
            return Err(SpectraError::TooFewPoints { points: means.len() });
        }
        let mut sums = vec![(0.0, 0.0); grid.len()];
        for (nm, mean) in own.wavelengths_nm().into_iter().zip(means.iter()) {
            for (i, weight) in grid.between(nm) {
                sums[i].0 += weight * mean;
                sums[i].1 += weight;
            }
        }
        // Every wavelength of a grid whose step is at least 1 nm is within 1 nm of an integer one.
        let on_grid = sums.into_iter().map(|(sum, weight)| if weight > 0.0 { sum / weight } else { 0.0 });
        let on_grid = Spectrum::from_values(on_grid.collect());
        let every_nm = Some(Arc::new(EveryNm { grid: own, values: means }));
        Ok(Self { on_grid, every_nm, has_lines: true })
    }

    /// Light without narrow lines, which `spectrum` computes on any grid. On a grid of less than 1 nm it is known
    /// on the grid alone.
    ///
    /// # Errors
    /// Those of `spectrum`.
    pub fn sampled(
        grid: &Grid,
        spectrum: impl Fn(&Grid) -> Result<Spectrum, SpectraError>,
    ) -> Result<Self, SpectraError> {
        let on_grid = spectrum(grid)?;
        let own = grid.integers().ok();
        let every_nm =
            own.map(|grid| Ok(Arc::new(EveryNm { grid, values: spectrum(&grid)? }))).transpose()?;
        Ok(Self { on_grid, every_nm, has_lines: false })
    }

    /// Means over 1 nm, if the light has lines narrower than the step of the grid.
    pub fn lines(&self) -> Option<&EveryNm> {
        self.every_nm().filter(|_| self.has_lines)
    }

    /// The light at every nanometre, if it is known there.
    pub fn every_nm(&self) -> Option<&EveryNm> {
        self.every_nm.as_deref()
    }

    /// Light after a filter, whose transmittance `filter` computes on any grid.
    ///
    /// # Errors
    /// Those of `filter`.
    pub fn filtered(
        &self,
        grid: &Grid,
        filter: impl Fn(&Grid) -> Result<Spectrum, SpectraError>,
    ) -> Result<Self, SpectraError> {
        let every_nm = self.every_nm().map(|own| {
            let values = filter(&own.grid)?.zip_map(&own.values, |a, b| a * b);
            Ok(EveryNm { grid: own.grid, values })
        });
        match every_nm.transpose()? {
            Some(own) if self.has_lines => Self::with_lines(grid, own.values),
            own => Ok(Self {
                on_grid: filter(grid)?.zip_map(&self.on_grid, |a, b| a * b),
                every_nm: own.map(Arc::new),
                has_lines: false,
            }),
        }
    }
}

impl From<Spectrum> for LightSpectrum {
    fn from(on_grid: Spectrum) -> Self {
        Self { on_grid, every_nm: None, has_lines: false }
    }
}

impl Deref for LightSpectrum {
    type Target = Spectrum;
    fn deref(&self) -> &Spectrum {
        &self.on_grid
    }
}

impl Grid {
    /// Integer wavelengths within the grid, as a grid of 1 nm.
    ///
    /// # Errors
    /// If there are fewer than two, or the step is below 1 nm: means over 1 nm are then coarser than the
    /// grid.
    pub fn integers(&self) -> Result<Self, SpectraError> {
        let (first, last) = ((self.start_nm() - 1e-6).ceil(), (self.stop_nm() + 1e-6).floor());
        if self.step_nm() < 1.0 {
            return Err(SpectraError::Grid { start_nm: first, stop_nm: last, step_nm: self.step_nm() });
        }
        Self::new(first, last, 1.0)
    }

    /// The two wavelengths of the grid next to `nm`, by index, each with its weight in linear interpolation;
    /// none outside the grid.
    pub fn between(&self, nm: f64) -> impl Iterator<Item = (usize, f64)> {
        let position = (nm - self.start_nm()) / self.step_nm();
        let inside = nm >= self.start_nm() - 1e-6 && nm <= self.stop_nm() + 1e-6;
        let left = (position.max(0.0) as usize).min(self.len() - 2);
        let share = (position - left as f64).clamp(0.0, 1.0);
        [(left, 1.0 - share), (left + 1, share)].into_iter().filter(move |_| inside)
    }
}

impl Tabulated {
    /// Means of the table over the bands of `grid`, each weighted by the triangle between its neighbours:
    /// exact integrals of the lines between the points. A band at an end of the table is its part within the
    /// table.
    ///
    /// # Errors
    /// If the table does not cover the grid.
    pub fn means(&self, grid: &Grid) -> Result<Spectrum, SpectraError> {
        let step = grid.step_nm();
        let mean = |centre: f64| {
            let (first, last) = self.range_nm();
            let (from, to) = ((centre - step).max(first), (centre + step).min(last));
            let points = self.wavelengths_nm().iter().copied().filter(|nm| *nm > from && *nm < to);
            let mut points: Vec<f64> = points.chain([from, centre, to]).collect();
            points.sort_by(f64::total_cmp);
            let weight = |nm: f64| (1.0 - (nm - centre).abs() / step).max(0.0);
            let (mut sum, mut weights) = (0.0, 0.0);
            for pair in points.windows(2).filter(|pair| pair[1] > pair[0]) {
                let middle = 0.5 * (pair[0] + pair[1]);
                // Simpson's rule is exact for the product of two lines.
                for (nm, part) in [(pair[0], 1.0), (middle, 4.0), (pair[1], 1.0)] {
                    let weight = part * (pair[1] - pair[0]) * weight(nm);
                    sum += weight * self.at(nm)?;
                    weights += weight;
                }
            }
            Ok(if weights > 0.0 { sum / weights } else { self.at(centre)? })
        };
        self.on(grid)?;
        let means: Result<Vec<f64>, _> = grid.wavelengths_nm().into_iter().map(mean).collect();
        means.map(Spectrum::from_values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum of the means times the step is the light, wherever its lines are.
    #[test]
    fn means_over_bands_keep_the_light() {
        for (start, step) in [(380.0, 5.0), (381.3, 7.6), (380.0, 1.0)] {
            let grid = Grid::new(start, start + 50.0 * step, step).unwrap();
            let own = grid.integers().unwrap();
            let middle = start + 25.0 * step;
            for line in [middle.round(), middle.round() + 1.0, middle.round() + 2.0] {
                let means = Spectrum::from_fn(&own, |nm| if nm == line { 1.0 } else { 0.0 });
                let light = LightSpectrum::with_lines(&grid, means).unwrap();
                let weights = |i: usize| {
                    own.wavelengths_nm()
                        .iter()
                        .flat_map(|nm| grid.between(*nm))
                        .filter(|at| at.0 == i)
                        .map(|at| at.1)
                        .sum::<f64>()
                };
                let sum: f64 = (0..grid.len()).map(|i| light[i] * weights(i)).sum();
                assert!((sum - 1.0).abs() < 1e-12, "{start} {step} {line}: {sum}");
            }
        }
    }

    /// A triangular line of full width 0.2 nm at 546.07 nm has an area of 0.1 nm, which two means over 1 nm
    /// share.
    #[test]
    fn means_of_a_table_are_exact_integrals() {
        let table = Tabulated::new(vec![400.0, 545.97, 546.07, 546.17, 700.0], vec![0.0, 0.0, 1.0, 0.0, 0.0])
            .unwrap();
        let grid = Grid::new(540.0, 550.0, 1.0).unwrap();
        let means = table.means(&grid).unwrap();
        assert!((means.iter().sum::<f64>() - 0.1).abs() < 1e-13);
        assert!((means[6] / 0.1 - 0.93).abs() < 0.01 && (means[7] / 0.1 - 0.07).abs() < 0.01, "{means:?}");
        // Means of a straight line are the line itself, also at its ends' inner neighbours.
        let line = Tabulated::new(vec![539.0, 551.0], vec![1.0, 13.0]).unwrap().means(&grid).unwrap();
        assert!((0..=10).all(|i| (line[i] - (2.0 + f64::from(i as u32))).abs() < 1e-12), "{line:?}");
        assert!(table.means(&Grid::new(390.0, 400.0, 1.0).unwrap()).is_err());
    }

    #[test]
    fn grids_finer_than_1_nm_have_no_lines() {
        let grid = Grid::new(380.0, 780.0, 0.5).unwrap();
        assert!(LightSpectrum::with_lines(&grid, Spectrum::constant(&grid, 1.0)).is_err());
        let grid = Grid::new(380.0, 780.0, 5.0).unwrap();
        assert!(LightSpectrum::with_lines(&grid, Spectrum::constant(&grid, 1.0)).is_err());
    }
}
