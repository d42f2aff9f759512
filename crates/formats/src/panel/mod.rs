//! What the controller of a panel takes: codes of states, packed into bytes, for a panel that may be mounted
//! turned.
//!
//! | | |
//! |---|---|
//! | [`CONTROLLERS`] | the codes and the packing of the usual controllers, with their published sources |
//! | [`PanelFrame`] | the codes of a picture, turned as the panel is mounted; [`packed`](PanelFrame::packed) into bytes |
//! | [`write_indexed_bmp`], [`write_frame_header`], [`write_mask_png`] | the frame as BMP and as C header, and a mask of what changed |
//! | [`read_shown_states`] | `states.png` of the frame that the panel shows |
//! | [`FrameNumbers`] | what a reader of the frame needs to know, in `image.json` |
//!
//! **Out of scope**: the commands of controllers, their waveforms and their connection.

mod controller;
mod numbers;
mod packing;
mod shown;
mod write;

pub use controller::{CONTROLLERS, Controller};
pub use numbers::{ChangedPixels, FrameNumbers, changed_rectangle};
pub use packing::{Mounting, Packing, PanelFrame, RequestedPacking, TooFewBits, bits_of, row_bytes};
pub use shown::{ShownStates, read_shown_states, write_states_png};
pub use write::{HeaderHead, write_frame_header, write_indexed_bmp, write_mask_png};
