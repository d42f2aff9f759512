//! Rays of s or of p that views see in flat layers above a mirror, where sources are polarised or a polariser is before the eye.
//!
//! Nothing scatters: a ray that a view sees has left a source in the mirrored direction, and its weight depends on both.

use crate::light::cone_points::{Nodes, Point};
use crate::polarised_view::seen_in;
use crate::specular::specular_image;
use crate::{Cone, ReflectanceFactor, Source, Stack, WholeView};

/// The rays of all views.
#[derive(Debug, Clone)]
pub(super) struct Rays(Vec<OfView>);

#[derive(Debug, Clone)]
struct OfView {
    cone: Cone,
    /// Number of nodes of the base's table across it for which its points were made.
    across: f64,
    /// By source, with the weight of the polarisation.
    points: Vec<Vec<Point>>,
}

impl Rays {
    /// Returns the rays of s (0) or of p (1) for the stack of this polarisation.
    pub(super) fn new(
        stack: &Stack,
        (views, sources): (&[Cone], &[Source]),
        (seen, polarisation): (&WholeView, usize),
        digits: f64,
    ) -> Self {
        let view = |cone: &Cone| {
            let across = across(stack, cone);
            let nodes = Nodes { rings: (digits / 2.5) as usize, across };
            let of_source = |(number, source): (usize, &Source)| {
                let lit = (number, source.direction());
                let weighted = |Point { beta, weight }| Point {
                    beta,
                    weight: weight * seen.weights(Some(cone), lit, beta)[polarisation],
                };
                seen_in(cone, source, (digits, nodes)).into_iter().map(weighted).collect()
            };
            OfView { cone: *cone, across, points: sources.iter().enumerate().map(of_source).collect() }
        };
        Self(views.iter().map(view).collect())
    }

    /// Returns whether they can be used for the base of this stack.
    pub(super) fn serve(&self, stack: &Stack) -> bool {
        self.0.iter().all(|view| view.across == across(stack, &view.cone))
    }

    /// Returns what a view sees of each source.
    pub(super) fn seen(&self, stack: &Stack, view: usize) -> Vec<ReflectanceFactor> {
        let Some(view) = self.0.get(view) else { return Vec::new() };
        let of_source = |points: &Vec<Point>| {
            let mut sum = ReflectanceFactor::zeros(stack.base().states(), stack.base().bins());
            points.iter().for_each(|point| sum.add(&specular_image(stack, point.beta), point.weight));
            sum
        };
        view.points.iter().map(of_source).collect()
    }
}

/// Number of nodes of the base's table across a view.
fn across(stack: &Stack, cone: &Cone) -> f64 {
    let lowest = stack.layers().last();
    lowest.map_or(0.0, |layer| stack.base().nodes_across(cone, &layer.medium))
}
