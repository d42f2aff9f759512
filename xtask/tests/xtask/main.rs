//! Tests of the files of the project that no program reads.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests say what they expect by unwrapping")]

mod project;
