//! Lobes in azimuth: their Fourier orders, and products of them summed over a circle.
//!
//! At radii a and c a k-correlation lobe is `b/(2 pi) (A - C cos phi)^(-3/2)` with
//! `A = a^2 + b^2 + c^2`, `C = 2 a c`. Its mean over azimuth is a complete elliptic integral
//! (Gradshteyn & Ryzhik, 2.575); higher orders follow from it by the three-term recurrence of
//! Legendre functions of half-integer degree, run backwards (Miller; Gautschi, SIAM Rev. 9, 24
//! (1967)).

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;

use super::super::quadrature::{MULTIPLE_POLES, Node, Point, Pole, graded};

/// Fourier orders 0, 1, ... of the lobe between radii `a` and `c`: the density is
/// `sum over all m of orders[|m|] exp(i m phi)`.
pub(super) fn orders(lobe: Lobe, a: f64, c: f64, orders: &mut [f64]) {
    let count = orders.len();
    match lobe {
        Lobe::KCorrelation { width } => side_by_side(width, a, [c], count, |m, [order]| orders[m] = order),
        Lobe::Lambertian => {
            orders.fill(0.0);
            orders[0] = if a <= 1.0 && c <= 1.0 { 1.0 / PI } else { 0.0 };
        }
    }
}

/// Radii that are worked on side by side.
const LANES: usize = 8;

/// The first `count` orders between radius `a` and each of the nodes: `each` gets an order, the first
/// node's number and the orders of that and the following nodes.
pub(super) fn orders_of_nodes(
    lobe: Lobe,
    a: f64,
    nodes: &[Node],
    count: usize,
    mut each: impl FnMut(usize, usize, &[f64]),
) {
    for (number, nodes) in nodes.chunks(LANES).enumerate() {
        let first = number * LANES;
        let radii: [f64; LANES] = std::array::from_fn(|k| nodes[k.min(nodes.len() - 1)].x);
        match lobe {
            Lobe::KCorrelation { width } => {
                side_by_side(width, a, radii, count, |m, orders| each(m, first, &orders[..nodes.len()]));
            }
            Lobe::Lambertian => {
                let orders = radii.map(|c| if a <= 1.0 && c <= 1.0 { 1.0 / PI } else { 0.0 });
                each(0, first, &orders[..nodes.len()]);
            }
        }
    }
}

/// Orders 0, 1, ... of several radii at once: divisions overlap.
fn side_by_side<const N: usize>(
    width: f64,
    a: f64,
    c: [f64; N],
    count: usize,
    mut each: impl FnMut(usize, [f64; N]),
) {
    let near = c.map(|c| width * width + (a - c).powi(2));
    let far = c.map(|c| width * width + (a + c).powi(2));
    let squares: [f64; N] = std::array::from_fn(|k| near[k] / far[k]);
    let integrals = second_kind(squares);
    let mut order: [f64; N] =
        std::array::from_fn(|k| width * integrals[k] / (PI * PI * near[k] * far[k].sqrt()));
    each(0, order);
    if count == 1 {
        return;
    }
    let chi: [f64; N] = std::array::from_fn(|k| 0.5 * (near[k] + far[k]) / (2.0 * a * c[k]).max(TINY));
    // Ratios of successive orders tend to this.
    let decay = chi.map(|chi| 1.0 / (chi + (chi * chi - 1.0).max(0.0).sqrt()));
    let slowest = decay.into_iter().fold(0.0, f64::max);
    // The first guess of the ratio is forgotten within some multiples of this many orders.
    let most = count + 8 + (-3.0 / slowest.ln()).min(100.0) as usize;
    let mut ratio = decay.map(|decay| decay * (1.0 + 0.5 / most as f64));
    let mut ratios = vec![[0.0; N]; count];
    for m in (1..most).rev() {
        let m_ = m as f64;
        for k in 0..N {
            ratio[k] = (m_ + 0.5) / (2.0 * chi[k] * m_ - (m_ - 0.5) * ratio[k]);
        }
        if m < count {
            ratios[m] = ratio;
        }
    }
    for (m, ratio) in ratios.iter().enumerate().skip(1) {
        order.iter_mut().zip(ratio).for_each(|(order, ratio)| *order *= ratio);
        each(m, order);
    }
}

/// Around the centre lobes are even.
const TINY: f64 = 1e-100;

/// The lobe's integral over azimuth.
pub(super) fn ring(lobe: Lobe, a: f64, c: f64) -> f64 {
    let mut order = [0.0];
    orders(lobe, a, c, &mut order);
    2.0 * PI * order[0]
}

/// The complete elliptic integrals of the second kind, from `k'^2 = 1 - k^2` above 0 (by the
/// arithmetic-geometric mean; Abramowitz & Stegun, 17.6).
fn second_kind<const N: usize>(k_prime_squared: [f64; N]) -> [f64; N] {
    let (mut a, mut b) = ([1.0; N], k_prime_squared.map(f64::sqrt));
    let (mut sum, mut power) = (k_prime_squared.map(|k| 0.5 * (1.0 - k)), 0.5);
    while (0..N).any(|k| a[k] - b[k] > 1e-9 * a[k]) {
        power *= 2.0;
        for k in 0..N {
            let c = 0.5 * (a[k] - b[k]);
            (a[k], b[k]) = (0.5 * (a[k] + b[k]), (a[k] * b[k]).sqrt());
            sum[k] += power * c * c;
        }
    }
    std::array::from_fn(|k| PI / (a[k] + b[k]) * (1.0 - sum[k]))
}

/// Where a lobe around radius `centre` is singular, as a function of the other radius.
pub(super) fn poles(lobe: Lobe, centre: f64, poles: &mut Vec<Pole>) {
    if let Lobe::KCorrelation { width } = lobe {
        for at in [centre, -centre] {
            let near = |pole: &Pole| (pole.at - at).abs() < 0.25 * width;
            if !poles.iter().any(near) {
                poles.push(Pole { at, off: width });
            }
        }
    }
}

/// From this many points on, panels around the lobes do with fewer.
const MOST_EVEN_POINTS: f64 = 300.0;

/// The integral over azimuth, at this radius, of the product of two sums of lobes.
pub(super) fn ring_of_products(lobe: Lobe, radius: f64, one: &[Point], other: &[Point], digits: f64) -> f64 {
    let Lobe::KCorrelation { width } = lobe else {
        let weight = |points: &[Point]| points.iter().map(|point| point.weight).sum::<f64>();
        return if radius <= 1.0 { 2.0 / PI * weight(one) * weight(other) } else { 0.0 };
    };
    // A lobe's poles in azimuth lie at its own azimuth, so far off the real line as this says.
    let excess = |point: &Point| {
        let r = point.beta.length();
        ((radius - r).powi(2) + width * width) / (2.0 * radius * r).max(1e-300)
    };
    let off = |excess: f64| 2.0 * (0.5 * excess).sqrt().asinh();
    let least = |points: &[Point]| points.iter().map(excess).fold(f64::INFINITY, f64::min);
    let count = ((digits + MULTIPLE_POLES) / off(least(one).min(least(other)))).ceil() + 2.0;
    let scale = (width / (2.0 * PI)).powi(2);
    if count <= MOST_EVEN_POINTS {
        return scale * even_sum(width, radius, count as usize, one, other);
    }
    let azimuth = |point: &Point| point.beta.y.atan2(point.beta.x);
    let mut poles: Vec<Pole> = Vec::new();
    for point in one.iter().chain(other) {
        for turn in [-2.0 * PI, 0.0, 2.0 * PI] {
            let pole = Pole { at: azimuth(point) + turn, off: off(excess(point)) };
            let sharper = |p: &Pole| p.off <= pole.off && (p.at - pole.at).abs() < 0.25 * p.off;
            if !poles.iter().any(sharper) {
                poles.push(pole);
            }
        }
    }
    let value = |node: &Node| {
        let (sin, cos) = node.x.sin_cos();
        let (x, y) = (radius * cos, radius * sin);
        node.weight * lobes(width, x, y, one) * lobes(width, x, y, other)
    };
    scale * graded(-PI, PI, &[], &poles, digits).iter().map(value).sum::<f64>()
}

/// The integral by so many even steps; some are made side by side.
fn even_sum(width: f64, radius: f64, count: usize, one: &[Point], other: &[Point]) -> f64 {
    let step = 2.0 * PI / count as f64;
    let (sin, cos) = step.sin_cos();
    let (mut x, mut y) = ([radius; LANES], [0.0; LANES]);
    for k in 1..LANES {
        (x[k], y[k]) = (x[k - 1] * cos - y[k - 1] * sin, x[k - 1] * sin + y[k - 1] * cos);
    }
    let (sin, cos) = (LANES as f64 * step).sin_cos();
    let mut sum = [0.0; LANES];
    for first in (0..count).step_by(LANES) {
        let (one, other) = (several(width, &x, &y, one), several(width, &x, &y, other));
        for k in 0..LANES {
            sum[k] += if first + k < count { one[k] * other[k] } else { 0.0 };
            (x[k], y[k]) = (x[k] * cos - y[k] * sin, x[k] * sin + y[k] * cos);
        }
    }
    step * sum.iter().sum::<f64>()
}

/// [`lobes`] at several points.
#[inline]
fn several(width: f64, x: &[f64; LANES], y: &[f64; LANES], points: &[Point]) -> [f64; LANES] {
    let mut sum = [0.0; LANES];
    for point in points {
        for k in 0..LANES {
            let s = width * width + (x[k] - point.beta.x).powi(2) + (y[k] - point.beta.y).powi(2);
            sum[k] += point.weight / (s * s.sqrt());
        }
    }
    sum
}

/// The weighted sum of lobes at a point, but for the factor `b / (2 pi)`.
#[inline]
fn lobes(width: f64, x: f64, y: f64, points: &[Point]) -> f64 {
    let mut sum = 0.0;
    for point in points {
        let s = width * width + (x - point.beta.x).powi(2) + (y - point.beta.y).powi(2);
        sum += point.weight / (s * s.sqrt());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::Beta;

    /// Orders against the trapezoid rule, which converges exponentially.
    #[test]
    fn orders_are_the_lobes_fourier_coefficients() {
        for (width, a, c) in [(0.05, 0.3, 0.35), (0.05, 0.9, 0.1), (0.4, 1.2, 1.0), (0.02, 0.5, 0.5)] {
            let lobe = Lobe::KCorrelation { width };
            let mut found = vec![0.0; 30];
            orders(lobe, a, c, &mut found);
            let (steps, first) = (4000, found[0]);
            for (m, found) in found.iter().enumerate() {
                let term = |k: i32| {
                    let phi = 2.0 * PI * f64::from(k) / f64::from(steps);
                    let to = Beta { x: c * phi.cos(), y: c * phi.sin() };
                    lobe.density(Beta { x: a, y: 0.0 }, to) * (m as f64 * phi).cos()
                };
                let truth = (0..steps).map(term).sum::<f64>() / f64::from(steps);
                // What the recurrence starts with shows in the last orders alone.
                let within = 1e-5 * first + 1e-12;
                assert!((found - truth).abs() < within, "{width} {a} {c} {m}: {found} {truth}");
            }
            assert!((ring(lobe, a, c) - 2.0 * PI * found[0]).abs() < 1e-12);
        }
    }

    /// Both ways of summing over azimuth agree, for lobes down to a width of 1e-4.
    #[test]
    fn products_of_narrow_lobes() {
        let point = |x, y| vec![Point { beta: Beta { x, y }, weight: 1.0 }];
        let (one, other) = (point(0.3, 0.02), point(-0.1, 0.29));
        for width in [1e-4, 3e-3, 0.05] {
            let lobe = Lobe::KCorrelation { width };
            let found = ring_of_products(lobe, 0.3, &one, &other, 23.0);
            let steps = 400_000;
            let term = |k: i32| {
                let phi = 2.0 * PI * f64::from(k) / f64::from(steps);
                let at = Beta { x: 0.3 * phi.cos(), y: 0.3 * phi.sin() };
                lobe.density(one[0].beta, at) * lobe.density(other[0].beta, at)
            };
            let truth = (0..steps).map(term).sum::<f64>() * 2.0 * PI / f64::from(steps);
            assert!((found / truth - 1.0).abs() < 1e-8, "{width}: {found} {truth}");
        }
    }
}
