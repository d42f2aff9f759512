//! Light of a path: one number, one number and a look-up, or spectra.
//!
//! Directions do not depend on wavelength. Under layers that are the same at every wavelength, light is one
//! number until it meets the pixel; until it meets the pixel a second time, it is one number, the angle of
//! the first meeting and what the pattern shows there. What such light contributes is added to the nodes of
//! the pixel's angular table, and spectra are formed from the sums once, for all paths
//! ([`tally`](super::tally)). Light has spectra from the second meeting on, and from its start under layers
//! with colour or over a pixel that scatters by a kernel.
//!
//! Below flat layers above a pixel that changes polarisation, what a meter sees of light is four spectra for each image ([`mueller`](crate::mueller)),
//! which become one where the path leaves.

use super::pattern::{Meeting, Pattern};
use crate::angular::Stencil;
use crate::light::polarised::Quartet;
use crate::mueller::{Factors, METER, Mueller};
use crate::walk::{add_scaled, scale_rows};

/// Light of a path.
#[derive(Debug, Clone)]
pub(super) struct Light {
    form: Form,
    /// The form in which paths start.
    starts: Form,
    meetings: u32,
    /// Factor on the look-up or the spectra.
    scale: f64,
    /// `[image][number][wavelength]` after the first meeting with the pixel, `[number][wavelength]` before; valid in this
    /// form.
    spectra: Vec<f64>,
    /// Numbers for each wavelength: 1, or 4 of polarised light; and those with which paths start.
    numbers: usize,
    starting: usize,
    images: usize,
    first: FirstMeeting,
    /// The brightness is 1 at the first meeting.
    reference: f64,
    bins: usize,
}

/// What light consists of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    /// The same at all wavelengths; it has not met the pixel.
    Number,
    /// It has met the pixel once.
    LookUp,
    Spectra,
}

/// The first meeting with the pixel.
#[derive(Debug, Clone)]
pub(super) struct FirstMeeting {
    /// Squared length of the direction cosines.
    pub(super) beta_squared: f64,
    /// Weights on the nodes of the pixel's angular table.
    pub(super) look_up: Stencil,
    /// What the pattern shows at the place.
    pub(super) shown: Shown,
}

/// What the pattern shows at a place.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shown {
    /// Image k shows state k.
    EachState,
    /// States that an image shows, and their coverages; numbers are `image * states + state`.
    Covered(Vec<(usize, f64)>),
}

/// Light as it is recorded.
pub(super) enum Recorded<'p> {
    /// Not met the pixel; the same at all wavelengths.
    Number(f64),
    /// Met the pixel once.
    LookUp(f64, &'p FirstMeeting),
    /// A factor, and spectra `[wavelength]` or `[image][wavelength]`.
    Spectra(f64, &'p [f64]),
}

impl Light {
    /// Memory for light that starts as a number, or else as spectra; of polarised light, as four.
    pub(super) fn new(
        (images, bins): (usize, usize),
        as_number: bool,
        is_polarised: bool,
        shown: Shown,
    ) -> Self {
        let starts = if as_number { Form::Number } else { Form::Spectra };
        let first = FirstMeeting { beta_squared: 0.0, look_up: Stencil::ONLY_NODE, shown };
        let (numbers, images) = (if is_polarised { METER.len() } else { 1 }, images.max(1));
        let spectra = vec![0.0; images * numbers * bins];
        Self {
            form: starts,
            starts,
            meetings: 0,
            scale: 1.0,
            spectra,
            numbers,
            starting: numbers,
            images,
            first,
            reference: 1.0,
            bins,
        }
    }

    /// Becomes one unit.
    pub(super) fn start(&mut self) {
        (self.form, self.meetings, self.scale, self.reference) = (self.starts, 0, 1.0, 1.0);
        self.numbers = self.starting;
        if self.form == Form::Spectra {
            let rows = self.spectra.chunks_exact_mut(self.bins).zip(METER).take(self.numbers);
            rows.for_each(|(row, meter)| row.fill(meter));
        }
    }

    /// Becomes a copy of other light; keeps the memory.
    pub(super) fn copy(&mut self, other: &Self) {
        (self.form, self.meetings, self.scale, self.reference) =
            (other.form, other.meetings, other.scale, other.reference);
        match self.form {
            Form::Number => {}
            Form::LookUp => {
                (self.first.beta_squared, self.first.look_up) =
                    (other.first.beta_squared, other.first.look_up);
                self.first.shown.copy(&other.first.shown);
            }
            Form::Spectra => {
                self.numbers = other.numbers;
                let valid = other.valid().len();
                self.spectra[..valid].copy_from_slice(other.valid());
            }
        }
    }

    /// Number of meetings with the pixel.
    pub(super) fn meetings(&self) -> u32 {
        self.meetings
    }

    pub(super) fn bins(&self) -> usize {
        self.bins
    }

    /// True if light is one number until it meets the pixel.
    pub(super) fn is_number(&self) -> bool {
        self.form == Form::Number
    }

    /// The first meeting, if spectra have not been formed since.
    pub(super) fn looked_up(&self) -> Option<&FirstMeeting> {
        (self.form == Form::LookUp).then_some(&self.first)
    }

    pub(super) fn recorded(&self) -> Recorded<'_> {
        match self.form {
            Form::Number => Recorded::Number(self.scale),
            Form::LookUp => Recorded::LookUp(self.scale, &self.first),
            Form::Spectra => Recorded::Spectra(self.scale, self.valid()),
        }
    }

    /// Its spectra, `[wavelength]` or `[image][wavelength]`, with the factor on them; it must have started as
    /// spectra.
    pub(super) fn as_spectra(&mut self) -> &[f64] {
        let scale = std::mem::replace(&mut self.scale, 1.0);
        self.valid_mut().iter_mut().for_each(|value| *value *= scale);
        self.valid()
    }

    /// Length of the spectra that are valid.
    fn len(&self) -> usize {
        (if self.meetings == 0 { 1 } else { self.images }) * self.numbers * self.bins
    }

    fn valid(&self) -> &[f64] {
        &self.spectra[..self.len()]
    }

    fn valid_mut(&mut self) -> &mut [f64] {
        let len = self.len();
        &mut self.spectra[..len]
    }

    /// Multiplies it by a factor for all wavelengths, or for each.
    pub(super) fn multiply(&mut self, factors: &[f64]) {
        match factors {
            [factor] => self.scale *= factor,
            _ => scale_rows(self.valid_mut(), factors),
        }
    }

    /// Sum over images, added to `out` by wavelength; it must have started as spectra.
    pub(super) fn add_total(&self, out: &mut [f64]) {
        self.valid().chunks_exact(self.bins).for_each(|row| add_scaled(out, row, self.scale));
    }

    /// The largest light of any image and wavelength, over that at the first meeting; before it, over that at
    /// the start.
    pub(super) fn brightness(&self) -> f64 {
        let largest = if self.form == Form::Spectra { largest(self.valid()) } else { 1.0 };
        self.scale * largest / self.reference
    }

    /// First meeting with the pixel, of light that is a number; returns what the pattern shows, to be set.
    pub(super) fn meet(&mut self, beta_squared: f64, look_up: Stencil) -> &mut Shown {
        (self.form, self.meetings) = (Form::LookUp, 1);
        self.reference = self.scale.max(f64::MIN_POSITIVE);
        (self.first.beta_squared, self.first.look_up) = (beta_squared, look_up);
        &mut self.first.shown
    }

    /// Forms the spectra of the look-up, from the reflectance of each state at the first meeting.
    pub(super) fn expand(&mut self, reflectance: &[f64]) {
        let states = reflectance.len() / self.bins;
        match &self.first.shown {
            Shown::EachState => self.spectra.copy_from_slice(reflectance),
            Shown::Covered(covered) => {
                self.spectra.fill(0.0);
                for (number, coverage) in covered {
                    let of_state = &reflectance[number % states * self.bins..][..self.bins];
                    let image = &mut self.spectra[number / states * self.bins..][..self.bins];
                    add_scaled(image, of_state, *coverage);
                }
            }
        }
        self.form = Form::Spectra;
        self.reference *= largest(&self.spectra).max(f64::MIN_POSITIVE);
    }

    /// Reflection by the pixel, of light that has spectra, with the reflectance of each image;
    /// `[image][wavelength]`.
    pub(super) fn reflect(&mut self, reflectance: &[f64]) {
        if self.meetings == 0 {
            let (fresh, others) = self.spectra.split_at_mut(self.bins);
            others.chunks_exact_mut(self.bins).for_each(|row| row.copy_from_slice(fresh));
        }
        self.spectra.iter_mut().zip(reflectance).for_each(|(light, factor)| *light *= factor);
        if self.meetings == 0 {
            self.reference = (self.scale * largest(&self.spectra)).max(f64::MIN_POSITIVE);
        }
        self.meetings = self.meetings.saturating_add(1);
    }

    /// Sums over images of polarised light of p and of s, by wavelength.
    pub(super) fn totals_of_each(&self) -> [Vec<f64>; 2] {
        [0, 1].map(|number| {
            let mut sum = vec![0.0; self.bins];
            let rows = self.valid().chunks_exact(self.bins).skip(number).step_by(self.numbers);
            rows.for_each(|row| add_scaled(&mut sum, row, 1.0));
            sum
        })
    }

    /// Polarised light before a flat part of these factors for each wavelength, and a factor for all.
    pub(super) fn pass_back(&mut self, factors: &[Factors], scale: f64) {
        self.scale *= scale;
        self.map_quartets(|_, bin, meter| factors[bin].before(meter));
    }

    /// Polarised light before a pixel of these matrices, `[image][element][wavelength]`.
    pub(super) fn reflect_back(&mut self, matrices: &[f64]) {
        if self.meetings == 0 {
            let (fresh, others) = self.spectra.split_at_mut(self.numbers * self.bins);
            others.chunks_exact_mut(fresh.len()).for_each(|row| row.copy_from_slice(fresh));
        }
        let (is_first, bins) = (self.meetings == 0, self.bins);
        self.meetings = self.meetings.saturating_add(1);
        self.map_quartets(|image, bin, meter| {
            let of = |element: usize| matrices[(image * Mueller::ELEMENTS + element) * bins + bin];
            [0, 1, 2, 3].map(|column| (0..4).map(|row| meter[row] * of(4 * row + column)).sum())
        });
        if is_first {
            self.reference = (self.scale * largest(self.valid())).max(f64::MIN_POSITIVE);
        }
    }

    fn map_quartets(&mut self, to: impl Fn(usize, usize, Quartet) -> Quartet) {
        let bins = self.bins;
        for (image, rows) in self.valid_mut().chunks_exact_mut(METER.len() * bins).enumerate() {
            for bin in 0..bins {
                let found = to(image, bin, [0, 1, 2, 3].map(|number| rows[number * bins + bin]));
                found.into_iter().enumerate().for_each(|(number, value)| rows[number * bins + bin] = value);
            }
        }
    }

    /// Becomes what is seen of such light where it enters.
    pub(super) fn receive(&mut self, light: Quartet) {
        if self.numbers == 1 {
            return;
        }
        let (rows, bins) = (self.len() / (self.numbers * self.bins), self.bins);
        for at in 0..rows * bins {
            // Later ones are not overwritten before they are read.
            let (image, bin) = (at / bins, at % bins);
            let of = |number: usize| self.spectra[(image * METER.len() + number) * bins + bin];
            self.spectra[at] = light.iter().enumerate().map(|(number, light)| light * of(number)).sum();
        }
        self.numbers = 1;
    }
}

impl Shown {
    /// Becomes a copy; keeps the memory.
    fn copy(&mut self, other: &Self) {
        if let (Self::Covered(own), Self::Covered(other)) = (self, other) {
            own.clone_from(other);
        }
    }

    /// Becomes what a pattern shows at a meeting.
    pub(super) fn set(&mut self, pattern: &dyn Pattern, meeting: &Meeting, states: usize) {
        if let Self::Covered(covered) = self {
            covered.clear();
            pattern.shows_at(meeting, &mut |image, state, coverage| {
                covered.push((image * states + state, coverage))
            });
        }
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0_f64, |most, value| most.max(*value))
}
