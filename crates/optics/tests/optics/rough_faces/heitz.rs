//! Heitz's random walk over microfacets, walker by walker, in unit vectors: an independent implementation,
//! in which all formulas have other forms (slopes drawn one after the other, Fresnel by angles, Lambda by
//! angles).
//!
//! E. Heitz, J. Hanika, E. d'Eon, C. Dachsbacher, "Multiple-Scattering Microfacet BSDFs with the Smith
//! Model", ACM Trans. Graph. 35 (4), 58 (2016): heights, algorithm 1; refraction turns the face over.

use std::f64::consts::{PI, TAU};

use papilio_optics::rough::{Distribution, Side};
use papilio_sampling::{SampleStream, Sampler};

/// Fractions of light after an interface: means over walkers, and standard errors.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shares {
    /// Left after one microfacet, to either side.
    pub(super) one: [f64; 2],
    /// Returned after more than one.
    pub(super) several_back: [f64; 2],
}

/// An interface; the medium has index `n[0]` above, `n[1]` below.
#[derive(Debug, Clone, Copy)]
pub(super) struct Face {
    pub(super) distribution: Distribution,
    pub(super) alpha: f64,
    pub(super) n: [f64; 2],
}

/// A sequence of random numbers.
struct Draws {
    numbers: SampleStream,
    path: u64,
    next: u32,
    four: [f64; 4],
}

impl Draws {
    fn draw(&mut self) -> f64 {
        if self.next.is_multiple_of(4) {
            self.four = self.numbers.block(self.path, self.next / 4);
        }
        self.next += 1;
        self.four[(self.next as usize - 1) % 4]
    }

    /// Draws from the gamma distribution of this shape, above 0 (G. Marsaglia, W. Tsang, ACM Trans. Math.
    /// Softw. 26, 363 (2000)).
    fn gamma(&mut self, shape: f64) -> f64 {
        if shape < 1.0 {
            let power = self.draw().max(1e-300).powf(1.0 / shape);
            return power * self.gamma(shape + 1.0);
        }
        let d = shape - 1.0 / 3.0;
        loop {
            let x = self.gauss();
            let v = (1.0 + x / (9.0 * d).sqrt()).powi(3);
            if v > 0.0 && (1.0 - self.draw()).ln() < 0.5 * x * x + d - d * v + d * v.ln() {
                return d * v;
            }
        }
    }

    fn gauss(&mut self) -> f64 {
        (-2.0 * (1.0 - self.draw()).ln()).sqrt() * (TAU * self.draw()).cos()
    }
}

/// A walker that has just left a microfacet: propagation with z away from its side of the interface, height
/// from the other side.
#[derive(Clone, Copy)]
struct Walker {
    side: usize,
    direction: [f64; 3],
    height: f64,
}

impl Face {
    /// Follows light from this side at this angle in its medium.
    pub(super) fn walk(&self, from: Side, theta_deg: f64, walkers: u64, seed: u64) -> Shares {
        let numbers = SampleStream::new(Sampler::Random, seed, 0);
        let (mut sums, mut squares) = ([0.0; 2], [0.0; 2]);
        for path in 0..walkers {
            let mut draws = Draws { numbers, path, next: 0, four: [0.0; 4] };
            let found = self.walker(from as usize, theta_deg.to_radians(), &mut draws);
            for k in 0..2 {
                sums[k] += found[k];
                squares[k] += found[k] * found[k];
            }
        }
        let mean = |k: usize| {
            let mean = sums[k] / walkers as f64;
            [mean, ((squares[k] / walkers as f64 - mean * mean).max(0.0) / walkers as f64).sqrt()]
        };
        Shares { one: mean(0), several_back: mean(1) }
    }

    /// Shares of light from above that leave after one, two and more microfacets of a white metal, each with
    /// its standard error.
    pub(super) fn orders_of_metal(&self, theta_deg: f64, walkers: u64, seed: u64) -> [[f64; 2]; 3] {
        let numbers = SampleStream::new(Sampler::Random, seed, 0);
        let theta = theta_deg.to_radians();
        let (mut sums, mut squares) = ([0.0; 3], [0.0; 3]);
        for path in 0..walkers {
            let mut draws = Draws { numbers, path, next: 0, four: [0.0; 4] };
            let height = draws.draw().powf(1.0 / (1.0 + self.lambda(theta.cos())));
            let mut walker = Walker { side: 0, direction: [theta.sin(), 0.0, -theta.cos()], height };
            let (mut left, mut found) = (1.0, [0.0; 3]);
            for share in &mut found[..2] {
                walker = self.mirrored(walker, &mut draws);
                let leaves = self.leaves(&walker);
                *share = left * leaves;
                left -= *share;
                // Little light goes on by chance: a walker that leaves almost surely hardly meets a
                // microfacet.
                if left < 0.1 {
                    left = if draws.draw() < 10.0 * left { 0.1 } else { 0.0 };
                }
                if left == 0.0 {
                    break;
                }
                walker.height = self.next_height(&walker, leaves, &mut draws);
            }
            found[2] = left;
            for k in 0..3 {
                sums[k] += found[k];
                squares[k] += found[k] * found[k];
            }
        }
        [0, 1, 2].map(|k| {
            let mean = sums[k] / walkers as f64;
            [mean, ((squares[k] / walkers as f64 - mean * mean).max(0.0) / walkers as f64).sqrt()]
        })
    }

    /// Chance that a walker leaves its side of the interface.
    fn leaves(&self, walker: &Walker) -> f64 {
        let cos = walker.direction[2];
        if cos > 0.0 { walker.height.powf(self.lambda(cos)) } else { 0.0 }
    }

    /// Height at which a walker meets the next microfacet, up or down, given that it does not leave.
    fn next_height(&self, walker: &Walker, leaves: f64, draws: &mut Draws) -> f64 {
        let cos = walker.direction[2];
        if cos > 0.0 {
            let survives = leaves + draws.draw() * (1.0 - leaves);
            (walker.height / survives.powf(1.0 / self.lambda(cos))).min(1.0)
        } else {
            walker.height * draws.draw().powf(1.0 / (1.0 + self.lambda(-cos)))
        }
    }

    /// Returns the walker after a microfacet that reflects all light.
    fn mirrored(&self, walker: Walker, draws: &mut Draws) -> Walker {
        let Walker { side, direction, height } = walker;
        let m = self.normal(direction, draws);
        let cos_i = -(0..3).map(|k| direction[k] * m[k]).sum::<f64>();
        Walker { side, direction: [0, 1, 2].map(|k| direction[k] + 2.0 * cos_i * m[k]), height }
    }

    /// Returns the light that leaves after one microfacet and the light that returns after several: expected
    /// values wherever light may leave.
    fn walker(&self, from: usize, theta: f64, draws: &mut Draws) -> [f64; 2] {
        let direction = [theta.sin(), 0.0, -theta.cos()];
        // It comes from above all heights, and certainly meets a microfacet.
        let height = draws.draw().powf(1.0 / (1.0 + self.lambda(theta.cos())));
        let mut walker = Walker { side: from, direction, height };
        let (mut weight, mut found) = (1.0, [0.0; 2]);
        for facet in 0.. {
            walker = self.facet(walker, draws);
            let leaves = self.leaves(&walker);
            let now = weight * leaves;
            match facet {
                0 => found[0] += now,
                _ if walker.side == from => found[1] += now,
                _ => {}
            }
            weight -= now;
            if weight < 0.1 {
                if draws.draw() > 5.0 * weight {
                    break;
                }
                weight = 0.2;
            }
            walker.height = self.next_height(&walker, leaves, draws);
        }
        found
    }

    /// Returns Smith's Lambda at an angle of this cosine, above 0.
    fn lambda(&self, cos: f64) -> f64 {
        let tan = (1.0 / (cos * cos) - 1.0).max(0.0).sqrt();
        let a = 1.0 / (self.alpha * tan);
        match self.distribution {
            Distribution::Ggx => 0.5 * ((1.0 + 1.0 / (a * a)).sqrt() - 1.0),
            // Zero slopes have no shadowing; from here on it is below 1e-12.
            Distribution::Beckmann => beckmann_lambda(a),
            // A mixture of Gaussian slopes whose inverse variance has a gamma distribution, by the midpoint
            // rule in the logarithm of that variance's scale.
            Distribution::StudentT { tail } => {
                let (shape, steps) = (tail - 1.0, 60);
                let (mut sum, mut all) = (0.0, 0.0);
                for k in 0..steps {
                    let g = (-11.0 + 14.5 * (f64::from(k) + 0.5) / f64::from(steps)).exp();
                    let weight = (shape * g.ln() - g).exp();
                    sum += weight * beckmann_lambda(a * (g / shape).sqrt());
                    all += weight;
                }
                sum / all
            }
        }
    }

    /// Returns the walker after a microfacet that is visible to it.
    fn facet(&self, walker: Walker, draws: &mut Draws) -> Walker {
        let Walker { side, direction, height } = walker;
        let m = self.normal(direction, draws);
        let cos_i = -(0..3).map(|k| direction[k] * m[k]).sum::<f64>();
        let eta = self.n[side] / self.n[1 - side];
        let sin2_t = eta * eta * (1.0 - cos_i * cos_i);
        let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
        let r_s = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
        let r_p = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
        let fresnel = if sin2_t >= 1.0 { 1.0 } else { 0.5 * (r_s * r_s + r_p * r_p) };
        if draws.draw() < fresnel {
            let direction = [0, 1, 2].map(|k| direction[k] + 2.0 * cos_i * m[k]);
            return Walker { side, direction, height };
        }
        let [x, y, z] = [0, 1, 2].map(|k| eta * direction[k] + (eta * cos_i - cos_t) * m[k]);
        // Seen from the other side, heights are inverted.
        Walker { side: 1 - side, direction: [x, y, -z], height: 1.0 - height }
    }

    /// Samples a normal among those that face the walker, by projected area.
    fn normal(&self, direction: [f64; 3], draws: &mut Draws) -> [f64; 3] {
        let (x, y, z) = (-self.alpha * direction[0], -self.alpha * direction[1], -direction[2]);
        let length = (x * x + y * y + z * z).sqrt();
        let across = x.hypot(y);
        let (sin, cos) = (across / length, z / length);
        let (along, beside) = match self.distribution {
            // The slope along x has the density (cos + sin t)/(1 + t^2)^(3/2): with t = tan a, that of a is
            // cos(a - theta).
            Distribution::Ggx => {
                let theta = sin.atan2(cos);
                let angle = theta + (draws.draw() * (1.0 + cos) - 1.0).asin();
                let t = angle.tan();
                // Given it, the other is distributed as Student's t with three degrees of freedom, over its
                // root.
                let squares: f64 = (0..3).map(|_| draws.gauss().powi(2)).sum();
                (t, (1.0 + t * t).sqrt() * draws.gauss() / squares.sqrt())
            }
            Distribution::Beckmann => loop {
                let (t, s) = (draws.gauss() / 2f64.sqrt(), draws.gauss() / 2f64.sqrt());
                if draws.draw() * (cos + 5.0 * sin) < cos + t * sin {
                    break (t, s);
                }
            },
            // Of the same mixture, by rejection from `(cos + max(t, 0) sin) p(t)`, which has two parts.
            Distribution::StudentT { tail } => loop {
                let shape = tail - 1.0;
                let steep =
                    0.5 * sin * shape.sqrt() * (ln_gamma(shape - 0.5) - ln_gamma(shape)).exp() / PI.sqrt();
                let is_steep = draws.draw() * (cos.max(0.0) + steep) < steep;
                let g = draws.gamma(if is_steep { shape - 0.5 } else { shape });
                let width = (shape / g).sqrt();
                let s = width * draws.gauss() / 2f64.sqrt();
                let t = if is_steep {
                    width * (-(1.0 - draws.draw()).ln()).sqrt()
                } else {
                    width * draws.gauss() / 2f64.sqrt()
                };
                if draws.draw() * (cos.max(0.0) + t.max(0.0) * sin) < cos + t * sin {
                    break (t, s);
                }
            },
        };
        let (ux, uy) = if across > 0.0 { (x / across, y / across) } else { (1.0, 0.0) };
        let (mx, my) = (self.alpha * (ux * along - uy * beside), self.alpha * (uy * along + ux * beside));
        let norm = (mx * mx + my * my + 1.0).sqrt();
        [mx / norm, my / norm, 1.0 / norm]
    }
}

/// Returns Smith's Lambda of Gaussian slopes at the reduced cotangent a.
fn beckmann_lambda(a: f64) -> f64 {
    // Zero slopes have no shadowing; from 5 on it is below 1e-12.
    if a > 5.0 { 0.0 } else { 0.5 * ((-a * a).exp() / (a * PI.sqrt()) - erfc(a)) }
}

/// Returns the logarithm of the gamma function by Stirling's series, above 0.
fn ln_gamma(x: f64) -> f64 {
    if x < 8.0 {
        return ln_gamma(x + 1.0) - x.ln();
    }
    let series = 1.0 / (12.0 * x) - 1.0 / (360.0 * x.powi(3)) + 1.0 / (1260.0 * x.powi(5));
    (x - 0.5) * x.ln() - x + 0.5 * TAU.ln() + series
}

/// Returns the complementary error function by its continued fraction, or by its series.
fn erfc(x: f64) -> f64 {
    if x > 2.0 {
        let fraction = (1..60).rev().fold(x, |rest, k| x + 0.5 * f64::from(k) / rest);
        return (-x * x).exp() / (fraction * PI.sqrt());
    }
    let (mut term, mut sum) = (x, x);
    for k in 1..60 {
        let k = f64::from(k);
        term *= -x * x / k;
        sum += term / (2.0 * k + 1.0);
    }
    1.0 - 2.0 / PI.sqrt() * sum
}
