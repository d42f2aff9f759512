//! Measured scattering: the data of goniometers and imaging spheres, and their evaluation.
//!
//! A [`Measurement`] is a BSDF as stored in a file. It has one [`MeasuredPart`] for each scatter mode
//! (reflection or transmission, from the front or from the back), with values at the cells of a
//! [`Geometry`] in one or more [`Channel`]s. Its data are not filled, smoothed or renormalised: a
//! cell that was not measured is NaN.
//!
//! **Conventions.** Values are `f` in 1/sr, radiance out over irradiance in, without the cosine,
//! referred to air. A [`Direction`] points away from the sample, its inclination is from the normal
//! of the side of the light, and azimuths have the same sense on both sides. The mirror
//! direction and the regular direction of light from (theta, phi) are therefore both
//! (theta, phi + 180 deg).
//!
//! **Evaluation.** A smooth [`Shape`] through the cells, an [`Audit`], [`Fit`]s of analytic lobes, the
//! [`kernel`] for a display, [`calibrated`] and [`deblurred`] values, and an [`Instrument`] that simulates
//! the measurement of a known BSDF.
//!
//! **Limits**: unpolarised light, a uniform sample, no fluorescence.
//!
//!
//! **Out of scope**: file formats (`formats`).
//!
//! ```
//! use papilio_goniometry::{Fill, Instrument, Shape, SyntheticSample};
//! // Haze 65 measured with an imaging sphere, on its grid of 2 deg and with its blur.
//! let sample = SyntheticSample::new(0.65)?;
//! let seen = sample.measured(&SyntheticSample::instrument(), &[1.0; 3])?;
//! let shape = Shape::of_part(&seen.parts[0], 1, Fill::None).unwrap();
//! // The total integrated scatter of the sample is 0.90.
//! assert!((shape.total(0) - 0.90).abs() < 2e-3);
//! assert!((shape.along(0, 0.0, 0.0).unwrap() - 20.7).abs() < 0.1);
//! # Ok::<(), papilio_goniometry::GoniometryError>(())
//! ```

mod audit;
mod backing;
mod by_wavelength;
mod calibration;
mod direction;
mod double_pass;
mod error;
mod face;
mod fit;
mod geometry;
mod instrument;
mod kernel;
mod measurement;
mod models;
mod patch_rings;
mod patch_turned;
mod scattered;
mod shape;
mod tree;
mod two_instruments;

pub use audit::{Audit, Channels, Incidence, ListedPairs, Rotation};
pub use backing::Backing;
pub use by_wavelength::WavelengthLevels;
pub use calibration::{CalibratedSample, Calibration, calibrated};
pub use direction::Direction;
pub use double_pass::double_pass_error;
pub use error::GoniometryError;
pub use fit::{Data, Fit, FitOptions, Parameter, RankedFit, RegularLight, Weights, fitted, ranked};
pub use geometry::{
    Geometry, HalfAngleGrid, KLEMS_FULL, KLEMS_HALF, KLEMS_QUARTER, Overlap, PartOfCircle, Ring,
    SpecularGrid, SphericalGrid, Symmetry, TensorTree, TreeNode, WarpFields, WarpedGrid, patch_count,
    patch_of, projected_solid_angle,
};
pub use instrument::{
    DeblurOptions, DeblurResult, DeblurStatistics, Instrument, Noise, SyntheticSample, View, deblurred,
    tristimulus_factors,
};
pub use kernel::{Changes, Lamination, Preparation, kernel};
pub use measurement::{Channel, MeasuredPart, Measurement, Provenance, ScatterMode, may_be_relative};
pub use models::{Kind, Meaning, Model, Normalisation};
pub use patch_rings::{lobe_patch_means, ring_patch_lights, ring_patch_means};
pub use scattered::{PairError, PairErrors, PairInterpolation};
pub use shape::{Fill, Shape, is_on_rings, on_specular_grid};
pub use tree::patch_means;
pub use two_instruments::incidence_scale;
