//! Tests of studies, searches and tolerance analyses through the public API.

#![allow(clippy::panic, clippy::unwrap_used, reason = "test helpers unwrap what they expect")]

mod design;
mod fit;
mod fit_limits;
mod production;
