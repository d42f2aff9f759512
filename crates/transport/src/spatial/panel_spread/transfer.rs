//! What is seen of small modulations of the pixel, by spatial frequency.

use std::f64::consts::PI;

use num_complex::Complex64;

use super::{PanelSpread, Part};
use crate::adding::first_pass::Weights;
use crate::{AngularTable, Panel, Reflector};

impl PanelSpread {
    /// Returns what is seen of a small modulation of the pixel about each of its states at each of these
    /// frequencies (cycles per mm along x and y), as a reflectance factor: at f = 0 that of the uniform
    /// state. Its phase is about the own ray of each direction of view. Shape `[frequency][state][wavelength]`.
    ///
    /// Frequencies that follow each other in equal steps take the least time.
    pub fn transfer(&self, panel: &Panel, frequencies_per_mm: &[[f64; 2]]) -> Vec<Complex64> {
        let len = panel.base.states() * panel.base.bins();
        let mut out = vec![Complex64::ZERO; frequencies_per_mm.len() * len];
        for part in &self.parts {
            match (&panel.base.reflector, &part.ghosts) {
                (Reflector::Specular(table), None) => {
                    self.over_table(part, table, frequencies_per_mm, &mut out)
                }
                _ => self.over_states(part, panel, frequencies_per_mm, &mut out),
            }
        }
        if !self.returned.is_empty() {
            self.add_orders(panel, frequencies_per_mm, &mut out);
        }
        out
    }

    /// Adds a part that sees the table in many directions.
    fn over_table(&self, part: &Part, table: &AngularTable, frequencies: &[[f64; 2]], out: &mut [Complex64]) {
        let mut rows = vec![Weights::new(&table.nodes); 2 * frequencies.len()];
        part.each_sample(|sample| {
            let stencil = table.nodes.stencil(sample.beta.squared(), part.index);
            phases(sample.place_mm, frequencies, |k, phase| {
                rows[2 * k].add(&stencil, sample.weight * phase.re);
                rows[2 * k + 1].add(&stencil, sample.weight * phase.im);
            });
        });
        let rows: Vec<Vec<f64>> = rows.into_iter().map(|row| row.finish(&table.nodes).0).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let len = out.len() / frequencies.len().max(1);
        let sums = table.weighted_sums(&rows);
        for (out, sums) in out.chunks_exact_mut(len.max(1)).zip(sums.chunks_exact((2 * len).max(1))) {
            let (re, im) = sums.split_at(len);
            for (k, out) in out.iter_mut().enumerate() {
                *out += part.through[k % part.through.len()] * Complex64::new(re[k], im[k]);
            }
        }
    }

    /// Adds a part that sees each state in one direction, with its ghosts, or in which all directions are the
    /// same.
    fn over_states(&self, part: &Part, panel: &Panel, frequencies: &[[f64; 2]], out: &mut [Complex64]) {
        let (bins, len) = (part.through.len(), out.len() / frequencies.len().max(1));
        let mut rho = vec![0.0; len];
        let beta_squared = part.images.first().map_or(0.0, |only| only.beta.squared());
        panel.base.reflectance(beta_squared, &panel.medium, &mut rho);
        let mut sums = vec![Complex64::ZERO; frequencies.len()];
        part.each_sample(|sample| {
            phases(sample.place_mm, frequencies, |k, phase| sums[k] += sample.weight * phase);
        });
        let lit: Vec<usize> = (0..bins).filter(|bin| part.through[*bin] != 0.0).collect();
        for ((sum, frequency), out) in sums.iter().zip(frequencies).zip(out.chunks_exact_mut(len.max(1))) {
            let ghosts = part.ghosts.as_ref().map(|ghosts| ghosts.at(*frequency));
            for (out, rho) in out.chunks_exact_mut(bins).zip(rho.chunks_exact(bins)) {
                for &bin in &lit {
                    let orders = ghosts.as_ref().map_or(Complex64::ONE, |a| 1.0 / (1.0 - a[bin] * rho[bin]));
                    out[bin] += sum * orders * (rho[bin] * part.through[bin]);
                }
            }
        }
    }

    /// Multiplies by all orders of the light that returns to a Lambertian pixel.
    fn add_orders(&self, panel: &Panel, frequencies: &[[f64; 2]], out: &mut [Complex64]) {
        let Reflector::Lambertian(rho) = &panel.base.reflector else { return };
        for (frequency, out) in frequencies.iter().zip(out.chunks_exact_mut(rho.len().max(1))) {
            let returned = self.returned(frequency[0].hypot(frequency[1]));
            for (k, (out, rho)) in out.iter_mut().zip(rho).enumerate() {
                *out /= 1.0 - returned[k % returned.len()] * rho;
            }
        }
    }
}

/// Calls `each` with the number and phase of each frequency of light at this place.
#[inline(always)]
fn phases(place_mm: [f64; 2], frequencies: &[[f64; 2]], mut each: impl FnMut(usize, Complex64)) {
    let at = |f: [f64; 2]| Complex64::cis(-2.0 * PI * (f[0] * place_mm[0] + f[1] * place_mm[1]));
    let mut k = 0;
    while k < frequencies.len() {
        let count = equal_steps(&frequencies[k..]);
        let mut phase = at(frequencies[k]);
        each(k, phase);
        if count > 1 {
            let step = at([0, 1].map(|axis| frequencies[k + 1][axis] - frequencies[k][axis]));
            for more in 1..count {
                phase *= step;
                each(k + more, phase);
            }
        }
        k += count;
    }
}

/// Returns the number of frequencies, from the first, that follow each other in equal steps.
fn equal_steps(frequencies: &[[f64; 2]]) -> usize {
    let [first, second, ..] = frequencies else { return frequencies.len() };
    let step = [0, 1].map(|axis| second[axis] - first[axis]);
    let size = frequencies.iter().flatten().fold(0.0, |most: f64, f| most.max(f.abs()));
    let expected = |(k, f): &(usize, &[f64; 2])| {
        (0..2).all(|axis| (f[axis] - first[axis] - *k as f64 * step[axis]).abs() <= 1e-12 * size)
    };
    frequencies.iter().enumerate().take_while(expected).count()
}
