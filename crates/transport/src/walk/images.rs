//! Mirror images of round sources: light that nothing scatters.
//!
//! The image is seen where the viewer's field and the mirrored source overlap. Either
//! may be far smaller than the other, so that points of the one hardly ever fall on the
//! other: points are drawn in the smallest cone that holds the overlap. Everything that
//! happens to the light is known in closed form ([`specular_image`]).

use std::f64::consts::PI;

use crate::specular::{Image, specular_image};
use crate::{Cone, Estimate, Panel, Reflector, Source, Stack, Top};

/// The images of all sources in one field of view.
#[derive(Debug)]
pub(super) struct Images<'a> {
    stack: &'a Stack,
    view: Cone,
    /// For each source that may be seen: its number, its mirrored cone, the overlap, and
    /// the weight of a point of it.
    seen: Vec<Seen>,
    /// Whether the stack mirrors anything at all.
    mirrors: bool,
}

#[derive(Debug)]
struct Seen {
    source: usize,
    mirrored: Cone,
    overlap: Cone,
    weight: f64,
}

/// The sums over a replicate's paths: an image for each source that may be seen.
#[derive(Debug, Clone)]
pub(super) struct Sums(Vec<Image>);

impl<'a> Images<'a> {
    pub(super) fn new(stack: &'a Stack, view: Cone, sources: &[Source]) -> Self {
        let seen = sources.iter().enumerate().filter_map(|(source, light)| {
            let Source::Disc(disc) = light else { return None };
            let mirrored = disc.mirrored();
            let overlap = view.overlap(&mirrored)?;
            // A field of no width is a single direction.
            let share = if view.is_point() { 1.0 } else { overlap.solid_angle() / view.solid_angle() };
            Some(Seen { source, mirrored, overlap, weight: share * PI / disc.projected_solid_angle() })
        });
        Self { stack, view, seen: seen.collect(), mirrors: mirrors(stack) }
    }

    pub(super) fn sums(&self) -> Sums {
        let base = self.stack.base();
        let empty = || Image { front: vec![0.0; base.bins()], base: vec![0.0; base.states() * base.bins()] };
        Sums(self.seen.iter().map(|_| empty()).collect())
    }

    /// Adds one point of each overlap.
    pub(super) fn path(&self, u: [f64; 2], sums: &mut Sums) {
        if !self.mirrors {
            return;
        }
        for (seen, sum) in self.seen.iter().zip(&mut sums.0) {
            let beta = seen.overlap.sample_towards(u);
            if self.view.holds(beta) && seen.mirrored.holds(beta) {
                let image = specular_image(self.stack, beta);
                super::add_scaled(&mut sum.front, &image.front, seen.weight);
                super::add_scaled(&mut sum.base, &image.base, seen.weight);
            }
        }
    }

    /// Adds the mean images to what else is seen of the sources.
    pub(super) fn add_to(&self, mut estimate: Estimate, sums: &Sums, scale: f64) -> Estimate {
        for (seen, sum) in self.seen.iter().zip(&sums.0) {
            let rho = &mut estimate.rho[seen.source];
            super::add_scaled(&mut rho.front, &sum.front, scale);
            super::add_scaled(&mut rho.base, &sum.base, scale);
        }
        estimate
    }
}

/// Whether any light comes back unscattered.
fn mirrors(stack: &Stack) -> bool {
    match stack {
        Stack::Panel(panel) => panel_mirrors(panel),
        // Some angle may, and what does not is cheap.
        Stack::Layered(_) => true,
    }
}

fn panel_mirrors(stack: &Panel) -> bool {
    let reaches_base = match &stack.top {
        Top::Diffuser(diffuser) => diffuser.straight_through > 0.0,
        Top::Coated => true,
        Top::Fresnel(_) => return true,
    };
    let specular = matches!(stack.base.reflector, Reflector::Specular(_));
    stack.front.reflectance_above.max() > 0.0 || (reaches_base && specular)
}
