//! What views at one inclination see of a field, by azimuthal order: a view's azimuth is a factor of each.

use std::sync::Arc;

use papilio_optics::with_widest_simd;

use super::super::add_scaled;
use super::super::first_pass::{Pass, Weights};
use super::super::projected::Projected;
use super::super::recycling::{Forms, Group, Recycling, azimuth_factor};
use super::{Bundle, Light};

/// A group of points of a view and a group of a field.
#[derive(Debug, Clone)]
pub(super) struct ByOrder {
    /// Weights of the first pass on the nodes of the table, `[order][node]`.
    weights: Vec<f64>,
    /// Forms of recycled light, by order.
    forms: Vec<Forms>,
    odd: bool,
    /// Number of nodes of the rule.
    nodes: usize,
}

/// Returns one for each group of a field; none for other sources.
pub(super) fn of(
    (pass, index): (&Pass<'_>, usize),
    view: &Bundle,
    recycled: Option<(&Recycling, &Group)>,
    light: &Light,
) -> Vec<Arc<ByOrder>> {
    let Some(projected) = light.projected.get(index) else { return Vec::new() };
    let one = |(number, projected): (usize, &Projected)| {
        let forms = |(recycling, own): (&Recycling, &Group)| {
            recycling.between_by_order(own, &light.recycled[index][number])
        };
        Arc::new(ByOrder {
            weights: pass.by_order(&view.points, view.azimuth(), projected),
            forms: recycled.map(forms).unwrap_or_default(),
            odd: light.groups[number].odd,
            nodes: projected.nodes(),
        })
    };
    projected.iter().enumerate().map(one).collect()
}

impl ByOrder {
    /// Returns the weights of a view at this azimuth, and the number of nodes used.
    pub(super) fn weights_at(&self, azimuth: f64, pass: &Pass<'_>) -> (Weights, usize) {
        let mut sum = vec![0.0; pass.table.count()];
        with_widest_simd(
            #[inline(always)]
            || {
                for (m, order) in self.weights.chunks_exact(sum.len()).enumerate() {
                    add_scaled(&mut sum, order, self.factor(m, azimuth));
                }
            },
        );
        (Weights(sum), self.nodes)
    }

    /// Returns the forms of a view at this azimuth.
    pub(super) fn forms_at(&self, azimuth: f64) -> Forms {
        Forms::sum(&self.forms, |m| self.factor(m, azimuth))
    }

    fn factor(&self, order: usize, azimuth: f64) -> f64 {
        azimuth_factor(order, -azimuth, self.odd)
    }
}
