//! The extension module under the Python package `papilio`: a thin face over `scenario`, `display`, `formats`,
//! `figures`, `colour` and `optics`.
//!
//! The package's own modules (`papilio/*.py`) hold what Python does well: arguments, tables, notebooks. Here is what
//! computes, with the interpreter free meanwhile. Mistakes come out as the exceptions of `papilio/errors.py`; what is
//! given is checked on this side, too: nothing a script says ends the interpreter.

mod batch;
mod brdf;
mod colour;
mod columns;
mod cone;
mod diffuser;
mod errors;
mod figures;
mod films;
mod plot;
mod pool;
mod production;
mod result;
mod run;
mod scenario;
mod search;
mod watch;

use pyo3::prelude::*;

/// Small vectors come and go in every evaluation of a prepared display.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// What the package `papilio` stands on; not for use by itself.
#[pymodule]
mod _papilio {
    #[pymodule_export]
    use crate::batch::{Batch, metric_names};
    #[pymodule_export]
    use crate::brdf::{beams, bsdf};
    #[pymodule_export]
    use crate::colour::{delta_e_2000, gamut, illuminant_names, illuminant_spectrum, lab, uv_prime, xyz};
    #[pymodule_export]
    use crate::cone::Cone;
    #[pymodule_export]
    use crate::diffuser::{Diffuser, lobe_names};
    #[pymodule_export]
    use crate::figures::png;
    #[pymodule_export]
    use crate::films::{film, film_grid, material_index, material_names};
    #[pymodule_export]
    use crate::plot::{curves, map};
    #[pymodule_export]
    use crate::production::Production;
    #[pymodule_export]
    use crate::result::RunResult;
    #[pymodule_export]
    use crate::run::Prepared;
    #[pymodule_export]
    use crate::scenario::{
        Described, Resolved, edit, migrate, new_scenario, present_path, preset_names, schema,
    };
    #[pymodule_export]
    use crate::search::{Search, moved_text};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
