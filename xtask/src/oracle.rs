//! `cargo xtask oracle`: the committed reference tables against the programs that made them.

use crate::python::Environment;
use crate::shell::{self, Outcome, command};

/// What the oracles import, pinned.
const PACKAGES: [&str; 4] = ["tmm==0.2.0", "numpy==2.4.6", "colour-science==0.4.7", "scipy==1.17.1"];

const SCRIPTS: [&str; 4] = [
    "validation/films/tmm_oracle.py",
    "validation/colour/tables_oracle.py",
    "validation/colour/colour_oracle.py",
    "validation/fits/fit_oracle.py",
];

/// The chore.
pub(crate) fn oracle() -> Outcome {
    let environment = Environment::new("oracle", &PACKAGES)?;
    SCRIPTS.into_iter().try_for_each(|script| shell::run(command(environment.python(), [script, "--check"])))
}
