//! The indices and thicknesses of a film, ready for the kernel.

use std::f64::consts::PI;

use num_complex::Complex64;
use pulp::Simd;

use super::harmonic::THIN;
use super::lanes::{Complex, Lanes};
use super::{SpectralLayer, Thickness};

/// The indices and thicknesses of a film, as structures of arrays over wavelength.
#[derive(Debug, Clone)]
pub(super) struct Media {
    /// 2 pi/lambda, 1/nm.
    pub(super) k0: Vec<f64>,
    pub(super) incidence: Vec<f64>,
    pub(super) above: Vec<Layer>,
    pub(super) gap: Option<Medium>,
    pub(super) below: Vec<Layer>,
    pub(super) substrate: Medium,
}

/// A layer of fixed thickness.
#[derive(Debug, Clone)]
pub(super) struct Layer {
    pub(super) medium: Medium,
    pub(super) nm: f64,
    /// Its phase is at most [`THIN`] in every direction and at every wavelength.
    pub(super) thin: bool,
}

/// A medium over wavelength.
#[derive(Debug, Clone)]
pub(super) struct Medium {
    /// n + ik.
    pub(super) index: Parts,
    /// n^2.
    pub(super) eps: Parts,
    /// 1/n^2.
    pub(super) inverse_eps: Parts,
    /// Beta up to which waves propagate at every wavelength; 0 if any is absorbed.
    pub(super) travels_below: f64,
    /// Beta above which waves decay at every wavelength.
    pub(super) decays_above: f64,
}

#[derive(Debug, Clone)]
pub(super) struct Parts {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Media {
    pub(super) fn new(
        wavelengths_nm: &[f64],
        incidence: &[f64],
        layers: &[SpectralLayer],
        substrate: &[Complex64],
    ) -> Self {
        let mut media = Self {
            k0: wavelengths_nm.iter().map(|nm| 2.0 * PI / nm).collect(),
            incidence: incidence.to_vec(),
            above: Vec::new(),
            gap: None,
            below: Vec::new(),
            substrate: Medium::new(substrate),
        };
        for layer in layers {
            let medium = Medium::new(&layer.index);
            match layer.thickness {
                Thickness::Gap => media.gap = Some(medium),
                Thickness::Fixed(nm) => {
                    let layer = media.layer(medium, nm);
                    if media.gap.is_none() { &mut media.above } else { &mut media.below }.push(layer);
                }
            }
        }
        media
    }

    fn layer(&self, medium: Medium, nm: f64) -> Layer {
        let beta = self.incidence.iter().fold(0.0, |most: f64, n| most.max(*n));
        // Upper bound of |n^2 - beta^2|; the two have the same sign if both are real.
        let most = |eps: f64| if medium.is_clear() { eps.max(beta * beta) } else { eps + beta * beta };
        let thin = (0..self.k0.len()).all(|at| most(medium.eps.size(at)).sqrt() * self.k0[at] * nm <= THIN);
        Layer { medium, nm, thin }
    }

    /// Returns the number of layers, including the gap.
    pub(super) fn layers(&self) -> usize {
        self.above.len() + usize::from(self.gap.is_some()) + self.below.len()
    }

    pub(super) fn wavelengths(&self) -> usize {
        self.k0.len()
    }
}

impl Medium {
    fn new(index: &[Complex64]) -> Self {
        let eps: Vec<Complex64> = index.iter().map(|n| n * n).collect();
        let slowest = |limit: f64, n: &Complex64| if n.im == 0.0 { limit.min(n.re) } else { 0.0 };
        Self {
            index: Parts::new(index.iter().copied()),
            inverse_eps: Parts::new(eps.iter().map(Complex64::inv)),
            travels_below: index.iter().fold(f64::INFINITY, slowest),
            decays_above: index.iter().fold(0.0, |limit: f64, n| limit.max(n.re)),
            eps: Parts::new(eps.into_iter()),
        }
    }

    /// Returns whether nothing is absorbed at any wavelength.
    pub(super) fn is_clear(&self) -> bool {
        self.travels_below > 0.0
    }
}

impl Parts {
    fn new(values: impl Iterator<Item = Complex64>) -> Self {
        let (re, im) = values.map(|z| (z.re, z.im)).unzip();
        Self { re, im }
    }

    #[inline(always)]
    pub(super) fn load<S: Simd>(&self, simd: S, at: usize) -> Complex<S> {
        Complex::new(load(simd, &self.re, at), load(simd, &self.im, at))
    }

    #[inline(always)]
    pub(super) fn load_real<S: Simd>(&self, simd: S, at: usize) -> Lanes<S> {
        load(simd, &self.re, at)
    }

    fn size(&self, at: usize) -> f64 {
        self.re[at].hypot(self.im[at])
    }
}

/// Loads the register of `values` that begins at `at`. Lanes beyond the end contain zeros; their results are
/// meaningless and not stored.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, values: &[f64], at: usize) -> Lanes<S> {
    Lanes::load(simd, &values[at..values.len().min(at + S::F64_LANES)])
}
