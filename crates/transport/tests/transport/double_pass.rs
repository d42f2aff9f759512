//! Two passes through a k-correlation lobe over a mirror, in closed form and by quadrature.

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;
use papilio_transport::{Cone, Diffuser, Top};

use crate::common::one;

pub(crate) fn diffuser(width: f64, transmittance: f64, regular_fraction: f64) -> Top {
    let lobe = Lobe::KCorrelation { width };
    Top::Diffuser(Diffuser { lobe, transmittance: one(transmittance), regular_fraction })
}

/// The part of a double pass that would go through |beta| > 1.5, which the glass does not carry: midpoint
/// rule in the azimuth and in 1.5/|beta|.
pub(crate) fn beyond_the_glass(lobe: Lobe, from: Beta, to: Beta) -> f64 {
    let (rings, spokes) = (400, 200);
    let mut sum = 0.0;
    for ring in 0..rings {
        let inverse = (f64::from(ring) + 0.5) / f64::from(rings);
        let radius = 1.5 / inverse;
        for spoke in 0..spokes {
            let (x, y) = warp::polar(radius, (f64::from(spoke) + 0.5) / f64::from(spokes));
            let product = lobe.density(from, Beta { x, y }) * lobe.density(Beta { x, y }, to);
            sum += product * radius * radius / inverse;
        }
    }
    sum * 2.0 * PI / f64::from(rings * spokes)
}

/// A diffuser of width b, transmittance T and regular fraction s over a mirror R.
pub(crate) struct DoublePass {
    pub(crate) width: f64,
    pub(crate) transmittance: f64,
    pub(crate) regular_fraction: f64,
    pub(crate) reflectance: f64,
}

impl DoublePass {
    /// Returns `rho` of a disc seen from a direction: the mean over its beams (midpoint rule, uniform in
    /// solid angle, weighted with the cosine), and its mirror image if `seen`. The loss beyond the glass is
    /// subtracted with its value at the disc's axis.
    pub(crate) fn of_disc(&self, from: Beta, disc: &Cone, seen: bool) -> f64 {
        let s = self.regular_fraction;
        let density = |width, to| Lobe::KCorrelation { width }.density(from, to);
        let (rings, spokes) = (400_usize, 100_usize);
        let (mut sum, mut weights) = (0.0, 0.0);
        for ring in 0..rings {
            for spoke in 0..spokes {
                let u = [(ring as f64 + 0.5) / rings as f64, (spoke as f64 + 0.5) / spokes as f64];
                let to = -disc.sample_towards(u);
                let cosine = (1.0 - to.squared()).sqrt();
                let double = (1.0 - s).powi(2) * density(2.0 * self.width, to);
                sum += cosine * (2.0 * s * (1.0 - s) * density(self.width, to) + double);
                weights += cosine;
            }
        }
        let lobe = Lobe::KCorrelation { width: self.width };
        let lost = (1.0 - s).powi(2) * beyond_the_glass(lobe, from, -disc.axis_towards());
        let image = if seen { s.powi(2) / disc.projected_solid_angle() } else { 0.0 };
        PI * self.transmittance.powi(2) * self.reflectance * (sum / weights - lost + image)
    }
}
