//! Both solvers against closed forms, published tables, laws and each other.

#![allow(
    clippy::panic,
    clippy::print_stdout,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod adding_layered;
mod adding_layered_laws;
mod adding_panel;
mod azimuth;
mod closed_forms;
mod common;
mod double_pass;
mod errors_over_paths;
mod few_wavelengths;
mod fields;
mod floors;
mod lambertian_return;
mod layered_spread;
mod layered_walk;
mod layers;
mod many_columns;
mod narrow_lobes;
mod panel_spread;
mod places;
mod plain;
mod plain_campaign;
mod reflecting;
mod rough_surface;
mod scatter_faces;
mod stokes;
mod strategies;
mod wave_faces;
