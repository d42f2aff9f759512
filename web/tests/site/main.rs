//! The server as a browser, or an attacker, meets it: over a socket.

#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a test; that of the load says what it found"
)]

mod answers;
mod client;
mod description;
mod hostile;
mod load;
