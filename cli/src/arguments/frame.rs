//! What `papilio image` writes for the controller of a panel.

use std::path::PathBuf;

use clap::Args;

use super::one_of;

/// The frame for the controller of a panel.
#[derive(Debug, Args)]
pub(crate) struct FrameArguments {
    /// Write frame.bin: the codes of the states (display.pixel.codes, or their numbers) with this number of
    /// bits for each pixel, the first pixel in the highest bits, rows in whole bytes
    #[arg(long, value_parser = one_of(PACKED), value_name = "BITS")]
    pub(crate) packed: Option<Packed>,
    /// Write the frame in these forms; bits are those of --packed, of the controller, or the fewest
    #[arg(long, value_parser = one_of(FORMS), value_name = "FORM,...", value_delimiter = ',')]
    pub(crate) frame: Vec<FrameForm>,
    /// Rotate the frame clockwise, for a panel that is mounted turned
    #[arg(long, value_parser = one_of(TURNS), value_name = "DEGREES")]
    pub(crate) rotate: Option<u8>,
    /// Mirror the frame left to right, after the rotation
    #[arg(long)]
    pub(crate) mirror: bool,
    /// states.png of the frame that the panel shows now: write changed.png, the pixels that differ
    #[arg(long, value_name = "STATES")]
    pub(crate) since: Option<PathBuf>,
}

/// How codes become bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Packed {
    /// This number of bits for each pixel.
    Bits(u8),
    /// A plane for each bit.
    Planes,
}

const PACKED: [(&str, &str, Packed); 5] = [
    ("1", "", Packed::Bits(1)),
    ("2", "", Packed::Bits(2)),
    ("4", "", Packed::Bits(4)),
    ("8", "", Packed::Bits(8)),
    ("planes", "A plane of 1 bit for each pixel for each bit of the codes, bit 0 first", Packed::Planes),
];

/// A form of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum FrameForm {
    /// The bytes.
    Bytes,
    /// An indexed BMP.
    Bmp,
    /// A C header.
    Header,
}

const FORMS: [(&str, &str, FrameForm); 3] = [
    ("bin", "frame.bin: the bytes", FrameForm::Bytes),
    ("bmp", "frame.bmp: an indexed BMP, whose numbers are the codes", FrameForm::Bmp),
    ("h", "frame.h: the bytes as a C header", FrameForm::Header),
];

/// Quarter turns.
const TURNS: [(&str, &str, u8); 4] = [("0", "", 0), ("90", "", 1), ("180", "", 2), ("270", "", 3)];
