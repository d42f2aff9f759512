//! The program as its users meet it.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod command_line;
mod common;
mod compare;
mod diffuser;
mod first_steps;
mod lab_files;
mod many_points;
mod migrate;
mod new;
mod optimize;
mod serve;
mod sweep;
mod tolerance;
