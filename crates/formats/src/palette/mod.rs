//! Palettes: measured colours of the states of a panel ([`read_palette`]), and colours for other programs
//! ([`files_of_palette`]).

mod read;
mod swatches;

pub use papilio_display::palette::device_colour;
pub use read::{PaletteTable, read_palette};
pub use swatches::{files_of_palette, light_and_view, palette_files};
