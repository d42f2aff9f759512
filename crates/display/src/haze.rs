//! Haze of the front of a display: what a hazemeter reads of its glass alone.
//!
//! # Model
//! Light along the normal passes the layers above the pixel into air. The haze is the fraction of what is transmitted that
//! leaves at more than 2.5 deg from the normal (after ASTM D1003). One interface scatters: a rough one, or a diffuser given by
//! its lobe; all others are flat.
//!
//! # Validity
//! Light passes once: what the faces reflect to and fro is left out (0.2 % of the light of a plate of glass), and so is the
//! light that a rough interface sends across after several microfacets (0.3 % of it at alpha = 0.2 from GGX, less from others).
//! A hazemeter of ASTM D1003 has a lamp of finite size, whose light within its own aperture counts as not deviated.

use std::f64::consts::{FRAC_PI_2, TAU};

use papilio_optics::Beta;
use papilio_optics::interface::fresnel_reflectance;
use papilio_optics::lobe::HAZE_ANGLE_DEG;
use papilio_optics::quadrature::gauss;
use papilio_optics::rough::{Distribution, Rough, Side};
use papilio_transport::Interface as Ready;

use crate::scene::{Interface, Scene};

/// Number of points of each of the rules.
const POINTS: usize = 40;

/// Returns the haze of the front, per cent: `None` if no interface scatters or several do, if a medium scatters, or if the
/// scattering is measured or by waves.
pub(crate) fn haze_percent(scene: &Scene) -> Option<f64> {
    let layers = &scene.display.layers;
    let is_flat = |interface: &Interface| match interface {
        Interface::Coating(_) => true,
        Interface::Ready(ready) => {
            matches!(
                ready,
                Ready::Open | Ready::IdealAr | Ready::Fresnel | Ready::Component(_) | Ready::Coating(_)
            )
        }
        Interface::Rough { .. } | Interface::OfSurface(_) => false,
    };
    let mut scattering = layers.iter().enumerate().filter(|(_, layer)| !is_flat(&layer.interface));
    let (number, layer) = scattering.next()?;
    if scattering.next().is_some() || layers.iter().any(|layer| layer.medium.scattering.is_some()) {
        return None;
    }
    let above = number.checked_sub(1).map_or(1.0, |above| layers[above].medium.index[0]);
    let haze = match &layer.interface {
        Interface::Rough { alpha, distribution } => of_rough(
            *distribution,
            *alpha,
            [above, layer.medium.index[0]],
            scene.display.index_above_pixel()[0],
        ),
        Interface::Ready(Ready::Diffuser(diffuser)) => diffuser.lobe.haze(diffuser.regular_fraction),
        _ => return None,
    };
    haze.is_finite().then_some(100.0 * haze)
}

/// Returns the haze of a rough interface between media of these indices, behind which light leaves a medium of the index
/// `last` to air through a flat face.
fn of_rough(distribution: Distribution, alpha: f64, [above, below]: [f64; 2], last: f64) -> f64 {
    let face = Rough::with(distribution, alpha, above, below);
    // Light of single microfacets about the normal, in units in which its peak has the width 1.
    let width = alpha * (below - above).abs();
    let ring = |angle: f64| {
        let beta = width * angle.tan();
        let density = face.single(Side::Above, Beta::default(), Side::Below, Beta { x: beta, y: 0.0 });
        let leaves = 1.0 - fresnel_reflectance(last, 1.0, beta);
        TAU * beta * density * leaves * width / angle.cos().powi(2)
    };
    let limits = [HAZE_ANGLE_DEG.to_radians().sin(), 1.0].map(|beta| (beta / width).atan().min(FRAC_PI_2));
    let within =
        |from: f64, to: f64| gauss(from, to, POINTS).map(|(at, weight)| weight * ring(at)).sum::<f64>();
    let [near, far] = [within(0.0, limits[0]), within(limits[0], limits[1])];
    far / (near + far)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Small slopes deviate light by (n - 1) times the slope: the haze is the fraction of steeper ones. Losses at the flat face
    /// change little within 20 deg.
    #[test]
    fn haze_is_the_fraction_of_steep_slopes() {
        for (distribution, alpha) in [
            (Distribution::Beckmann, 0.0587),
            (Distribution::Beckmann, 0.0395),
            (Distribution::Ggx, 0.0331),
            (Distribution::Ggx, 0.0057),
            (Distribution::StudentT { tail: 3.0 }, 0.03),
        ] {
            let found = of_rough(distribution, alpha, [1.0, 1.52], 1.52);
            let expected = distribution.steeper(alpha, HAZE_ANGLE_DEG.to_radians().sin() / 0.52);
            assert!((found / expected - 1.0).abs() < 0.04, "{distribution:?} {alpha}: {found} {expected}");
        }
    }

    /// A finer rule: the integral has converged.
    #[test]
    fn haze_is_integrated_to_its_digits() {
        let (alpha, from) = (0.0269, HAZE_ANGLE_DEG.to_radians().sin());
        let face = Rough::with(Distribution::Ggx, alpha, 1.0, 1.52);
        let ring = |beta: f64| {
            let density = face.single(Side::Above, Beta::default(), Side::Below, Beta { x: beta, y: 0.0 });
            TAU * beta * density * (1.0 - fresnel_reflectance(1.52, 1.0, beta))
        };
        let sum = |from: f64, to: f64| {
            let steps = 100_000;
            let step = (to - from) / f64::from(steps);
            (0..steps).map(|k| step * ring(from + step * (f64::from(k) + 0.5))).sum::<f64>()
        };
        let [near, far] = [sum(0.0, from), sum(from, 1.0)];
        let found = of_rough(Distribution::Ggx, alpha, [1.0, 1.52], 1.52);
        assert!((found / (far / (near + far)) - 1.0).abs() < 1e-5, "{found}");
    }
}
