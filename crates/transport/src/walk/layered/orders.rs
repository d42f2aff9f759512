//! Control variates for the light of beams and small discs in a medium: the orders of scattering by a narrow
//! phase function.
//!
//! Deflections by the phase function of Henyey and Greenstein with anisotropies g and h, one after the other,
//! are one deflection with g h. Let `s` be the direction of a source. The mean of `p_h(after . s)` over a
//! deflection by `p_g` is therefore `p_gh(before . s)`, exactly. If light kept the cosine of the source, then
//! light that has an optical length T to go before it leaves for the source would be scattered m more times
//! with the probability `T^m exp(-T) / m!`, and m deflections would lead it to the source with the density
//! `p_(g^m)`. This is close to the truth for the light that matters: that near `s`.
//!
//! The series over m is therefore an approximation of all that a path still contributes, from any depth and
//! direction. Along the path, its value after each random decision is subtracted, and its exact mean over
//! this decision is added. The sum has mean zero whatever the quality of the approximation, and removes the
//! noise of decisions as far as the approximation is good. Its coefficients follow from the medium alone; no
//! regression is needed, and it serves all states and wavelengths at once.
//!
//! The mean over a flight is exact because the coefficients are polynomials of the depth.

use papilio_optics::phase::HenyeyGreenstein;

use super::bulk::Bulk;
use crate::skeleton::Propagation;
use crate::walk::Target;

/// Degree of the polynomials of the depth.
const DEGREE: usize = 6;
const TERMS: usize = DEGREE + 1;
/// Largest number of orders.
const MOST: usize = 16;
/// Optical length beyond which little light of few orders arrives.
const LONGEST: f64 = 12.0;
/// Connections to a disc carry nearly all of its light if its density is this many times that of the phase
/// function's peak.
const SMALL: f64 = 4.0;
/// Anisotropy from which on the approximation is good.
const NARROW: f64 = 0.5;
/// Optical length of a flight up to which Gauss quadrature is exact.
const SHORT: f64 = 2.0;

/// Powers of the depth that a flight reaches, integrated over the flight: `exp(-t) x(t)^k dt` up to the
/// boundary.
pub(super) type Moments = [f64; TERMS];

/// The orders of a source's light in a medium.
#[derive(Debug, Clone)]
pub(super) struct Orders {
    /// Leaving upwards and downwards.
    ways: [Way; 2],
}

/// Light that leaves the medium for the source in one sense.
#[derive(Debug, Clone)]
struct Way {
    towards: [f64; 3],
    anisotropy: f64,
    albedo: f64,
    /// Orders in use.
    count: usize,
    /// Polynomial of the depth for each number of further events, that of the next one included.
    further: [[f64; TERMS]; MOST],
    /// The same where light has left the medium downwards, to return from a mirror.
    returning: [f64; MOST],
}

/// The approximation after a deflection, for each of the two ways.
#[derive(Debug, Clone, Copy)]
pub(super) struct Expected {
    /// Mean over the next flight, less the value before it; the former where the flight ends in the medium.
    pub(super) flight: [f64; 2],
    pub(super) before: [f64; 2],
    /// Coefficients of what is subtracted at the end of the flight.
    next: [[f64; TERMS]; 2],
    left: [f64; 2],
}

impl Orders {
    /// Builds the orders of light for this target; `None` where they would not reduce noise. `mirror`: light
    /// that leaves the medium downwards returns.
    pub(super) fn new(bulk: &Bulk<'_>, target: Target, mirror: bool) -> Option<Self> {
        let index = bulk.index();
        if !bulk.is_grey() || bulk.anisotropy() < NARROW || target.beta.squared() >= index * index {
            return None;
        }
        let peak = HenyeyGreenstein { anisotropy: bulk.anisotropy() }.at_cosine(1.0);
        let way = |going| -> Option<Way> {
            let towards = bulk.direction(target.beta, going);
            if target.density < SMALL * bulk.over_cosines(peak, towards[2]) {
                return None;
            }
            let scale = target.only_connection(bulk.over_cosines(1.0, towards[2]));
            let length = bulk.optical_thickness() / towards[2].abs();
            let tail = if mirror && going == Propagation::Down { length } else { 0.0 };
            (length + tail <= LONGEST).then(|| Way::new(bulk, (towards, going), (length, tail), scale))
        };
        Some(Self { ways: [way(Propagation::Up)?, way(Propagation::Down)?] })
    }

    /// Evaluates the approximation for light of this direction at this depth, from -1 to 1; `moments` are
    /// those of its flight, and `leaves` is the probability with which it leaves the medium.
    pub(super) fn expected(
        &self,
        direction: [f64; 3],
        depth: f64,
        moments: &Moments,
        leaves: f64,
    ) -> Expected {
        let mut of = Expected { flight: [0.0; 2], before: [0.0; 2], next: [[0.0; TERMS]; 2], left: [0.0; 2] };
        let powers = powers(depth);
        for (k, way) in self.ways.iter().enumerate() {
            let density = way.densities(direction);
            let mut sum = [0.0; TERMS];
            for m in 0..way.count {
                let further = &way.further[m];
                sum.iter_mut().zip(further).for_each(|(sum, value)| *sum += density[m + 1] * value);
                if m > 0 {
                    of.before[k] += density[m] * dot(further, &powers);
                    of.left[k] += density[m] * way.returning[m];
                }
            }
            if direction[2] < 0.0 {
                of.left[k] = 0.0;
            }
            of.flight[k] = way.albedo * dot(&sum, moments) + leaves * of.left[k];
            of.next[k] = way.further[0].map(|value| way.albedo * density[1] * value);
        }
        of
    }
}

impl Expected {
    /// Value at the end of the flight: at this depth from -1 to 1, or outside of the medium. What the event
    /// there adds, and its mean over the deflection there, are left out of it.
    pub(super) fn after(&self, reached: Option<f64>) -> [f64; 2] {
        reached.map_or(self.left, |depth| {
            let powers = powers(depth);
            self.next.map(|next| dot(&next, &powers))
        })
    }
}

impl Way {
    fn new(
        bulk: &Bulk<'_>,
        (towards, going): ([f64; 3], Propagation),
        (length, tail): (f64, f64),
        scale: f64,
    ) -> Self {
        let albedo = bulk.largest_albedo();
        let most = length + tail;
        let count = ((most + 3.0 * most.sqrt()).ceil() as usize + 1).min(MOST - 1);
        let mut further = [[0.0; TERMS]; MOST];
        let mut returning = [0.0; MOST];
        // At Chebyshev nodes, from the top to the bottom; then as powers.
        let rest = |x: f64| 0.5 * length * if going == Propagation::Down { 1.0 - x } else { 1.0 + x };
        let nodes: [f64; TERMS] =
            std::array::from_fn(|k| (std::f64::consts::PI * (k as f64 + 0.5) / TERMS as f64).cos());
        let (mut values, mut factor) = (nodes.map(|x| scale * (-rest(x)).exp()), scale);
        for m in 0..count {
            further[m] = interpolated(&nodes, &values);
            returning[m] = factor;
            let next = albedo / (m + 1) as f64;
            values.iter_mut().zip(nodes).for_each(|(value, x)| *value *= next * (rest(x) + tail));
            factor *= next * tail;
        }
        Self { towards, anisotropy: bulk.anisotropy(), albedo, count, further, returning }
    }

    /// Density towards the source per steradian after each number of deflections, from 1 on.
    fn densities(&self, direction: [f64; 3]) -> [f64; MOST + 1] {
        let cos: f64 = self.towards.iter().zip(direction).map(|(a, b)| a * b).sum();
        let mut densities = [0.0; MOST + 1];
        let mut anisotropy = 1.0;
        for density in &mut densities[1..=self.count] {
            anisotropy *= self.anisotropy;
            *density = HenyeyGreenstein { anisotropy }.at_cosine(cos);
        }
        densities
    }
}

/// Returns the moments of a flight that begins at this depth, from -1 to 1, with this change over a mean free
/// path.
pub(super) fn moments(depth: f64, slope: f64, edge: f64) -> Moments {
    let mut moments = [0.0; TERMS];
    if edge <= SHORT {
        for (node, weight) in GAUSS {
            let t = edge * node;
            let mut value = edge * weight * (-t).exp();
            let x = depth + slope * t;
            for moment in &mut moments {
                *moment += value;
                value *= x;
            }
        }
        return moments;
    }
    // By parts. The slope is below 1: rounding errors do not grow. A longer flight than this ends in the
    // medium.
    let edge = edge.min(1e3);
    let (left, last) = ((-edge).exp(), depth + slope * edge);
    let (mut start, mut end, mut before) = (1.0, left, 0.0);
    for (k, moment) in moments.iter_mut().enumerate() {
        *moment = start - end + k as f64 * slope * before;
        (start, end, before) = (start * depth, end * last, *moment);
    }
    moments
}

fn powers(x: f64) -> [f64; TERMS] {
    let mut powers = [1.0; TERMS];
    (1..TERMS).for_each(|k| powers[k] = x * powers[k - 1]);
    powers
}

fn dot(a: &[f64; TERMS], b: &[f64; TERMS]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns the coefficients of powers of the polynomial with these values at these nodes (Newton's divided
/// differences).
fn interpolated(nodes: &[f64; TERMS], values: &[f64; TERMS]) -> [f64; TERMS] {
    let mut differences = *values;
    for j in 1..TERMS {
        for k in (j..TERMS).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (nodes[k] - nodes[k - j]);
        }
    }
    let mut powers = [0.0; TERMS];
    for j in (0..TERMS).rev() {
        for k in (1..TERMS).rev() {
            powers[k] = powers[k - 1] - nodes[j] * powers[k];
        }
        powers[0] = differences[j] - nodes[j] * powers[0];
    }
    powers
}

/// Nodes and weights of Gauss's rule of eight points from 0 to 1.
const GAUSS: [(f64, f64); 8] = [
    (0.0198550717512319, 0.0506142681451882),
    (0.1016667612931866, 0.1111905172266873),
    (0.2372337950418355, 0.1568533229389437),
    (0.4082826787521751, 0.181341891689181),
    (0.591717321247825, 0.181341891689181),
    (0.7627662049581645, 0.1568533229389437),
    (0.8983332387068134, 0.1111905172266873),
    (0.9801449282487682, 0.0506142681451882),
];
