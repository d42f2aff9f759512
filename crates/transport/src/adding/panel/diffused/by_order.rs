//! What views at one inclination see of a source, by azimuthal order: a view's azimuth is a factor of each.

use std::borrow::Cow;
use std::sync::Arc;

use papilio_optics::with_widest_simd;

use super::super::add_scaled;
use super::super::first_pass::{Pass, Weights, merged_radii};
use super::super::projected::{Circle, Projected};
use super::super::recycling::{Forms, Group, Recycling, azimuth_factor};
use super::{Bundle, Light};

/// A group of points of a view and a group of a source.
#[derive(Debug, Clone)]
pub(super) struct ByOrder {
    /// Weights of the first pass on the nodes of the table, `[order][node]`.
    weights: Vec<f64>,
    /// Forms of recycled light, by order.
    forms: Vec<Forms>,
    /// Azimuth of the light.
    azimuth: f64,
    odd: bool,
    /// Number of nodes of the rule.
    nodes: usize,
}

/// Returns one for each group of a field; of another source only if `many` views are at this inclination, and
/// none if light may pass unscattered: that of one lobe needs twice as many orders as a product of two.
pub(super) fn of(
    (pass, index): (&Pass<'_>, usize),
    view: &Bundle,
    recycled: Option<(&Recycling, &Group)>,
    light: &Light,
    many: bool,
) -> Vec<Arc<ByOrder>> {
    let for_this_view = |bundle: &Bundle| {
        let radii =
            [&bundle.points, &view.points].map(|points| merged_radii(points).into_iter().map(|r| r.0));
        let [lit, views] = radii.map(|radii| radii.collect::<Vec<f64>>());
        let circles = |count| Circle::of_points(&bundle.points, bundle.azimuth(), count);
        Cow::Owned(pass.project(&lit, &views, circles))
    };
    let projected: Vec<Cow<'_, Projected>> = match light.projected.get(index) {
        Some(projected) => projected.iter().map(Cow::Borrowed).collect(),
        None if many && pass.straight() == 0.0 => light.groups.iter().map(for_this_view).collect(),
        None => Vec::new(),
    };
    let one = |(number, projected): (usize, Cow<'_, Projected>)| {
        let forms = |(recycling, own): (&Recycling, &Group)| {
            recycling.between_by_order(own, &light.recycled[index][number])
        };
        let bundle = &light.groups[number];
        Arc::new(ByOrder {
            weights: pass.by_order(&view.points, view.azimuth(), &projected),
            forms: recycled.map(forms).unwrap_or_default(),
            azimuth: bundle.azimuth(),
            odd: bundle.odd,
            nodes: projected.nodes(),
        })
    };
    projected.into_iter().enumerate().map(one).collect()
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
        azimuth_factor(order, self.azimuth - azimuth, self.odd)
    }
}
