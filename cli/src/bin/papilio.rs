//! The program `papilio`; everything is in the library, which the Python package starts as well.

use std::process::ExitCode;

/// Every evaluation of a prepared display allocates many small vectors: with the system's allocator it takes
/// 5 to 8 % longer.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    ExitCode::from(papilio_cli::main(&std::env::args_os().collect::<Vec<_>>()))
}
