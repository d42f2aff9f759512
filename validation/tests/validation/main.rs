//! Comparisons with published numbers, with other programs, and between the two solvers.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests state their expectations by unwrapping"
)]

mod chapter_5;
mod colour_oracle;
mod colour_table_5_1;
mod errors_over_seeds;
mod exported;
mod fit;
mod flat_chains;
mod lamps;
mod materials;
mod measured;
mod measured_pixel;
mod numerical_integration;
mod optimize;
mod paper;
mod polarised;
mod random_scenarios;
mod random_spatial;
mod reference_pixel;
mod sparkle;
mod spatial;
mod table_5_3;
mod two_solvers;
