//! A Lambertian base under a diffuser: a kernel of rank one.
//!
//! Of light above the diffuser at `beta`, the fraction `a(beta)` reaches the base (unscattered, or by the
//! lobe into the disc of the glass: closed forms). The base sends `R/(pi n^2)` into every direction of that
//! disc. By reciprocity, `a` is also the fraction that leaves towards `beta`. One pass is
//! `a(v) R a(l)/(pi n^2)`, and all orders are a geometric series in `r T^2 R kappa`, with `kappa` the
//! integral of `a^2/(pi n^2)` over the disc of air.

use std::f64::consts::PI;

use crate::Diffuser;
use crate::light::cone_points::Point;
use crate::numerics::quadrature::{Pole, radial};

/// Integrals over directions, for one index.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Shares {
    index: f64,
    /// The integral of `a/(pi n^2)` over the disc of air: the fraction of the base's light that leaves.
    pub(crate) out: f64,
    /// `kappa`: the fraction that would leave and return, under a perfect mirror.
    pub(crate) back: f64,
    pub(crate) nodes: usize,
}

impl Shares {
    pub(crate) fn new(diffuser: &Diffuser, index: f64, digits: f64) -> Self {
        let mut poles = Vec::new();
        if let papilio_optics::lobe::Lobe::KCorrelation { width } = diffuser.lobe {
            poles.extend([index, -index].map(|at| Pole { at, off: width }));
        }
        let rule = radial(1.0, &[], &poles, digits);
        let (mut out, mut back) = (0.0, 0.0);
        for node in &rule {
            let a = arriving(diffuser, node.x, index);
            out += node.weight * a;
            back += node.weight * a * a;
        }
        let area = PI * index * index;
        Self { index, out: out / area, back: back / area, nodes: rule.len() }
    }

    /// Returns the mean of `a` over the points of a view or a source.
    pub(crate) fn arriving(&self, diffuser: &Diffuser, points: &[Point]) -> f64 {
        points.iter().map(|p| p.weight * arriving(diffuser, p.beta.length(), self.index)).sum()
    }

    /// Returns `pi` times the density of directions of the base.
    pub(crate) fn density(&self) -> f64 {
        1.0 / (self.index * self.index)
    }
}

fn arriving(diffuser: &Diffuser, radius: f64, index: f64) -> f64 {
    let straight = if radius < index { diffuser.regular_fraction } else { 0.0 };
    straight + (1.0 - diffuser.regular_fraction) * diffuser.lobe.fraction_in_disc(radius, index)
}
