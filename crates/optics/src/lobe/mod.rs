//! Scattering lobes of diffusers, as densities over direction cosines.
//!
//! A lobe is the angular shape alone: [`evaluate`](Scatterer::evaluate) integrates to one
//! over the whole plane of `beta_o`. A diffuser's BTDF (1/sr, referred to air,
//! without the cosine) is its transmittance times this. All lobes here
//! are reciprocal and are sampled exactly: `evaluate` and `density` are the same number.

mod balanced;
mod gaussian;
mod k_correlation;
mod lambertian;

pub use balanced::{BalancedLobe, FaceLight, FaceLobe};
pub use gaussian::Gaussian;
pub use k_correlation::KCorrelation;
pub use lambertian::Lambertian;

use crate::Beta;
use crate::scatterer::{Sample, Scatterer};

/// The shape of a scattering lobe.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Lobe {
    /// The [k-correlation lobe](KCorrelation).
    KCorrelation {
        /// b, in direction cosines, above 0.
        width: f64,
    },
    /// The [Lambertian lobe](Lambertian).
    Lambertian,
}

impl From<KCorrelation> for Lobe {
    fn from(KCorrelation { width }: KCorrelation) -> Self {
        Self::KCorrelation { width }
    }
}

impl Scatterer for Lobe {
    type Direction = Beta;

    #[inline(always)]
    fn evaluate(&self, from: Beta, to: Beta) -> f64 {
        match *self {
            Self::KCorrelation { width } => KCorrelation { width }.evaluate(from, to),
            Self::Lambertian => Lambertian.evaluate(from, to),
        }
    }

    #[inline(always)]
    fn sample(&self, from: Beta, u: [f64; 4]) -> Option<Sample<Beta>> {
        match *self {
            Self::KCorrelation { width } => KCorrelation { width }.sample(from, u),
            Self::Lambertian => Lambertian.sample(from, u),
        }
    }

    #[inline(always)]
    fn density(&self, from: Beta, to: Beta) -> f64 {
        self.evaluate(from, to)
    }

    fn albedo(&self, from: Beta) -> f64 {
        match *self {
            Self::KCorrelation { width } => KCorrelation { width }.albedo(from),
            Self::Lambertian => Lambertian.albedo(from),
        }
    }
}

impl Lobe {
    /// Returns only the direction of [`sample`](Scatterer::sample), from the two numbers that lobes need.
    #[inline(always)]
    pub fn sample_direction(&self, from: Beta, [u, v]: [f64; 2]) -> Option<Beta> {
        // Without closures and without the density: this is the innermost loop of Monte Carlo.
        match *self {
            Self::KCorrelation { width } => Some(KCorrelation { width }.sample_direction(from, [u, v])),
            Self::Lambertian => Lambertian.sample_direction(from, [u, v]),
        }
    }

    /// Returns the fraction of the lobe within `radius` of the direction of normal incidence.
    pub fn fraction_within(&self, radius: f64) -> f64 {
        match *self {
            Self::KCorrelation { width } => KCorrelation { width }.fraction_within(radius),
            Self::Lambertian => Lambertian.fraction_within(radius),
        }
    }

    /// Returns the fraction of the lobe that stays within the air hemisphere at normal incidence.
    ///
    /// `total_transmittance = T ((1 - s) fraction + s)`, s the regular fraction.
    pub fn hemispherical_fraction(&self) -> f64 {
        self.fraction_within(1.0)
    }

    /// Returns the fraction of the lobe within the disc `|beta_o| <= radius`, for light that arrives with
    /// `|beta_i| = offset`. With a radius of 1 it is the fraction that a diffuser transmits into the air.
    pub fn fraction_in_disc(&self, offset: f64, radius: f64) -> f64 {
        self.fractions_in_disc([offset], radius)[0]
    }

    /// Returns the same for several offsets at once, so that divisions overlap.
    #[inline(always)]
    pub fn fractions_in_disc<const N: usize>(&self, offsets: [f64; N], radius: f64) -> [f64; N] {
        match *self {
            Self::KCorrelation { width } => KCorrelation { width }.fractions_in_disc(offsets, radius),
            Self::Lambertian => {
                offsets.map(|offset| if offset > 1.0 { 0.0 } else { Lambertian.fraction_within(radius) })
            }
        }
    }

    /// Returns the haze: fraction beyond 2.5 deg of all light transmitted into the air hemisphere at normal
    /// incidence, regular light included.
    pub fn haze(&self, regular_fraction: f64) -> f64 {
        let scattered = 1.0 - regular_fraction;
        let hemisphere = self.fraction_within(1.0);
        let beyond = hemisphere - self.fraction_within(HAZE_ANGLE_DEG.to_radians().sin());
        scattered * beyond / (scattered * hemisphere + regular_fraction)
    }
}

/// ASTM D1003: light deviated by more than this counts as haze, degrees.
pub const HAZE_ANGLE_DEG: f64 = 2.5;

/// Returns the width b of the k-correlation lobe that has this [haze](Lobe::haze).
///
/// With a regular fraction the haze first rises and then falls with b (a very wide lobe scatters most of its
/// light beyond the hemisphere): the narrower of the two widths is returned. `None` if no width has that
/// haze.
pub fn width_from_haze(haze: f64, regular_fraction: f64) -> Option<f64> {
    let haze_of = |log_width: f64| Lobe::KCorrelation { width: log_width.exp() }.haze(regular_fraction);
    if !(haze > 0.0 && haze < 1.0 && (0.0..1.0).contains(&regular_fraction)) {
        return None;
    }
    let mut low = (1e-9_f64).ln();
    let mut high = log_width_of_most_haze(haze_of);
    if haze < haze_of(low) || haze > haze_of(high) {
        return None;
    }
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if haze_of(middle) < haze { low = middle } else { high = middle }
    }
    Some((0.5 * (low + high)).exp())
}

/// Returns the largest haze that a k-correlation lobe can have with this regular fraction.
pub fn largest_haze(regular_fraction: f64) -> f64 {
    let haze_of = |log_width: f64| Lobe::KCorrelation { width: log_width.exp() }.haze(regular_fraction);
    haze_of(log_width_of_most_haze(haze_of))
}

/// Golden-section search for the maximum of a unimodal function of ln(width).
fn log_width_of_most_haze(haze_of: impl Fn(f64) -> f64) -> f64 {
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut a, mut b) = ((1e-9_f64).ln(), (1e3_f64).ln());
    for _ in 0..120 {
        let (c, d) = (b - golden * (b - a), a + golden * (b - a));
        if haze_of(c) > haze_of(d) { b = d } else { a = c }
    }
    0.5 * (a + b)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use papilio_sampling::warp;

    use super::*;
    use papilio_testing::ChiSquare;

    /// Haze and width, truncated at the hemisphere: table recomputed from 1 - F(sin 2.5 deg)/F(1),
    /// F(r) = 1 - b/sqrt(b^2 + r^2).
    #[test]
    fn haze_and_width_are_inverse() {
        for (haze, width) in
            [(0.50, 0.02607), (0.65, 0.03869), (0.78, 0.05667), (0.81, 0.06295), (0.90, 0.09543)]
        {
            let found = width_from_haze(haze, 0.0).unwrap();
            assert!((found - width).abs() < 6e-6, "haze {haze}: {found} against {width}");
        }
    }

    /// Chi-square of samples against a claimed distribution of the radius, on 16 x 16 cells
    /// of equal probability around the unscattered direction.
    fn chi_square(lobe: Lobe, beta_i: Beta, fraction_within: impl Fn(f64) -> f64) -> ChiSquare {
        let numbers = papilio_sampling::SampleStream::new(papilio_sampling::Sampler::Random, 17, 0);
        let (samples, mut cells) = (40_000, [0.0_f64; 256]);
        for path in 0..samples {
            let u = numbers.block(path, 0);
            let beta_o = lobe.sample(beta_i, u).unwrap().direction;
            let from = if lobe == Lobe::Lambertian { beta_o } else { beta_o - beta_i };
            let turn = from.y.atan2(from.x).rem_euclid(2.0 * PI) / (2.0 * PI);
            let cell = |v: f64| ((v * 16.0) as usize).min(15);
            cells[cell(fraction_within(from.length())) * 16 + cell(turn)] += 1.0;
        }
        ChiSquare::uniform(&cells)
    }

    /// `fraction_within` is the integral of the density (tested below), which relates samples to densities.
    #[test]
    fn samples_follow_density() {
        for lobe in
            [Lobe::KCorrelation { width: 0.0567 }, Lobe::KCorrelation { width: 0.9 }, Lobe::Lambertian]
        {
            for theta_deg in [0.0, 30.0] {
                let found = chi_square(lobe, Beta::towards(theta_deg, 50.0, 1.0), |radius| {
                    lobe.fraction_within(radius)
                });
                assert!(found.is_likely(), "{lobe:?} {theta_deg}: {found:?}");
            }
        }
    }

    #[test]
    fn slightly_too_wide_density_is_refused() {
        let wider = Lobe::KCorrelation { width: 0.0567 * 1.05 };
        let lobe = Lobe::KCorrelation { width: 0.0567 };
        let found = chi_square(lobe, Beta::default(), |radius| wider.fraction_within(radius));
        assert!(!found.is_likely(), "{found:?}");
    }

    #[test]
    fn regular_light_is_not_haze() {
        let width = width_from_haze(0.4, 0.3).unwrap();
        assert!((Lobe::KCorrelation { width }.haze(0.3) - 0.4).abs() < 1e-12);
        assert!(width < 0.2, "the narrower of the two widths: {width}");
        assert_eq!(width_from_haze(0.8, 0.3), None, "30 % straight-through leaves at most 70 % haze");
        assert_eq!(width_from_haze(0.9999, 0.0), None);
        for regular_fraction in [0.0, 0.3, 0.9] {
            let most = largest_haze(regular_fraction);
            assert!(width_from_haze(most - 1e-9, regular_fraction).is_some());
            assert_eq!(width_from_haze(most + 1e-9, regular_fraction), None);
        }
        // The widest lobe is uniform over the hemisphere: all but the fraction sin^2 2.5 deg is haze.
        let flat = 1.0 - 2.5_f64.to_radians().sin().powi(2);
        assert!((largest_haze(0.0) - flat).abs() < 1e-6);
        assert_eq!(largest_haze(1.0), 0.0);
        assert_eq!(width_from_haze(f64::NAN, 0.0), None);
    }

    /// TIS/T of a b = 0.1 lobe by truncation alone, 0 to 75 deg, by numerical integration over the unit
    /// disc.
    #[test]
    fn truncation_removes_more_of_oblique_light() {
        let lobe = Lobe::KCorrelation { width: 0.1 };
        let published =
            [(0.0, 0.9005), (15.0, 0.8953), (30.0, 0.8768), (45.0, 0.8331), (60.0, 0.7291), (75.0, 0.5342)];
        for (theta_deg, share) in published {
            let beta_i = Beta::towards(theta_deg, 0.0, 1.0);
            let (rings, spokes) = (1500, 720);
            let mut sum = 0.0;
            for ring in 0..rings {
                let radius = (ring as f64 + 0.5) / rings as f64;
                for spoke in 0..spokes {
                    let (x, y) = warp::polar(radius, (spoke as f64 + 0.5) / spokes as f64);
                    sum += lobe.density(beta_i, Beta { x, y }) * radius;
                }
            }
            let share_found = sum * 2.0 * PI / (rings * spokes) as f64;
            assert!((share_found - share).abs() < 6e-5, "{theta_deg} deg: {share_found} against {share}");
        }
    }

    /// Compared with the integral over azimuth of the part between the near and far rim.
    #[test]
    fn fraction_in_disc_equals_integral_of_density() {
        for (width, radius) in [(0.0567, 1.0), (0.005, 1.0), (0.4, 1.5)] {
            let lobe = Lobe::KCorrelation { width };
            for offset in [0.0, 0.3, 0.97, 1.0, 1.02, 1.4, 1.5] {
                let steps = 400_000;
                let mean = (0..steps).map(|step| {
                    let phi = PI * (f64::from(step) + 0.5) / f64::from(steps);
                    let half_chord = (radius * radius - (offset * phi.sin()).powi(2)).max(0.0).sqrt();
                    let [near, far] = [-half_chord, half_chord].map(|h| (h - offset * phi.cos()).max(0.0));
                    lobe.fraction_within(far) - lobe.fraction_within(near)
                });
                let integral = mean.sum::<f64>() / f64::from(steps);
                let found = lobe.fraction_in_disc(offset, radius);
                assert!((found - integral).abs() < 2e-8, "{width} {radius} {offset}: {found} {integral}");
            }
        }
        assert_eq!(Lobe::Lambertian.fraction_in_disc(0.5, 1.0), 1.0);
        assert_eq!(Lobe::Lambertian.fraction_in_disc(1.2, 1.0), 0.0);
    }

    #[test]
    fn fraction_within_radius_equals_integral_of_density() {
        for lobe in [Lobe::KCorrelation { width: 0.07 }, Lobe::Lambertian] {
            for radius in [0.05, 0.4, 1.0] {
                let rings = 20_000;
                let integral: f64 = (0..rings)
                    .map(|ring| {
                        let r = radius * (ring as f64 + 0.5) / rings as f64;
                        lobe.density(Beta::default(), Beta { x: r, y: 0.0 }) * 2.0 * PI * r
                    })
                    .sum::<f64>()
                    * radius
                    / rings as f64;
                assert!((integral - lobe.fraction_within(radius)).abs() < 1e-6);
            }
        }
    }
}
