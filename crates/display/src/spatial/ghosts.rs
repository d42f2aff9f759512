//! Mirror-like pixels under a flat face: a sharp image, and fainter ones that the face and the pixel reflect
//! between each other.
//!
//! Each direction of the field of view has ghosts at places of its own, relative to its own ray.
//!
//! Direction is conserved, so that image k is shifted by k times 2 D. For a small signal about a state of
//! reflectance rho under a face of reflectance F, image k has (F rho)^k of the light of the first: of each wavelength, and of s and of p.
//!
//! A front of screen above an air gap returns light, too, after one or more trips through the air: images at
//! sums of both shifts.
//!
//! The images of a pattern multiply: light of order k has met the pixel at k + 1 places, each 2 D from the
//! one before. Lines, text and patterns are computed so; their light is not that of the spread, which holds for
//! small signals. The mean of a pattern over a period depends on the view: a moire of the panel with itself.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_optics::Beta;
use papilio_transport::spatial::{Cells, Peak, displacement, fraction_of_order, orders_between};

use super::irradiance::irradiance;
use super::patterns::{Pattern, Text};
use super::response::Lit;
use super::{Level, PatternKind, Response};
use crate::DisplayError;

/// Images that are weaker than this fraction of all light are left out.
const FAINTEST: f64 = 1e-9;

/// Most orders of the mean of stripes and of checkerboards with exact edges: those of pixels that return 0.96
/// or 0.81 of the light with the face. Brighter ones are divided into cells.
const MOST_ORDERS: [usize; 2] = [500, 100];

/// Light of which less than this fraction is left has met the page far away.
const FAR: f64 = 1e-7;

/// Most trips through the glass of light whose places are followed, without and with trips through the air.
const MOST_FOLLOWED: [usize; 2] = [500, 60];

/// Width of an image, as a fraction of the thickness, for positions of tables: images are sharp.
const SHARP: f64 = 1e-3;

/// Natural digits of a wide field of view.
const MOST_DIGITS: f64 = 11.0;

/// Images of a wide field that are fainter than this fraction of the brightest one are no sharp images.
const SHARP_LIGHT: f64 = 1e-2;

pub(super) struct Ghosts {
    /// Place of each image, mm, and its light by state.
    images: Vec<GhostImage>,
    states: usize,
    thickness_mm: f64,
    trips: Vec<RoundTrips>,
    /// Whether the field of view has several directions: each shows ghosts at places of its own.
    is_wide: bool,
}

/// Round trips of light between pixel and face, of wavelengths with the same places.
struct RoundTrips {
    /// Distance between meetings, mm.
    step_mm: [f64; 2],
    /// Shift of a trip through the air above the face, mm.
    air_mm: [f64; 2],
    bins: Vec<RoundTrip>,
}

/// Round trips at one wavelength.
struct RoundTrip {
    /// Part of Y that a pixel of reflectance 1 would return to first order, by the state that is seen: a field of
    /// view has a mean of each.
    through: Vec<f64>,
    face: Faces,
    /// Reflectance of each state.
    pixel: Vec<f64>,
}

/// Response of a bare panel, which is `lit`, to light of parts of which each has its own: `via_pixel` is the light that its pixel
/// returns, `[state][wavelength]`.
pub(super) fn response<'a>(
    lit: Lit<'_>,
    parts: impl Iterator<Item = (Lit<'a>, &'a [f64])>,
    weights: &[f64],
) -> Result<Ghosts, DisplayError> {
    let mut ghosts = Ghosts {
        images: Vec::new(),
        states: lit.panel.base.states(),
        thickness_mm: lit.thickness_mm(),
        trips: Vec::new(),
        is_wide: false,
    };
    let mut y = vec![0.0; ghosts.states];
    for (lit, via_pixel) in parts {
        ghosts.add(lit, weights, via_pixel)?;
        for (y, row) in y.iter_mut().zip(via_pixel.chunks_exact(weights.len())) {
            *y += row.iter().zip(weights).map(|(light, weight)| light * weight).sum::<f64>();
        }
    }
    // The response has the shape of the spread, whose light is Y.
    for (state, y) in y.into_iter().enumerate() {
        let all: f64 = ghosts.images.iter().map(|(_, light)| light[state]).sum();
        let scale = if all > 0.0 { y / all } else { 0.0 };
        ghosts.images.iter_mut().for_each(|(_, light)| light[state] *= scale);
    }
    Ok(ghosts)
}

impl Ghosts {
    /// Adds the light of a part.
    fn add(&mut self, lit: Lit<'_>, weights: &[f64], via_pixel: &[f64]) -> Result<(), DisplayError> {
        let Lit { panel, view, level, .. } = lit;
        let (index, thickness_mm, air_mm) = (panel.medium.index(), lit.thickness_mm(), lit.air_mm()?);
        // Ghosts are faint: fewer digits.
        let per_beta = 2.0 * (thickness_mm / (index.min() * index.min() - 1.0).max(0.1).sqrt() + air_mm);
        let phase = 2.0 * PI * level.most_per_mm * per_beta * view.field.half_angle();
        let directions = view.field.directions(phase, level.digits.min(MOST_DIGITS));
        // What pixels return in each direction of the field, and in its mean.
        let mut mean = vec![0.0; via_pixel.len()];
        for (beta, share) in &directions {
            let returned = returned_along(lit, *beta);
            mean.iter_mut().zip(returned).for_each(|(mean, returned)| *mean += share * returned);
        }
        let through = |(at, mean): (usize, &f64)| {
            if *mean > 0.0 { weights[at % weights.len()] * via_pixel[at] / mean } else { 0.0 }
        };
        let through: Vec<f64> = mean.iter().enumerate().map(through).collect();
        for (beta, share) in &directions {
            add_direction(lit, (*beta, *share), &through, (&mut self.trips, &mut self.images))?;
        }
        self.is_wide |= directions.len() > 1;
        Ok(())
    }
}

/// Place of an image, mm, and the light of each state in it.
type GhostImage = ([f64; 2], Vec<f64>);

/// Reflectance of the pixel along a direction, `[state][wavelength]`.
fn reflectance_along(lit: Lit<'_>, beta: Beta) -> Vec<f64> {
    let base = &lit.panel.base;
    let mut reflectance = vec![0.0; base.states() * base.bins()];
    base.reflectance(beta.squared(), &lit.panel.medium, &mut reflectance);
    reflectance
}

/// What a uniform pixel returns along a direction through all orders, relative to light that meets it for the
/// first time, `[state][wavelength]`.
fn returned_along(lit: Lit<'_>, beta: Beta) -> Vec<f64> {
    let mut returned = reflectance_along(lit, beta);
    let bins = lit.panel.base.bins();
    let by_faces: Vec<f64> =
        (0..bins).map(|bin| Faces::new(lit.faces(bin, beta), false).returned()).collect();
    for row in returned.chunks_exact_mut(bins) {
        row.iter_mut().zip(&by_faces).for_each(|(rho, face)| *rho /= 1.0 - face * *rho);
    }
    returned
}

/// Adds what is seen along a direction of the field, which has this share of its light; `through`: the part of Y
/// of a pixel that returns all light, `[state][wavelength]`. Places are relative to its own ray.
fn add_direction(
    lit: Lit<'_>,
    (beta, share): (Beta, f64),
    through: &[f64],
    (trips, images): (&mut Vec<RoundTrips>, &mut Vec<GhostImage>),
) -> Result<(), DisplayError> {
    let panel = lit.panel;
    let (states, bins) = (panel.base.states(), panel.base.bins());
    let (reflectance, returned) = (reflectance_along(lit, beta), returned_along(lit, beta));
    let index = panel.medium.index();
    let (thickness_mm, air_mm) = (lit.thickness_mm(), displacement(beta, 2.0 * lit.air_mm()?, 1.0));
    let trip = |bin: usize| {
        let face = Faces::new(lit.faces(bin, beta), air_mm != [0.0; 2]);
        let of_states = |values: &[f64]| (0..states).map(|state| values[state * bins + bin]).collect();
        let through: Vec<f64> = of_states(through);
        RoundTrip {
            through: through.iter().map(|part| share * part).collect(),
            face,
            pixel: of_states(&reflectance),
        }
    };
    // Wavelengths of the same index have the same places.
    let mut bin = 0;
    while bin < bins {
        let same = (bin..bins).take_while(|other| index[*other] == index[bin]).count();
        let step = displacement(beta, thickness_mm, index[bin]).map(|shift| 2.0 * shift);
        let trip = RoundTrips { step_mm: step, air_mm, bins: (bin..bin + same).map(trip).collect() };
        // Response of each state in the images of a number of trips through the glass, by the number of those
        // through the air.
        let leaving = |trip: &RoundTrip| vec![trip.face.leaving.clone(); states];
        let mut rows: Vec<Vec<Vec<f64>>> = trip.bins.iter().map(leaving).collect();
        for order in 0.. {
            let count = rows.iter().flatten().map(Vec::len).max().unwrap_or(0);
            let mut any = false;
            for air in 0..count {
                let of_state = |state: usize| -> f64 {
                    let row = rows.iter().zip(bin..);
                    let one = |(row, bin): (&Vec<Vec<f64>>, usize)| {
                        let at = state * bins + bin;
                        share * through[at] * returned[at] * row[state].get(air).copied().unwrap_or(0.0)
                    };
                    row.map(one).sum()
                };
                let light: Vec<f64> = (0..states).map(of_state).collect();
                if order + air > 0 && light.iter().all(|light| light.abs() <= FAINTEST) {
                    continue;
                }
                any = true;
                let place = [0, 1].map(|k| order as f64 * step[k] + air as f64 * air_mm[k]);
                // All directions see their own ray at the same place.
                match images.first_mut().filter(|(first, _)| *first == [0.0; 2] && place == [0.0; 2]) {
                    Some((_, sum)) => sum.iter_mut().zip(light).for_each(|(sum, light)| *sum += light),
                    None => images.push((place, light)),
                }
            }
            if !any {
                break;
            }
            for (row, trip) in rows.iter_mut().zip(&trip.bins) {
                row.iter_mut()
                    .zip(&trip.pixel)
                    .for_each(|(row, rho)| *row = trip.face.returned_of(row, *rho));
            }
        }
        trips.push(RoundTrips { bins: merged(trip.bins), ..trip });
        bin += same;
    }
    Ok(())
}

/// Wavelengths that follow each other with the same face and pixel as one.
fn merged(all: Vec<RoundTrip>) -> Vec<RoundTrip> {
    let mut merged: Vec<RoundTrip> = Vec::new();
    for one in all {
        match merged.last_mut().filter(|last| last.face == one.face && last.pixel == one.pixel) {
            Some(last) => last.through.iter_mut().zip(one.through).for_each(|(sum, more)| *sum += more),
            None => merged.push(one),
        }
    }
    merged
}

/// What a face, and a front above it, return to the pixel and let through, by the number of trips through the
/// air between them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Faces {
    pub(super) returned: Vec<f64>,
    pub(super) leaving: Vec<f64>,
}

impl Faces {
    /// `is_apart`: whether light moves in the air between them.
    pub(super) fn new([face, front]: [f64; 2], is_apart: bool) -> Self {
        let between = face * front;
        let by_front = (1.0 - face).powi(2) * front;
        if !is_apart || by_front == 0.0 {
            return Self { returned: vec![face + by_front / (1.0 - between)], leaving: vec![1.0] };
        }
        let count = orders_between(between, FAINTEST);
        let leaving: Vec<f64> = (0..count).map(|k| fraction_of_order(between, k, count)).collect();
        let scale = by_front / (1.0 - between);
        let returned = std::iter::once(face).chain(leaving.iter().map(|part| scale * part)).collect();
        Self { returned, leaving }
    }

    /// Fraction of uniform light that comes back.
    pub(super) fn returned(&self) -> f64 {
        self.returned.iter().sum()
    }

    /// Light, by trips through the air, that is reflected by the pixel and comes back.
    fn returned_of(&self, light: &[f64], rho: f64) -> Vec<f64> {
        let mut sums = vec![0.0; light.len() + self.returned.len() - 1];
        for (k, light) in light.iter().enumerate() {
            for (j, part) in self.returned.iter().enumerate() {
                sums[k + j] += rho * light * part;
            }
        }
        while sums.len() > 1 && sums.last().is_some_and(|last| *last < 0.1 * FAINTEST) {
            sums.pop();
        }
        sums
    }
}

impl RoundTrips {
    /// Mean over a period of a pattern.
    fn mean(&self, pattern: Pattern, level: Level) -> f64 {
        let [on, off] = pattern.states;
        if self.bins.iter().any(|trip| trip.face.returned.len() > 1) {
            return self.mean_of_cells(pattern, level);
        }
        let rounds = self.bins.iter().map(|trip| trip.face.returned() * trip.pixel[on].max(trip.pixel[off]));
        let most = rounds.fold(0.0_f64, f64::max);
        // Light of later orders is less than the faintest image.
        let orders = if most > 0.0 { (FAINTEST.ln() / most.min(0.999).ln()).ceil() as usize } else { 0 };
        if orders > MOST_ORDERS[usize::from(pattern.kind == PatternKind::Checkerboard)] {
            return self.mean_of_cells(pattern, level);
        }
        let shift = |axis: usize, order: usize| order as f64 * self.step_mm[axis] / pattern.period_mm;
        let pieces = |axis: usize| -> Vec<(f64, f64)> {
            let along = axis == 0 || pattern.kind == PatternKind::Checkerboard;
            let edges = (0..=orders).flat_map(|order| [0.0, 0.5].map(|edge| edge + shift(axis, order)));
            let mut edges: Vec<f64> = edges.filter(|_| along).map(|edge| edge.rem_euclid(1.0)).collect();
            edges.extend([0.0, 1.0]);
            edges.sort_by(f64::total_cmp);
            edges.windows(2).map(|pair| (0.5 * (pair[0] + pair[1]), pair[1] - pair[0])).collect()
        };
        let second = |axis: usize, at: f64, order: usize| (at - shift(axis, order)).rem_euclid(1.0) >= 0.5;
        let mut sum = 0.0;
        for (y, height) in pieces(1) {
            for (x, width) in pieces(0).into_iter().filter(|(_, width)| width * height > 0.0) {
                let state = |order: usize| {
                    let across = pattern.kind == PatternKind::Checkerboard && second(1, y, order);
                    if second(0, x, order) == across { on } else { off }
                };
                let states: Vec<usize> = (0..=orders).map(state).collect();
                sum += width * height * self.bins.iter().map(|trip| trip.light(&states)).sum::<f64>();
            }
        }
        sum
    }
}

impl RoundTrips {
    /// Mean over a period below a front apart from the face: trips of different lengths. A period is divided
    /// into cells with edges along those of the pattern.
    fn mean_of_cells(&self, pattern: Pattern, level: Level) -> f64 {
        let Pattern { kind, period_mm, states: [on, off] } = pattern;
        let across = match (kind, level.is_fine) {
            (PatternKind::Stripes, true) => 512,
            (PatternKind::Stripes, false) | (PatternKind::Checkerboard, true) => 128,
            (PatternKind::Checkerboard, false) => 64,
        };
        let rows = if kind == PatternKind::Stripes { 1 } else { across };
        let is_on: Vec<bool> = (0..across * rows)
            .map(|cell| (cell % across < across / 2) == (cell / across * 2 < across))
            .collect();
        let (cells, mut sum) = (Cells { count: [across, rows], period_mm: [period_mm; 2] }, 0.0);
        for trip in &self.bins {
            let rho: Vec<f64> = is_on.iter().map(|is_on| trip.pixel[if *is_on { on } else { off }]).collect();
            let irradiance = irradiance(&trip.face, [self.step_mm, self.air_mm], cells, &rho, FAINTEST);
            let through = is_on.iter().map(|is_on| trip.through[if *is_on { on } else { off }]);
            let light: f64 = through.zip(rho.iter().zip(irradiance)).map(|(t, (rho, e))| t * rho * e).sum();
            sum += light / rho.len() as f64;
        }
        sum
    }

    /// Places where light that is seen at a point has met the pixel, relative to it, mm,
    /// `[trips through glass][through air]`.
    fn places(&self) -> Vec<Vec<[f64; 2]>> {
        let of_bin = |trip: &RoundTrip| {
            let brightest = trip.pixel.iter().copied().fold(0.0, f64::max);
            (trip.face.returned() * brightest, trip.face.returned.len(), trip.face.leaving.len())
        };
        let (most, returns, images) = self
            .bins
            .iter()
            .map(of_bin)
            .fold((0.0_f64, 1, 1), |all, one| (all.0.max(one.0), all.1.max(one.1), all.2.max(one.2)));
        let needed = if most > 0.0 { (FAR.ln() / most.min(0.999).ln()).ceil() as usize } else { 0 };
        let trips = needed.min(MOST_FOLLOWED[usize::from(returns > 1)]);
        let after = |glass: usize| {
            let at =
                |air: usize| [0, 1].map(|k| -(glass as f64 * self.step_mm[k] + air as f64 * self.air_mm[k]));
            (0..images + glass * (returns - 1)).map(at).collect()
        };
        (0..=trips).map(after).collect()
    }

    /// Light of a point through all orders: states at its [`Self::places`], and that of most of the page, far away.
    fn of_point(&self, states: &[Vec<usize>], page: usize) -> f64 {
        self.bins.iter().map(|trip| trip.seen(states, page)).sum()
    }
}

impl RoundTrip {
    /// Light that is seen at the places of images that have these states, `[trips through glass][through air]`.
    fn seen(&self, states: &[Vec<usize>], page: usize) -> f64 {
        let far = 1.0 / (1.0 - self.face.returned() * self.pixel[page]);
        let mut irradiance = vec![far; states.last().map_or(0, Vec::len)];
        for (here, before) in states.iter().zip(&states[1..]).rev() {
            let left: Vec<f64> =
                before.iter().zip(&irradiance).map(|(state, e)| self.pixel[*state] * e).collect();
            let of = |air: usize| {
                let parts = self.face.returned.iter().zip(&left[air..]);
                1.0 + parts.map(|(part, light)| part * light).sum::<f64>()
            };
            irradiance = (0..here.len()).map(of).collect();
        }
        let images = self.face.leaving.iter().zip(&states[0]).zip(irradiance);
        images.map(|((part, state), e)| part * self.through[*state] * self.pixel[*state] * e).sum()
    }

    /// Light of all orders that meet these states in turn.
    fn light(&self, states: &[usize]) -> f64 {
        let (mut product, mut sum, face) = (self.through[states[0]], 0.0, self.face.returned());
        for (order, state) in states.iter().enumerate() {
            product *= self.pixel[*state] * if order > 0 { face } else { 1.0 };
            sum += product;
        }
        sum
    }
}

impl Ghosts {
    /// Adds the light of each image to the bins that `place` selects, half to each.
    fn binned(&self, bins: usize, place: impl Fn([f64; 2]) -> [usize; 2]) -> Vec<Vec<f64>> {
        let mut sums = vec![vec![0.0; bins]; self.states];
        for (at, light) in &self.images {
            for bin in place(*at).into_iter().filter(|bin| *bin < bins) {
                sums.iter_mut().zip(light).for_each(|(sums, light)| sums[bin] += 0.5 * light);
            }
        }
        sums
    }
}

/// The bins below and above a place, which differ where it is a border.
fn around(edges: &[f64], at: f64) -> [usize; 2] {
    [edges.partition_point(|edge| *edge < at), edges.partition_point(|edge| *edge <= at)]
}

impl Response for Ghosts {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.states];
        for (at, light) in &self.images {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * at[axis]);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += phase * light);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(edges_mm.len() + 1, |at| around(edges_mm, at[axis]))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(radii_mm.len() + 1, |at| around(radii_mm, at[0].hypot(at[1])))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        let columns = x_mm.len() - 1;
        let bins = columns * (y_mm.len() - 1);
        self.binned(bins, |at| {
            let [column, row] = [around(x_mm, at[0])[1], around(y_mm, at[1])[1]];
            let inside = column > 0 && column <= columns && row > 0 && row < y_mm.len();
            [if inside { (row - 1) * columns + column - 1 } else { usize::MAX }; 2]
        })
    }

    fn line(&self, [line, surround]: [usize; 2], axis: usize, width_mm: f64, _: Level) -> Option<f64> {
        let state_at = |at: &[f64; 2]| if at[axis].abs() < 0.5 * width_mm { line } else { surround };
        let of_trips = |trips: &RoundTrips| {
            let places = trips.places();
            let states: Vec<_> = places.iter().map(|row| row.iter().map(state_at).collect()).collect();
            trips.of_point(&states, surround)
        };
        Some(self.trips.iter().map(of_trips).sum())
    }

    fn text(&self, text: &Text<'_>, [black, white]: [usize; 2], _: Level) -> Option<Vec<f64>> {
        let [columns, rows] = text.bitmap.count.map(|count| count as i64);
        let mut light = vec![0.0; text.middles.len()];
        for trips in &self.trips {
            let pixels = |at: &[f64; 2]| [0, 1].map(|k| (at[k] / text.pitch_mm[k]).round() as i64);
            let places = trips.places();
            let ways: Vec<Vec<[i64; 2]>> =
                places.iter().map(|row| row.iter().map(pixels).collect()).collect();
            for (light, middle) in light.iter_mut().zip(text.middles) {
                let (column, row) = (*middle as i64 % columns, *middle as i64 / columns);
                let state_at = |way: &[i64; 2]| {
                    let (x, y) = (column + way[0], row + way[1]);
                    let is_inside = (0..columns).contains(&x) && (0..rows).contains(&y);
                    if is_inside && text.bitmap.black[(y * columns + x) as usize] { black } else { white }
                };
                let states: Vec<_> = ways.iter().map(|row| row.iter().map(state_at).collect()).collect();
                *light += trips.of_point(&states, white);
            }
        }
        Some(light)
    }

    fn pattern_mean(&self, pattern: Pattern, level: Level) -> Option<f64> {
        (pattern.period_mm > 0.0).then(|| self.trips.iter().map(|trips| trips.mean(pattern, level)).sum())
    }

    fn images(&self) -> Vec<[f64; 2]> {
        let largest = |light: &[f64]| light.iter().copied().fold(0.0, f64::max);
        let brightest = self.images.iter().map(|(_, light)| largest(light)).fold(0.0, f64::max);
        let least = if self.is_wide { SHARP_LIGHT * brightest } else { 0.0 };
        self.images.iter().filter(|(_, light)| largest(light) >= least).map(|(at, _)| *at).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        let peak = |at_mm: [f64; 2]| Peak { at_mm, width_mm: SHARP * self.thickness_mm };
        self.images().into_iter().map(peak).collect()
    }
}
