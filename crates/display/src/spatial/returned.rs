//! A diffuser over mirror-like pixels, with the light that a front of screen returns to them.
//!
//! **What.** Y of a state is the light that meets the pixel once, Y1, and that of all further orders, E. The response to a
//! small change of the pixel counts light once for each of its meetings: if light that meets it more than once does so
//! m times in the mean, it has the shape of the first order with the fraction `Y1/(Y1 + m E)`, and
//! that of all meetings of E with the rest.
//!
//! **The shape of the meetings of E** is the integral of `meetings.rs`. The coarse level and a third result, of other
//! points ([`Level::is_other`]), have a fourth of its points each; the larger difference is the error. Y itself, and what is seen of
//! pages, is exact. E/Y is about the reflectance of the front times that of the pixel.
//! `adding::LayeredSpread` follows this light exactly, in seconds instead of milliseconds.
//!
//! **Figures.** Lines, text and patterns have the light of all meetings of each point with their own state (`figures.rs`).

use std::sync::Arc;

use num_complex::Complex64;
use papilio_transport::spatial::Peak;
use papilio_transport::{Source, Top};

use super::figures::{FigureLight, Figures};
use super::lobe::{self, LobeResponse};
use super::meetings::{Air, Meetings, Points, Way};
use super::patterns::{Pattern, Text};
use super::response::Lit;
use super::series::add;
use super::{Level, Response};
use crate::DisplayError;

/// Points of the first level, and natural digits in which there are twice as many.
const POINTS: f64 = 2048.0;
const DIGITS: f64 = 9.0;
const DIGITS_OF_TWICE: f64 = 2.0;

/// Less returned light than this does not count.
const NOTHING: f64 = 1e-9;

pub(super) struct Returned {
    first: LobeResponse,
    /// Y of light that meets the pixel once, `[state]`.
    once: Vec<f64>,
    /// Y over that of light that meets the pixel once, `[state]`.
    orders: Vec<f64>,
    /// Places of the meetings of light that has more than one; `None` if there is none.
    meetings: Option<Meetings>,
    /// Part of the response that is of these meetings, `[state]`.
    part: Vec<f64>,
    /// The same light, by which states it meets.
    figures: Option<FigureLight>,
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
    fn new(
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
        let most = orders.iter().copied().fold(1.0, f64::max);
        let found = match most > 1.0 + NOTHING {
            true => meetings(lit, source, &first, (weights, most))?,
            false => None,
        };
        let (meetings, figures) = found.unzip();
        let part = |(number, orders): (&f64, &f64)| {
            let more = number * (orders - 1.0);
            more / (1.0 + more)
        };
        let part = match &meetings {
            Some(meetings) => meetings.number.iter().zip(&orders).map(part).collect(),
            None => vec![0.0; once.len()],
        };
        Ok(Self { first, once, orders, meetings, part, figures })
    }
}

/// Places of the meetings of light that has more than one; `most` is the largest `orders` of a state.
fn meetings(
    lit: Lit<'_>,
    source: &Source,
    first: &LobeResponse,
    (weights, most): (&[f64], f64),
) -> Result<Option<(Meetings, FigureLight)>, DisplayError> {
    let Top::Diffuser(diffuser) = &lit.panel.top else { return Ok(None) };
    let Some(brightest) = first.brightest() else { return Ok(None) };
    let air = Air::new(lit, weights)?;
    let (front, total) = (&lit.panel.front.reflectance_below, weights.iter().sum::<f64>());
    let kept = |(bin, weight): (usize, &f64)| weight * front[bin] * diffuser.transmittance[bin].powi(2);
    let way = Way {
        view: &lit.view.field,
        source,
        diffuser,
        index: brightest.index,
        glass_mm: lit.thickness_mm(),
        air: &air,
        kept: weights.iter().enumerate().map(kept).sum::<f64>() / total,
    };
    let count = POINTS * ((lit.level.digits - DIGITS) / DIGITS_OF_TWICE).exp2();
    let (part, stream) = match lit.level {
        Level { is_other: true, .. } => (0.25, 2),
        Level { is_fine, .. } => (1.0, u64::from(!is_fine)),
    };
    let points = Points { count: (part * count) as usize, stream, returned: 1.0 - 1.0 / most };
    let found =
        Meetings::new(&way, &points, lit.panel.base.states(), |beta, rho| brightest.reflectance(beta, rho));
    Ok(Some((found, FigureLight::new(&way, points, lit.panel, weights))))
}

impl Returned {
    /// Light of two states that meets them more than once, and that of their pages.
    fn figures(&self, states: [usize; 2]) -> Option<(Arc<Figures>, [f64; 2])> {
        let figures = self.figures.as_ref()?.of(states);
        Some((figures, states.map(|state| self.returned(state))))
    }

    /// Y of what returns to a page of a state.
    fn returned(&self, state: usize) -> f64 {
        self.once[state] * (self.orders[state] - 1.0)
    }

    /// Light in bins: that of the first order, and that of all meetings of what is returned.
    fn binned(&self, mut once: Vec<Vec<f64>>, further: impl Fn(&Meetings) -> Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let factor = |bins: &mut [Vec<f64>], of: &dyn Fn(usize) -> f64| {
            for (state, bins) in bins.iter_mut().enumerate() {
                bins.iter_mut().for_each(|light| *light *= of(state));
            }
        };
        factor(&mut once, &|state| self.orders[state] * (1.0 - self.part[state]));
        if let Some(meetings) = &self.meetings {
            let mut bins = further(meetings);
            factor(&mut bins, &|state| self.of_meetings(state));
            add(&mut once, bins);
        }
        once
    }

    /// Light of the meetings of what is returned.
    fn of_meetings(&self, state: usize) -> f64 {
        self.once[state] * self.orders[state] * self.part[state]
    }
}

impl Response for Returned {
    fn has_other_points(&self) -> bool {
        self.orders.iter().any(|orders| *orders > 1.0 + NOTHING)
    }

    fn transfer(&self, axis: usize, frequency_per_mm: f64) -> Vec<Complex64> {
        let mut sums = self.first.transfer(axis, frequency_per_mm);
        for (state, sum) in sums.iter_mut().enumerate() {
            *sum *= self.orders[state] * (1.0 - self.part[state]);
        }
        if let Some(meetings) = &self.meetings {
            let light = meetings.transfer(axis, frequency_per_mm).into_iter().enumerate();
            sums.iter_mut()
                .zip(light)
                .for_each(|(sum, (state, part))| *sum += self.of_meetings(state) * part);
        }
        sums
    }

    fn strips(&self, axis: usize, edges_mm: &[f64]) -> Vec<Vec<f64>> {
        let bin = |place: [f64; 2]| edges_mm.partition_point(|edge| *edge <= place[axis]);
        self.binned(self.first.strips(axis, edges_mm), |further| further.bins(edges_mm.len() + 1, bin))
    }

    fn rings(&self, radii_mm: &[f64]) -> Vec<Vec<f64>> {
        let bin = |[x, y]: [f64; 2]| radii_mm.partition_point(|radius| *radius <= x.hypot(y));
        self.binned(self.first.rings(radii_mm), |further| further.bins(radii_mm.len() + 1, bin))
    }

    fn cells(&self, x_mm: &[f64], y_mm: &[f64]) -> Vec<Vec<f64>> {
        self.binned(self.first.cells(x_mm, y_mm), |further| further.cells(x_mm, y_mm))
    }

    fn line(&self, [line, page]: [usize; 2], axis: usize, width_mm: f64, _: Level) -> Option<f64> {
        let strips = self.first.strips(axis, &[-0.5 * width_mm, 0.5 * width_mm]);
        let first = self.once[page] + strips[line][1] - strips[page][1];
        let is_line = |place: [f64; 2]| place[axis].abs() < 0.5 * width_mm;
        let further = self.figures([line, page]);
        Some(first + further.map_or(0.0, |(figures, exact)| figures.at_place(exact, |at| !is_line(at))))
    }

    fn pattern_mean(&self, pattern: Pattern, _: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states } = pattern;
        let first: f64 = states.iter().map(|state| 0.5 * self.once[*state]).sum();
        let further = self.figures(states);
        Some(first + further.map_or(0.0, |(figures, exact)| figures.of_pattern(exact, kind, period_mm)))
    }

    fn text(&self, text: &Text<'_>, [black, white]: [usize; 2], _: Level) -> Option<Vec<f64>> {
        let kernel = text.kernel(&self.first);
        let [more, less] = [black, white].map(|state| text.over_black(&kernel, state));
        let first = more.iter().zip(less).map(|(more, less)| self.once[white] + more - less);
        let further = self.figures([black, white]);
        let further = further
            .map_or_else(|| vec![0.0; text.middles.len()], |(figures, exact)| figures.of_text(exact, text));
        Some(first.zip(further).map(|(first, further)| first + further).collect())
    }

    fn images(&self) -> Vec<[f64; 2]> {
        Response::images(&self.first)
    }

    fn peaks(&self) -> Vec<Peak> {
        Response::peaks(&self.first)
    }
}
