//! Readers and writers: spectra, n-k tables, pixel tables, results.
mod error;
mod file;
mod index;
mod json;
mod pixel_table;
mod place;
mod refractiveindex;
mod result;
mod rows;
mod spectrum;

pub use error::{FormatError, Problem};
pub use file::{DataFile, LARGEST_FILE, write_file};
pub use index::read_index;
pub use json::write_json;
pub use pixel_table::{PIXEL_COLUMNS, PixelTable, read_pixel_table};
pub use place::{Place, Remark, Spot};
pub use result::{ResultFile, write_spectra, write_states};
pub use spectrum::read_spectrum;
