//! `cargo xtask oldest-rust` and `cargo xtask semver`: what RELEASING.md promises of versions.

use crate::shell::{self, Needs, Outcome, cargo, command};

/// Compiles everything with the oldest Rust that the manifests allow. rustup installs it.
pub(crate) fn oldest_rust() -> Outcome {
    shell::need(Needs { tool: &["rustup"], install: "install Rust with rustup (https://rustup.rs)" })?;
    let oldest = env!("CARGO_PKG_RUST_VERSION");
    shell::run(command(
        "rustup",
        ["toolchain", "install", oldest, "--profile", "minimal", "--no-self-update"],
    ))?;
    shell::run(command(
        "rustup",
        ["run", oldest, "cargo", "check", "--workspace", "--all-targets", "--locked"],
    ))
}

/// Compares what the published crates offer with the last version, if there is one.
pub(crate) fn semver() -> Outcome {
    let described =
        shell::run_apart(command("git", ["describe", "--tags", "--abbrev=0", "--match", "v[0-9]*"]));
    let last = described.texts[0].trim();
    if last.is_empty() {
        println!("There is no tag of a version yet: nothing to compare with.");
        return Ok(());
    }
    let install = "cargo install cargo-semver-checks --locked";
    shell::need(Needs { tool: &["cargo", "semver-checks"], install })?;
    shell::run(cargo(["semver-checks", "--workspace", "--baseline-rev", last]))
}
