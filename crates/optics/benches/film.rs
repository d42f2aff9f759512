//! Benchmarks of the film kernel.

fn main() {}
