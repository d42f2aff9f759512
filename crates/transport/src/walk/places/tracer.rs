//! The tracer: one path at a time, with its place.

use papilio_optics::Beta;
use papilio_optics::phase::HenyeyGreenstein;
use papilio_sampling::{PLANNED_BLOCKS, warp};

use super::faces::Face;
use super::path::Path;
use super::pattern::Pattern;
use super::tally::Record;
use crate::front::Flat;
use crate::layers::{Departure, Scattered};
use crate::skeleton::{Part, Propagation};
use crate::walk::{PathNumbers, Target, add_scaled, base_density, base_direction};
use crate::{Cone, Layered, Medium, Reflector, Source};

/// Light below this fraction of that at the first meeting with the pixel continues by roulette.
const FAINT: f64 = 0.1;

/// After this number of planes roulette applies whatever the light: nothing may be trapped forever.
const FREE: u32 = 1024;
const MOST_SURVIVAL: f64 = 0.95;

/// Number of planes after which roulette applies wherever the path is.
const OFTEN: u32 = 16;

/// Fraction of the directions that are sampled around the directions of sources, where light passes a scatterer above a
/// mirror for the first time.
const TO_SOURCES: f64 = 0.5;

/// A stack with lengths, its sources, and what is seen of its pixel.
pub(super) struct Tracer<'a> {
    stack: &'a Layered,
    lengths_mm: Vec<f64>,
    view: Cone,
    sources: &'a [Source],
    pattern: Box<dyn Pattern + 'a>,
    air: Medium,
    /// Scattering of each interface, of light going down and up.
    faces: Vec<[Vec<Face<'a>>; 2]>,
    /// Directions of beams and of the centres of discs, if directions are sampled around them.
    about: Vec<Beta>,
    /// Number of places of a path: 1, or one for each wavelength.
    places: usize,
    /// Number of wavelengths at which layers differ: 1 or all.
    bands: usize,
}

/// Memory of a tracer.
#[derive(Debug, Clone)]
pub(super) struct Workspace {
    path: Path,
    /// The last part of a connection to a source.
    last: Path,
    /// A point of each source.
    targets: Vec<Option<Target>>,
    flat: FlatWork,
}

#[derive(Debug, Clone)]
struct FlatWork {
    parts: Vec<Part>,
    /// Fractions of the light that take each alternative; `[alternative][band]`.
    fractions: Vec<f64>,
    totals: Vec<f64>,
    factors: Vec<f64>,
    /// Reflectance of each state; `[state][wavelength]`.
    reflectance: Vec<f64>,
    /// Coverage of each state; `[image][state]`.
    coverages: Vec<f64>,
    /// Reflectance of each image; `[image][wavelength]`.
    mixed: Vec<f64>,
}

/// Random numbers of a path.
struct Dice<'n> {
    numbers: &'n PathNumbers<'n>,
    /// Planes that the path has reached.
    steps: u32,
    event: u32,
    of_connections: u32,
}

impl Dice<'_> {
    /// Numbers of the next event; those of points of the sources are left out.
    fn next(&mut self) -> [f64; 4] {
        self.event += if self.event + 2 == PLANNED_BLOCKS { 2 } else { 1 };
        self.numbers.block(self.event)
    }

    /// A number for a connection; independent of those of events.
    fn of_connection(&mut self) -> f64 {
        self.of_connections += 1;
        self.numbers.block(u32::MAX - self.of_connections)[0]
    }
}

impl<'a> Tracer<'a> {
    pub(super) fn new(
        stack: &'a Layered,
        lengths_mm: Vec<f64>,
        (view, sources): (Cone, &'a [Source]),
        pattern: Box<dyn Pattern + 'a>,
    ) -> Self {
        let bins = stack.base.bins();
        let constant = stack.layers.iter().all(|layer| layer.medium.constant_index().is_some());
        let about = sources.iter().filter_map(|source| match source {
            Source::Beam(beta) => Some(*beta),
            Source::Disc(cone) => Some(-cone.axis_towards()),
            Source::Diffuse | Source::Field(_) => None,
        });
        Self {
            stack,
            lengths_mm,
            view,
            sources,
            pattern,
            air: Medium::new(vec![1.0; bins].into()),
            faces: Face::of(stack),
            about: about.filter(|_| stack.base.is_specular()).collect(),
            places: if constant { 1 } else { bins },
            bands: if stack.is_grey() { 1 } else { bins },
        }
    }

    pub(super) fn bins(&self) -> usize {
        self.stack.base.bins()
    }

    pub(super) fn workspace(&self) -> Workspace {
        let (bins, states, images) = (self.bins(), self.stack.base.states(), self.pattern.images());
        let path = Path::new(images, bins, self.places);
        let most = 2 + self.faces.iter().flatten().map(Vec::len).max().unwrap_or(0);
        Workspace {
            last: path.clone(),
            path,
            targets: vec![None; self.sources.len()],
            flat: FlatWork {
                parts: vec![Part::flat(Flat::CLEAR); self.bands],
                fractions: vec![0.0; most * self.bands],
                totals: vec![0.0; bins],
                factors: vec![0.0; bins],
                reflectance: vec![0.0; states * bins],
                coverages: vec![0.0; images * states],
                mixed: vec![0.0; images * bins],
            },
        }
    }

    /// Traces a path.
    pub(super) fn trace(&self, numbers: &PathNumbers<'_>, work: &mut Workspace, record: &mut impl Record) {
        for (target, source) in work.targets.iter_mut().zip(self.sources) {
            *target =
                Target::sample(source, numbers.of_sources(0).first_chunk().copied().unwrap_or([0.5; 2]));
        }
        let path = &mut work.path;
        path.start(self.view.sample_towards(numbers.field()));
        let (u, period) = (numbers.beside_field(), self.pattern.period_mm());
        path.place_mm.fill([u[0] * period[0], u[1] * period[1]]);
        // The view's own ray meets the pixel there.
        let beta = path.beta;
        for (layer, length) in self.stack.layers.iter().zip(&self.lengths_mm) {
            path.move_back(|place| -per_beta(&layer.medium, place, beta, *length));
        }
        path.entry_mm = path.place_mm.first().copied().unwrap_or_default();
        let mut dice = Dice { numbers, steps: 0, event: 0, of_connections: 1 };
        while self.step(&mut dice, work, record) {
            dice.steps += 1;
            if dice.steps.is_multiple_of(OFTEN) && !self.survives(&mut dice, &mut work.path) {
                return;
            }
        }
    }

    /// Follows a path to its next plane; false if it ends.
    fn step(&self, dice: &mut Dice<'_>, work: &mut Workspace, record: &mut impl Record) -> bool {
        let Path { plane, going, .. } = work.path;
        match going {
            Propagation::Up if plane == 0 => {
                self.leave(&work.path, record);
                false
            }
            Propagation::Down if plane == 2 * self.stack.layers.len() => {
                record.leaves(&work.path, true);
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
    fn leave(&self, path: &Path, record: &mut impl Record) {
        for (number, source) in self.sources.iter().enumerate() {
            if *source == Source::Diffuse {
                record.receives(number, path, 1.0);
            } else if let Some(target) = Target::at(source, path.beta) {
                let weight = if path.density.is_finite() {
                    target.balanced(path.density, || path.density, 0.0)
                } else {
                    target.strength
                };
                record.receives(number, path, weight);
            }
        }
        record.leaves(path, false);
    }

    /// Crosses a medium without scattering, or what of it is not scattered.
    fn cross(&self, layer: usize, path: &mut Path, flat: &mut FlatWork) -> bool {
        let medium = &self.stack.layers[layer].medium;
        let squared = path.beta.squared();
        if squared >= medium.largest_index().powi(2) {
            return false;
        }
        let depth = medium.scattering().map_or(0.0, |scattering| scattering.optical_thickness);
        if self.places > 1 || depth > 0.0 || medium.transmittance().is_some() {
            for (bin, factor) in flat.factors.iter_mut().enumerate() {
                let cosine = (1.0 - squared / medium.index()[bin].powi(2)).max(0.0).sqrt();
                let clear = medium.transmittance().map_or(1.0, |t| t[bin].powf(1.0 / cosine));
                *factor = if cosine > 0.0 { clear * (-depth / cosine).exp() } else { 0.0 };
            }
            path.multiply(&flat.factors);
        }
        self.move_across(layer, path, 1.0);
        path.advance();
        true
    }

    /// Moves a path by what a part of the thickness of a medium moves it.
    fn move_across(&self, layer: usize, path: &mut Path, part: f64) {
        let (medium, length) = (&self.stack.layers[layer].medium, part * self.lengths_mm[layer]);
        if length > 0.0 {
            let beta = path.beta;
            path.move_back(|place| per_beta(medium, place, beta, length));
        }
    }

    /// Reflection by the pixel at the place of the path, with the reflectance of each state that is in the workspace.
    fn reflect(&self, path: &mut Path, flat: &mut FlatWork, record: &impl Record) {
        let (bins, states) = (self.bins(), self.stack.base.states());
        let FlatWork { reflectance, coverages, mixed, .. } = flat;
        mixed.fill(0.0);
        for (k, place) in path.place_mm.iter().enumerate() {
            coverages.fill(0.0);
            self.pattern.coverages(*place, coverages);
            let here = path.bins_at(k);
            for (row, of_image) in mixed.chunks_exact_mut(bins).zip(coverages.chunks_exact(states)) {
                for (coverage, of_state) in of_image.iter().zip(reflectance.chunks_exact(bins)) {
                    if *coverage != 0.0 {
                        add_scaled(&mut row[here.clone()], &of_state[here.clone()], *coverage);
                    }
                }
            }
        }
        path.reflect(mixed);
        record.meets(path);
    }

    /// Reflection and transmission by an interface, and scattering.
    fn pass_interface(
        &self,
        number: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        let going = work.path.going;
        self.prepare(number, &work.path, &mut work.flat);
        let faces = &self.faces[number][going as usize];
        let length = work.path.beta.length();
        for (k, face) in faces.iter().enumerate() {
            let FlatWork { parts, fractions, .. } = &mut work.flat;
            let out = &mut fractions[(2 + k) * self.bands..][..self.bands];
            face.fraction(length, out, |band| parts[band].scattered[going as usize]);
        }
        let first = work.path.meetings == 0 && going == Propagation::Down && !self.about.is_empty();
        for (k, face) in faces.iter().enumerate() {
            self.connect_from_face((number, face, first && face.passes()), 2 + k, dice, work, record);
        }
        let alternatives = 2 + faces.len();
        let Some(chosen) = self.choose(alternatives, || dice.next()[0], &mut work.path, &mut work.flat)
        else {
            return false;
        };
        let path = &mut work.path;
        match chosen {
            0 => path.turn(),
            1 => path.advance(),
            _ => {
                let face = &faces[chosen - 2];
                let Some((to, density, weight)) =
                    self.sample(face, first && face.passes(), path.beta, dice.next())
                else {
                    return false;
                };
                let FlatWork { factors, .. } = &mut work.flat;
                for (bin, factor) in factors.iter_mut().enumerate() {
                    *factor = weight * face.carried(to, bin);
                }
                if factors.iter().all(|factor| *factor == 0.0) {
                    return false;
                }
                path.multiply(factors);
                path.depart_from(2 * number, to.going);
                (path.beta, path.density) = (to.beta, density);
            }
        }
        true
    }

    /// Fractions of light that an interface reflects (alternative 0) and transmits (1), by band.
    fn prepare(&self, number: usize, path: &Path, flat: &mut FlatWork) {
        let upper = if number == 0 { &self.air } else { &self.stack.layers[number - 1].medium };
        let layer = &self.stack.layers[number];
        let FlatWork { parts, fractions, .. } = flat;
        layer.interface.kind().parts([upper, &layer.medium], path.beta.squared(), parts);
        for (band, part) in parts.iter().enumerate() {
            let Flat { t, above, below } = part.flat;
            fractions[band] = if path.going == Propagation::Down { above } else { below };
            fractions[self.bands + band] = t;
        }
    }

    /// Chooses one of the first alternatives in proportion to its light; `None` if all is absorbed.
    fn choose(
        &self,
        alternatives: usize,
        u: impl FnOnce() -> f64,
        path: &mut Path,
        flat: &mut FlatWork,
    ) -> Option<usize> {
        let FlatWork { fractions, totals, factors, .. } = flat;
        if self.bands > 1 {
            totals.fill(0.0);
            path.add_total(totals);
        }
        let weight = |k: usize| -> f64 {
            let fractions = &fractions[k * self.bands..][..self.bands];
            match fractions {
                [fraction] => *fraction,
                _ => fractions.iter().zip(&*totals).map(|(fraction, total)| fraction * total).sum(),
            }
        };
        let mut weights = [0.0; MOST];
        let weights = weights.get_mut(..alternatives)?;
        weights.iter_mut().enumerate().for_each(|(k, out)| *out = weight(k));
        let sum: f64 = weights.iter().sum();
        if sum <= 0.0 {
            return None;
        }
        let mut chosen = weights.iter().position(|weight| *weight > 0.0)?;
        if weights[chosen] < sum {
            let mut rest = u() * sum;
            for (k, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
                chosen = k;
                if rest < *weight {
                    break;
                }
                rest -= weight;
            }
        }
        let scale = sum / weights[chosen];
        let factors = &mut factors[..self.bands];
        let taken = &fractions[chosen * self.bands..][..self.bands];
        factors.iter_mut().zip(taken).for_each(|(factor, fraction)| *factor = scale * fraction);
        path.multiply(factors);
        Some(chosen)
    }

    /// Samples a direction; returns it with its density, and the value of the kernel over that density.
    fn sample(
        &self,
        face: &Face<'_>,
        guided: bool,
        from: Beta,
        u: [f64; 4],
    ) -> Option<(Departure, f64, f64)> {
        if !guided {
            let (to, Scattered { value, density, .. }) = face.sample(from, u)?;
            return Some((to, density, value / density));
        }
        let [choice, ..] = u;
        let (axis, rest) = if choice < TO_SOURCES {
            let place = choice / TO_SOURCES * self.about.len() as f64;
            (self.about[(place as usize).min(self.about.len() - 1)], place.fract())
        } else {
            (from, (choice - TO_SOURCES) / (1.0 - TO_SOURCES))
        };
        let (to, _) = face.sample(axis, [rest, u[1], u[2], u[3]])?;
        let (value, density) = self.guided(face, from, to);
        Some((to, density, value / density))
    }

    /// Value of a kernel, and the density of directions that are also sampled around those of sources.
    fn guided(&self, face: &Face<'_>, from: Beta, to: Departure) -> (f64, f64) {
        let Scattered { value, density, .. } = face.scatter(from, to);
        let of_sources: f64 = self.about.iter().map(|axis| face.scatter(*axis, to).density).sum();
        (value, (1.0 - TO_SOURCES) * density + TO_SOURCES * of_sources / self.about.len() as f64)
    }

    /// Connects light that an interface scatters on a channel to all sources.
    fn connect_from_face(
        &self,
        (number, face, guided): (usize, &Face<'_>, bool),
        alternative: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) {
        let Workspace { path, last, targets, flat } = work;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            for going in face.leaves() {
                let to = Departure { beta: target.beta, going: *going };
                let (value, density) = if guided {
                    self.guided(face, path.beta, to)
                } else {
                    let Scattered { value, density, .. } = face.scatter(path.beta, to);
                    (value, density)
                };
                let weight = target.balanced(value, || density, 0.0);
                if weight <= 0.0 {
                    continue;
                }
                last.copy(path);
                for bin in 0..self.bins() {
                    let fraction = flat.fractions[alternative * self.bands + bin.min(self.bands - 1)];
                    flat.factors[bin] = weight * fraction * face.spread(*going, bin);
                }
                last.multiply(&flat.factors);
                last.depart_from(2 * number, *going);
                last.beta = target.beta;
                let mut work = Last { last: &mut *last, parts: flat };
                self.reach(source, &mut work, dice, record);
                // The fractions of this interface are needed again.
                self.prepare(number, path, flat);
            }
        }
    }

    /// Follows light towards a source through all flat layers, by one route; adds what arrives.
    fn reach(&self, source: usize, work: &mut Last<'_>, dice: &mut Dice<'_>, record: &mut impl Record) {
        let Last { last: path, parts: flat } = work;
        loop {
            match path.going {
                Propagation::Up if path.plane == 0 => return record.receives(source, path, 1.0),
                Propagation::Down if path.plane == 2 * self.stack.layers.len() => {
                    if !self.stack.base.is_specular() {
                        return;
                    }
                    self.reflect_by_mirror(path, flat, record);
                    if path.brightness() == 0.0 {
                        return;
                    }
                }
                going => {
                    let element = if going == Propagation::Down { path.plane } else { path.plane - 1 };
                    if element.is_multiple_of(2) {
                        self.prepare(element / 2, path, flat);
                        match self.choose(2, || dice.of_connection(), path, flat) {
                            None => return,
                            Some(0) => path.turn(),
                            Some(_) => path.advance(),
                        }
                    } else if !self.cross(element / 2, path, flat) {
                        return;
                    }
                }
            }
        }
    }

    fn reflect_by_mirror(&self, path: &mut Path, flat: &mut FlatWork, record: &impl Record) {
        self.stack.base.reflectance(path.beta.squared(), self.lowest(), &mut flat.reflectance);
        self.reflect(path, flat, record);
        path.going = Propagation::Up;
    }

    /// The medium above the pixel.
    fn lowest(&self) -> &Medium {
        self.stack.layers.last().map_or(&self.air, |layer| &layer.medium)
    }

    /// Reflection by the pixel; false if the path ends.
    fn meet_base(&self, dice: &mut Dice<'_>, work: &mut Workspace, record: &mut impl Record) -> bool {
        match &self.stack.base.reflector {
            Reflector::Specular(_) => {
                self.reflect_by_mirror(&mut work.path, &mut work.flat, record);
                self.survives(dice, &mut work.path)
            }
            Reflector::Lambertian(reflectance) => {
                work.flat.reflectance.copy_from_slice(reflectance);
                self.reflect(&mut work.path, &mut work.flat, record);
                if !self.survives(dice, &mut work.path) {
                    return false;
                }
                self.leave_lambertian(dice, work, record)
            }
            Reflector::Scattering(kernels) => self.leave_kernels(kernels, dice, work, record),
        }
    }

    /// Light leaves a Lambertian pixel: the same basic radiance in all directions of the medium.
    fn leave_lambertian(&self, dice: &mut Dice<'_>, work: &mut Workspace, record: &mut impl Record) -> bool {
        let medium = self.lowest();
        let largest = medium.largest_index();
        let value = warp::uniform_disc_density(largest);
        // Over the disc of each wavelength, where the value is that of the largest.
        let spread = |beta: Beta, bin: usize| {
            let n = medium.index()[bin];
            if beta.squared() < n * n { (largest / n).powi(2) } else { 0.0 }
        };
        let Workspace { path, last, targets, flat } = work;
        path.going = Propagation::Up;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            let weight = target.balanced(value, || base_density(largest, target.beta), 0.0);
            last.copy(path);
            last.beta = target.beta;
            let factors = flat.factors.iter_mut().enumerate();
            factors.for_each(|(bin, factor)| *factor = weight * spread(target.beta, bin));
            last.multiply(&flat.factors);
            self.reach(source, &mut Last { last, parts: flat }, dice, record);
        }
        let [u, v, ..] = dice.next();
        path.beta = base_direction(largest, [u, v]);
        path.density = base_density(largest, path.beta);
        for (bin, factor) in flat.factors.iter_mut().enumerate() {
            *factor = value / path.density * spread(path.beta, bin);
        }
        path.multiply(&flat.factors);
        true
    }

    /// Light leaves a pixel with a kernel for each state: one direction serves all.
    fn leave_kernels(
        &self,
        kernels: &[crate::ScatterKernel],
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        use papilio_optics::Scatterer;
        let index = self.lowest().largest_index();
        let of_air = |beta: Beta| Beta { x: beta.x / index, y: beta.y / index };
        let from = work.path.beta;
        let density = |to: Beta| {
            let sum: f64 = kernels.iter().map(|one| one.scatter.density(of_air(from), of_air(to))).sum();
            sum / (kernels.len() as f64 * index * index)
        };
        let bins = self.bins();
        let set = |to: Beta, weight: f64, reflectance: &mut [f64]| {
            for (row, kernel) in reflectance.chunks_exact_mut(bins).zip(kernels) {
                let value = weight * kernel.scatter.evaluate(of_air(from), of_air(to)) / (index * index);
                row.iter_mut().zip(&*kernel.factor).for_each(|(out, factor)| *out = value * factor);
            }
        };
        let Workspace { path, last, targets, flat } = work;
        path.going = Propagation::Up;
        for (source, target) in targets.iter().enumerate() {
            let Some(target) = target else { continue };
            // The balance of a connection is a factor on any value.
            set(target.beta, target.balanced(1.0, || density(target.beta), 0.0), &mut flat.reflectance);
            last.copy(path);
            self.reflect(last, flat, record);
            last.beta = target.beta;
            self.reach(source, &mut Last { last, parts: flat }, dice, record);
        }
        let u = dice.next();
        let place = u[2] * kernels.len() as f64;
        let Some(kernel) = kernels.get(place as usize) else { return false };
        let Some(sent) = kernel.scatter.sample(of_air(from), [u[0], u[1], place.fract(), 0.0]) else {
            return false;
        };
        let to = Beta { x: sent.direction.x * index, y: sent.direction.y * index };
        let drawn = density(to);
        set(to, 1.0 / drawn, &mut flat.reflectance);
        self.reflect(path, flat, record);
        (path.beta, path.density) = (to, drawn);
        self.survives(dice, path)
    }

    /// Flights and deflections in a scattering medium, until the light leaves it.
    fn pass_slab(
        &self,
        layer: usize,
        dice: &mut Dice<'_>,
        work: &mut Workspace,
        record: &mut impl Record,
    ) -> bool {
        let medium = &self.stack.layers[layer].medium;
        let Some(scattering) = medium.scattering() else { return true };
        let (index, thickness) = (medium.largest_index(), scattering.optical_thickness);
        let phase = HenyeyGreenstein { anisotropy: scattering.anisotropy };
        let direction = |beta: Beta, going: Propagation| {
            let (x, y) = (beta.x / index, beta.y / index);
            let z = (1.0 - x * x - y * y).max(1e-18).sqrt();
            [x, y, if going == Propagation::Down { z } else { -z }]
        };
        let over_cosines = |density: f64, z: f64| density / (index * index * z.abs().max(f64::MIN_POSITIVE));
        if work.path.beta.squared() >= index * index {
            return false;
        }
        let mut now = direction(work.path.beta, work.path.going);
        let mut depth = if now[2] > 0.0 { 0.0 } else { thickness };
        loop {
            let u = dice.next();
            let path = &mut work.path;
            let rest = if now[2] > 0.0 { thickness - depth } else { depth };
            let edge = rest / now[2].abs().max(f64::MIN_POSITIVE);
            let flown = (-u[3].ln()).min(edge);
            self.fly(layer, path, (now, flown / thickness), &mut work.flat);
            if flown >= edge {
                path.going = if now[2] > 0.0 { Propagation::Down } else { Propagation::Up };
                path.plane = if now[2] > 0.0 { 2 * layer + 2 } else { 2 * layer + 1 };
                return true;
            }
            depth = (depth + flown * now[2]).clamp(0.0, thickness);
            path.multiply(if self.bands == 1 { &scattering.albedo[..1] } else { &scattering.albedo });
            let Workspace { path, last, targets, flat } = work;
            for (source, target) in targets.iter().enumerate() {
                let Some(target) = target.filter(|target| target.beta.squared() < index * index) else {
                    continue;
                };
                for going in [Propagation::Up, Propagation::Down] {
                    let towards = direction(target.beta, going);
                    let density = over_cosines(phase.at_cosine(dot(now, towards)), towards[2]);
                    let rest = if going == Propagation::Down { thickness - depth } else { depth };
                    let edge = rest / towards[2].abs();
                    let weight = target.balanced(density, || density, 0.0) * (-edge).exp();
                    last.copy(path);
                    last.beta = target.beta;
                    last.multiply(&[weight]);
                    self.fly(layer, last, (towards, edge / thickness), flat);
                    (last.going, last.plane) =
                        (going, if going == Propagation::Down { 2 * layer + 2 } else { 2 * layer + 1 });
                    self.reach(source, &mut Last { last, parts: flat }, dice, record);
                }
            }
            if !self.survives(dice, path) {
                return false;
            }
            let before = now;
            now = warp::deflected(before, 1.0 - phase.sample_cosine(u[0]), u[1]);
            path.density = over_cosines(phase.at_cosine(dot(before, now)), now[2]);
            path.beta = Beta { x: index * now[0], y: index * now[1] };
        }
    }

    /// Moves a path by a flight in a scattering medium, of a length relative to the thickness of the medium.
    fn fly(&self, layer: usize, path: &mut Path, ([x, y, _], length): ([f64; 3], f64), flat: &mut FlatWork) {
        if let Some(transmittance) = self.stack.layers[layer].medium.transmittance() {
            let factors = flat.factors.iter_mut().zip(&**transmittance);
            factors.for_each(|(factor, t)| *factor = t.powf(length));
            path.multiply(&flat.factors);
        }
        let length = length * self.lengths_mm[layer];
        path.place_mm.iter_mut().for_each(|place| *place = [place[0] - length * x, place[1] - length * y]);
    }

    /// Roulette; false if the path ends.
    fn survives(&self, dice: &mut Dice<'_>, path: &mut Path) -> bool {
        let brightness = path.brightness();
        let most = if dice.steps < FREE { 1.0 } else { MOST_SURVIVAL };
        let survival = (brightness / FAINT).min(most);
        if survival < 1.0 {
            if dice.of_connection() >= survival {
                return false;
            }
            path.multiply(&[1.0 / survival]);
        }
        true
    }
}

/// Most alternatives at an interface.
const MOST: usize = 8;

struct Last<'w> {
    last: &'w mut Path,
    parts: &'w mut FlatWork,
}

/// What a medium of this thickness moves light by, per unit of direction cosines, mm; 0 where it has no such direction.
fn per_beta(medium: &Medium, place: usize, beta: Beta, thickness_mm: f64) -> f64 {
    let index = medium.constant_index().unwrap_or_else(|| medium.index()[place]);
    let squared = index * index - beta.squared();
    if squared > 0.0 { thickness_mm / squared.sqrt() } else { 0.0 }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
