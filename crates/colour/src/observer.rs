//! CIE standard observers on a wavelength grid: CIE 1931 (2 degrees) and CIE 1964 (10 degrees).
//!
//! **What.** `X = sum S(l) xbar(l)` over integer nanometres `l`, and the same for Y and Z
//! (CIE 15:2018, at 1 nm; Feng 2012, eq. 5-6 to 5-8), with S
//! interpolated linearly between the grid's wavelengths. Because the interpolation is
//! linear in S, it is combined once into a weight for each grid wavelength, and
//! X, Y, Z are three dot products.
//!
//! **Range.** The integer nanometres of the grid from 380 to 780, where
//! `data/observers.csv` tabulates the observer. Wavelengths outside are ignored
//! (they hold 6e-6 of the integral of ybar). A narrower grid loses light of both the
//! white and the display: relative values are then consistent with each other, but not
//! with those of the full range.

use std::sync::LazyLock;

use papilio_spectra::{EveryNm, Grid, LightSpectrum, Spectrum, sum_of_products};

use crate::{ColourError, D65_UV, UvPrime, Xyz};

/// Luminous efficacy of radiation at ybar = 1, lm/W.
///
/// The SI fixes 683 lm/W at 540 THz, slightly off the peak of ybar, which is at
/// 555 nm in standard air; there the efficacy is 683.002 lm/W (CIE 18:2019).
pub const LUMENS_PER_WATT: f64 = 683.002;

/// Standard observer for X, Y, Z. Luminance and illuminance always use V(lambda), the ybar of CIE 1931.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Standard {
    /// CIE 1931 (2 degrees), for fields of 1 to 4 degrees.
    #[default]
    Cie1931,
    /// CIE 1964 (10 degrees), for fields of more than 4 degrees.
    Cie1964,
}

impl Standard {
    /// CIE 1976 u', v' of D65 for this observer (CIE 15:2018, appendix: x = 0.31272, y = 0.32903 for 1931;
    /// x = 0.31381, y = 0.33098 for 1964).
    pub fn d65_uv(self) -> UvPrime {
        match self {
            Self::Cie1931 => D65_UV,
            Self::Cie1964 => UvPrime { u: 0.19786, v: 0.46954 },
        }
    }
}

/// Standard observer, prepared for one wavelength grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Observer {
    /// Weights of xbar, ybar and zbar at each grid wavelength, nm.
    weight: [Vec<f64>; 3],
}

impl Observer {
    /// Prepares the CIE 1931 observer for `grid`.
    ///
    /// # Errors
    /// If the grid contains no integer nanometre from 380 to 780 nm.
    pub fn new(grid: &Grid) -> Result<Self, ColourError> {
        Self::of(Standard::Cie1931, grid)
    }

    /// Prepares a standard observer for `grid`.
    ///
    /// # Errors
    /// The same as those of [`new`](Self::new).
    pub fn of(standard: Standard, grid: &Grid) -> Result<Self, ColourError> {
        let mut weight = [(); 3].map(|()| vec![0.0; grid.len()]);
        let mut any = false;
        for (nm, matching) in matching_functions(standard) {
            // A tolerance of 1e-6 nm allows for rounding at the ends of the grid.
            let position = (nm - grid.start_nm()) / grid.step_nm();
            if nm < grid.start_nm() - 1e-6 || nm > grid.stop_nm() + 1e-6 {
                continue;
            }
            any = true;
            let left = (position.max(0.0) as usize).min(grid.len() - 2);
            let share = (position - left as f64).clamp(0.0, 1.0);
            for (weight, value) in weight.iter_mut().zip(matching.to_array()) {
                weight[left] += (1.0 - share) * value;
                weight[left + 1] += share * value;
            }
        }
        if any {
            Ok(Self { weight })
        } else {
            Err(ColourError::NothingVisible { start_nm: grid.start_nm(), stop_nm: grid.stop_nm() })
        }
    }

    /// Computes the tristimulus values of a spectrum on the observer's grid, in the
    /// spectrum's unit times nm, without normalisation.
    ///
    /// Relative values are obtained by dividing by Y of the white: `xyz * (1.0 / white.y)`.
    pub fn xyz(&self, spectrum: &[f64]) -> Xyz {
        debug_assert_eq!(spectrum.len(), self.weight[0].len());
        let [x, y, z] = &self.weight;
        Xyz {
            x: sum_of_products(x, spectrum),
            y: sum_of_products(y, spectrum),
            z: sum_of_products(z, spectrum),
        }
    }

    /// Computes the luminance, cd/m2, of a spectral radiance in W/(m2 sr nm), or the
    /// illuminance, lx, of a spectral irradiance in W/(m2 nm).
    pub fn luminance(&self, spectrum: &[f64]) -> f64 {
        LUMENS_PER_WATT * sum_of_products(&self.weight[1], spectrum)
    }

    /// Computes the luminance or illuminance of a light, from its means over 1 nm if it has lines.
    pub fn luminance_of_light(&self, light: &LightSpectrum) -> f64 {
        let of_lines = |lines: &EveryNm| Some(Self::new(&lines.grid).ok()?.luminance(&lines.values));
        light.lines().map_or_else(|| self.luminance(light), |lines| of_lines(lines).unwrap_or(0.0))
    }

    /// Scales a relative spectrum to a spectral irradiance, W/(m2 nm), of illuminance `lux`.
    ///
    /// # Errors
    /// If the spectrum contains no visible light.
    pub fn scale_to_illuminance(&self, spectrum: &Spectrum, lux: f64) -> Result<Spectrum, ColourError> {
        let now = self.luminance(spectrum);
        if now > 0.0 && now.is_finite() {
            Ok(spectrum.map(|value| value * (lux / now)))
        } else {
            Err(ColourError::Dark { lux })
        }
    }

    /// Computes the weights with which reflectances at the wavelengths of `grid` contribute to X, Y and Z of
    /// the light that they reflect. This observer is that of `light.grid`. The unit is that of the light
    /// times nm.
    pub fn of_light(&self, light: &EveryNm, grid: &Grid, between: Between) -> [Vec<f64>; 3] {
        debug_assert_eq!(self.weight[0].len(), light.values.len());
        let mut weights = [(); 3].map(|()| vec![0.0; grid.len()]);
        for (l, nm) in light.grid.wavelengths_nm().into_iter().enumerate() {
            for (i, share) in between.shares(grid, nm) {
                for (weights, bar) in weights.iter_mut().zip(&self.weight) {
                    weights[i] += share * bar[l] * light.values[l];
                }
            }
        }
        weights
    }

    /// Returns the weights of X, Y and Z, one for each grid wavelength, nm.
    pub fn weights(&self) -> [&[f64]; 3] {
        [&self.weight[0], &self.weight[1], &self.weight[2]]
    }
}

/// Interpolation of reflectances between the wavelengths of a grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Between {
    /// Linear, between two neighbours.
    Linear,
    /// Cubic, through four neighbours (Lagrange). The difference from linear interpolation estimates the
    /// error of the latter.
    Cubic,
}

impl Between {
    /// Wavelengths of the grid by index, and their weights in the value at `nm`.
    fn shares(self, grid: &Grid, nm: f64) -> Vec<(usize, f64)> {
        let linear: Vec<(usize, f64)> = grid.between(nm).collect();
        let Some(&(left, _)) = linear.first().filter(|_| self == Self::Cubic && grid.len() >= 4) else {
            return linear;
        };
        let first = left.saturating_sub(1).min(grid.len() - 4);
        let at = (nm - grid.start_nm()) / grid.step_nm();
        let share = |i: usize| {
            let others = (first..first + 4).filter(|j| *j != i);
            others.map(|j| (at - j as f64) / (i as f64 - j as f64)).product::<f64>()
        };
        (first..first + 4).map(|i| (i, share(i))).collect()
    }
}

/// Spectral locus: wavelength in nm and tristimulus values of monochromatic light.
///
/// Integer nanometres from 380 to 699; at longer wavelengths the chromaticity is constant.
pub fn spectral_locus() -> impl Iterator<Item = (f64, Xyz)> {
    matching_functions(Standard::Cie1931).take_while(|(nm, _)| *nm < 700.0)
}

/// Wavelength in nm and xbar, ybar, zbar of 1931 and of 1964: the table of the CIE at 1 nm (source:
/// `spectra/data/README.md`).
static TABLE: LazyLock<Vec<[f64; 7]>> = LazyLock::new(|| {
    let rows = include_str!("../data/observers.csv").lines().skip(1);
    let numbers = |row: &str| row.split(',').filter_map(|cell| cell.parse().ok()).collect::<Vec<f64>>();
    rows.filter_map(|row| numbers(row).try_into().ok()).collect()
});

/// Tabulated wavelengths in nm with xbar, ybar and zbar.
fn matching_functions(standard: Standard) -> impl Iterator<Item = (f64, Xyz)> {
    TABLE.iter().map(move |&[nm, x, y, z, x10, y10, z10]| match standard {
        Standard::Cie1931 => (nm, Xyz { x, y, z }),
        Standard::Cie1964 => (nm, Xyz { x: x10, y: y10, z: z10 }),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_spectra::illuminant;
    use papilio_testing::{Dice, laws};

    fn grid(start: f64, stop: f64, step: f64) -> Grid {
        Grid::new(start, stop, step).unwrap()
    }

    /// CIE 15:2018: ybar sums to 106.857 nm, and so (nearly) do xbar and zbar.
    #[test]
    fn the_matching_functions_have_their_published_sums() {
        for step in [0.5, 1.0, 5.0, 20.0] {
            let grid = grid(380.0, 780.0, step);
            let sum = Observer::new(&grid).unwrap().xyz(&Spectrum::constant(&grid, 1.0));
            assert!((sum.y - 106.857).abs() < 1e-3, "{sum:?}");
            assert!((sum.x / sum.y - 1.0).abs() < 1e-3 && (sum.z / sum.y - 1.0).abs() < 1e-3);
        }
    }

    /// CIE 15:2018: x, y of the illuminants for the 2 degree observer
    /// (360 to 830 nm; the light outside 380 to 780 nm is within the tolerance).
    #[test]
    fn illuminants_have_their_published_chromaticities() {
        let grid = grid(380.0, 780.0, 1.0);
        let observer = Observer::new(&grid).unwrap();
        for (name, x, y) in [
            ("D65", 0.31272, 0.32903),
            ("D50", 0.34567, 0.35851),
            ("A", 0.44758, 0.40745),
            ("E", 0.33333, 0.33333),
            ("LED-B1", 0.4560, 0.4078),
        ] {
            let xy = observer.xyz(&illuminant(name, &grid).unwrap()).chromaticity().unwrap();
            assert!((xy.x - x).abs() < 5e-5 && (xy.y - y).abs() < 5e-5, "{name}: {xy:?}");
        }
    }

    /// A 5 nm grid is fine enough for every named illuminant.
    #[test]
    fn chromaticity_of_every_illuminant_is_the_same_on_a_5_nm_grid() {
        let uv = |name: &str, step: f64| {
            let grid = grid(380.0, 780.0, step);
            Observer::new(&grid).unwrap().xyz(&illuminant(name, &grid).unwrap()).uv_prime().unwrap()
        };
        for name in papilio_spectra::illuminant_names() {
            let shift = uv(name, 5.0).distance(uv(name, 1.0));
            assert!(shift < 2e-4, "{name}: {shift}");
        }
    }

    /// The weights equal interpolation to 1 nm followed by summation.
    #[test]
    fn weights_equal_interpolation_to_1_nm() {
        let (coarse, fine) = (grid(381.3, 761.3, 7.6), grid(382.0, 761.0, 1.0));
        let s = |nm: f64| 1.0 + (nm / 37.0).sin();
        let table: Vec<f64> = coarse.wavelengths_nm().into_iter().map(s).collect();
        let between = |nm: f64| {
            let i = (((nm - 381.3) / 7.6) as usize).min(coarse.len() - 2);
            let t = (nm - coarse.wavelength_nm(i)) / 7.6;
            table[i] * (1.0 - t) + table[i + 1] * t
        };
        let interpolated = Spectrum::from_fn(&fine, between);
        let ours = Observer::new(&coarse).unwrap().xyz(&table);
        let plain = Observer::new(&fine).unwrap().xyz(&interpolated);
        for (a, b) in ours.to_array().into_iter().zip(plain.to_array()) {
            assert!((a - b).abs() < 1e-10);
        }
    }

    /// CIE 15:2018: x10 and y10 of D65 and A.
    #[test]
    fn observer_of_1964_gives_the_published_chromaticities() {
        let grid = grid(380.0, 780.0, 1.0);
        let observer = Observer::of(Standard::Cie1964, &grid).unwrap();
        for (name, x, y) in [("D65", 0.31381, 0.33098), ("A", 0.45117, 0.40594)] {
            let xy = observer.xyz(&illuminant(name, &grid).unwrap()).chromaticity().unwrap();
            assert!((xy.x - x).abs() < 1e-4 && (xy.y - y).abs() < 1e-4, "{name} {xy:?}");
        }
        for standard in [Standard::Cie1931, Standard::Cie1964] {
            let observer = Observer::of(standard, &grid).unwrap();
            let d65 = observer.xyz(&illuminant("D65", &grid).unwrap()).uv_prime().unwrap();
            assert!(d65.distance(standard.d65_uv()) < 1e-4, "{d65:?}");
        }
    }

    /// Under a light of a few lines, X, Y and Z of a reflectance that is linear (cubic) over the grid are
    /// exactly those of the sum over 1 nm.
    #[test]
    fn weights_of_a_light_with_lines_equal_summation_at_1_nm() {
        let (coarse, fine) = (grid(380.0, 780.0, 5.0), grid(380.0, 780.0, 1.0));
        let lines = |nm: f64| if [405.0, 436.0, 546.0, 578.0, 611.0].contains(&nm) { 50.0 } else { 0.3 };
        let own = EveryNm { grid: fine, values: Spectrum::from_fn(&fine, lines) };
        let observer = Observer::new(&fine).unwrap();
        type Reflectance = fn(f64) -> f64;
        let cases: [(Between, Reflectance); 2] = [
            (Between::Linear, |x| 0.4 + 0.3 * x),
            (Between::Cubic, |x| 0.4 + 0.3 * x - 0.6 * x * x + 0.2 * x * x * x),
        ];
        for (between, reflectance) in cases {
            let reflectance = |nm: f64| reflectance((nm - 580.0) / 200.0);
            let weights = observer.of_light(&own, &coarse, between);
            let at_nodes = Spectrum::from_fn(&coarse, reflectance);
            let plain = observer.xyz(&Spectrum::from_fn(&fine, |nm| lines(nm) * reflectance(nm)));
            for (weights, plain) in weights.iter().zip(plain.to_array()) {
                let ours = sum_of_products(weights, &at_nodes);
                assert!((ours / plain - 1.0).abs() < 1e-12, "{between:?}: {ours} {plain}");
            }
        }
    }

    #[test]
    fn wavelengths_outside_the_table_are_ignored() {
        let (wide, visible) = (grid(300.0, 900.0, 5.0), grid(380.0, 780.0, 5.0));
        let y = |g: &Grid| Observer::new(g).unwrap().xyz(&Spectrum::constant(g, 1.0)).y;
        assert!((y(&wide) - y(&visible)).abs() < 1e-12);
        let outside = Observer::new(&grid(300.0, 370.0, 5.0));
        assert_eq!(outside, Err(ColourError::NothingVisible { start_nm: 300.0, stop_nm: 370.0 }));
        assert!(Observer::new(&grid(500.2, 500.8, 0.2)).is_err());
    }

    #[test]
    fn scaled_light_has_the_requested_illuminance() {
        let grid = grid(380.0, 780.0, 5.0);
        let observer = Observer::new(&grid).unwrap();
        let light = observer.scale_to_illuminance(&illuminant("A", &grid).unwrap(), 500.0).unwrap();
        assert!((observer.luminance(&light) - 500.0).abs() < 1e-9);
        let dark = observer.scale_to_illuminance(&Spectrum::constant(&grid, 0.0), 500.0);
        assert_eq!(dark, Err(ColourError::Dark { lux: 500.0 }));
    }

    /// Tristimulus values are linear in light (Grassmann), and a perfect white has Y = 1 in any light.
    #[test]
    fn tristimulus_values_are_linear_in_light() {
        let observer = Observer::new(&grid(380.0, 780.0, 5.0)).unwrap();
        let spectrum = |dice: &mut Dice, least| dice.several(81..=81, |dice| dice.between(least, 1.0));
        laws(
            300,
            |dice| (spectrum(dice, 0.0), spectrum(dice, -0.1), dice.between(0.0, 9.0)),
            |(a, b, t)| {
                let mixed: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + t * b).collect();
                let sum = observer.xyz(a) + observer.xyz(b) * *t;
                for (left, right) in observer.xyz(&mixed).to_array().into_iter().zip(sum.to_array()) {
                    assert!((left - right).abs() < 1e-10 * (1.0 + t));
                }
                let white = observer.xyz(a);
                assert!(((white * (1.0 / white.y)).y - 1.0).abs() < 1e-14);
            },
        );
    }
}
