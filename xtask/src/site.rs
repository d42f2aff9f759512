//! `cargo xtask site`: the documentation site, built from `docs/` without a network.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::page;
use crate::shell::{self, Needs, Outcome, cargo, command};

/// Folder of the site in the target folder.
fn folder() -> PathBuf {
    shell::target().join("site")
}

/// Builds the site. With the argument `--api`, it contains the documentation of the crates; with `--check`,
/// it is tested in a browser.
pub(crate) fn site(arguments: &[String]) -> Outcome {
    let known = ["--api", "--check"];
    if arguments.iter().any(|argument| !known.contains(&argument.as_str())) {
        return Err("usage: cargo xtask site [--api] [--check]".to_owned());
    }
    let has = |option: &str| arguments.iter().any(|argument| argument == option);
    if has("--api") {
        shell::run(cargo(["doc", "--workspace", "--no-deps", "--no-default-features"]))?;
    }
    build(&folder(), has("--api"))?;
    if has("--check") { check() } else { Ok(()) }
}

/// Builds the site into a folder.
fn build(out: &Path, with_crates: bool) -> Outcome {
    let mut generator = cargo(["run", "--quiet", "--package", "papilio-site", "--"]);
    generator.arg(out);
    if let Some(pages) = python_reference()? {
        generator.arg("--python").arg(pages);
    }
    if with_crates {
        generator.arg("--rust").arg(shell::target().join("doc"));
    }
    shell::run(generator)
}

/// Writes the reference of the Python package, and returns its folder. Without Python, the site shows the
/// sources of its modules.
fn python_reference() -> Result<Option<PathBuf>, String> {
    let python = Needs {
        tool: &["python3"],
        install: "install Python 3.11 or later for the reference of the package",
    };
    if let Err(missing) = shell::need(python) {
        println!("site: {missing}");
        return Ok(None);
    }
    let pages = shell::target().join("site-python");
    // Pages of modules that no longer exist.
    let _ = fs::remove_dir_all(&pages);
    shell::run(command("python3", ["site/python_api.py", &*pages.to_string_lossy()]))?;
    Ok(Some(pages))
}

/// Builds the site and tests it in a browser, with the packages of the web app's page: axe-core and
/// playwright-core.
pub(crate) fn check() -> Outcome {
    let browser = page::browser()?;
    page::install()?;
    let site = shell::target().join("site-tested");
    build(&site, false)?;
    let mut tests = command("node", ["--test", "site/tests/browser.test.mjs"]);
    tests.env("SITE", site).env("CHROMIUM", browser).env("PAGE", page::folder());
    shell::run(tests)
}

/// Tests of the search in the index of the site, without a browser.
pub(crate) fn search_tests() -> Command {
    command("node", ["--test", "site/tests/search.test.mjs"])
}
