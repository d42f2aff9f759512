//! A virtual instrument: what an imaging sphere would write about a lobe that is known.
//!
//! Light comes from each incidence of the grid; the values are those of the sample, blurred, normalised,
//! with noise:
//!
//! - **Blur**: f is convolved, in the plane of direction cosines, with a k-correlation kernel of width
//!   `blur`, the image that source, optics and camera make of a straight beam. A k-correlation lobe of
//!   width b becomes one of width b + blur.
//! - **Renormalised** values integrate to the sample's own total in spite of light that the blur moves
//!   beyond the horizon; real instruments calibrate so. Otherwise that light is lost.
//! - **Noise** is normal: a `relative` part and a `floor` in 1/sr; what would be negative is 0. Numbers
//!   depend on seed, way, channel and cell alone.
//! - **TIS** is the true total of each incidence, times the channel's factor: a detector of its own,
//!   without blur and noise.
//!
//! The instrument sees no finer than its kernel, but it samples points: cells are not averaged over their
//! extent.

mod blur;
mod deblur;
mod quadrature;
mod rings;
mod synthetic;

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_sampling::{Numbers, Sampler};

use crate::{Channel, Geometry, GoniometryError, Measurement, Part, Provenance, SpecularGrid, Symmetry, Way};
use blur::Blurred;
use quadrature::Rule;

pub use deblur::{Deblurred, Unblur, Unblurred, deblurred};
pub use synthetic::{SyntheticSample, tristimulus_factors};

/// An imaging sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Where it looks.
    pub grid: SpecularGrid,
    /// What it looks through.
    pub channels: Vec<Channel>,
    /// Width of the image of a straight beam, direction cosines: .0001 to 1, or 0 for none.
    pub blur: f64,
    /// True if its values integrate to the sample's total.
    pub renormalise: bool,
    /// Its noise.
    pub noise: Noise,
    /// It sees nothing beyond this inclination, degrees.
    pub dark_beyond_deg: f64,
}

/// Noise of an instrument.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Standard deviation relative to the value.
    pub relative: f64,
    /// Standard deviation of what comes on top, 1/sr.
    pub floor: f64,
    /// Other seeds, other noise.
    pub seed: u64,
}

/// One way of light through, or off, what is measured.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// From where to where.
    pub way: Way,
    /// f, 1/sr, from and to direction cosines of propagation in air. What it is beyond |beta| = 1 is
    /// blurred into the hemisphere; 0 for nothing.
    pub f: &'a dyn Fn(Beta, Beta) -> f64,
    /// Share that passes without scattering, multiplied with the same factors: 0 for an instrument without blur, to which it
    /// has no width.
    pub straight: f64,
    /// What f is multiplied with in each of the instrument's channels.
    pub factors: &'a [f64],
}

impl Instrument {
    /// The dissertation's (Feng 2012, section 3.3): incidences 0 to 75 deg by 5, azimuths 0 to 180 by
    /// 10, radial distances 0 to 180 by 2; X, Y and Z; without blur and noise.
    pub fn imaging_sphere() -> Self {
        let steps = |to: u32, step: u32| (0..=to / step).map(|k| f64::from(k * step)).collect();
        Self {
            grid: SpecularGrid {
                rotations_deg: vec![0.0],
                incidences_deg: steps(75, 5),
                azimuths_deg: steps(180, 10),
                radials_deg: steps(180, 2),
                symmetry: Symmetry::Plane,
            },
            channels: vec![Channel::X, Channel::Y, Channel::Z],
            blur: 0.0,
            renormalise: true,
            noise: Noise::default(),
            dark_beyond_deg: 90.0,
        }
    }

    /// What it finds.
    ///
    /// # Errors
    /// If one of its numbers is out of range, or a view has not a factor for each channel.
    pub fn measure(&self, sample: &str, views: &[View<'_>]) -> Result<Measurement, GoniometryError> {
        self.check(views)?;
        let provenance = Provenance {
            sample: sample.to_owned(),
            source: "synthetic: a virtual imaging sphere, not a measurement".to_owned(),
            remarks: vec![format!(
                "blur {} in direction cosines{}; noise {} relative and {} per sr, seed {}; dark beyond {} deg",
                self.blur,
                if self.renormalise { ", renormalised" } else { "" },
                self.noise.relative,
                self.noise.floor,
                self.noise.seed,
                self.dark_beyond_deg,
            )],
            ..Provenance::default()
        };
        let parts = views.iter().map(|view| self.part(view)).collect();
        Ok(Measurement { provenance, media: [1.0; 2], parts })
    }

    fn check(&self, views: &[View<'_>]) -> Result<(), GoniometryError> {
        let numbers = [("the relative noise", self.noise.relative), ("the noise floor", self.noise.floor)];
        for (what, value) in numbers {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(GoniometryError::OutOfRange { what, value, expected: "0 or more" });
            }
        }
        if self.blur != 0.0 && !(1e-4..=1.0).contains(&self.blur) {
            let (what, value) = ("the blur", self.blur);
            return Err(GoniometryError::OutOfRange { what, value, expected: "0, or .0001 to 1" });
        }
        if self.blur == 0.0 && views.iter().any(|view| view.straight > 0.0) {
            let expected = "above 0 beside light that passes straight, whose image it is";
            return Err(GoniometryError::OutOfRange { what: "the blur", value: 0.0, expected });
        }
        let counts = views.iter().map(|view| view.factors.len());
        if let Some(count) = counts.into_iter().find(|count| *count != self.channels.len()) {
            let what = "the number of a view's factors";
            let expected = "one for each of the instrument's channels";
            return Err(GoniometryError::OutOfRange { what, value: count as f64, expected });
        }
        Ok(())
    }

    fn part(&self, view: &View<'_>) -> Part {
        let (rule, geometry) = (Rule::new(), Geometry::Specular(self.grid.clone()));
        let per_incidence = self.grid.azimuths_deg.len() * self.grid.radials_deg.len();
        let mut clean = Vec::with_capacity(geometry.cells());
        let mut totals = Vec::new();
        for rotation in &self.grid.rotations_deg {
            for incidence in &self.grid.incidences_deg {
                // Only the sample turns.
                let from = Beta::from_source(*incidence, 180.0 - rotation, 1.0);
                let lobe = Blurred::new(&rule, view.f, from, self.blur).with_straight(view.straight);
                let total = lobe.total();
                let scale = if self.renormalise && total > 0.0 { total / lobe.seen() } else { 1.0 };
                let cells = clean.len()..clean.len() + per_incidence;
                clean.extend(cells.map(|cell| {
                    let viewer = geometry.directions(cell).map(|[_, viewer]| viewer);
                    let seen = viewer.filter(|viewer| viewer.theta_deg <= self.dark_beyond_deg);
                    seen.map_or(0.0, |viewer| scale * lobe.value(viewer.leaving()))
                }));
                totals.push(total);
            }
        }
        let noisy = |(channel, factor): (usize, &f64)| -> Vec<f64> {
            let stream = (view.way as u64) * 256 + channel as u64;
            let numbers = Numbers::new(Sampler::Random, self.noise.seed, stream);
            clean.iter().enumerate().map(|(k, f)| self.noisy(f * factor, &numbers, self.pixel(k))).collect()
        };
        Part {
            way: view.way,
            channels: self.channels.clone(),
            geometry: geometry.clone(),
            values: view.factors.iter().enumerate().flat_map(noisy).collect(),
            tis: view.factors.iter().flat_map(|factor| totals.iter().map(move |t| t * factor)).collect(),
        }
    }

    /// At radial distance 0 all azimuths are one pixel.
    fn pixel(&self, cell: usize) -> u64 {
        let radials = self.grid.radials_deg.len();
        let row = radials * self.grid.azimuths_deg.len();
        let middle = self.grid.radials_deg[cell % radials] == 0.0;
        (if middle { cell - cell % row + cell % radials } else { cell }) as u64
    }

    fn noisy(&self, f: f64, numbers: &Numbers, pixel: u64) -> f64 {
        let Noise { relative, floor, .. } = self.noise;
        if f == 0.0 || (relative == 0.0 && floor == 0.0) {
            return f;
        }
        let [u, v, ..] = numbers.block(pixel, 0);
        let (sin, cos) = (2.0 * PI * v).sin_cos();
        let size = (-2.0 * u.ln()).sqrt();
        (f * (1.0 + relative * size * cos) + floor * size * sin).max(0.0)
    }
}

#[cfg(test)]
mod tests;
