//! Light between flat parts that are apart: how far each order of it goes, and which fraction it has.
//!
//! **What.** Components of a front of screen at different heights reflect light between each other. It keeps its direction
//! beta, so that an order that goes k more times up and down through a gap of air of the height g moves by `k 2 D_g(beta)`. A
//! viewer sees the pixels again at these places, and light of the pixels returns from them. Between two components of the
//! reflectances R and r, order k has the fraction `(R r)^k (1 - R r)` of what leaves.
//!
//! **How.** Light that rises from below is followed from component to component, by the number of times that it has come
//! down through each gap, until a given fraction is left, which the farthest way has. A front with too many ways is refused.

use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::sync::Arc;

use super::SpreadError;
use crate::Panel;
use crate::front::Flat;

/// Most ways, and most steps by which they are found.
const MOST_WAYS: usize = 256;
const MOST_STEPS: usize = 20_000;

/// Least fraction that is left, and the part of it that light has which is not followed.
const LEAST: f64 = 1e-8;
const EACH: f64 = 1e-3;

/// Most orders of light between two parts.
const MOST_ORDERS: usize = 64;

/// Light that goes equally far.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontWay {
    /// How far up and down it goes through the air, besides the own way of a view, mm.
    pub air_mm: f64,
    /// Fraction of all light at each wavelength.
    pub fraction: Arc<[f64]>,
}

/// Light of a front of screen, by ways.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontWays {
    /// Light that leaves upwards; the first way is the own one of a view.
    pub leaving: Vec<FrontWay>,
    /// Light that returns to what is below the front.
    pub returned: Vec<FrontWay>,
}

/// Where light is: above a part, coming down to it, or below one, rising to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum At {
    Above(usize),
    Below(Reverse<usize>),
}

/// Components at one height, by wavelength, and the air below them.
type Part = (Vec<Flat>, f64);

/// Light at each wavelength by how often it has come down through each gap.
type ByGaps = BTreeMap<Vec<u32>, Vec<f64>>;

impl FrontWays {
    /// Follows light through the front of a panel until this fraction is left.
    ///
    /// # Errors
    /// If there are too many ways.
    pub fn new(panel: &Panel, left: f64) -> Result<Self, SpreadError> {
        let parts = apart(panel);
        if parts.len() < 2 {
            let gap_mm: f64 = panel.gaps_mm.split_last().map_or(0.0, |(_, gaps)| gaps.iter().sum());
            let gap_mm = parts.first().map_or(gap_mm, |(_, gap_mm)| *gap_mm);
            let only = |air_mm: f64| vec![FrontWay { air_mm, fraction: vec![1.0; panel.base.bins()].into() }];
            return Ok(Self { leaving: only(0.0), returned: only(2.0 * gap_mm) });
        }
        let left = left.max(LEAST);
        let whole: Vec<Flat> = (0..panel.base.bins())
            .map(|bin| parts.iter().fold(Flat::CLEAR, |upper, (part, _)| upper.over(part[bin])))
            .collect();
        let [leaving, returned] = followed(&parts, EACH * left);
        let leaving = ways(leaving, &parts, whole.iter().map(|flat| flat.t), left)?;
        let returned = ways(returned, &parts, whole.iter().map(|flat| flat.below), left)?;
        Ok(Self { leaving, returned })
    }
}

/// Number of orders of light of which the fraction `between` goes on to the next one, if less than `faintest` of it may be left.
/// The last order has the rest.
pub fn orders_between(between: f64, faintest: f64) -> usize {
    (1..MOST_ORDERS).find(|order| between.powi(*order as i32) <= faintest).unwrap_or(MOST_ORDERS)
}

/// Fraction of the light that leaves in an order, of which `between` goes on to the next one; the last one of `count` has the
/// rest.
pub fn fraction_of_order(between: f64, order: usize, count: usize) -> f64 {
    between.powi(order as i32) * if order + 1 == count { 1.0 } else { 1.0 - between }
}

/// Components of the front that reflect at different heights, outermost first; none where their heights are not known.
fn apart(panel: &Panel) -> Vec<Part> {
    let gaps = panel.gaps_mm.split_last().map_or(&[][..], |(_, gaps)| gaps);
    if panel.single_pass || gaps.len() != panel.components.len() {
        return Vec::new();
    }
    let is_clear = |part: &[Flat]| part.iter().all(|flat| flat.above == 0.0 && flat.below == 0.0);
    let mut parts: Vec<Part> = Vec::new();
    for (component, gap_mm) in panel.components.iter().zip(gaps) {
        let pairs = component.reflectance.iter().zip(component.absorptance.iter());
        let part: Vec<Flat> = pairs.map(|(r, a)| Flat { t: 1.0 - r - a, above: *r, below: *r }).collect();
        match parts.last_mut() {
            Some((upper, upper_mm)) if *upper_mm == 0.0 || is_clear(upper) || is_clear(&part) => {
                // What reflects nothing has no place of its own.
                let is_upper = *upper_mm > 0.0 && !is_clear(upper);
                *upper_mm = gap_mm + if is_upper { *upper_mm } else { 0.0 };
                upper.iter_mut().zip(part).for_each(|(upper, lower)| *upper = upper.over(lower));
            }
            _ => parts.push((part, *gap_mm)),
        }
    }
    parts
}

/// Follows one unit of light that rises to the lowest part: what leaves upwards, and what comes down again. Less than `least` is
/// not followed.
fn followed(parts: &[Part], least: f64) -> [ByGaps; 2] {
    let last = parts.len() - 1;
    let mut found = [ByGaps::new(), ByGaps::new()];
    let mut light: BTreeMap<(u32, At, Vec<u32>), Vec<f64>> = BTreeMap::new();
    let add = |sum: &mut Vec<f64>, more: Vec<f64>| match sum.is_empty() {
        true => *sum = more,
        false => sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += more),
    };
    light.insert((0, At::Below(Reverse(last)), vec![0; parts.len()]), vec![1.0; parts[0].0.len()]);
    // In ascending order of how often it has come down, light that comes down first.
    for _ in 0..MOST_STEPS {
        let Some(((downs, at, gaps), amount)) = light.pop_first() else { break };
        if amount.iter().all(|amount| *amount < least) {
            continue;
        }
        let part = match at {
            At::Above(part) | At::Below(Reverse(part)) => part,
        };
        let times = |of: fn(&Flat) -> f64| -> Vec<f64> {
            amount.iter().zip(&parts[part].0).map(|(amount, flat)| amount * of(flat)).collect()
        };
        let (rising, rises_to, down) = match at {
            At::Above(part) => (times(|flat| flat.above), part.checked_sub(1), times(|flat| flat.t)),
            At::Below(Reverse(part)) => (times(|flat| flat.t), part.checked_sub(1), times(|flat| flat.below)),
        };
        match rises_to {
            Some(upper) => {
                add(light.entry((downs, At::Below(Reverse(upper)), gaps.clone())).or_default(), rising)
            }
            None => add(found[0].entry(gaps.clone()).or_default(), rising),
        }
        let mut gaps = gaps;
        gaps[part] += 1;
        match part == last {
            true => add(found[1].entry(gaps).or_default(), down),
            false => add(light.entry((downs + 1, At::Above(part + 1), gaps)).or_default(), down),
        }
    }
    found
}

/// The brightest ways with all light but the fraction `left`, which the farthest one has. `all` is what there is at each wavelength.
fn ways(
    found: ByGaps,
    parts: &[Part],
    all: impl Iterator<Item = f64>,
    left: f64,
) -> Result<Vec<FrontWay>, SpreadError> {
    let all: Vec<f64> = all.collect();
    let mut ways: Vec<(f64, Vec<f64>)> = Vec::new();
    for (gaps, light) in found {
        let downs = gaps.iter().zip(parts);
        let air_mm: f64 = downs.map(|(downs, (_, gap_mm))| 2.0 * f64::from(*downs) * gap_mm).sum();
        // Without light, all of it goes the first way.
        let of_none = if ways.is_empty() { 1.0 } else { 0.0 };
        let fraction = light.iter().zip(&all);
        let fraction = fraction.map(|(light, all)| if *all > 0.0 { light / all } else { of_none });
        let is_same = |(other, _): &&mut (f64, Vec<f64>)| (*other - air_mm).abs() <= 1e-9 * air_mm;
        match ways.iter_mut().find(is_same) {
            Some((_, sum)) => sum.iter_mut().zip(fraction).for_each(|(sum, more)| *sum += more),
            None => ways.push((air_mm, fraction.collect())),
        }
    }
    let largest = |fraction: &[f64]| fraction.iter().copied().fold(0.0, f64::max);
    ways.sort_by(|(_, a), (_, b)| largest(b).total_cmp(&largest(a)));
    let mut rest = vec![1.0; all.len()];
    let mut kept = Vec::new();
    for (air_mm, fraction) in ways.into_iter().take(MOST_WAYS) {
        if largest(&rest) <= left {
            break;
        }
        rest.iter_mut().zip(&fraction).for_each(|(rest, part)| *rest -= part);
        kept.push((air_mm, fraction));
    }
    if largest(&rest) > left {
        return Err(SpreadError::ManyWays);
    }
    kept.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    if let Some((_, farthest)) = kept.last_mut() {
        farthest.iter_mut().zip(rest).for_each(|(part, rest)| *part += rest);
    }
    Ok(kept.into_iter().map(|(air_mm, fraction)| FrontWay { air_mm, fraction: fraction.into() }).collect())
}
