//! Plain loops in the widest registers that there are.

use pulp::{Arch, Simd, WithSimd};

/// Does a piece of work, compiled for each instruction set and done in the best that this machine has.
/// So is all that is part of the closure: mark both it and what it calls `inline(always)`.
#[inline(always)]
pub fn wide<R>(work: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Work(work))
}

struct Work<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Work<F> {
    type Output = R;

    // Called by reference: by value there would be a function of its own between.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
