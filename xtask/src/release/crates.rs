//! The crates, as the registry gets them: packed, and each compiled from its package alone, in the order of
//! their dependencies.

use std::path::{Path, PathBuf};

use super::{copy, folder, replace, version};
use crate::page;
use crate::shell::{self, Outcome, cargo, command};

/// Packs and compiles all crates that can be published.
pub(super) fn make() -> Outcome {
    // The crate of the web app carries the page.
    page::build()?;
    let target = shell::target().join("crates");
    let packages = target.join("package");
    if packages.exists() {
        std::fs::remove_dir_all(&packages).map_err(|error| format!("{}: {error}", packages.display()))?;
    }
    let mut publish = cargo(["publish", "--workspace", "--dry-run", "--target-dir"]);
    publish.arg(&target);
    // Neither debug lines nor traces of what changed: each crate is compiled once.
    publish.env("CARGO_PROFILE_DEV_DEBUG", "0").env("CARGO_INCREMENTAL", "0");
    // The page is not in git, which is why cargo takes it for a change that was not committed. Others are
    // refused where it matters.
    publish.arg("--allow-dirty");
    if std::env::var_os("CI").is_some() {
        let status = shell::run_apart(command("git", ["status", "--porcelain"]));
        status.outcome?;
        if !status.texts[0].is_empty() {
            return Err(format!("these files differ from the commit:\n{}", status.texts[0]));
        }
    }
    shell::run(publish)?;
    replace(|name| name.ends_with(".crate"))?;
    // Cargo leaves the packages of a dry run in a folder below this one.
    let end = format!("-{}.crate", version());
    for package in find(&packages, &end)? {
        copy(&package, &folder().join(package.file_name().unwrap_or_default()))?;
    }
    Ok(())
}

/// Paths of the files in a folder whose names end so.
fn find(folder: &Path, end: &str) -> Result<Vec<PathBuf>, String> {
    let failure = |error: std::io::Error| format!("{}: {error}", folder.display());
    let mut found = Vec::new();
    for entry in folder.read_dir().map_err(failure)? {
        let path = entry.map_err(failure)?.path();
        if path.is_dir() {
            found.extend(find(&path, end)?);
        } else if path.to_string_lossy().ends_with(end) {
            found.push(path);
        }
    }
    Ok(found)
}
