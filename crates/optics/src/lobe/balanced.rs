//! A lobe at a flat face, balanced so that it scatters exactly what the face transmits or reflects.
//!
//! **Model.** Light at a face between two media is scattered with the density
//! `K(a, b) = x(|a|) x(|b|) L(|b - a|)` over direction cosines, L the lobe and x a factor that solves
//! `x(a) ∫ x(b) L(|b - a|) d²b = F(a)` over the disc of directions, F being Fresnel's transmittance or
//! reflectance of the flat face. It is reciprocal, loses nothing, and is the lobe itself where F is constant
//! and the rim of the disc is far: x = sqrt(F).
//!
//! **Domain.** Transmission connects the directions that both media have, `|beta| < min(n₁, n₂)`; reflection
//! those of its medium.
//!
//! **Accuracy.** x is tabulated over the arcsine of `|beta|` over the radius of the disc; the balance holds
//! within 1e-4 of the light.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_sampling::warp;

use super::{Gaussian, KCorrelation};
use crate::Beta;
use crate::interface::fresnel_reflectance;

/// The light of a face that a lobe scatters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaceLight {
    /// What is transmitted between media of these indices, either way.
    Transmitted([f64; 2]),
    /// What is reflected in a medium of the first index, at one of the second.
    Reflected([f64; 2]),
}

impl FaceLight {
    /// Radius of the disc of its directions.
    pub fn radius(&self) -> f64 {
        match *self {
            Self::Transmitted([a, b]) => a.min(b),
            Self::Reflected([from, _]) => from,
        }
    }

    /// Fraction of the light of a `|beta|` that it is; 0 beyond its disc.
    pub fn at(&self, length: f64) -> f64 {
        if length > self.radius() {
            return 0.0;
        }
        match *self {
            Self::Transmitted([a, b]) => 1.0 - fresnel_reflectance(a, b, length),
            Self::Reflected([from, to]) => fresnel_reflectance(from, to, length),
        }
    }
}

/// The shape of a lobe about the direction that the light had.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FaceLobe {
    /// Behind heights with the correlation exp(-r/l), in the end.
    KCorrelation(KCorrelation),
    /// Behind heights with a Gaussian correlation.
    Gaussian(Gaussian),
}

impl FaceLobe {
    /// Returns the width, direction cosines.
    pub fn width(&self) -> f64 {
        match *self {
            Self::KCorrelation(KCorrelation { width }) | Self::Gaussian(Gaussian { width }) => width,
        }
    }

    /// Returns the density at the square of a distance, per unit area of direction cosines.
    #[inline(always)]
    pub fn at_squared_distance(&self, squared: f64) -> f64 {
        match self {
            Self::KCorrelation(lobe) => lobe.at_squared_distance(squared),
            Self::Gaussian(lobe) => lobe.at_squared_distance(squared),
        }
    }

    /// Returns the fraction of the lobe within a distance of the direction that the light had.
    pub fn fraction_within(&self, radius: f64) -> f64 {
        match self {
            Self::KCorrelation(lobe) => lobe.fraction_within(radius),
            Self::Gaussian(lobe) => lobe.fraction_within(radius),
        }
    }

    /// Returns the mean of the density between directions of these `|beta|` over the difference of their
    /// azimuths.
    pub fn mean_over_azimuth(&self, a: f64, b: f64) -> f64 {
        match self {
            Self::KCorrelation(lobe) => lobe.mean_over_azimuth(a, b),
            Self::Gaussian(lobe) => lobe.mean_over_azimuth(a, b),
        }
    }

    /// Returns the direction at the distance within which a fraction of the light lies, and at a fraction of
    /// a turn.
    pub fn direction_at(&self, from: Beta, fraction: f64, turn: f64) -> Beta {
        match self {
            Self::KCorrelation(lobe) => lobe.sample_direction(from, [1.0 - fraction, turn]),
            Self::Gaussian(lobe) => {
                let (x, y) = warp::polar(lobe.distance_of(fraction), turn);
                from + Beta { x, y }
            }
        }
    }
}

/// A balanced lobe.
#[derive(Debug, Clone, PartialEq)]
pub struct BalancedLobe {
    lobe: FaceLobe,
    light: FaceLight,
    /// x over sqrt(F) at equal steps of the arcsine, from half a step on.
    factors: Vec<f64>,
}

/// Nodes of the table: least and largest number.
const NODES: [f64; 2] = [600.0, 1500.0];

/// Weights of the first nodes of the midpoint rule, which make its error one of the fourth order.
const END: [f64; 3] = [13.0 / 12.0, 7.0 / 8.0, 25.0 / 24.0];

/// Rounds of the balance: each removes more than half of what is left.
const ROUNDS: usize = 60;

impl BalancedLobe {
    /// Balances a lobe.
    pub fn new(lobe: FaceLobe, light: FaceLight) -> Self {
        let radius = light.radius();
        let nodes = (4.0 * PI * radius / lobe.width()).clamp(NODES[0], NODES[1]) as usize;
        let step = FRAC_PI_2 / nodes as f64;
        let at = |k: usize| ((k as f64 + 0.5) * step).sin_cos();
        let beta: Vec<f64> = (0..nodes).map(|k| radius * at(k).0).collect();
        let wanted: Vec<f64> = beta.iter().map(|beta| light.at(*beta)).collect();
        // The midpoint rule, corrected at its ends: there the integrand is an odd function of the distance.
        let weight = |k: usize| END.get(k.min(nodes - 1 - k)).copied().unwrap_or(1.0) * step;
        let area: Vec<f64> =
            (0..nodes).map(|k| 2.0 * PI * radius * radius * at(k).0 * at(k).1 * weight(k)).collect();
        let mut mean = vec![0.0; nodes * nodes];
        for i in 0..nodes {
            for j in 0..=i {
                let value = lobe.mean_over_azimuth(beta[i], beta[j]);
                (mean[i * nodes + j], mean[j * nodes + i]) = (value, value);
            }
        }
        let mut x: Vec<f64> = wanted.iter().map(|wanted| wanted.sqrt()).collect();
        for _ in 0..ROUNDS {
            let sums: Vec<f64> = mean
                .chunks_exact(nodes)
                .map(|row| row.iter().zip(&x).zip(&area).map(|((l, x), area)| l * x * area).sum())
                .collect();
            let mut change = 0.0_f64;
            for ((x, sum), wanted) in x.iter_mut().zip(sums).zip(&wanted) {
                let all = *x * sum;
                if all > 0.0 {
                    change = change.max((wanted / all - 1.0).abs());
                    *x *= (wanted / all).sqrt();
                }
            }
            if change < 1e-9 {
                break;
            }
        }
        let factor = |(x, wanted): (&f64, &f64)| if *wanted > 0.0 { x / wanted.sqrt() } else { 1.0 };
        Self { lobe, light, factors: x.iter().zip(&wanted).map(factor).collect() }
    }

    /// A lobe that is not balanced: it has the widths and the limits of the balanced one, and takes no time.
    pub fn unbalanced(lobe: FaceLobe, light: FaceLight) -> Self {
        Self { lobe, light, factors: vec![1.0] }
    }

    /// The lobe before it is balanced.
    pub fn lobe(&self) -> FaceLobe {
        self.lobe
    }

    /// The light that it scatters.
    pub fn light(&self) -> FaceLight {
        self.light
    }

    /// The factor x of a `|beta|`; 0 beyond the disc.
    pub fn factor(&self, length: f64) -> f64 {
        let radius = self.light.radius();
        if length >= radius {
            return 0.0;
        }
        let last = self.factors.len() - 1;
        let place = ((length / radius).asin() / FRAC_PI_2 * self.factors.len() as f64 - 0.5).max(0.0);
        let low = (place as usize).min(last);
        let share = (place - low as f64).min(1.0);
        let factor = (1.0 - share) * self.factors[low] + share * self.factors[(low + 1).min(last)];
        factor * self.light.at(length).sqrt()
    }

    /// Density of light scattered from one direction to another.
    pub fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        let factors = self.factor(from.length()) * self.factor(to.length());
        if factors > 0.0 { factors * self.lobe.at_squared_distance((to - from).squared()) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Light of all directions is scattered as the face transmits or reflects it, between the nodes, too; the
    /// means over azimuths are those of the trapezoid rule.
    #[test]
    fn nothing_is_lost() {
        for light in [
            FaceLight::Transmitted([1.0, 1.5]),
            FaceLight::Reflected([1.0, 1.5]),
            FaceLight::Reflected([1.5, 1.0]),
        ] {
            let lobes = [0.03, 0.3, 3.0].map(|width| {
                [FaceLobe::KCorrelation(KCorrelation { width }), FaceLobe::Gaussian(Gaussian { width })]
            });
            for lobe in lobes.into_iter().flatten() {
                let (one, width) = (BalancedLobe::new(lobe, light), lobe.width());
                for from in [0.0, 0.31, 0.8 * light.radius()] {
                    let (rings, turns) = (4000, 256);
                    let sum: f64 = (0..rings)
                        .map(|k| {
                            let t = (f64::from(k) + 0.5) / f64::from(rings) * FRAC_PI_2;
                            let length = light.radius() * t.sin();
                            let mean = one.lobe().mean_over_azimuth(from, length);
                            let turned = (0..turns).map(|k| {
                                let (sin, cos) = (2.0 * PI * f64::from(k) / f64::from(turns)).sin_cos();
                                let to = Beta { x: length * cos, y: length * sin };
                                one.lobe().at_squared_distance((to - Beta { x: from, y: 0.0 }).squared())
                            });
                            if width > 0.1 {
                                let other = turned.sum::<f64>() / f64::from(turns);
                                assert!(
                                    (mean / other - 1.0).abs() < 1e-9,
                                    "{lobe:?} {from} {length}: {mean} {other}"
                                );
                            }
                            let area = 2.0 * PI * light.radius().powi(2) * t.sin() * t.cos() * FRAC_PI_2
                                / f64::from(rings);
                            one.factor(from) * one.factor(length) * mean * area
                        })
                        .sum();
                    assert!((sum - light.at(from)).abs() < 1e-4, "{light:?} {lobe:?} {from}: {sum}");
                }
            }
        }
    }
}
