//! The Python package (`python`): maturin builds its wheel, which is installed and tested in a separate
//! environment.

use std::path::PathBuf;
use std::process::Command;

use crate::python::Environment;
use crate::shell::{self, Outcome, cargo, command};

/// Packages that build and test it, with versions, and its optional dependencies.
const PACKAGES: [&str; 13] = [
    "maturin==1.16.0",
    "pytest==9.2.0",
    "mypy==2.4.1",
    "numpy==2.4.6",
    "xarray==2026.9.0",
    "pandas==3.1.1",
    "distributed==2026.8.0",
    "pyarrow==26.0.1",
    // Read and write netCDF files.
    "h5netcdf==1.8.2",
    "h5py==3.16.0",
    "nbclient==0.11.0",
    "ipykernel==7.4.0",
    // Renders exported displays, in variants that need no LLVM.
    "mitsuba==3.9.1",
];

/// Number of designs in the long test of clusters.
const DESIGNS: (&str, &str) = ("PAPILIO_DESIGNS", "100000");

/// Notebooks of docs/notebooks to run; without this variable, none.
const NOTEBOOKS: (&str, &str) = ("PAPILIO_NOTEBOOKS", "all");

/// Blocks of the documentation that take long; without this variable, none.
const LONG_BLOCKS: (&str, &str) = ("PAPILIO_DOCS_ALL", "1");

/// Build profile of the extension module.
#[derive(Clone, Copy)]
pub(crate) enum Profile {
    /// For tests: compiles quickly.
    Dev,
    /// For users.
    Release,
}

impl Profile {
    fn name(self) -> &'static str {
        match self {
            Self::Dev => "dev",
            Self::Release => "release",
        }
    }

    /// Path of the program built with this profile.
    fn papilio(self) -> PathBuf {
        match self {
            Self::Dev => shell::papilio_for_tests(),
            Self::Release => shell::papilio(),
        }
    }
}

/// Runs the task: builds the wheel for users, and tests it in a clean environment.
pub(crate) fn package() -> Outcome {
    let environment = Environment::clean("python", &PACKAGES)?;
    build(&environment, Profile::Release)?;
    shell::run(cargo(["build", "--release", "--package", "papilio"]))?;
    shell::run(tests(&environment, Profile::Release))
}

/// The environment of the daily tests, with all packages installed.
pub(crate) fn environment() -> Result<Environment, String> {
    Environment::new("python", &PACKAGES)
}

/// Builds the wheel and installs it.
pub(crate) fn build(environment: &Environment, profile: Profile) -> Outcome {
    wheel(environment, profile).into_iter().try_for_each(shell::run)
}

/// Commands that build the wheel and install it.
pub(crate) fn wheel(environment: &Environment, profile: Profile) -> [Command; 2] {
    let wheels = shell::target().join("wheels");
    let out = wheels.to_string_lossy();
    let build = ["-m", "maturin", "build", "--quiet", "--manifest-path", "python/Cargo.toml", "--profile"];
    let lean = matches!(profile, Profile::Dev).then_some("--no-default-features");
    let build = build.into_iter().chain([profile.name(), "--out", &*out]).chain(lean);
    // Replaces an installed package even if it has the same version.
    let install = ["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps", "--no-index"];
    let install = install.into_iter().chain(["--find-links", &*out, "papilio"]);
    [command(environment.python(), build), command(environment.python(), install)]
}

/// Tests of the package. They compare it with the program of the same profile.
pub(crate) fn tests(environment: &Environment, profile: Profile) -> Command {
    // Not in the folder `python`: Python would import the sources there, which lack the extension module.
    let arguments = ["-m", "pytest", "-c", "python/pyproject.toml", "python/tests"];
    let mut tests = command(environment.python(), arguments);
    tests.env("PAPILIO", profile.papilio());
    if matches!(profile, Profile::Release) {
        tests.envs([DESIGNS, NOTEBOOKS, LONG_BLOCKS]);
    }
    tests
}
