//! What views at one inclination see of a source, by azimuthal order: a view's azimuth is a factor of each.

use std::borrow::Cow;
use std::sync::Arc;

use papilio_optics::with_widest_simd;

use super::super::add_scaled;
use super::super::first_pass::{Pass, Weights, merged_radii};
use super::super::projected::{Circle, Projected};
use super::super::recycling::{Forms, Group, Recycling, azimuth_factor};
use super::{Bundle, Light};
use crate::Source;

/// Number of views at one inclination from which on their light is computed by azimuthal orders, whatever the
/// source.
const MANY_VIEWS: usize = 16;

/// A group of points of a view and a group of a source.
#[derive(Debug, Clone)]
pub(super) struct ByOrder {
    /// Weights of the first pass on the nodes of the table, `[order][node]`.
    weights: Vec<f64>,
    /// Forms of recycled light, by order.
    forms: Vec<Forms>,
    /// Azimuth of the light; `None` if all orders are summed for the azimuth of the only view.
    azimuth: Option<f64>,
    odd: bool,
    /// Number of nodes of the rule.
    nodes: usize,
}

/// A group of points of a view, and its recycled light.
pub(super) struct OfView<'a> {
    pub(super) bundle: &'a Bundle,
    pub(super) recycled: Option<(&'a Recycling, &'a Group)>,
}

/// Returns, for each group of a view, one for each group of a field; of another source only if many views are
/// at this inclination, and none if light may pass unscattered: that of one lobe needs twice as many orders as
/// a product of two. `project` projects a group of a field that is not stored.
pub(super) fn of(
    (pass, index): (&Pass<'_>, usize),
    views: &[OfView<'_>],
    light: &Light,
    project: impl Fn(&Bundle) -> Projected,
    at_inclination: usize,
) -> Vec<Vec<Arc<ByOrder>>> {
    let mut all = vec![Vec::new(); views.len()];
    let is_field = matches!(light.source, Source::Field(_));
    if !is_field && (at_inclination < MANY_VIEWS || pass.straight() > 0.0) {
        return all;
    }
    for (number, bundle) in light.groups.iter().enumerate() {
        let of_field: Option<Cow<'_, Projected>> = match light.projected.get(index) {
            Some(stored) => Some(Cow::Borrowed(&stored[number])),
            None => is_field.then(|| Cow::Owned(project(bundle))),
        };
        for (view, all) in views.iter().zip(&mut all) {
            let projected = match &of_field {
                Some(projected) => Cow::Borrowed(&**projected),
                None => Cow::Owned(for_view(pass, view.bundle, bundle)),
            };
            let forms = |(recycling, own): (&Recycling, &Group)| {
                recycling.between_by_order(own, &light.recycled[index][number])
            };
            let azimuth = view.bundle.azimuth();
            let by_order = ByOrder {
                weights: pass.by_order(&view.bundle.points, azimuth, &projected),
                forms: view.recycled.map(forms).unwrap_or_default(),
                azimuth: Some(bundle.azimuth()),
                odd: bundle.odd,
                nodes: projected.nodes(),
            };
            all.push(Arc::new(if at_inclination > 1 { by_order } else { by_order.at(azimuth, pass) }));
        }
    }
    all
}

/// Projects a group of a source of points for one group of a view.
fn for_view(pass: &Pass<'_>, view: &Bundle, light: &Bundle) -> Projected {
    let radii = [&light.points, &view.points].map(|points| merged_radii(points).into_iter().map(|r| r.0));
    let [lit, views] = radii.map(|radii| radii.collect::<Vec<f64>>());
    pass.project(&lit, &views, |count| Circle::of_points(&light.points, light.azimuth(), count))
}

impl ByOrder {
    /// Sums all orders for a view at this azimuth: a fraction of the memory.
    fn at(self, azimuth: f64, pass: &Pass<'_>) -> Self {
        let (Weights(weights), nodes) = self.weights_at(azimuth, pass);
        let forms = if self.forms.is_empty() { Vec::new() } else { vec![self.forms_at(azimuth)] };
        Self { weights, forms, azimuth: None, odd: self.odd, nodes }
    }

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
        self.azimuth.map_or(1.0, |of_light| azimuth_factor(order, of_light - azimuth, self.odd))
    }
}
