//! Output of searches, fits, tolerance analyses and BSDF tables as text: tables, figures, scenarios and warnings.
//!
//! | from | output |
//! |---|---|
//! | a search | [`search_table`] (`optimize.csv`), [`search_figures`], [`SearchReport`], [`design_texts`] (`best.toml` or the front) |
//! | a fit | [`fit_table`] (`fit.csv`), [`fit_figures`], [`fitted_text`] (`fitted.toml`), [`fitted_edits`] |
//! | a tolerance analysis | [`tolerance_tables`], [`tolerance_figures`] |
//! | the BSDF table of a display | [`brdf_warnings`], [`between_warning`], and the sufficient [`finer_step`] |
//!
//! The program writes these texts into a folder; the Python package shows them and writes the same bytes.
//!
//! **Out of scope.** Writing files and printing, which the caller does. Nothing is computed here.
//!
//! ```
//! use papilio_design::output::moved;
//! use std::path::Path;
//!
//! // There is no such file next to the scenario, so the text does not change.
//! let text = "material = \"SiO2\"\n";
//! assert_eq!(moved(text, Path::new("scenarios"), Path::new("out/best")), text);
//! ```

mod brdf;
mod designs;
mod fit;
mod search_figures;
mod search_report;
mod search_table;
mod tolerance;

pub use brdf::{
    MOST_MISSED, Refinable, between_warning, brdf_warnings, finer_step, smallest_step, table_numbers,
};
pub use designs::{design_texts, moved};
pub use fit::{fit_figures, fit_table, fitted_edits, fitted_text};
pub use search_figures::search_figures;
pub use search_report::{DesignReport, OwnDesign, SearchReport, is_at_end, quantities};
pub use search_table::search_table;
pub use tolerance::{tolerance_axis, tolerance_figures, tolerance_tables};
