//! Tests of the scenario crate through its public interface.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "helpers of tests may unwrap too")]

mod bad_input;
mod bounds;
mod common;
mod edits;
mod environments;
mod examples;
mod hostile;
mod layers;
mod library;
mod liquid_crystals;
mod matrix;
mod measured;
mod no_light;
mod one_message;
mod optimize;
mod pixels;
mod reflection;
mod remarks;
mod schema;
mod set_and_presets;
mod surfaces;
mod two_forms;
