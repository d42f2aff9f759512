//! Designs, searches and tolerances from outside.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod design;
mod production;
