//! Bytes of a response with a head in JSON and 16-bit floating point numbers, which a browser gives to its
//! graphics processor as they are.

use papilio_imaging::push_halves;
use serde::Serialize;

use crate::fault::Fault;

/// The length of the head and of each block is a multiple of this.
const BLOCK: usize = 4;

/// Begins a response: the length of the head, and the head, filled up with spaces.
pub(super) fn with_head(head: &impl Serialize) -> Result<Vec<u8>, Fault> {
    let mut json =
        serde_json::to_vec(head).map_err(|_| Fault::internal("the response cannot be serialised"))?;
    json.resize(json.len().next_multiple_of(BLOCK), b' ');
    let length = u32::try_from(json.len()).map_err(|_| Fault::internal("the response is too long"))?;
    Ok([length.to_le_bytes().as_slice(), &json].concat())
}

/// Appends bytes, filled up with zeros.
pub(super) fn push_bytes(out: &mut Vec<u8>, bytes: &[u8]) {
    out.extend_from_slice(bytes);
    out.resize(out.len().next_multiple_of(BLOCK), 0);
}

/// Appends the X, Y, Z of each pixel, filled up with zeros.
pub(super) fn push_pixels(out: &mut Vec<u8>, pixels: &[[f32; 3]]) {
    push_halves(out, pixels.as_flattened());
    out.resize(out.len().next_multiple_of(BLOCK), 0);
}
