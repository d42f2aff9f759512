//! The pixel: a mirror, a Lambertian pixel, or one with a kernel for each state.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;

use super::Stokes;
use super::row;
use super::sums::{Path, Run, intensities, unpolarised};
use crate::layers::Departure;
use crate::mueller::Factors;
use crate::skeleton::Propagation::Up;
use crate::{Base, Medium, Reflector, ScatterKernel};

impl Stokes<'_> {
    pub(super) fn meet_pixel(&self, path: &mut Path, run: &mut Run<'_>) {
        let base = self.stack.base();
        if path.towards.is_some() && !base.is_specular() {
            return path.end();
        }
        if !path.has_met_pixel {
            path.has_met_pixel = true;
            path.rows = path.rows.repeat(base.states());
        }
        let medium = self.stack.layers.last().map_or(&self.air, |layer| &layer.medium);
        let arriving = intensities(&path.rows);
        match &base.reflector {
            Reflector::Specular(_) => {
                self.reflect(base, medium, path);
                if path.towards.is_none() {
                    run.meet(&arriving, &intensities(&path.rows));
                }
            }
            Reflector::Lambertian(_) => self.scatter_evenly(base, medium, path, run),
            Reflector::Scattering(kernels) => self.scatter_by(kernels, medium, path, run),
        }
    }

    /// The reflectance of a pixel by row.
    fn reflectance(&self, base: &Base, medium: &Medium, beta: Beta) -> Vec<f64> {
        let mut all = vec![0.0; base.states() * base.bins()];
        base.reflectance_towards(beta, medium, &mut all);
        let columns = self.bins.len();
        (0..base.states() * columns).map(|k| all[k / columns * base.bins() + self.bin(k)]).collect()
    }

    fn reflect(&self, base: &Base, medium: &Medium, path: &mut Path) {
        let of = |base: &Base| self.reflectance(base, medium, path.beta);
        let mirrors = self.lit.mirrors_of_each();
        let [s, p] = mirrors.map_or_else(|| [of(base), of(base)], |mirrors| mirrors.both.each_ref().map(of));
        let products = mirrors.and_then(|mirrors| Some(mirrors.products.as_ref()?.each_ref().map(of)));
        for (k, row) in path.rows.iter_mut().enumerate() {
            let (s, p) = (s[k], p[k]);
            let crossed = match &products {
                Some([re, im]) => Complex64::new(re[k], im[k]),
                // As a mirror of metal.
                None => Complex64::new(-(s * p).max(0.0).sqrt(), 0.0),
            };
            *row = row::behind(Factors { p, s, crossed }, *row);
        }
        path.going = Up;
    }

    fn scatter_evenly(&self, base: &Base, medium: &Medium, path: &mut Path, run: &mut Run<'_>) {
        let (n, [u, v, ..]) = (medium.largest_index(), run.random());
        let arriving = intensities(&path.rows);
        let reflectance = self.reflectance(base, medium, path.beta);
        let reflected: Vec<f64> = reflectance.iter().zip(&arriving).map(|(r, light)| r * light).collect();
        run.meet(&arriving, &reflected);
        // Uniform over the disc of each index, sampled over that of the largest.
        let rows = |to: Departure, factor: f64| {
            let of = |(k, light): (usize, &f64)| {
                let n = medium.index()[self.bin(k)];
                if to.beta.squared() < n * n { factor * light / (n * n) } else { 0.0 }
            };
            unpolarised(reflected.iter().enumerate().map(of))
        };
        let (x, y) = warp::uniform_disc(n, [u, v]);
        let to = Departure { beta: Beta { x, y }, going: Up };
        let density = 1.0 / (PI * n * n);
        let sent = Some((to, rows(to, n * n), density));
        let place = (2 * self.stack.layers.len(), &[Up][..]);
        self.scatter(place, path, run, |to| (rows(to, 1.0 / PI), density), sent);
    }

    fn scatter_by(&self, kernels: &[ScatterKernel], medium: &Medium, path: &mut Path, run: &mut Run<'_>) {
        let (n, u, [by_chance, ..]) = (medium.largest_index(), run.random(), run.random());
        let arriving = intensities(&path.rows);
        let in_medium = |beta: Beta| (1.0 / n) * beta;
        let from = in_medium(path.beta);
        // States share their directions: those of one of them, by chance.
        let chosen = ((by_chance * kernels.len() as f64) as usize).min(kernels.len() - 1);
        let sampling = |to: Departure| {
            let density = |kernel: &ScatterKernel| kernel.scatter.density(from, in_medium(to.beta));
            kernels.iter().map(density).sum::<f64>() / (kernels.len() as f64 * n * n)
        };
        let rows = |to: Departure, factor: f64| {
            let value = |kernel: &ScatterKernel| kernel.scatter.evaluate(from, in_medium(to.beta)) / (n * n);
            let values: Vec<f64> = kernels.iter().map(value).collect();
            let of = |(k, light): (usize, &f64)| {
                let state = k / self.bins.len();
                factor * values[state] * kernels[state].factor[self.bin(k)] * light
            };
            unpolarised(arriving.iter().enumerate().map(of))
        };
        let sampled = kernels[chosen].scatter.sample(from, u).map(|sample| {
            let to = Departure { beta: n * sample.direction, going: Up };
            let density = sampling(to);
            (to, rows(to, 1.0 / density), density)
        });
        let nothing = || vec![0.0; arriving.len()];
        run.meet(&arriving, &sampled.as_ref().map_or_else(nothing, |(_, rows, _)| intensities(rows)));
        let place = (2 * self.stack.layers.len(), &[Up][..]);
        self.scatter(place, path, run, |to| (rows(to, 1.0), sampling(to)), sampled);
    }
}
