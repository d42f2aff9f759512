//! A pattern of Lambertian reflectances under a face that returns light to it, through all orders.
//!
//! **What.** The irradiance of a pattern rho(x), relative to that of the light from outside, is
//! `E = 1 + A * (rho E)`, with the return A of the layers above ([`FaceReturn`](super::FaceReturn),
//! [`LambertianReturn`](super::LambertianReturn)); what leaves upwards is `rho E`. In the Fourier domain A
//! multiplies, between x and f the fast Fourier transform. A is below 0.6, so that repeating converges.
//!
//! **Limits.** Features much larger than the thickness: `rho/(1 - A(0) rho)` for each point. Much smaller:
//! the mean reflectance in the place of rho in the denominator (Clapper and Yule).
//!
//! **Spread inside the pixel.** With a [`PixelSpread`] P, `rho E` becomes `sqrt(rho) P * (sqrt(rho) E)`,
//! between the means of cells.

use num_complex::Complex64;
use papilio_fourier::Plane;

use super::PixelSpread;

/// Cells of a period of a pattern: rows from the bottom, columns from the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cells {
    /// Number of columns and rows.
    pub count: [usize; 2],
    /// Period along x and y, mm.
    pub period_mm: [f64; 2],
}

impl Cells {
    /// Number of cells.
    pub fn len(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Returns true if there is no cell.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Width and height of a cell, mm.
    pub fn size(&self) -> [f64; 2] {
        [0, 1].map(|axis| self.period_mm[axis] / self.count[axis] as f64)
    }

    /// Middle of a cell, mm.
    pub fn middle(&self, cell: usize) -> [f64; 2] {
        let [x, y] = [cell % self.count[0], cell / self.count[0]];
        let size = self.size();
        [(x as f64 + 0.5) * size[0], (y as f64 + 0.5) * size[1]]
    }

    /// Highest frequency of these cells, cycles per mm.
    pub fn most_per_mm(&self) -> f64 {
        let [x, y] = [0, 1].map(|k| 0.5 * self.count[k] as f64 / self.period_mm[k]);
        x.hypot(y)
    }

    /// Frequency along an axis (0: x) of a bin of the discrete Fourier transform.
    pub(super) fn frequency(&self, axis: usize, bin: usize) -> f64 {
        let count = self.count[axis];
        let wave = if 2 * bin <= count { bin as f64 } else { bin as f64 - count as f64 };
        wave / self.period_mm[axis]
    }
}

/// Face above a periodic pattern.
pub struct Recycling {
    cells: Cells,
    /// Return at each bin, over the number of cells; columns vary slowest (transposed).
    transfer: Vec<f64>,
    /// Spread inside the pixels at each bin, in the same order and unit.
    spread: Option<Vec<f64>>,
    plane: Plane,
}

impl Recycling {
    /// Prepares the layers above for patterns of these cells. `returned`: fraction that comes back at a
    /// frequency, cycles per mm.
    pub fn new(cells: Cells, returned: impl Fn(f64) -> f64) -> Self {
        let [columns, rows] = cells.count;
        let scale = 1.0 / cells.len() as f64;
        let mut transfer = vec![0.0; cells.len()];
        for column in 0..columns {
            // A is even: the other half is its mirror image.
            for row in 0..=rows / 2 {
                let f = cells.frequency(0, column).hypot(cells.frequency(1, row));
                let mirror = (columns - column) % columns;
                let at = column * rows + row;
                transfer[at] =
                    if mirror < column { transfer[mirror * rows + row] } else { scale * returned(f) };
                transfer[column * rows + (rows - row) % rows] = transfer[at];
            }
        }
        Self { cells, transfer, spread: None, plane: Plane::new(cells.count) }
    }

    /// The same pixels, inside which light spreads.
    #[must_use]
    pub fn with_spread(self, spread: Option<PixelSpread>) -> Self {
        let scale = 1.0 / self.cells.len() as f64;
        let factors = |spread: PixelSpread| {
            spread
                .between(self.cells.count, self.cells.period_mm)
                .into_iter()
                .map(|factor| scale * factor)
                .collect()
        };
        Self { spread: spread.map(factors), ..self }
    }

    /// Irradiance of each cell relative to that of the light from outside, for the mean reflectance of each
    /// cell. Ends when a repetition changes no cell by more than `tolerance`.
    ///
    /// Where light spreads inside the pixels, it is the irradiance that a cell would need for the same light
    /// without spread.
    pub fn irradiance(&self, reflectance: &[f64], tolerance: f64) -> Vec<f64> {
        let mut irradiance = vec![1.0; reflectance.len()];
        // Uniform patterns have E = 1/(1 - A(0) rho).
        let mean = reflectance.iter().sum::<f64>() / reflectance.len() as f64;
        irradiance.fill(1.0 / (1.0 - self.transfer[0] * self.cells.len() as f64 * mean));
        let roots: Vec<f64> = reflectance.iter().map(|rho| rho.max(0.0).sqrt()).collect();
        loop {
            let inside = self.spread.as_ref().map(|spread| self.inside(spread, &roots, &irradiance));
            let radiosity: Vec<f64> = match &inside {
                Some(inside) => roots.iter().zip(inside).map(|(root, light)| root * light).collect(),
                None => reflectance.iter().zip(&irradiance).map(|(rho, e)| rho * e).collect(),
            };
            let returned = self.returned(&radiosity);
            let mut change = 0.0_f64;
            for (value, returned) in irradiance.iter_mut().zip(returned) {
                change = change.max((1.0 + returned - *value).abs());
                *value = 1.0 + returned;
            }
            if change.is_nan() || change <= tolerance {
                let Some(inside) = inside else { return irradiance };
                let of_cell =
                    |(k, light): (usize, f64)| if roots[k] > 0.0 { light / roots[k] } else { irradiance[k] };
                return inside.into_iter().enumerate().map(of_cell).collect();
            }
        }
    }

    /// Light inside the pixels on its way out of each cell.
    fn inside(&self, spread: &[f64], roots: &[f64], irradiance: &[f64]) -> Vec<f64> {
        let entered: Vec<f64> = roots.iter().zip(irradiance).map(|(root, e)| root * e).collect();
        self.multiplied(&entered, spread)
    }

    /// Light that the face returns of what leaves each cell.
    pub fn returned(&self, radiosity: &[f64]) -> Vec<f64> {
        self.multiplied(radiosity, &self.transfer)
    }

    /// Multiplies the transform of the cells by factors over their number.
    fn multiplied(&self, cells: &[f64], factors: &[f64]) -> Vec<f64> {
        let cells = cells.iter().map(|value| Complex64::new(*value, 0.0)).collect();
        let mut spectrum = self.plane.forward(cells);
        spectrum.iter_mut().zip(factors).for_each(|(value, factor)| *value *= factor);
        self.plane.inverse(spectrum).into_iter().map(|value| value.re).collect()
    }
}

#[cfg(test)]
mod tests {
    use papilio_optics::interface::fresnel_reflectance;

    use super::super::FaceReturn;
    use super::*;

    /// Paper of 0.6 and 0.03 under 1 mm of glass, diffuse light, seen along the normal through a bare face.
    const PAPER: [f64; 2] = [0.6, 0.03];
    const SEEN: f64 = 0.387_508;

    /// Stripes along y, half of each: the irradiance across a period.
    fn stripes(period_mm: f64, cells: usize) -> (Vec<f64>, Vec<f64>) {
        let cells = Cells { count: [cells, 1], period_mm: [period_mm, 1.0] };
        let face =
            FaceReturn::new(1.5, 1.0, cells.most_per_mm(), |beta| 1.0 - fresnel_reflectance(1.5, 1.0, beta));
        let rho: Vec<f64> = (0..cells.len()).map(|k| PAPER[usize::from(2 * k >= cells.len())]).collect();
        let irradiance = Recycling::new(cells, |f| face.at(f)).irradiance(&rho, 1e-9);
        (rho, irradiance)
    }

    fn mean_seen(rho: &[f64], irradiance: &[f64]) -> f64 {
        SEEN * rho.iter().zip(irradiance).map(|(rho, e)| rho * e).sum::<f64>() / rho.len() as f64
    }

    /// Means over a period, by the ratio of period to thickness: a dense Fourier solution of a separate
    /// program. Between 3 and 5 they are below the limit of fine patterns.
    #[test]
    fn stripes_have_known_means() {
        for (period, expected) in [
            (0.1, 0.150_30),
            (1.0, 0.150_47),
            (2.0, 0.151_27),
            (3.0, 0.149_10),
            (5.0, 0.148_12),
            (10.0, 0.155_94),
            (20.0, 0.167_10),
            (50.0, 0.177_87),
        ] {
            // Below fine stripes the irradiance is nearly uniform; many frequencies of theirs take seconds.
            let (rho, irradiance) = stripes(period, if period < 3.0 { 256 } else { 1024 });
            let found = mean_seen(&rho, &irradiance);
            assert!((found - expected).abs() < 1e-5, "{period}: {found} {expected}");
        }
    }

    /// Means of a white and a black stripe of 5 thicknesses each.
    #[test]
    fn white_and_black_stripes_have_known_radiance() {
        let (rho, irradiance) = stripes(10.0, 1024);
        let (white, black) = rho.split_at(rho.len() / 2);
        let (lit, dark) = irradiance.split_at(rho.len() / 2);
        for (found, expected) in [(mean_seen(white, lit), 0.297_95), (mean_seen(black, dark), 0.013_93)] {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }

    #[test]
    fn uniform_and_fine_patterns_have_closed_forms() {
        let a = 0.596_346;
        for rho in PAPER {
            let cells = Cells { count: [8, 6], period_mm: [3.0, 2.0] };
            let face = FaceReturn::new(1.5, 1.0, cells.most_per_mm(), |beta| {
                1.0 - fresnel_reflectance(1.5, 1.0, beta)
            });
            let irradiance = Recycling::new(cells, |f| face.at(f)).irradiance(&vec![rho; cells.len()], 1e-12);
            assert!(irradiance.iter().all(|e| (e - 1.0 / (1.0 - a * rho)).abs() < 1e-6));
        }
        // Clapper and Yule: the mean reflectance in the denominator.
        let (rho, irradiance) = stripes(1e-3, 16);
        let mean = 0.315;
        assert!((mean_seen(&rho, &irradiance) - SEEN * mean / (1.0 - a * mean)).abs() < 1e-6);
    }

    /// Light that spreads inside the pixels: a small modulation of the reflectance has half of its light from
    /// places that it leaves, and no return or all of it at once gives the formulae of print: Yule and
    /// Nielsen's with n = 2, and Clapper and Yule's.
    #[test]
    fn spread_inside_pixels_has_limits_of_print() {
        let rho: Vec<f64> = (0..64).map(|k| PAPER[usize::from(k >= 32)]).collect();
        let cells = Cells { count: [64, 1], period_mm: [0.1, 1.0] };
        let root = 0.5 * (0.6_f64.sqrt() + 0.03_f64.sqrt());
        let mean = |returned: f64, spread_mm: f64| {
            let recycling = Recycling::new(cells, |_| returned).with_spread(PixelSpread::new(spread_mm));
            let irradiance = recycling.irradiance(&rho, 1e-12);
            rho.iter().zip(irradiance).map(|(rho, e)| rho * e).sum::<f64>() / 64.0
        };
        for returned in [0.0, 0.596] {
            // The return of a thin face comes back at its own place.
            let clapper_yule = root * root / (1.0 - returned * 0.315);
            assert!(
                (mean(returned, 100.0) - clapper_yule).abs() < 1e-6,
                "{returned}: {}",
                mean(returned, 100.0)
            );
            let own = 0.5 * PAPER.iter().map(|rho| rho / (1.0 - returned * rho)).sum::<f64>();
            assert!((mean(returned, 0.0) - own).abs() < 1e-9 && (mean(returned, 1e-7) - own).abs() < 1e-5);
            // Less spread, more light.
            assert!(mean(returned, 0.01) > mean(returned, 0.02) && mean(returned, 0.02) > clapper_yule);
        }
        for (f, spread_mm) in [(1.0, 0.05), (3.0, 0.05), (3.0, 0.3)] {
            let (count, spread) = (256, PixelSpread::new(spread_mm).unwrap());
            let cells = Cells { count: [count, 1], period_mm: [1.0 / f, 1.0] };
            let wave: Vec<f64> =
                (0..count).map(|k| (2.0 * std::f64::consts::PI * k as f64 / count as f64).cos()).collect();
            let rho: Vec<f64> = wave.iter().map(|wave| 0.5 + 1e-5 * wave).collect();
            for returned in [0.0, 0.4] {
                // A face whose return does not depend on the frequency, except that of uniform light.
                let face = |f: f64| if f == 0.0 { 0.5 } else { returned };
                let recycling = Recycling::new(cells, face).with_spread(Some(spread));
                let irradiance = recycling.irradiance(&rho, 1e-14);
                let amplitude: f64 =
                    (0..count).map(|k| rho[k] * irradiance[k] * wave[k]).sum::<f64>() * 2.0 / count as f64;
                let (e, p) = (1.0 / (1.0 - 0.5 * 0.5), spread.at(f));
                let expected = 1e-5 * e * 0.5 * (1.0 + p) / (1.0 - 0.5 * p * returned);
                assert!((amplitude / expected - 1.0).abs() < 2e-4, "{f} {spread_mm}: {amplitude} {expected}");
            }
        }
    }

    /// A small modulation about a mean: (1 - rho A(0))/(1 - rho A(f)).
    #[test]
    fn small_signals_have_known_transfer() {
        for (f, expected) in [(0.02, 0.9454), (0.05, 0.8298), (0.1, 0.7024), (0.2, 0.6202), (0.3, 0.6235)] {
            let cells = Cells { count: [16, 1], period_mm: [1.0 / f, 1.0] };
            let face = FaceReturn::new(1.5, 1.0, cells.most_per_mm(), |beta| {
                1.0 - fresnel_reflectance(1.5, 1.0, beta)
            });
            let wave: Vec<f64> =
                (0..16).map(|k| (2.0 * std::f64::consts::PI * f64::from(k) / 16.0).cos()).collect();
            let rho: Vec<f64> = wave.iter().map(|wave| 0.6 + 1e-5 * wave).collect();
            let irradiance = Recycling::new(cells, |f| face.at(f)).irradiance(&rho, 1e-13);
            let amplitude =
                |values: &dyn Fn(usize) -> f64| (0..16).map(|k| values(k) * wave[k]).sum::<f64>() / 8.0;
            let seen = amplitude(&|k| rho[k] * irradiance[k]);
            // Relative to that of a slow modulation, d/drho of rho/(1 - A(0) rho).
            let slow = 1e-5 / (1.0 - face.at(0.0) * 0.6).powi(2);
            assert!((seen / slow - expected).abs() < 6e-5, "{f}: {} {expected}", seen / slow);
        }
    }
}
