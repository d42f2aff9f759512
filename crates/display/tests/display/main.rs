//! Displays from the scenario to the result: numbers, laws and what does not change them.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod asked_metrics;
mod by_light_and_angle;
mod common;
mod designs;
mod front_light;
mod honest_errors;
mod lights;
mod prepared;
mod viewing_cone;
