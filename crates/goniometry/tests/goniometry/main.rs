//! Tests of measured scattering against its known source, and against other programs.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, say what they expect by unwrapping")]

mod about_the_normal;
mod ends;
mod listed;
mod measured;
mod merl;
mod rotations;
mod scipy;
mod trees;
