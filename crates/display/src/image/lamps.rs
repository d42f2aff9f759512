//! Mirror images of lamps over a panel, for an eye at its place.
//!
//! **What.** A lamp with `radius_deg` is seen in each face of the display, and in pixels like mirrors, at the
//! places of the panel from which the mirrored direction leads to the eye. Its luminance there is that of the
//! lamp times the reflectance of the display in this direction ([`crate::lamp_images`]). A lamp without a
//! radius has no luminance, and no image in computed pictures; drawings show it as a small disc
//! ([`drawn_lamps`]).
//!
//! **Border.** A pixel sees a round patch of directions: the field of view of the eye, or the pixel itself
//! where that is larger. Its part within the lamp is that of two circles in a plane.

use std::f64::consts::PI;

use super::perspective::Eye;
use crate::DisplayError;
use crate::lamp_images::whole;
use crate::run::Control;
use crate::scene::{AngleMedium, DirectedLight};
use crate::setup::{Setup, Towards};

/// Half of the angle across the disc with which collimated light is drawn, degrees. It has no luminance: that
/// of the disc is its illuminance over the disc's projected solid angle.
pub(super) const COLLIMATED_DEG: f64 = 0.25;

/// The mirror image of a lamp.
#[derive(Debug, Clone, PartialEq)]
#[allow(non_snake_case, reason = "the field's own letters")]
pub struct LampImage {
    /// Name of the light: `directed.0`, ...
    pub light: String,
    /// Direction from the display to an eye that sees the middle of the image: to the right, upwards, and
    /// away from the panel; of length 1.
    pub towards: [f64; 3],
    /// Half of the angle across the lamp, degrees.
    pub radius_deg: f64,
    /// Whether its light is collimated, so that it has no luminance of its own.
    pub is_collimated: bool,
    /// X, Y and Z of the image on a pixel in each state, relative to a perfect white in all light; in
    /// addition to all other light.
    pub XYZ: Vec<[f64; 3]>,
}

/// Computes the images of all lamps that a display mirrors for a drawing: collimated ones as small discs
/// ([`COLLIMATED_DEG`]).
///
/// # Errors
/// If the scene is invalid.
pub(super) fn drawn_lamps(
    setup: &Setup,
    states: &[String],
    control: &Control<'_>,
) -> Result<Vec<LampImage>, DisplayError> {
    let scene = &setup.scene;
    if scene.lighting.directed.is_empty() {
        return Ok(Vec::new());
    }
    let mut drawn = scene.clone();
    for light in &mut drawn.lighting.directed {
        // Near the horizon, the disc is smaller.
        let most = 0.5 * (90.0 - light.theta_deg.abs());
        light.radius_deg.get_or_insert(COLLIMATED_DEG.min(most));
    }
    let is_collimated = |image: &LampImage| {
        let number = image.light.strip_prefix("directed.").and_then(|number| number.parse::<usize>().ok());
        number
            .and_then(|number| scene.lighting.directed.get(number))
            .is_some_and(|one| one.radius_deg.is_none())
    };
    let images = lamp_images(&setup.clone().renewed_towards(&drawn, Towards::Views, control)?, states);
    Ok(images.into_iter().map(|one| LampImage { is_collimated: is_collimated(&one), ..one }).collect())
}

/// Computes the images of all round lamps that a display mirrors, with a colour for each of the states.
pub(super) fn lamp_images(setup: &Setup, states: &[String]) -> Vec<LampImage> {
    let scene = &setup.scene;
    let is_round = |light: &DirectedLight| light.radius_deg.is_some() && light.share > 0.0;
    if scene.solver.angle_medium != AngleMedium::Air || !scene.lighting.directed.iter().any(is_round) {
        return Vec::new();
    }
    let mut all = Vec::new();
    for one in whole(setup) {
        let light = &scene.lighting.directed[one.light];
        let of_state = |state: &String| {
            let pixel = setup.states.iter().position(|name| name == state).map(|number| one.pixel[number]);
            [0, 1, 2].map(|k| one.front[k] + pixel.map_or(0.0, |pixel| pixel[k]))
        };
        let colours: Vec<[f64; 3]> = states.iter().map(of_state).collect();
        if colours.iter().flatten().any(|value| *value > 0.0) {
            let (theta, phi) = (light.theta_deg.to_radians(), light.phi_deg.to_radians());
            all.push(LampImage {
                light: format!("directed.{}", one.light),
                towards: [-theta.sin() * phi.cos(), -theta.sin() * phi.sin(), theta.cos()],
                radius_deg: light.radius_deg.unwrap_or(0.0),
                is_collimated: false,
                XYZ: colours,
            });
        }
    }
    all
}

impl LampImage {
    /// Adds the image to what an eye sees of the pixels of a panel; `half_field_deg` is half of its field of
    /// view.
    pub(super) fn add(
        &self,
        eye: &Eye,
        (size, states): ([usize; 2], &[u8]),
        half_field_deg: f64,
        seen: &mut [[f32; 3]],
    ) {
        let radius = self.radius_deg.to_radians();
        let rows = seen.chunks_exact_mut(size[0]).zip(states.chunks_exact(size[0])).enumerate();
        for (row, (seen, states)) in rows {
            for (column, (seen, state)) in seen.iter_mut().zip(states).enumerate() {
                let ([x, y, z], half_pixel) = eye.direction(size, [column, row]);
                let [u, v, w] = self.towards;
                // Between directions that are close to each other, the cosine has lost its digits.
                let cross = [y * w - z * v, z * u - x * w, x * v - y * u];
                let sine = cross.iter().map(|part| part * part).sum::<f64>().sqrt();
                let angle = sine.atan2(x * u + y * v + z * w);
                let share = within(angle, radius, half_pixel.max(half_field_deg.to_radians()));
                if share > 0.0 {
                    let image = self.XYZ[usize::from(*state)];
                    (0..3).for_each(|k| seen[k] += (share * image[k]) as f32);
                }
            }
        }
    }
}

/// Part of a circle of radius `own` that is within a circle of radius `other`, whose centre is `distance`
/// away.
fn within(distance: f64, other: f64, own: f64) -> f64 {
    if distance >= other + own {
        return 0.0;
    }
    if distance <= (other - own).abs() {
        return (other / own).powi(2).min(1.0);
    }
    // Sectors minus the triangles between the points of intersection.
    let segment = |radius: f64, than: f64| {
        let cosine = (distance * distance + radius * radius - than * than) / (2.0 * distance * radius);
        let half = cosine.clamp(-1.0, 1.0).acos();
        radius * radius * (half - half.sin() * half.cos())
    };
    (segment(own, other) + segment(other, own)) / (PI * own * own)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of a small circle is within a large one on whose border it lies; the area of two equal circles
    /// whose distance is their radius is 2 pi/3 - sqrt(3)/2.
    #[test]
    fn parts_of_circles() {
        assert!((within(1000.0, 1000.0, 1.0) - 0.5).abs() < 1e-3);
        assert!((within(1.0, 1.0, 1.0) - (2.0 / 3.0 - 0.75_f64.sqrt() / PI)).abs() < 1e-12);
        assert_eq!((within(0.5, 2.0, 1.0), within(3.0, 2.0, 1.0), within(0.1, 0.5, 1.0)), (1.0, 0.0, 0.25));
    }
}
