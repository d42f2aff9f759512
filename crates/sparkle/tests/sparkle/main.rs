//! Rays through random faces against waves.

#![allow(clippy::unwrap_used, reason = "helpers of tests, too, say what they expect by unwrapping")]

mod waves;
