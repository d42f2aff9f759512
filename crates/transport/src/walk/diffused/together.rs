//! First passes of several paths at once, as registers hold them.
//!
//! Over a mirror, with directions drawn from the lobe, diffuse light and beams, all first passes
//! go the same way and end in weights on the nodes of the pixel's table: what leads there is arithmetic
//! without a branch, which compilers spread over the widest registers that there are. Only the look-up
//! itself is done path by path, and so are the few paths that go on.
//!
//! Paths stand in groups whose borders do not depend on how many are asked for at a time: each
//! group is computed whole and those wanted are added, so that sums are the same bits.

use std::ops::Range;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::{Numbers, PLANNED_BLOCKS};
use pulp::{Arch, Simd, WithSimd};

use super::books::{Sums, Tally};
use super::first::First;
use super::{Diffused, Downward, PassNumbers};
use crate::walk::tally::{Channel, Moments, SIDE_BY_SIDE};
use crate::walk::{PathNumbers, Target};
use crate::{AngularTable, CosinePanels, Nodes, Reflector, Source};

/// Paths of a group.
const LANES: usize = 16;

/// A number for each path of a group.
type Lanes = [f64; LANES];

/// First passes of a group.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Above the diffuser, x and y.
    above: [Lanes; 2],
    /// Below it: `|beta|^2`, and the cosine in the medium.
    below: Lanes,
    cosine: Lanes,
    /// The share of the light there that leaves into the air.
    leaving: Lanes,
    /// Whether the path goes on if it is below the probability of that.
    survival: Lanes,
    /// For each source; nothing for diffuse light.
    from_source: Vec<FromSource>,
}

/// What a beam gives, in both techniques.
#[derive(Debug, Clone, Copy)]
struct FromSource {
    /// To the direction that the path has drawn.
    connected: Lanes,
    /// To one drawn about the beam: `|beta|^2` and weight.
    backwards: [Lanes; 2],
    /// Of the same.
    cosine: Lanes,
}

/// Computes a group from its first path on.
struct Pass<'a, 'b> {
    walk: &'a Diffused<'b>,
    width: f64,
    numbers: &'a Numbers,
    first: u64,
    group: &'a mut Group,
}

impl WithSimd for Pass<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { walk, width, numbers, first, group } = self;
        let [u, v, s, t] = numbers.side_by_side::<LANES, 4>(first, 0);
        [group.survival] = numbers.side_by_side::<LANES, 1>(first, PLANNED_BLOCKS - 1);
        // A lobe that is known to be of this kind leaves no branch.
        let lobe = Lobe::KCorrelation { width };
        let towards_field = walk.view.sampler();
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let above = towards_field([u[k], v[k]]);
            (group.above[0][k], group.above[1][k]) = (above.x, above.y);
            let below = drawn(lobe, above, [s[k], t[k]]);
            (x[k], y[k]) = (below.x, below.y);
            group.below[k] = below.squared();
        }
        let offsets = group.below.map(f64::sqrt);
        group.leaving = walk.leaving.at(offsets);
        let index = walk.stack.medium.largest_index();
        let per_square = 1.0 / (index * index);
        for k in 0..LANES {
            group.cosine[k] = cosine(group.below[k] * per_square);
        }
        for (source, from) in walk.sources.iter().zip(&mut group.from_source) {
            let Source::Beam(beam) = source else { continue };
            let target = Target::beam(*beam);
            for k in 0..LANES {
                let above = Beta { x: group.above[0][k], y: group.above[1][k] };
                let below = Beta { x: x[k], y: y[k] };
                from.connected[k] = connected(lobe, &target, [above, below, *beam]);
                let back = drawn(lobe, *beam, [s[k], t[k]]);
                from.backwards[0][k] = back.squared();
                from.cosine[k] = cosine(back.squared() * per_square);
                let within = back.squared() < index * index;
                from.backwards[1][k] =
                    if within { connected(lobe, &target, [above, back, *beam]) } else { 0.0 };
            }
        }
    }
}

// Closures may become functions of their own, compiled without the instruction set.

/// A direction that the lobe sends light from here to.
#[inline(always)]
fn drawn(lobe: Lobe, from: Beta, numbers: [f64; 2]) -> Beta {
    lobe.sample(from, numbers).unwrap_or(from)
}

/// What a beam sends to a direction below the diffuser that is seen from one above, by the technique that drew it from there.
#[inline(always)]
fn connected(lobe: Lobe, target: &Target, [above, below, beam]: [Beta; 3]) -> f64 {
    let value = lobe.density(below, beam);
    target.balanced(value, || 0.0, value / lobe.density(above, below))
}

/// Of the sine's square.
#[inline(always)]
fn cosine(squared: f64) -> f64 {
    (1.0 - squared).max(0.0).sqrt()
}

/// Adds those of a group that are wanted to the sums.
struct Add<'a, 'b> {
    walk: &'a Diffused<'b>,
    wanted: Range<u64>,
    first: u64,
    tally: &'a mut Tally,
}

impl WithSimd for Add<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { walk, wanted, first, tally } = self;
        let Tally { group, sums, .. } = tally;
        match &walk.stack.base.reflector {
            Reflector::Specular(AngularTable { nodes: Nodes::CosinePanels(panels), .. }) => {
                let wanted = |k: usize| wanted.contains(&(first + k as u64));
                walk.add_moments(
                    simd,
                    group,
                    std::array::from_fn(|k| f64::from(u8::from(wanted(k)))),
                    panels,
                    sums,
                );
            }
            _ => wanted.for_each(|path| walk.add(group, (path - first) as usize, sums)),
        }
    }
}

/// Adds look-ups at these cosines to channels, each with weights of its own. Those of several paths side by side,
/// panel by panel: rarely do they lie in more than two or three.
#[inline(always)]
fn look_up<S: Simd, const C: usize>(
    simd: S,
    panels: &CosinePanels,
    cosines: &Lanes,
    weights: [&Lanes; C],
    channels: [&mut Channel; C],
) {
    let mut places = [0; LANES];
    for (place, cosine) in places.iter_mut().zip(cosines) {
        *place = panels.panel(*cosine);
    }
    let mut left = (1_u32 << LANES) - 1;
    while left != 0 {
        let panel = places[left.trailing_zeros() as usize];
        let mut x = [0.0; LANES];
        let mut own = [[0.0; LANES]; C];
        for k in 0..LANES {
            let here = places[k] == panel;
            left &= !(u32::from(here) << k);
            let factor = f64::from(u8::from(here));
            // Elsewhere the polynomials might be huge.
            x[k] = factor * panels.within(panel, cosines[k]);
            for c in 0..C {
                own[c][k] = factor * weights[c][k];
            }
        }
        for c in 0..C {
            let moments = channels[c].moments(panel, panels.panel_count());
            add_polynomials(simd, &x, &own[c], moments);
        }
    }
}

/// Adds weights times Chebyshev's polynomials of degrees 0, 1, ... at x.
#[inline(always)]
fn add_polynomials<S: Simd>(simd: S, x: &Lanes, weights: &Lanes, moments: &mut Moments) {
    for first in (0..LANES).step_by(SIDE_BY_SIDE) {
        let of_half = first..first + SIDE_BY_SIDE;
        let (x, weights) = (S::as_simd_f64s(&x[of_half.clone()]).0, S::as_simd_f64s(&weights[of_half]).0);
        for (place, (x, weight)) in x.iter().zip(weights).enumerate() {
            // The weights' part in the polynomials: they need no product of their own.
            let twice = simd.add_f64s(*x, *x);
            let (mut before, mut now) = (simd.mul_f64s(*weight, *x), *weight);
            for sums in moments.iter_mut() {
                let sum = &mut S::as_mut_simd_f64s(sums).0[place];
                *sum = simd.add_f64s(*sum, now);
                (before, now) = (now, simd.sub_f64s(simd.mul_f64s(twice, now), before));
            }
        }
    }
}

impl Diffused<'_> {
    /// Whether [`Self::paths`] knows the way.
    pub(super) fn goes_together(&self) -> bool {
        let plain = self.specular && self.straight() == 0.0 && !self.discs;
        let drawn = matches!(self.first, First::Kernel(_));
        plain && drawn && self.width().is_some() && self.stack.medium.constant_index().is_some()
    }

    fn width(&self) -> Option<f64> {
        match self.diffuser.lobe {
            Lobe::KCorrelation { width } => Some(width),
            Lobe::Lambertian => None,
        }
    }

    pub(super) fn group(&self) -> Group {
        let none = FromSource { connected: [0.0; LANES], backwards: [[0.0; LANES]; 2], cosine: [0.0; LANES] };
        let lanes = [0.0; LANES];
        Group {
            above: [lanes; 2],
            below: lanes,
            cosine: lanes,
            leaving: lanes,
            survival: lanes,
            from_source: vec![none; self.sources.len()],
        }
    }

    /// These paths, if they go together.
    pub(super) fn paths_together(&self, numbers: &Numbers, paths: Range<u64>, tally: &mut Tally) {
        let Some(width) = self.width() else { return };
        let group_of = |path: u64| path / LANES as u64;
        for number in group_of(paths.start)..paths.end.div_ceil(LANES as u64) {
            let first = number * LANES as u64;
            let group = &mut tally.group;
            Arch::new().dispatch(Pass { walk: self, width, numbers, first, group });
            let wanted = paths.start.max(first)..paths.end.min(first + LANES as u64);
            Arch::new().dispatch(Add { walk: self, wanted: wanted.clone(), first, tally });
            for path in wanted {
                let k = (path - first) as usize;
                if tally.group.survival[k] < self.survival {
                    let above = Beta { x: tally.group.above[0][k], y: tally.group.above[1][k] };
                    let numbers = PathNumbers { numbers, path, start: numbers.block(path, 0) };
                    self.second_pass(above, &numbers, tally);
                }
            }
        }
    }

    /// Those paths of a group that count 1, and not 0, to the sums.
    #[inline(always)]
    fn add_moments<S: Simd>(
        &self,
        simd: S,
        group: &Group,
        counts: Lanes,
        panels: &CosinePanels,
        sums: &mut Sums,
    ) {
        let index = self.stack.medium.largest_index();
        let mut arriving = counts;
        let mut leaving = group.leaving;
        for k in 0..LANES {
            if group.below[k] >= index * index {
                arriving[k] = 0.0;
            }
            leaving[k] *= arriving[k];
        }
        sums.entering.add(None, counts.iter().sum());
        sums.arriving.add(None, arriving.iter().sum());
        let diffuse = [&mut sums.reflected, &mut sums.leaving];
        look_up(simd, panels, &group.cosine, [&arriving, &leaving], diffuse);
        for ((source, from), sum) in self.sources.iter().zip(&group.from_source).zip(&mut sums.from_source) {
            if let Source::Beam(_) = source {
                let (mut connected, mut backwards) = (from.connected, from.backwards[1]);
                for k in 0..LANES {
                    connected[k] *= arriving[k];
                    backwards[k] *= counts[k];
                }
                look_up(simd, panels, &group.cosine, [&connected], [&mut *sum]);
                look_up(simd, panels, &from.cosine, [&backwards], [sum]);
            }
        }
    }

    /// Path `k` of a group to the sums.
    #[inline(always)]
    fn add(&self, group: &Group, k: usize, sums: &mut Sums) {
        sums.entering.add(None, 1.0);
        let index = self.stack.medium.largest_index();
        for (from, sum) in group.from_source.iter().zip(&mut sums.from_source) {
            let [squared, weight] = from.backwards.map(|of| of[k]);
            if weight != 0.0 {
                sum.look_up(&self.look_up_at(squared), weight);
            }
        }
        let squared = group.below[k];
        if squared >= index * index {
            return;
        }
        let light = self.look_up_at(squared);
        sums.arriving.add(None, 1.0);
        sums.reflected.look_up(&light, 1.0);
        sums.leaving.look_up(&light, group.leaving[k]);
        for ((source, from), sum) in self.sources.iter().zip(&group.from_source).zip(&mut sums.from_source) {
            if let Source::Beam(_) = source {
                sum.look_up(&light, from.connected[k]);
            }
        }
    }

    /// All that comes after the first pass, for a path that goes on.
    #[cold]
    fn second_pass(&self, beta: Beta, numbers: &PathNumbers<'_>, tally: &mut Tally) {
        let light = Downward { beta, weight: 1.0, carries: false, scattered: false };
        let first = PassNumbers::new(numbers, 0, self);
        let Some(down) = self.through_anew(light, &first) else { return };
        if let Some(out) = self.go_on(light, down, &first, &mut tally.room) {
            self.passes(1, out.as_light(), numbers, tally);
        }
    }
}
