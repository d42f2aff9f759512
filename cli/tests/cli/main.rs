//! Tests of the program as a process, one module for each command.

#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping, and campaigns print what they find"
)]

mod bad_input;
mod bad_pictures;
mod brdf;
mod catalogue;
mod common;
mod compare;
mod cone;
mod crosstalk;
mod diffuser;
// The commands are those of a Unix shell.
#[cfg(unix)]
mod docs_blocks;
// Memory and time of a process, as Linux states them.
#[cfg(target_os = "linux")]
mod extremes;
mod figures;
mod fine_detail;
mod first_steps;
mod fit;
mod frame;
mod gloss;
mod gonio;
mod image;
#[cfg(target_os = "linux")]
mod kills;
mod lab_files;
mod many_points;
mod migrate;
mod mtf;
mod new;
mod optimize;
mod palette;
mod pixel;
mod progress;
mod reference;
mod run;
mod same_time;
mod serve;
mod sparkle;
mod state_names;
mod sweep;
mod tolerance;
// Limits of a process, as a Unix shell sets them.
#[cfg(unix)]
mod unwritable;
mod warnings;
