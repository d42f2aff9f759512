//! Readers and writers: what comes in from files, and what goes out to them.
//!
//! | in | from |
//! |---|---|
//! | [`read_spectrum`] | two columns: wavelength in nm, value |
//! | [`read_shares`], [`read_light`] | the same, with the range of shares, or of a light |
//! | [`read_profile`] | two columns: angle in degrees, relative radiance |
//! | [`read_light_map`] | Radiance pictures and OpenEXR maps of the whole sphere (told apart by content) |
//! | [`read_ies`] | luminaires, IES LM-63 type C |
//! | [`read_index`] | n-k in nm, or a refractiveindex.info page (told apart by content) |
//! | [`read_pixel_table`] | `pixel.csv`: state, angle, wavelength, reflectance |
//! | [`read_measured_panel`] | spectra or X, Y, Z of a panel's states |
//! | [`read_result`] | `result.json` |
//! | [`read_bsdf`] | measured scattering in any of many formats (told apart by content) |
//!
//! | out | to |
//! |---|---|
//! | [`ResultFile`] with [`write_json`] | `result.json`; its schema: [`result_schema`] |
//! | [`write_states`], [`write_spectra`], [`write_reflection`] | `states.csv`, `spectra.csv`, `reflection.csv` |
//! | [`PixelTable::write`] | `pixel.csv` |
//! | [`write_cone_csv`], [`write_cone_npy`] | `cone.csv`, `cone.npy`; what they are: [`ConeFile`] with [`write_json`] |
//! | [`write_comparison`], [`write_compared_spectra`] | a comparison with a measured panel |
//! | [`AuditFile`], [`FitFile`] with [`write_json`] | what was found in a measurement |
//! | [`write_bsdf`] | `display-bsdf.npz` |
//! | [`write_measurement`] | measured scattering as a [`BsdfFormat`] |
//!
//! A file is read whole, at most [`LARGEST_FILE`] bytes, as a [`DataFile`]; a
//! [`FormatError`] names the file, line and column and prints as compilers do. A
//! file is written whole or not at all by [`write_file`]. Numbers are written so
//! that they read back as they were, bit for bit.
//!
//! **Out of scope**: what a file is for. Readers check what it says: whether a spectrum covers a grid is the caller's question.
//!
//! ```
//! use papilio_formats::{DataFile, read_index};
//! let page = b"DATA:\n- type: formula 1\n  wavelength_range: 0.21 6.7\n  \
//!     coefficients: 0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161\n";
//! let silica = read_index(&DataFile { name: "SiO2.yml".into(), bytes: page.to_vec() })?;
//! // Malitson 1965: n_d = 1.458464.
//! assert!((silica.index(587.5618).unwrap().re - 1.458464).abs() < 1e-6);
//! # Ok::<(), papilio_formats::FormatError>(())
//! ```

mod audit;
mod audit_text;
mod bsdf;
mod comparison;
mod cone;
mod error;
mod file;
mod index;
mod journal;
mod json;
mod light;
mod measured_panel;
mod npy;
mod pixel_table;
mod refractiveindex;
mod result;
mod result_read;
mod rows;
mod spectrum;
mod study;
mod sweep;
mod sweep_json;
mod sweep_light;
#[cfg(feature = "parquet")]
mod sweep_parquet;
#[cfg(not(feature = "parquet"))]
#[path = "no_parquet.rs"]
mod sweep_parquet;
mod tolerance;
pub mod words;

pub use audit::{AuditFile, FitFile};
pub use audit_text::audit_text;
pub use bsdf::{
    BsdfFormat, BsdfProblem, BsdfSource, LARGEST_BSDF_FILE, MOST_CELLS, WriteError, bsdf_format_table,
    bsdf_formats, read_bsdf, write_bsdf, write_measurement,
};
pub use comparison::{write_compared_spectra, write_comparison};
pub use cone::{CONE_QUANTITIES, ConeFile, write_cone_csv, write_cone_npy};
pub use error::{FormatError, Problem};
pub use file::{DataFile, LARGEST_FILE, write_file};
pub use index::{read_index, read_index_within};
pub use journal::{
    HeldJournal, Journal, JournalNumber, JournalRow, JournalRows, Journals, LARGEST_JOURNAL, RowsHead,
    foreign, journal_name, journal_paths, open_journal, read_journal, read_journals, tidy_journals,
    trusted_lines, write_journal_line,
};
pub use json::write_json;
pub use light::{
    LightMap, Luminaire, MapChannel, MapColour, MapProblem, read_ies, read_light_map, read_profile,
};
pub use measured_panel::read_measured_panel;
pub use papilio_diagnostics::{Diagnostic, Place, Spot, Warned};
pub use pixel_table::{PIXEL_COLUMNS, PixelTable, is_name, read_pixel_table};
pub use result::{ResultFile, result_schema, write_reflection, write_spectra, write_states};
pub use result_read::{ReadResult, read_result};
pub use spectrum::{read_light, read_shares, read_spectrum};
pub use study::write_study;
pub use sweep::{
    LightHead, SweepHead, SweepHeadAxis, SweepJournal, SweepPoint, sweep_place, sweep_value, write_sweep_csv,
};
pub use sweep_json::write_sweep_json;
pub use sweep_light::{light_points, write_light_csv, write_light_json};
pub use sweep_parquet::{light_parquet, sweep_parquet};
pub use tolerance::{SearchHead, ToleranceHead, write_table};

/// Whether tables can be written as Parquet: the feature `parquet`, which builds of the program have unless it is turned off.
pub const HAS_PARQUET: bool = cfg!(feature = "parquet");

/// What to say where they cannot.
pub const NO_PARQUET: &str = "this papilio was built without Parquet; \
    `cargo build --release --package papilio` builds it with the feature `parquet` on";
