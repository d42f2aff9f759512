//! The reflective display: pixels, states, lighting, viewer, the run and its metrics.

pub mod scene;
