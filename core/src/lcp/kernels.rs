//! Inner loops of the LCP solvers, compiled for the widest vector registers of the machine at run time.
use pulp::{Arch, Simd, WithSimd};

/// Vectors are padded with zeros to a length that is a multiple of this number.
pub(super) const LANES: usize = 8;

/// The largest absolute value in a padded vector. Each SIMD lane has its own maximum, so that comparisons do not wait
/// for each other.
#[inline(always)]
pub(super) fn largest_size(vector: &[f64]) -> f64 {
    let mut lanes = [0.0_f64; LANES];
    for chunk in vector.chunks_exact(LANES) {
        for (lane, a) in lanes.iter_mut().zip(chunk) {
            *lane = if a.abs() > *lane { a.abs() } else { *lane };
        }
    }
    lanes.into_iter().fold(0.0, f64::max)
}

/// target ← target − Σ_k factors_k · source_k. `sources` has the vectors source_k one after the other. Each has the
/// length of `target`, a multiple of [`LANES`].
pub(super) fn subtract_multiples(target: &mut [f64], factors: &[f64], sources: &[f64]) {
    Arch::new().dispatch(SubtractMultiples { target, factors, sources });
}

struct SubtractMultiples<'a> {
    target: &'a mut [f64],
    factors: &'a [f64],
    sources: &'a [f64],
}

impl WithSimd for SubtractMultiples<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let target = S::as_mut_simd_f64s(self.target).0;
        let sources = S::as_simd_f64s(self.sources).0;
        let mut from = 0;
        while from + 4 <= target.len() {
            subtract_in_strip::<S, 4>(simd, from, target, self.factors, sources);
            from += 4;
        }
        while from < target.len() {
            subtract_in_strip::<S, 1>(simd, from, target, self.factors, sources);
            from += 1;
        }
    }
}

/// Updates N SIMD registers of `target`, from register `from` on. The sums over all sources stay in registers.
#[inline(always)]
fn subtract_in_strip<S: Simd, const N: usize>(
    simd: S,
    from: usize,
    target: &mut [S::f64s],
    factors: &[f64],
    sources: &[S::f64s],
) {
    let mut sums = [simd.splat_f64s(0.0); N];
    for (factor, source) in factors.iter().zip(sources.chunks_exact(target.len())) {
        let factor = simd.splat_f64s(*factor);
        for (sum, s) in sums.iter_mut().zip(&source[from..from + N]) {
            *sum = simd.mul_add_e_f64s(factor, *s, *sum);
        }
    }
    for (t, sum) in target[from..from + N].iter_mut().zip(sums) {
        *t = simd.sub_f64s(*t, sum);
    }
}
