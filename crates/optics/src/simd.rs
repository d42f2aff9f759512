//! Plain loops compiled for the widest SIMD registers available.

use pulp::{Arch, Simd, WithSimd};

/// Runs a closure that is compiled for each instruction set, in the best version for this machine.
/// Everything inlined into the closure is compiled with it: mark both it and the functions that it calls
/// `inline(always)`.
#[inline(always)]
pub fn with_widest_simd<R>(work: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Work(work))
}

struct Work<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Work<F> {
    type Output = R;

    // Called by reference: by value, a separate function would be generated in between.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
