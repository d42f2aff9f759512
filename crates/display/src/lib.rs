//! The reflective display: pixels, states, lighting, viewer, the run and its metrics.

mod error;
mod meter;
mod metrics;
pub mod pixel;
mod prepare;
pub mod result;
mod run;
mod sample;
pub mod scene;

pub use error::DisplayError;
pub use run::{Control, Progress, run};
