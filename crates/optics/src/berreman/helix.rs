//! Helices: slices that turn by the same angle from one to the next.
//!
//! Where all slices of a list together turn a layer by as much as leaves it as it was, a wave whose azimuth is turned by the angle of a slice meets
//! the same slices, in an order that begins with another one. Scattering matrices of the slices, of the first and of the last of them together and of many
//! turns (by doubling) are therefore computed once for all azimuths that differ by multiples of this angle.

use super::lanes::Blocks;
use super::spectral::Slice;

/// Fewest slices of a helix.
const FEWEST: usize = 4;

/// Largest difference of directions, and of azimuths in steps, that counts as none.
const ROUNDING: f64 = 1e-9;

/// Returns the angle from one slice to the next, radians, if these are the slices of a helix.
pub(super) fn step(slices: &[Slice]) -> Option<f64> {
    let [first, second, ..] = slices else { return None };
    if slices.len() < FEWEST {
        return None;
    }
    let azimuth = |slice: &Slice| slice.axes[0][1].atan2(slice.axes[0][0]);
    let step = azimuth(second) - azimuth(first);
    // Axes have no sense.
    let is_turned = |turns: usize, slice: &Slice| {
        let (sin, cos) = (step * turns as f64).sin_cos();
        first.axes.iter().zip(&slice.axes).all(|([x, y, z], own)| {
            let turned = [cos * x - sin * y, sin * x + cos * y, *z];
            let is_same = |sign: f64| turned.iter().zip(own).all(|(a, b)| (a - sign * b).abs() < ROUNDING);
            is_same(1.0) || is_same(-1.0)
        })
    };
    let is_equal = |slice: &Slice| (slice.thickness_nm / first.thickness_nm - 1.0).abs() < ROUNDING;
    let turns = step.abs() > ROUNDING && slices.iter().enumerate().all(|(k, slice)| is_turned(k, slice));
    (turns && is_turned(slices.len(), first) && slices.iter().all(is_equal)).then_some(step)
}

/// Returns slices that follow each other some times, with the first of them once more.
pub(super) fn repeated(slices: impl Iterator<Item = Blocks>, repeats: usize, rest: usize) -> Blocks {
    let (mut once, mut first) = (None, None);
    for (number, slice) in slices.enumerate() {
        if number == rest {
            first = once;
        }
        once = Some(over(once, slice));
    }
    let first = if rest > 0 { first.or(once) } else { None };
    let all = once.and_then(|once| power(once, repeats));
    match (all, first) {
        (Some(all), Some(first)) => all.over(&first),
        (all, first) => all.or(first).unwrap_or_else(Blocks::nothing),
    }
}

fn over(above: Option<Blocks>, below: Blocks) -> Blocks {
    above.map_or(below, |above| above.over(&below))
}

/// Returns a part many times, by doubling.
fn power(mut once: Blocks, mut left: usize) -> Option<Blocks> {
    let mut all = None;
    while left > 0 {
        if left % 2 == 1 {
            all = Some(over(all, once));
        }
        left /= 2;
        if left > 0 {
            once = once.over(&once);
        }
    }
    all
}

/// A turn of a helix as waves of one azimuth meet it.
pub(super) struct Turns {
    azimuth: f64,
    /// The first slices together, from one to all.
    first: Vec<Blocks>,
    /// The last slices together, from all to one.
    last: Vec<Blocks>,
    /// Numbers of turns, together.
    powers: Vec<(usize, Blocks)>,
}

impl Turns {
    pub(super) fn new(azimuth: f64, slices: impl Iterator<Item = Blocks>) -> Self {
        let slices: Vec<Blocks> = slices.collect();
        let (mut first, mut last) = (Vec::with_capacity(slices.len()), Vec::with_capacity(slices.len()));
        for slice in &slices {
            first.push(over(first.last().copied(), *slice));
        }
        for slice in slices.iter().rev() {
            last.push(last.last().map_or(*slice, |below| slice.over(below)));
        }
        last.reverse();
        Self { azimuth, first, last, powers: Vec::new() }
    }

    /// Returns the slice that waves of another azimuth meet first.
    pub(super) fn start(&self, azimuth: f64, step: f64) -> Option<usize> {
        let steps = (self.azimuth - azimuth) / step;
        let nearest = steps.round();
        let is_one = (steps - nearest).abs() < ROUNDING * self.first.len() as f64;
        is_one.then_some((nearest as i64).rem_euclid(self.first.len() as i64) as usize)
    }

    /// Returns so many slices from this one on, a turn at least.
    pub(super) fn blocks(&mut self, start: usize, count: usize) -> Blocks {
        let turn = self.first.len();
        let (begun, left) =
            if start == 0 { (None, count) } else { (Some(self.last[start]), count + start - turn) };
        let mut all = begun;
        if let Some(whole) = self.turns(left / turn) {
            all = Some(over(all, whole));
        }
        match left % turn {
            0 => all.unwrap_or_else(Blocks::nothing),
            rest => over(all, self.first[rest - 1]),
        }
    }

    fn turns(&mut self, count: usize) -> Option<Blocks> {
        if let Some((_, known)) = self.powers.iter().find(|(known, _)| *known == count) {
            return Some(*known);
        }
        let made = power(*self.first.last()?, count)?;
        self.powers.push((count, made));
        Some(made)
    }
}
