//! Quadrature rules for known light on a panel of cosines: the integral of the polynomial through Chebyshev
//! points.

use std::f64::consts::PI;

use super::PARTS;

/// Number of last coefficients from which the missing ones are extrapolated.
pub(super) const LAST: usize = 6;

/// Degrees up to this multiple of the number of nodes have aliases of their own.
const DEGREES: usize = 3;

/// Effects of the missing coefficients N and N + 1, N + 2 and N + 3, ... on the error; the last one is a
/// bound for all others.
pub(super) type Aliases = Vec<f64>;

/// Panel with this number of nodes, which is even; its borders are given in parts of 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Panel {
    pub(super) start: u32,
    pub(super) end: u32,
    pub(super) count: usize,
}

/// Light on the fine nodes of a panel: what rules are made for.
pub(super) struct FineLight<'a> {
    pub(super) cosines: &'a [f64],
    /// `[row][node]`.
    pub(super) rows: Vec<&'a [f64]>,
    /// Rows of light whose errors are estimated, and the sums of their weights over all panels.
    pub(super) lights: Vec<(usize, f64)>,
}

/// Quadrature rule for all rows.
#[derive(Debug)]
pub(super) struct Rule {
    pub(super) cosines: Vec<f64>,
    /// `[row][node]`.
    pub(super) weights: Vec<Vec<f64>>,
    /// Weights on the nodes that give the last coefficients of a function, `[coefficient][node]`.
    pub(super) last: [Vec<f64>; LAST],
    /// For each light, the effect of missing coefficients.
    pub(super) aliases: Vec<Aliases>,
    /// The same with the recycled light of it, which comes from all directions as well.
    pub(super) recycled: Vec<Aliases>,
}

impl Panel {
    /// Returns the cosines at which it begins and ends.
    fn borders(self) -> [f64; 2] {
        [self.start, self.end].map(|part| f64::from(part) / f64::from(PARTS))
    }
}

impl Rule {
    pub(super) fn new(panel: Panel, fine: &FineLight<'_>) -> Self {
        let (count, [start, end]) = (panel.count, panel.borders());
        let angles = (0..count).map(|node| PI - PI * (node as f64 + 0.5) / count as f64);
        let cosines = angles.clone().map(|angle| start + 0.5 * (end - start) * (1.0 + angle.cos())).collect();
        let at_nodes = polynomials(DEGREES * count, angles);
        let on_panel = |cosine: &f64| (2.0 * (cosine - start) / (end - start) - 1.0).clamp(-1.0, 1.0).acos();
        let at_fine = polynomials(DEGREES * count, fine.cosines.iter().map(on_panel));
        // A coefficient is this factor times the sum of values times polynomials.
        let scale = |degree: usize| if degree == 0 { 1.0 / count as f64 } else { 2.0 / count as f64 };
        let weights_of = |row: &[f64]| -> Vec<f64> {
            let mut weights = vec![0.0; count];
            for (degree, (at_fine, at_nodes)) in at_fine.iter().zip(&at_nodes).enumerate().take(count) {
                let moment = scale(degree) * dot(row, at_fine);
                weights.iter_mut().zip(at_nodes).for_each(|(weight, value)| *weight += moment * value);
            }
            weights
        };
        let aliases_of = |row: &[f64]| -> Aliases {
            let weights = weights_of(row);
            let error = |degree: usize| (dot(row, &at_fine[degree]) - dot(&weights, &at_nodes[degree])).abs();
            let pairs =
                (count..DEGREES * count).step_by(2).map(|degree| error(degree).max(error(degree + 1)));
            let others = row.iter().chain(&weights).map(|weight| weight.abs()).sum();
            pairs.chain([others]).collect()
        };
        let uniform = aliases_of(&by_projected_area(fine.cosines, panel));
        let aliases: Vec<Aliases> = fine.lights.iter().map(|(row, _)| aliases_of(fine.rows[*row])).collect();
        let with_uniform = |(own, (_, total)): (&Aliases, &(usize, f64))| {
            own.iter().zip(&uniform).map(|(own, uniform)| own + total.abs() * uniform).collect()
        };
        let last = |k: usize| {
            let degree = count - LAST + k;
            at_nodes[degree].iter().map(|value| scale(degree) * value).collect()
        };
        Self {
            cosines,
            weights: fine.rows.iter().map(|row| weights_of(row)).collect(),
            last: std::array::from_fn(last),
            recycled: aliases.iter().zip(&fine.lights).map(with_uniform).collect(),
            aliases,
        }
    }
}

/// Returns Chebyshev polynomials at points given by their angles, `[degree][point]`.
fn polynomials(degrees: usize, angles: impl Iterator<Item = f64> + Clone) -> Vec<Vec<f64>> {
    (0..degrees).map(|degree| angles.clone().map(|angle| (degree as f64 * angle).cos()).collect()).collect()
}

/// Returns weights of the light that a perfect diffuser sends everywhere, on the fine nodes of a panel
/// (Chebyshev points on each part, whose weights are exact to 0.2 %).
fn by_projected_area(cosines: &[f64], panel: Panel) -> Vec<f64> {
    let of_part = cosines.len() / (panel.end - panel.start) as usize;
    let weight = |(node, cosine): (usize, &f64)| {
        let angle = PI * ((node % of_part) as f64 + 0.5) / of_part as f64;
        cosine * PI * angle.sin() / (of_part as f64 * f64::from(PARTS))
    };
    cosines.iter().enumerate().map(weight).collect()
}

fn dot(one: &[f64], other: &[f64]) -> f64 {
    one.iter().zip(other).map(|(one, other)| one * other).sum()
}
