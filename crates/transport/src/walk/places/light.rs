//! Light of a path: one number, one number and a look-up, or spectra.
//!
//! Directions do not depend on wavelength. Under layers that are the same at every wavelength, light is one
//! number until it meets the pixel; until it meets the pixel a second time, it is one number, the angle of
//! the first meeting and what the pattern shows there. What such light contributes is added to the nodes of
//! the pixel's angular table, and spectra are formed from the sums once, for all paths
//! ([`tally`](super::tally)). Light has spectra from the second meeting on, and from its start under layers
//! with colour or over a pixel that scatters by a kernel.

use super::pattern::{Meeting, Pattern};
use crate::angular::Stencil;
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
    /// `[image][wavelength]` after the first meeting with the pixel, `[wavelength]` before; valid in this
    /// form.
    spectra: Vec<f64>,
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
    /// Memory for light that starts as a number, or else as spectra.
    pub(super) fn new((images, bins): (usize, usize), as_number: bool, shown: Shown) -> Self {
        let starts = if as_number { Form::Number } else { Form::Spectra };
        let first = FirstMeeting { beta_squared: 0.0, look_up: Stencil::ONLY_NODE, shown };
        let spectra = vec![0.0; images.max(1) * bins];
        Self { form: starts, starts, meetings: 0, scale: 1.0, spectra, first, reference: 1.0, bins }
    }

    /// Becomes one unit.
    pub(super) fn start(&mut self) {
        (self.form, self.meetings, self.scale, self.reference) = (self.starts, 0, 1.0, 1.0);
        if self.form == Form::Spectra {
            self.spectra[..self.bins].fill(1.0);
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

    fn valid(&self) -> &[f64] {
        if self.meetings == 0 { &self.spectra[..self.bins] } else { &self.spectra }
    }

    fn valid_mut(&mut self) -> &mut [f64] {
        if self.meetings == 0 { &mut self.spectra[..self.bins] } else { &mut self.spectra }
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
