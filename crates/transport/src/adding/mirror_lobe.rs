//! Light of a beam that leaves within a small window around its mirror direction, of a display whose surface is weakly rough:
//! what the receptor of a glossmeter accepts.
//!
//! # Method
//! A surface of roughness alpha reflects and refracts a beam into lobes of a width in proportion to alpha. The grid of
//! `layered` covers all directions and resolves the lobes in all of them, so that its work grows as a power of
//! 1/alpha. Near the mirror direction few directions count. Of the light that the window accepts,
//!
//! `F = R + T B T + T B (R' B) T + T B (R' B)^2 T + ...`,
//!
//! with the surface's reflection R from above and R' from below, its refraction T, and the reflectance B of all flat layers below
//! it, R is an integral over the window, and T towards the window one for each direction below. The light below is followed in two
//! rules of polar coordinates around the beam: one as narrow as T, for the light that has been refracted, and one as narrow as R',
//! for the light that has been reflected inside. Both rules, and that over the window, are graded towards the peaks of the lobes:
//! the work does not depend on alpha.
//!
//! # Validity
//! The surface is the only scatterer, lies in air above a denser medium, and the base is a mirror. Light that meets several
//! microfacets is left out, except where it is reflected at once: it leaves in all directions, and for alpha up to 0.1 the window
//! would accept less than 1e-4 of it. Light reflected inside by more than 12 widths of the lobe beyond the window is lost: it returns to the
//! window by a second such deviation only.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicBool, Ordering};

use papilio_optics::Beta;
use papilio_optics::rough::{Rough, Side};
use papilio_spectra::StateSpectra;

use super::layered::{refraction_width, rough_surface};
use crate::Stack;
use crate::numerics::quadrature::{Pole, graded};
use crate::skeleton::{Propagation, Ray, Skeleton};

/// Extent of the rules around the beam beyond the window, in widths of their lobe.
const REACH: f64 = 12.0;
/// Orders of inter-reflection at most.
const MOST_ORDERS: usize = 200;
/// Spokes of half a circle for each natural digit.
const SPOKES: f64 = 2.0;
/// Ends of the panels of a spoke, asinh of the distance over the width of the lobe: Gaussian lobes end within some of them.
const PANELS: [f64; 9] = [0.4, 0.8, 1.2, 1.6, 2.0, 2.5, 3.5, 5.0, 7.0];

/// A rectangular window around a direction in the plane of incidence, the plane y = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Window {
    /// Inclination of its middle, radians.
    pub middle: f64,
    /// In the plane of incidence and across, radians from the middle: where the accepted fraction begins to decrease, and where it
    /// ends.
    pub ends: [[f64; 2]; 2],
    /// Largest fraction along both.
    pub most: [f64; 2],
}

impl Window {
    fn fraction(&self, axis: usize, angle: f64) -> f64 {
        let [from, to] = self.ends[axis];
        self.most[axis] * ((to - angle.abs()) / (to - from)).clamp(0.0, 1.0)
    }

    /// Returns the largest distance of its directions from a beam, in direction cosines.
    fn farthest_from(&self, beam: Beta) -> f64 {
        let [in_plane, across] = self.ends.map(|[_, to]| to);
        let corner = |u: f64| {
            let (sin, cos) = across.sin_cos();
            (Beta { x: (self.middle + u).sin() * cos, y: sin } - beam).length()
        };
        corner(in_plane).max(corner(-in_plane))
    }

    /// Returns a rule over the window for an integrand with a peak of this width at `peak`: directions and weights, areas of
    /// direction cosines times the accepted fraction.
    fn rule(&self, peak: Beta, width: f64, digits: f64) -> Vec<(Beta, f64)> {
        let across = peak.y.clamp(-1.0, 1.0).asin();
        let in_plane = (peak.x / across.cos().max(1e-9)).clamp(-1.0, 1.0).asin() - self.middle;
        let horizon = FRAC_PI_2 - self.middle;
        let axis = |axis: usize, at: f64, per_angle: f64, more: &[Pole]| {
            let [from, to] = self.ends[axis];
            let mut poles = vec![Pole { at, off: width / per_angle.max(1e-3) }];
            poles.extend(more);
            graded(-to, to, &[-from, 0.0, from], &poles, digits)
        };
        let end_of_air = [Pole { at: horizon, off: 0.0 }];
        let along = axis(0, in_plane, (self.middle + in_plane).cos(), &end_of_air);
        let beside = axis(1, across, across.cos(), &[]);
        let mut rule = Vec::with_capacity(along.len() * beside.len());
        for u in &along {
            let (sin, cos) = (self.middle + u.x).sin_cos();
            let fraction = self.fraction(0, u.x) * u.weight * cos.max(0.0);
            for a in &beside {
                let (sin_a, cos_a) = a.x.sin_cos();
                let weight = fraction * self.fraction(1, a.x) * a.weight * cos_a * cos_a;
                rule.push((Beta { x: sin * cos_a, y: sin_a }, weight));
            }
        }
        rule
    }
}

/// Whether [`accepted`] applies to a stack.
pub fn applies(stack: &Stack) -> bool {
    rough_surface(stack.in_runs()).is_some()
}

/// Returns the fraction of the light of a beam of this inclination, radians, that the window accepts, for each state and
/// wavelength; to this number of natural digits. Light that a Lambertian base scatters is left out. `None` if the method does not
/// apply ([`applies`]), or `stop` was set.
pub fn accepted(
    stack: &Stack,
    beam: f64,
    window: &Window,
    digits: f64,
    stop: &AtomicBool,
) -> Option<StateSpectra> {
    let stack = stack.in_runs();
    let face = rough_surface(stack)?;
    let beam = Beta { x: beam.sin(), y: 0.0 };
    let (states, bins) = (stack.base().states(), stack.base().bins());
    let mut sum = StateSpectra::zeros(states, bins);
    let at_once = reflected(face, beam, window, digits);
    sum.iter_mut().for_each(|value| *value += at_once);
    // Light below the surface, as often as it has been reflected inside: first in the narrow rule.
    let widths = [refraction_width(face, beam.length()), inside_width(face, beam.length())];
    let reach = window.farthest_from(beam);
    let [narrow, wide] = widths.map(|width| rule(face, beam, (width, reach + REACH * width), digits));
    let lower = |points: &[Point]| Lower::new(stack, face, points, window, digits, stop);
    let (first, further) = (lower(&narrow)?, lower(&wide)?);
    let entered: Vec<f64> = narrow
        .iter()
        .map(|point| point.weight * face.single(Side::Above, beam, Side::Below, point.beta))
        .collect();
    let columns = states * bins;
    let mut light: Vec<f64> =
        (0..narrow.len() * columns).map(|k| entered[k / columns] * first.reflected[k]).collect();
    add_leaving(&light, &first.seen, &mut sum);
    let [onto, between] = [&narrow, &wide].map(|from| inside(face, from, &wide, digits as usize + 7));
    let mut kernel = &onto;
    let mut last = 0.0;
    for order in 0..MOST_ORDERS {
        if stop.load(Ordering::Relaxed) {
            return None;
        }
        light = kernel.pass(&light, columns);
        for (k, value) in light.iter_mut().enumerate() {
            *value *= wide[k / columns].weight * further.reflected[k];
        }
        let added = add_leaving(&light, &further.seen, &mut sum);
        let whole = sum.iter().fold(0.0, |most: f64, value| most.max(*value));
        // A geometric series, whose ratio decreases towards its limit from above.
        let ratio = if order > 0 && last > 0.0 { (added / last).min(0.99) } else { 0.9 };
        if added * ratio / (1.0 - ratio) <= (-digits).exp() * whole {
            break;
        }
        (last, kernel) = (added, &between);
    }
    Some(sum)
}

/// Light that the surface reflects at once, into the window.
fn reflected(face: &Rough, beam: Beta, window: &Window, digits: f64) -> f64 {
    let normal = (1.0 - beam.squared()).max(0.0).sqrt();
    let several = face.several(Side::Above, beam.length())[0];
    let total = face.several_total(Side::Above, Side::Above);
    let one = |(to, weight): (Beta, f64)| {
        let often =
            if total > 0.0 { several * face.several(Side::Above, to.length())[0] / total } else { 0.0 };
        weight * (face.single(Side::Above, beam, Side::Above, to) + often)
    };
    window.rule(beam, 2.0 * face.alpha() * normal, digits).into_iter().map(one).sum()
}

/// Width of the lobe that the surface reflects inside.
fn inside_width(face: &Rough, beta: f64) -> f64 {
    2.0 * face.alpha() * (face.index(Side::Below).powi(2) - beta * beta).max(0.0).sqrt()
}

/// A direction below the surface, in the half y > 0, and its weight, an area of direction cosines.
#[derive(Debug, Clone, Copy)]
struct Point {
    beta: Beta,
    weight: f64,
}

/// Returns a rule for light around a beam, up to this distance from it, in the half y > 0 of the disc of the medium: the other is
/// its mirror image.
fn rule(face: &Rough, beam: Beta, (width, reach): (f64, f64), digits: f64) -> Vec<Point> {
    let radius = face.index(Side::Below);
    let spokes = (SPOKES * digits).ceil() as usize;
    let own = Pole { at: 0.0, off: FRAC_PI_2 };
    let mut points = Vec::new();
    for spoke in 0..spokes {
        let step = PI / spokes as f64;
        let (sin, cos) = (step * (spoke as f64 + 0.5)).sin_cos();
        let leaves = |radius: f64| {
            let inward = beam.x * cos;
            let reaches = inward * inward + radius * radius - beam.squared();
            (reaches.max(0.0).sqrt() - inward).max(0.0)
        };
        let [air, medium] = [1.0, radius].map(|radius| (leaves(radius) / width).asinh());
        let mut breaks = PANELS.to_vec();
        breaks.push(air);
        for node in graded(0.0, medium.min((reach / width).asinh()), &breaks, &[own], digits) {
            let r = width * node.x.sinh();
            let weight = r * width * node.x.cosh() * node.weight * step;
            points.push(Point { beta: Beta { x: beam.x + r * cos, y: r * sin }, weight });
        }
    }
    points
}

/// What becomes of light that goes down from the surface, by point.
struct Lower {
    /// Fraction that returns to the surface; shape `[point][state][wavelength]`.
    reflected: Vec<f64>,
    /// Light towards each point from the whole window, of the surface's refraction.
    seen: Vec<f64>,
}

impl Lower {
    fn new(
        stack: &Stack,
        face: &Rough,
        points: &[Point],
        window: &Window,
        digits: f64,
        stop: &AtomicBool,
    ) -> Option<Self> {
        let base = stack.base();
        let (bins, columns) = (base.bins(), base.states() * base.bins());
        let mut skeleton = Skeleton::new(stack, base);
        let mut field = skeleton.field();
        let (mut reflected, mut seen) = (Vec::with_capacity(points.len() * columns), Vec::new());
        for point in points {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            skeleton.set(stack, base, point.beta);
            skeleton.emit(Ray::from_element(0, Propagation::Down), &mut field);
            let (before, risen) = field.at(Ray::arriving_at(0, Propagation::Up));
            let one =
                |k: usize| before[k % bins % before.len()] + field.rising[k] * risen[k % bins % risen.len()];
            reflected.extend((0..columns).map(one));
            let width = refraction_width(face, point.beta.length().min(1.0));
            let light = |(above, weight): (Beta, f64)| {
                weight * face.single(Side::Above, above, Side::Below, point.beta)
            };
            seen.push(window.rule(point.beta, width, digits).into_iter().map(light).sum());
        }
        Some(Self { reflected, seen })
    }
}

/// Adds the light of both halves that leaves into the window; returns the largest addition.
fn add_leaving(light: &[f64], seen: &[f64], sum: &mut StateSpectra) -> f64 {
    let columns = light.len() / seen.len().max(1);
    let mut added = vec![0.0; columns];
    for (row, seen) in light.chunks(columns.max(1)).zip(seen) {
        added.iter_mut().zip(row).for_each(|(sum, light)| *sum += 2.0 * light * seen);
    }
    sum.iter_mut().zip(&added).for_each(|(sum, added)| *sum += added);
    added.into_iter().fold(0.0, f64::max)
}

/// Reflection inside from some directions to others, for light that is symmetric in y.
struct Inside {
    /// Shape `[to][from]`.
    kernel: Vec<f64>,
    from: usize,
}

/// Returns the reflection of the surface inside. Light of no direction is reflected more than it should be, by a rule of this
/// order: far from the beam the directions are too far apart for the lobe.
fn inside(face: &Rough, from: &[Point], to: &[Point], order: usize) -> Inside {
    let value = |to: &Point, from: &Point| {
        let mirrored = Beta { x: from.beta.x, y: -from.beta.y };
        let both = [from.beta, mirrored].map(|beta| face.single(Side::Below, beta, Side::Below, to.beta));
        both[0] + both[1]
    };
    let mut kernel: Vec<f64> =
        to.iter().flat_map(|to| from.iter().map(move |from| value(to, from))).collect();
    let lengths: Vec<f64> = from.iter().map(|point| point.beta.length()).collect();
    let goals = face.returned(Side::Below, &lengths, order);
    for (k, goal) in goals.iter().enumerate() {
        let found: f64 = to.iter().enumerate().map(|(i, to)| to.weight * kernel[i * from.len() + k]).sum();
        if found > *goal {
            (0..to.len()).for_each(|i| kernel[i * from.len() + k] *= goal / found);
        }
    }
    Inside { kernel, from: from.len() }
}

impl Inside {
    /// Returns the light of each column that arrives; shape `[direction][column]`.
    fn pass(&self, light: &[f64], columns: usize) -> Vec<f64> {
        let mut arrives = vec![0.0; self.kernel.len() / self.from.max(1) * columns];
        for (row, factors) in arrives.chunks_mut(columns).zip(self.kernel.chunks(self.from)) {
            for (light, factor) in light.chunks(columns).zip(factors) {
                row.iter_mut().zip(light).for_each(|(sum, light)| *sum += factor * light);
            }
        }
        arrives
    }
}
