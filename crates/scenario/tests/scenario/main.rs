//! The scenario room from outside: what it takes, what it refuses, and how.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod bad_input;
mod bounds;
mod common;
mod environments;
mod examples;
mod hostile;
mod layers;
mod library;
mod measured;
mod optimize;
mod pixels;
mod remarks;
mod schema;
mod set_and_presets;
