//! The Python package: a wheel, which needs no Rust, and the source distribution.
//!
//! On Linux, the wheel is linked by zig (of the Python package `ziglang`) with the C library of
//! manylinux2014, or musl's, so that it runs on every distribution since 2014. One wheel serves all versions
//! of Python since 3.11 (`abi3`).

use std::path::PathBuf;
use std::process::Command;

use super::program::host;
use super::{check, folder, only, replace, version};
use crate::page;
use crate::python::Environment;
use crate::shell::{self, Outcome, command};

/// Packages that build the wheel.
const PACKAGES: [&str; 2] = ["maturin==1.16.0", "ziglang==0.16.0"];

/// Builds the wheel for a system, and checks it.
pub(super) fn make(target: Option<&str>) -> Outcome {
    page::build()?;
    let host = host()?;
    let target = target.unwrap_or(&host);
    let [system, processor] = platform(target);
    let is_old = |name: &str| name.ends_with(".whl") && name.contains(system) && name.contains(processor);
    replace(is_old)?;
    let mut build = maturin(&["build", "--profile", "dist", "--target", target])?;
    if target.contains("linux") {
        let policy = if target.ends_with("musl") { "musllinux_1_2" } else { "manylinux2014" };
        build.args(["--zig", "--compatibility", policy]);
    }
    shell::run(build)?;
    let wheel = only(is_old, "wheel")?;
    if target != host {
        println!("The wheel for {target} is not checked: the Python of this machine is for {host}.");
        return Ok(());
    }
    check::python(&wheel, None)
}

/// Makes the source distribution, and checks it: pip builds the package from it alone.
pub(super) fn make_source() -> Outcome {
    page::build()?;
    let name = format!("papilio-{}.tar.gz", version());
    replace(|file| file == name)?;
    shell::run(maturin(&["sdist"])?)?;
    // In the profile of the tests, which compiles quickly.
    check::python(
        &only(|file| file == name, "source distribution")?,
        Some("--profile dev --no-default-features"),
    )
}

/// A command of maturin, which finds zig next to itself.
fn maturin(arguments: &[&str]) -> Result<Command, String> {
    let environment = Environment::new("release", &PACKAGES)?;
    let python = environment.python();
    let all = ["-m", "maturin"].into_iter().chain(arguments.iter().copied());
    let mut maturin = command(&python, all.chain(["--manifest-path", "python/Cargo.toml"]));
    maturin.arg("--out").arg(folder());
    let found: Vec<PathBuf> =
        std::env::var_os("PATH").map(|all| std::env::split_paths(&all).collect()).unwrap_or_default();
    let folders = python.parent().map(PathBuf::from).into_iter().chain(found);
    let path = std::env::join_paths(folders).map_err(|error| format!("PATH: {error}"))?;
    maturin.env("PATH", path);
    if let Some(hash) = page::hash() {
        maturin.env("PAPILIO_PAGE", hash);
    }
    Ok(maturin)
}

/// Two words in the names of the wheels for a system.
fn platform(target: &str) -> [&'static str; 2] {
    let is_arm = target.starts_with("aarch64");
    let system = match target {
        _ if target.ends_with("-linux-gnu") => "manylinux",
        _ if target.ends_with("-linux-musl") => "musllinux",
        _ if target.contains("darwin") => return ["macosx", if is_arm { "arm64" } else { "x86_64" }],
        _ => return ["win", if is_arm { "arm64" } else { "amd64" }],
    };
    [system, if is_arm { "aarch64" } else { "x86_64" }]
}
