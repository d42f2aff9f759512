//! The reference tracer: light through any layers, one event at a time, at one wavelength and in one state.
//! Read this first.
//!
//! It has no shortcut: no closed form, no importance sampling, no groups of paths. Both solvers compute the
//! same faster, and are tested against it. A path starts at the viewer and follows light backwards, which all
//! layers permit, because they are reciprocal. It goes from *plane* to plane: plane 0 is in the air, plane e
//! above element e (interface, medium, interface, medium ...), the last one on the pixel. An interface
//! transmits, reflects, scatters or absorbs it, in proportion to the light that does; a scattering medium
//! deflects it after random flights (`slab`); the pixel reflects or scatters it; in the air it finds the
//! light of its direction. A beam has no width, so that no path finds it by chance: each event that scatters
//! sends a second path towards it. The mean weight with which paths find a source is the reflectance factor
//! `pi L / E` under that source alone.

mod path;
mod slab;

use std::f64::consts::PI;

use papilio_optics::{Beta, Scatterer};
use papilio_sampling::{SampleStream, warp};

use super::Target;
use crate::layers::{Arrival, Departure, Incidence};
use crate::skeleton::Propagation::{self, Down, Up};
use crate::{Cone, Medium, Reflector, ScatterKernel, Source, Stack};
use path::{Path, Run};

/// A stack, its view and sources, at one wavelength (`bin`) and in one state.
pub struct Plain<'a> {
    stack: &'a Stack,
    air: Medium,
    view: Cone,
    sources: &'a [Source],
    bin: usize,
    state: usize,
}

impl<'a> Plain<'a> {
    /// Prepares the tracer of a wavelength and a state, by their numbers.
    pub fn new(stack: &'a Stack, view: Cone, sources: &'a [Source], [bin, state]: [usize; 2]) -> Self {
        Self { stack, air: Medium::new(vec![1.0; stack.base().bins()].into()), view, sources, bin, state }
    }

    /// Returns the reflectance factor under each source alone: the mean over this number of paths.
    pub fn reflectance_factors(&self, numbers: &SampleStream, paths: u64) -> Vec<f64> {
        let mut run = Run { received: vec![0.0; self.sources.len()], numbers, path: 0, blocks: 0 };
        for path in 0..paths {
            (run.path, run.blocks) = (path, 0);
            let [u, v, ..] = run.random();
            let beta = self.view.sample_towards([u, v]);
            self.follow(Path { beta, going: Down, plane: 0, weight: 1.0, events: 0, beam: None }, &mut run);
        }
        run.received.iter().map(|sum| sum / paths as f64).collect()
    }

    /// The main loop: follows a path until it leaves into the air, or ends.
    fn follow(&self, mut path: Path, run: &mut Run<'_>) {
        while path.weight > 0.0 && path.survives(run) {
            match path.going {
                Up if path.plane == 0 => return self.leave(&path, run),
                Down if path.plane == 2 * self.stack.layers.len() => self.meet_pixel(&mut path, run),
                Down => self.meet_element(path.plane, &mut path, run),
                Up => self.meet_element(path.plane - 1, &mut path, run),
            }
        }
    }

    /// In the air: finds the sources that send light of this direction.
    fn leave(&self, path: &Path, run: &mut Run<'_>) {
        for (number, (source, received)) in self.sources.iter().zip(&mut run.received).enumerate() {
            *received += path.weight
                * match (path.beam, source) {
                    (Some(beam), _) => f64::from(u8::from(beam == number)),
                    (None, Source::Diffuse) => 1.0,
                    (None, _) => Target::at(source, path.beta).map_or(0.0, |target| target.strength),
                };
        }
    }

    /// Scatters light at an element: sends a path to each beam, by the density of scattered light over
    /// direction cosines, and goes on in a sampled direction with a weight (`None`: the light is absorbed).
    fn scatter(
        &self,
        (element, ways): (usize, &[Propagation]),
        path: &mut Path,
        run: &mut Run<'_>,
        density: impl Fn(Departure) -> f64,
        sampled: Option<(Departure, f64)>,
    ) {
        for (number, source) in self.sources.iter().enumerate() {
            for going in ways {
                let Source::Beam(beta) = *source else { continue };
                let to = Departure { beta, going: *going };
                let weight = path.weight * PI * density(to);
                let mut towards = Path { weight, beam: Some(number), ..*path };
                towards.depart(element, to);
                self.follow(towards, run);
            }
        }
        path.weight *= sampled.map_or(0.0, |(_, weight)| weight);
        sampled.into_iter().for_each(|(to, _)| path.depart(element, to));
    }

    /// An interface or a medium.
    fn meet_element(&self, element: usize, path: &mut Path, run: &mut Run<'_>) {
        let Some((kind, media)) = self.stack.elements().nth(element) else { return };
        let slab = self.stack.layers[element / 2].medium.scattering();
        if let Some(slab) = slab.filter(|_| element % 2 == 1 && path.beam.is_none()) {
            return self.cross_slab(element, slab, path, run);
        }
        let media = media.map(|medium| medium.unwrap_or(&self.air));
        let at = Incidence::between(media, self.bin, path.beta.squared());
        let (flat, from, [mut u, ..]) = (kind.regular(&at), path.going, run.random());
        let back = if from == Down { flat.above } else { flat.below };
        match u {
            _ if u < flat.t => return path.depart(element, Departure { beta: path.beta, going: from }),
            _ if u < flat.t + back => return path.going = from.reversed(),
            _ => u -= flat.t + back,
        }
        let (scatterer, disc) = (kind.scattering_interface(), media[from as usize].largest_index());
        let Some(interface) = scatterer.filter(|_| path.beam.is_none()) else { return path.weight = 0.0 };
        for channel in interface.channels(from) {
            let fraction = interface.fraction(channel, from, at.beta, disc);
            let fraction =
                fraction.map_or(kind.scattered(&at)[from as usize], |(all, by)| all * by[self.bin]);
            if u < fraction {
                let arrival = Arrival { beta: path.beta, going: from, channel, disc };
                // The kernel is that of the largest indices.
                let colour = |to: Departure| {
                    let side = usize::from(to.going == Down);
                    let [largest, n] = [media[side].largest_index(), at.indices[side]];
                    let carried = if to.beta.squared() < n * n { 1.0 } else { 0.0 };
                    let colour = interface.colours(arrival, to.beta).at(self.bin);
                    carried * colour * interface.spread(channel, from, [largest, n])
                };
                let sampled = interface.sample(arrival, run.random());
                let sampled = sampled.map(|(to, s)| (to, s.value / s.density * colour(to)));
                let density = |to| interface.scatter(arrival, to).value * colour(to);
                return self.scatter((element, channel.leaves(from)), path, run, density, sampled);
            }
            u -= fraction;
        }
        path.weight = 0.0;
    }

    /// The pixel: a mirror, a Lambertian pixel, or one with a kernel for each state.
    fn meet_pixel(&self, path: &mut Path, run: &mut Run<'_>) {
        let (base, at, u) = (self.stack.base(), (2 * self.stack.layers.len(), &[Up][..]), run.random());
        let medium = self.stack.layers.last().map_or(&self.air, |layer| &layer.medium);
        let n = medium.index()[self.bin];
        let mut reflectance = vec![0.0; base.states() * base.bins()];
        base.reflectance_towards(path.beta, medium, &mut reflectance);
        let reflectance = reflectance[self.state * base.bins() + self.bin];
        let times = |beta: Beta, by: f64| Beta { x: beta.x * by, y: beta.y * by };
        let up = |beta: Beta| Departure { beta: times(beta, n), going: Up };
        match &base.reflector {
            Reflector::Specular(_) => (path.weight, path.going) = (path.weight * reflectance, Up),
            _ if path.beam.is_some() => path.weight = 0.0,
            Reflector::Lambertian(_) => {
                let (x, y) = warp::uniform_disc(1.0, [u[0], u[1]]);
                let density = |_| reflectance / (PI * n * n);
                self.scatter(at, path, run, density, Some((up(Beta { x, y }), reflectance)));
            }
            Reflector::Scattering(kernels) => {
                let (ScatterKernel { scatter, factor }, from) =
                    (&kernels[self.state], times(path.beta, 1.0 / n));
                let sampled = scatter.sample(from, u);
                let sampled = sampled.map(|s| (up(s.direction), s.value / s.density * factor[self.bin]));
                let value = |to: Departure| scatter.evaluate(from, times(to.beta, 1.0 / n)) / (n * n);
                self.scatter(at, path, run, |to| value(to) * factor[self.bin], sampled);
            }
        }
    }
}
