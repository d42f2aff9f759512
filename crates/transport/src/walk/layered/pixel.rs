//! A base that scatters by one kernel per state.
//!
//! One direction serves all states: it is sampled from the kernel of one of them, and the light of each state
//! is multiplied by its own kernel over the mean of all densities.

use papilio_optics::{Beta, Scatterer};

use super::OutgoingRay;
use super::ledger::{Sums, Workspace};
use super::light::Light;
use crate::layers::Scattered;
use crate::skeleton::{Propagation, Ray};
use crate::walk::horizon::Horizons;
use crate::{Medium, ScatterKernel};

/// The base, under a medium (air, if there is none).
#[derive(Debug, Clone, Copy)]
pub(super) struct Pixel<'a> {
    pub(super) kernels: &'a [ScatterKernel],
    pub(super) medium: Option<&'a Medium>,
    pub(super) element: usize,
    pub(super) horizons: Option<&'a Horizons>,
}

impl Pixel<'_> {
    /// Reflection by the base: connections to sources, and a new direction.
    pub(super) fn reflect(
        &self,
        from: Beta,
        u: [f64; 3],
        sums: &mut Sums,
        workspace: &mut Workspace,
    ) -> Option<OutgoingRay> {
        let ray = Ray { plane: self.element, going: Propagation::Up };
        sums.arriving.add(&workspace.light, 1.0);
        workspace.meetings = workspace.meetings.saturating_add(1);
        self.tint(&mut workspace.light);
        let mut turned = workspace.light.clone();
        let Workspace { light, share, lamps, .. } = &mut *workspace;
        for lamp in lamps.now().iter() {
            turned.clone_from(light);
            let density = self.density(from, lamp.beta);
            self.weigh(&mut turned, |kernel| {
                let value = self.value(kernel, from, lamp.beta);
                lamp.weight(Scattered { value, density, reverse: density }, 0.0, f64::INFINITY)
            });
            share.clear();
            lamp.reach(ray, |_| 1.0, share);
            lamp.add(&turned, share, sums);
        }
        let sent = self.send(from, u)?;
        let density = self.density(from, sent);
        self.weigh(&mut workspace.light, |kernel| self.value(kernel, from, sent) / density);
        sums.reflected.add(&workspace.light, 1.0);
        Some(OutgoingRay::exactly(sent, ray, density))
    }

    /// Turns all light into light that has met the base, in the colour of each state.
    fn tint(&self, light: &mut Light) {
        let rows = light.met.chunks_exact_mut(light.fresh.len());
        for (row, kernel) in rows.zip(self.kernels) {
            for ((met, fresh), factor) in row.iter_mut().zip(&light.fresh).zip(&*kernel.factor) {
                *met = (*met + fresh) * factor;
            }
        }
        light.fresh.fill(0.0);
    }

    /// Multiplies each state's light.
    fn weigh(&self, light: &mut Light, weight: impl Fn(&ScatterKernel) -> f64) {
        let rows = light.met.chunks_exact_mut(light.fresh.len());
        for (row, kernel) in rows.zip(self.kernels) {
            let weight = weight(kernel);
            row.iter_mut().for_each(|met| *met *= weight);
        }
    }

    fn index(&self) -> f64 {
        self.medium.map_or(1.0, Medium::largest_index)
    }

    /// The same direction as cosines of a medium of index 1.
    fn of_air(&self, beta: Beta) -> Beta {
        let index = self.index();
        Beta { x: beta.x / index, y: beta.y / index }
    }

    fn value(&self, kernel: &ScatterKernel, from: Beta, to: Beta) -> f64 {
        kernel.scatter.evaluate(self.of_air(from), self.of_air(to)) / self.index().powi(2)
    }

    /// The mean density of all kernels, with the directions towards the horizons.
    fn density(&self, from: Beta, to: Beta) -> f64 {
        let (from, of_air) = (self.of_air(from), self.of_air(to));
        let sum: f64 = self.kernels.iter().map(|kernel| kernel.scatter.density(from, of_air)).sum();
        let own = sum / (self.kernels.len() as f64 * self.index().powi(2));
        self.horizons.map_or(own, |horizons| horizons.pixel_density(own, to))
    }

    fn send(&self, from: Beta, mut u: [f64; 3]) -> Option<Beta> {
        if let Some(towards) = self.horizons.and_then(|horizons| horizons.of_pixel(&mut u)) {
            return Some(towards);
        }
        let place = u[2] * self.kernels.len() as f64;
        let kernel = self.kernels.get(place as usize)?;
        let sent = kernel.scatter.sample(self.of_air(from), [u[0], u[1], place.fract(), 0.0])?;
        Some(Beta { x: sent.direction.x * self.index(), y: sent.direction.y * self.index() })
    }
}
