//! Light that the layers above the glass return to Lambertian pixels, tabulated for callers that ask many
//! frequencies.
//!
//! **What.** A flat face alone returns `A(f)` of [`FaceReturn`]; a front of screen above an air gap adds the
//! orders of light between the two, each a [`FrontReturn`] with a longer way. Below a diffuser only the front
//! returns light, through its lobe ([`lobe_return`]), by each of its ways ([`FrontWays`]) from its own height. These decrease quickly with the frequency: light
//! through a gap has no sharp edge. They are Chebyshev polynomials on panels that widen with the frequency,
//! up to [`HIGHEST`].

use std::sync::Arc;

use super::super::face::{FrontReturn, POINTS_OF_TABLE, chebyshev, clenshaw};
use super::super::{Accuracy, FaceReturn, FrontWay, FrontWays};
use super::{Heights, SpreadError, lobe_return};
use crate::layers::Indices;
use crate::{Diffuser, Panel, Top};

/// Frequencies of the table, times the length of the way: that of the first panel, the ratio of the ends of
/// each of the next ones, and the greatest width of a panel. The last panel ends at `HIGHEST`; less than 1e-5
/// of a front's reflectance comes back beyond.
const FIRST: f64 = 0.02;
const GROWTH: f64 = 1.25;
const WIDEST: f64 = 0.4;
const HIGHEST: f64 = 8.0;

/// Highest frequencies of the rules, times the length.
const RULES: [f64; 3] = [0.125, 1.0, HIGHEST];

/// Frequency times the length from which on nothing comes back through a lobe: there less than 1e-3 of what
/// returns of uniform light.
const HIGHEST_OF_LOBE: f64 = 3.0;

/// Orders whose light is below this fraction are left out, the last one standing for all that follow.
const FAINTEST: f64 = 1e-5;
const MOST_ORDERS: usize = 6;

/// Fraction of the light between components of a front that the farthest way has: it returns far away.
const WAYS_LEFT: f64 = 1e-4;

/// Light that the layers above return to Lambertian pixels at wavelengths with the same return.
#[derive(Debug, Clone)]
pub struct LambertianReturn {
    /// Numbers of the wavelengths.
    pub bins: Vec<usize>,
    index: f64,
    /// Reflectance of the front for light from below, through a diffuser twice.
    front: f64,
    /// A flat face; none below a diffuser.
    face: Option<FaceReturn>,
    /// Orders of a front that reflects everything, with the weight of each index for which they were made.
    orders: Vec<(f64, Arc<[Tabulated]>)>,
}

impl LambertianReturn {
    /// Prepares the return of a flat face or a diffuser, and of a front above it.
    ///
    /// # Errors
    /// If several components of the front reflect at different heights above a flat face, or light goes to and fro between them
    /// too often.
    pub fn all(panel: &Panel, accuracy: Accuracy) -> Result<Vec<Self>, SpreadError> {
        let heights = Heights::new(panel)?;
        let index = panel.medium.index();
        let front = |bin: usize| match &panel.top {
            _ if panel.single_pass => 0.0,
            Top::Diffuser(Diffuser { transmittance, .. }) => {
                panel.front.reflectance_below[bin] * transmittance[bin].powi(2)
            }
            Top::Fresnel(_) | Top::IdealAr => panel.front.reflectance_below[bin],
        };
        let largest = (0..index.len()).map(front).fold(0.0, f64::max);
        // Each component of a front above a diffuser returns light from its own height.
        let ways = match &panel.top {
            Top::Diffuser(_) if largest > 0.0 => FrontWays::new(panel, WAYS_LEFT)?.returned,
            _ => vec![FrontWay { air_mm: 0.0, fraction: vec![1.0; index.len()].into() }],
        };
        let indices = (largest > 0.0).then(|| Indices::new(&panel.medium, accuracy.digits));
        let table = |index: f64, way: &FrontWay| match &panel.top {
            Top::Diffuser(diffuser) => {
                let heights = Heights { front_mm: 0.5 * way.air_mm, ..heights };
                through_lobe(diffuser, index, heights, accuracy.digits)
            }
            Top::Fresnel(_) | Top::IdealAr => orders(panel, index, heights, largest),
        };
        // By index and way.
        let nodes = indices.iter().flat_map(|indices| &indices.nodes);
        let tables: Vec<Vec<Arc<[Tabulated]>>> =
            nodes.map(|index| ways.iter().map(|way| table(*index, way)).collect()).collect();
        let mut all: Vec<Self> = Vec::new();
        for bin in 0..index.len() {
            let same = |one: &&mut Self| {
                let is_same_way = |way: &FrontWay| way.fraction[one.bins[0]] == way.fraction[bin];
                one.index == index[bin] && one.front == front(bin) && ways.iter().all(is_same_way)
            };
            if let Some(known) = all.iter_mut().find(same) {
                known.bins.push(bin);
                continue;
            }
            let known = all.iter().find(|one| one.index == index[bin]).map(|one| one.face.clone());
            let face = known.unwrap_or_else(|| {
                let passes = |beta: f64| 1.0 - mean(panel.face_reflectances(index[bin], beta));
                let face = || FaceReturn::new(index[bin], heights.glass_mm, accuracy.most_per_mm, passes);
                (!matches!(panel.top, Top::Diffuser(_))).then(|| face().tabulated())
            });
            let blend = |(node, tables): (usize, &Vec<Arc<[Tabulated]>>)| -> Vec<_> {
                let weight = indices.as_ref().map_or(0.0, |indices| indices.blend_at(node, bin));
                let of_way = |(way, table): (&FrontWay, &Arc<[Tabulated]>)| {
                    (weight * way.fraction[bin], table.clone())
                };
                ways.iter().zip(tables).map(of_way).collect()
            };
            let orders = match front(bin) > 0.0 {
                true => tables.iter().enumerate().flat_map(blend).collect(),
                false => Vec::new(),
            };
            all.push(Self { bins: vec![bin], index: index[bin], front: front(bin), face, orders });
        }
        Ok(all)
    }

    /// The return of other layers, at the wavelengths `bins`: a sum of tables, each with its factor.
    pub(in crate::spatial) fn of_tables(bins: Vec<usize>, tables: Vec<(f64, Arc<[Tabulated]>)>) -> Self {
        Self { bins, index: 1.0, front: 1.0, face: None, orders: tables }
    }

    /// Fraction that comes back of the light from the pixels that is modulated at this frequency (cycles per
    /// mm), with its sign.
    pub fn at(&self, frequency_per_mm: f64) -> f64 {
        let by_face = self.face.as_ref().map_or(0.0, |face| face.at(frequency_per_mm));
        by_face + self.by_front(frequency_per_mm)
    }

    /// The part of it that the front returns.
    pub fn by_front(&self, frequency_per_mm: f64) -> f64 {
        let of_index = |(weight, orders): &(f64, Arc<[Tabulated]>)| {
            let all = orders.iter().rev();
            weight * all.fold(0.0, |sum, order| self.front * (sum + order.at(frequency_per_mm)))
        };
        self.orders.iter().map(of_index).sum()
    }
}

fn mean([s, p]: [f64; 2]) -> f64 {
    0.5 * (s + p)
}

/// Tabulates the orders between the face and a front that reflects everything; the factor of the front is
/// missing in each.
fn orders(panel: &Panel, index: f64, heights: Heights, largest: f64) -> Arc<[Tabulated]> {
    // What the face reflects from above is at most 1, of grazing light; without a face, there is one order.
    let count = match panel.top {
        Top::Fresnel(_) => ((FAINTEST.ln() / largest.min(0.99).ln()).ceil() as usize).clamp(2, MOST_ORDERS),
        Top::IdealAr | Top::Diffuser(_) => 1,
    };
    let of = |order: usize| {
        let lengths = [heights.glass_mm, order as f64 * heights.front_mm];
        // The pixel mixes what it reflects.
        let weight = |r: f64| {
            let rest = if order == count { 1.0 / (1.0 - r * largest) } else { 1.0 };
            (1.0 - r).powi(2) * r.powi(order as i32 - 1) * rest
        };
        let weight = |beta: f64| mean(panel.face_reflectances(index, beta).map(weight));
        let length = lengths[0] + lengths[1];
        let rules = RULES.map(|most| FrontReturn::new(index, lengths, most / length, weight));
        Tabulated::new(length, |rule, f| rules[rule].at(f))
    };
    (1..=count).map(of).collect()
}

/// Tabulates what comes back through a diffuser from a front that reflects everything.
fn through_lobe(diffuser: &Diffuser, index: f64, heights: Heights, digits: f64) -> Arc<[Tabulated]> {
    let length = heights.glass_mm + heights.front_mm;
    let rules = [RULES[0], RULES[1], HIGHEST_OF_LOBE].map(|most| {
        let accuracy = Accuracy { digits, most_per_mm: most / length };
        lobe_return::lit(diffuser, index, heights, accuracy, most > RULES[1])
    });
    let at = |rule: usize, f: f64| match f * length > HIGHEST_OF_LOBE {
        true => 0.0,
        false => lobe_return::returned(&rules[rule], f),
    };
    [Tabulated::new(length, at)].into()
}

/// A function of the frequency on panels.
#[derive(Debug, Clone, Default)]
pub(in crate::spatial) struct Tabulated {
    /// Ends of the panels, cycles per mm, and the coefficients of each.
    pub(in crate::spatial) panels: Vec<([f64; 2], [f64; POINTS_OF_TABLE])>,
}

impl Tabulated {
    /// Tabulates a function of one of the rules, by its number, and a frequency; `length` is that of the way.
    fn new(length: f64, at: impl Fn(usize, f64) -> f64) -> Self {
        let mut panels = Vec::new();
        let (mut from, mut to) = (0.0_f64, FIRST);
        while from < HIGHEST {
            let rule = RULES.iter().position(|most| to <= *most * (1.0 + 1e-9)).unwrap_or(RULES.len() - 1);
            let ends = [from / length, to / length];
            panels.push((ends, chebyshev(ends, |f| at(rule, f))));
            (from, to) = (to, (to * GROWTH).min(to + WIDEST).min(HIGHEST));
        }
        Self { panels }
    }

    /// Highest frequency, cycles per mm; `None` of an empty table.
    pub(in crate::spatial) fn end(&self) -> Option<f64> {
        self.panels.last().map(|(ends, _)| ends[1])
    }

    pub(in crate::spatial) fn at(&self, frequency_per_mm: f64) -> f64 {
        let f = frequency_per_mm.abs();
        let panel = self.panels.partition_point(|(ends, _)| ends[1] < f);
        let Some(([from, to], coefficients)) = self.panels.get(panel) else { return 0.0 };
        clenshaw(coefficients, (2.0 * f - from - to) / (to - from))
    }
}
