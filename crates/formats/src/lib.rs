//! Readers of input files and writers of output files.
//!
//! | reader | input |
//! |---|---|
//! | [`read_spectrum`] | a wavelength and a value: tables, and files of instruments (CGATS, CxF, IES TM-27, Argyll, ASD, Ocean Optics, Sekonic) |
//! | [`read_fractions`], [`read_light`] | the same, with values from 0 to 1, or of a light source |
//! | [`read_profile`] | two columns: angle in degrees, relative radiance |
//! | [`read_light_map`] | Radiance pictures and OpenEXR maps of the whole sphere (detected from the content) |
//! | [`read_luminaire`] | luminaires, IES LM-63 (types A, B and C) and EULUMDAT |
//! | [`read_index`] | a table of n and k or of a permittivity, or a refractiveindex.info page (detected from the content) |
//! | [`read_pixel_table`] | `pixel.csv`: state, angle, wavelength, reflectance, and perhaps azimuth |
//! | [`read_director`] | directors of a liquid crystal: depth, tilt, twist |
//! | [`read_polariser`] | both polarisations of a polariser by wavelength |
//! | [`read_windows`] | rectangles of sub-pixels: name, x0, y0, x1, y1 |
//! | [`read_measured_panel`] | spectra or X, Y, Z of the states of a panel |
//! | [`read_measurement`] | the same, or metrics by name |
//! | [`read_result`] | `result.json` |
//! | [`read_picture`] | PNG, JPEG and SVG pictures as linear X, Y, Z (detected from the content) |
//! | [`read_heights`] | maps of heights in several formats (detected from the content) |
//! | [`read_density`] | tables of frequency and power spectral density of heights |
//! | [`read_mesh`] | meshes of triangles: OBJ, and STL in text or binary (detected from the content) |
//! | [`read_bsdf`] | measured scattering in several formats (detected from the content) |
//!
//! | writer | output |
//! |---|---|
//! | [`ResultFile`] with [`write_json`] | `result.json`; its schema: [`result_schema`] |
//! | [`write_states`], [`write_spectra`], [`write_reflection`] | `states.csv`, `spectra.csv`, `reflection.csv` |
//! | [`report::RunReport`] | `report.html` |
//! | [`PixelTable::write`] | `pixel.csv` |
//! | [`write_absorption`], [`write_sub_pixels`] | `absorption.csv`, `sub-pixels.csv` |
//! | [`write_cone_csv`], [`write_cone_npy`] | `cone.csv`, `cone.npy`; their description: [`ConeFile`] with [`write_json`] |
//! | [`CrosstalkFile`] with [`write_json`], [`write_crosstalk_csv`], [`write_patterns_csv`] | `crosstalk.json`, `crosstalk.csv`, `patterns.csv`; schema: [`crosstalk_schema`] |
//! | [`MtfFile`] with [`write_json`], [`write_mtf_csv`], [`write_spread_csv`], [`write_kernel_npy`] | `mtf.json`, `mtf.csv`, `spread.csv`, `kernel-STATE.npy`; schema: [`mtf_schema`] |
//! | [`write_comparison`], [`write_compared_spectra`], [`write_compared_metrics`] | a comparison with a measured panel |
//! | [`AuditFile`], [`FitFile`] with [`write_json`] | audit of a measurement, fitted lobes |
//! | [`StepsFile`] with [`write_json`], [`write_steps`] | a display without each step of its measured diffuser; `steps.csv` |
//! | [`write_rgb_png`], [`write_indexed_png`], [`write_scene_exr`] | pictures: encoded colours, numbers of states, linear light |
//! | [`png()`] | PNG images of figures |
//! | [`panel`] | frames for the controllers of panels |
//! | [`SurfaceAuditFile`] with [`write_json`], [`write_totals`], [`write_face`] | `audit.json`, `totals.csv`, `totals_by_azimuth.csv`, `face.npz` of a surface |
//! | [`write_bsdf`] | `display-bsdf.npz` |
//! | [`write_bsdf_klems`] | `display-STATE.xml` |
//! | [`write_bsdf_radiant`] | `display-STATE.bsdf` |
//! | [`write_bsdf_csv`], [`write_mirror_csv`] | `display-STATE.csv`, `display-mirror.csv` |
//! | [`write_rgl`], [`MirrorFile`] with [`write_json`] | `display-STATE.bsdf`, `display-mirror.json` |
//! | [`scene_script`] | `scene.py` |
//! | [`write_measurement`] | measured scattering in a [`BsdfFormat`] |
//!
//! A [`DataFile`] is an input file in memory, of at most [`LARGEST_FILE`] bytes. A
//! [`FormatError`] has the file, line and column, and prints as a compiler's message.
//! [`write_file`] writes a file completely or not at all. Numbers are written such
//! that reading them returns the same bits.
//!
//! **Out of scope**: the purpose of a file. Readers check its content; the caller checks, for example,
//! whether a spectrum covers a grid.
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

mod absorption;
mod audit;
mod audit_text;
mod bsdf;
mod comparison;
mod cone;
mod crosstalk;
mod decoders;
mod director;
mod error;
mod face_read;
mod file;
mod gloss;
mod gonio;
mod guard;
mod index;
mod inputs;
mod instrument;
mod journal;
mod json;
mod light;
mod measured;
mod measured_panel;
mod mtf;
mod npy;
mod npz;
mod palette;
pub mod panel;
mod picture;
mod pixel_table;
mod polariser;
mod refractiveindex;
pub mod report;
mod result;
mod result_read;
mod sparkle;
mod spatial;
mod spectrum;
mod states;
mod steps;
mod study;
mod surface;
mod svg;
mod sweep;
mod sweep_columns;
mod sweep_json;
mod sweep_light;
#[cfg(feature = "parquet")]
mod sweep_parquet;
#[cfg(not(feature = "parquet"))]
#[path = "no_parquet.rs"]
mod sweep_parquet;
mod table;
mod temporary;
mod tolerance;
mod windows;
mod woollam;
pub mod words;

pub use absorption::{write_absorption, write_sub_pixels};
pub use audit::{AuditFile, FitFile};
pub use audit_text::audit_text;
pub use bsdf::{
    BetweenError, BsdfFile, BsdfFormat, BsdfProblem, BsdfSource, Exported, FAINT, LARGEST_BSDF_FILE,
    MOST_CELLS, MirrorFile, WriteError, between_error, bsdf_format_table, bsdf_formats, klems_numbers,
    klems_rings, read_bsdf, read_bsdf_file, scene_script, write_bsdf, write_bsdf_csv, write_bsdf_klems,
    write_bsdf_radiant, write_measurement, write_mirror_csv, write_rgl,
};
pub use comparison::{write_compared_metrics, write_compared_spectra, write_comparison};
pub use cone::{CONE_QUANTITIES, ConeFile, cone_quantities, write_cone_csv, write_cone_npy};
pub use crosstalk::{CrosstalkFile, crosstalk_schema, write_crosstalk_csv, write_patterns_csv};
pub use director::{DirectorRow, read_director};
pub use error::{FormatError, Problem};
pub use face_read::read_face;
pub use file::{DataFile, LARGEST_FILE, is_of_place, unwritable, write_file};
pub use gloss::{GlossFile, gloss_schema, write_gloss};
pub use gonio::{
    AzimuthAudit, GonioHead, Holds, SurfaceAuditFile, WaveRow, WaveSide, roads_that_hold,
    surface_audit_schema, write_cutoffs, write_face, write_psd, write_totals, write_waves,
};
pub use index::{read_index, read_index_within};
pub use inputs::{is_input, open_input, protect_inputs};
pub use journal::{
    Journal, JournalNumber, JournalRow, JournalRows, Journals, LARGEST_JOURNAL, LockedJournal, RowsHead,
    TableHead, foreign_journal_error, journal_name, journal_paths, open_journal, read_journal, read_journals,
    read_verified_lines, write_journal_line,
};
pub use json::write_json;
pub use light::{
    IntensityEdge, LightMap, Luminaire, MapChannel, MapColour, Opening, OpeningShape, is_luminaire,
    read_light_map, read_luminaire, read_profile,
};
pub use measured::read_measurement;
pub use measured_panel::read_measured_panel;
pub use mtf::{MtfFile, mtf_schema, write_kernel_npy, write_mtf_csv, write_spread_csv};
pub use palette::{
    PaletteTable, device_colour, files_of_palette, light_and_view, palette_files, read_palette,
};
pub use papilio_diagnostics::{Diagnostic, Place, Spot, Warned};
pub use picture::{
    LARGEST_PICTURE_FILE, MOST_PICTURE_PIXELS, RgbSpace, SourcePicture, Transfer, picture_format,
    read_picture, write_indexed_png, write_rgb_png, write_scene_exr,
};
pub use pixel_table::{PIXEL_COLUMNS, PixelTable, is_name, read_pixel_over_half_turn, read_pixel_table};
pub use polariser::{PolariserTable, read_polariser};
pub use result::{ResultFile, result_schema, write_reflection, write_spectra, write_states};
pub use result_read::{ReadResult, read_result, read_result_with};
pub use sparkle::{SparkleFile, sparkle_schema, write_sparkle};
pub use spatial::{ImageFile, SpatialFile, TitledFile, image_schema, palette_schema};
pub use spectrum::{
    read_fractions, read_fractions_with_notes, read_light, read_light_with_notes, read_spectrum,
};
pub use steps::{StepRow, StepsFile, write_steps};
pub use study::write_study;
pub use surface::{HeightFile, MeshFile, is_height_file, read_density, read_heights, read_mesh};
pub use svg::{HAS_PNG, PNG_SCALE, PngError, png};
pub use sweep::{
    LightHead, SweepHead, SweepHeadAxis, SweepJournal, SweepPoint, sweep_place, sweep_value, write_sweep_csv,
};
pub use sweep_columns::{light_columns, sweep_columns};
pub use sweep_json::write_sweep_json;
pub use sweep_light::{light_points, write_light_csv, write_light_json};
pub use sweep_parquet::{light_parquet, sweep_parquet};
pub use temporary::remove_abandoned;
pub use tolerance::{SearchHead, ToleranceHead, write_table};
pub use windows::{NamedRectangle, read_windows};

/// Whether this build can write tables as Parquet: the feature `parquet`, which released programs have.
pub const HAS_PARQUET: bool = cfg!(feature = "parquet");

/// Message of a build without Parquet.
pub const NO_PARQUET: &str = "this papilio was built without Parquet; \
    build it with the feature `parquet`: `cargo build --release --package papilio --features parquet`";
