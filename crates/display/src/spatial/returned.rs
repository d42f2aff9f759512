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
//! **Figures.** In lines and text, light that was returned before its last meeting is seen there from the places of diffuse light; the
//! coarse level takes the places of the source. In patterns, light that returns from elsewhere meets both halves equally often at each
//! meeting; at the coarse level it has the mean of the orders of both. The differences are in the error.

use num_complex::Complex64;
use papilio_transport::spatial::Peak;
use papilio_transport::{Source, Top};

use super::lobe::{self, LobeResponse};
use super::meetings::{Meetings, Points, Way};
use super::patterns::{Pattern, Text};
use super::response::Lit;
use super::series::add;
use super::{Level, PatternKind, Response};
use crate::DisplayError;

/// Points of the first level, and natural digits in which there are twice as many.
const POINTS: f64 = 2048.0;
const DIGITS: f64 = 9.0;
const DIGITS_OF_TWICE: f64 = 2.0;

/// Less returned light than this does not count.
const NOTHING: f64 = 1e-9;

pub(super) struct Returned {
    first: LobeResponse,
    /// What is seen of figures in diffuse light, and its Y by state; `None` if that is the first order, and at the
    /// coarse level.
    diffuse: Option<(LobeResponse, Vec<f64>)>,
    /// Y of light that meets the pixel once, `[state]`.
    once: Vec<f64>,
    /// Y over that of light that meets the pixel once, `[state]`.
    orders: Vec<f64>,
    /// Places of the meetings of light that has more than one; `None` if there is none.
    meetings: Option<Meetings>,
    /// Part of the response that is of these meetings, `[state]`.
    part: Vec<f64>,
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
        let most = orders.iter().copied().fold(1.0, f64::max);
        let meetings =
            if most > 1.0 + NOTHING { meetings(lit, source, &first, (weights, most)) } else { None };
        let part = |(number, orders): (&f64, &f64)| {
            let more = number * (orders - 1.0);
            more / (1.0 + more)
        };
        let part = match &meetings {
            Some(meetings) => meetings.number.iter().zip(&orders).map(part).collect(),
            None => vec![0.0; once.len()],
        };
        let diffuse = (meetings.is_some() && lit.level.is_fine && *source != Source::Diffuse).then(|| {
            let diffuse = lobe::response(lit, &Source::Diffuse, weights)?;
            let y = luminous(&diffuse);
            Ok::<_, DisplayError>((diffuse, y))
        });
        Ok(Self { first, diffuse: diffuse.transpose()?, once, orders, meetings, part })
    }
}

/// Places of the meetings of light that has more than one; `most` is the largest `orders` of a state.
fn meetings(
    lit: Lit<'_>,
    source: &Source,
    first: &LobeResponse,
    (weights, most): (&[f64], f64),
) -> Option<Meetings> {
    let Top::Diffuser(diffuser) = &lit.panel.top else { return None };
    let brightest = first.brightest()?;
    let (front, total) = (&lit.panel.front.reflectance_below, weights.iter().sum::<f64>());
    let kept = |(bin, weight): (usize, &f64)| weight * front[bin] * diffuser.transmittance[bin].powi(2);
    let way = Way {
        view: &lit.view.field,
        source,
        diffuser,
        index: brightest.index,
        glass_mm: lit.thickness_mm(),
        air_mm: lit.air_of_one_front_mm().unwrap_or_default(),
        kept: weights.iter().enumerate().map(kept).sum::<f64>() / total,
    };
    let count = POINTS * ((lit.level.digits - DIGITS) / DIGITS_OF_TWICE).exp2();
    let (part, stream) = match lit.level {
        Level { is_other: true, .. } => (0.25, 2),
        Level { is_fine, .. } => (1.0, u64::from(!is_fine)),
    };
    let points = Points { count: (part * count) as usize, stream, returned: 1.0 - 1.0 / most };
    Some(Meetings::new(&way, &points, lit.panel.base.states(), |beta, rho| brightest.reflectance(beta, rho)))
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
        let inside = |place: [f64; 2]| f64::from((place[axis] + at_mm).abs() < 0.5 * width_mm);
        self.mean_of_later(inside)[state]
    }

    /// What a state of one half of a pattern returns to itself, less what the other half does: the correlation of the
    /// pattern with itself.
    pub(super) fn own_of_pattern(&self, state: usize, kind: PatternKind, period_mm: f64) -> f64 {
        if period_mm == 0.0 {
            return 0.0;
        }
        let along = |at_mm: f64| 1.0 - 4.0 * (at_mm / period_mm - (at_mm / period_mm).round()).abs();
        self.mean_of_later(|[x, y]| match kind {
            PatternKind::Stripes => along(x),
            PatternKind::Checkerboard => along(x) * along(y),
        })[state]
    }

    /// Fraction of what returns to each stroke of text of a state that comes from text.
    pub(super) fn own_of_text(&self, state: usize, text: &Text<'_>) -> Vec<f64> {
        let (x, y) = (text.edges(0), text.edges(1));
        match &self.meetings {
            Some(meetings) => text.over_black(&meetings.cells_of_later(&x, &y)[state]),
            None => text.over_black(&vec![0.0; (x.len() - 1) * (y.len() - 1)]),
        }
    }

    /// Mean of a function of the place of what returns, `[state]`.
    fn mean_of_later(&self, of: impl Fn([f64; 2]) -> f64) -> Vec<f64> {
        self.meetings
            .as_ref()
            .map_or_else(|| vec![0.0; self.once.len()], |meetings| meetings.mean_of_later(of))
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
        let edges = [-0.5 * width_mm, 0.5 * width_mm];
        let change = |seen: &LobeResponse| {
            let light = seen.strips(axis, &edges);
            light[line][1] - light[page][1]
        };
        Some(self.figure([line, page], change, self.own_of_line(line, (axis, width_mm), 0.0)))
    }

    fn pattern_mean(&self, pattern: Pattern, level: Level) -> Option<f64> {
        let Pattern { kind, period_mm, states: [on, off] } = pattern;
        let own = self.own_of_pattern(on, kind, period_mm);
        let half = |state: usize, other: usize| {
            let [one, other] = [self.orders[state], self.orders[other]];
            let mixed = if level.is_fine { 2.0 / (1.0 / one + 1.0 / other) } else { 0.5 * (one + other) };
            0.5 * self.once[state] * (mixed + own * (one - mixed))
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
        Response::images(&self.first)
    }

    fn peaks(&self) -> Vec<Peak> {
        Response::peaks(&self.first)
    }
}
