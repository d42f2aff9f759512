//! What is seen of a light guide below the front of screen, from what is seen of the same light above it.
//!
//! The front is alike at all angles, so light that falls on the layer below it goes the same ways wherever it came
//! from: a guide of E lx there is ambient light of E/t, t the front's transmittance, less what the front itself
//! mirrors of that. For one component of reflectance R and absorptance A that is the factor 1/(1 - R - A) which light gains that crosses
//! the front once instead of twice. What leaks upwards is a veil of t times its luminance, and what the front sends back of it
//! is diffuse light on the panel.

use papilio_transport::{Front, ReflectanceFactor, Stack};

use crate::scene::{FrontLight, Scene};

/// A front light and the front above it.
#[derive(Debug)]
pub(super) struct BelowFront {
    front: Front,
    is_diffuse: bool,
    leak: f64,
}

impl BelowFront {
    pub(super) fn new(scene: &Scene, stack: &Stack) -> Option<Self> {
        let FrontLight { field, upward_over_downward, .. } = scene.lighting.front_light.as_ref()?;
        let front = match stack {
            Stack::Panel(panel) => panel.front.clone(),
            Stack::Layered(layered) => {
                let components = layered.layers.iter().map_while(|layer| layer.interface.front_component());
                let components =
                    components.map(|[reflectance, absorptance]| (&**reflectance, &**absorptance));
                Front::exact(scene.grid.len(), components)
            }
        };
        Some(Self { front, is_diffuse: field.is_none(), leak: *upward_over_downward })
    }

    /// How a number changes with what is seen above the front, from how it changes with what is seen below it:
    /// shapes are those of `rho.base`; that of diffuse light is added to.
    pub(super) fn pull_back(&self, of_it: &mut [f64], of_diffuse: &mut [f64]) {
        let Front { transmittance, reflectance_below, .. } = &self.front;
        let bins = transmittance.len();
        for (k, (it, diffuse)) in of_it.iter_mut().zip(of_diffuse).enumerate() {
            let bin = k % bins;
            *it *= if transmittance[bin] > 0.0 { 1.0 / transmittance[bin] } else { 0.0 };
            *diffuse += self.leak * reflectance_below[bin] * *it;
        }
    }

    /// Of what is seen of its light above the front, and of diffuse light.
    pub(super) fn seen(
        &self,
        of_it: &ReflectanceFactor,
        of_diffuse: &ReflectanceFactor,
    ) -> ReflectanceFactor {
        let Front { transmittance, reflectance_above, reflectance_below } = &self.front;
        let bins = transmittance.len();
        let share = |bin: usize| if transmittance[bin] > 0.0 { 1.0 / transmittance[bin] } else { 0.0 };
        let sent_back = |bin: usize| self.leak * reflectance_below[bin];
        let base = of_it.via_pixel.iter().zip(&of_diffuse.via_pixel).enumerate().map(|(k, (it, diffuse))| {
            let bin = k % bins;
            share(bin) * (it + sent_back(bin) * diffuse)
        });
        let front = (0..bins).map(|bin| {
            let diffuse = of_diffuse.front[bin] - reflectance_above[bin];
            // Other light than diffuse is mirrored by the front alone: a panel's diffuser reflects nothing.
            let it = if self.is_diffuse { diffuse } else { 0.0 };
            share(bin) * (it + sent_back(bin) * diffuse) + self.leak * transmittance[bin]
        });
        ReflectanceFactor { via_pixel: base.collect(), front: front.collect() }
    }
}
