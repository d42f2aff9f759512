//! Monte Carlo solver: unbiased path tracing through the stack, backwards from the viewer.
//!
//! # Estimator
//! A path starts with the direction cosines of light that reaches the viewer and follows the light back:
//! through the front, into the medium, to the base, out again, and into as many further passes as Russian
//! roulette grants. Every event is sampled from its own kernel, so the weight of a path holds only spectra.
//! One path carries all wavelengths and all states; contrast and gamut thus come from correlated estimates.
//!
//! The estimate for each source is `rho`, the *reflectance factor under that source alone*: `pi L / E`, by
//! state and wavelength, with L the radiance towards the viewer and E the illuminance of the source in the
//! display plane. Diffuse light is added wherever light leaves, with the exact fraction of it that leaves.
//! Beams are added by connections at every scattering event. Round sources and fields are found by
//! connections and by chance, weighted by the balance heuristic (Veach & Guibas 1995), so that nothing
//! counts twice. A narrow lobe between the direction of the viewer and that of the source is sampled from
//! both ends, again with the balance heuristic.
//!
//! Mirror images of round sources and fields are integrated separately from the paths, over the intersection
//! of the field of view and the image. Mirror images of beams have no radiance; they add nothing here (see
//! [`specular_image`](crate::specular_image)).
//!
//! # Speed
//! Scattering does not depend on wavelength. On its first pass a path only adds its weight to the nodes of
//! the [`AngularTable`](crate::AngularTable) of the base; spectra are formed once at the end. On later
//! passes the path carries spectra.
//!
//! # Tracers
//! There is one tracer each for a bare panel, a panel with a diffuser, and layers in any order. The last
//! sums everything that happens between two scattering events in closed form. It is the reference for all
//! stacks that a panel cannot describe.
//!
//! Media with a phase matrix have a fourth, which follows Stokes parameters (`stokes.rs`): in any layers, but event by event, as the
//! reference.
//!
//! [`Plain`] is none of these: it is the walk without any shortcut, in 170 lines (paths and slabs apart, in
//! `plain/`). Read it first; the others are tested against it.
//!
//! # Ledger
//! The same path also describes a unit beam that enters from the view direction (all kernels are
//! reciprocal). The light that ends in each layer is recorded; `unaccounted` is what roulette removed minus
//! what it added, zero on average.

mod accumulator;
mod bare;
mod diffused;
mod guide;
mod horizon;
mod images;
mod layered;
pub mod places;
mod plain;
mod stokes;
mod strategy;

use std::borrow::Cow;

use papilio_optics::{Beta, with_widest_simd};
use papilio_sampling::{PLANNED_BLOCKS, SampleStream, warp};

use crate::polarised_view::Changes;
use crate::{Cone, Estimate, Source, Stack, Top, WholeView};
use bare::Bare;
use diffused::Diffused;
use images::Images;
use layered::Layered;
pub use plain::Plain;
use stokes::Stokes;
pub use strategy::Strategy;

/// Uniform random numbers of one path. Its first blocks are planned ([`PLANNED_BLOCKS`]): those of the first
/// block have the smallest discrepancy, and serve the decisions with the largest effect.
struct PathNumbers<'a> {
    numbers: &'a SampleStream,
    path: u64,
    start: [f64; 4],
}

impl<'a> PathNumbers<'a> {
    #[inline]
    fn new(numbers: &'a SampleStream, path: u64) -> Self {
        Self { numbers, path, start: numbers.block(path, 0) }
    }

    /// Returns the numbers for the point in the viewer's field.
    #[inline]
    fn field(&self) -> [f64; 2] {
        [self.start[0], self.start[1]]
    }

    /// Returns the numbers for decisions that interact with the point in the field.
    #[inline]
    fn beside_field(&self) -> [f64; 2] {
        [self.start[2], self.start[3]]
    }

    /// Returns the numbers for the point of a mirror image.
    #[inline]
    fn image(&self) -> [f64; 2] {
        self.field()
    }

    /// Returns the numbers for the points of round sources.
    #[inline]
    fn on_discs(&self) -> [f64; 2] {
        [self.start[2], self.start[3]]
    }

    /// Returns four numbers; the blocks from 1 to `PLANNED_BLOCKS - 1` are planned, others are independent.
    #[inline]
    fn block(&self, block: u32) -> [f64; 4] {
        self.numbers.block(self.path, block)
    }

    /// Returns the numbers for the scattering of a source's light by scatterer number `k`: planned ones for
    /// the first.
    #[inline]
    fn of_sources(&self, k: u32) -> [f64; 4] {
        self.block(if k == 0 { PLANNED_BLOCKS - 1 } else { u32::MAX - k })
    }
}

/// The Monte Carlo solver, prepared for one stack, one view and its sources.
#[derive(Debug)]
pub struct Walk<'a> {
    kind: Kind<'a>,
    /// What polarised sources and a polariser change.
    changes: Option<Changes>,
}

#[derive(Debug)]
enum Kind<'a> {
    Bare(Bare<'a>, Images<'a>),
    Diffused(Box<Diffused<'a>>, Images<'a>),
    Layered(Box<Layered<'a>>, Images<'a>),
    Stokes(Box<Stokes<'a>>),
    /// Of a stack that keeps s and p apart: a walk for each, with the same random numbers, and their weights by source
    /// and in the ledger.
    Polarised(Box<[Walk<'a>; 2]>, Vec<[f64; 2]>, [f64; 2]),
}

impl<'a> Walk<'a> {
    /// Prepares a solver; `view` is the cone of directions (in air) that the viewer's field covers.
    pub fn new(stack: &'a Stack, view: Cone, sources: &'a [Source]) -> Self {
        Self::with_strategy(stack, view, sources, Strategy::default(), &[])
    }

    /// Prepares a solver as [`Self::new`] does. `strategy` selects how directions are sampled where a
    /// panel's diffuser scatters (for all other stacks, directions are always sampled from the kernel).
    ///
    /// `shares` are the fractions of the illuminance by source, for the guided strategy; missing ones are 1.
    pub fn with_strategy(
        stack: &'a Stack,
        view: Cone,
        sources: &'a [Source],
        strategy: Strategy,
        shares: &[f64],
    ) -> Self {
        Self::of_light(stack, (view, None), Cow::Borrowed(sources), (strategy, shares))
    }

    /// Prepares the tracer of Stokes parameters, which media with a phase matrix need.
    pub fn following_polarisation(stack: &'a Stack, view: Cone, sources: Cow<'a, [Source]>) -> Self {
        Self { kind: Kind::Stokes(Box::new(Stokes::new(stack, view, sources))), changes: None }
    }

    fn of_light(
        stack: &'a Stack,
        (view, polarised): (Cone, Option<(WholeView, usize)>),
        sources: Cow<'a, [Source]>,
        (strategy, shares): (Strategy, &[f64]),
    ) -> Self {
        if stack.has_phase_matrix() {
            return Self::following_polarisation(stack, view, sources);
        }
        let lit = stack;
        let stack = stack.in_runs();
        if let Some(both) = stack.polarised() {
            let of = |number: usize| {
                let own = match lit.polarised_view() {
                    Some(light) => Cow::Owned(light.sources(&sources, Some(number)).into_owned()),
                    None => sources.clone(),
                };
                let rays = lit.polarised_view().and_then(|light| light.rays());
                let polarised = rays.map(|seen| (seen.clone(), number));
                Self::of_light(&both[number], (view, polarised), own, (strategy, shares))
            };
            let walks = Box::new([0, 1].map(of));
            let weights = (lit.weights_by_source(Some(&view), &sources), lit.weights_of_polarisations());
            return Self { kind: Kind::Polarised(walks, weights.0, weights.1), changes: None };
        }
        let changes = lit.polarised_view().and_then(|light| light.changes(&view, &sources));
        let sources = match lit.polarised_view() {
            Some(light) => Cow::Owned(light.sources(&sources, None).into_owned()),
            None => sources,
        };
        let images = Images::new(stack, view, &sources, polarised, lit.phases());
        let kind = match stack.panel() {
            None => Kind::Layered(Box::new(Layered::new(stack, view, sources)), images),
            Some(panel) => match &panel.top {
                Top::Diffuser(diffuser) => {
                    let diffused = Diffused::new(panel, diffuser, view, sources, (strategy, shares));
                    Kind::Diffused(Box::new(diffused), images)
                }
                Top::IdealAr | Top::Fresnel(_) => Kind::Bare(Bare::new(panel, view, sources), images),
            },
        };
        Self { kind, changes }
    }

    /// Returns the smallest probability of a random choice that may carry a large fraction of the light; 1
    /// if nothing is chosen at random. Replicates that have each traced fewer paths than its reciprocal may
    /// agree by chance: their spread says little.
    pub fn rarest(&self) -> f64 {
        let (of_paths, images) = match &self.kind {
            Kind::Bare(bare, images) => (bare.rarest(), images),
            Kind::Diffused(diffused, images) => (diffused.rarest(), images),
            Kind::Layered(layered, images) => (layered.rarest(), images),
            Kind::Stokes(stokes) => return stokes.rarest(),
            Kind::Polarised(both, ..) => return both[0].rarest().min(both[1].rarest()),
        };
        of_paths.min(images.rarest())
    }

    /// Returns true if the error is smallest for numbers of paths that are powers of two, so that runs should
    /// double them: the tracers of panels take all their decisions from one low-discrepancy set.
    pub fn prefers_powers_of_two(&self) -> bool {
        match &self.kind {
            Kind::Bare(..) | Kind::Diffused(..) => true,
            Kind::Layered(..) | Kind::Stokes(_) => false,
            Kind::Polarised(both, ..) => both[0].prefers_powers_of_two(),
        }
    }

    /// Returns an empty replicate, to be filled by [`Self::trace`].
    pub fn replicate(&self) -> Replicate {
        let tally = match &self.kind {
            Kind::Bare(bare, images) => Accumulator::Bare(Box::new(bare.tally()), images.sums()),
            Kind::Diffused(diffused, images) => {
                Accumulator::Diffused(Box::new(diffused.tally()), images.sums())
            }
            Kind::Layered(layered, images) => Accumulator::Layered(Box::new(layered.tally()), images.sums()),
            Kind::Stokes(stokes) => Accumulator::Stokes(Box::new(stokes.sums())),
            Kind::Polarised(both, ..) => {
                Accumulator::Polarised(Box::new(both.each_ref().map(Self::replicate)))
            }
        };
        Replicate { paths: 0, tally }
    }

    /// Returns the number of paths that are traced together, a power of two: calls of [`Self::trace`] with
    /// fewer have more noise.
    pub fn batch(&self) -> u64 {
        match &self.kind {
            Kind::Layered(layered, _) => layered.batch_size(),
            Kind::Bare(..) | Kind::Diffused(..) | Kind::Stokes(_) => 1,
            Kind::Polarised(both, ..) => both[0].batch(),
        }
    }

    /// Traces `count` further paths of a replicate. The result depends only on the random numbers and the
    /// total number of paths; for layers in any order, whose paths are traced in batches, also on how the
    /// paths are divided among calls, unless each call ends at a multiple of [`Self::batch`].
    pub fn trace(&self, replicate: &mut Replicate, numbers: &SampleStream, count: u64) {
        let paths = replicate.paths..replicate.paths + count;
        let of = |path| PathNumbers::new(numbers, path);
        match (&self.kind, &mut replicate.tally) {
            (Kind::Bare(bare, images), Accumulator::Bare(tally, sums)) => {
                images.paths(paths.clone().map(of), sums);
                paths.map(of).for_each(|path| bare.path(&path, tally));
            }
            (Kind::Diffused(diffused, images), Accumulator::Diffused(tally, sums)) => {
                images.paths(paths.clone().map(of), sums);
                diffused.paths(numbers, paths, tally);
            }
            (Kind::Layered(layered, images), Accumulator::Layered(tally, sums)) => {
                images.paths(paths.clone().map(of), sums);
                layered.paths(numbers, paths, tally);
            }
            (Kind::Stokes(stokes), Accumulator::Stokes(sums)) => {
                paths.for_each(|path| stokes.trace(numbers, path, sums));
            }
            (Kind::Polarised(both, ..), Accumulator::Polarised(tallies)) => {
                let pairs = both.iter().zip(tallies.iter_mut());
                pairs.for_each(|(walk, tally)| walk.trace(tally, numbers, count));
            }
            // A replicate of another solver: its sums have no meaning here.
            _ => debug_assert!(false, "a replicate belongs to the walk that made it"),
        }
        replicate.paths += count;
    }

    /// Returns the means over the paths of a replicate, which must have traced at least one.
    pub fn estimate(&self, replicate: &Replicate) -> Estimate {
        self.estimates(std::slice::from_ref(replicate)).pop().unwrap_or_default()
    }

    /// Returns the means of several replicates. Their spectra are formed together, which takes a fraction of
    /// the time.
    pub fn estimates(&self, replicates: &[Replicate]) -> Vec<Estimate> {
        if let Kind::Polarised(both, by_source, weights) = &self.kind {
            return Self::means_of_both(both, (by_source, *weights), replicates);
        }
        let mut means = match &self.kind {
            Kind::Diffused(diffused, _) => diffused.estimates(&Self::diffused_sums(replicates)),
            Kind::Layered(layered, _) => {
                let tallies = replicates.iter().filter_map(|replicate| match &replicate.tally {
                    Accumulator::Layered(tally, _) => Some((&**tally, replicate.scale())),
                    _ => None,
                });
                layered.estimates(&tallies.collect::<Vec<_>>())
            }
            Kind::Bare(..) | Kind::Stokes(_) | Kind::Polarised(..) => {
                replicates.iter().map(|one| self.mean(one)).collect()
            }
        };
        let (Kind::Bare(_, images) | Kind::Diffused(_, images) | Kind::Layered(_, images)) = &self.kind
        else {
            return means;
        };
        for (mean, replicate) in means.iter_mut().zip(replicates) {
            let (Accumulator::Bare(_, sums) | Accumulator::Diffused(_, sums) | Accumulator::Layered(_, sums)) =
                &replicate.tally
            else {
                continue;
            };
            images.add_to(mean, sums, replicate.scale());
        }
        if let Some(changes) = &self.changes {
            means.iter_mut().for_each(|mean| changes.apply(&mut mean.rho));
        }
        means
    }

    /// Returns the means of several replicates, both polarisations together.
    fn means_of_both(
        both: &[Self; 2],
        (by_source, weights): (&[[f64; 2]], [f64; 2]),
        replicates: &[Replicate],
    ) -> Vec<Estimate> {
        let of = |polarisation: usize| {
            let own = replicates.iter().filter_map(|replicate| match &replicate.tally {
                Accumulator::Polarised(tallies) => Some(tallies[polarisation].clone()),
                _ => None,
            });
            both[polarisation].estimates(&own.collect::<Vec<_>>())
        };
        of(0).iter().zip(&of(1)).map(|(s, p)| s.mixed_with(p, by_source, weights)).collect()
    }

    fn diffused_sums(replicates: &[Replicate]) -> Vec<(&diffused::Accumulator, f64)> {
        let mut sums = Vec::with_capacity(replicates.len());
        for replicate in replicates {
            if let Accumulator::Diffused(tally, _) = &replicate.tally {
                sums.push((&**tally, replicate.scale()));
            }
        }
        sums
    }

    /// Returns the means without mirror images; an empty estimate for the replicate of another solver.
    fn mean(&self, replicate: &Replicate) -> Estimate {
        match (&self.kind, &replicate.tally) {
            (Kind::Bare(bare, _), Accumulator::Bare(tally, _)) => bare.estimate(tally, replicate.scale()),
            (Kind::Stokes(stokes), Accumulator::Stokes(sums)) => stokes.estimate(sums, replicate.scale()),
            _ => Estimate::default(),
        }
    }
}

/// Running sums of one replicate.
#[derive(Debug, Clone)]
pub struct Replicate {
    paths: u64,
    tally: Accumulator,
}

impl Replicate {
    /// Returns the number of paths traced so far.
    pub fn paths(&self) -> u64 {
        self.paths
    }

    /// Returns the factor that turns sums into means.
    fn scale(&self) -> f64 {
        1.0 / self.paths as f64
    }
}

#[derive(Debug, Clone)]
enum Accumulator {
    Bare(Box<bare::Accumulator>, images::Sums),
    Diffused(Box<diffused::Accumulator>, images::Sums),
    Layered(Box<layered::Accumulator>, images::Sums),
    Stokes(Box<stokes::Sums>),
    Polarised(Box<[Replicate; 2]>),
}

/// A point of a source to connect to, and its density over direction cosines (infinite for a beam).
#[derive(Debug, Clone, Copy)]
struct Target {
    beta: Beta,
    density: f64,
    /// `pi` times the radiance of the source over its illuminance; for a beam `pi`, the weight of its delta
    /// function.
    strength: f64,
}

impl Target {
    #[inline]
    fn sample(source: &Source, u: [f64; 2]) -> Option<Self> {
        match source {
            Source::Diffuse => None,
            Source::Beam(beta) => Some(Self::beam(*beta)),
            Source::Disc(cone) => Some(Self::on_disc(cone, -cone.sample_towards(u))),
            Source::Field(field) => {
                let (beta, density) = field.sample(u);
                Some(Self::in_field(beta, field.radiance(beta), density))
            }
        }
    }

    /// Returns the point of a source that light propagating with `beta` comes from, if the source has
    /// radiance there. Diffuse light, which is added in closed form, has no points.
    #[inline]
    fn at(source: &Source, beta: Beta) -> Option<Self> {
        match source {
            Source::Diffuse | Source::Beam(_) => None,
            Source::Disc(cone) => cone.sends(beta).then(|| Self::on_disc(cone, beta)),
            Source::Field(field) => {
                let radiance = field.radiance(beta);
                (radiance > 0.0).then(|| Self::in_field(beta, radiance, field.density(beta)))
            }
        }
    }

    #[inline(always)]
    fn beam(beta: Beta) -> Self {
        Self { beta, density: f64::INFINITY, strength: std::f64::consts::PI }
    }

    #[inline]
    fn on_disc(cone: &Cone, beta: Beta) -> Self {
        let strength = std::f64::consts::PI / cone.projected_solid_angle();
        Self { beta, density: cone.density(beta), strength }
    }

    #[inline]
    fn in_field(beta: Beta, radiance: f64, density: f64) -> Self {
        Self { beta, density, strength: std::f64::consts::PI * radiance }
    }

    /// Returns the contribution of one sample to `rho` where this connection is the only technique.
    #[inline]
    fn only_connection(&self, scatter: f64) -> f64 {
        if self.density.is_infinite() {
            self.strength * scatter
        } else {
            self.strength * scatter / self.density
        }
    }

    /// Returns the contribution of one sample to `rho` where a direction can reach this point by any of
    /// three techniques: the last scattering event, whose kernel has this `value` and is sampled with
    /// density `pdf`; this connection; and the direction before it sampled backwards from here, with a
    /// density of this `ratio` to that with which the path drew it (0: it is not sampled backwards).
    ///
    /// Balance heuristic: the integrand over the sum of the three products of densities. The value is the
    /// same for all techniques.
    #[inline(always)]
    fn balanced(&self, value: f64, pdf: impl FnOnce() -> f64, ratio: f64) -> f64 {
        if self.density.is_infinite() {
            self.strength * value / (1.0 + ratio)
        } else {
            self.strength * value / (self.density * (1.0 + ratio) + pdf())
        }
    }
}

/// Index of the medium above which so few directions can leave into the air that they are sampled
/// separately.
const DENSE: f64 = 2.0;

/// Samples a direction into which a Lambertian base in a medium of this index sends light. In a dense medium
/// every second one can leave, although only a small fraction of all directions can.
fn base_direction(index: f64, [u, v]: [f64; 2]) -> Beta {
    let (radius, u) = match index {
        _ if index <= DENSE => (index, u),
        _ if u < 0.5 => (1.0, 2.0 * u),
        _ => (index, 2.0 * u - 1.0),
    };
    let (x, y) = warp::uniform_disc(radius, [u, v]);
    Beta { x, y }
}

/// Returns the density of [`base_direction`] over direction cosines.
fn base_density(index: f64, to: Beta) -> f64 {
    let all = warp::uniform_disc_density(index);
    if index <= DENSE {
        return all;
    }
    0.5 * (all + if to.squared() < 1.0 { warp::uniform_disc_density(1.0) } else { 0.0 })
}

/// Multiplies each row of `rows` (shape `[state][wavelength]`) by `factor`.
fn scale_rows(rows: &mut [f64], factor: &[f64]) {
    with_widest_simd(
        #[inline(always)]
        || {
            for row in rows.chunks_exact_mut(factor.len()) {
                row.iter_mut().zip(factor).for_each(|(value, f)| *value *= f);
            }
        },
    );
}

/// `sum += scale * values`.
fn add_scaled(sum: &mut [f64], values: &[f64], scale: f64) {
    with_widest_simd(
        #[inline(always)]
        || sum.iter_mut().zip(values).for_each(|(s, v)| *s += v * scale),
    );
}

/// `sum[state][wavelength] += scale * values[state][wavelength] * factor[wavelength]`.
fn add_rows_times(sum: &mut [f64], values: &[f64], factor: &[f64], scale: f64) {
    let bins = factor.len();
    with_widest_simd(
        #[inline(always)]
        || {
            for (sum, row) in sum.chunks_exact_mut(bins).zip(values.chunks_exact(bins)) {
                sum.iter_mut().zip(row).zip(factor).for_each(|((s, v), f)| *s += scale * v * f);
            }
        },
    );
}
