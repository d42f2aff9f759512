//! The web app's page (`web/page`): built by npm, tested by node and in a browser.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, Needs, Outcome, cargo, command};

const NPM: Needs = Needs { tool: &["npm"], install: "install Node.js 20 or later (https://nodejs.org)" };

/// Names of the browser that the end-to-end tests drive; the variable `CHROMIUM` names another one.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Which end-to-end tests: the flow of every day with one mishap of each kind, or all of them, with fifty mishaps.
pub(crate) const EVERYDAY: &str = "flow";
/// All of them.
pub(crate) const ALL: &str = "full";

/// The chore: the page alone, all of it.
pub(crate) fn page() -> Outcome {
    let browser = browser()?;
    build()?;
    shell::run(unit_tests())?;
    shell::run(cargo(["build", "--package", "papilio"]))?;
    shell::run(end_to_end(ALL, &browser))
}

/// Where the page is.
pub(crate) fn folder() -> PathBuf {
    shell::root().join("web").join("page")
}

/// Builds the page into `web/page/dist`.
pub(crate) fn build() -> Outcome {
    shell::need(NPM)?;
    if !is_installed(&folder()) {
        shell::run(npm(["ci"]))?;
    }
    shell::run(npm(["run", "build"]))
}

/// Why the page cannot be tested here, or the browser that does it.
pub(crate) fn browser() -> Result<PathBuf, String> {
    shell::need(NPM)?;
    let set = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let folders: Vec<PathBuf> =
        std::env::var_os("PATH").map(|all| std::env::split_paths(&all).collect()).unwrap_or_default();
    let in_path = BROWSERS.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let missing = "chromium is missing: apt-get install chromium, or name one in CHROMIUM";
    set.into_iter().chain(in_path).find(|path| path.is_file()).ok_or_else(|| missing.to_owned())
}

/// The page's unit tests.
pub(crate) fn unit_tests() -> Command {
    npm(["test"])
}

/// The end-to-end tests against the program of the development profile, as it was built last.
pub(crate) fn end_to_end(which: &str, browser: &Path) -> Command {
    let mut tests = npm(["run", which]);
    tests.env("PAPILIO", shell::papilio_for_tests()).env("CHROMIUM", browser);
    tests
}

fn npm<const N: usize>(arguments: [&str; N]) -> Command {
    let mut npm = command("npm", arguments);
    npm.current_dir(folder());
    npm
}

/// True if npm has installed what the lock file says.
fn is_installed(page: &Path) -> bool {
    let changed = |path: &Path| fs::metadata(path).and_then(|about| about.modified()).ok();
    let installed = changed(&page.join("node_modules").join(".package-lock.json"));
    installed.is_some_and(|installed| Some(installed) >= changed(&page.join("package-lock.json")))
}

/// A number for the page that was built last, another one for another page; none if there is no page.
pub(crate) fn print() -> Option<String> {
    // The page's start names all its parts by their contents.
    let start = fs::read(folder().join("dist").join("index.html")).ok()?;
    let mut hasher = DefaultHasher::new();
    start.hash(&mut hasher);
    Some(format!("{:016x}", hasher.finish()))
}
