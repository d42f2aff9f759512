//! Rays of s or of p that views see in flat layers above a mirror, where sources are polarised or a polariser is before the eye.
//!
//! Nothing scatters: a ray that a view sees has left a source in the mirrored direction, and its weight depends on both.

use papilio_optics::Beta;

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
    /// By source, with the weight of the product of both amplitudes, in the rays of s.
    products: Vec<Vec<Point>>,
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
            let all: Vec<Vec<Point>> =
                sources.iter().map(|source| seen_in(cone, source, (digits, nodes))).collect();
            let weighted = |factor: &dyn Fn((usize, Option<Beta>), Beta) -> f64| {
                let of_source = |(number, (points, source)): (usize, (&Vec<Point>, &Source))| {
                    let lit = (number, source.direction());
                    let one = |point: &Point| Point {
                        beta: point.beta,
                        weight: point.weight * factor(lit, point.beta),
                    };
                    points.iter().map(one).filter(|point| point.weight != 0.0).collect()
                };
                all.iter().zip(sources).enumerate().map(of_source).collect::<Vec<Vec<Point>>>()
            };
            let (points, products) = match stack.phases() {
                None => {
                    (weighted(&|lit, beta| seen.weights(Some(cone), lit, beta)[polarisation]), Vec::new())
                }
                Some(_) => {
                    let of = |one: usize| weighted(&|lit, beta| seen.products(Some(cone), lit, beta)[one]);
                    (of(polarisation), if polarisation == 0 { of(2) } else { Vec::new() })
                }
            };
            OfView { cone: *cone, across, points, products }
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
        let of_source = |(number, points): (usize, &Vec<Point>)| {
            let mut sum = ReflectanceFactor::zeros(stack.base().states(), stack.base().bins());
            points.iter().for_each(|point| sum.add(&specular_image(stack, point.beta), point.weight));
            if let (Some(phases), Some(products)) = (stack.phases(), view.products.get(number)) {
                products.iter().for_each(|point| sum.add(&phases.image(point.beta), point.weight));
            }
            sum
        };
        view.points.iter().enumerate().map(of_source).collect()
    }
}

/// Number of nodes of the base's table across a view.
fn across(stack: &Stack, cone: &Cone) -> f64 {
    let lowest = stack.layers().last();
    lowest.map_or(0.0, |layer| stack.base().nodes_across(cone, &layer.medium))
}
