//! What searches, tolerances and BSDFs hand on: tables, figures, scenarios and warnings, as texts.
//!
//! | of | gives |
//! |---|---|
//! | a search | [`search_table`] (`optimize.csv`), [`search_figures`], [`design_texts`] (`best.toml`, or those of a front) |
//! | a tolerance analysis | [`tolerance_tables`], [`tolerance_figures`] |
//! | a table of a display's BSDF | [`brdf_warnings`], and the [`finer_step`] that would do |
//!
//! The program writes them into a folder; the Python package shows them, and writes the same bytes.
//!
//! **Out of scope.** Writing, printing: whoever asks does that. Nothing is computed here.
//!
//! ```
//! use papilio_findings::moved;
//! use std::path::Path;
//!
//! // No such file is beside the scenario: the text stays as it is.
//! let text = "material = \"SiO2\"\n";
//! assert_eq!(moved(text, Path::new("scenarios"), Path::new("out/best")), text);
//! ```

mod brdf;
mod designs;
mod search_figures;
mod search_table;
mod tolerance;

pub use brdf::{MOST_MISSED, brdf_warnings, finer_step};
pub use designs::{design_texts, moved};
pub use search_figures::search_figures;
pub use search_table::search_table;
pub use tolerance::{tolerance_figures, tolerance_tables};
