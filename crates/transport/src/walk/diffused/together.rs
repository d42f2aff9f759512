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
use crate::Source;
use crate::walk::{PathNumbers, Target};

/// Paths of a group.
const LANES: usize = 16;

/// A number for each path of a group.
type Lanes = [f64; LANES];

/// First passes of a group.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Above the diffuser, x and y.
    above: [Lanes; 2],
    /// Below it: `|beta|^2`.
    below: Lanes,
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
        let drawn = |from: Beta, k: usize| lobe.sample(from, [s[k], t[k]]).unwrap_or(from);
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for k in 0..LANES {
            let above = walk.view.sample_towards([u[k], v[k]]);
            (group.above[0][k], group.above[1][k]) = (above.x, above.y);
            let below = drawn(above, k);
            (x[k], y[k]) = (below.x, below.y);
            group.below[k] = below.squared();
        }
        let offsets = group.below.map(f64::sqrt);
        group.leaving = lobe.shares_in_disc(offsets, 1.0);
        let index = walk.stack.medium.largest_index();
        for (source, from) in walk.sources.iter().zip(&mut group.from_source) {
            let Source::Beam(beam) = source else { continue };
            let target = Target::beam(*beam);
            for k in 0..LANES {
                let above = Beta { x: group.above[0][k], y: group.above[1][k] };
                let below = Beta { x: x[k], y: y[k] };
                let towards = |from: Beta| {
                    let value = lobe.density(from, *beam);
                    target.balanced(value, || 0.0, value / lobe.density(above, from))
                };
                from.connected[k] = towards(below);
                let back = drawn(*beam, k);
                from.backwards[0][k] = back.squared();
                let within = back.squared() < index * index;
                from.backwards[1][k] = if within { towards(back) } else { 0.0 };
            }
        }
    }
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
    fn with_simd<S: Simd>(self, _: S) {
        let Self { walk, wanted, first, tally } = self;
        for path in wanted {
            walk.add(&tally.group, (path - first) as usize, &mut tally.sums);
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
        let none = FromSource { connected: [0.0; LANES], backwards: [[0.0; LANES]; 2] };
        let lanes = [0.0; LANES];
        Group {
            above: [lanes; 2],
            below: lanes,
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
