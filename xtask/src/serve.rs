//! `cargo xtask serve`: the web app with its page, built and served.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use crate::shell::{self, Needs, Outcome, cargo, command};

/// Builds the page and the program, and serves; `arguments` are those of `papilio serve`.
pub(crate) fn serve(arguments: &[String]) -> Outcome {
    let program = build()?;
    let mut serve = command(program, ["serve"]);
    serve.args(arguments);
    shell::run(serve)
}

/// Builds the page into the program, and returns where that is.
fn build() -> Result<std::path::PathBuf, String> {
    let page = shell::root().join("web").join("page");
    shell::need(Needs { tool: &["npm"], install: "install Node.js 20 or later (https://nodejs.org)" })?;
    let npm = |arguments: &[&str]| {
        let mut npm = command("npm", arguments);
        npm.current_dir(&page);
        shell::run(npm)
    };
    if !is_installed(&page) {
        npm(&["ci"])?;
    }
    npm(&["run", "build"])?;
    let mut build = cargo(["build", "--release", "--package", "papilio"]);
    // The program notices a page that was built anew.
    build.env("PAPILIO_PAGE", print_of(&page.join("dist").join("index.html"))?);
    shell::run(build)?;
    Ok(shell::target().join("release").join(if cfg!(windows) { "papilio.exe" } else { "papilio" }))
}

/// True if npm has installed what the lock file says.
fn is_installed(page: &Path) -> bool {
    let changed = |path: &Path| fs::metadata(path).and_then(|about| about.modified()).ok();
    let installed = changed(&page.join("node_modules").join(".package-lock.json"));
    installed.is_some_and(|installed| Some(installed) >= changed(&page.join("package-lock.json")))
}

/// Another number for another page: its start names all its parts by their contents.
fn print_of(index: &Path) -> Result<String, String> {
    let text = fs::read(index).map_err(|error| format!("{} cannot be read: {error}", index.display()))?;
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    Ok(format!("{:016x}", hasher.finish()))
}
