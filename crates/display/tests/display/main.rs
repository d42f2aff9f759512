//! Tests of displays from the scenario to the result: values, physical laws and reproducibility.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests express expectations by unwrapping, too"
)]

mod absorption;
mod aperture;
mod asked_metrics;
mod auto;
mod below_layers;
mod by_light_and_angle;
mod common;
mod crosstalk;
mod crosstalk_by_paths;
mod crosstalk_returned;
mod depolarisation;
mod designs;
mod filter;
mod filter_above_crystals;
mod filter_above_mirrors;
mod first_answers;
mod front_light;
mod fronts;
mod gloss;
mod half_vectors;
mod honest_errors;
mod images;
mod layered_mtf;
mod levels_that_agree;
mod lights;
mod liquid_crystals;
mod microgeometry;
mod mirrors_kept_apart;
mod mtf;
mod one_model;
mod particles;
mod picture;
mod picture_samples;
mod placed;
mod polarised_crystals;
mod polarised_views;
mod port;
mod prepared;
mod returned;
mod shown;
mod spread_within;
mod sub_pixels;
mod table_azimuths;
mod tangents;
mod viewing_cone;
mod within_step;
