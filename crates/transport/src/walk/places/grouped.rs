//! Many paths at once: a lobe over a mirror-like pixel.
//!
//! Below a diffuser that reflects nothing, light meets a mirror-like pixel once, and all paths take the same
//! steps: arithmetic without branches, for the widest registers available, as in the walk without places.
//! Diffuse light is added in closed form, with the fraction of the lobe that leaves. Light of a beam is found
//! by two techniques, with directions sampled from the lobe about the viewer's ray and about the beam
//! (balance heuristic); each direction has a place of its own.
//!
//! The borders of the groups do not depend on how many paths are requested at a time.

use std::ops::Range;

use papilio_optics::lobe::Lobe;
use papilio_optics::{Beta, with_widest_simd};
use papilio_sampling::SampleStream;
use pulp::{Arch, Simd, WithSimd};

use super::light::{FirstMeeting, Shown};
use super::path::Trace;
use super::pattern::Meeting;
use super::tally::Sums;
use super::tracer::{Shows, Tracer};
use crate::angular::Stencil;
use crate::walk::diffused::{Drawn, Escape, LANES, Lanes};
use crate::{Diffuser, Interface, Nodes, Reflector, Source};

/// What groups need of a stack.
pub(super) struct Grouped<'a> {
    tracer: &'a Tracer<'a>,
    width: f64,
    index: f64,
    thickness_mm: f64,
    states: usize,
    /// Transmittance of the diffuser, twice.
    through: f64,
    nodes: &'a Nodes,
    leaving: &'a Escape,
    /// Numbers of the sources of diffuse light.
    diffuse: Vec<usize>,
}

/// Paths of a group.
struct Group {
    /// Where the viewer's own ray meets the pixel: 0 or a place in the period.
    own: [Lanes; 2],
    /// Where it enters the diffuser.
    from: [Lanes; 2],
    below: Meetings,
    beams: Vec<FromBeam>,
}

/// Meetings with the pixel.
struct Meetings {
    squared: Lanes,
    place_mm: [Lanes; 2],
}

/// Light of a beam, by both techniques.
struct FromBeam {
    source: usize,
    beam: Beta,
    /// Light at the direction sampled about the viewer's ray.
    connected: Lanes,
    /// Light at the direction sampled about the beam, and its meeting.
    weight: Lanes,
    backwards: Meetings,
}

impl Meetings {
    const NONE: Self = Self { squared: [0.0; LANES], place_mm: [[0.0; LANES]; 2] };

    /// Sets meeting `k`, of light of direction cosines `beta` that begins at `from`.
    #[inline(always)]
    fn set(&mut self, k: usize, beta: Beta, from: [f64; 2], [square, thickness_mm]: [f64; 2]) {
        let squared = beta.squared();
        // Directions that the medium does not have are left out later.
        let per_beta = thickness_mm / (square - squared).max(1e-12 * square).sqrt();
        self.squared[k] = squared;
        self.place_mm[0][k] = from[0] - beta.x * per_beta;
        self.place_mm[1][k] = from[1] - beta.y * per_beta;
    }
}

/// The fraction of the light below the diffuser that leaves, if paths can be traced in groups.
pub(super) fn leaving(tracer: &Tracer<'_>) -> Option<Escape> {
    lobe(tracer).map(|(diffuser, _, index)| Escape::new(diffuser.lobe, index))
}

/// The diffuser, the width of its lobe and the index of the medium below it, if all paths take the same
/// steps.
fn lobe<'a>(tracer: &Tracer<'a>) -> Option<(&'a Diffuser, f64, f64)> {
    let [layer] = &tracer.stack.layers[..] else { return None };
    let Interface::Diffuser(diffuser) = &layer.interface else { return None };
    let Lobe::KCorrelation { width } = diffuser.lobe else { return None };
    let index = layer.medium.constant_index()?;
    let clear = layer.medium.transmittance().is_none() && layer.medium.scattering().is_none();
    let plain = tracer.sources.iter().all(|source| matches!(source, Source::Diffuse | Source::Beam(_)));
    let is_uniform = clear && plain && tracer.bands == 1 && diffuser.regular_fraction == 0.0;
    let base = tracer.stack.base();
    (is_uniform && base.is_specular() && !base.is_azimuthal()).then_some((diffuser, width, index))
}

impl<'a> Grouped<'a> {
    /// `leaving` is the table of [`leaving`].
    pub(super) fn new(tracer: &'a Tracer<'a>, leaving: &'a Escape) -> Option<Self> {
        let (diffuser, width, index) = lobe(tracer)?;
        let Reflector::Specular(table) = &tracer.stack.base().reflector else { return None };
        let diffuse = tracer.sources.iter().enumerate().filter(|(_, source)| **source == Source::Diffuse);
        Some(Self {
            tracer,
            width,
            index,
            thickness_mm: tracer.stack.layers[0].thickness_mm,
            states: tracer.stack.base().states(),
            through: diffuser.transmittance[0].powi(2),
            nodes: &table.nodes,
            leaving,
            diffuse: diffuse.map(|(source, _)| source).collect(),
        })
    }

    /// Traces these paths.
    pub(super) fn trace(&self, numbers: &SampleStream, paths: Range<u64>, sums: &mut Sums<'_>) {
        let mut group = self.group();
        let shown = match self.tracer.shows {
            Shows::EachState => Shown::EachState,
            Shows::Pattern(_) => Shown::Covered(Vec::new()),
        };
        let first = FirstMeeting { beta_squared: 0.0, look_up: Stencil::ONLY_NODE, shown };
        let mut memory = (first, Trace::default());
        let arch = Arch::new();
        let lanes = LANES as u64;
        for number in paths.start / lanes..paths.end.div_ceil(lanes) {
            let start = number * lanes;
            arch.dispatch(Pass { walk: self, numbers, first: start, group: &mut group });
            let leaving: Lanes = self.leaving.at(&group.below.squared);
            let wanted = paths.start.max(start) - start..paths.end.min(start + lanes) - start;
            let wanted = wanted.start as usize..wanted.end as usize;
            with_widest_simd(
                #[inline(always)]
                || {
                    for k in wanted.clone() {
                        let of_beams = group.beams.iter().map(|one| (one.source, one.connected[k]));
                        let of_diffuse = self.diffuse.iter().map(|source| (*source, leaving[k]));
                        let own = [0, 1].map(|axis| group.own[axis][k]);
                        let all = of_diffuse.chain(of_beams);
                        self.meet((&group.below, own), k, all, &mut memory, sums);
                        for FromBeam { source, weight, backwards, .. } in &group.beams {
                            let light = std::iter::once((*source, weight[k]));
                            self.meet((backwards, own), k, light, &mut memory, sums);
                        }
                    }
                },
            );
        }
    }

    /// Adds light of several sources at meeting `k`.
    #[inline(always)]
    fn meet(
        &self,
        (meetings, own_mm): (&Meetings, [f64; 2]),
        k: usize,
        lights: impl Iterator<Item = (usize, f64)>,
        (first, trace): &mut (FirstMeeting, Trace),
        sums: &mut Sums<'_>,
    ) {
        let squared = meetings.squared[k];
        if squared >= self.index * self.index {
            return;
        }
        let place_mm = [meetings.place_mm[0][k], meetings.place_mm[1][k]];
        first.look_up = self.nodes.stencil(squared, self.index);
        if let Shows::Pattern(pattern) = self.tracer.shows {
            let meeting =
                Meeting { place_mm, own_mm, own_at_filter_mm: own_mm, passed_mm: own_mm, is_first: true };
            first.shown.set(pattern, &meeting, self.states);
        }
        let lights = lights.map(|(source, light)| (source, self.through * light));
        sums.add_meeting(place_mm, first, trace, lights);
    }

    fn group(&self) -> Group {
        let from_beam = |(source, of): (usize, &Source)| match of {
            Source::Beam(beam) => Some(FromBeam {
                source,
                beam: *beam,
                connected: [0.0; LANES],
                weight: [0.0; LANES],
                backwards: Meetings::NONE,
            }),
            Source::Diffuse | Source::Disc(_) | Source::Field(_) => None,
        };
        let beams = self.tracer.sources.iter().enumerate().filter_map(from_beam).collect();
        Group { own: [[0.0; LANES]; 2], from: [[0.0; LANES]; 2], below: Meetings::NONE, beams }
    }
}

/// Computation of a group from its first path on.
struct Pass<'a, 'b> {
    walk: &'a Grouped<'b>,
    numbers: &'a SampleStream,
    first: u64,
    group: &'a mut Group,
}

impl WithSimd for Pass<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self { walk, numbers, first, group } = self;
        let lobe = Lobe::KCorrelation { width: walk.width };
        let (square, thickness) = (walk.index * walk.index, walk.thickness_mm);
        let period = walk.tracer.period_mm();
        if period != [0.0; 2] {
            group.own = [0, 1].map(|k| numbers.batch(first, 1, k));
            let own = group.own.iter_mut().zip(period);
            own.for_each(|(own, period)| own.iter_mut().for_each(|place| *place *= period));
        }
        let drawn = Drawn::new(lobe, walk.tracer.view.sampler(), numbers, first);
        for k in 0..LANES {
            let above = drawn.above(k);
            let per_beta = thickness / (square - above.x.powi(2) - above.y.powi(2)).sqrt();
            group.from[0][k] = group.own[0][k] + above.x * per_beta;
            group.from[1][k] = group.own[1][k] + above.y * per_beta;
        }
        let Group { from, below, beams, .. } = group;
        let places: [[f64; 2]; LANES] = std::array::from_fn(|k| [from[0][k], from[1][k]]);
        for (k, place) in places.iter().enumerate() {
            below.set(k, drawn.above(k) + drawn.offset(k), *place, [square, thickness]);
        }
        for FromBeam { beam, connected, weight, backwards, .. } in beams {
            drawn.connect(lobe, (*beam, square), connected, weight);
            for (k, place) in places.iter().enumerate() {
                backwards.set(k, *beam + drawn.offset(k), *place, [square, thickness]);
            }
        }
    }
}
