//! Loops compiled for the widest vector registers of the machine at run time.

use pulp::{Arch, Simd, WithSimd};

/// Runs a closure that is marked `#[inline(always)]`, compiled for the widest vector registers of the machine.
///
/// The closure is called as `FnMut`. If it were called as `FnOnce` and captured by reference, the call would go through
/// a shim that is neither inlined nor vectorized; a fused multiply-add would then be a function call.
#[inline(always)]
pub fn vectorized<R>(work: impl FnMut() -> R) -> R {
    Arch::new().dispatch(Work(work))
}

struct Work<F>(F);

impl<R, F: FnMut() -> R> WithSimd for Work<F> {
    type Output = R;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> R {
        (self.0)()
    }
}
