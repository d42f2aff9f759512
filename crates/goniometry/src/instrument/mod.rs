//! A virtual instrument: simulated measurement of a known lobe with an imaging sphere.
//!
//! Light arrives from each incidence of the grid. The values are those of the sample, blurred, normalised
//! and with noise:
//!
//! - **Blur**: f is convolved, in the plane of direction cosines, with a k-correlation kernel of width
//!   `blur`, which is the image of a collimated beam by source, optics and camera. A k-correlation lobe of
//!   width b becomes one of width b + blur.
//! - **Renormalised** values integrate to the sample's own total, including light that the blur moves
//!   beyond the horizon; real instruments are calibrated in this way. Otherwise that light is lost.
//! - **Noise** is normal, with a `relative` component and a `floor` in 1/sr; negative values become 0. Random
//!   numbers depend on seed, scatter mode, channel and cell only.
//! - **TIS** is the true total of each incidence, times the channel's factor, as from a separate detector
//!   without blur and noise.
//!
//! The resolution of the instrument is that of its kernel, but it samples points: cells are not averaged over
//! their extent.

mod blur;
mod deblur;
mod quadrature;
mod rings;
mod synthetic;

use std::f64::consts::PI;

use papilio_optics::Beta;
use papilio_sampling::{SampleStream, Sampler};

use crate::{
    Channel, Geometry, GoniometryError, MeasuredPart, Measurement, Provenance, ScatterMode, SpecularGrid,
    Symmetry,
};
use blur::BlurredLobe;
use quadrature::Rule;

pub use deblur::{DeblurOptions, DeblurResult, DeblurStatistics, deblurred};
pub use synthetic::{SyntheticSample, tristimulus_factors};

/// Virtual imaging sphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Instrument {
    /// Directions of the measurement.
    pub grid: SpecularGrid,
    /// Channels of the measurement.
    pub channels: Vec<Channel>,
    /// Width of the image of a collimated beam, direction cosines: 0.0001 to 1, or 0 without blur.
    pub blur: f64,
    /// True if the values integrate to the sample's total.
    pub renormalise: bool,
    /// Noise of the values.
    pub noise: Noise,
    /// Inclination beyond which all values are 0, degrees.
    pub dark_beyond_deg: f64,
}

/// Noise of an instrument.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Noise {
    /// Standard deviation relative to the value.
    pub relative: f64,
    /// Standard deviation of the additive component, 1/sr. Negative results become 0, which raises the mean of dark values
    /// by up to `floor/sqrt(2 pi)`.
    pub floor: f64,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// One scatter mode of a sample to be measured.
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// Scatter mode.
    pub way: ScatterMode,
    /// f, 1/sr, for direction cosines of propagation in air. Values beyond |beta| = 1 are
    /// blurred into the hemisphere; they may be 0.
    pub f: &'a dyn Fn(Beta, Beta) -> f64,
    /// Fraction that is not scattered, multiplied by the same factors. It must be 0 for an instrument without
    /// blur, because its image would have no width.
    pub straight: f64,
    /// Factors of f in each of the instrument's channels.
    pub factors: &'a [f64],
}

impl Instrument {
    /// Instrument of the dissertation (Feng 2012, section 3.3): incidences 0 to 75 deg in steps of 5,
    /// azimuths 0 to 180 in steps of 10, radial distances 0 to 180 in steps of 2; X, Y and Z; without blur
    /// and noise.
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

    /// Simulates the measurement of a sample.
    ///
    /// # Errors
    /// If one of the instrument's numbers is out of range, or a view does not have one factor for each
    /// channel.
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
            return Err(GoniometryError::OutOfRange { what, value, expected: "0, or 0.0001 to 1" });
        }
        if self.blur == 0.0 && views.iter().any(|view| view.straight > 0.0) {
            let expected = "above 0 with unscattered light, whose image has the width of the blur";
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

    fn part(&self, view: &View<'_>) -> MeasuredPart {
        let (rule, geometry) = (Rule::new(), Geometry::Specular(self.grid.clone()));
        let per_incidence = self.grid.azimuths_deg.len() * self.grid.radials_deg.len();
        let mut clean = Vec::with_capacity(geometry.cells());
        let mut totals = Vec::new();
        for rotation in &self.grid.rotations_deg {
            for incidence in &self.grid.incidences_deg {
                // The sample rotates; the instrument does not.
                let from = Beta::from_source(*incidence, 180.0 - rotation, 1.0);
                let lobe = BlurredLobe::new(&rule, view.f, from, self.blur).with_straight(view.straight);
                let total = lobe.total();
                let scale = if self.renormalise && total > 0.0 { total / lobe.measured_total() } else { 1.0 };
                let cells = clean.len()..clean.len() + per_incidence;
                clean.extend(cells.map(|cell| {
                    let viewer = geometry.directions(cell).map(|[_, viewer]| viewer);
                    let visible = viewer.filter(|viewer| viewer.theta_deg <= self.dark_beyond_deg);
                    visible.map_or(0.0, |viewer| scale * lobe.value(viewer.leaving()))
                }));
                totals.push(total);
            }
        }
        let noisy = |(channel, factor): (usize, &f64)| -> Vec<f64> {
            let stream = (view.way as u64) * 256 + channel as u64;
            let numbers = SampleStream::new(Sampler::Random, self.noise.seed, stream);
            clean.iter().enumerate().map(|(k, f)| self.noisy(f * factor, &numbers, self.pixel(k))).collect()
        };
        MeasuredPart {
            way: view.way,
            channels: self.channels.clone(),
            geometry: geometry.clone(),
            values: view.factors.iter().enumerate().flat_map(noisy).collect(),
            tis: view.factors.iter().flat_map(|factor| totals.iter().map(move |t| t * factor)).collect(),
        }
    }

    /// Index of the camera pixel of a cell: at radial distance 0, all azimuths share one pixel.
    fn pixel(&self, cell: usize) -> u64 {
        let radials = self.grid.radials_deg.len();
        let row = radials * self.grid.azimuths_deg.len();
        let at_centre = self.grid.radials_deg[cell % radials] == 0.0;
        (if at_centre { cell - cell % row + cell % radials } else { cell }) as u64
    }

    fn noisy(&self, f: f64, numbers: &SampleStream, pixel: u64) -> f64 {
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
