//! Light with lines narrower than the step of the grid: what its radiance at the wavelengths of the grid does
//! not contain.
//!
//! X, Y, Z and luminances are sums over the radiance at the wavelengths of the grid. For a light with lines,
//! weights of reflectances are known from its means over 1 nm ([`LineWeights`](crate::setup::LineWeights));
//! the differences are collected here, and added. They are linear in reflectances, so that they have
//! replicates and levels as all other quantities.

use std::f64::consts::PI;

use crate::setup::{Light, Setup};

/// Number of quantities of each state.
pub(super) const QUANTITIES: usize = 4;

/// Corrections of one light for each reflectance factor, `[quantity][wavelength]`, in W/(m2 sr): X, Y, Z, Y
/// of CIE 1931.
pub(super) struct Corrections([Vec<f64>; QUANTITIES]);

impl Corrections {
    /// Corrections of a light; `None` without narrow lines.
    pub(super) fn new(setup: &Setup, light: &Light) -> Option<Self> {
        let lines = light.lines.as_ref()?;
        let ([x, y, z], [_, y_1931, _]) = (setup.seen_by().weights(), setup.observer.weights());
        let beyond = |own: &[f64], bar: &[f64]| -> Vec<f64> {
            let grid = light.irradiance.iter().zip(bar).map(|(e, bar)| e * bar);
            own.iter().zip(grid).map(|(own, grid)| (own - grid) / PI).collect()
        };
        Some(Self([
            beyond(&lines.xyz[0], x),
            beyond(&lines.xyz[1], y),
            beyond(&lines.xyz[2], z),
            beyond(&lines.y_1931, y_1931),
        ]))
    }

    /// Corrections of light that is reflected with these factors at each wavelength.
    pub(super) fn of(&self, factors: impl Iterator<Item = f64> + Clone) -> [f64; QUANTITIES] {
        self.0.each_ref().map(|weights| weights.iter().zip(factors.clone()).map(|(w, rho)| w * rho).sum())
    }

    /// Derivative with respect to the reflectance factor at a wavelength of a quantity with these derivatives
    /// with respect to X, Y, Z and Y of CIE 1931.
    pub(super) fn slope(&self, bin: usize, of_xyz: [f64; 3], of_y_1931: f64) -> f64 {
        let [x, y, z] = of_xyz;
        let slopes = [x, y, z, of_y_1931];
        self.0.iter().zip(slopes).map(|(weights, slope)| weights[bin] * slope).sum()
    }
}
