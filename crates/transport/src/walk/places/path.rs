//! A path with a place: its direction, its light, and where it is in the plane of the panel.

use std::ops::Range;

use papilio_optics::Beta;

use super::light::Light;
use super::pattern::Meeting;
use super::waves::Spot;
use crate::skeleton::Propagation;

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
    /// Middle of the sample, if that is limited.
    pub(super) middle_mm: [f64; 2],
    /// Whether it has been beside the sample.
    pub(super) left_sample: bool,
    /// Where the view's own ray meets the pixel.
    pub(super) own_mm: [f64; 2],
    /// Where the view's own ray passes the plane of the filter.
    pub(super) own_at_filter_mm: [f64; 2],
    /// Where it passed the plane of the filter before its first meeting with the pixel, as `place_mm`; empty
    /// without filter.
    pub(super) passed_mm: Vec<[f64; 2]>,
    /// Density over direction cosines with which the direction was sampled; infinite if the path was never
    /// scattered.
    pub(super) density: f64,
    pub(super) light: Light,
    /// Number of its polarisation where flat layers keep s (0) and p (1) apart.
    pub(super) polarisation: usize,
    pub(super) trace: Trace,
}

/// What is remembered of the places at which a path met the pixel.
#[derive(Debug, Clone, Default)]
pub(super) struct Trace {
    /// `[meeting][place][line]`.
    pub(super) spots: Vec<Spot>,
    /// `[meeting][place][bin]`.
    pub(super) bins: Vec<usize>,
}

impl Trace {
    pub(super) fn clear(&mut self) {
        self.spots.clear();
        self.bins.clear();
    }

    fn copy(&mut self, other: &Self) {
        self.spots.clone_from(&other.spots);
        self.bins.clone_from(&other.bins);
    }
}

impl Path {
    pub(super) fn new(light: Light, places: usize) -> Self {
        Self {
            beta: Beta { x: 0.0, y: 0.0 },
            plane: 0,
            going: Propagation::Down,
            place_mm: vec![[0.0; 2]; places],
            entry_mm: [0.0; 2],
            middle_mm: [0.0; 2],
            left_sample: false,
            own_mm: [0.0; 2],
            own_at_filter_mm: [0.0; 2],
            passed_mm: Vec::new(),
            density: f64::INFINITY,
            light,
            polarisation: 0,
            trace: Trace::default(),
        }
    }

    /// Begins in the air, towards the display, with one unit of light.
    pub(super) fn start(&mut self, beta: Beta) {
        (self.beta, self.plane, self.going) = (beta, 0, Propagation::Down);
        self.density = f64::INFINITY;
        self.polarisation = 0;
        self.left_sample = false;
        self.light.start();
        self.trace.clear();
    }

    /// Becomes a copy of another path; keeps the memory.
    pub(super) fn copy(&mut self, other: &Self) {
        (self.beta, self.plane, self.going) = (other.beta, other.plane, other.going);
        (self.density, self.polarisation) = (other.density, other.polarisation);
        self.place_mm.copy_from_slice(&other.place_mm);
        (self.entry_mm, self.own_mm) = (other.entry_mm, other.own_mm);
        (self.middle_mm, self.left_sample) = (other.middle_mm, other.left_sample);
        self.own_at_filter_mm = other.own_at_filter_mm;
        self.passed_mm.clone_from(&other.passed_mm);
        self.light.copy(&other.light);
        self.trace.copy(&other.trace);
    }

    /// The wavelengths of a place.
    pub(super) fn bins_at(&self, place: usize) -> Range<usize> {
        if self.place_mm.len() == 1 { 0..self.light.bins() } else { place..place + 1 }
    }

    /// Remembers that it passes the plane of the filter here, unless it has met the pixel.
    pub(super) fn passes_filter(&mut self) {
        if self.light.meetings() == 0 {
            self.passed_mm.clone_from(&self.place_mm);
        }
    }

    /// Its meeting with the pixel, by the number of a place.
    pub(super) fn meeting(&self, place: usize) -> Meeting {
        Meeting {
            place_mm: self.place_mm[place],
            own_mm: self.own_mm,
            own_at_filter_mm: self.own_at_filter_mm,
            passed_mm: self.passed_mm.get(place).copied().unwrap_or(self.own_mm),
            is_first: self.light.meetings() == 0,
        }
    }

    /// True until the light is scattered.
    pub(super) fn is_unscattered(&self) -> bool {
        self.density.is_infinite()
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
