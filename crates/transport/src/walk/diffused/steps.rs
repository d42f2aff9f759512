//! Steps of a path through a panel: across the diffuser, to the base and off it.

use papilio_optics::{Beta, Scatterer};
use papilio_sampling::warp;

use super::first_pass::First;
use super::ledger::Workspace;
use super::numbers::PassNumbers;
use super::{Diffused, LightAbove, LightBelow};
use crate::Reflector;
use crate::angular::Stencil;
use crate::walk::strategy::DirectionSampler;
use crate::walk::{base_density, base_direction, scale_rows};

impl Diffused<'_> {
    /// Transmits light down through the diffuser, scattered by the lobe with this probability.
    #[inline]
    pub(super) fn down(
        &self,
        light: LightAbove,
        by_lobe: f64,
        numbers: &PassNumbers<'_>,
    ) -> Option<LightBelow> {
        let LightAbove { beta, weight, .. } = light;
        let n = self.stack.medium.largest_index();
        let (drawing, balanced) = match &self.first {
            First::Kernel(kernel) if numbers.pass == 0 && self.specular => (kernel, true),
            _ => (&self.drawing, false),
        };
        let (to, drawn, straight) = self.through(drawing, beta, n, by_lobe, numbers.down)?;
        let rival = if balanced && !straight { self.diffuser.lobe.density(beta, to) } else { f64::INFINITY };
        Some(LightBelow { beta: to, weight: weight * drawn, rival })
    }

    /// Returns the probability with which light on its way out to a disc is scattered, if it can be.
    pub(super) fn by_lobe_upwards(&self) -> f64 {
        if self.straight() < 1.0 { 1.0 } else { 0.0 }
    }

    /// Returns the weight of the light that leaves into the air, from light of this weight that the base has
    /// reflected along `up`.
    ///
    /// Unscattered light from a Lambertian base leaves if it has a direction in the air, which a fraction
    /// 1/n^2 of it has. This fraction is used instead of the direction of the path: with low-discrepancy
    /// numbers all replicates could count equally.
    #[inline]
    pub(super) fn leaves(&self, weight: f64, up: LightBelow) -> f64 {
        let offset = up.beta.length();
        let scattered =
            up.weight * (1.0 - self.straight()) * self.diffuser.lobe.fraction_in_disc(offset, 1.0);
        // In a dispersive medium, the light no longer contains wavelengths that do not have this direction:
        // a direction that all wavelengths have represents the rest.
        let smallest = self.stack.medium.index().iter().copied().fold(f64::INFINITY, f64::min);
        let straight = match self.stack.medium.constant_index() {
            Some(n) if !self.specular => weight / (n * n).max(1.0),
            None if !self.specular && smallest >= 1.0 && offset < smallest => {
                up.weight / (smallest * smallest)
            }
            None if !self.specular && smallest >= 1.0 => 0.0,
            _ if offset <= 1.0 => up.weight,
            _ => 0.0,
        };
        scattered + self.straight() * straight
    }

    pub(super) fn straight(&self) -> f64 {
        self.diffuser.regular_fraction
    }

    /// Scatters by the lobe with this probability, else passes unscattered, into a disc of this radius.
    /// Returns the direction, the weight, and whether it is unscattered; `None` also where there is no
    /// light.
    #[inline]
    pub(super) fn through(
        &self,
        drawing: &DirectionSampler,
        beta: Beta,
        radius: f64,
        by_lobe: f64,
        u: [f64; 2],
    ) -> Option<(Beta, f64, bool)> {
        let (straight, chance) = (self.straight(), 1.0 - by_lobe);
        if u[0] < chance {
            return (straight > 0.0).then(|| (beta, straight / chance, true));
        }
        if straight == 1.0 {
            return None;
        }
        let rest = if chance > 0.0 { (u[0] - chance) / by_lobe } else { u[0] };
        let drawn = drawing.draw(beta, radius, [rest, u[1]])?;
        Some((drawn.beta, drawn.weight * (1.0 - straight) / by_lobe, false))
    }

    /// Returns the density with which light on its way out to a disc is scattered to `to`.
    #[inline]
    pub(super) fn density_out(&self, from: Beta, to: Beta) -> f64 {
        self.by_lobe_upwards() * self.drawing.density(from, to, 1.0)
    }

    /// Reflects light at the base: a look-up on a first pass, else `carried` becomes `reflected`.
    #[inline]
    pub(super) fn meet_base(&self, base: Beta, carries: bool, workspace: &mut Workspace) -> Option<Stencil> {
        if carries {
            multiply(&mut workspace.reflected, &workspace.carried, |out| self.reflectance(base, out));
            return None;
        }
        Some(self.look_up(base))
    }

    #[inline]
    pub(super) fn look_up(&self, base: Beta) -> Stencil {
        self.look_up_at(base.squared())
    }

    #[inline(always)]
    pub(super) fn look_up_at(&self, squared: f64) -> Stencil {
        match (&self.stack.base.reflector, self.stack.medium.constant_index()) {
            (Reflector::Specular(table), Some(index)) => table.nodes.stencil(squared, index),
            _ => Stencil::ONLY_NODE,
        }
    }

    pub(super) fn reflectance(&self, base: Beta, out: &mut [f64]) {
        self.stack.base.reflectance(base.squared(), &self.stack.medium, out);
    }

    /// Samples a direction of the whole medium, as a Lambertian base reflects it.
    #[inline]
    pub(super) fn leave_base(&self, weight: f64, numbers: &PassNumbers<'_>) -> LightBelow {
        let n = self.stack.medium.largest_index();
        if let First::Guided(guided) = &self.first {
            let (beta, density) = guided.guide.draw(numbers.base);
            let weight = weight * warp::uniform_disc_density(n) / density;
            return LightBelow { beta, weight, rival: f64::INFINITY };
        }
        let (beta, weight) = self.off_base(weight, numbers.base);
        let rival = if self.backwards { base_density(n, beta) } else { f64::INFINITY };
        LightBelow { beta, weight, rival }
    }

    /// Samples a direction into which a Lambertian base reflects light; returns it and the weight of the
    /// light.
    #[inline]
    pub(super) fn off_base(&self, weight: f64, u: [f64; 2]) -> (Beta, f64) {
        let n = self.stack.medium.largest_index();
        let beta = base_direction(n, u);
        (beta, weight * warp::uniform_disc_density(n) / base_density(n, beta))
    }

    /// Removes the wavelengths for which the medium has no such direction.
    pub(super) fn keep_within_disc(&self, beta: Beta, spread: Spread, spectra: &mut [f64]) {
        let medium = &self.stack.medium;
        if medium.constant_index().is_some() {
            return;
        }
        let kept: Vec<f64> =
            medium.index().iter().map(|&n| spread.kept(beta, n, medium.largest_index())).collect();
        scale_rows(spectra, &kept);
    }
}

/// How a base spreads light, for wavelengths whose medium has a smaller disc than the largest.
#[derive(Debug, Clone, Copy)]
pub(super) enum Spread {
    No,
    Lambertian,
}

impl Spread {
    /// Returns the weight of `beta` at index `n`, where it was sampled for index `largest`.
    pub(super) fn kept(self, beta: Beta, n: f64, largest: f64) -> f64 {
        match self {
            _ if beta.squared() >= n * n => 0.0,
            Self::No => 1.0,
            Self::Lambertian => (largest / n).powi(2),
        }
    }
}

/// `out = values * f`, where `fill` writes f.
pub(super) fn multiply(out: &mut [f64], values: &[f64], fill: impl FnOnce(&mut [f64])) {
    fill(out);
    scale_rows(out, values);
}
