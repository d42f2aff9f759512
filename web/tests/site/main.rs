//! Tests of the server over a socket, with requests of browsers and of attackers.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests; the load test prints its results"
)]

mod answers;
mod client;
mod description;
mod detail;
mod gonio;
mod hostile;
mod image;
mod load;
mod offers;
mod soak;
mod studies;
