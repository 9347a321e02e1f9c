//! Entries of right-hand sides: one number per row, or `LANES` numbers per row for several right-hand sides.

use super::layout::{PANEL, ROWS};
use pulp::{Arch, Simd, WithSimd};
use std::marker::PhantomData;

/// Number of right-hand sides that are solved together, one in each SIMD lane.
pub const LANES: usize = 8;

/// The entries of one row in all right-hand sides that are solved together.
pub(super) trait Entry: Copy + Send + Sync {
    const ZERO: Self;

    fn add(&mut self, other: Self);

    fn negate(&mut self);

    fn is_zero(&self) -> bool;

    /// Forward substitution with `count` columns (L₁, L₂) of a supernode: vector ← (L₁⁻¹v₁, v₂ − L₂L₁⁻¹v₁).
    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]);

    /// Backward substitution with `count` columns (L₁, L₂) of a supernode: v₁ ← L₁⁻ᵀ(v₁ − L₂ᵀv₂).
    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]);
}

impl Entry for f64 {
    const ZERO: Self = 0.0;

    fn add(&mut self, other: Self) {
        *self += other;
    }

    fn negate(&mut self) {
        *self = -*self;
    }

    fn is_zero(&self) -> bool {
        *self == 0.0
    }

    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]) {
        Run::<_, Eliminate>::dispatch(columns, count, vector);
    }

    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]) {
        Run::<_, Substitute>::dispatch(columns, count, vector);
    }
}

/// The entries of one row in `LANES` right-hand sides. Results in a lane are the same to the last bit for any numbers
/// in the other lanes.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f64; LANES]);

impl Entry for Lanes {
    const ZERO: Self = Self([0.0; LANES]);

    fn add(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }

    fn negate(&mut self) {
        self.0.iter_mut().for_each(|value| *value = -*value);
    }

    fn is_zero(&self) -> bool {
        self.0 == [0.0; LANES]
    }

    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]) {
        Run::<_, Eliminate>::dispatch(columns, count, vector);
    }

    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]) {
        Run::<_, Substitute>::dispatch(columns, count, vector);
    }
}

/// Arguments of a [`Kernel`]: `count` columns of a supernode, stored by panels (see `layout`), and a vector.
struct Run<'a, E, K> {
    columns: &'a [f64],
    count: usize,
    vector: &'a mut [E],
    kernel: PhantomData<K>,
}

/// An inner loop over `count` columns, with eight numbers in N SIMD registers. The compiler makes a separate loop for a
/// `count` that is constant.
trait Kernel<E> {
    fn run<S: Simd, const N: usize>(simd: S, columns: &[f64], count: usize, vector: &mut [E]);
}

impl<'a, E, K: Kernel<E>> Run<'a, E, K> {
    fn dispatch(columns: &'a [f64], count: usize, vector: &'a mut [E]) {
        Arch::new().dispatch(Self { columns, count, vector, kernel: PhantomData });
    }
}

impl<E, K: Kernel<E>> WithSimd for Run<'_, E, K> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        const { assert!(ROWS == 8 && LANES == 8) }
        let Self { columns, count, vector, .. } = self;
        match (8 / S::F64_LANES, count) {
            (1, PANEL) => K::run::<S, 1>(simd, columns, PANEL, vector),
            (1, _) => K::run::<S, 1>(simd, columns, count, vector),
            (2, PANEL) => K::run::<S, 2>(simd, columns, PANEL, vector),
            (2, _) => K::run::<S, 2>(simd, columns, count, vector),
            (4, _) => K::run::<S, 4>(simd, columns, count, vector),
            _ => K::run::<S, 8>(simd, columns, count, vector),
        }
    }
}

struct Eliminate;

struct Substitute;

impl Kernel<Lanes> for Eliminate {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(simd: S, columns: &[f64], count: usize, vector: &mut [Lanes]) {
        let (own, tail) = columns.split_at(count * count);
        let (solved, below) = vector.split_at_mut(count);
        let mut x = [[simd.splat_f64s(0.0); N]; PANEL];
        for k in 0..count {
            let l = &own[k * count..(k + 1) * count];
            let inverse = 1.0 / l[k];
            for lane in 0..LANES {
                solved[k].0[lane] *= inverse;
            }
            let pivot = solved[k];
            for i in k + 1..count {
                for lane in 0..LANES {
                    solved[i].0[lane] -= l[i] * pivot.0[lane];
                }
            }
            let registers = S::as_simd_f64s(&solved[k].0).0;
            for n in 0..N {
                x[k][n] = simd.neg_f64s(registers[n]);
            }
        }
        for (block, rows) in tail.chunks(ROWS * count).zip(below.chunks_mut(ROWS)) {
            let height = rows.len();
            // Processes half of the columns at a time, so that the entries of x for these columns stay in registers.
            for (l, x) in block.chunks(HALF * height).zip(x.chunks_exact(HALF)) {
                if let (Ok(l), Ok(rows)) =
                    (<&[f64; HALF * ROWS]>::try_from(l), <&mut [Lanes; ROWS]>::try_from(&mut *rows))
                {
                    for i in 0..ROWS {
                        let row = S::as_mut_simd_f64s(&mut rows[i].0).0;
                        for k in 0..HALF {
                            let l = simd.splat_f64s(l[k * ROWS + i]);
                            for n in 0..N {
                                row[n] = simd.mul_add_e_f64s(l, x[k][n], row[n]);
                            }
                        }
                    }
                } else {
                    for (i, row) in rows.iter_mut().enumerate() {
                        let row = S::as_mut_simd_f64s(&mut row.0).0;
                        for (k, l) in l.chunks_exact(height).enumerate() {
                            let l = simd.splat_f64s(l[i]);
                            for n in 0..N {
                                row[n] = simd.mul_add_e_f64s(l, x[k][n], row[n]);
                            }
                        }
                    }
                }
            }
        }
    }
}

impl Kernel<Lanes> for Substitute {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(simd: S, columns: &[f64], count: usize, vector: &mut [Lanes]) {
        let (own, tail) = columns.split_at(count * count);
        let (solved, below) = vector.split_at_mut(count);
        let mut sums = [[simd.splat_f64s(0.0); N]; PANEL];
        for (block, rows) in tail.chunks(ROWS * count).zip(below.chunks(ROWS)) {
            let height = rows.len();
            for (l, sums) in block.chunks(HALF * height).zip(sums.chunks_exact_mut(HALF)) {
                if let (Ok(l), Ok(rows)) = (<&[f64; HALF * ROWS]>::try_from(l), <&[Lanes; ROWS]>::try_from(rows)) {
                    let mut own = [[simd.splat_f64s(0.0); N]; HALF];
                    own.copy_from_slice(sums);
                    for i in 0..ROWS {
                        let row = S::as_simd_f64s(&rows[i].0).0;
                        for k in 0..HALF {
                            let l = simd.splat_f64s(l[k * ROWS + i]);
                            for n in 0..N {
                                own[k][n] = simd.mul_add_e_f64s(l, row[n], own[k][n]);
                            }
                        }
                    }
                    sums.copy_from_slice(&own);
                } else {
                    for (l, sum) in l.chunks_exact(height).zip(sums) {
                        for (l, row) in l.iter().zip(rows) {
                            let row = S::as_simd_f64s(&row.0).0;
                            for n in 0..N {
                                sum[n] = simd.mul_add_e_f64s(simd.splat_f64s(*l), row[n], sum[n]);
                            }
                        }
                    }
                }
            }
        }
        for k in (0..count).rev() {
            let l = &own[k * count..(k + 1) * count];
            let mut known = Lanes::ZERO;
            S::as_mut_simd_f64s(&mut known.0).0.copy_from_slice(&sums[k]);
            for i in k + 1..count {
                for lane in 0..LANES {
                    known.0[lane] += l[i] * solved[i].0[lane];
                }
            }
            let inverse = 1.0 / l[k];
            for lane in 0..LANES {
                let value = &mut solved[k].0[lane];
                *value = inverse * (*value - known.0[lane]);
            }
        }
    }
}

/// Number of columns of a panel that are processed together, so that the solution entries x of these columns stay in
/// registers.
const HALF: usize = PANEL / 2;

impl Kernel<f64> for Eliminate {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(simd: S, columns: &[f64], count: usize, vector: &mut [f64]) {
        let (own, tail) = columns.split_at(count * count);
        let (solved, below) = vector.split_at_mut(count);
        let mut x = [simd.splat_f64s(0.0); PANEL];
        for k in 0..count {
            let l = &own[k * count..(k + 1) * count];
            solved[k] /= l[k];
            for i in k + 1..count {
                solved[i] -= l[i] * solved[k];
            }
            x[k] = simd.splat_f64s(-solved[k]);
        }
        let (blocks, rest) = tail.split_at(below.len() / ROWS * ROWS * count);
        let mut rows = below.chunks_exact_mut(ROWS);
        for (block, rows) in blocks.chunks_exact(ROWS * count).zip(&mut rows) {
            let rows = &mut S::as_mut_simd_f64s(rows).0[..N];
            let l = &S::as_simd_f64s(block).0[..count * N];
            let mut sums = [simd.splat_f64s(0.0); N];
            sums.copy_from_slice(rows);
            for k in 0..count {
                for n in 0..N {
                    sums[n] = simd.mul_add_e_f64s(l[k * N + n], x[k], sums[n]);
                }
            }
            rows.copy_from_slice(&sums);
        }
        let rows = rows.into_remainder();
        for (k, l) in rest.chunks_exact(rows.len().max(1)).enumerate() {
            for (row, l) in rows.iter_mut().zip(l) {
                *row -= l * solved[k];
            }
        }
    }
}

impl Kernel<f64> for Substitute {
    #[inline(always)]
    fn run<S: Simd, const N: usize>(simd: S, columns: &[f64], count: usize, vector: &mut [f64]) {
        let (own, tail) = columns.split_at(count * count);
        let (solved, below) = vector.split_at_mut(count);
        let (blocks, rest) = tail.split_at(below.len() / ROWS * ROWS * count);
        let (whole, last) = below.split_at(below.len() / ROWS * ROWS);
        let totals = products::<S, N>(simd, blocks, count, whole);
        for k in (0..count).rev() {
            let l = &own[k * count..(k + 1) * count];
            let mut known = totals[k];
            for (l, row) in rest[k * last.len()..(k + 1) * last.len()].iter().zip(last) {
                known += l * row;
            }
            for i in k + 1..count {
                known += l[i] * solved[i];
            }
            solved[k] = (solved[k] - known) / l[k];
        }
    }
}

/// Scalar product of each of `count` columns of L with the vector, over the rows in full blocks of `ROWS` rows.
///
/// Blocks are read from the last to the first, as backward substitution reads the columns: reading memory in one
/// direction is 1.5 times as fast. The sums are separate variables, since the compiler would keep an array in memory.
#[inline(always)]
fn products<S: Simd, const N: usize>(simd: S, blocks: &[f64], count: usize, vector: &[f64]) -> [f64; PANEL] {
    let blocks = || blocks.chunks_exact(ROWS * count).zip(vector.chunks_exact(ROWS));
    let zero = simd.splat_f64s(0.0);
    let mut totals = [0.0; PANEL];
    let mut from = 0;
    if count >= HALF {
        let (mut low, mut high) = ([zero; HALF], [zero; HALF]);
        for (block, rows) in blocks().rev() {
            if count == PANEL {
                high = add_products::<S, N>(simd, high, &block[ROWS * HALF..], rows);
            }
            low = add_products::<S, N>(simd, low, &block[..ROWS * HALF], rows);
        }
        for k in 0..HALF {
            totals[k] = simd.reduce_sum_f64s(low[k]);
            totals[HALF + k] = simd.reduce_sum_f64s(high[k]);
        }
        from = if count == PANEL { PANEL } else { HALF };
    }
    for (k, total) in totals.iter_mut().enumerate().take(count).skip(from) {
        let mut sum = zero;
        for (block, rows) in blocks().rev() {
            let (l, rows) = (&S::as_simd_f64s(&block[ROWS * k..]).0[..N], &S::as_simd_f64s(rows).0[..N]);
            (0..N).for_each(|n| sum = simd.mul_add_e_f64s(l[n], rows[n], sum));
        }
        *total = simd.reduce_sum_f64s(sum);
    }
    totals
}

#[inline(always)]
fn add_products<S: Simd, const N: usize>(simd: S, to: [S::f64s; HALF], block: &[f64], rows: &[f64]) -> [S::f64s; HALF] {
    let [mut a, mut b, mut c, mut d] = to;
    let (l, rows) = (&S::as_simd_f64s(block).0[..HALF * N], &S::as_simd_f64s(rows).0[..N]);
    for n in 0..N {
        d = simd.mul_add_e_f64s(l[3 * N + n], rows[n], d);
        c = simd.mul_add_e_f64s(l[2 * N + n], rows[n], c);
        b = simd.mul_add_e_f64s(l[N + n], rows[n], b);
        a = simd.mul_add_e_f64s(l[n], rows[n], a);
    }
    [a, b, c, d]
}
