//! A diffuser over mirror-like pixels, with the light that a front of screen returns to them.
//!
//! **What.** Y of a state is the light that meets the pixel once, Y1, and that of all further orders, so that
//! `q = 1 - Y1/Y` is what returns of the light. Orders form a series, `Y = Y1/(1 - q)`: the response to a
//! small change of the pixel has the shape of the last meeting with the fraction 1 - q, and another shape
//! with the fraction q: light that the front returns later. At its last meeting, light that was returned
//! before is seen from the same places as diffuse light.
//!
//! **The shape of what returns later** is an estimate; it is broad. It has met the pixel at 2 D, and meets it
//! again after two further passes: a ghost about the place of a trip to the front and back. For small angles
//! and a lobe of Cauchy's kind its way is that of 5 passes of the first order and 4 of the air,
//! `|OTF|^(5 + 4 n g/d)`. The coarse level takes the shape of the first order for all light, so that the
//! error of a result, the difference of levels, bounds that of the estimate; where both cross, a third shape, with
//! four times the exponent, bounds it ([`Level::is_broader`]). Y itself, and what is seen of
//! pages, is exact. `q` is about the reflectance of the front times that of the pixel, some 1e-2.
//! `adding::LayeredSpread` follows this light exactly, in seconds instead of milliseconds.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::Source;
use papilio_transport::spatial::{Peak, displacement};

use super::lobe::{self, LobeResponse};
use super::patterns::{Pattern, Text};
use super::response::Lit;
use super::series::{Series, add};
use super::{Level, PatternKind, Response};
use crate::DisplayError;

/// Period of the series, in reaches: the thickness, or a part of a large distance to the front.
const PERIOD: f64 = 100.0;

/// The series ends where the light of all states is below this fraction, at the latest at `HIGHEST` over the
/// thickness.
const FAINTEST: f64 = 1e-4;
const HIGHEST: f64 = 16.0;

/// Frequencies of a pattern, as multiples of the lowest one, end here.
const MOST_WAVES: u32 = 20;

/// Factor of the exponent of the blur of light that returns later, in the broader of its estimates. What paths show of displays with film pixels,
/// mirrors and a front of 0.15 is between both (with a factor of 2, not all of it).
const BROADER: f64 = 4.0;

/// Less returned light than this does not count.
const NOTHING: f64 = 1e-9;

pub(super) struct Returned {
    first: LobeResponse,
    /// What is seen in diffuse light, and its Y by state; `None` if that is the first order, and at the
    /// coarse level.
    diffuse: Option<(LobeResponse, Vec<f64>)>,
    /// Y of light that meets the pixel once, `[state]`.
    once: Vec<f64>,
    /// Y over that of light that meets the pixel once, `[state]`: 1/(1 - q).
    orders: Vec<f64>,
    /// What the front returns later; none at the coarse level, which takes the shape of the first order.
    later: Option<Series>,
}

/// Response of mirror-like pixels below a diffuser; `via_pixel` is the light of all orders,
/// `[state][wavelength]`.
pub(super) fn response(
    lit: Lit<'_>,
    source: &Source,
    weights: &[f64],
    via_pixel: &[f64],
) -> Result<Box<dyn Response>, DisplayError> {
    let first = lobe::response(lit, source, weights)?;
    if !lit.returns() {
        return Ok(Box::new(first));
    }
    Ok(Box::new(Returned::new(lit, (source, first), weights, via_pixel)?))
}

impl Returned {
    /// Below a front that returns light; `first` is the light of the source that meets the pixel once.
    pub(super) fn new(
        lit: Lit<'_>,
        (source, first): (&Source, LobeResponse),
        weights: &[f64],
        via_pixel: &[f64],
    ) -> Result<Self, DisplayError> {
        let luminous = |response: &LobeResponse| -> Vec<f64> {
            response.transfer(0, 0.0).iter().map(|y| y.re).collect()
        };
        let once = luminous(&first);
        let all = via_pixel.chunks_exact(weights.len());
        let all = all.map(|row| row.iter().zip(weights).map(|(light, weight)| light * weight).sum::<f64>());
        let orders: Vec<f64> = once
            .iter()
            .zip(all)
            .map(|(once, all)| if *once > 0.0 { (all / once).max(1.0) } else { 1.0 })
            .collect();
        let is_fine = lit.level.is_fine && orders.iter().any(|orders| *orders > 1.0 + NOTHING);
        let later = is_fine.then(|| later(lit, &first, (&once, &orders)));
        let diffuse = (is_fine && *source != Source::Diffuse).then(|| {
            let diffuse = lobe::response(lit, &Source::Diffuse, weights)?;
            let y = luminous(&diffuse);
            Ok::<_, DisplayError>((diffuse, y))
        });
        Ok(Self { first, diffuse: diffuse.transpose()?, once, orders, later })
    }
}

/// Light q Y of the states, by place.
fn later(lit: Lit<'_>, first: &LobeResponse, (once, orders): (&[f64], &[f64])) -> Series {
    let (thickness_mm, air_mm) = (lit.thickness_mm(), lit.air_of_one_front_mm().unwrap_or_default());
    let period_mm = PERIOD * thickness_mm.max(0.25 * (thickness_mm + air_mm));
    let step_per_mm = 1.0 / period_mm;
    let power = if lit.level.is_broader { BROADER } else { 1.0 } * power(lit, air_mm);
    let mut rest: Vec<Vec<f64>> = once.iter().map(|_| Vec::new()).collect();
    for k in 0..=(HIGHEST / thickness_mm / step_per_mm) as usize {
        let f = k as f64 * step_per_mm;
        let [x, y] = [0, 1].map(|axis| first.transfer(axis, f));
        let mut most = 0.0_f64;
        for (state, rest) in rest.iter_mut().enumerate() {
            let light = once[state] * (orders[state] - 1.0);
            let blur =
                if once[state] > 0.0 { 0.5 * (x[state].norm() + y[state].norm()) / once[state] } else { 0.0 };
            let seen = blur.powf(power);
            most = most.max(seen.abs());
            rest.push(light * seen);
        }
        if most < FAINTEST {
            break;
        }
    }
    let at_mm = place_mm(lit, air_mm);
    Series { step_per_mm, sharp: vec![0.0; once.len()], rest, at_mm, inside: None }
}

/// Exponent of the first order's blur that gives the blur of light that returns later.
fn power(lit: Lit<'_>, air_mm: f64) -> f64 {
    // Ways per direction cosine in the air and the glass: geometric means of those along and across the plane
    // of view.
    let index = lit.panel.medium.index();
    let (index, beta) = (index[index.len() / 2], lit.view.field.axis_towards().squared());
    let [air, glass] = [(air_mm, 1.0), (lit.thickness_mm(), index)]
        .map(|(length, index): (f64, f64)| length * index / (index * index - beta).max(1e-6));
    5.0 + 4.0 * air / glass
}

/// Centre of this light: a mirror shifts light on its way to the front and back.
fn place_mm(lit: Lit<'_>, air_mm: f64) -> [f64; 2] {
    let (beta, index) = (lit.view.field.axis_towards(), lit.panel.medium.index());
    let glass = displacement(beta, 2.0 * lit.thickness_mm(), index[index.len() / 2]);
    let air = displacement(beta, 2.0 * air_mm, 1.0);
    [glass[0] + air[0], glass[1] + air[1]]
}

impl Returned {
    /// Light of a figure on a page. `change`: change of the first order's light, given one response; `own`:
    /// fraction of what returns that comes from the figure itself.
    fn figure(&self, [figure, page]: [usize; 2], change: impl Fn(&LobeResponse) -> f64, own: f64) -> f64 {
        let first = self.once[page] + change(&self.first);
        let (last, y) = match &self.diffuse {
            Some((diffuse, y)) => (y[page] + change(diffuse), y),
            None => (first, &self.once),
        };
        // Light that returned before its last meeting, relative to light that meets the pixel once from the
        // same directions.
        let [figure, page] = [figure, page].map(|state| {
            if y[state] > 0.0 { self.once[state] * (self.orders[state] - 1.0) / y[state] } else { 0.0 }
        });
        first + last * (page + own * (figure - page))
    }

    /// Y of what returns to a page of a state.
    pub(super) fn returned(&self, state: usize) -> f64 {
        self.once[state] * (self.orders[state] - 1.0)
    }

    /// Fraction of what returns to a line of a state that comes from the line itself; `at_mm`: of the place,
    /// from its middle.
    pub(super) fn own_of_line(&self, state: usize, (axis, width_mm): (usize, f64), at_mm: f64) -> f64 {
        let edges = [-0.5 * width_mm - at_mm, 0.5 * width_mm - at_mm];
        let light = match &self.later {
            Some(later) => later.strips(axis, &edges),
            None => self.first.strips(axis, &edges),
        };
        fraction(&light[state], 1)
    }

    /// What a state of one half of a pattern returns to itself, less what the other half does: the transform
    /// at the frequencies of the pattern.
    pub(super) fn own_of_pattern(&self, state: usize, kind: PatternKind, period_mm: f64) -> f64 {
        let shape = |f: [f64; 2]| {
            let length = f[0].hypot(f[1]);
            let light = match &self.later {
                Some(later) => {
                    let turned =
                        (0..2).map(|axis| (2.0 * PI * f[axis] * later.at_mm[axis]).cos()).product::<f64>();
                    turned * later.at(length)[state] / later.at(0.0)[state]
                }
                None => self.first.transfer(0, length)[state].norm() / self.first.transfer(0, 0.0)[state].re,
            };
            if light.is_finite() { light } else { 0.0 }
        };
        let order = |k: u32| 8.0 / PI.powi(2) / f64::from(k * k);
        let wave = |k: u32| f64::from(k) / period_mm;
        let odd = || (1..MOST_WAVES).step_by(2);
        match kind {
            _ if period_mm == 0.0 => 0.0,
            PatternKind::Stripes => odd().map(|k| order(k) * shape([wave(k), 0.0])).sum(),
            PatternKind::Checkerboard => odd()
                .flat_map(|j| odd().map(move |k| (j, k)))
                .map(|(j, k)| order(j) * order(k) * shape([wave(j), wave(k)]))
                .sum(),
        }
    }

    /// Fraction of what returns to each stroke of text of a state that comes from text.
    pub(super) fn own_of_text(&self, state: usize, text: &Text<'_>) -> Vec<f64> {
        let (edges, total) = ([text.edges(0), text.edges(1)], |y: f64| if y > 0.0 { 1.0 / y } else { 0.0 });
        let (cells, scale) = match &self.later {
            Some(later) => (later.cells(&edges[0], &edges[1]), total(later.at(0.0)[state])),
            None => (self.first.cells(&edges[0], &edges[1]), total(self.once[state])),
        };
        text.over_black(&cells[state]).into_iter().map(|light| scale * light).collect()
    }

    /// Light in bins: that of the last meeting, and what is returned later.
    fn binned(
        &self,
        last: impl Fn(&LobeResponse) -> Vec<Vec<f64>>,
        later: impl Fn(&Series) -> Vec<Vec<f64>>,
    ) -> Vec<Vec<f64>> {
        let mut sums = Vec::new();
        for (response, factors) in self.last() {
            let mut bins = last(response);
            for (bins, factor) in bins.iter_mut().zip(&factors) {
                bins.iter_mut().for_each(|light| *light *= factor);
            }
            add(&mut sums, bins);
        }
        if let Some(series) = &self.later {
            add(&mut sums, later(series));
        }
        sums
    }

    /// Responses to the light of the last meeting, with their factors by state: all light, `(1 - q) Y` beside
    /// what returns later.
    fn last(&self) -> Vec<(&LobeResponse, Vec<f64>)> {
        let Some((diffuse, y)) = &self.diffuse else {
            let factors = if self.later.is_some() { vec![1.0; self.once.len()] } else { self.orders.clone() };
            return vec![(&self.first, factors)];
        };
        let first = self.orders.iter().map(|orders| 1.0 / orders).collect();
        let of_diffuse = |(state, orders): (usize, &f64)| {
            if y[state] > 0.0 { (1.0 - 1.0 / orders) * self.once[state] / y[state] } else { 0.0 }
        };
        vec![(&self.first, first), (diffuse, self.orders.iter().enumerate().map(of_diffuse).collect())]
    }
}

/// Part of the light that is in a bin.
fn fraction(bins: &[f64], bin: usize) -> f64 {
    let total: f64 = bins.iter().sum();
    if total > 0.0 { bins[bin] / total } else { 0.0 }
}

impl Response for Returned {
    fn is_estimated(&self) -> bool {
        self.orders.iter().any(|orders| *orders > 1.0 + NOTHING)
    }

    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = vec![Complex64::ZERO; self.once.len()];
        for (response, factors) in self.last() {
            let light = response.transfer(axis, frequency_per_mm).into_iter().zip(factors);
            sums.iter_mut().zip(light).for_each(|(sum, (light, factor))| *sum += light * factor);
        }
        if let Some(later) = &self.later {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * later.at_mm[axis]);
            let light = later.at(frequency_per_mm);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += light * phase);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(|last| last.strips(axis, edges_mm), |later| later.strips(axis, edges_mm))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(|last| last.rings(radii_mm), |later| later.rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(|last| last.cells(x_mm, y_mm), |later| later.cells(x_mm, y_mm))
    }

    fn line(&self, [line, page]: [usize; 2], axis: usize, width_mm: f64, _: Level) -> Option<f64> {
        let edges = [-0.5 * width_mm, 0.5 * width_mm];
        let change = |seen: &LobeResponse| {
            let light = seen.strips(axis, &edges);
            light[line][1] - light[page][1]
        };
        Some(self.figure([line, page], change, self.own_of_line(line, (axis, width_mm), 0.0)))
    }

    fn pattern_mean(&self, pattern: Pattern, _: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states: [on, off] } = pattern;
        let own = self.own_of_pattern(on, kind, period_mm);
        let half = |state: usize, other: usize| {
            let mixed = 1.0 / (0.5 / self.orders[state] + 0.5 / self.orders[other]);
            0.5 * self.once[state] * (mixed + own * (self.orders[state] - mixed))
        };
        Some(half(on, off) + half(off, on))
    }

    fn text(&self, text: &Text<'_>, [black, white]: [usize; 2], _: Level) -> Option<Vec<f64>> {
        let edges = [text.edges(0), text.edges(1)];
        let over_black = |seen: &LobeResponse| -> Vec<f64> {
            let cells = seen.cells(&edges[0], &edges[1]);
            let [more, less] = [black, white].map(|state| text.over_black(&cells[state]));
            more.iter().zip(less).map(|(more, less)| more - less).collect()
        };
        let own = self.own_of_text(black, text);
        let (first, diffuse) = (over_black(&self.first), self.diffuse.as_ref().map(|one| over_black(&one.0)));
        let stroke = |(stroke, own): (usize, &f64)| {
            let change = |seen: &LobeResponse| match &diffuse {
                Some(diffuse) if !std::ptr::eq(seen, &self.first) => diffuse[stroke],
                _ => first[stroke],
            };
            self.figure([black, white], change, *own)
        };
        Some(own.iter().enumerate().map(stroke).collect())
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.last().iter().flat_map(|(response, _)| response.images()).collect()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.last().iter().flat_map(|(response, _)| response.peaks()).collect()
    }
}
