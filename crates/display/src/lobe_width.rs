//! Width of a display's lobe about the mirror direction, which decides where the nodes of its exported BSDF
//! are needed.

use crate::scene::{Scene, Stop};
use crate::viewers::{Viewer, ViewerGrid};
use crate::{Control, DisplayError, HalfVectorGrid, brdf_at_viewers, depends_on_azimuth};

/// Inclinations of the light at which the width is determined, degrees.
const LIGHTS_DEG: [f64; 7] = [0.0, 20.0, 40.0, 55.0, 70.0, 80.0, 88.0];

/// Inclinations of the half vector: the first one after 0, degrees, the factor to the next one, and their
/// number.
const FIRST_DEG: f64 = 0.01;
const FACTOR: f64 = 1.35;
const COUNT: i32 = 29;

/// Relative error of the BSDF that is sufficient for a width.
const SUFFICIENT: f64 = 0.02;

/// Width of a lobe that hardly falls, degrees.
const BROAD_DEG: f64 = 30.0;

/// Inclination of the half vector, out of the plane of incidence, at which the lobe has fallen half-way from
/// its mirror direction to its smallest value, for each inclination of the light. It is about half the
/// distance from the mirror direction.
#[derive(Debug, Clone, PartialEq)]
pub struct LobeWidths {
    theta_i_deg: Vec<f64>,
    width_deg: Vec<f64>,
}

impl LobeWidths {
    /// The same width in direction cosines for all inclinations of the light: that of a half vector increases
    /// as 1/cos(theta_i).
    pub fn constant(width_deg: f64) -> Self {
        Self { theta_i_deg: vec![0.0], width_deg: vec![width_deg] }
    }

    /// Computes the widths of the scene's display, of the sum of its states and wavelengths; of a display that depends on azimuth, for
    /// light at one.
    ///
    /// # Errors
    /// If the scene is invalid, or the computation was stopped.
    pub fn of_scene(scene: &Scene, control: &Control<'_>) -> Result<Self, DisplayError> {
        let mut scene = scene.clone();
        scene.solver.stop = Stop::RelativeError { target: SUFFICIENT, per_wavelength: false };
        let silent = Control { progress: &|_| {}, ..*control };
        let phi_i_deg = if depends_on_azimuth(&scene, control)? { vec![0.0] } else { Vec::new() };
        let table = brdf_at_viewers(&scene, AcrossPlane { phi_i_deg }, &silent)?;
        let bins = table.wavelength_nm.len();
        let mut first = 0;
        let mut width = |light: usize| {
            let places = AcrossPlane::places(light);
            let from = first;
            first += places.len();
            let sum = |k: usize| -> f64 {
                let of_state = |brdf: &Vec<f32>| -> f64 {
                    brdf[(from + k) * bins..][..bins].iter().map(|f| f64::from(*f)).sum()
                };
                table.states.iter().map(|state| of_state(&state.brdf)).sum()
            };
            let values: Vec<f64> = (0..places.len()).map(sum).collect();
            fall(&places, &values)
        };
        Ok(Self {
            width_deg: (0..LIGHTS_DEG.len()).map(&mut width).collect(),
            theta_i_deg: LIGHTS_DEG.to_vec(),
        })
    }

    /// Width for light from `theta_i_deg`, degrees: that in direction cosines is interpolated.
    pub fn at(&self, theta_i_deg: f64) -> f64 {
        let cosine = |theta: f64| theta.to_radians().cos();
        let scaled = |k: usize| self.width_deg[k] * cosine(self.theta_i_deg[k]);
        let upper =
            self.theta_i_deg.partition_point(|theta| *theta < theta_i_deg).min(self.theta_i_deg.len() - 1);
        let lower = upper.saturating_sub(1);
        let [a, b] = [self.theta_i_deg[lower], self.theta_i_deg[upper]];
        let t = if b > a { ((theta_i_deg - a) / (b - a)).clamp(0.0, 1.0) } else { 0.0 };
        ((1.0 - t) * scaled(lower) + t * scaled(upper)) / cosine(theta_i_deg)
    }
}

/// Returns where values have fallen half-way from the first to the smallest one, by linear interpolation.
fn fall(places: &[f64], values: &[f64]) -> f64 {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let half = 0.5 * (values[0] + least);
    // A display that scatters evenly, or not at all.
    if values[0] <= 1.1 * least {
        return BROAD_DEG;
    }
    let below = values.iter().position(|value| *value < half).unwrap_or(values.len() - 1).max(1);
    let [high, low] = [values[below - 1], values[below]];
    let t = if high > low { ((high - half) / (high - low)).clamp(0.0, 1.0) } else { 1.0 };
    (places[below - 1] + t * (places[below] - places[below - 1])).clamp(FIRST_DEG, BROAD_DEG)
}

/// Viewers whose half vectors are perpendicular to the plane of incidence.
struct AcrossPlane {
    phi_i_deg: Vec<f64>,
}

impl AcrossPlane {
    /// Inclinations of the half vector, degrees, whose viewers are above the horizon.
    fn places(light: usize) -> Vec<f64> {
        let all = std::iter::once(0.0).chain((0..COUNT).map(|k| FIRST_DEG * FACTOR.powi(k)));
        all.filter(|theta_m| Self::viewer(light, *theta_m).is_some()).collect()
    }

    fn viewer(light: usize, theta_m_deg: f64) -> Option<Viewer> {
        HalfVectorGrid::viewer(LIGHTS_DEG[light], [(theta_m_deg / 90.0).sqrt(), 0.25])
    }
}

impl ViewerGrid for AcrossPlane {
    fn theta_i_deg(&self) -> &[f64] {
        &LIGHTS_DEG
    }

    fn phi_i_deg(&self) -> &[f64] {
        &self.phi_i_deg
    }

    fn viewers(&self, light: usize) -> (Vec<Viewer>, Vec<Option<usize>>) {
        let viewers: Vec<Viewer> =
            Self::places(light).into_iter().filter_map(|theta_m| Self::viewer(light, theta_m)).collect();
        let numbers = (0..viewers.len()).map(Some).collect();
        (viewers, numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn width_is_where_a_lobe_has_fallen_half_way() {
        let places: Vec<f64> =
            std::iter::once(0.0).chain((0..COUNT).map(|k| FIRST_DEG * FACTOR.powi(k))).collect();
        let lobe = |theta: &f64| 0.1 + (-(theta / 2.0).powi(2)).exp();
        let width = fall(&places, &places.iter().map(lobe).collect::<Vec<_>>());
        assert!((width / (2.0 * std::f64::consts::LN_2.sqrt()) - 1.0).abs() < 0.05, "{width}");
        assert_eq!(fall(&places, &vec![0.3; places.len()]), BROAD_DEG);
        assert_eq!(fall(&places, &vec![0.0; places.len()]), BROAD_DEG);
        let widths = LobeWidths { theta_i_deg: vec![0.0, 60.0], width_deg: vec![1.0, 2.0] };
        assert!((widths.at(0.0) - 1.0).abs() < 1e-12 && (widths.at(60.0) - 2.0).abs() < 1e-12);
        assert!((LobeWidths::constant(1.0).at(60.0) - 2.0).abs() < 1e-12);
    }
}
