//! `cargo xtask serve`: builds the web app with its page, and starts it.

use crate::page;
use crate::shell::{self, Outcome, cargo, command};

/// Builds the page and the program, and starts the server with the arguments of `papilio serve`.
pub(crate) fn serve(arguments: &[String]) -> Outcome {
    let program = build()?;
    let mut serve = command(program, ["serve"]);
    serve.args(arguments);
    shell::run(serve)
}

/// Builds the program with the page, and returns its path.
fn build() -> Result<std::path::PathBuf, String> {
    page::build()?;
    shell::run(cargo(["build", "--release", "--package", "papilio"]))?;
    Ok(shell::papilio())
}
