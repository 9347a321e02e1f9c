//! Loops compiled for the widest vector registers of the machine at run time.

use pulp::{Arch, Simd, WithSimd};

/// Runs a closure marked `#[inline(always)]`, vectorized for this machine.
///
/// It is called as `FnMut`. As `FnOnce`, a closure that captures by reference would be called through a shim, which is
/// not inlined and not vectorized; a fused multiply-add would then be a function call.
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
