//! The lights of a scene one by one: what is seen of a display is the sum of what is seen in each.

use crate::scene::Scene;

/// A scene that is lit by one of its lights alone.
pub(super) struct Alone {
    /// Name of the light, as in other results: `diffuse`, `directed.0`, ...
    pub(super) light: String,
    pub(super) scene: Scene,
    /// True for the front light, which does not light a perfect white above it.
    pub(super) is_front_light: bool,
}

impl Alone {
    /// The display, the view, and this light with illuminance 1, without the other lights; and its
    /// illuminance, lx. Colours relative to a perfect white in this light depend on the former only.
    pub(super) fn with_unit_illuminance(&self) -> (Scene, f64) {
        let mut scene = self.scene.clone();
        let lighting = &mut scene.lighting;
        lighting.directed.retain(|light| light.share > 0.0);
        lighting.environment.retain(|one| one.parts.iter().any(|part| part.share > 0.0));
        let front_light_lx = lighting.front_light.as_ref().map_or(0.0, |guide| guide.illuminance_lx);
        let directed = lighting.directed.iter().map(|light| light.share);
        let parts = lighting.environment.iter().flat_map(|one| &one.parts).map(|part| part.share);
        let share: f64 = lighting.diffuse + directed.chain(parts).sum::<f64>();
        let lux = if self.is_front_light { front_light_lx } else { lighting.illuminance_lx * share };
        lighting.illuminance_lx = 1.0;
        if self.is_front_light {
            lighting.front_light.iter_mut().for_each(|guide| guide.illuminance_lx = 1.0);
        } else {
            lighting.diffuse /= share;
            lighting.directed.iter_mut().for_each(|light| light.share /= share);
            let parts = lighting.environment.iter_mut().flat_map(|one| &mut one.parts);
            parts.for_each(|part| part.share /= share);
        }
        (scene, lux)
    }
}

/// Returns the scene once for each of its lights, in the order of the scene. Lights without illuminance are
/// left out.
pub(super) fn each_alone(scene: &Scene) -> Vec<Alone> {
    let lighting = &scene.lighting;
    let dark = {
        let mut dark = scene.clone();
        dark.lighting.diffuse = 0.0;
        dark.lighting.directed.iter_mut().for_each(|light| light.share = 0.0);
        let parts = dark.lighting.environment.iter_mut().flat_map(|environment| &mut environment.parts);
        parts.for_each(|part| part.share = 0.0);
        if let Some(guide) = &mut dark.lighting.front_light {
            guide.illuminance_lx = 0.0;
        }
        dark
    };
    let mut all = Vec::new();
    let mut add = |light: String, is_lit: bool, switch_on: &dyn Fn(&mut Scene)| {
        if is_lit {
            let mut scene = dark.clone();
            switch_on(&mut scene);
            all.push(Alone { is_front_light: light == "front_light", light, scene });
        }
    };
    add("diffuse".to_owned(), lighting.diffuse > 0.0, &|one| one.lighting.diffuse = lighting.diffuse);
    for (k, light) in lighting.directed.iter().enumerate() {
        let switch_on = |one: &mut Scene| one.lighting.directed[k].share = light.share;
        add(format!("directed.{k}"), light.share > 0.0, &switch_on);
    }
    for (k, environment) in lighting.environment.iter().enumerate() {
        let is_lit = environment.parts.iter().any(|part| part.share > 0.0);
        let switch_on = |one: &mut Scene| one.lighting.environment[k] = environment.clone();
        add(format!("environment.{k}"), is_lit, &switch_on);
    }
    if let Some(guide) = &lighting.front_light {
        let switch_on = |one: &mut Scene| one.lighting.front_light = Some(guide.clone());
        add("front_light".to_owned(), guide.illuminance_lx > 0.0, &switch_on);
    }
    all
}
