//! A path with a place: its light, and where it is in the plane of the panel.

use std::ops::Range;

use num_complex::Complex64;
use papilio_optics::Beta;

use crate::skeleton::Propagation;
use crate::walk::{add_scaled, scale_rows};

/// State of a path, or of the last part of a connection to a source.
#[derive(Debug, Clone)]
pub(super) struct Path {
    /// Direction cosines of the light that is followed back.
    pub(super) beta: Beta,
    /// The plane above the next element if the path goes down, below it if the path goes up.
    pub(super) plane: usize,
    pub(super) going: Propagation,
    /// Place, mm; one for all wavelengths, or one for each where an index depends on wavelength.
    pub(super) place_mm: Vec<[f64; 2]>,
    /// Its first place.
    pub(super) entry_mm: [f64; 2],
    /// Density over direction cosines with which the direction was sampled; infinite if the path was never scattered.
    pub(super) density: f64,
    /// Number of meetings with the pixel.
    pub(super) meetings: u32,
    /// Light; `[image][wavelength]` after the first meeting with the pixel, `[wavelength]` before.
    light: Vec<f64>,
    /// The largest light at the first meeting.
    reference: f64,
    bins: usize,
    pub(super) trace: Trace,
}

/// What is remembered of the places at which a path met the pixel.
#[derive(Debug, Clone, Default)]
pub(super) struct Trace {
    /// Sum over the meetings of `exp(-2 pi i f.r)`; `[place][frequency]`.
    pub(super) phases: Vec<Complex64>,
    /// Cells of the meetings; `[meeting][place]`.
    pub(super) cells: Vec<usize>,
}

impl Path {
    pub(super) fn new(images: usize, bins: usize, places: usize) -> Self {
        Self {
            beta: Beta { x: 0.0, y: 0.0 },
            plane: 0,
            going: Propagation::Down,
            place_mm: vec![[0.0; 2]; places],
            entry_mm: [0.0; 2],
            density: f64::INFINITY,
            meetings: 0,
            light: vec![0.0; images * bins],
            reference: 1.0,
            bins,
            trace: Trace::default(),
        }
    }

    /// Begins in the air, towards the display, with one unit of light.
    pub(super) fn start(&mut self, beta: Beta) {
        (self.beta, self.plane, self.going) = (beta, 0, Propagation::Down);
        (self.density, self.meetings, self.reference) = (f64::INFINITY, 0, 1.0);
        self.light[..self.bins].fill(1.0);
        self.trace.phases.fill(Complex64::ZERO);
        self.trace.cells.clear();
    }

    /// Becomes a copy of another path; keeps the memory.
    pub(super) fn copy(&mut self, other: &Self) {
        let Self { beta, plane, going, density, meetings, reference, .. } = *other;
        (self.beta, self.plane, self.going) = (beta, plane, going);
        (self.density, self.meetings, self.reference) = (density, meetings, reference);
        self.place_mm.clone_from(&other.place_mm);
        let valid = other.light().len();
        self.light[..valid].copy_from_slice(other.light());
        self.trace.phases.clone_from(&other.trace.phases);
        self.trace.cells.clone_from(&other.trace.cells);
    }

    /// Its light; `[wavelength]` before the first meeting, `[image][wavelength]` after it.
    pub(super) fn light(&self) -> &[f64] {
        if self.meetings == 0 { &self.light[..self.bins] } else { &self.light }
    }

    fn light_mut(&mut self) -> &mut [f64] {
        if self.meetings == 0 { &mut self.light[..self.bins] } else { &mut self.light }
    }

    pub(super) fn bins(&self) -> usize {
        self.bins
    }

    /// The wavelengths of a place.
    pub(super) fn bins_at(&self, place: usize) -> Range<usize> {
        if self.place_mm.len() == 1 { 0..self.bins } else { place..place + 1 }
    }

    /// Multiplies its light by a factor for all wavelengths, or for each.
    pub(super) fn multiply(&mut self, factors: &[f64]) {
        match factors {
            [factor] if *factor == 1.0 => {}
            [factor] if self.bins > 1 => {
                let factor = *factor;
                self.light_mut().iter_mut().for_each(|value| *value *= factor);
            }
            _ => scale_rows(self.light_mut(), factors),
        }
    }

    /// Sum of its light over images, added to `out` by wavelength.
    pub(super) fn add_total(&self, out: &mut [f64]) {
        self.light().chunks_exact(self.bins).for_each(|row| add_scaled(out, row, 1.0));
    }

    /// The largest light of any image and wavelength, over that at the first meeting.
    pub(super) fn brightness(&self) -> f64 {
        self.light().iter().fold(0.0_f64, |most, value| most.max(*value)) / self.reference
    }

    /// Reflection by the pixel, with the reflectance of each image at its place; `[image][wavelength]`.
    pub(super) fn reflect(&mut self, reflectance: &[f64]) {
        if self.meetings == 0 {
            let (fresh, others) = self.light.split_at_mut(self.bins);
            others.chunks_exact_mut(self.bins).for_each(|row| row.copy_from_slice(fresh));
        }
        self.light.iter_mut().zip(reflectance).for_each(|(light, factor)| *light *= factor);
        if self.meetings == 0 {
            self.reference = self.light.iter().fold(f64::MIN_POSITIVE, |most, value| most.max(*value));
        }
        self.meetings = self.meetings.saturating_add(1);
    }

    /// Passes the next element.
    pub(super) fn advance(&mut self) {
        match self.going {
            Propagation::Down => self.plane += 1,
            Propagation::Up => self.plane -= 1,
        }
    }

    /// Turns back before the next element.
    pub(super) fn turn(&mut self) {
        self.going = self.going.reversed();
    }

    /// Leaves an element in this sense.
    pub(super) fn depart_from(&mut self, element: usize, going: Propagation) {
        self.going = going;
        self.plane = if going == Propagation::Down { element + 1 } else { element };
    }

    /// Moves by a vector per unit of direction cosines, mm, at each place.
    pub(super) fn move_back(&mut self, per_beta_mm: impl Fn(usize) -> f64) {
        let Beta { x, y } = self.beta;
        for (k, [place_x, place_y]) in self.place_mm.iter_mut().enumerate() {
            let per_beta = per_beta_mm(k);
            *place_x -= x * per_beta;
            *place_y -= y * per_beta;
        }
    }
}
