//! Papilio on the command line.
fn main() {}
