//! The eye at its place: each part of a panel is seen in its own direction.
//!
//! **What.** The eye is at `viewer.distance_mm` from the middle of the panel, along the view. The picture is computed in the directions of
//! three times three places of the panel (its middle, the middles of its sides and its corners), and is a polynomial of second degree of the
//! place in between.
//!
//! **Error.** The difference of the colours of pages from the polynomial in two directions between these places. Mirror images of small lamps in
//! a flat face may be narrower than that: they are not resolved.

use super::ImageSettings;
use super::held::Lit;
use super::stack::{self, Seen};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::{AngleMedium, Scene};

/// Angle between the directions of two opposite sides, degrees, below which the panel is seen in one direction.
const ONE_DIRECTION_DEG: f64 = 1.0;

/// Places of the polynomial along an axis, from -1 to 1.
const PLACES: [f64; 3] = [-1.0, 0.0, 1.0];

/// Places at which it is compared with pages.
const BETWEEN: [[f64; 2]; 2] = [[0.5, 0.5], [-0.5, -0.5]];

/// An eye before a panel.
pub(super) struct Eye {
    /// Half of the width and height of the panel, to the middles of the outermost pixels, mm.
    half_mm: [f64; 2],
    /// Place of the eye: to the right, upwards, and above the panel, mm.
    at_mm: [f64; 3],
}

impl Eye {
    /// The eye of a scene; `None` if it sees all of the panel in one direction, or the size of the pixels is not known.
    pub(super) fn before(scene: &Scene, size: [usize; 2]) -> Option<Self> {
        let pitch_mm = scene.display.matrix.as_ref()?.pitch_mm;
        let (theta, phi) =
            (scene.viewer.theta_deg.first()?.to_radians(), scene.viewer.phi_deg.first()?.to_radians());
        let distance = scene.viewer.distance_mm;
        let direction = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
        let half_mm = [0, 1].map(|k| 0.5 * (size[k] - 1) as f64 * pitch_mm[k]);
        let eye = Self { half_mm, at_mm: direction.map(|part| distance * part) };
        let span_deg = 2.0 * (half_mm[0].max(half_mm[1]) / distance).atan().to_degrees();
        (scene.solver.angle_medium == AngleMedium::Air && span_deg > ONE_DIRECTION_DEG).then_some(eye)
    }

    /// The scene as it is seen from a place of the panel, whose sides are at -1 and 1.
    fn scene(&self, scene: &Scene, [x, y]: [f64; 2]) -> Scene {
        let [dx, dy] = [self.at_mm[0] - x * self.half_mm[0], self.at_mm[1] - y * self.half_mm[1]];
        let mut there = scene.clone();
        if [x, y] != [0.0; 2] {
            there.viewer.theta_deg = vec![dx.hypot(dy).atan2(self.at_mm[2]).to_degrees()];
            there.viewer.phi_deg = vec![dy.atan2(dx).to_degrees()];
        }
        there
    }

    /// What the reader sees of a picture of states.
    pub(super) fn seen(
        &self,
        scene: &Scene,
        picture: ([usize; 2], &[u8]),
        settings: &ImageSettings,
        control: &Control<'_>,
    ) -> Result<Seen, DisplayError> {
        let mut prepared = Prepared::new(scene)?;
        let (size, states) = picture;
        let mut all = Seen { pixels: vec![[0.0; 3]; states.len()], error: 0.0, neighbours_light: false };
        let [columns, rows] = [0, 1].map(|k| shares_along(size[k]));
        let mut off: [Vec<[f64; 3]>; 2] = [Vec::new(), Vec::new()];
        for (row, y) in PLACES.into_iter().enumerate() {
            for (column, x) in PLACES.into_iter().enumerate() {
                let there = self.scene(scene, [x, y]);
                let lit = Lit::new(&there, settings, &mut prepared, control)?;
                let pages = lit.palette.pages();
                for (off, at) in off.iter_mut().zip(BETWEEN) {
                    off.resize(pages.len(), [0.0; 3]);
                    let share = shares(at[0])[column] * shares(at[1])[row];
                    off.iter_mut().zip(&pages).for_each(|(sum, page)| {
                        (0..3).for_each(|k| sum[k] += share * page[k]);
                    });
                }
                let seen = stack::seen(&there, picture, &lit.palette, settings.surround, control)?;
                all.error = all.error.max(seen.error);
                all.neighbours_light |= seen.neighbours_light;
                let lines = all.pixels.chunks_exact_mut(size[0]).zip(seen.pixels.chunks_exact(size[0]));
                // Rows of pictures begin at the top.
                for ((line, part), along_y) in lines.zip(rows.iter().rev()) {
                    for ((pixel, part), along_x) in line.iter_mut().zip(part).zip(&columns) {
                        let share = along_x[column] * along_y[row];
                        (0..3).for_each(|k| pixel[k] += share * part[k]);
                    }
                }
            }
        }
        let mut largest = 0.0_f64;
        for (polynomial, at) in off.iter().zip(BETWEEN) {
            let lit = Lit::new(&self.scene(scene, at), settings, &mut prepared, control)?;
            let pairs = polynomial.iter().flatten().zip(lit.palette.pages().into_iter().flatten());
            largest = pairs.map(|(one, other)| (one - other).abs()).fold(largest, f64::max);
        }
        all.error += largest;
        Ok(all)
    }
}

/// Colours of pages.
/// Shares of the three places at a place between -1 and 1 (Lagrange).
fn shares(at: f64) -> [f64; 3] {
    [0.5 * at * (at - 1.0), 1.0 - at * at, 0.5 * at * (at + 1.0)]
}

/// Shares at each of a number of pixels.
fn shares_along(pixels: usize) -> Vec<[f32; 3]> {
    let at = |k: usize| 2.0 * k as f64 / (pixels - 1).max(1) as f64 - 1.0;
    (0..pixels)
        .map(|k| if pixels == 1 { shares(0.0) } else { shares(at(k)) }.map(|share| share as f32))
        .collect()
}
