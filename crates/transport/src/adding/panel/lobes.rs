//! Fourier orders of lobes over azimuth.
//!
//! At radii a and c a k-correlation lobe is `b/(2 pi) (A - C cos phi)^(-3/2)` with `A = a^2 + b^2 + c^2`,
//! `C = 2 a c`. Its mean over azimuth is a complete elliptic integral (Gradshteyn & Ryzhik, 2.575). Higher
//! orders follow from it by the three-term recurrence of Legendre functions of half-integer degree, run
//! backwards (Miller; Gautschi, SIAM Rev. 9, 24 (1967)).

use std::f64::consts::PI;

use papilio_optics::lobe::Lobe;
use papilio_optics::with_widest_simd;

use crate::numerics::quadrature::{Node, Pole};

/// Number of radii that are computed together.
pub(in crate::adding) const LANES: usize = 8;

/// Returns the radii of these nodes, padded with the last of them.
#[inline(always)]
pub(super) fn radii_of(nodes: &[Node]) -> [f64; LANES] {
    std::array::from_fn(|k| nodes[k.min(nodes.len() - 1)].x)
}

/// Computes the first `count` Fourier orders 0, 1, ... of the lobe between radius `a` and each of the nodes:
/// its density there is `sum over all m of orders[|m|] exp(i m phi)`. `each` receives an order, the number
/// of the first node and the orders of that and the following nodes.
pub(in crate::adding) fn orders_of_nodes(
    lobe: Lobe,
    a: f64,
    nodes: &[Node],
    count: usize,
    mut each: impl FnMut(usize, usize, &[f64]),
) {
    let mut ratios = Vec::new();
    with_widest_simd(
        #[inline(always)]
        || {
            for (number, nodes) in nodes.chunks(LANES).enumerate() {
                let first = number * LANES;
                let radii = radii_of(nodes);
                match lobe {
                    Lobe::KCorrelation { width } => {
                        side_by_side(width, a, radii, (count, None), &mut ratios, |m, orders| {
                            each(m, first, &orders[..nodes.len()])
                        });
                    }
                    Lobe::Lambertian => {
                        let orders = radii.map(|c| if a <= 1.0 && c <= 1.0 { 1.0 / PI } else { 0.0 });
                        each(0, first, &orders[..nodes.len()]);
                    }
                }
            }
        },
    );
}

/// Computes orders 0, 1, ... up to `count` of several radii at once, so that divisions overlap. The
/// recurrence begins at the given order, or as late as the first orders need. `ratios` is a workspace.
/// Always inlined, so that it is compiled for the instruction set of its caller.
#[inline(always)]
pub(in crate::adding) fn side_by_side(
    width: f64,
    a: f64,
    c: [f64; LANES],
    (count, from): (usize, Option<usize>),
    ratios: &mut Vec<[f64; LANES]>,
    mut each: impl FnMut(usize, [f64; LANES]),
) {
    let near = c.map(|c| width * width + (a - c).powi(2));
    let far = c.map(|c| width * width + (a + c).powi(2));
    let squares: [f64; LANES] = std::array::from_fn(|k| near[k] / far[k]);
    let integrals = second_kind(squares);
    let mut order: [f64; LANES] =
        std::array::from_fn(|k| width * integrals[k] / (PI * PI * near[k] * far[k].sqrt()));
    each(0, order);
    if count == 1 {
        return;
    }
    let chi: [f64; LANES] = std::array::from_fn(|k| 0.5 * (near[k] + far[k]) / (2.0 * a * c[k]).max(TINY));
    // Limit of the ratio of successive orders.
    let decay = chi.map(|chi| 1.0 / (chi + (chi * chi - 1.0).max(0.0).sqrt()));
    let slowest = decay.into_iter().fold(0.0, f64::max);
    // The error of the first ratio becomes negligible within a few multiples of this number of orders.
    let most = from.unwrap_or_else(|| count + 8 + (-3.0 / slowest.ln()).min(100.0) as usize);
    let mut ratio = decay.map(|decay| decay * (1.0 + 0.5 / most as f64));
    ratios.resize(count.max(ratios.len()), [0.0; LANES]);
    for m in (1..most).rev() {
        let m_ = m as f64;
        for k in 0..LANES {
            ratio[k] = (m_ + 0.5) / (2.0 * chi[k] * m_ - (m_ - 0.5) * ratio[k]);
        }
        if m < count {
            ratios[m] = ratio;
        }
    }
    for (m, ratio) in ratios.iter().enumerate().take(count).skip(1) {
        order.iter_mut().zip(ratio).for_each(|(order, ratio)| *order *= ratio);
        each(m, order);
    }
}

/// Around the centre lobes do not depend on azimuth.
const TINY: f64 = 1e-100;

/// Returns the mean over azimuth of a weighted sum of lobes around these radii, at the nodes.
pub(super) fn means(lobe: Lobe, weighted_radii: &[(f64, f64)], nodes: &[Node]) -> Vec<f64> {
    let mut sum = vec![0.0; nodes.len()];
    for (radius, weight) in weighted_radii {
        orders_of_nodes(lobe, *radius, nodes, 1, |_, first, values| {
            sum[first..].iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
        });
    }
    sum
}

/// Returns complete elliptic integrals of the second kind, from `k'^2 = 1 - k^2` above 0 (by the
/// arithmetic-geometric mean; Abramowitz & Stegun, 17.6).
#[inline(always)]
fn second_kind(k_prime_squared: [f64; LANES]) -> [f64; LANES] {
    let (mut a, mut b) = ([1.0; LANES], k_prime_squared.map(f64::sqrt));
    let (mut sum, mut power) = (k_prime_squared.map(|k| 0.5 * (1.0 - k)), 0.5);
    while (0..LANES).any(|k| a[k] - b[k] > 1e-9 * a[k]) {
        power *= 2.0;
        for k in 0..LANES {
            let c = 0.5 * (a[k] - b[k]);
            (a[k], b[k]) = (0.5 * (a[k] + b[k]), (a[k] * b[k]).sqrt());
            sum[k] += power * c * c;
        }
    }
    std::array::from_fn(|k| PI / (a[k] + b[k]) * (1.0 - sum[k]))
}

/// Adds the singularities of a lobe around radius `centre`, as a function of the other radius.
pub(in crate::adding) fn poles(lobe: Lobe, centre: f64, poles: &mut Vec<Pole>) {
    if let Lobe::KCorrelation { width } = lobe {
        for at in [centre, -centre] {
            let near = |pole: &Pole| (pole.at - at).abs() < 0.25 * width;
            if !poles.iter().any(near) {
                poles.push(Pole { at, off: width });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use papilio_optics::{Beta, Scatterer};

    /// Orders are compared with the trapezoid rule, which converges exponentially.
    #[test]
    fn orders_equal_fourier_coefficients_of_lobe() {
        for (width, a, c) in [(0.05, 0.3, 0.35), (0.05, 0.9, 0.1), (0.4, 1.2, 1.0), (0.02, 0.5, 0.5)] {
            let lobe = Lobe::KCorrelation { width };
            let (mut found, node) = (vec![0.0; 30], [Node { x: c, weight: 1.0 }]);
            orders_of_nodes(lobe, a, &node, 30, |m, _, values| found[m] = values[0]);
            let (steps, first) = (4000, found[0]);
            for (m, found) in found.iter().enumerate() {
                let term = |k: i32| {
                    let phi = 2.0 * PI * f64::from(k) / f64::from(steps);
                    let to = Beta { x: c * phi.cos(), y: c * phi.sin() };
                    lobe.density(Beta { x: a, y: 0.0 }, to) * (m as f64 * phi).cos()
                };
                let truth = (0..steps).map(term).sum::<f64>() / f64::from(steps);
                // The start of the recurrence affects only the last orders.
                let within = 1e-5 * first + 1e-12;
                assert!((found - truth).abs() < within, "{width} {a} {c} {m}: {found} {truth}");
            }
            assert!((means(lobe, &[(a, 2.0)], &node)[0] - 2.0 * found[0]).abs() < 1e-12);
        }
    }
}
