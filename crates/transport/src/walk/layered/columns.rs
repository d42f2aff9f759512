//! Fewer spectra: the values of the pixel's reflectance at which light is followed.
//!
//! If the layers are the same at every wavelength and the pixel at every angle, then all that a state or
//! wavelength can change is one number, the reflectance r of the pixel. Light that leaves, or that is
//! absorbed anywhere, is a smooth function of r: a series of r^m, with the light that meets the pixel m
//! times. Paths carry its values at a few r, the columns: those that occur, if they are few, else Chebyshev
//! nodes between the smallest and the largest. Every mean over paths is then interpolated by one polynomial,
//! which is the same as interpolating every path.
//!
//! The series converges for |r| < 1, since no display returns more light to its pixel than the pixel
//! reflects. This bounds the error of interpolation (L. N. Trefethen, *Approximation Theory and Approximation
//! Practice*, theorem 8.2), and determines the number of nodes.

use std::f64::consts::PI;

use papilio_spectra::StateSpectra;

use super::light::Light;
use crate::angular::Nodes;
use crate::{AngularTable, Base, Reflector, Stack};

/// Relative error of interpolated results.
const ERROR: f64 = 1e-9;

/// Largest number of columns; each costs as much as a wavelength.
const MOST: usize = 32;

/// Columns of a display.
#[derive(Debug)]
pub(super) struct Columns {
    /// The base with one state per column, and one wavelength.
    pub(super) base: Base,
    /// Weights of the columns in each result; shape `[state][wavelength][column]`.
    weights: Vec<f64>,
    bins: usize,
}

impl Columns {
    /// Builds the columns of a display; `None` if they would not save time.
    pub(super) fn new(stack: &Stack) -> Option<Self> {
        if stack.mirrors().is_some() {
            return None;
        }
        let base = stack.base();
        let reflectance = match &base.reflector {
            Reflector::Lambertian(reflectance) => reflectance.clone(),
            Reflector::Specular(AngularTable { nodes: Nodes::Constant, .. }) => {
                let mut reflectance = StateSpectra::zeros(base.states(), base.bins());
                base.reflectance(0.0, &stack.layers.last()?.medium, &mut reflectance);
                reflectance
            }
            Reflector::Specular(_) | Reflector::Scattering(_) => return None,
        };
        let nodes = nodes(&reflectance).filter(|nodes| nodes.len() < reflectance.len())?;
        if !stack.is_grey() {
            return None;
        }
        let weights = reflectance.iter().flat_map(|r| lagrange(&nodes, *r)).collect();
        let reflector = match &base.reflector {
            Reflector::Lambertian(_) => Reflector::lambertian(nodes, 1),
            _ => Reflector::Specular(AngularTable {
                nodes: Nodes::Constant,
                basis: vec![1.0].into(),
                mixture: nodes,
                common: vec![0.0],
            }),
        };
        let base = Base { reflector, inactive_absorptance: vec![0.0].into() };
        Some(Self { base, weights, bins: stack.base().bins() })
    }

    /// Returns light of all states and wavelengths.
    pub(super) fn expand(&self, light: &Light) -> Light {
        let rows = self.weights.chunks_exact(light.met.len());
        let met = rows.map(|weights| weights.iter().zip(&light.met).map(|(w, value)| w * value).sum());
        Light { fresh: vec![light.fresh[0]; self.bins], met: met.collect() }
    }
}

/// Returns reflectances at which results are computed.
fn nodes(reflectance: &[f64]) -> Option<Vec<f64>> {
    let mut distinct = reflectance.to_vec();
    distinct.sort_unstable_by(f64::total_cmp);
    distinct.dedup();
    let [least, .., most] = distinct[..] else { return Some(distinct) };
    let (centre, half) = (0.5 * (least + most), 0.5 * (most - least));
    // The nearest pole on the interval's own scale, and the size of the ellipse through it.
    let pole = (1.0 - centre) / half;
    let ellipse = pole + (pole * pole - 1.0).max(0.0).sqrt();
    let count = (-ERROR.ln() / ellipse.ln()).ceil();
    if distinct.len() as f64 <= count {
        return (distinct.len() <= MOST).then_some(distinct);
    }
    let angle = |k: usize| PI * (k as f64 + 0.5) / count;
    (count <= MOST as f64).then(|| (0..count as usize).map(|k| centre + half * angle(k).cos()).collect())
}

/// Returns the weights of the values at the nodes in the interpolating polynomial.
fn lagrange(nodes: &[f64], at: f64) -> Vec<f64> {
    let weight = |k: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(j, _)| *j != k);
        others.map(|(_, node)| (at - node) / (nodes[k] - node)).product()
    };
    (0..nodes.len()).map(weight).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The light of a Lambertian pixel under a surface that returns a fraction of it, at every reflectance.
    #[test]
    fn interpolated_series_equals_closed_form() {
        for (least, most, returned) in [(0.3, 0.7, 0.6), (0.05, 0.6, 1.0), (0.0, 0.4, 0.9)] {
            let spectrum: Vec<f64> = (0..81).map(|k| least + (most - least) * f64::from(k) / 80.0).collect();
            let nodes = nodes(&spectrum).unwrap();
            assert!(nodes.len() < 30, "{}", nodes.len());
            for r in spectrum {
                let truth = r / (1.0 - returned * r);
                let values = nodes.iter().map(|node| node / (1.0 - returned * node));
                let found: f64 = values.zip(lagrange(&nodes, r)).map(|(value, weight)| value * weight).sum();
                assert!((found - truth).abs() < 10.0 * ERROR, "{r}: {found} {truth}");
            }
        }
        assert_eq!(nodes(&[0.1, 0.8, 0.1, 0.8]).unwrap(), [0.1, 0.8]);
        assert!(nodes(&(0..81).map(|k| f64::from(k) / 80.0).collect::<Vec<_>>()).is_none());
    }
}
