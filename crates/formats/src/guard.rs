//! Panics in libraries that decode files become errors of these files. All readers of formats of others pass
//! through [`read`].

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

use papilio_diagnostics::Diagnostic;

use crate::error::FormatError;
use crate::file::DataFile;
use crate::picture_format;

thread_local! {
    /// Whether this thread decodes a file: its panics are reported as errors, and not printed.
    static DECODES: Cell<bool> = const { Cell::new(false) };
}

/// Calls the reader of a file. A panic in it is an error of the file.
///
/// # Errors
/// Those of the reader, and that its decoder has failed.
pub(crate) fn read<T>(
    file: &DataFile,
    reader: impl FnOnce(&DataFile) -> Result<T, FormatError>,
) -> Result<T, FormatError> {
    decoded(|| reader(file)).unwrap_or_else(|DecoderPanic| {
        let named = picture_format(&file.bytes).map_or("file".to_owned(), |format| format!("{format} file"));
        let wrong = Diagnostic::new(format!(
            "this {named} cannot be read: its contents contradict each other, so that the decoder failed"
        ));
        let hint = "is it damaged or cut off? Save it again, if possible in another format";
        Err(FormatError::whole(&file.name, wrong.hint(hint)))
    })
}

/// A decoder has panicked.
#[derive(Debug, PartialEq, Eq)]
struct DecoderPanic;

/// Calls a decoder, and does not print its panic.
fn decoded<T>(decode: impl FnOnce() -> T) -> Result<T, DecoderPanic> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let before = take_hook();
        set_hook(Box::new(move |panic| {
            if !DECODES.get() {
                before(panic);
            }
        }));
    });
    let outer = DECODES.replace(true);
    // The decoder's state is dropped with the panic; nothing of it is used afterwards.
    let decoded = catch_unwind(AssertUnwindSafe(decode));
    DECODES.set(outer);
    decoded.map_err(|_| DecoderPanic)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_of_a_decoder_is_an_error_of_the_file() {
        let file = DataFile { name: "a.bin".to_owned(), bytes: vec![1, 2] };
        let read_at = |at: usize| read(&file, |file| Ok(file.bytes[std::hint::black_box(at)]));
        let error = read_at(3).unwrap_err();
        assert_eq!(error.place.name, "a.bin");
        assert!(error.to_string().contains("contradict each other"), "{error}");
        assert_eq!(read_at(1), Ok(2));
    }
}
