//! `cargo xtask oracle`: the committed reference tables against the programs that made them.

use crate::shell::{self, Needs, Outcome, command};

/// What the oracles import, pinned.
const PACKAGES: [&str; 4] = ["tmm==0.2.0", "numpy==2.4.6", "colour-science==0.4.7", "scipy==1.17.1"];

const SCRIPTS: [&str; 3] =
    ["validation/films/tmm_oracle.py", "validation/colour/colour_oracle.py", "validation/fits/fit_oracle.py"];

/// The chore.
pub(crate) fn oracle() -> Outcome {
    shell::need(Needs { tool: &["python3"], install: "install Python 3.11 or newer with its venv module" })?;
    let folder = shell::target().join("oracle");
    shell::run(command("python3", ["-m", "venv", &folder.to_string_lossy()]))?;
    let bin = folder.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let python = || bin.join("python");
    shell::run(command(python(), ["-m", "pip", "install", "--quiet"].into_iter().chain(PACKAGES)))?;
    SCRIPTS.into_iter().try_for_each(|script| shell::run(command(python(), [script, "--check"])))
}
