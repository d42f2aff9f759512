//! What a reader of a frame needs to know.

use papilio_display::result::Named;
use schemars::JsonSchema;
use serde::Serialize;

use super::{Controller, Mounting, Packing, PanelFrame, row_bytes};

/// Layout and codes of a frame for the controller of a panel.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub struct FrameNumbers {
    /// Number of columns and rows of the panel, after the rotation.
    pub size: [usize; 2],
    /// Bits of the code of a pixel.
    pub bits: u8,
    /// Whether frame.bin and frame.h consist of as many planes as a code has bits, the lowest bit first, with 1
    /// bit for each pixel. Otherwise the bits of a pixel are next to each other.
    pub planes: bool,
    /// Bytes of a row (of each plane): rows are padded to whole bytes.
    pub bytes_per_row: usize,
    /// The controller of `display.pixel.codes`; null for other codes.
    pub controller: Option<&'static str>,
    /// Code of each state.
    pub codes: Named<u8>,
    /// Clockwise rotation of the picture into the rows and columns of the panel, degrees.
    pub rotation_deg: u16,
    /// Whether the rotated frame is mirrored left to right.
    pub mirrored: bool,
    /// What differs from the frame that the panel shows; null without `--since`.
    pub changed: Option<ChangedPixels>,
}

impl FrameNumbers {
    /// The numbers of a frame with the codes of its states, without a frame before it.
    pub fn new(
        frame: &PanelFrame,
        (packing, mounting): (Packing, Mounting),
        controller: Option<&'static Controller>,
        codes: &[(String, u8)],
    ) -> Self {
        Self {
            size: frame.size,
            bits: packing.bits(),
            planes: matches!(packing, Packing::Planes(_)),
            bytes_per_row: row_bytes(frame.size[0], packing.bits_in_row()),
            controller: controller.map(|controller| controller.name),
            codes: Named(codes.to_vec()),
            rotation_deg: 90 * u16::from(mounting.quarter_turns),
            mirrored: mounting.is_mirrored,
            changed: None,
        }
    }
}

/// The pixels that differ from another frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ChangedPixels {
    /// Their number.
    pub pixels: usize,
    /// The rectangle that contains them: column and row of its upper left pixel, its number of columns and rows.
    /// Columns are extended to multiples of 8, as far as the bytes of a row reach: with 1 bit for each pixel and in planes, also beyond the last
    /// column of the frame, into the bits of its last byte that remain. Null if no pixel changed.
    pub rectangle: Option<[usize; 4]>,
}

/// Columns of a rectangle are multiples of this: controllers take whole bytes of 8 pixels.
const ALIGNED: usize = 8;

/// The rectangle that contains the pixels that are true, in rows of `columns`: column, row, number of columns
/// and of rows. Its columns are extended to multiples of 8, and end with the bytes of the row: it consists of whole bytes.
pub fn changed_rectangle(columns: usize, packing: Packing, changed: &[bool]) -> Option<[usize; 4]> {
    let places = || (0..changed.len()).filter(|at| changed[*at]);
    let (top, bottom) = (places().next()? / columns, places().next_back()? / columns);
    let (left, right) =
        places().fold((columns, 0), |(left, right), at| (left.min(at % columns), right.max(at % columns)));
    let left = left - left % ALIGNED;
    let bits = packing.bits_in_row();
    let in_bytes = row_bytes(columns, bits) * 8 / usize::from(bits);
    let end = (right + 1).next_multiple_of(ALIGNED).min(in_bytes);
    Some([left, top, end - left, bottom + 1 - top])
}
