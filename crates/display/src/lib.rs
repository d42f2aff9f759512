//! The reflective display: pixels, states, lighting, viewer, the run and its metrics.

pub mod result;
pub mod scene;
