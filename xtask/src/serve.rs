//! `cargo xtask serve`: the web app with its page, built and served.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

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
    let mut build = cargo(["build", "--release", "--package", "papilio"]);
    // The program notices a page that was built anew.
    build.env("PAPILIO_PAGE", print_of(&page::folder().join("dist").join("index.html"))?);
    shell::run(build)?;
    Ok(shell::target().join("release").join(if cfg!(windows) { "papilio.exe" } else { "papilio" }))
}

/// Another number for another page: its start names all its parts by their contents.
fn print_of(index: &Path) -> Result<String, String> {
    let text = fs::read(index).map_err(|error| format!("{} cannot be read: {error}", index.display()))?;
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}
