//! Flat layers that change faster over direction than the light that meets them.
//!
//! A coating with a gap of air or a guided mode has resonances narrower than the distance of the nodes. What scattered
//! light loses and gains there is an integral of the coating's reflectance or transmittance f times that light, which
//! is smooth: the polynomial through its values at the nodes. So the value of f at node j is replaced by its mean
//! with the node's cardinal function, `f_j = integral of f l_j over the range/(weight of the node)` (product
//! integration). The sum over nodes is then exact for any f, however sharp it is. The means obey `R + T + A = 1`; close to a
//! narrow resonance some of them may be below 0 or above 1. Round trips of light that keeps its direction, between a
//! coating and a mirror, are no such sum: their layers have values at the nodes.

use std::f64::consts::PI;

use super::grid::{Grid, share_and_density, variable};
use super::splits::Between;
use crate::front::Flat;
use crate::numerics::quadrature::{gauss, legendre};

/// Points of the rule of each piece of a table.
const POINTS: usize = 16;

/// Smallest piece, in the variable of a range, -1 to 1.
const LEAST: f64 = 1e-12;

/// Returns the values of flat layers at each node: means in those ranges in which they are smooth only between
/// some `|beta|^2`, `pieces`.
pub(super) fn averaged(grid: &Grid, pieces: &[f64], flat: impl Fn(f64) -> Flat) -> Vec<Flat> {
    let mut values: Vec<Flat> = grid.beta.iter().map(|beta| flat(*beta)).collect();
    let mut first = 0;
    for range in grid.all_ranges() {
        let ends = ends_of_pieces(range, pieces);
        if ends.len() > 2 {
            let ends = resolving(ends, range.count);
            means(range, &ends, &flat, &mut values[first..first + range.count]);
        }
        first += range.count;
    }
    values
}

/// Returns the ends of the pieces in the variable of the range, ascending, from -1 to 1.
fn ends_of_pieces(range: &Between, pieces: &[f64]) -> Vec<f64> {
    let [low, high] = range.ends.map(|end| end * end);
    let within = pieces.iter().filter(|at| (low..high).contains(*at));
    let mut ends: Vec<f64> = within.map(|at| variable(range.ends, range.roots, *at)).collect();
    ends.extend([-1.0, 1.0]);
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < LEAST);
    ends
}

/// Adds ends between which the rule of a piece resolves the cardinal functions of so many nodes, which oscillate as
/// `cos(nodes * arccos x)`.
fn resolving(mut ends: Vec<f64>, nodes: usize) -> Vec<f64> {
    /// Phase of an oscillation over a piece.
    const MOST: f64 = 6.0;
    let parts = (PI * nodes as f64 / MOST).ceil() as usize;
    ends.extend((1..parts).map(|part| (PI * part as f64 / parts as f64).cos()));
    ends.sort_by(f64::total_cmp);
    ends.dedup_by(|a, b| *a - *b < LEAST);
    ends
}

/// Computes the means at the nodes of a range.
fn means(range: &Between, ends: &[f64], flat: &impl Fn(f64) -> Flat, values: &mut [Flat]) {
    let Between { ends: [a, b], roots, .. } = *range;
    let nodes = legendre(range.count);
    // Barycentric weights of the Gauss-Legendre nodes (Wang & Xiang 2012).
    let sign = |j: usize| if j.is_multiple_of(2) { 1.0 } else { -1.0 };
    let barycentric: Vec<f64> = nodes
        .iter()
        .enumerate()
        .map(|(j, node)| sign(j) * ((1.0 - node.x * node.x) * node.weight).sqrt())
        .collect();
    let mut sums = vec![[0.0; 3]; nodes.len()];
    let mut cardinal = vec![0.0; nodes.len()];
    for piece in ends.windows(2) {
        for point in gauss(piece[0], piece[1], POINTS) {
            let [share, density] = share_and_density(point.x, roots);
            let Flat { t, above, below } = flat((a * a + (b * b - a * a) * share).sqrt());
            for ((factor, node), weight) in cardinal.iter_mut().zip(&nodes).zip(&barycentric) {
                let distance = point.x - node.x;
                *factor = weight / if distance == 0.0 { f64::MIN_POSITIVE.sqrt() } else { distance };
            }
            let scale = density * point.weight / cardinal.iter().sum::<f64>();
            for (sum, factor) in sums.iter_mut().zip(&cardinal) {
                let weight = scale * factor;
                sum.iter_mut().zip([t, above, below]).for_each(|(sum, value)| *sum += weight * value);
            }
        }
    }
    for ((value, sum), node) in values.iter_mut().zip(sums).zip(&nodes) {
        let [_, density] = share_and_density(node.x, roots);
        let [t, above, below] = sum.map(|sum| sum / (density * node.weight));
        *value = Flat { t, above, below };
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::Density;
    use super::super::splits::Splits;
    use super::*;

    /// Sums over nodes of a step times polynomials of all degrees below their number, in closed form.
    #[test]
    fn means_of_a_step_have_its_moments() {
        for least in [12, 60] {
            let density = Density { least, spacing: f64::INFINITY, angle: None };
            let grid = Grid::new(&Splits::at(&[1.0]), density, &[]);
            let step = |beta: f64| Flat { t: f64::from(u8::from(beta < 0.6)), above: 0.0, below: 1.0 };
            let found = averaged(&grid, &[0.36], step);
            for power in [0, 2, 9] {
                let terms = found.iter().zip(&grid.beta).zip(&grid.scale);
                let light = |beta: f64| beta.powi(2 * power);
                let sums = terms.fold([0.0; 2], |[t, below], ((flat, beta), scale)| {
                    let weight = scale * scale * light(*beta) / PI;
                    [t + weight * flat.t, below + weight * flat.below]
                });
                let whole = 1.0 / f64::from(power + 1);
                let expected = [0.36_f64.powi(power + 1) * whole, whole];
                let error = sums.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
                // The polynomial through few nodes is not quite the light.
                let most = match (least, power) {
                    (12, 9) => 1e-3,
                    (12, _) => 1e-8,
                    _ => 1e-10,
                };
                assert!(error < most, "{least} {power}: {sums:?}");
            }
        }
    }
}
