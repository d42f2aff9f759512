//! Commands that depend on place: what a reader sees of single pixels.
//!
//! Every function takes a scene whose media have thicknesses ([`crate::scene::Display::lengths_mm`]) and, where sub-pixels matter,
//! a [`crate::scene::Matrix`].

mod sparkle;

pub use sparkle::{Antiglare, SparkleMap, SparkleResult, SparkleRow, sparkle};
