//! The eye at its place: each part of a panel is seen in its own direction.
//!
//! **What.** The eye is at `viewer.distance_mm` from the middle of the panel, along the view. What is seen is
//! computed in the directions of some places of the panel, and is a polynomial of the place in between.
//!
//! **Places.** Those of Chebyshev along each axis (Clenshaw and Curtis), 3 to 33, as many as the colours of
//! pages need. Their error is the largest difference from pages in the directions of the places that would be
//! the next.
//!
//! **Lamps.** Mirror images of round lamps have borders: they are left out of the polynomials, and drawn at
//! their places (`lamps.rs`).

use std::collections::BTreeMap;
use std::f64::consts::PI;

use super::ImageSettings;
use super::chunks::in_rows;
use super::held::Lit;
use super::lamps::lamp_images;
use super::stack::{Layers, Picture, Seen, Several, colours_of_pages};
use crate::DisplayError;
use crate::prepared::Prepared;
use crate::run::Control;
use crate::scene::{AngleMedium, Scene};

/// Angle between the directions of two opposite sides, degrees, below which the panel is seen in one
/// direction.
const ONE_DIRECTION_DEG: f64 = 1.0;

/// Error of the colours of pages, relative to a perfect white, with which places are close enough.
const CLOSE: f64 = 1e-3;

/// Places along an axis, at most, minus 1; a power of 2.
const MOST: usize = 32;

/// An eye before a panel.
pub(super) struct Eye {
    /// Half of the width and height of the panel, to the middles of the outermost pixels, mm.
    half_mm: [f64; 2],
    /// Place of the eye: to the right, upwards, and above the panel, mm.
    at_mm: [f64; 3],
}

impl Eye {
    /// The eye of a scene; `None` if it sees all of the panel in one direction, or the size of the pixels is
    /// not known.
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

    /// From a place of the panel, whose sides are at -1 and 1, to the eye, mm.
    fn towards_eye(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        [self.at_mm[0] - x * self.half_mm[0], self.at_mm[1] - y * self.half_mm[1], self.at_mm[2]]
    }

    /// Direction from a pixel to the eye, of length 1, and half of the angle across the pixel. Rows are
    /// counted from the top.
    pub(super) fn direction(&self, size: [usize; 2], [column, row]: [usize; 2]) -> ([f64; 3], f64) {
        let place = [place(column, size[0]), -place(row, size[1])];
        let towards = self.towards_eye(place);
        let length = towards.iter().map(|part| part * part).sum::<f64>().sqrt();
        let half_pitch = [0, 1].map(|k| self.half_mm[k] / (size[k] - 1).max(1) as f64);
        (towards.map(|part| part / length), half_pitch[0].max(half_pitch[1]) / length)
    }

    /// The scene as it is seen from a place.
    fn scene(&self, scene: &Scene, place: [f64; 2]) -> Scene {
        let mut there = scene.clone();
        if place != [0.0; 2] {
            let [x, y, z] = self.towards_eye(place);
            let viewer = &mut there.viewer;
            let (theta, phi) = (x.hypot(y).atan2(z), y.atan2(x));
            if let (Some(angle_deg), [theta_deg], [phi_deg]) =
                (&mut viewer.polariser_deg, &viewer.theta_deg[..], &viewer.phi_deg[..])
            {
                let middle = [theta_deg, phi_deg].map(|angle| angle.to_radians());
                *angle_deg = turned(angle_deg.to_radians(), middle, [theta, phi]).to_degrees();
            }
            viewer.theta_deg = vec![theta.to_degrees()];
            viewer.phi_deg = vec![phi.to_degrees()];
        }
        there
    }

    /// What the reader sees of a picture of states.
    pub(super) fn seen(
        &self,
        lit: &Lit,
        picture: Picture<'_>,
        settings: &ImageSettings,
        control: &Control<'_>,
    ) -> Result<Seen, DisplayError> {
        let scene = &lit.setup.scene;
        let mut pages = Pages {
            eye: self,
            scene,
            settings,
            control,
            prepared: Prepared::of(lit.setup.clone()),
            known: BTreeMap::new(),
        };
        let from_afar = |error| match error {
            DisplayError::BelowHorizon { theta_deg, .. } => {
                DisplayError::TooClose { distance_mm: scene.viewer.distance_mm, theta_deg }
            }
            other => other,
        };
        let (counts, error) = pages.close_enough().map_err(from_afar)?;
        let mut places = Vec::new();
        for row in 0..=counts[1] {
            for column in 0..=counts[0] {
                places.push([column * (MOST / counts[0]), row * (MOST / counts[1])]);
                pages.at(places[places.len() - 1]).map_err(from_afar)?;
            }
        }
        let known: Vec<&PageThere> = places.iter().map(|place| &pages.known[place]).collect();
        let lit_by: Vec<_> = known.iter().map(|page| (&page.lit.setup, &page.lit.palette)).collect();
        let several = Several { missed: CLOSE, without_lamps: true, by_paths: true };
        let Picture { size, states, .. } = picture;
        let layers = Layers::new(&lit_by, picture, settings.surround, several, &mut None, control)?;
        control.check()?;
        let shares = [0, 1].map(|k| {
            let polynomials = Polynomials::new(counts[k]);
            (0..size[k]).map(move |pixel| polynomials.at(place(pixel, size[k]))).collect::<Vec<Vec<f64>>>()
        });
        let mut pixels = vec![[0.0_f32; 3]; states.len()];
        // Weights of a picture at the places along a row, of which the first is at the top.
        let along_row = |row: usize, number: usize| -> Vec<f32> {
            let along_y = &shares[1][size[1] - 1 - row];
            let at = |column: usize| {
                let of_row = |(row, share): (usize, &f64)| {
                    share * layers.mixtures()[row * (counts[0] + 1) + column][number]
                };
                along_y.iter().enumerate().map(of_row).sum::<f64>() as f32
            };
            (0..=counts[0]).map(at).collect()
        };
        let along_x: Vec<Vec<f32>> =
            shares[0].iter().map(|shares| shares.iter().map(|share| *share as f32).collect()).collect();
        let weight = |along_row: &[f32], column: usize| -> f32 {
            along_row.iter().zip(&along_x[column]).map(|(sum, share)| sum * share).sum()
        };
        if let Some((states, colours)) = layers.pages() {
            in_rows(control.thread_count(), &mut pixels, size[0], |row, line| {
                let states = &states[row * size[0]..][..size[0]];
                for (number, colours) in colours.iter().enumerate() {
                    let along_row = along_row(row, number);
                    for (column, (pixel, state)) in line.iter_mut().zip(states).enumerate() {
                        let (weight, part) = (weight(&along_row, column), colours[usize::from(*state)]);
                        (0..3).for_each(|k| pixel[k] += weight * part[k]);
                    }
                }
            });
        } else {
            layers.each(|number, part| {
                let lines = pixels.chunks_exact_mut(size[0]).zip(part.chunks_exact(size[0]));
                for (row, (line, part)) in lines.enumerate() {
                    let along_row = along_row(row, number);
                    for (column, (pixel, part)) in line.iter_mut().zip(part).enumerate() {
                        let weight = weight(&along_row, column);
                        (0..3).for_each(|k| pixel[k] += weight * part[k]);
                    }
                }
            });
        }
        // Between places that are too far apart, a polynomial may be negative.
        pixels.iter_mut().flatten().for_each(|value| *value = value.max(0.0));
        let names = known[0].lit.palette.names();
        for lamp in lamp_images(&lit.setup, &names) {
            lamp.add(self, (size, states), 0.5 * scene.viewer.field_deg, &mut pixels);
        }
        let neighbours_light = layers.have_neighbours_light();
        Ok(Seen { pixels, error: layers.error() + error, between_places: error, neighbours_light })
    }
}

/// Colours of pages in the directions of places.
struct Pages<'a> {
    eye: &'a Eye,
    scene: &'a Scene,
    settings: &'a ImageSettings,
    control: &'a Control<'a>,
    prepared: Prepared,
    /// By the numbers of the places along x and y.
    known: BTreeMap<[usize; 2], PageThere>,
}

/// The part of the progress that is a page, by its number from 0; how many there will be is not known. The
/// first grid has 9.
fn part_of_page(number: usize) -> [f64; 2] {
    [number, number + 1].map(|pages| pages as f64 / (pages as f64 + 9.0))
}

/// Pages in one direction.
struct PageThere {
    lit: Lit,
    /// X, Y and Z of each state, without the images of lamps.
    colours: Vec<[f64; 3]>,
}

impl Pages<'_> {
    /// Computes the pages at a place.
    fn at(&mut self, at: [usize; 2]) -> Result<&PageThere, DisplayError> {
        if !self.known.contains_key(&at) {
            let scene = self.eye.scene(self.scene, at.map(|k| chebyshev(k, MOST)));
            let lit = self.control.within(part_of_page(self.known.len()), |control| {
                Lit::new(&scene, self.settings, &mut self.prepared, control)
            })?;
            let colours = colours_of_pages(&lit.setup, &lit.palette, true);
            self.known.insert(at, PageThere { lit, colours });
        }
        Ok(&self.known[&at])
    }

    /// Number of places along each axis, minus 1, and the error of pages between them.
    fn close_enough(&mut self) -> Result<([usize; 2], f64), DisplayError> {
        let mut counts = [2; 2];
        let mut errors = [0.0; 2];
        for axis in 0..2 {
            loop {
                errors[axis] = self.error_along(axis, counts[axis])?;
                if errors[axis] <= CLOSE || 2 * counts[axis] >= MOST {
                    break;
                }
                counts[axis] *= 2;
            }
        }
        Ok((counts, errors[0] + errors[1]))
    }

    /// Largest difference of pages from the polynomial through `count + 1` places along an axis, at the
    /// places that would be the next, at the sides and in the middle of the other axis.
    fn error_along(&mut self, axis: usize, count: usize) -> Result<f64, DisplayError> {
        let polynomials = Polynomials::new(count);
        let mut largest = 0.0_f64;
        for across in [0, MOST / 2, MOST] {
            let place = |k: usize| if axis == 0 { [k, across] } else { [across, k] };
            let step = MOST / count;
            let mut nodes = Vec::new();
            for node in 0..=count {
                nodes.push(self.at(place(node * step))?.colours.clone());
            }
            for between in 0..count {
                let at = between * step + step / 2;
                let shares = polynomials.at(chebyshev(at, MOST));
                let there = &self.at(place(at))?.colours;
                for (state, colour) in there.iter().enumerate() {
                    for (k, value) in colour.iter().enumerate() {
                        let sum: f64 =
                            shares.iter().zip(&nodes).map(|(share, node)| share * node[state][k]).sum();
                        largest = largest.max((sum - value).abs());
                    }
                }
            }
        }
        Ok(largest)
    }
}

/// Polynomials through the places of Chebyshev (barycentric formula; Berrut and Trefethen, SIAM Rev. 46, 501
/// (2004)).
struct Polynomials {
    nodes: Vec<f64>,
}

impl Polynomials {
    /// Through `count + 1` places.
    fn new(count: usize) -> Self {
        Self { nodes: (0..=count).map(|k| chebyshev(k, count)).collect() }
    }

    /// Shares of the places at a place between -1 and 1.
    fn at(&self, at: f64) -> Vec<f64> {
        if let Some(here) = self.nodes.iter().position(|node| (node - at).abs() < 1e-12) {
            return (0..self.nodes.len()).map(|k| f64::from(u8::from(k == here))).collect();
        }
        let last = self.nodes.len() - 1;
        let weight = |(k, node): (usize, &f64)| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let half = if k == 0 || k == last { 0.5 } else { 1.0 };
            sign * half / (at - node)
        };
        let weights: Vec<f64> = self.nodes.iter().enumerate().map(weight).collect();
        let sum: f64 = weights.iter().sum();
        weights.into_iter().map(|weight| weight / sum).collect()
    }
}

/// Place number `k` of Chebyshev, from -1 (0) to 1 (`count`).
fn chebyshev(k: usize, count: usize) -> f64 {
    if 2 * k == count { 0.0 } else { -(PI * k as f64 / count as f64).cos() }
}

/// The angle that a polariser has in another view, from its plane of incidence, if it does not turn with the view.
fn turned(angle: f64, from: [f64; 2], to: [f64; 2]) -> f64 {
    // Unit vectors in the plane of incidence and across it, counter-clockwise as seen by the viewer.
    let vectors = |[theta, phi]: [f64; 2]| {
        let [(sin, cos), (sin_phi, cos_phi)] = [theta.sin_cos(), phi.sin_cos()];
        [[cos * cos_phi, cos * sin_phi, -sin], [-sin_phi, cos_phi, 0.0]]
    };
    let [[p, s], there] = [vectors(from), vectors(to)];
    let axis: [f64; 3] = std::array::from_fn(|k| angle.cos() * p[k] + angle.sin() * s[k]);
    let [along, across] = there.map(|one| one.iter().zip(axis).map(|(a, b)| a * b).sum::<f64>());
    across.atan2(along)
}

/// Place of the middle of a pixel, from -1 to 1.
fn place(pixel: usize, pixels: usize) -> f64 {
    if pixels == 1 { 0.0 } else { 2.0 * pixel as f64 / (pixels - 1) as f64 - 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn polynomials_are_exact_for_polynomials() {
        let of = |x: f64| 1.0 - 2.0 * x + 0.5 * x.powi(3) - 3.0 * x.powi(4);
        let polynomials = Polynomials::new(4);
        for at in [-1.0, -0.93, -0.2, 0.0, 0.41, 1.0] {
            let sum: f64 = polynomials
                .at(at)
                .iter()
                .zip(&polynomials.nodes)
                .map(|(share, node)| share * of(*node))
                .sum();
            assert!((sum - of(at)).abs() < 1e-12, "{at}: {sum}");
        }
    }
}
