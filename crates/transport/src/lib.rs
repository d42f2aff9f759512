//! Light transport through the layered display: the stack and its two solvers.
//!
//! - [`Stack`]: any layers in any order, each an [`Interface`] and the [`Medium`] below it, over the pixel
//!   ([`Base`]; a specular one is an [`AngularTable`]).
//! - [`Panel`]: what a stack is for the fast methods of both solvers, if it is a front of screen ([`Front`]),
//!   a surface or a [`Diffuser`] ([`Top`]), and clear glass.
//! - [`Source`], [`Field`] and [`Cone`]: directions of light and of the viewer; spectrum and illuminance of a
//!   source are the caller's. A field consists of cells, of [`Pixels`] or of a formula ([`Radiance`]).
//! - [`walk`]: unbiased Monte Carlo. The result is, for each source, the reflectance factor
//!   under that source alone, by state and wavelength, and an energy ledger.
//!
//! Directions are [`Beta`](papilio_optics::Beta), direction cosines of propagation; radiance is
//! basic radiance (over index squared). Arrays over states and wavelengths are flat, in the
//! order `[state][wavelength]`.
//!
//! ```
//! use papilio_sampling::{SampleStream, Sampler};
//! use papilio_transport::walk::Walk;
//! use papilio_transport::{
//!     AngularTable, Base, Cone, Interface, Layer, Medium, Nodes, Reflector, Source, Stack,
//! };
//!
//! // Bare glass of index 1.5 over a mirror of 50 %, one state, one wavelength.
//! let mirror =
//!     AngularTable { nodes: Nodes::Constant, basis: vec![0.5].into(), mixture: vec![1.0], common: vec![0.0] };
//! let base = Base { reflector: Reflector::Specular(mirror), inactive_absorptance: vec![0.0].into() };
//! let glass = Layer::new(Interface::Fresnel, Medium::new(vec![1.5].into()));
//! let stack = Stack::new(vec![glass], base);
//! let normal = Cone::new(0.0, 0.0, 0.0, 1.0);
//! let walk = Walk::new(&stack, normal, &[Source::Diffuse]);
//! let mut replicate = walk.replicate();
//! walk.trace(&mut replicate, &SampleStream::new(Sampler::Sobol, 0, 0), 1 << 14);
//! let rho = &walk.estimate(&replicate).rho[0];
//! // r + (1 - r)^2 0.5 / (1 - 0.5 r) with r = 0.04.
//! assert!((rho.via_pixel[0] + rho.front[0] - 0.510204).abs() < 1e-3);
//! ```
//!
//! **Limits.** Layers are parallel and uniform; scattered light counts as unpolarised; a
//! diffuser given by its BTDF reflects nothing, unless its reflection is described too
//! ([`ReflectingDiffuser`]).
//!
//! **Out of scope.** Threads, files, spectra of light, colours.

pub mod adding;
mod angular;
mod base;
mod cosines;
mod estimate;
mod front;
mod layers;
mod light;
mod mirror_run;
mod mueller;
mod numerics;
mod panel;
mod phases;
mod pixel_spread;
mod polarised_view;
mod skeleton;
pub mod spatial;
mod specular;
mod stack;
pub mod walk;
mod window;

pub use angular::{AngularTable, Nodes};
pub use base::{Base, Reflector};
pub use cosines::CosinePanels;
pub use estimate::{Estimate, Ledger, ReflectanceFactor};
pub use front::Front;
pub use layers::*;
pub use light::{Cone, Edge, Field, Pixels, Radiance, Source, Vibration};
pub use mueller::{Mueller, MuellerAt, MuellerByDirection, WholeView};
pub use panel::{Approximation, Described, Panel, PanelParts, Top};
pub use phases::Phases;
pub use pixel_spread::PixelSpread;
pub use polarised_view::{Followed, PolarisedLight, PolarisedView, Top as PolarisedTop};
pub use specular::{disc_image, specular_image, specular_image_of};
pub use stack::{Layer, NotAPanel, Stack};
