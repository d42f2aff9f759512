//! Reflectance factor under a front light below the front of screen, computed from that under the same light
//! above it.
//!
//! The properties of the front do not depend on angle. The light that falls on the layer below it therefore
//! follows the same paths whatever its origin: a light guide of E lx there is equivalent to ambient light of
//! E/t, where t is the front's transmittance, without the front's own reflection of that light. For one
//! component of reflectance R and absorptance A, this is the factor 1/(1 - R - A) that light gains by
//! crossing the front once instead of twice. Light that leaks upwards adds a veil of t times its luminance,
//! and the part of it that the front reflects is diffuse light on the panel.

use papilio_spectra::StateSpectra;
use papilio_transport::{Front, ReflectanceFactor, Stack};

use crate::scene::{FrontLight, Scene};

/// Front light, with the front of screen above it.
#[derive(Debug)]
pub(super) struct BelowFront {
    front: Front,
    is_diffuse: bool,
    leak: f64,
}

impl BelowFront {
    pub(super) fn new(scene: &Scene, stack: &Stack) -> Option<Self> {
        let FrontLight { field, upward_over_downward, .. } = scene.lighting.front_light.as_ref()?;
        let front = match stack.panel() {
            Some(panel) => panel.front.clone(),
            None => {
                let components = stack.layers().iter().map_while(|layer| layer.interface.front_component());
                let components =
                    components.map(|[reflectance, absorptance]| (&**reflectance, &**absorptance));
                Front::exact(scene.grid.len(), components)
            }
        };
        Some(Self { front, is_diffuse: field.is_none(), leak: *upward_over_downward })
    }

    /// Converts the derivatives of a number with respect to the reflectance factor below the front to those
    /// with respect to the one above it. Shapes are those of `rho.base`; the derivative for diffuse light is
    /// added to `of_diffuse`.
    pub(super) fn pull_back(&self, of_it: &mut [f64], of_diffuse: &mut [f64]) {
        let Front { transmittance, reflectance_below, .. } = &self.front;
        let bins = transmittance.len();
        for (k, (it, diffuse)) in of_it.iter_mut().zip(of_diffuse).enumerate() {
            let bin = k % bins;
            *it *= if transmittance[bin] > 0.0 { 1.0 / transmittance[bin] } else { 0.0 };
            *diffuse += self.leak * reflectance_below[bin] * *it;
        }
    }

    pub(super) fn is_diffuse(&self) -> bool {
        self.is_diffuse
    }

    /// Converts weights of the light via the pixel to those of the reflectance factors under the same light
    /// above the front and under diffuse light, which is that which leaks upwards and comes back.
    pub(super) fn weights(&self, weights: &[f64]) -> [Vec<f64>; 2] {
        let Front { transmittance, reflectance_below, .. } = &self.front;
        let gains = transmittance.iter().map(|t| if *t > 0.0 { 1.0 / t } else { 0.0 });
        let of_it: Vec<f64> = weights.iter().zip(gains).map(|(weight, gain)| weight * gain).collect();
        let sent_back = reflectance_below.iter().map(|r| self.leak * r);
        let of_diffuse = of_it.iter().zip(sent_back).map(|(weight, back)| weight * back).collect();
        [of_it, of_diffuse]
    }

    /// Computes the reflectance factor from those under the same light above the front and under diffuse
    /// light.
    pub(super) fn seen(
        &self,
        of_it: &ReflectanceFactor,
        of_diffuse: &ReflectanceFactor,
    ) -> ReflectanceFactor {
        let Front { transmittance, reflectance_above, reflectance_below } = &self.front;
        let bins = transmittance.len();
        let gain = |bin: usize| if transmittance[bin] > 0.0 { 1.0 / transmittance[bin] } else { 0.0 };
        let sent_back = |bin: usize| self.leak * reflectance_below[bin];
        let base = of_it.via_pixel.iter().zip(&of_diffuse.via_pixel).enumerate().map(|(k, (it, diffuse))| {
            let bin = k % bins;
            gain(bin) * (it + sent_back(bin) * diffuse)
        });
        let front = (0..bins).map(|bin| {
            let diffuse = of_diffuse.front[bin] - reflectance_above[bin];
            // Light that is not diffuse is reflected by the front only: a panel's diffuser has no reflection.
            let it = if self.is_diffuse { diffuse } else { 0.0 };
            gain(bin) * (it + sent_back(bin) * diffuse) + self.leak * transmittance[bin]
        });
        let via_pixel = StateSpectra::new(base.collect(), bins);
        ReflectanceFactor { via_pixel, front: front.collect() }
    }
}
