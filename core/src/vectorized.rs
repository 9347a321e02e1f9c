//! Loops compiled for the widest vector registers of the machine at run time.

use pulp::{Arch, Simd, WithSimd};

/// Runs a closure marked `#[inline(always)]`, vectorized for this machine.
///
/// It is called as `FnMut`: as `FnOnce`, a closure that captures by reference is called through a shim that is not
/// inlined and not vectorized; a fused multiply-add is then a function call.
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
