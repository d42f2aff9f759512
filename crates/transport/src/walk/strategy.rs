//! Strategies for sampling directions where a diffuser scatters.
//!
//! Whatever the density, the weight of a path contains the value of the lobe over the density. All
//! strategies thus have the same mean; they differ in noise.
//!
//! - [`Strategy::Uniform`]: uniformly over the hemisphere (of the medium on the way down, of air up).
//! - [`Strategy::Cosine`]: uniformly over direction cosines.
//! - [`Strategy::Ward`]: Ward's lobe with the width that fits the diffuser best (least squares, as
//!   Feng 2012, eq. 4-17, 4-18), about the unscattered direction (eq. 4-19 to 4-21). Its Gaussian
//!   tail falls faster than the diffuser's: one direction in ten is sampled by the cosine, without
//!   which the weights would be unbounded.
//! - [`Strategy::Kernel`]: from the lobe itself; towards sources from both ends.
//! - [`Strategy::Guided`]: on the first pass from the product of lobe, light and pixel
//!   ([`guide`](super::guide)).
//!
//! From the first scattering on the way up on, the last two draw some directions from lobes about the
//! sources: paths that reach a source by chance alone are rare and bright where lobes are narrow.

use papilio_optics::lobe::Lobe;
use papilio_optics::scatter::GaussianFacets;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;

use crate::Source;

/// How the Monte Carlo solver samples directions where a diffuser scatters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Strategy {
    /// Uniformly over the hemisphere of directions.
    Uniform,
    /// Proportionally to the cosine.
    Cosine,
    /// From Ward's lobe, fitted to that of the diffuser.
    Ward,
    /// From the lobe itself.
    #[default]
    Kernel,
    /// From the product of the lobe, the light and the pixel.
    Guided,
}

impl Strategy {
    /// All strategies.
    pub const ALL: [Self; 5] = [Self::Uniform, Self::Cosine, Self::Ward, Self::Kernel, Self::Guided];

    /// Returns the name used in scenarios.
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniform => "uniform",
            Self::Cosine => "cosine",
            Self::Ward => "ward",
            Self::Kernel => "kernel",
            Self::Guided => "guided",
        }
    }
}

/// Fraction of the directions that are sampled by the cosine instead of from Ward's lobe.
const COSINE_FRACTION: f64 = 0.1;

/// Fraction of the directions that are sampled from lobes about sources.
const ABOUT_SOURCES: f64 = 0.5;

/// Width of the Gaussian `exp(-r^2/s^2)` that fits a k-correlation lobe of width 1 best: it maximises
/// `(integral of both)^2 / integral of its square`.
const GAUSSIAN_OF_LOBE: f64 = 1.2175;

/// Samples directions for one lobe.
#[derive(Debug)]
pub(super) struct DirectionSampler {
    lobe: Lobe,
    kind: Kind,
}

#[derive(Debug)]
enum Kind {
    Uniform,
    Cosine,
    Ward(Ward),
    Kernel,
    AboutSources(Vec<(Beta, Lobe)>),
}

/// A direction, and the value of the lobe over the density with which it was sampled.
#[derive(Debug, Clone, Copy)]
pub(super) struct DirectionSample {
    pub(super) beta: Beta,
    pub(super) weight: f64,
}

impl DirectionSampler {
    /// Returns the sampler of a strategy; `index` is that of the medium below the diffuser.
    pub(super) fn new(strategy: Strategy, lobe: Lobe, index: f64, sources: &[Source]) -> Self {
        let kind = match (strategy, lobe) {
            (Strategy::Uniform, _) => Kind::Uniform,
            (Strategy::Cosine, _) => Kind::Cosine,
            (Strategy::Ward, Lobe::KCorrelation { width }) => Kind::Ward(Ward::fitted(width, index)),
            (Strategy::Kernel | Strategy::Guided, Lobe::KCorrelation { width }) => {
                let lamps: Vec<_> = sources.iter().filter_map(|source| lobe_about(source, width)).collect();
                if lamps.is_empty() { Kind::Kernel } else { Kind::AboutSources(lamps) }
            }
            (_, Lobe::Lambertian) => Kind::Kernel,
        };
        Self { lobe, kind }
    }

    /// Returns a sampler of the lobe itself.
    pub(super) fn kernel(lobe: Lobe) -> Self {
        Self { lobe, kind: Kind::Kernel }
    }

    /// Samples a direction in a medium whose directions fill a disc of this radius; `None` if there is none.
    #[inline]
    pub(super) fn draw(&self, from: Beta, radius: f64, u: [f64; 2]) -> Option<DirectionSample> {
        let beta = match &self.kind {
            Kind::Kernel => {
                return Some(DirectionSample { beta: self.lobe.sample_direction(from, u)?, weight: 1.0 });
            }
            Kind::Uniform => {
                let (x, y) = warp::polar(radius * (u[0] * (2.0 - u[0])).sqrt(), u[1]);
                Beta { x, y }
            }
            Kind::Cosine => cosine(radius, u),
            Kind::Ward(_) if u[0] < COSINE_FRACTION => cosine(radius, [u[0] / COSINE_FRACTION, u[1]]),
            Kind::Ward(ward) => {
                ward.sample(from, [(u[0] - COSINE_FRACTION) / (1.0 - COSINE_FRACTION), u[1]])?
            }
            Kind::AboutSources(lamps) => {
                let rest = u[0] / ABOUT_SOURCES;
                if rest < 1.0 {
                    let lamp = (rest * lamps.len() as f64) as usize;
                    let (at, lobe) = lamps.get(lamp)?;
                    let rest = (rest * lamps.len() as f64 - lamp as f64).max(f64::MIN_POSITIVE);
                    lobe.sample_direction(*at, [rest, u[1]])?
                } else {
                    self.lobe
                        .sample_direction(from, [(u[0] - ABOUT_SOURCES) / (1.0 - ABOUT_SOURCES), u[1]])?
                }
            }
        };
        let density = self.density(from, beta, radius);
        (density > 0.0).then(|| DirectionSample { beta, weight: self.lobe.density(from, beta) / density })
    }

    /// Returns the density with which [`Self::draw`] samples `to`, over direction cosines.
    #[inline]
    pub(super) fn density(&self, from: Beta, to: Beta, radius: f64) -> f64 {
        match &self.kind {
            Kind::Kernel => self.lobe.density(from, to),
            Kind::AboutSources(lamps) => {
                let of_lamps: f64 = lamps.iter().map(|(at, lobe)| lobe.density(*at, to)).sum();
                (1.0 - ABOUT_SOURCES) * self.lobe.density(from, to)
                    + ABOUT_SOURCES * of_lamps / lamps.len() as f64
            }
            _ if to.length() >= radius => 0.0,
            Kind::Uniform => {
                let cos = (1.0 - to.squared() / (radius * radius)).sqrt();
                0.5 * warp::uniform_disc_density(radius) / cos
            }
            Kind::Cosine => warp::uniform_disc_density(radius),
            Kind::Ward(ward) => {
                let cosine = COSINE_FRACTION * warp::uniform_disc_density(radius);
                (1.0 - COSINE_FRACTION) * ward.density(from, to) + cosine
            }
        }
    }
}

#[inline]
fn cosine(radius: f64, u: [f64; 2]) -> Beta {
    let (x, y) = warp::uniform_disc(radius, u);
    Beta { x, y }
}

/// Returns the direction of a source, and a lobe of its size or of the diffuser's, whichever is larger.
fn lobe_about(source: &Source, width: f64) -> Option<(Beta, Lobe)> {
    match source {
        Source::Diffuse | Source::Field(_) => None,
        Source::Beam(beta) => Some((*beta, Lobe::KCorrelation { width })),
        Source::Disc(cone) => {
            let width = width.hypot(cone.half_angle().sin());
            Some((-cone.axis_towards(), Lobe::KCorrelation { width }))
        }
    }
}

/// Microfacets with Gaussian slopes in a medium of this index.
#[derive(Debug, Clone, Copy)]
struct Ward {
    facets: GaussianFacets,
    index: f64,
}

impl Ward {
    /// Fits the lobe: near the normal `tan h` is half the deviation over the index.
    fn fitted(width: f64, index: f64) -> Self {
        Self { facets: GaussianFacets { alpha: GAUSSIAN_OF_LOBE * width / (2.0 * index) }, index }
    }

    /// Converts a direction to cosines of a medium of index 1.
    fn of_air(&self, beta: Beta) -> Beta {
        Beta { x: beta.x / self.index, y: beta.y / self.index }
    }

    fn sample(&self, from: Beta, u: [f64; 2]) -> Option<Beta> {
        let to = self.facets.sample(self.of_air(from), u)?;
        Some(Beta { x: self.index * to.x, y: self.index * to.y })
    }

    /// Returns the density per unit area of direction cosines.
    fn density(&self, from: Beta, to: Beta) -> f64 {
        self.facets.density(self.of_air(from), self.of_air(to)) / (self.index * self.index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_sampling::{SampleStream, Sampler};

    /// Chi-square, as a standard normal variable, of samples on the cells of a square grid against the
    /// density times `distorted`.
    fn statistic(drawing: &DirectionSampler, radius: f64, distorted: impl Fn(Beta) -> f64) -> f64 {
        const SIDE: usize = 12;
        const DRAWS: u64 = 60_000;
        let numbers = SampleStream::new(Sampler::Random, 5, 0);
        let from = Beta { x: 0.1, y: -0.05 };
        let cell = |to: Beta| {
            let at = |v: f64| ((v / radius + 1.0) * 0.5 * SIDE as f64).clamp(0.0, SIDE as f64 - 1.0) as usize;
            at(to.y) * SIDE + at(to.x)
        };
        let mut met = vec![0.0_f64; SIDE * SIDE];
        for path in 0..DRAWS {
            let u = numbers.block(path, 0);
            let drawn = drawing.draw(from, radius, [u[0], u[1]]).filter(|drawn| drawn.beta.length() < radius);
            drawn.into_iter().for_each(|drawn| met[cell(drawn.beta)] += 1.0);
        }
        let mut expected = vec![0.0; SIDE * SIDE];
        let fine = 60 * SIDE;
        let step = 2.0 * radius / fine as f64;
        for k in 0..fine * fine {
            let at = |k: usize| -radius + (k as f64 + 0.5) * step;
            let to = Beta { x: at(k % fine), y: at(k / fine) };
            if to.length() < radius {
                let density = drawing.density(from, to, radius) * distorted(to);
                expected[cell(to)] += density * step * step * DRAWS as f64;
            }
        }
        let cells = met.iter().copied().zip(expected).filter(|(_, expected)| *expected > 20.0);
        papilio_testing::ChiSquare::of(cells, 20.0).z()
    }

    /// Below the glass and above it; lobes about the sources make the kernel a mixture.
    #[test]
    fn samples_follow_density() {
        let lobe = Lobe::KCorrelation { width: 0.2 };
        let lamps =
            [Source::Beam(Beta { x: -0.4, y: 0.3 }), Source::Disc(crate::Cone::new(40.0, 0.0, 5.0, 1.0))];
        for strategy in Strategy::ALL {
            let drawing = DirectionSampler::new(strategy, lobe, 1.5, &lamps);
            for radius in [1.5, 1.0] {
                let right = statistic(&drawing, radius, |_| 1.0);
                assert!(right.abs() < 4.5, "{strategy:?} {radius}: {right}");
                let wrong = statistic(&drawing, radius, |to| 1.0 + 0.3 * to.x);
                assert!(wrong > 4.5, "{strategy:?} {radius}: a wrong density must be caught, {wrong}");
            }
        }
    }

    /// The weight of a sample is the value of the lobe over the density.
    #[test]
    fn sample_weights_equal_lobe_over_density() {
        let lobe = Lobe::KCorrelation { width: 0.1 };
        let lamps = [Source::Beam(Beta { x: -0.4, y: 0.3 })];
        let numbers = SampleStream::new(Sampler::Random, 6, 0);
        let from = Beta { x: 0.2, y: 0.1 };
        for strategy in Strategy::ALL {
            let drawing = DirectionSampler::new(strategy, lobe, 1.5, &lamps);
            for path in 0..100 {
                let u = numbers.block(path, 0);
                let Some(drawn) = drawing.draw(from, 1.5, [u[0], u[1]]) else { continue };
                let over = lobe.density(from, drawn.beta) / drawing.density(from, drawn.beta, 1.5);
                assert!((drawn.weight - over).abs() < 1e-12 * over, "{strategy:?}");
            }
        }
    }
}
