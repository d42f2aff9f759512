//! Directions of light between two planes: rings of inclinations with azimuths.

use std::f64::consts::{FRAC_PI_2, PI};

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;

use super::super::spread::SUMS;
use crate::numerics::quadrature::{Node, Pole, gauss, radial_with};
use crate::{Diffuser, Field};

/// A direction of propagation and its part of the light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// Direction cosines times the index.
    pub beta: Beta,
    /// Part of the light.
    pub weight: f64,
}

/// Light of an inclination that a face returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Ring {
    pub(super) beta: f64,
    /// Fraction of the light of a Lambertian plane.
    pub(super) weight: f64,
    /// Air that it crosses above the medium and back, over 2, mm.
    pub(super) air_mm: f64,
    /// True if its way is many periods.
    pub(super) is_far: bool,
    /// Azimuths in a quadrant.
    pub(super) azimuths: usize,
}

/// Phase of the first order in a panel of inclinations, radians, at level 0.
const PHASE_OF_PANEL: f64 = 8.0;
/// Azimuths of light whose phase does not matter.
const FEWEST: usize = 8;
/// Panels of the disc of air, points of a panel, and most points of a panel of azimuths.
const PANELS: usize = 3;
const POINTS: usize = 8;
const MOST_OF_PANEL: usize = 16;

/// Directions in a medium of light from the whole hemisphere of the air, or towards it: `passes` is the
/// fraction of light that passes as a function of `|beta|`. A higher level has more.
pub fn diffuse_directions(level: u32, passes: impl Fn(f64) -> f64) -> Vec<Direction> {
    let azimuths = 24 << level;
    let mut all = Vec::new();
    for panel in 0..PANELS << level {
        let ends = [panel, panel + 1].map(|end| end as f64 / f64::from((PANELS << level) as u32));
        for node in gauss(ends[0], ends[1], POINTS) {
            let (beta, slope) = towards_rim(node.x);
            let weight = 2.0 * beta * slope * node.weight * passes(beta);
            let ring = Ring { beta, weight, air_mm: 0.0, is_far: false, azimuths };
            let points = self::azimuths(&ring, false);
            all.extend(points.map(|(beta, share)| Direction { beta, weight: weight * share }));
        }
    }
    all
}

/// Azimuths of a quadrant of the light below a diffuser at level 0, in all sums: of uniform light, and of that of a field, which each
/// sum resolves.
const DIFFUSED: usize = 24;
const DIFFUSED_OF_FIELD: usize = 48;

/// Directions in a medium of diffuse light below a diffuser, or of light that leaves through it: those of a sum of this number,
/// below [`Part::SUMS`](super::super::Part::SUMS). Areas of windows have kinks, whose errors scatter from sum to sum.
pub fn diffused_directions(diffuser: &Diffuser, index: f64, level: u32, sum: usize) -> Vec<Direction> {
    diffused(diffuser, index, (level, sum), DIFFUSED)
}

fn diffused(diffuser: &Diffuser, index: f64, (level, sum): (u32, usize), azimuths: usize) -> Vec<Direction> {
    let Diffuser { lobe, regular_fraction, .. } = diffuser;
    let width = if let Lobe::KCorrelation { width } = lobe { *width } else { 1.0 };
    let digits = 6.0 + 3.0 * f64::from(level);
    let more = sum as isize - 1;
    let azimuths = ((azimuths << level) / SUMS).saturating_add_signed(more);
    let mut all = Vec::new();
    for node in radial_with(index, (&[1.0], &[Pole { at: 1.0, off: width }]), digits, more) {
        let straight = if node.x < 1.0 { *regular_fraction } else { 0.0 };
        let leaves = straight + (1.0 - regular_fraction) * lobe.fraction_in_disc(node.x, 1.0);
        let ring = Ring { beta: node.x, weight: 1.0, air_mm: 0.0, is_far: false, azimuths };
        let points = self::azimuths(&ring, false);
        all.extend(points.map(|(beta, share)| Direction { beta, weight: leaves * node.weight * share }));
    }
    all
}

/// The same of the light of a field: its mean over the lobe around each direction.
pub fn diffused_directions_of_field(
    diffuser: &Diffuser,
    field: &Field,
    index: f64,
    level: u32,
    sum: usize,
) -> Vec<Direction> {
    let Diffuser { lobe, regular_fraction, .. } = diffuser;
    let count = 12 << level;
    let place = |k: usize| (k as f64 + 0.5) / count as f64;
    let light = |beta: Beta| if beta.squared() < 1.0 { field.radiance(beta) } else { 0.0 };
    let around = |beta: Beta| -> f64 {
        let all = (0..count * count).map(|k| [place(k % count), place(k / count)]);
        let scattered = all.filter_map(|u| lobe.sample_direction(beta, u)).map(light);
        scattered.sum::<f64>() / (count * count) as f64
    };
    let leaves = |beta: Beta| regular_fraction * light(beta) + (1.0 - regular_fraction) * around(beta);
    let all = diffused(diffuser, index, (level, sum), DIFFUSED_OF_FIELD);
    // Of uniform light, each direction has its own part of the lobe.
    let uniform = |beta: Beta| {
        let straight = if beta.squared() < 1.0 { *regular_fraction } else { 0.0 };
        straight + (1.0 - regular_fraction) * lobe.fraction_in_disc(beta.length(), 1.0)
    };
    let of_field = |Direction { beta, weight }: Direction| {
        let uniform = uniform(beta);
        Direction { beta, weight: if uniform > 0.0 { weight * leaves(beta) / uniform } else { 0.0 } }
    };
    all.into_iter().map(of_field).collect()
}

/// `|beta|` from 0 to 1, dense at 1, where the transmittance ends as a square root; and its derivative.
fn towards_rim(v: f64) -> (f64, f64) {
    let rest = 1.0 - v;
    (1.0 - rest * rest, 2.0 * rest)
}

/// Directions of a ring with their fractions: Gaussian rules in each quadrant, because windows have edges
/// along x and y. `mirrored`: only those above the x axis.
pub(super) fn azimuths(ring: &Ring, mirrored: bool) -> impl Iterator<Item = (Beta, f64)> + use<> {
    let radius = ring.beta;
    let quadrants = if mirrored { 2 } else { 4 };
    let panels = ring.azimuths.div_ceil(MOST_OF_PANEL);
    let points = ring.azimuths.div_ceil(panels);
    (0..quadrants * panels).flat_map(move |panel| {
        let [from, to] = [panel, panel + 1].map(|end| FRAC_PI_2 * end as f64 / panels as f64);
        gauss(from, to, points).map(move |node: Node| {
            let (sin, cos) = node.x.sin_cos();
            let share = node.weight / (FRAC_PI_2 * quadrants as f64);
            (Beta { x: radius * cos, y: radius * sin }, share)
        })
    })
}

/// Rings of the light of a Lambertian plane that a face returns; `way` is the way to the face and back per
/// tangent of the inclination, in periods.
pub(super) fn return_rings(
    index: f64,
    way: f64,
    (level, is_plane): (u32, bool),
    face: &dyn Fn(f64) -> f64,
) -> Vec<Ring> {
    // Beyond this phase of the first order, where light returns does not depend on where it left.
    let finer = f64::from(1 + level);
    let farthest = farthest(level, is_plane);
    let rate = 2.0 * PI * way;
    let panel_phase = PHASE_OF_PANEL / finer;
    let area = index * index;
    let mut rings = Vec::new();
    let mut add = |beta: f64, weight: f64| {
        let phase = rate * beta / (area - beta * beta).max(1e-12).sqrt();
        let is_far = phase > farthest;
        let azimuths = if is_far { FEWEST } else { FEWEST + (0.6 * finer * phase) as usize };
        if weight != 0.0 {
            rings.push(Ring { beta, weight, air_mm: 0.0, is_far, azimuths });
        }
    };
    let rim = 1.0 / (area - 1.0).max(1e-12).sqrt();
    let panels = 2 + ((rate * rim).min(farthest) / panel_phase).ceil() as usize;
    for panel in 0..panels {
        let ends = [panel, panel + 1].map(|end| end as f64 / panels as f64);
        for node in gauss(ends[0], ends[1], POINTS) {
            let (beta, slope) = towards_rim(node.x);
            add(beta, 2.0 * beta * slope * node.weight / area * face(beta));
        }
    }
    // Total reflection, by the tangent of the inclination as far as the phase matters, and by the inclination
    // beyond.
    let end = (farthest / rate).max(rim);
    let panels = (rate * (end - rim) / panel_phase).ceil() as usize;
    for panel in 0..panels {
        let at = |k: usize| rim + (end - rim) * k as f64 / panels as f64;
        for node in gauss(at(panel), at(panel + 1), POINTS) {
            let beta = index * node.x / (1.0 + node.x * node.x).sqrt();
            add(beta, 2.0 * node.x / (1.0 + node.x * node.x).powi(2) * node.weight);
        }
    }
    for node in gauss(end.atan(), FRAC_PI_2, 2 * POINTS) {
        let (sin, cos) = node.x.sin_cos();
        add(index * sin, 2.0 * sin * cos * node.weight);
    }
    rings
}

/// Phase of the first order beyond which light returns anywhere.
fn farthest(level: u32, is_plane: bool) -> f64 {
    let most = if is_plane { 30.0 } else { 40.0 };
    most * (1.0 + 0.5 * f64::from(level))
}

/// Rings of the light that a front above the face returns: `weight` is the fraction of it at `|beta|`,
/// `lengths_mm` are the medium and the air on half of the way, `period_mm` the shortest period.
pub(super) fn front_rings(
    index: f64,
    (lengths_mm, period_mm): ([f64; 2], f64),
    (level, is_plane): (u32, bool),
    weight: impl Fn(f64) -> f64,
) -> Vec<Ring> {
    let phase = |beta: f64| {
        let medium = lengths_mm[0] * beta / (index * index - beta * beta).sqrt();
        let air = lengths_mm[1] * beta / (1.0 - beta * beta).max(1e-30).sqrt();
        4.0 * PI * (medium + air) / period_mm
    };
    let (finer, farthest) = (f64::from(1 + level), farthest(level, is_plane));
    // |beta| = sin x: up to the phase that matters, and beyond.
    let (mut near, mut far) = (0.0, FRAC_PI_2);
    for _ in 0..50 {
        let middle: f64 = 0.5 * (near + far);
        *(if phase(middle.sin()) < farthest { &mut near } else { &mut far }) = middle;
    }
    let count = 1 + (farthest * finer / PHASE_OF_PANEL).ceil() as usize;
    let ends =
        (0..=count).map(|k| near * k as f64 / count as f64).chain([0.5 * (near + FRAC_PI_2), FRAC_PI_2]);
    let ends: Vec<f64> = ends.collect();
    let ring = |node: Node| {
        let (beta, cos) = node.x.sin_cos();
        let phase = phase(beta);
        let is_far = phase > farthest;
        let azimuths = if is_far { FEWEST } else { FEWEST + (0.6 * finer * phase) as usize };
        let weight = 2.0 * beta * cos * node.weight / (index * index) * weight(beta);
        Ring { beta, weight, air_mm: lengths_mm[1], is_far, azimuths }
    };
    ends.windows(2)
        .flat_map(|pair| gauss(pair[0], pair[1], POINTS))
        .map(ring)
        .filter(|ring| ring.weight > 0.0)
        .collect()
}
