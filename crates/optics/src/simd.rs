//! Plain loops compiled for the widest SIMD registers available.

use pulp::{Arch, Simd, WithSimd};

/// Runs a closure that is compiled for each instruction set, in the best version for this machine.
/// Everything inlined into the closure is compiled with it: mark both it and the functions that it calls
/// `inline(always)`.
#[inline(always)]
pub fn with_widest_simd<R>(work: impl FnMut() -> R) -> R {
    let result = Arch::new().dispatch(Work(work));
    clear_wide_registers();
    result
}

/// Clears the upper halves of the vector registers. Call it after code of other crates that uses wide ones in
/// hand-written assembly (matrix products, masked stores), for which the compiler does not do it.
///
/// While any upper half is in use, x86 processors of some makers execute ordinary floating-point code, which
/// has to preserve it, up to thirty times slower.
#[inline(always)]
pub fn clear_wide_registers() {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        simd.avx._mm256_zeroupper();
    }
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
