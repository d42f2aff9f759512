//! Extension module of the Python package `papilio`: a thin layer over `scenario`, `display`, `formats`,
//! `figures`, `colour` and `optics`.
//!
//! The Python modules of the package (`papilio/*.py`) handle arguments, tables and notebooks. This module computes, and releases
//! the interpreter meanwhile. It raises the exceptions of `papilio/errors.py`, and checks all arguments again, so that no
//! script can crash the interpreter.

mod absorption;
mod batch;
mod brdf;
mod colour;
mod columns;
mod cone;
mod diffuser;
mod errors;
mod figures;
mod films;
mod image;
mod palette;
mod plot;
mod pool;
mod production;
mod program;
mod result;
mod run;
mod scenario;
mod search;
mod spatial;
mod surface;
mod watch;
mod waves;

use pyo3::prelude::*;

/// Every evaluation of a prepared display allocates many small vectors.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// Implementation of the package `papilio`; not for direct use.
#[pymodule]
mod _papilio {
    #[pymodule_export]
    use crate::absorption::Absorption;
    #[pymodule_export]
    use crate::batch::{Batch, metric_names};
    #[pymodule_export]
    use crate::brdf::{beams, bsdf};
    #[pymodule_export]
    use crate::colour::{
        delta_e_2000, gamut, illuminant_names, illuminant_sheet, illuminant_spectrum, lab, uv_prime, xyz,
    };
    #[pymodule_export]
    use crate::cone::Cone;
    #[pymodule_export]
    use crate::diffuser::{Diffuser, lobe_names};
    #[pymodule_export]
    use crate::figures::png;
    #[pymodule_export]
    use crate::films::{film, film_grid, material_index, material_names, material_sheet};
    #[pymodule_export]
    use crate::image::Image;
    #[pymodule_export]
    use crate::palette::Palette;
    #[pymodule_export]
    use crate::plot::{curves, map};
    #[pymodule_export]
    use crate::production::Production;
    #[pymodule_export]
    use crate::program::program;
    #[pymodule_export]
    use crate::result::RunResult;
    #[pymodule_export]
    use crate::run::Prepared;
    #[pymodule_export]
    use crate::scenario::{
        Described, Resolved, edit, label, migrate, new_scenario, present_path, preset_names, schema,
    };
    #[pymodule_export]
    use crate::search::{Search, moved_text};
    #[pymodule_export]
    use crate::spatial::{Crosstalk, Mtf, Sparkle};
    #[pymodule_export]
    use crate::surface::Surface;
    #[pymodule_export]
    use crate::waves::{film_absorptance, film_amplitudes, film_derivatives};

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
