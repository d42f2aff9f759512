//! First passes of several paths at once, as registers hold them.
//!
//! Over a mirror, with directions drawn from the lobe, diffuse light and beams, all first passes
//! go the same way and end in weights on the nodes of the pixel's table: what leads there is arithmetic
//! without a branch, which compilers spread over the widest registers that there are. Only where to look
//! things up is found path by path; the look-ups themselves wait until there are enough of them in a panel of the table.
//!
//! Paths stand in groups whose borders do not depend on how many are asked for at a time: each
//! group is computed whole and those wanted are added, so that sums are the same bits.

use std::ops::Range;

use papilio_optics::Beta;
use papilio_optics::lobe::Lobe;
use papilio_sampling::Numbers;
use pulp::{Arch, Simd, WithSimd};

use super::Diffused;
use super::books::{Sums, Tally};
use super::first::First;
use crate::walk::Target;
use crate::{AngularTable, CosinePanels, Nodes, Reflector, Source};

/// Paths of a group.
const LANES: usize = 16;

/// A number for each path of a group.
type Lanes = [f64; LANES];

/// First passes of a group.
#[derive(Debug, Clone)]
pub(super) struct Group {
    /// Below the diffuser: `|beta|^2`, and the cosine in the medium.
    below: Lanes,
    cosine: Lanes,
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
        let u: Lanes = numbers.side_by_side(first, 0, 0);
        let v: Lanes = numbers.side_by_side(first, 0, 1);
        let s: Lanes = numbers.side_by_side(first, 0, 2);
        let t: Lanes = numbers.side_by_side(first, 0, 3);
        // A lobe that is known to be of this kind leaves no branch.
        let lobe = Lobe::KCorrelation { width };
        let towards_field = walk.view.sampler();
        let [mut above_x, mut above_y, mut x, mut y] = [[0.0; LANES]; 4];
        let index = walk.stack.medium.largest_index();
        let per_square = 1.0 / (index * index);
        for k in 0..LANES {
            let above = towards_field([u[k], v[k]]);
            (above_x[k], above_y[k]) = (above.x, above.y);
            let below = drawn(lobe, above, [s[k], t[k]]);
            (x[k], y[k]) = (below.x, below.y);
            group.below[k] = below.squared();
            group.cosine[k] = cosine(below.squared() * per_square);
        }
        for (source, from) in walk.sources.iter().zip(&mut group.from_source) {
            let Source::Beam(beam) = source else { continue };
            let target = Target::beam(*beam);
            for k in 0..LANES {
                let above = Beta { x: above_x[k], y: above_y[k] };
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
        Group { below: lanes, cosine: lanes, from_source: vec![none; self.sources.len()] }
    }

    /// The first passes of these paths, if they go together.
    pub(super) fn first_passes_together(&self, numbers: &Numbers, paths: Range<u64>, tally: &mut Tally) {
        let Some(width) = self.width() else { return };
        let Tally { group, sums, .. } = tally;
        let arch = Arch::new();
        let group_of = |path: u64| path / LANES as u64;
        for number in group_of(paths.start)..paths.end.div_ceil(LANES as u64) {
            let first = number * LANES as u64;
            arch.dispatch(Pass { walk: self, width, numbers, first, group });
            let wanted = paths.start.max(first) - first..paths.end.min(first + LANES as u64) - first;
            let wanted = wanted.start as usize..wanted.end as usize;
            sums.entering.add(None, wanted.len() as f64);
            match &self.stack.base.reflector {
                Reflector::Specular(AngularTable { nodes: Nodes::CosinePanels(panels), .. }) => {
                    self.add_in_panels(group, wanted, panels, sums);
                }
                _ => wanted.for_each(|k| self.add(group, k, sums)),
            }
        }
    }

    /// These paths of a group to the sums.
    fn add_in_panels(&self, group: &Group, wanted: Range<usize>, panels: &CosinePanels, sums: &mut Sums) {
        let (index, count) = (self.stack.medium.largest_index(), panels.panel_count());
        let arriving = |k: &usize| group.below[*k] < index * index;
        sums.arriving.add(None, wanted.clone().filter(arriving).count() as f64);
        let places = panels.places(&group.cosine);
        let leaving = |k: usize| (places[k], self.leaving.at(group.below[k]));
        sums.leaving.look_up_in_panels(wanted.clone().filter(arriving).map(leaving), count);
        for ((source, from), sum) in self.sources.iter().zip(&group.from_source).zip(&mut sums.from_source) {
            if let Source::Beam(_) = source {
                let connected = |k: usize| (places[k], from.connected[k]);
                sum.look_up_in_panels(wanted.clone().filter(arriving).map(connected), count);
                let (places, [_, weights]) = (panels.places(&from.cosine), &from.backwards);
                let within = |k: &usize| weights[*k] != 0.0;
                sum.look_up_in_panels(wanted.clone().filter(within).map(|k| (places[k], weights[k])), count);
            }
        }
    }

    /// Path `k` of a group to the sums, over a table without panels.
    fn add(&self, group: &Group, k: usize, sums: &mut Sums) {
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
        sums.leaving.look_up(&light, self.leaving.at(group.below[k]));
        for ((source, from), sum) in self.sources.iter().zip(&group.from_source).zip(&mut sums.from_source) {
            if let Source::Beam(_) = source {
                sum.look_up(&light, from.connected[k]);
            }
        }
    }
}
