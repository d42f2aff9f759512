//! `cargo xtask peers`: compares the speed of Papilio with that of other programs, for docs/peers.md.

use crate::package::{self, Profile};
use crate::python::Environment;
use crate::shell::{self, Outcome, cargo, command};

/// The other programs, with versions. Newer versions of mitsuba need a newer LLVM than some systems have.
const PACKAGES: [&str; 14] = [
    "tmm==0.2.0",
    "tmm_fast==0.3.0",
    "PyMoosh==4.0.1",
    "pyElli==0.23.1",
    "colour-science==0.4.7",
    "pywincalc==3.3.1",
    "mitsuba==3.7.1",
    "numpy==2.4.6",
    "pillow==13.0.0",
    "epaper-dithering==6.1.1",
    // Judge and photographs of pictures.
    "scikit-image==0.26.0",
    "scikit-learn==1.9.1",
    "matplotlib==3.11.2",
    // Builds Papilio's own package.
    "maturin==1.16.0",
];

/// Runs the task. It takes minutes, during which no other program should run.
pub(crate) fn peers() -> Outcome {
    let environment = Environment::new("peers", &PACKAGES)?;
    package::build(&environment, Profile::Release)?;
    shell::run(cargo(["build", "--release", "--package", "papilio-validation", "--example", "peers"]))?;
    let program =
        shell::target().join("release/examples/peers").with_extension(std::env::consts::EXE_EXTENSION);
    shell::run(cargo(["build", "--release", "--bin", "papilio"]))?;
    let papilio = shell::papilio();
    for (script, program) in [("peers", program), ("pictures", papilio)] {
        let script = format!("validation/peers/{script}.py");
        shell::run(command(environment.python(), [&*script, &program.to_string_lossy()]))?;
    }
    Ok(())
}
