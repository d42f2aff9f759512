//! The tracer: one path at a time, with its place.

use std::borrow::Cow;

use super::branches::Branches;
use super::changing::{Changing, ChangingWork};
use super::dice::Dice;
use super::faces::Face;
use super::filter::FilterPlane;
use super::light::{Light, Shown};
use super::path::Path;
use super::pattern::Pattern;
use super::sample::RoundSample;
use super::tally::Record;
use crate::front::Flat;
use crate::mueller::LIGHT;
use crate::skeleton::{Part, Propagation};
use crate::walk::horizon::Horizons;
use crate::walk::{PathNumbers, Target};
use crate::{Cone, Layer, Medium, PixelSpread, Reflector, Source, Stack, WholeView};
use papilio_optics::Beta;

/// Light below this fraction of that at the first meeting with the pixel continues by roulette.
const FAINT: f64 = 0.1;

/// After this number of planes roulette applies whatever the light: nothing may be trapped forever.
const FREE: u32 = 1024;
const MOST_SURVIVAL: f64 = 0.95;

/// Number of planes after which roulette applies wherever the path is.
const OFTEN: u32 = 16;

/// A stack, its sources, and what is seen of its pixel.
pub(super) struct Tracer<'a> {
    pub(super) stack: &'a Stack,
    /// A pixel that changes polarisation below flat layers.
    pub(super) changing: Option<Changing<'a>>,
    /// The layers for s and for p, if they keep both apart.
    pub(super) of_each: Option<&'a [Vec<Layer>; 2]>,
    pub(super) view: Cone,
    pub(super) sources: Cow<'a, [Source]>,
    pub(super) shows: Shows<'a>,
    /// A filter above the pixel.
    pub(super) filter: Option<FilterPlane>,
    /// Spread of light inside a Lambertian pixel.
    pub(super) spread: Option<PixelSpread>,
    /// A sample that is not infinite.
    pub(super) sample: Option<RoundSample>,
    /// What is polarised where this is light of s (0) or of p (1) in flat layers above a mirror.
    pub(super) rays: Option<(WholeView, usize)>,
    pub(super) air: Medium,
    /// Where lobes of the stack have no bound.
    pub(super) horizons: Option<Horizons>,
    /// Scattering of each interface, of light going down and up.
    pub(super) faces: Vec<[Vec<Face<'a>>; 2]>,
    /// Directions of beams and of the centres of discs, if directions are sampled around them.
    pub(super) about: Vec<Beta>,
    /// True if sources have points to choose.
    has_points: bool,
    /// Number of places of a path: 1, or one for each wavelength.
    pub(super) places: usize,
    /// Number of wavelengths at which layers differ: 1 or all.
    pub(super) bands: usize,
}

/// What the plane of the pixel shows.
#[derive(Clone, Copy)]
pub(super) enum Shows<'a> {
    /// Image k shows state k everywhere.
    EachState,
    Pattern(&'a dyn Pattern),
}

/// Memory of a tracer.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    pub(super) path: Path,
    /// The last part of a connection to a source.
    pub(super) last: Path,
    pub(super) branches: Branches,
    /// A point of each source.
    pub(super) targets: Vec<Option<Target>>,
    pub(super) flat: FlatWork,
    /// That of a connection.
    pub(super) of_last: FlatWork,
    pub(super) pixel: PixelWork,
}

/// Numbers of an interface.
#[derive(Debug, Clone)]
pub(super) struct FlatWork {
    pub(super) parts: Vec<Part>,
    /// Fractions of the light that take each alternative; `[alternative][band]`.
    pub(super) fractions: Vec<f64>,
    pub(super) totals: Vec<f64>,
    /// By band.
    pub(super) factors: Vec<f64>,
}

/// Numbers of the pixel.
#[derive(Debug, Clone)]
pub(super) struct PixelWork {
    /// Reflectance of each state; `[state][wavelength]`.
    pub(super) reflectance: Vec<f64>,
    /// Reflectance of each image; `[image][wavelength]`.
    pub(super) mixed: Vec<f64>,
    /// The same where light entered a pixel inside which it spread.
    pub(super) entered: Vec<f64>,
    /// That of a pixel which changes polarisation.
    pub(super) changing: ChangingWork,
}

impl<'a> Tracer<'a> {
    pub(super) fn new(
        stack: &'a Stack,
        (view, sources): (Cone, Cow<'a, [Source]>),
        shows: Shows<'a>,
        filter: Option<FilterPlane>,
    ) -> Self {
        let bins = stack.base().bins();
        let horizons = Horizons::of(stack);
        let constant = stack.layers.iter().all(|layer| layer.medium.constant_index().is_some());
        let about = sources.iter().filter_map(Source::direction);
        let about = about.filter(|_| stack.base().is_specular()).collect();
        let has_points = sources.iter().any(Source::has_radiance);
        Self {
            stack,
            changing: Changing::of(stack),
            of_each: stack.layers_of_each(),
            view,
            sources,
            shows,
            air: Medium::new(vec![1.0; bins].into()),
            faces: Face::of(stack, horizons),
            horizons,
            about,
            has_points,
            places: if constant { 1 } else { bins },
            bands: if stack.is_grey() && filter.is_none() { 1 } else { bins },
            filter,
            spread: None,
            sample: None,
            rays: None,
        }
    }

    pub(super) fn bins(&self) -> usize {
        self.stack.base().bins()
    }

    /// Number of images.
    pub(super) fn images(&self) -> usize {
        match self.shows {
            Shows::EachState => self.stack.base().states(),
            Shows::Pattern(pattern) => pattern.images(),
        }
    }

    /// Period over which first places are distributed, mm.
    pub(super) fn period_mm(&self) -> [f64; 2] {
        match self.shows {
            Shows::EachState => [0.0; 2],
            Shows::Pattern(pattern) => pattern.period_mm(),
        }
    }

    /// Memory for paths, whose light has spectra from the start if they are wanted.
    pub(super) fn workspace(&self, spectra: bool) -> Workspace {
        let (bins, states, images) = (self.bins(), self.stack.base().states(), self.images());
        // The light of two places of a pattern is no sum of lights of states.
        let meets_two = self.spread.is_some() && matches!(self.shows, Shows::Pattern(_));
        // A look-up is by inclination alone.
        let base = self.stack.base();
        let looks_up =
            !matches!(base.reflector, Reflector::Scattering(_)) && !base.is_azimuthal() && !meets_two;
        let shown = match self.shows {
            Shows::EachState => Shown::EachState,
            Shows::Pattern(_) => Shown::Covered(Vec::new()),
        };
        let is_changed = self.changing.is_some();
        let as_number = self.bands == 1 && looks_up && !spectra && !is_changed;
        let light = Light::new((images, bins), as_number, is_changed, shown);
        let path = Path::new(light, self.places);
        let most = 2 + self.faces.iter().flatten().map(Vec::len).max().unwrap_or(0);
        let flat = FlatWork {
            parts: vec![Part::flat(Flat::CLEAR); self.bands],
            fractions: vec![0.0; most * self.bands],
            totals: vec![0.0; bins],
            factors: vec![0.0; self.bands],
        };
        Workspace {
            last: path.clone(),
            branches: Branches::default(),
            path,
            targets: vec![None; self.sources.len()],
            of_last: flat.clone(),
            flat,
            pixel: PixelWork {
                reflectance: vec![0.0; states * bins],
                mixed: vec![0.0; images * bins],
                entered: vec![0.0; if meets_two { images * bins } else { 0 }],
                changing: ChangingWork::default(),
            },
        }
    }

    /// Traces a path.
    pub(super) fn trace(&self, numbers: &PathNumbers<'_>, work: &mut Workspace, record: &mut impl Record) {
        self.choose_points(numbers, work);
        let path = &mut work.path;
        path.start(self.view.sample_towards(numbers.field()));
        let (u, period) = (numbers.beside_field(), self.period_mm());
        path.own_mm = [u[0] * period[0], u[1] * period[1]];
        path.passed_mm.clear();
        path.place_mm.fill(path.own_mm);
        // The view's own ray meets the pixel there.
        let beta = path.beta;
        for Layer { medium, thickness_mm, .. } in &self.stack.layers {
            path.move_back(|place| -per_beta(medium, place, beta, *thickness_mm));
        }
        path.entry_mm = path.place_mm.first().copied().unwrap_or_default();
        self.place_in_sample(numbers, path);
        path.own_at_filter_mm = path.own_mm;
        if let (Some(filter), Some(layer)) = (&self.filter, self.stack.layers.last()) {
            let way = per_beta(&layer.medium, self.bins() / 2, beta, filter.height_mm);
            path.own_at_filter_mm = [path.own_mm[0] + way * beta.x, path.own_mm[1] + way * beta.y];
        }
        let mut dice = Dice::new(numbers);
        if self.of_each.is_some() {
            // Light of the view is followed for s and for p.
            work.path.light.multiply(&[0.5]);
            let (other, _) = work.branches.add(&work.path, dice.branch());
            other.polarisation = 1;
        }
        loop {
            while self.step(&mut dice, work, record) && self.continues(&mut dice, work) {}
            let Some(counts) = work.branches.take(&mut work.path) else { return };
            dice.counts = counts;
        }
    }

    /// Traces a path back from a Lambertian pixel to the light that reaches it for the first time.
    pub(super) fn trace_up(&self, numbers: &PathNumbers<'_>, work: &mut Workspace, record: &mut impl Record) {
        self.choose_points(numbers, work);
        let (path, bottom) = (&mut work.path, 2 * self.stack.layers.len());
        path.start(Beta { x: 0.0, y: 0.0 });
        let (u, period) = (numbers.beside_field(), self.period_mm());
        path.own_mm = [u[0] * period[0], u[1] * period[1]];
        path.passed_mm.clear();
        path.place_mm.fill(path.own_mm);
        path.plane = bottom;
        let mut dice = Dice::new(numbers);
        self.leave_lambertian(&mut dice, work, record);
        let is_at_pixel = |path: &Path| path.going == Propagation::Down && path.plane == bottom;
        while !is_at_pixel(&work.path) && self.step(&mut dice, work, record) {
            if !self.continues(&mut dice, work) {
                return;
            }
        }
    }

    /// Chooses a point of each source.
    fn choose_points(&self, numbers: &PathNumbers<'_>, work: &mut Workspace) {
        let of_points = if self.has_points { numbers.of_sources(0) } else { [0.5; 4] };
        for (target, source) in work.targets.iter_mut().zip(self.sources.iter()) {
            *target = Target::sample(source, [of_points[0], of_points[1]]);
        }
    }

    /// A polarisation of scattered light, by chance.
    pub(super) fn any_polarisation(&self, dice: &mut Dice<'_>) -> usize {
        if self.of_each.is_some() { usize::from(dice.of_connection() < 0.5) } else { 0 }
    }

    /// Counts a step; false if roulette ends the path.
    fn continues(&self, dice: &mut Dice<'_>, work: &mut Workspace) -> bool {
        dice.counts.steps += 1;
        !dice.counts.steps.is_multiple_of(OFTEN) || self.survives(dice, &mut work.path)
    }

    /// Follows a path to its next plane; false if it ends.
    fn step(&self, dice: &mut Dice<'_>, work: &mut Workspace, record: &mut impl Record) -> bool {
        self.watch_edge(&mut work.path);
        let Path { plane, going, .. } = work.path;
        match going {
            Propagation::Up if plane == 0 => {
                self.leave(&mut work.path, record);
                false
            }
            Propagation::Down if plane == 2 * self.stack.layers.len() => {
                record.leaves(&mut work.path, true);
                self.meet_base(dice, work, record)
            }
            _ => {
                let element = if going == Propagation::Down { plane } else { plane - 1 };
                if element.is_multiple_of(2) {
                    return self.pass_interface(element / 2, dice, work, record);
                }
                let medium = &self.stack.layers[element / 2].medium;
                if medium.scattering().is_some() {
                    return self.pass_slab(element / 2, dice, work, record);
                }
                self.cross(element / 2, &mut work.path, &mut work.flat)
            }
        }
    }

    /// Light leaves into the air.
    fn leave(&self, path: &mut Path, record: &mut impl Record) {
        path.light.receive(LIGHT);
        for (number, source) in self.sources.iter().enumerate() {
            let of_ray = self.rays.as_ref().map_or(1.0, |(seen, polarisation)| {
                seen.weights(Some(&self.view), (number, source.direction()), path.beta)[*polarisation]
            });
            if *source == Source::Diffuse {
                record.receives(number, path, of_ray);
            } else if let Some(target) = Target::at(source, path.beta) {
                let weight = if path.density.is_finite() {
                    target.balanced(path.density, || path.density, 0.0)
                } else {
                    target.strength
                };
                record.receives(number, path, of_ray * weight);
            }
        }
        record.leaves(path, false);
    }

    /// Roulette; false if the path ends.
    pub(super) fn survives(&self, dice: &mut Dice<'_>, path: &mut Path) -> bool {
        let brightness = path.light.brightness();
        let most = if dice.counts.steps < FREE { 1.0 } else { MOST_SURVIVAL };
        let survival = (brightness / FAINT).min(most);
        if survival < 1.0 {
            if dice.of_connection() >= survival {
                return false;
            }
            path.light.multiply(&[1.0 / survival]);
        }
        true
    }
}

/// What a medium of this thickness moves light by, per unit of direction cosines, mm; 0 where it has no such
/// direction.
pub(super) fn per_beta(medium: &Medium, place: usize, beta: Beta, thickness_mm: f64) -> f64 {
    let index = medium.constant_index().unwrap_or_else(|| medium.index()[place]);
    let squared = index * index - beta.squared();
    if squared > 0.0 { thickness_mm / squared.sqrt() } else { 0.0 }
}
