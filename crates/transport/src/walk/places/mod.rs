//! Monte Carlo with places: what a viewer sees of a pixel that is not the same everywhere.
//!
//! A path carries the place (x, y) at which it is, in the plane of the panel. A crossing of a medium
//! (thickness d, index n) moves light of direction cosines beta by `d beta / sqrt(n^2 - |beta|^2)`, a flight
//! in a scattering medium by its own length; layers are uniform and act at one place. Where the path meets
//! the pixel, it reads there what the pattern shows. All orders of recycled light, all layers and all sources
//! are included. Estimates are unbiased for any pattern: this is the reference for the kernels and transfer
//! functions of [`spatial`](crate::spatial).
//!
//! # What is estimated
//! - [`What::Pattern`]: the reflectance factor of an actual [`Pattern`], at given places or as a mean over a
//!   period.
//! - [`What::Kernel`]: where uniform states are seen: `exp(-2 pi i f.r)` at chosen frequencies, and light in
//!   the cells of a grid. ([`Spreads`]: light that met the pixel once, and the response of all orders to a
//!   small change.)
//! - [`exits`](PlacedWalk::exits): where light that enters at one place leaves.
//! - [`entries`](PlacedWalk::entries): where light that reaches a place of the pixel entered.
//!
//! # Method
//! A plain path tracer, backwards from the viewer; nothing is summed in closed form, since a closed form does
//! not know where light meets the pixel. One event at a time is chosen in proportion to its light; until
//! light is scattered, all bright alternatives are followed (`branches`). At each scattering event the path
//! is connected to every directed source; the last part of a connection passes flat layers and mirrors by one
//! route, chosen like those of paths. Discs and fields are also found by chance (balance heuristic). A
//! scatterer above a mirror is sampled around the viewer's ray and around the rays of lamps: light of a lamp
//! is seen around both. A path carries all images and wavelengths; where an index depends on wavelength, it
//! has a place for each. Under layers without colour it carries one number until it meets the pixel a second
//! time (`light`). Below a lobe that reflects nothing, it meets a mirror-like pixel once, and many paths take
//! their steps together (`grouped`).
//!
//! The place of a meeting refers to that of the view's own ray. A field of view of some width is focused on
//! the pixel: own rays of all its directions meet the pixel at the same place.
//!
//! Below flat layers, light keeps its plane of incidence. Above a mirror-like pixel, each path is therefore followed once as light of s and once as light
//! of p, each with its own faces, films and sources; above a Lambertian one, it has one of both from meeting to meeting (`flat`). Above a pixel that changes
//! polarisation, it carries what a meter sees of polarised light (`changing`).
//!
//! Transforms cost a path the same at any number of frequencies (`waves`).
//!
//! Except for the groups, this tracer shares no estimator with [`Walk`](super::Walk): it is an independent
//! check of the uniform results, too.

mod bins;
mod branches;
mod changing;
mod connect;
mod dice;
mod faces;
mod filter;
mod flat;
mod grouped;
mod light;
mod path;
mod pattern;
mod pixel;
mod sample;
mod slab;
mod tally;
mod tracer;
mod waves;

use std::borrow::Cow;

use papilio_sampling::SampleStream;

use super::PathNumbers;
use super::diffused::Escape;
use crate::{Cone, PixelSpread, ReflectanceFactor, Reflector, Source, Stack};
pub use bins::CellGrid;
pub use filter::FilterPlane;
use grouped::Grouped;
use light::Recorded;
use papilio_optics::Beta;
use path::Path;
pub use pattern::{Matrix, Meeting, Pattern, SeenFrom, Shape, TwoStates, Uniform};
pub use sample::RoundSample;
pub use tally::{Kernel, KernelTally, Spreads};
use tally::{Plan, Record, Sums};
use tracer::{Shows, Tracer, Workspace};

/// Distance within which most light meets the pixel, in thicknesses of all layers.
const EXTENT: f64 = 4.0;

/// What a walk with places estimates.
pub enum What<'a> {
    /// What is seen of a pattern.
    Pattern(&'a dyn Pattern),
    /// The spread of each uniform state.
    Kernel(KernelTally),
    /// The spread of each image of a pattern, as a mean over its period; below a filter.
    KernelOf(&'a dyn Pattern, KernelTally),
}

/// Reason why there is no walk with places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PlaceError {
    /// A thickness is negative or not finite, mm.
    Thickness(f64),
    /// Channels are not those of the sources and wavelengths.
    Channels,
    /// A filter is not inside the lowest medium, or that medium scatters.
    Filter,
}

impl std::fmt::Display for PlaceError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Thickness(mm) => write!(f, "a thickness is {mm} mm; expected a length of at least 0"),
            Self::Channels => write!(f, "channels of a kernel do not match the sources and wavelengths"),
            Self::Filter => write!(
                f,
                "the colour filter is not inside a clear medium above the pixels (expected a height of at most the thickness of the lowest layer)"
            ),
        }
    }
}

impl std::error::Error for PlaceError {}

/// Means of a replicate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Estimate {
    /// Reflectance factor by source, `[image][wavelength]`; images are the states if kernels are tallied.
    pub rho: Vec<ReflectanceFactor>,
    /// Spread by source, if kernels are tallied.
    pub spreads: Vec<Spreads>,
}

/// Light that leaves a stack.
#[derive(Debug, Clone, Copy)]
pub struct Exit<'p> {
    /// Place relative to that of entry, mm.
    pub place_mm: [f64; 2],
    /// Place relative to the middle of a round sample, mm.
    pub from_middle_mm: [f64; 2],
    /// Whether the path has been beside the sample.
    pub left_sample: bool,
    /// Direction cosines.
    pub beta: Beta,
    /// False if it leaves into the air above, true if it arrives at the plane of the pixel.
    pub below: bool,
    /// Light, per unit that enters; by wavelength, or `[state][wavelength]` once it has met the pixel.
    pub light: &'p [f64],
}

/// Light of a source that reaches the pixel for the first time.
#[derive(Debug, Clone, Copy)]
pub struct Entry<'p> {
    /// Number of the source.
    pub source: usize,
    /// Where it meets the pixel, mm.
    pub place_mm: [f64; 2],
    /// Where it passed the plane of the filter, mm: one place for all wavelengths, or one for each; empty
    /// without filter.
    pub passed_mm: &'p [[f64; 2]],
    /// Irradiance over that of the source above the display, by wavelength.
    pub light: &'p [f64],
}

/// The Monte Carlo solver with places, for one stack, one view and its sources.
pub struct PlacedWalk<'a> {
    /// Of light of s and of p, where a mirror-like pixel and all above it keep them apart; else of all light.
    walks: Vec<OwnWalk<'a>>,
}

/// The walk of light of a polarisation, or of all light.
struct OwnWalk<'a> {
    tracer: Tracer<'a>,
    plan: Plan<'a>,
    /// Where paths can be traced in groups.
    leaving: Option<Escape>,
    /// How much it counts in what is seen of each source, and of unpolarised light.
    weights: Vec<f64>,
    weight: f64,
}

/// Running sums of one replicate of a walk with places.
pub struct PlacedReplicate<'w> {
    paths: u64,
    /// By walk.
    own: Vec<(Sums<'w>, Workspace)>,
}

impl PlacedReplicate<'_> {
    /// Returns the number of paths traced so far.
    pub fn paths(&self) -> u64 {
        self.paths
    }
}

impl<'a> PlacedWalk<'a> {
    /// Prepares a solver; `view` and `sources` are those of [`Walk::new`](super::Walk::new).
    ///
    /// # Errors
    /// If a thickness is negative, or channels do not match the sources and wavelengths.
    pub fn new(
        stack: &'a Stack,
        view: Cone,
        sources: &'a [Source],
        what: What<'a>,
    ) -> Result<Self, PlaceError> {
        Self::below(None, stack, (view, sources), what)
    }

    /// Prepares a solver for pixels below a filter, which is inside the lowest medium.
    ///
    /// # Errors
    /// Those of [`new`](Self::new); if the lowest medium scatters, is not above the whole filter, or its
    /// wavelengths are not those of the filter.
    pub fn filtered(
        filter: FilterPlane,
        stack: &'a Stack,
        (view, sources): (Cone, &'a [Source]),
        what: What<'a>,
    ) -> Result<Self, PlaceError> {
        let lowest = stack.layers.last().ok_or(PlaceError::Filter)?;
        let bins = stack.base().bins();
        let fits = filter.transmittance.len() == filter.windows.len()
            && filter.transmittance.iter().all(|one| one.len() == bins)
            && (0.0..=lowest.thickness_mm).contains(&filter.height_mm);
        if !fits || lowest.medium.scattering().is_some() {
            return Err(PlaceError::Filter);
        }
        Self::below(Some(filter), stack, (view, sources), what)
    }

    fn below(
        filter: Option<FilterPlane>,
        stack: &'a Stack,
        (view, sources): (Cone, &'a [Source]),
        what: What<'a>,
    ) -> Result<Self, PlaceError> {
        let mut thicknesses = stack.layers.iter().map(|layer| layer.thickness_mm);
        if let Some(wrong) = thicknesses.find(|mm| !(0.0..f64::INFINITY).contains(mm)) {
            return Err(PlaceError::Thickness(wrong));
        }
        let (shows, kernel) = match what {
            What::Pattern(pattern) => (Shows::Pattern(pattern), None),
            What::Kernel(kernel) => (Shows::EachState, Some(kernel)),
            // Light of patterns has spectra below filters only, and the nodes of the pixel know no images.
            What::KernelOf(..) if filter.is_none() => return Err(PlaceError::Filter),
            What::KernelOf(pattern, kernel) => (Shows::Pattern(pattern), Some(kernel)),
        };
        let fits = |kernel: &KernelTally| {
            let mut channels = kernel.channels.iter().flatten();
            kernel.channels.len() == sources.len() && channels.all(|one| one.len() == stack.base().bins())
        };
        if !kernel.as_ref().is_none_or(fits) {
            return Err(PlaceError::Channels);
        }
        let of = |(own, sources): (&'a Stack, Cow<'a, [Source]>), weights: Vec<f64>, weight: f64, rays| {
            let mut tracer = Tracer::new(own, (view, sources), shows, filter.clone());
            tracer.rays = rays;
            let plan = Plan::new(own.base(), tracer.images(), kernel.clone(), EXTENT * own.thickness_mm());
            // Groups do not cross the filter.
            let leaving = filter.is_none().then(|| grouped::leaving(&tracer)).flatten();
            OwnWalk { tracer, plan, leaving, weights, weight }
        };
        let Some(both) = stack.polarised() else {
            return Ok(Self {
                walks: vec![of((stack, sources.into()), vec![1.0; sources.len()], 1.0, None)],
            });
        };
        let (by_source, usual) =
            (stack.weights_by_source(Some(&view), sources), stack.weights_of_polarisations());
        let walks = both.iter().enumerate().map(|(number, own)| {
            let sources = stack.sources_of(number, sources);
            let rays = stack.polarised_view().and_then(|view| view.rays()).map(|seen| (seen.clone(), number));
            of((own, sources), by_source.iter().map(|weights| weights[number]).collect(), usual[number], rays)
        });
        Ok(Self { walks: walks.collect() })
    }

    /// The same walk over a Lambertian pixel inside which light spreads.
    #[must_use]
    pub fn with_spread(mut self, spread: Option<PixelSpread>) -> Self {
        for OwnWalk { tracer, .. } in &mut self.walks {
            tracer.spread =
                spread.filter(|_| matches!(tracer.stack.base().reflector, Reflector::Lambertian(_)));
        }
        self
    }

    /// The same walk in a round sample, for [`exits`](Self::exits) alone; the pattern must be uniform.
    #[must_use]
    pub fn in_sample(mut self, sample: Option<RoundSample>) -> Self {
        self.walks.iter_mut().for_each(|walk| walk.tracer.sample = sample);
        self
    }

    /// Returns an empty replicate, to be filled by [`Self::trace`].
    pub fn replicate(&self) -> PlacedReplicate<'_> {
        let own = self.walks.iter().map(|OwnWalk { tracer, plan, .. }| {
            (Sums::new(plan, tracer.sources.len()), tracer.workspace(false))
        });
        PlacedReplicate { paths: 0, own: own.collect() }
    }

    /// Traces `count` further paths of a replicate. The result depends only on the random numbers and the
    /// total number of paths, of which powers of two have the smallest error.
    pub fn trace(&self, replicate: &mut PlacedReplicate<'_>, numbers: &SampleStream, count: u64) {
        let PlacedReplicate { paths, own } = replicate;
        let wanted = *paths..*paths + count;
        *paths = wanted.end;
        for (OwnWalk { tracer, leaving, .. }, (sums, work)) in self.walks.iter().zip(own) {
            let wanted = wanted.clone();
            match leaving.as_ref().and_then(|leaving| Grouped::new(tracer, leaving)) {
                Some(grouped) => grouped.trace(numbers, wanted, sums),
                None => wanted.for_each(|path| tracer.trace(&PathNumbers::new(numbers, path), work, sums)),
            }
        }
    }

    /// Returns the means over the paths of a replicate, which must have traced at least one.
    pub fn estimate(&self, replicate: &PlacedReplicate<'_>) -> Estimate {
        let scale = 1.0 / replicate.paths as f64;
        let own = self.walks.iter().zip(&replicate.own);
        let mut all = own.map(|(walk, (sums, _))| sums.means(scale).times(&walk.weights));
        let first = all.next().unwrap_or_default();
        all.fold(first, |sum, more| sum.plus(&more))
    }

    /// Follows light that enters from where the viewer is, at one place, to where it leaves; `paths` are
    /// numbers of paths.
    ///
    /// All layers are reciprocal: light that reaches the viewer at this place comes from the same places. The
    /// sum over the exits above, over the number of paths, is what returns. Light is unpolarised.
    pub fn exits(&self, numbers: &SampleStream, paths: std::ops::Range<u64>, mut exit: impl FnMut(Exit<'_>)) {
        for OwnWalk { tracer, weight, .. } in &self.walks {
            let mut exits = Exits { exit: &mut exit, weight: *weight, light: Vec::new() };
            let mut work = tracer.workspace(true);
            let trace = |path| tracer.trace(&PathNumbers::new(numbers, path), &mut work, &mut exits);
            paths.clone().for_each(trace);
        }
    }
}

impl PlacedWalk<'_> {
    /// Follows light that reaches the pixel for the first time back to where it entered; `paths` are numbers
    /// of paths. Places on the pixel are distributed as those of the view's own ray. The sum over the
    /// entries, over the number of paths, is the mean irradiance.
    ///
    /// The pixel of the stack must be Lambertian: a mirror-like one would be part of the way to a beam.
    pub fn entries(&self, numbers: &SampleStream, paths: std::ops::Range<u64>, entry: impl FnMut(Entry<'_>)) {
        let Some(OwnWalk { tracer, .. }) = self.walks.first() else { return };
        let (mut work, mut entries) = (tracer.workspace(true), Entries { entry, light: Vec::new() });
        paths.for_each(|path| tracer.trace_up(&PathNumbers::new(numbers, path), &mut work, &mut entries));
    }
}

/// Passes on the light that enters.
struct Entries<F> {
    entry: F,
    light: Vec<f64>,
}

impl<F: FnMut(Entry<'_>)> Record for Entries<F> {
    fn receives(&mut self, source: usize, path: &Path, weight: f64) {
        let Recorded::Spectra(scale, spectra) = path.light.recorded() else { return };
        self.light.clear();
        self.light.extend(spectra.iter().map(|light| weight * scale * light));
        let (place_mm, passed_mm) = (path.own_mm, &path.passed_mm[..]);
        (self.entry)(Entry { source, place_mm, passed_mm, light: &self.light });
    }
}

/// Passes on the light that leaves.
struct Exits<F> {
    exit: F,
    weight: f64,
    light: Vec<f64>,
}

impl<F: FnMut(Exit<'_>)> Record for Exits<F> {
    fn receives(&mut self, _: usize, _: &Path, _: f64) {}

    fn leaves(&mut self, path: &mut Path, below: bool) {
        let [x, y] = path.place_mm.first().copied().unwrap_or_default();
        let from = |[from_x, from_y]: [f64; 2]| [x - from_x, y - from_y];
        let (place_mm, from_middle_mm) = (from(path.entry_mm), from(path.middle_mm));
        let left_sample = path.left_sample;
        self.light.clear();
        self.light.extend(path.light.as_spectra().iter().map(|light| self.weight * light));
        (self.exit)(Exit {
            place_mm,
            from_middle_mm,
            left_sample,
            beta: path.beta,
            below,
            light: &self.light,
        });
    }
}
