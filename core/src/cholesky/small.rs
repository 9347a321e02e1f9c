//! Dense elimination of columns that stay in the cache: vectors of rows by four columns at a time in registers, nothing packed.

use pulp::{Arch, Simd, WithSimd};

/// Most numbers of a panel that the second cache holds beside what it leaves.
const NUMBERS: usize = 1 << 14;
/// Most columns: of more, rows of the last ones would be far apart.
const COLUMNS: usize = 64;
/// Columns of a tile in registers, and vectors of its rows.
const WIDE: usize = 4;
const TALL: usize = 2;

/// Whether a panel is small enough.
pub(super) fn fits(panel: &[f64], height: usize) -> bool {
    panel.len() <= NUMBERS.min(COLUMNS * height)
}

/// As [`super::front::eliminate`].
pub(super) fn eliminate(panel: &mut [f64], height: usize) -> Result<(), usize> {
    Arch::new().dispatch(Eliminate { panel, height })
}

/// As [`super::front::leave`], of one of its tiles.
pub(super) fn leave(panel: &[f64], height: usize, from: usize, tile: &mut [f64]) {
    Arch::new().dispatch(Leave { panel, height, from, tile });
}

struct Eliminate<'a> {
    panel: &'a mut [f64],
    height: usize,
}

impl WithSimd for Eliminate<'_> {
    type Output = Result<(), usize>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Result<(), usize> {
        let Self { panel, height } = self;
        for first in (0..panel.len() / height).step_by(WIDE) {
            let (done, rest) = panel.split_at_mut(first * height);
            let end = rest.len().min(WIDE * height);
            let columns = &mut rest[..end];
            subtract_product::<S, true>(simd, done, height, first, columns, 0);
            for k in 0..columns.len() / height {
                let at = first + k;
                let (column, others) = columns[k * height..].split_at_mut(height);
                if !(column[at] > 0.0) {
                    return Err(at);
                }
                let pivot = column[at].sqrt();
                column[at] = pivot;
                // Times its inverse would round twice.
                column[at + 1..].iter_mut().for_each(|l| *l /= pivot);
                for (other, from) in others.chunks_exact_mut(height).zip(at + 1..) {
                    let factor = column[from];
                    for (value, l) in other[from..].iter_mut().zip(&column[from..]) {
                        *value -= factor * l;
                    }
                }
            }
        }
        Ok(())
    }
}

struct Leave<'a> {
    panel: &'a [f64],
    height: usize,
    from: usize,
    tile: &'a mut [f64],
}

impl WithSimd for Leave<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { panel, height, from, tile } = self;
        for (columns, j) in tile.chunks_mut(WIDE * (height - from)).zip((from..).step_by(WIDE)) {
            subtract_product::<S, false>(simd, panel, height, j, columns, from);
        }
    }
}

/// Takes L Lᵀ off up to [`WIDE`] columns of a symmetric matrix from `j` on, whose first `skipped` rows are left out, or,
/// unless they ADD, overwrites them with −L Lᵀ.
#[inline(always)]
fn subtract_product<S: Simd, const ADD: bool>(
    simd: S,
    l: &[f64],
    height: usize,
    j: usize,
    columns: &mut [f64],
    skipped: usize,
) {
    match columns.len() / (height - skipped) {
        1 => subtract_from::<S, 1, ADD>(simd, l, height, j, columns, skipped),
        2 => subtract_from::<S, 2, ADD>(simd, l, height, j, columns, skipped),
        3 => subtract_from::<S, 3, ADD>(simd, l, height, j, columns, skipped),
        _ => subtract_from::<S, WIDE, ADD>(simd, l, height, j, columns, skipped),
    }
}

#[inline(always)]
fn subtract_from<S: Simd, const N: usize, const ADD: bool>(
    simd: S,
    l: &[f64],
    height: usize,
    j: usize,
    columns: &mut [f64],
    skipped: usize,
) {
    let mut i = j;
    while i + TALL * S::F64_LANES <= height {
        let mut sums = [[simd.splat_f64s(0.0); TALL]; N];
        for l in l.chunks_exact(height) {
            let (rows, factors) = (S::as_simd_f64s(&l[i..i + TALL * S::F64_LANES]).0, &l[j..j + N]);
            for n in 0..N {
                let factor = simd.splat_f64s(factors[n]);
                for m in 0..TALL {
                    sums[n][m] = simd.mul_add_e_f64s(rows[m], factor, sums[n][m]);
                }
            }
        }
        for n in 0..N {
            let at = n * (height - skipped) + i - skipped;
            let values = S::as_mut_simd_f64s(&mut columns[at..at + TALL * S::F64_LANES]).0;
            for m in 0..TALL {
                values[m] = if ADD { simd.sub_f64s(values[m], sums[n][m]) } else { simd.neg_f64s(sums[n][m]) };
            }
        }
        i += TALL * S::F64_LANES;
    }
    while i < height {
        let count = S::F64_LANES.min(height - i);
        let mut sums = [simd.splat_f64s(0.0); N];
        for l in l.chunks_exact(height) {
            let rows = simd.partial_load_f64s(&l[i..i + count]);
            for n in 0..N {
                sums[n] = simd.mul_add_e_f64s(rows, simd.splat_f64s(l[j + n]), sums[n]);
            }
        }
        for n in 0..N {
            let at = n * (height - skipped) + i - skipped;
            let values = &mut columns[at..at + count];
            let sum = if ADD { simd.sub_f64s(simd.partial_load_f64s(values), sums[n]) } else { simd.neg_f64s(sums[n]) };
            simd.partial_store_f64s(values, sum);
        }
        i += count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_eliminated_as_by_hand() {
        for (width, height) in [(1, 2), (1, 6), (3, 9), (4, 12), (24, 88), (35, 131), (64, 200)] {
            let entry = |i: usize, k: usize| if i == k { 60.0 } else { ((7 * i + 3 * k) as f64).sin() };
            let mut l = vec![0.0; width * height];
            for k in 0..width {
                for i in k..height {
                    let inner: f64 = (0..k).map(|p| l[p * height + i] * l[p * height + k]).sum();
                    l[k * height + i] = entry(i, k) - inner;
                    l[k * height + i] /= if i == k { l[k * height + k].sqrt() } else { l[k * height + k] };
                }
            }
            let mut panel: Vec<f64> = (0..width * height).map(|at| entry(at % height, at / height)).collect();
            assert!(fits(&panel, height));
            eliminate(&mut panel, height).unwrap();
            let from = width + (height - width) / 3;
            let mut tile = vec![f64::NAN; (height - from) * (height - from)];
            leave(&panel, height, from, &mut tile);
            for k in 0..width {
                assert!((k..height).all(|i| (panel[k * height + i] - l[k * height + i]).abs() < 1e-13));
            }
            for (k, column) in (from..height).zip(tile.chunks(height - from)) {
                for i in k..height {
                    let inner: f64 = (0..width).map(|p| l[p * height + i] * l[p * height + k]).sum();
                    assert!((column[i - from] + inner).abs() < 1e-12);
                }
            }
            panel[width * height - height + width - 1] = -1.0;
            assert!(eliminate(&mut panel, height).is_err());
        }
    }
}
