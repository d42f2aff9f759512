//! Python environments of chores, apart from each other and from the system's.

use std::fs;
use std::path::PathBuf;

use crate::shell::{self, Needs, command};

/// An environment with its packages.
pub(crate) struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// Made, or made complete, in the target folder; left alone if these packages were installed there last.
    pub(crate) fn new(name: &str, packages: &[&str]) -> Result<Self, String> {
        let environment = Self { folder: shell::target().join(name) };
        let installed = fs::read_to_string(environment.list()).unwrap_or_default();
        if installed == packages.join("\n") && environment.python().is_file() {
            return Ok(environment);
        }
        Self::made(name, packages, &[])
    }

    /// Made anew, with nothing else in it.
    pub(crate) fn clean(name: &str, packages: &[&str]) -> Result<Self, String> {
        Self::made(name, packages, &["--clear"])
    }

    fn made(name: &str, packages: &[&str], options: &[&str]) -> Result<Self, String> {
        shell::need(Needs {
            tool: &["python3"],
            install: "install Python 3.11 or newer with its venv module",
        })?;
        let folder = shell::target().join(name);
        let made = ["-m", "venv"].into_iter().chain(options.iter().copied());
        shell::run(command("python3", made.chain([&*folder.to_string_lossy()])))?;
        let environment = Self { folder };
        let install = ["-m", "pip", "install", "--quiet"].into_iter().chain(packages.iter().copied());
        shell::run(command(environment.python(), install))?;
        // Written last: an installation that fails is gone on with the next time.
        fs::write(environment.list(), packages.join("\n")).map_err(|error| format!("{name}: {error}"))?;
        Ok(environment)
    }

    /// The packages that were installed last, a line each.
    fn list(&self) -> PathBuf {
        self.folder.join("packages.txt")
    }

    /// Its interpreter.
    pub(crate) fn python(&self) -> PathBuf {
        self.folder.join(if cfg!(windows) { "Scripts" } else { "bin" }).join("python")
    }
}
