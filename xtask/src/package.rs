//! The Python package (`python`): built as a wheel by maturin, installed into an environment of its own, tested there.

use std::path::PathBuf;
use std::process::Command;

use crate::python::Environment;
use crate::shell::{self, Outcome, cargo, command};

/// What builds and tests it, pinned, and what it can work with.
const PACKAGES: [&str; 10] = [
    "maturin==1.16.0",
    "pytest==9.2.0",
    "mypy==2.4.1",
    "numpy==2.4.6",
    "xarray==2026.9.0",
    "pandas==3.1.1",
    "distributed==2026.8.0",
    "pyarrow==26.0.1",
    "nbclient==0.11.0",
    "ipykernel==7.4.0",
];

/// How many designs a cluster computes in its long test.
const DESIGNS: (&str, &str) = ("PAPILIO_DESIGNS", "100000");

/// Which of docs/notebooks are run: without it, none.
const NOTEBOOKS: (&str, &str) = ("PAPILIO_NOTEBOOKS", "all");

/// How the extension module is compiled.
#[derive(Clone, Copy)]
pub(crate) enum Profile {
    /// As for tests: quick to build.
    Dev,
    /// As for users.
    Release,
}

impl Profile {
    fn name(self) -> &'static str {
        match self {
            Self::Dev => "dev",
            Self::Release => "release",
        }
    }

    /// The program of this profile.
    fn papilio(self) -> PathBuf {
        match self {
            Self::Dev => shell::papilio_for_tests(),
            Self::Release => shell::papilio(),
        }
    }
}

/// The chore: the wheel as users get it, in a clean environment.
pub(crate) fn package() -> Outcome {
    let environment = Environment::clean("python", &PACKAGES)?;
    build(&environment, Profile::Release)?;
    shell::run(cargo(["build", "--release", "--package", "papilio"]))?;
    shell::run(tests(&environment, Profile::Release))
}

/// The environment of every day, made complete.
pub(crate) fn environment() -> Result<Environment, String> {
    Environment::new("python", &PACKAGES)
}

/// Builds the wheel and installs it.
pub(crate) fn build(environment: &Environment, profile: Profile) -> Outcome {
    let wheels = shell::target().join("wheels");
    let out = wheels.to_string_lossy();
    let build = ["-m", "maturin", "build", "--quiet", "--manifest-path", "python/Cargo.toml", "--profile"];
    let lean = matches!(profile, Profile::Dev).then_some("--no-default-features");
    let build = build.into_iter().chain([profile.name(), "--out", &*out]).chain(lean);
    shell::run(command(environment.python(), build))?;
    // Whatever stands there already: its version may be the same.
    let install = ["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps", "--no-index"];
    let install = install.into_iter().chain(["--find-links", &*out, "papilio"]);
    shell::run(command(environment.python(), install))
}

/// The package's tests; they compare it with the program of the same profile.
pub(crate) fn tests(environment: &Environment, profile: Profile) -> Command {
    // Not in `python`: the sources there, without the extension module, would be taken for the package.
    let arguments = ["-m", "pytest", "-c", "python/pyproject.toml", "python/tests"];
    let mut tests = command(environment.python(), arguments);
    tests.env("PAPILIO", profile.papilio());
    if matches!(profile, Profile::Release) {
        tests.envs([DESIGNS, NOTEBOOKS]);
    }
    tests
}
