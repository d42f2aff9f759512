//! The tracer of polarised light: Stokes parameters through any layers, as general as the reference
//! [`Plain`](super::Plain), of which it has the planes, the elements and the events.
//!
//! A path starts at the viewer and follows light backwards. It carries, for each wavelength and state, what the meter
//! makes of I, Q, U and V of the light that arrives where the path is: a row of four numbers, (1, 0, 0, 0) for a viewer
//! without a polariser. Each event multiplies the row from the right by the Mueller matrix of the light's own direction:
//! a face by Fresnel's s and p and the phase between them, a scattering medium by its phase matrix
//! ([`papilio_optics::phase`]), turned from the plane of incidence of the one direction into the scattering plane
//! and out of it into that of the other. Henyey and Greenstein's medium, scattering interfaces and pixels that are no
//! mirrors leave light unpolarised, and the straight part of a scattering medium or interface keeps its polarisation.
//! Sheets and mirrors that are given by their reflectance reflect as metal does along the normal.
//!
//! **Conventions** are those of [`Frame`] everywhere: p lies in the plane of incidence, s across it, (p, s,
//! direction of travel) is right-handed, along the normal the plane is that of azimuth 0; `Q = |p|^2 - |s|^2`,
//! `U = 2 Re(p s*)`, `V = 2 Im(p s*)`, fields are exp(-i omega t).
//!
//! Which way a path goes is chosen in proportion to unpolarised light, which is never negative: rows stay
//! in the cone of polarised light. Each event that scatters sends a second path towards each source; what a scattered path finds by chance
//! counts with it by the balance heuristic. Wavelengths at which layers and pixel are the same share a *column*.

mod elements;
mod pixel;
mod row;
mod slab;
mod sums;

use std::borrow::Cow;
use std::collections::HashMap;

use papilio_sampling::SampleStream;

use super::Target;
use crate::layers::Departure;
use crate::light::polarised::Frame;
use crate::mueller::WholeView;
use crate::skeleton::Propagation::{self, Down, Up};
use crate::{Cone, Medium, Reflector, Source, Stack};
use row::Row;
pub(super) use sums::Sums;
use sums::{Path, Run};

/// A stack, its view and sources.
#[derive(Debug)]
pub(super) struct Stokes<'a> {
    /// As given, and with its coatings as runs that keep s and p apart.
    lit: &'a Stack,
    stack: &'a Stack,
    air: Medium,
    view: Cone,
    sources: Cow<'a, [Source]>,
    polarised: WholeView,
    /// A wavelength of each column.
    bins: Vec<usize>,
    /// The column of each wavelength.
    column_of: Vec<usize>,
}

/// Light that a scatterer sends on: a direction, the rows, and the density of sampling the direction.
type Sent = (Departure, Vec<Row>, f64);

impl<'a> Stokes<'a> {
    pub(super) fn new(lit: &'a Stack, view: Cone, sources: Cow<'a, [Source]>) -> Self {
        let stack = lit.in_runs();
        let whole = lit.polarised_view().and_then(|view| view.whole().cloned());
        let air = Medium::new(vec![1.0; stack.base().bins()].into());
        let (mut bins, mut numbers) = (Vec::new(), HashMap::new());
        let number = |bin: usize| {
            *numbers.entry(key(stack, bin)).or_insert_with(|| {
                bins.push(bin);
                bins.len() - 1
            })
        };
        let column_of = (0..stack.base().bins()).map(number).collect();
        Self { lit, stack, air, view, sources, polarised: whole.unwrap_or_default(), bins, column_of }
    }

    /// As [`Walk::rarest`](super::Walk::rarest): roulette.
    pub(super) fn rarest(&self) -> f64 {
        if self.stack.elements().any(|(kind, _)| kind.scatters()) { sums::FAINT } else { 1.0 }
    }

    /// Traces a path.
    pub(super) fn trace(&self, numbers: &SampleStream, path: u64, sums: &mut Sums) {
        let mut run = Run { sums, numbers, path, blocks: 0 };
        let [u, v, ..] = run.random();
        let beta = self.view.sample_towards([u, v]);
        let rows = vec![row::of_meter(self.polarised.meter(Some(&self.view), beta)); self.bins.len()];
        let (plane, events, towards, density) = (0, 0, None, None);
        let path = Path { beta, going: Down, plane, rows, has_met_pixel: false, events, towards, density };
        self.follow(path, &mut run);
    }

    /// The main loop: follows a path until it leaves into the air, or ends.
    fn follow(&self, mut path: Path, run: &mut Run<'_>) {
        while path.survives(run) {
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
        if path.towards.is_none() {
            run.leave(path);
        }
        for (number, source) in self.sources.iter().enumerate() {
            let strength = match (path.towards, source) {
                (Some(towards), _) => f64::from(u8::from(towards == number)),
                (None, Source::Diffuse) => 1.0,
                (None, _) => Target::at(source, path.beta).map_or(0.0, |target| {
                    let chance = path.density.map_or(1.0, |density| density / (density + target.density));
                    target.strength * chance
                }),
            };
            if strength > 0.0 {
                let light = self.polarised.light(number, source.direction(), path.beta);
                run.receive(number, path, |row| strength * row::seen(row, light));
            }
        }
    }

    /// Scatters light at an element: sends a path to each source, by the rows times the density of scattered light over
    /// direction cosines, and the density of sampling; and goes on in a sampled direction (`None`: the light is absorbed).
    fn scatter(
        &self,
        (element, ways): (usize, &[Propagation]),
        path: &mut Path,
        run: &mut Run<'_>,
        density: impl Fn(Departure) -> (Vec<Row>, f64),
        sampled: Option<Sent>,
    ) {
        for (number, source) in self.sources.iter().enumerate() {
            if *source == Source::Diffuse {
                continue;
            }
            let [u, v, ..] = run.random();
            let Some(target) = Target::sample(source, [u, v]) else { continue };
            for going in ways {
                let to = Departure { beta: target.beta, going: *going };
                let (rows, sampling) = density(to);
                let mut towards = Path { rows, towards: Some(number), ..path.clone() };
                towards.weaken(|_| target.balanced(1.0, || sampling, 0.0));
                towards.depart(element, to);
                self.follow(towards, run);
            }
        }
        match sampled {
            Some((to, rows, density)) => {
                (path.rows, path.density) = (rows, Some(density));
                path.depart(element, to);
            }
            None => path.end(),
        }
    }

    /// The wavelength of a row of a path.
    fn bin(&self, row: usize) -> usize {
        self.bins[row % self.bins.len()]
    }
}

/// Returns the frame of light that a path follows in a medium of this index.
fn frame(at: Departure, index: f64) -> Frame {
    // The light propagates against the path.
    let sign = if at.going == Down { 1.0 } else { -1.0 };
    Frame::new((1.0 / index) * at.beta, sign)
}

/// Returns all on which layers and pixel depend at a wavelength.
fn key(stack: &Stack, bin: usize) -> Vec<u64> {
    let (base, mut key) = (stack.base(), Vec::new());
    stack.elements().for_each(|(kind, _)| kind.spectral_key(bin, &mut key));
    key.push(base.inactive_absorptance[bin].to_bits());
    match &base.reflector {
        Reflector::Specular(_) => key.push(bin as u64),
        Reflector::Lambertian(states) => key.extend(states.rows().map(|state| state[bin].to_bits())),
        Reflector::Scattering(states) => key.extend(states.iter().map(|state| state.factor[bin].to_bits())),
    }
    key
}
