//! Extension module of the Python package `papilio`: a thin layer over `scenario`, `display`, `formats`,
//! `figures`, `colour` and `optics`.
//!
//! The Python modules of the package (`papilio/*.py`) handle arguments, tables and notebooks. This module computes, and releases
//! the interpreter meanwhile. It raises the exceptions of `papilio/errors.py`, and checks all arguments again, so that no
//! script can crash the interpreter.

/// What a file exports to the extension module: its classes, then its functions.
macro_rules! exports {
    ($(classes $($class:ident),+;)? $(functions $($function:ident),+;)?) => {
        /// Adds the classes and functions of this file to the extension module.
        pub(crate) fn add_to(module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
            use pyo3::types::PyModuleMethods;
            $($(module.add_class::<$class>()?;)+)?
            $($(module.add_function(pyo3::wrap_pyfunction!($function, module)?)?;)+)?
            Ok(())
        }
    };
}

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
mod fit;
mod frame;
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
    use pyo3::prelude::*;

    /// Adds what each file exports.
    #[pymodule_init]
    fn add_exports(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let files = [
            crate::absorption::add_to,
            crate::batch::add_to,
            crate::brdf::add_to,
            crate::colour::add_to,
            crate::cone::add_to,
            crate::diffuser::add_to,
            crate::figures::add_to,
            crate::films::add_to,
            crate::fit::add_to,
            crate::frame::add_to,
            crate::image::add_to,
            crate::palette::add_to,
            crate::plot::add_to,
            crate::production::add_to,
            crate::program::add_to,
            crate::result::add_to,
            crate::run::add_to,
            crate::scenario::add_to,
            crate::search::add_to,
            crate::spatial::add_to,
            crate::surface::add_to,
            crate::waves::add_to,
        ];
        files.iter().try_for_each(|add_to| add_to(module))
    }

    #[pymodule_export]
    #[allow(non_upper_case_globals, reason = "Python's name")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
