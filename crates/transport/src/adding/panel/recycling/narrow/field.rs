//! Two or three passes between a view and a field, under a narrow lobe.
//!
//! Such light is a lobe, the closed form, and a smooth difference ([`Passes::differences`]). Over azimuth all three
//! are sums of few or many cosines: the orders of the product of a lobe and `cos n phi` are means of those of the
//! lobe, at distance n on both sides.

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::azimuth_factor;
use super::passes::{Passes, add_closed};
use crate::adding::panel::lobes;
use crate::adding::panel::projected::Circle;
use crate::adding::quadrature::{Node, Point};

/// Differences of passes from their closed form between all directions.
#[derive(Debug, Clone)]
pub(super) struct OfFields {
    /// `[|l|][|v|][n][sequence of terms]` with n of `cos n phi`.
    differences: Vec<f64>,
}

impl OfFields {
    pub(super) fn new(passes: &Passes) -> Self {
        let (turns, row) = (passes.turns.len(), passes.sequences(passes.count));
        // Values at Chebyshev points are a sum of cosines.
        let cosine = |n: usize, turn: usize| {
            let scale = if n == 0 { 1.0 } else { 2.0 };
            scale / turns as f64 * (PI * n as f64 * (turn as f64 + 0.5) / turns as f64).cos()
        };
        let mut differences = Vec::new();
        for radius in &passes.rings.radii {
            let end = passes.once.end(Beta { x: *radius, y: 0.0 });
            for at_turns in passes.differences(&end).chunks_exact(turns * row) {
                for n in 0..turns {
                    let mut sum = vec![0.0; row];
                    for (turn, values) in at_turns.chunks_exact(row).enumerate() {
                        let factor = cosine(n, turn);
                        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
                    }
                    differences.append(&mut sum);
                }
            }
        }
        Self { differences }
    }

    /// Returns `pi` times all passes between a view and a part of a field (whether it is odd in azimuth), a
    /// coefficient for each product of terms.
    pub(super) fn between(&self, passes: &Passes, view: &[Point], light: (&[Circle], bool)) -> Vec<f64> {
        let (rings, turns) = (passes.rings.len(), passes.turns.len());
        let mut form = vec![0.0; passes.sequences(passes.count)];
        let mut terms = vec![0.0; passes.once.terms()];
        for v in view {
            let of_view = passes.once.end(v.beta);
            let mut at_view = vec![0.0; rings];
            passes.rings.add_values(v.beta.length(), 1.0, &mut at_view);
            let mut at_rings = vec![0.0; rings * turns];
            let mut at_circle = vec![0.0; rings];
            for (circle, lit) in light.0.iter().zip(lit(passes, v, light).chunks_exact(turns)) {
                at_circle.fill(0.0);
                passes.rings.add_values(circle.radius, 1.0, &mut at_circle);
                for (sums, ring) in at_rings.chunks_exact_mut(turns).zip(&at_circle) {
                    sums.iter_mut().zip(lit).for_each(|(sum, lit)| *sum += ring * lit);
                }
                passes.once.terms_at(Beta { x: circle.radius, y: 0.0 }, &mut terms);
                add_closed(passes.count, [&of_view.terms, &terms], lit[0], &mut form);
            }
            let mut rows = self.differences.chunks_exact(form.len());
            for of_light in at_rings.chunks_exact(turns) {
                for ring in &at_view {
                    for (of_light, row) in of_light.iter().zip(&mut rows) {
                        let weight = ring * of_light;
                        form.iter_mut().zip(row).for_each(|(sum, value)| *sum += weight * value);
                    }
                }
            }
        }
        passes.folded(&form)
    }
}

/// Returns `pi` times the light of each circle that reaches a point of a view by the lobe of all passes times
/// `cos n phi`: `[circle][n]`.
fn lit(passes: &Passes, view: &Point, (circles, odd): (&[Circle], bool)) -> Vec<f64> {
    let turns = passes.turns.len();
    let nodes: Vec<Node> = circles.iter().map(|circle| Node { x: circle.radius, weight: 1.0 }).collect();
    let count = circles.iter().map(|circle| circle.orders.len()).max().unwrap_or(0);
    // Orders of the lobe, `[order][circle]`.
    let mut orders = vec![0.0; (count + turns) * circles.len()];
    for (share, width) in passes.lobes(passes.count) {
        let lobe = Lobe::KCorrelation { width };
        lobes::orders_of_nodes(lobe, view.beta.length(), &nodes, count + turns, |m, first, values| {
            let row = &mut orders[m * circles.len() + first..][..values.len()];
            row.iter_mut().zip(values).for_each(|(sum, value)| *sum += share * value);
        });
    }
    let turn = -view.beta.y.atan2(view.beta.x);
    let mut lit = vec![0.0; circles.len() * turns];
    for m in 0..count {
        let factor = PI * view.weight * azimuth_factor(m, turn, odd);
        for (k, (circle, lit)) in circles.iter().zip(lit.chunks_exact_mut(turns)).enumerate() {
            let light = factor * circle.orders.get(m).copied().unwrap_or(0.0);
            for (n, lit) in lit.iter_mut().enumerate() {
                let of = |order: usize| orders[order * circles.len() + k];
                *lit += light * 0.5 * (of(m.abs_diff(n)) + of(m + n));
            }
        }
    }
    lit
}
