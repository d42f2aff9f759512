//! Tests of readers and writers.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests also state their expectations by unwrapping"
)]

mod arrays;
mod azimuths;
mod bsdf;
mod decoders;
#[cfg(feature = "svg")]
mod drawings;
mod eulumdat;
mod heights;
mod laboratory;
mod light_map_fields;
mod light_maps;
mod luminaires;
mod meshes;
mod other_pictures;
mod panel;
mod pictures;
mod reading;
mod scene_pictures;
mod tables;
mod writing;
