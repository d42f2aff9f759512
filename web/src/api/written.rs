//! Files that are written to memory, for responses.

use std::io::Result as IoResult;

use crate::fault::Fault;

/// Returns the bytes of a file.
pub(super) fn bytes(write: impl FnOnce(&mut Vec<u8>) -> IoResult<()>) -> Result<Vec<u8>, Fault> {
    let mut bytes = Vec::new();
    write(&mut bytes).map_err(|_| Fault::internal("a table cannot be written"))?;
    Ok(bytes)
}

/// Returns the text of a file.
pub(super) fn text(write: impl FnOnce(&mut Vec<u8>) -> IoResult<()>) -> Result<String, Fault> {
    Ok(String::from_utf8_lossy(&bytes(write)?).into_owned())
}
