//! A diffuser over any pixel, with the light that a front of screen returns to the pixel.
//!
//! **What.** Y of a state is the light that meets the pixel once, Y1, and that of all further orders, so that `q = 1 - Y1/Y` is what
//! returns of the light. Orders form a series, `Y = Y1/(1 - q)`: the response to a small change of the pixel has the shape of the first
//! order with the fraction 1 - q, in light some of which was returned before, and another shape with the fraction q: light
//! that the front returns later.
//!
//! **That shape** is an estimate; it is broad. Light of a Lambertian pixel comes back as through a clear face ([`FlatReturn`]), after two
//! passes of the lobe. Light of a mirror-like pixel has met the pixel at 2 D, and meets it again after two further passes: a ghost about the
//! place of a trip to the front and back. For small angles and a lobe of Cauchy's kind its way is that of 5 passes of the first order
//! and 4 of the air, `|OTF|^(5 + 4 n g/d)`. The coarse level
//! takes the shape of the first order, so that the error of a result, the difference of levels, bounds that of the estimate. Y itself, and
//! what is seen of pages, is exact. `q` is about the reflectance of the front times that of the pixel, some 1e-2.

use std::f64::consts::PI;

use num_complex::Complex64;
use papilio_transport::Source;
use papilio_transport::spatial::{Accuracy, FlatReturn, Peak, displacement};

use super::lobe::{self, LobeResponse};
use super::patterns::{Pattern, Text};
use super::response::{Lit, several_fronts};
use super::series::{Series, add};
use super::{Level, PatternKind, Response};
use crate::DisplayError;

/// Period of the series, in reaches: the thickness, or a part of a large distance to the front.
const PERIOD: f64 = 100.0;

/// The series ends where the light of all states is below this fraction, at the latest at `HIGHEST` over the thickness.
const FAINTEST: f64 = 1e-4;
const HIGHEST: f64 = 16.0;

/// Frequencies of a pattern, as multiples of the lowest one, end here.
const MOST_WAVES: u32 = 20;

/// Less returned light than this does not count.
const NOTHING: f64 = 1e-9;

struct Returned {
    first: LobeResponse,
    /// Y of light that meets the pixel once, `[state]`.
    once: Vec<f64>,
    /// Y over that of light that meets the pixel once, `[state]`: 1/(1 - q).
    orders: Vec<f64>,
    /// What the front returns later; none at the coarse level, which takes the shape of the first order.
    later: Option<Series>,
    /// Factor of the first order in the response.
    direct: Vec<f64>,
}

/// Response of a panel with a diffuser; `via_pixel` is the light of all orders, `[state][wavelength]`.
pub(super) fn response(
    lit: Lit<'_>,
    source: &Source,
    weights: &[f64],
    via_pixel: &[f64],
) -> Result<Box<dyn Response>, DisplayError> {
    let first = lobe::response(lit, source, weights)?;
    let front = &lit.panel.front.reflectance_below;
    if lit.panel.single_pass || front.max() == 0.0 {
        return Ok(Box::new(first));
    }
    let once: Vec<f64> = first.transfer(0, 0.0).iter().map(|y| y.re).collect();
    let all = via_pixel.chunks_exact(weights.len());
    let all = all.map(|row| row.iter().zip(weights).map(|(light, weight)| light * weight).sum::<f64>());
    let orders: Vec<f64> = once
        .iter()
        .zip(all)
        .map(|(once, all)| if *once > 0.0 { (all / once).max(1.0) } else { 1.0 })
        .collect();
    let is_fine = lit.level.is_fine && orders.iter().any(|orders| *orders > 1.0 + NOTHING);
    let later = is_fine.then(|| later(lit, &first, (&once, &orders))).transpose()?;
    // (1 - q) Y is the light of the first order.
    let direct = if later.is_some() { vec![1.0; orders.len()] } else { orders.clone() };
    Ok(Box::new(Returned { first, once, orders, later, direct }))
}

/// Light q Y of the states, by place.
fn later(
    lit: Lit<'_>,
    first: &LobeResponse,
    (once, orders): (&[f64], &[f64]),
) -> Result<Series, DisplayError> {
    let (thickness_mm, air_mm) = (lit.thickness_mm(), front_air_mm(lit)?);
    let period_mm = PERIOD * thickness_mm.max(0.25 * (thickness_mm + air_mm));
    let step_per_mm = 1.0 / period_mm;
    let shape = Shape::new(lit, air_mm)?;
    let mut rest: Vec<Vec<f64>> = once.iter().map(|_| Vec::new()).collect();
    for k in 0..=(HIGHEST / thickness_mm / step_per_mm) as usize {
        let f = k as f64 * step_per_mm;
        let [x, y] = [0, 1].map(|axis| first.transfer(axis, f));
        let mut most = 0.0_f64;
        for (state, rest) in rest.iter_mut().enumerate() {
            let light = once[state] * (orders[state] - 1.0);
            let blur =
                if once[state] > 0.0 { 0.5 * (x[state].norm() + y[state].norm()) / once[state] } else { 0.0 };
            let seen = shape.at(f, blur);
            most = most.max(seen.abs());
            rest.push(light * seen);
        }
        if most < FAINTEST {
            break;
        }
    }
    let at_mm = shape.place_mm(lit, air_mm);
    Ok(Series { step_per_mm, sharp: vec![0.0; once.len()], rest, at_mm })
}

/// Air between the diffuser and the front: that of all components, if there are several.
fn front_air_mm(lit: Lit<'_>) -> Result<f64, DisplayError> {
    let fronts = lit.lengths_mm.len().saturating_sub(1);
    Ok(lit.air_mm().unwrap_or_else(|_| lit.lengths_mm[..fronts].iter().sum()))
}

/// Transform of what the front returns later, from the blur of the first order.
enum Shape {
    /// Power of the blur.
    Mirror(f64),
    Paper(FlatReturn),
}

impl Shape {
    fn new(lit: Lit<'_>, air_mm: f64) -> Result<Self, DisplayError> {
        let index = lit.panel.medium.index();
        if lit.panel.base.is_specular() {
            // Ways per direction cosine in the air and the glass: geometric means of those along and across the plane of view.
            let (index, beta) = (index[index.len() / 2], lit.view.field.axis_towards().squared());
            let [air, glass] = [(air_mm, 1.0), (lit.thickness_mm(), index)]
                .map(|(length, index): (f64, f64)| length * index / (index * index - beta).max(1e-6));
            return Ok(Self::Mirror(5.0 + 4.0 * air / glass));
        }
        let accuracy = Accuracy { digits: 6.0, most_per_mm: 1.0 / lit.thickness_mm() };
        let lengths = [air_mm, lit.thickness_mm()];
        let all = FlatReturn::all(lit.panel, &lengths, accuracy).map_err(several_fronts)?;
        let brightest = |a: &FlatReturn, b: &FlatReturn| a.by_front(0.0).total_cmp(&b.by_front(0.0));
        let brightest = all.into_iter().max_by(brightest);
        Ok(brightest.map_or(Self::Mirror(5.0), Self::Paper))
    }

    /// Place about which it is: a mirror shifts light on its way to the front and back.
    fn place_mm(&self, lit: Lit<'_>, air_mm: f64) -> [f64; 2] {
        let (beta, index) = (lit.view.field.axis_towards(), lit.panel.medium.index());
        match self {
            Self::Mirror(_) => {
                let glass = displacement(beta, 2.0 * lit.thickness_mm(), index[index.len() / 2]);
                let air = displacement(beta, 2.0 * air_mm, 1.0);
                [glass[0] + air[0], glass[1] + air[1]]
            }
            Self::Paper(_) => [0.0; 2],
        }
    }

    fn at(&self, frequency_per_mm: f64, blur: f64) -> f64 {
        match self {
            Self::Mirror(power) => blur.powf(*power),
            Self::Paper(face) => blur.powi(3) * face.by_front(frequency_per_mm) / face.by_front(0.0),
        }
    }
}

impl Returned {
    /// Light of a figure on a page. `change`: of the light of the first order; `own`: fraction of what returns that comes from the
    /// figure itself.
    fn figure(&self, [figure, page]: [usize; 2], change: f64, own: f64) -> f64 {
        (self.once[page] + change) * (self.orders[page] + own * (self.orders[figure] - self.orders[page]))
    }

    /// Adds what is returned later to the light of the first order.
    fn with_later(&self, mut bins: Vec<Vec<f64>>, later: impl Fn(&Series) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        for (bins, factor) in bins.iter_mut().zip(&self.direct) {
            bins.iter_mut().for_each(|bin| *bin *= factor);
        }
        if let Some(series) = &self.later {
            add(&mut bins, later(series));
        }
        bins
    }
}

/// Part of the light that is in a bin.
fn fraction(bins: &[f64], bin: usize) -> f64 {
    let total: f64 = bins.iter().sum();
    if total > 0.0 { bins[bin] / total } else { 0.0 }
}

impl Response for Returned {
    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = self.first.transfer(axis, frequency_per_mm);
        sums.iter_mut().zip(&self.direct).for_each(|(sum, factor)| *sum *= factor);
        if let Some(later) = &self.later {
            let phase = Complex64::cis(-2.0 * PI * frequency_per_mm * later.at_mm[axis]);
            let light = later.at(frequency_per_mm);
            sums.iter_mut().zip(light).for_each(|(sum, light)| *sum += light * phase);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        self.with_later(self.first.strips(axis, edges_mm), |later| later.strips(axis, edges_mm))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        self.with_later(self.first.rings(radii_mm), |later| later.rings(radii_mm))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.with_later(self.first.cells(x_mm, y_mm), |later| later.cells(x_mm, y_mm))
    }

    fn line(&self, [line, page]: [usize; 2], axis: usize, width_mm: f64, _: Level) -> Option<f64> {
        let edges = [-0.5 * width_mm, 0.5 * width_mm];
        let first = self.first.strips(axis, &edges);
        let later = self.later.as_ref().map(|later| later.strips(axis, &edges));
        let returned = fraction(&later.as_ref().unwrap_or(&first)[line], 1);
        Some(self.figure([line, page], first[line][1] - first[page][1], returned))
    }

    fn pattern_mean(&self, pattern: Pattern, _: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states } = pattern;
        let [on, off] = states;
        // What a state of one half returns to itself, less what the other half does: the transform at the frequencies of the pattern.
        let shape = |f: [f64; 2]| {
            let length = f[0].hypot(f[1]);
            let light = match &self.later {
                Some(later) => {
                    let turned =
                        (0..2).map(|axis| (2.0 * PI * f[axis] * later.at_mm[axis]).cos()).product::<f64>();
                    turned * later.at(length)[on] / later.at(0.0)[on]
                }
                None => self.first.transfer(0, length)[on].norm() / self.first.transfer(0, 0.0)[on].re,
            };
            if light.is_finite() { light } else { 0.0 }
        };
        let order = |k: u32| 8.0 / PI.powi(2) / f64::from(k * k);
        let wave = |k: u32| f64::from(k) / period_mm;
        let odd = || (1..MOST_WAVES).step_by(2);
        let own: f64 = match kind {
            _ if period_mm == 0.0 => 0.0,
            PatternKind::Stripes => odd().map(|k| order(k) * shape([wave(k), 0.0])).sum(),
            PatternKind::Checkerboard => odd()
                .flat_map(|j| odd().map(move |k| (j, k)))
                .map(|(j, k)| order(j) * order(k) * shape([wave(j), wave(k)]))
                .sum(),
        };
        let half = |state: usize, other: usize| {
            let mixed = 1.0 / (0.5 / self.orders[state] + 0.5 / self.orders[other]);
            0.5 * self.once[state] * (mixed + own * (self.orders[state] - mixed))
        };
        Some(half(on, off) + half(off, on))
    }

    fn text(&self, text: &Text<'_>, [black, white]: [usize; 2], _: Level) -> Option<Vec<f64>> {
        let edges = [text.edges(0), text.edges(1)];
        let first = self.first.cells(&edges[0], &edges[1]);
        let [more, less] = [black, white].map(|state| text.over_black(&first[state]));
        let total = |cells: f64| if cells > 0.0 { 1.0 / cells } else { 0.0 };
        let returned: Vec<f64> = match &self.later {
            Some(later) => {
                let scale = total(later.at(0.0)[black]);
                let cells = later.cells(&edges[0], &edges[1]);
                text.over_black(&cells[black]).into_iter().map(|light| scale * light).collect()
            }
            None => more.iter().map(|light| total(self.once[black]) * light).collect(),
        };
        let all = more.iter().zip(&less).zip(&returned);
        Some(all.map(|((more, less), own)| self.figure([black, white], more - less, *own)).collect())
    }

    fn images(&self) -> Vec<[f64; 2]> {
        self.first.images()
    }

    fn peaks(&self) -> Vec<Peak> {
        self.first.peaks()
    }
}
