//! The page of the web app (`web/page`): built with npm, tested with node and in a browser.

use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::shell::{self, Needs, Outcome, cargo, command};

/// The program npm: on Windows it is a script, which is found only by its whole name.
const PROGRAM: &str = if cfg!(windows) { "npm.cmd" } else { "npm" };

const NPM: Needs = Needs { tool: &[PROGRAM], install: "install Node.js 20 or later (https://nodejs.org)" };

/// Names of the browser for the end-to-end tests; the variable `CHROMIUM` specifies another one.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// Daily end-to-end tests: the main workflow, and one simulated failure of each kind.
pub(crate) const EVERYDAY: &str = "flow";
/// All end-to-end tests, with fifty simulated failures.
pub(crate) const ALL: &str = "full";

/// Runs the task: builds the page, and runs all its tests.
pub(crate) fn page() -> Outcome {
    let browser = browser()?;
    build()?;
    shell::run(unit_tests())?;
    shell::run(cargo(["build", "--package", "papilio"]))?;
    shell::run(end_to_end(ALL, &browser))
}

/// Folder of the page.
pub(crate) fn folder() -> PathBuf {
    shell::root().join("web").join("page")
}

/// Builds the page into `web/page/dist`.
pub(crate) fn build() -> Outcome {
    install()?;
    shell::run(npm(["run", "build"]))
}

/// Installs the packages of the lock file, if they are not installed.
pub(crate) fn install() -> Outcome {
    shell::need(NPM)?;
    if is_installed(&folder()) { Ok(()) } else { shell::run(npm(["ci"])) }
}

/// Path of the browser for the tests, or the reason why the page cannot be tested.
pub(crate) fn browser() -> Result<PathBuf, String> {
    shell::need(NPM)?;
    let specified = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let folders: Vec<PathBuf> =
        std::env::var_os("PATH").map(|all| std::env::split_paths(&all).collect()).unwrap_or_default();
    let in_path = BROWSERS.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name)));
    let missing = "chromium is missing: apt-get install chromium, or set CHROMIUM to the path of a browser";
    specified.into_iter().chain(in_path).find(|path| path.is_file()).ok_or_else(|| missing.to_owned())
}

/// Unit tests of the page.
pub(crate) fn unit_tests() -> Command {
    npm(["test"])
}

/// End-to-end tests of the page, with the latest program of the development profile.
pub(crate) fn end_to_end(which: &str, browser: &Path) -> Command {
    let mut tests = npm(["run", which]);
    tests.env("PAPILIO", shell::papilio_for_tests()).env("CHROMIUM", browser);
    tests
}

/// What `cargo xtask measure-page` can do: scripts of `web/page/package.json`.
const MEASUREMENTS: [&str; 3] = ["soak", "latency", "looks"];

/// Measures the page with the release program in a browser: soak of an hour, latency of all examples, or screenshots of all tools. The results
/// are in `target/page`.
pub(crate) fn measure(arguments: &[String]) -> Outcome {
    let (what, more) = arguments.split_first().ok_or("name one of soak, latency, looks")?;
    if !MEASUREMENTS.contains(&what.as_str()) {
        return Err(format!("`{what}` is none of {}", MEASUREMENTS.join(", ")));
    }
    let browser = browser()?;
    build()?;
    shell::run(cargo(["build", "--release", "--package", "papilio"]))?;
    let mut script = npm(["run", what, "--"]);
    script.env("PAPILIO", shell::papilio()).env("CHROMIUM", browser);
    if what == "soak" {
        script.arg(more.first().map_or("60", String::as_str));
        script.arg(shell::target().join("page"));
    } else {
        script.arg(shell::target().join("page")).args(more);
    }
    shell::run(script)
}

fn npm<const N: usize>(arguments: [&str; N]) -> Command {
    let mut npm = command(PROGRAM, arguments);
    npm.current_dir(folder());
    npm
}

/// True if npm has installed the packages of the lock file.
fn is_installed(page: &Path) -> bool {
    let changed = |path: &Path| fs::metadata(path).and_then(|about| about.modified()).ok();
    let installed = changed(&page.join("node_modules").join(".package-lock.json"));
    installed.is_some_and(|installed| Some(installed) >= changed(&page.join("package-lock.json")))
}

/// Hash of the latest page; `None` if there is no page.
pub(crate) fn hash() -> Option<String> {
    // index.html contains the names of all other files, which contain hashes of their contents.
    let start = fs::read(folder().join("dist").join("index.html")).ok()?;
    let mut hasher = DefaultHasher::new();
    start.hash(&mut hasher);
    Some(format!("{:016x}", hasher.finish()))
}
