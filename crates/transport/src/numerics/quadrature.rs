//! Quadrature for integrands with known singularities.
//!
//! The error of a Gauss-Legendre rule of p points is `rho^(-2p)`, with rho the size of the largest ellipse
//! around the interval (foci at its ends, rho the sum of its half-axes) that contains no singularity
//! (Trefethen, *Approximation Theory and Approximation Practice*, theorem 19.3). Lobes are rational
//! functions: their poles are known. An interval is therefore divided until no pole is near any panel, and
//! each panel gets the number of points that its nearest pole requires.
//!
//! All `digits` are natural: the requested error is `exp(-digits)`.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::LazyLock;

use papilio_optics::quadrature;

/// A node of a rule and its weight.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Node {
    pub(crate) x: f64,
    pub(crate) weight: f64,
}

/// Largest number of points of one panel.
pub(crate) const MOST_POINTS: usize = 40;

static RULES: LazyLock<Vec<Vec<Node>>> = LazyLock::new(|| (0..=MOST_POINTS).map(legendre).collect());

/// Step of Newton's method after which a node is known to rounding.
const LAST_STEP: f64 = 1e-14;

/// Returns the Gauss-Legendre rule of this many points on (-1, 1).
pub(crate) fn legendre(points: usize) -> Vec<Node> {
    quadrature::legendre(points, LAST_STEP).into_iter().map(|(x, weight)| Node { x, weight }).collect()
}

/// Returns the Gauss-Legendre rule on an interval.
pub(crate) fn gauss(from: f64, to: f64, points: usize) -> impl Iterator<Item = Node> {
    let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
    RULES[points.clamp(1, MOST_POINTS)]
        .iter()
        .map(move |node| Node { x: middle + half * node.x, weight: half * node.weight })
}

/// A pair of singularities of the integrand at `at +- i off`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Pole {
    pub(crate) at: f64,
    pub(crate) off: f64,
}

impl Pole {
    /// Converts the pole of a function of `beta` to one in `x` of `beta = radius sin x`.
    pub(crate) fn in_arc(self, radius: f64) -> Self {
        let (re, im) = (self.at / radius, self.off / radius);
        let (right, left) = ((re + 1.0).hypot(im), (re - 1.0).hypot(im));
        let (sum, difference) = (0.5 * (right + left), 0.5 * (right - left));
        Self { at: difference.clamp(-1.0, 1.0).asin(), off: sum.max(1.0).acosh() }
    }

    /// Returns the size of the ellipse around the interval on which this pole lies.
    pub(crate) fn ellipse(self, from: f64, to: f64) -> f64 {
        let axis = self.half_axis(from, to);
        axis + (axis * axis - 1.0).sqrt()
    }

    /// Returns the larger half-axis of the ellipse around the interval (scaled to -1 to 1) on which this
    /// pole lies.
    fn half_axis(self, from: f64, to: f64) -> f64 {
        let (middle, half) = (0.5 * (from + to), 0.5 * (to - from));
        let (re, im) = ((self.at - middle) / half, self.off / half);
        let distance = |end: f64| ((re - end) * (re - end) + im * im).sqrt();
        (0.5 * (distance(-1.0) + distance(1.0))).max(1.0)
    }
}

/// Panels are divided until their ellipses are at least this large ...
const SMALLEST_ELLIPSE: f64 = 2.3;
/// ... or they are this fraction of the whole interval (singularities on the interval itself).
const SMALLEST_PANEL: f64 = 1e-8;

/// Returns a rule on an interval for an integrand with these poles that is smooth between `breaks`.
pub(crate) fn graded(from: f64, to: f64, breaks: &[f64], poles: &[Pole], digits: f64) -> Vec<Node> {
    graded_with(from, to, (breaks, poles), digits, 0)
}

/// Returns the same rule with so many points more, or fewer, in each panel.
fn graded_with(
    from: f64,
    to: f64,
    (breaks, poles): (&[f64], &[Pole]),
    digits: f64,
    more: isize,
) -> Vec<Node> {
    let mut nodes = Vec::new();
    panels(from, to, breaks, poles, &mut |from, to, ellipse: f64| {
        let points = points_for(digits + MULTIPLE_POLES, 2.0 * ellipse.ln());
        nodes.extend(gauss(from, to, points.saturating_add_signed(more)));
    });
    nodes
}

/// Computes the panels of such a rule: `each` receives both ends and the size of the ellipse in which there
/// is no pole.
pub(crate) fn panels(
    from: f64,
    to: f64,
    breaks: &[f64],
    poles: &[Pole],
    each: &mut impl FnMut(f64, f64, f64),
) {
    let mut edges = vec![from, to];
    edges.extend(breaks.iter().copied().filter(|x| (from..to).contains(x)));
    edges.sort_by(f64::total_cmp);
    let least = SMALLEST_PANEL * (to - from);
    for pair in edges.windows(2).filter(|pair| pair[1] > pair[0]) {
        cut(pair[0], pair[1], poles, least, each);
    }
}

fn cut(from: f64, to: f64, poles: &[Pole], least: f64, each: &mut impl FnMut(f64, f64, f64)) {
    let mut nearest = (Pole { at: 0.0, off: 0.0 }, f64::INFINITY);
    for pole in poles {
        let axis = pole.half_axis(from, to);
        if axis < nearest.1 {
            nearest = (*pole, axis);
        }
    }
    let (pole, axis) = nearest;
    // The sum of half-axes.
    let ellipse = axis + (axis * axis - 1.0).sqrt();
    let inside = (pole.at - from) / (to - from);
    let at = if (0.2..0.8).contains(&inside) { pole.at } else { 0.5 * (from + to) };
    // Between neighbouring numbers there is none.
    if ellipse < SMALLEST_ELLIPSE && to - from > least && from < at && at < to {
        cut(from, at, poles, least, each);
        cut(at, to, poles, least, each);
    } else {
        // Where no pole is near, integrands are still not polynomials of low degree.
        each(from, to, ellipse.clamp(SMALLEST_ELLIPSE, LARGEST_ELLIPSE));
    }
}

/// Additional natural digits for multiple poles: products of lobes have threefold ones.
pub(crate) const MULTIPLE_POLES: f64 = 3.0;

/// Largest ellipse assumed for a panel: besides the poles there are functions that are tabulated over
/// direction.
const LARGEST_ELLIPSE: f64 = 6.0;

/// Returns the number of points for this many digits at `each` digits per point.
pub(crate) fn points_for(digits: f64, each: f64) -> usize {
    (digits / each).ceil().clamp(1.0, MOST_POINTS as f64) as usize
}

/// Returns a rule over the radius of the disc `|beta| <= radius` in `beta = radius sin x`, which resolves
/// square roots that end on its rim: nodes are |beta|, weights contain `2 pi |beta| d|beta|`.
pub(crate) fn radial(radius: f64, breaks: &[f64], poles: &[Pole], digits: f64) -> Vec<Node> {
    radial_with(radius, (breaks, poles), digits, 0)
}

/// Returns the same rule with so many points more, or fewer, in each panel.
pub(crate) fn radial_with(
    radius: f64,
    (breaks, poles): (&[f64], &[Pole]),
    digits: f64,
    more: isize,
) -> Vec<Node> {
    let inside = breaks.iter().filter(|b| **b < radius);
    let breaks: Vec<f64> = inside.map(|b| (b / radius).asin()).collect();
    let poles: Vec<Pole> = poles.iter().map(|pole| pole.in_arc(radius)).collect();
    let mut nodes = graded_with(0.0, FRAC_PI_2, (&breaks, &poles), digits, more);
    for node in &mut nodes {
        let (sin, cos) = node.x.sin_cos();
        node.x = radius * sin;
        node.weight *= 2.0 * PI * node.x * radius * cos;
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rule_of_p_points_integrates_degree_2p_minus_1() {
        for points in [1, 2, 5, 16, 40] {
            let degree = 2 * points as i32 - 2;
            let sum: f64 = gauss(-1.0, 1.0, points).map(|n| n.weight * n.x.powi(degree)).sum();
            assert!((sum - 2.0 / f64::from(degree + 1)).abs() < 1e-13, "{points}: {sum}");
        }
    }

    /// The lobe's own integral along a line, over six decades of width.
    #[test]
    fn graded_rule_has_requested_error() {
        for width in [1e-6, 1e-3, 0.05, 3.0] {
            for digits in [12.0, 18.0, 28.0] {
                let nodes = graded(0.0, 1.5, &[], &[Pole { at: 0.4, off: width }], digits);
                let f = |x: f64| width * width / (width * width + (x - 0.4).powi(2)).powf(1.5);
                let antiderivative = |x: f64| (x - 0.4) / (width * width + (x - 0.4).powi(2)).sqrt();
                let sum: f64 = nodes.iter().map(|n| n.weight * f(n.x)).sum();
                let truth = antiderivative(1.5) - antiderivative(0.0);
                // Positions near 0.4 are rounded to 1e-16, which is much for a narrow lobe.
                let allowed = 20.0 * (-digits).exp() + 1e-13 + 1e-15 / width;
                assert!((sum / truth - 1.0).abs() < allowed, "{width} {digits}");
            }
        }
    }

    /// Borders of strips and rings may be as close as numbers are.
    #[test]
    fn interval_between_neighbouring_numbers_has_one_panel() {
        let (from, to) = (1.0, 1.0 + f64::EPSILON);
        let nodes = graded(from, to, &[], &[Pole { at: 1.0, off: 1e-12 }], 12.0);
        let sum: f64 = nodes.iter().map(|node| node.weight).sum();
        assert!((sum / f64::EPSILON - 1.0).abs() < 1e-6, "{sum}");
    }

    #[test]
    fn square_root_on_rim_is_resolved() {
        let nodes = radial(1.5, &[], &[], 28.0);
        let sum: f64 = nodes.iter().map(|n| n.weight * (1.0 - n.x * n.x / 2.25).sqrt()).sum();
        assert!((sum - 2.25 * PI * 2.0 / 3.0).abs() < 1e-11, "{sum}");
    }
}
