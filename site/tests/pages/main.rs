//! Tests of the generator: the pages of `docs/`, and small repositories with one mistake each.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests, too, say what they expect by unwrapping"
)]

mod docs;
mod mistakes;
