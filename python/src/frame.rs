//! The frame of a picture for the controller of a panel.

use numpy::{IntoPyArray, PyArray2, PyReadonlyArray2};
use papilio_formats::panel::{
    CONTROLLERS, FrameNumbers, HeaderHead, Mounting, Packing, PanelFrame, RequestedPacking,
    write_frame_header, write_indexed_bmp,
};
use pyo3::prelude::*;

use crate::errors;
use crate::spatial::text;

exports! { functions frame; }

/// The bytes of a frame, the code of each pixel in its rows and columns, its numbers as JSON, the C header, and the BMP.
type Written<'py> = (Vec<u8>, Bound<'py, PyArray2<u8>>, String, String, Vec<u8>);

/// `codes` and `colours` are those of each state; `bits`: for each pixel, 0 for planes of 1 bit.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "the arguments of one function in Python")]
pub(crate) fn frame<'py>(
    py: Python<'py>,
    states: PyReadonlyArray2<'py, u8>,
    codes: Vec<(String, u8)>,
    colours: Vec<(u8, u8, u8)>,
    controller: Option<&str>,
    bits: Option<u8>,
    quarter_turns: u8,
    is_mirrored: bool,
    title: &str,
) -> PyResult<Written<'py>> {
    let controller = controller.and_then(|name| CONTROLLERS.iter().find(|one| one.name == name));
    let requested = match bits {
        None => None,
        Some(0) => Some(RequestedPacking::Planes),
        Some(bits @ (1 | 2 | 4 | 8)) => Some(RequestedPacking::Bits(bits)),
        Some(_) => return Err(errors::argument(py, "packed: expected 1, 2, 4, 8 or \"planes\"")),
    };
    let usual = controller.map(|controller| controller.packing);
    let packing = Packing::chosen(requested, usual, &codes).map_err(|few| {
        let ([needed, bits], largest) = (few.needed(), few.largest());
        let what = format!(
            "{} bits hold codes up to {largest}, and the code of {} is {}",
            few.bits, few.state, few.code
        );
        errors::argument(py, &format!("packed: {what}; it needs {needed} bits: packed={bits}"))
    })?;
    let states = states.as_array();
    let size = [states.dim().1, states.dim().0];
    let of_states: Vec<u8> = codes.iter().map(|(_, code)| *code).collect();
    let states: Vec<u8> = states.iter().copied().collect();
    let mounting = Mounting { quarter_turns, is_mirrored };
    let frame = PanelFrame::new(size, &states, &of_states, mounting);
    let numbers = FrameNumbers::new(&frame, (packing, mounting), controller, &codes);
    let bytes = frame.packed(packing);
    let mut header = Vec::new();
    let head =
        HeaderHead { program: concat!("papilio ", env!("CARGO_PKG_VERSION")), title, numbers: &numbers };
    write_frame_header(&mut header, head, &bytes).map_err(|error| errors::internal(&error.to_string()))?;
    let header = String::from_utf8(header).map_err(|error| errors::internal(&error.to_string()))?;
    let palette: Vec<(u8, [u8; 3])> =
        of_states.iter().copied().zip(colours.into_iter().map(<[u8; 3]>::from)).collect();
    let mut bmp = Vec::new();
    write_indexed_bmp(&mut bmp, &frame, packing.bits(), &palette)
        .map_err(|error| errors::internal(&error.to_string()))?;
    let [columns, rows] = frame.size;
    let shown = numpy::ndarray::Array2::from_shape_vec((rows, columns), frame.codes);
    let shown = shown.map_err(|error| errors::internal(&error.to_string()))?.into_pyarray(py);
    Ok((bytes, shown, text(&numbers)?, header, bmp))
}
