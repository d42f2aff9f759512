//! Files in and out.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod arrays;
mod bsdf;
mod light_maps;
mod reading;
mod writing;
