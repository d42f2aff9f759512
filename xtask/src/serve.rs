//! `cargo xtask serve`: the web app with its page, built and served.

use crate::page;
use crate::shell::{self, Outcome, cargo, command};

/// Builds the page and the program, and serves; `arguments` are those of `papilio serve`.
pub(crate) fn serve(arguments: &[String]) -> Outcome {
    let program = build()?;
    let mut serve = command(program, ["serve"]);
    serve.args(arguments);
    shell::run(serve)
}

/// Builds the page into the program, and returns where that is.
fn build() -> Result<std::path::PathBuf, String> {
    page::build()?;
    shell::run(cargo(["build", "--release", "--package", "papilio"]))?;
    Ok(shell::papilio())
}
