//! The reader of tables in text.
//!
//! **What.** Every table with columns is read here: spectra, n and k, palettes, measured panels, pixel
//! tables, profiles of light, rectangles, densities; and the headers of measured scattering. A column is
//! found by its name, in any order, and its unit is that of the name: `wavelength_nm`, `Wavelength (um)`,
//! `E [eV]`, `theta / rad`, `%R`. A name or a unit that is not understood is refused with its place; remarks
//! and uncertainties are passed over with a note. A table without a header is read by position where its
//! reader says so. **Text.** [`decode`](encoding::decode): UTF-8, UTF-16, Windows-1252, with or without a
//! byte order mark, lines that end in any way.
//! [`Dialect`]: commas, semicolons, tabs or blanks between the cells, decimal points or commas, one of each for the whole file.
//! **Missing values** (an empty cell, `NA`, `-`, `nan`) are refused with their place.

mod dialect;
mod encoding;
mod header;
mod names;
pub(crate) mod quantities;
pub(crate) mod rounding;
pub(crate) mod rows;
mod units;

pub(crate) use dialect::{Dialect, number};
pub(crate) use encoding::{decode, is_utf_16};
pub(crate) use header::{Column, Header, body, unknown};
pub(crate) use names::ColumnName;
pub(crate) use quantities::Quantity;
pub(crate) use rows::{Row, Table, TableText, clip, is_missing};
pub(crate) use units::{Dimension, HALF_TURN, QUARTER_TURN, TURN, Unit, may_be_radians, unit};
