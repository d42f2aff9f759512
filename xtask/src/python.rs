//! Python environments of the tasks, separate from each other and from that of the system.

use std::fs;
use std::path::PathBuf;

use crate::shell::{self, Needs, command};

/// A virtual environment with its packages.
pub(crate) struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// Creates the environment in the target folder, or installs its missing packages. Does nothing if the
    /// same list of packages was installed there last.
    pub(crate) fn new(name: &str, packages: &[&str]) -> Result<Self, String> {
        let environment = Self { folder: shell::target().join(name) };
        let installed = fs::read_to_string(environment.list()).unwrap_or_default();
        if installed == packages.join("\n") && environment.python().is_file() {
            return Ok(environment);
        }
        Self::create(name, packages, &[])
    }

    /// Creates the environment again, with no other packages.
    pub(crate) fn clean(name: &str, packages: &[&str]) -> Result<Self, String> {
        Self::create(name, packages, &["--clear"])
    }

    fn create(name: &str, packages: &[&str], options: &[&str]) -> Result<Self, String> {
        shell::need(Needs {
            tool: &["python3"],
            install: "install Python 3.11 or later with its venv module",
        })?;
        let folder = shell::target().join(name);
        let create = ["-m", "venv"].into_iter().chain(options.iter().copied());
        shell::run(command("python3", create.chain([&*folder.to_string_lossy()])))?;
        let environment = Self { folder };
        // Compiling all modules of all packages would take longer than installing them; Python compiles those
        // that it imports.
        let install = ["-m", "pip", "install", "--quiet", "--no-compile"];
        let install = install.into_iter().chain(packages.iter().copied());
        shell::run(command(environment.python(), install))?;
        // Written last: a failed installation is repeated the next time.
        fs::write(environment.list(), packages.join("\n")).map_err(|error| format!("{name}: {error}"))?;
        Ok(environment)
    }

    /// Path of the list of installed packages, one per line.
    fn list(&self) -> PathBuf {
        self.folder.join("packages.txt")
    }

    /// Path of its interpreter.
    pub(crate) fn python(&self) -> PathBuf {
        self.folder.join(if cfg!(windows) { "Scripts" } else { "bin" }).join("python")
    }
}
