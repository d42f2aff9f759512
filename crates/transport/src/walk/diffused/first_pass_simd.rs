//! First passes of several paths at once, in SIMD registers.
//!
//! Over a mirror, with directions sampled from the lobe, and under diffuse light and beams, all first passes
//! take the same steps and end in weights on the nodes of the pixel's table. These steps are arithmetic
//! without branches, which compilers vectorise for the widest registers available. Only the positions of
//! look-ups are found path by path; the look-ups wait until there are enough of them in a panel of the
//! table.
//!
//! The borders of the groups of paths do not depend on how many paths are requested at a time. Each group is
//! computed completely, and the requested paths of it are added; sums are thus identical to the bit.

use std::ops::Range;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, Scatterer};
use papilio_sampling::SampleStream;
use pulp::{Arch, Simd, WithSimd};

use super::Diffused;
use super::first_pass::First;
use super::ledger::Sums;
use crate::walk::Target;
use crate::{AngularTable, CosinePanels, Nodes, Reflector, Source};

/// Paths of a group.
pub(in crate::walk) const LANES: usize = 64;

/// A number for each path of a group.
pub(in crate::walk) type Lanes = [f64; LANES];

/// First passes of a group.
#[derive(Debug)]
struct Group {
    /// Directions of the paths below the diffuser.
    below: Directions,
    /// Fraction of the light there that leaves.
    leaving: Lanes,
    beams: Vec<FromBeam>,
}

/// Directions in the medium.
#[derive(Debug)]
struct Directions {
    /// `|beta|^2`, and the cosine.
    squared: Lanes,
    cosine: Lanes,
    /// Part of a table in panels that contains the cosine.
    part: [u32; LANES],
}

/// Contributions of a beam, by both techniques.
#[derive(Debug)]
struct FromBeam {
    /// Number of the source, and its direction.
    source: usize,
    beam: Beta,
    /// Contribution to the direction that the path has sampled.
    connected: Lanes,
    /// Contribution to a direction sampled about the beam, and that direction.
    weight: Lanes,
    backwards: Directions,
}

impl Directions {
    const NONE: Self = Self { squared: [0.0; LANES], cosine: [0.0; LANES], part: [0; LANES] };

    /// Stores direction `k`. `medium`: one over the square of the index; `parts`: number of parts of the
    /// table.
    #[inline(always)]
    fn set(&mut self, k: usize, beta: Beta, medium: f64, parts: f64) {
        let squared = beta.squared();
        let cosine = (1.0 - squared * medium).max(0.0).sqrt();
        (self.squared[k], self.cosine[k]) = (squared, cosine);
        self.part[k] = CosinePanels::part(cosine, parts);
    }

    /// Returns `|beta|^2`, cosine and part of some paths.
    #[inline(always)]
    fn of(&self, wanted: &Range<usize>) -> impl Iterator<Item = (&f64, &f64, &u32)> + Clone {
        let at = || wanted.clone();
        self.squared[at()].iter().zip(&self.cosine[at()]).zip(&self.part[at()]).map(|((s, c), p)| (s, c, p))
    }
}

/// Computation of a group from its first path on.
struct Pass<'a, 'b> {
    walk: &'a Diffused<'b>,
    width: f64,
    parts: f64,
    numbers: &'a SampleStream,
    first: u64,
    group: &'a mut Group,
}

impl WithSimd for Pass<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { walk, width, parts, numbers, first, group } = self;
        // A lobe whose kind is known at compile time leaves no branch.
        let lobe = Lobe::KCorrelation { width };
        let drawn = Drawn::new(lobe, walk.view.sampler(), numbers, first);
        let index = walk.stack.medium.largest_index();
        let medium = 1.0 / (index * index);
        for k in 0..LANES {
            group.below.set(k, drawn.above(k) + drawn.offset(k), medium, parts);
        }
        for FromBeam { beam, connected, weight, backwards, .. } in &mut group.beams {
            drawn.connect(lobe, (*beam, index * index), connected, weight);
            for k in 0..LANES {
                backwards.set(k, *beam + drawn.offset(k), medium, parts);
            }
        }
    }
}

/// Directions of a group above the diffuser, and deflections by its lobe.
pub(in crate::walk) struct Drawn {
    above: [Lanes; 2],
    offset: [Lanes; 2],
}

impl Drawn {
    /// Draws the directions of the paths from the first on; `towards_field` samples the view.
    #[inline(always)]
    pub(in crate::walk) fn new(
        lobe: Lobe,
        towards_field: impl Fn([f64; 2]) -> Beta,
        numbers: &SampleStream,
        first: u64,
    ) -> Self {
        // Each step is done for all paths before the next, so that the processor can overlap independent
        // operations.
        let mut drawn = Self { above: [[0.0; LANES]; 2], offset: [[0.0; LANES]; 2] };
        let u: Lanes = numbers.batch(first, 0, 0);
        let v: Lanes = numbers.batch(first, 0, 1);
        let s: Lanes = numbers.batch(first, 0, 2);
        let t: Lanes = numbers.batch(first, 0, 3);
        for k in 0..LANES {
            let above = towards_field([u[k], v[k]]);
            (drawn.above[0][k], drawn.above[1][k]) = (above.x, above.y);
        }
        for k in 0..LANES {
            let offset = lobe.sample_direction(Beta::default(), [s[k], t[k]]).unwrap_or_default();
            (drawn.offset[0][k], drawn.offset[1][k]) = (offset.x, offset.y);
        }
        drawn
    }

    /// Direction of path `k` above the diffuser.
    #[inline(always)]
    pub(in crate::walk) fn above(&self, k: usize) -> Beta {
        Beta { x: self.above[0][k], y: self.above[1][k] }
    }

    /// Deflection of path `k`.
    #[inline(always)]
    pub(in crate::walk) fn offset(&self, k: usize) -> Beta {
        Beta { x: self.offset[0][k], y: self.offset[1][k] }
    }

    /// Computes the light of a beam in the directions that are sampled about the view, and in those about the
    /// beam; `square`: of the index of the medium.
    #[inline(always)]
    pub(in crate::walk) fn connect(
        &self,
        lobe: Lobe,
        (beam, square): (Beta, f64),
        connected: &mut Lanes,
        weight: &mut Lanes,
    ) {
        let target = Target::beam(beam);
        for (k, connected) in connected.iter_mut().enumerate() {
            let above = self.above(k);
            *connected = connection(lobe, &target, [above, above + self.offset(k), beam]);
        }
        for (k, weight) in weight.iter_mut().enumerate() {
            let below = beam + self.offset(k);
            let within = below.squared() < square;
            *weight = if within { connection(lobe, &target, [self.above(k), below, beam]) } else { 0.0 };
        }
    }
}

// A function, since closures may be compiled without the instruction set.

/// Returns the light that a beam sends into a direction below the diffuser that is seen from one above, by
/// the technique that sampled it from above.
#[inline(always)]
fn connection(lobe: Lobe, target: &Target, [above, below, beam]: [Beta; 3]) -> f64 {
    let value = lobe.density(below, beam);
    target.balanced(value, || 0.0, value / lobe.density(above, below))
}

impl Diffused<'_> {
    /// Returns whether [`Self::paths`] can compute first passes in groups.
    pub(super) fn first_passes_can_be_grouped(&self) -> bool {
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

    /// Computes the first passes of these paths in groups, if possible.
    pub(super) fn grouped_first_passes(&self, numbers: &SampleStream, paths: Range<u64>, sums: &mut Sums) {
        let Some(width) = self.width() else { return };
        let panels = match &self.stack.base.reflector {
            Reflector::Specular(AngularTable { nodes: Nodes::CosinePanels(panels), .. }) => Some(panels),
            _ => None,
        };
        let parts = panels.map_or(1.0, CosinePanels::part_count);
        let group = &mut self.group();
        if let Some(panels) = panels {
            sums.leaving.prepare(panels, true);
            group.beams.iter().for_each(|beam| sums.from_source[beam.source].prepare(panels, false));
        }
        let arch = Arch::new();
        let group_of = |path: u64| path / LANES as u64;
        for number in group_of(paths.start)..paths.end.div_ceil(LANES as u64) {
            let first = number * LANES as u64;
            arch.dispatch(Pass { walk: self, width, parts, numbers, first, group });
            group.leaving = self.leaving.at(&group.below.squared);
            let wanted = paths.start.max(first) - first..paths.end.min(first + LANES as u64) - first;
            let wanted = wanted.start as usize..wanted.end as usize;
            sums.entering.add(None, wanted.len() as f64);
            match panels {
                Some(panels) => self.add_in_panels(group, wanted, panels, sums),
                None => wanted.for_each(|k| self.add(group, k, sums)),
            }
        }
    }

    fn group(&self) -> Group {
        let from_beam = |(source, of): (usize, &Source)| match of {
            Source::Beam(beam) => Some(FromBeam {
                source,
                beam: *beam,
                connected: [0.0; LANES],
                weight: [0.0; LANES],
                backwards: Directions::NONE,
            }),
            Source::Diffuse | Source::Disc(_) | Source::Field(_) => None,
        };
        let beams = self.sources.iter().enumerate().filter_map(from_beam).collect();
        Group { below: Directions::NONE, leaving: [0.0; LANES], beams }
    }

    /// Adds these paths of a group to the sums, one path after the other, so that the order of look-ups does
    /// not depend on how calls divide groups.
    fn add_in_panels(&self, group: &Group, wanted: Range<usize>, panels: &CosinePanels, sums: &mut Sums) {
        let Sums { leaving, from_source, .. } = sums;
        let square = self.stack.medium.largest_index().powi(2);
        let below = group.below.of(&wanted);
        let mut arriving = 0.0;
        for ((squared, cosine, part), share) in below.clone().zip(&group.leaving[wanted.clone()]) {
            if *squared < square {
                leaving.look_up_in_panel(panels.panel_of(*part), *cosine, *share);
                arriving += 1.0;
            }
        }
        sums.arriving.add(None, arriving);
        for FromBeam { source, connected, weight, backwards, .. } in &group.beams {
            let sum = &mut from_source[*source];
            let connected = below.clone().zip(&connected[wanted.clone()]);
            let backwards = backwards.of(&wanted).zip(&weight[wanted.clone()]);
            for (((squared, cosine, part), connected), ((_, to, to_part), weight)) in connected.zip(backwards)
            {
                if *squared < square {
                    sum.look_up_in_panel(panels.panel_of(*part), *cosine, *connected);
                }
                if *weight != 0.0 {
                    sum.look_up_in_panel(panels.panel_of(*to_part), *to, *weight);
                }
            }
        }
    }

    /// Adds path `k` of a group to the sums, over a table without panels.
    fn add(&self, group: &Group, k: usize, sums: &mut Sums) {
        let square = self.stack.medium.largest_index().powi(2);
        let squared = group.below.squared[k];
        let light = (squared < square).then(|| self.look_up_at(squared));
        for FromBeam { source, connected, weight, backwards, .. } in &group.beams {
            let sum = &mut sums.from_source[*source];
            if let Some(light) = &light {
                sum.look_up(light, connected[k]);
            }
            if weight[k] != 0.0 {
                sum.look_up(&self.look_up_at(backwards.squared[k]), weight[k]);
            }
        }
        if let Some(light) = light {
            sums.arriving.add(None, 1.0);
            sums.reflected.look_up(&light, 1.0);
            sums.leaving.look_up(&light, group.leaving[k]);
        }
    }
}
