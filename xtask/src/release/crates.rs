//! The crates, as the registry gets them: packed, and each compiled from its package alone, in the order of their dependencies.

use super::{copy, folder, replace, version};
use crate::page;
use crate::shell::{self, Outcome, cargo};

/// Packs and compiles all crates that can be published.
pub(super) fn make() -> Outcome {
    // The crate of the web app carries the page.
    page::build()?;
    let target = shell::target().join("crates");
    let mut publish = cargo(["publish", "--workspace", "--dry-run", "--target-dir"]);
    publish.arg(&target);
    // Neither debug lines nor traces of what changed: each crate is compiled once.
    publish.env("CARGO_PROFILE_DEV_DEBUG", "0").env("CARGO_INCREMENTAL", "0");
    // On a tag there is no change; a developer wants to know before he commits.
    if std::env::var_os("CI").is_none() {
        publish.arg("--allow-dirty");
    }
    shell::run(publish)?;
    replace(|name| name.ends_with(".crate"))?;
    let failure = |error: std::io::Error| format!("{}: {error}", target.display());
    let packages = target.join("package");
    for entry in packages.read_dir().map_err(failure)? {
        let path = entry.map_err(failure)?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name.ends_with(&format!("-{}.crate", version())) {
            copy(&path, &folder().join(name))?;
        }
    }
    Ok(())
}
