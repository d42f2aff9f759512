//! Simulation of reflective displays: pixels, drive states, lighting, viewer, runs and metrics.
//!
//! **API boundary.** [`run`] computes a [`result::RunResult`] from a [`scene::Scene`];
//! [`pixel::scan`] computes the reflectance of the pixel alone. The `scenario` crate reads scenes
//! from files, but any program can construct one:
//!
//! ```
//! use papilio_display::scene::*;
//! use papilio_display::{Control, run};
//! use papilio_spectra::{Grid, Spectrum, illuminant};
//! use std::sync::atomic::AtomicBool;
//!
//! // White paint (50 %) under bare glass, in diffuse light.
//! let grid = Grid::new(380.0, 780.0, 20.0)?;
//! let constant = |value| Spectrum::constant(&grid, value);
//! let paint = UniformPixel {
//!     kind: UniformKind::Lambertian,
//!     states: vec![("white".into(), constant(0.5))],
//!     spread_mm: 0.0,
//! };
//! let scene = Scene {
//!     grid,
//!     display: Display {
//!         layers: vec![Layer {
//!             interface: Ready::Fresnel.into(),
//!             medium: Medium::clear(constant(1.5)),
//!             thickness: Length::Mm(0.5),
//!             depolarisation: Depolarisation::default(),
//!         }],
//!         pixel: Pixel::Uniform(paint),
//!         matrix: None,
//!     },
//!     lighting: Lighting {
//!         illuminance_lx: 500.0,
//!         diffuse: 1.0,
//!         diffuse_spectrum: illuminant("D65", &grid)?.into(),
//!         directed: vec![],
//!         environment: vec![],
//!         front_light: None,
//!         port: None,
//!     },
//!     viewer: Viewer { theta_deg: vec![0.0], phi_deg: vec![0.0], field_deg: 0.1, numerical_aperture: None, polariser_deg: None, distance_mm: 500.0 },
//!     metrics: Metrics::default(),
//!     solver: Solver {
//!         method: Method::MonteCarlo,
//!         stop: Stop::RelativeError { target: 0.001, per_wavelength: false },
//!         sampler: Sampler::Sobol,
//!         scattering: Strategy::Kernel,
//!         approximation: Approximation::None,
//!         angle_medium: AngleMedium::Air,
//!         seed: 0,
//!     },
//!     unresolved: vec![],
//!     within_step: None,
//! };
//! let control = Control { threads: None, progress: &|_| {}, stop: &AtomicBool::new(false) };
//! let result = run(&scene, &control)?;
//! let white = result.views[0].states.get("white").unwrap();
//! // Saunderson's correction: 0.316071 for a paint of reflectance 0.5 viewed along the normal.
//! assert!((white.value.Y - 0.316071).abs() < 5.0 * white.standard_error.Y);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A series of scenes that differ little, as in a sweep or an interactive program, is run through one
//! [`Prepared`], which reuses all results that are still valid.
//!
//! [`Designs`] evaluates many film pixels under fixed layers, lights and views, as an optimisation needs it.
//!
//! Inside, data flows in one direction: `setup` prepares the stack, sources and views of a scene;
//! `run` calls a solver for them; `meter` converts its estimates into metrics with errors.
//!
//! **Limits.** The display is uniform over the field of view. **Out of scope.** Files, TOML and
//! output.

mod ambient_light;
mod brdf;
pub mod compare;
mod cone;
mod designs;
pub mod environment;
mod error;
mod filtered;
pub mod gloss;
mod half_vectors;
mod haze;
pub mod image;
mod label;
mod lamp_images;
mod lobe_width;
mod lobes;
mod meter;
mod metrics;
mod node_density;
mod notes;
pub mod palette;
pub mod pixel;
mod polarisation;
mod port;
mod prepared;
mod probes;
pub mod readability;
mod reflection;
pub mod result;
mod rings;
mod rows;
mod run;
pub mod scene;
mod setup;
mod single_view;
pub mod spatial;
mod surface;
mod target;
mod threads;
mod viewers;
mod within_step;

pub use ambient_light::{AmbientLight, AmbientSource, ambient_light, ambient_light_by_direction};
pub use brdf::{BrdfGrid, BrdfTable};
pub use cone::{ConeGrid, ConeLight, ConeResult, ConeState, ConeView};
pub use designs::{Derivatives, Designs, Parameter, Quantity};
pub use error::DisplayError;
pub use half_vectors::{HalfVectorGrid, HalfVectorTable};
pub use label::{
    Label, angle_in_text, capitalised, label_from_name, labelled_names, metric_label, split_unit,
    uncapitalised, view_in_name,
};
pub use lobe_width::LobeWidths;
pub use lobes::{TransmittedLobe, transmitted_lobes};
pub use node_density::NodeDensity;
pub use polarisation::note_of_places;
pub use prepared::Prepared;
pub use probes::ProbeGrid;
pub use reflection::{Reflection, ReflectionState, reflection};
pub use rings::{RingGrid, RingTable};
pub use rows::RowErrors;
pub use run::{
    Control, Cost, Forecast, Progress, ProgressFraction, SavedRows, StudyCurve, StudyPoint,
    THICKEST_FOR_MONTE_CARLO, Unsaved, adding_seconds, always_by_adding, brdf, brdf_at_viewers,
    brdf_at_viewers_resumed, brdf_resumed, cone, cost, depends_on_azimuth, expected_bytes,
    expected_map_bytes, expected_seconds, expected_view_bytes, forecast, run, study,
};
pub use single_view::{LightSummary, SingleView};
pub use viewers::{BrdfState, Viewer, ViewerGrid, ViewerTable};
