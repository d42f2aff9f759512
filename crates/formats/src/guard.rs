//! Panics in libraries that decode files become errors of these files.

use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread decodes a file: its panics are reported as errors, and not printed.
    static DECODES: Cell<bool> = const { Cell::new(false) };
}

/// Calls a decoder. A panic in it is returned as a message.
pub(crate) fn decoded<T>(decode: impl FnOnce() -> T) -> Result<T, String> {
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
    decoded.map_err(|_| "its contents contradict each other (the decoder failed)".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn panic_of_a_decoder_is_a_message() {
        let empty: Vec<u8> = Vec::new();
        assert!(decoded(|| empty[std::hint::black_box(3)]).unwrap_err().contains("decoder"));
        assert_eq!(decoded(|| 7), Ok(7));
    }
}
