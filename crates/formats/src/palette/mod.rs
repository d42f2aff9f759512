//! Palettes: measured colours of the states of a panel ([`read_palette`]), and colours for other programs
//! ([`palette_files`]).

mod read;
mod swatches;

pub use papilio_display::palette::device_colour;
pub use read::{PaletteTable, read_palette};
pub use swatches::palette_files;
