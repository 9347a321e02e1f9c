//! What substitution works on: one number a row, or those of several right-hand sides side by side.

use pulp::{Arch, Simd, WithSimd};

/// Right-hand sides that stand side by side.
pub const LANES: usize = 8;

/// A row of the right-hand sides.
pub(super) trait Entry: Copy + Send + Sync {
    const ZERO: Self;

    fn add(&mut self, other: Self);

    /// vector ← (L₁⁻¹v₁, −L₂L₁⁻¹v₁) for the columns (L₁, L₂) of a supernode, whose v₂ is zero.
    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]);

    /// v₁ ← L₁⁻ᵀ(v₁ − L₂ᵀv₂) for the columns (L₁, L₂) of a supernode.
    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]);
}

impl Entry for f64 {
    const ZERO: Self = 0.0;

    fn add(&mut self, other: Self) {
        *self += other;
    }

    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]) {
        Arch::new().dispatch(
            #[inline(always)]
            || eliminate(columns, count, vector),
        );
    }

    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]) {
        Arch::new().dispatch(
            #[inline(always)]
            || substitute(columns, count, vector),
        );
    }
}

/// Every lane is computed as if it were alone, so that its bits do not depend on what stands beside it.
#[derive(Clone, Copy)]
#[repr(align(64))]
pub(super) struct Lanes(pub(super) [f64; LANES]);

impl Entry for Lanes {
    const ZERO: Self = Self([0.0; LANES]);

    fn add(&mut self, other: Self) {
        self.0.iter_mut().zip(other.0).for_each(|(a, b)| *a += b);
    }

    fn eliminate(columns: &[f64], count: usize, vector: &mut [Self]) {
        Arch::new().dispatch(Eliminate { columns, count, vector });
    }

    fn substitute(columns: &[f64], count: usize, vector: &mut [Self]) {
        Arch::new().dispatch(Substitute { columns, count, vector });
    }
}

struct Eliminate<'a> {
    columns: &'a [f64],
    count: usize,
    vector: &'a mut [Lanes],
}

impl WithSimd for Eliminate<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match LANES / S::F64_LANES {
            1 => self.run::<S, 1>(simd),
            2 => self.run::<S, 2>(simd),
            4 => self.run::<S, 4>(simd),
            _ => self.run::<S, LANES>(simd),
        }
    }
}

impl Eliminate<'_> {
    /// With N registers a row.
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let Self { columns, count, vector } = self;
        let height = vector.len();
        for first in (0..count).step_by(TOGETHER) {
            let some = TOGETHER.min(count - first);
            let mut solved = [Lanes::ZERO; TOGETHER];
            for k in 0..some {
                let l = &columns[(first + k) * height..(first + k + 1) * height];
                let inverse = 1.0 / l[first + k];
                for lane in 0..LANES {
                    solved[k].0[lane] = inverse * vector[first + k].0[lane];
                }
                vector[first + k] = solved[k];
                for i in k + 1..some {
                    for lane in 0..LANES {
                        vector[first + i].0[lane] -= l[first + i] * solved[k].0[lane];
                    }
                }
            }
            let below = first + some;
            let mut x = [[simd.splat_f64s(0.0); N]; TOGETHER];
            for k in 0..TOGETHER {
                let registers = S::as_simd_f64s(&solved[k].0).0;
                for n in 0..N {
                    x[k][n] = simd.neg_f64s(registers[n]);
                }
            }
            if some == TOGETHER {
                let l = tails(&columns[first * height..], height, below);
                let factors = l[0].iter().zip(l[1]).zip(l[2]).zip(l[3]);
                for (row, (((a, b), c), d)) in vector[below..].iter_mut().zip(factors) {
                    let row = S::as_mut_simd_f64s(&mut row.0).0;
                    let l = [simd.splat_f64s(*a), simd.splat_f64s(*b), simd.splat_f64s(*c), simd.splat_f64s(*d)];
                    for n in 0..N {
                        for k in 0..TOGETHER {
                            row[n] = simd.mul_add_e_f64s(l[k], x[k][n], row[n]);
                        }
                    }
                }
            } else {
                for k in 0..some {
                    let l = &columns[(first + k) * height + below..(first + k + 1) * height];
                    for (row, l) in vector[below..].iter_mut().zip(l) {
                        let row = S::as_mut_simd_f64s(&mut row.0).0;
                        for n in 0..N {
                            row[n] = simd.mul_add_e_f64s(simd.splat_f64s(*l), x[k][n], row[n]);
                        }
                    }
                }
            }
        }
    }
}

struct Substitute<'a> {
    columns: &'a [f64],
    count: usize,
    vector: &'a mut [Lanes],
}

impl WithSimd for Substitute<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match LANES / S::F64_LANES {
            1 => self.run::<S, 1>(simd),
            2 => self.run::<S, 2>(simd),
            4 => self.run::<S, 4>(simd),
            _ => self.run::<S, LANES>(simd),
        }
    }
}

impl Substitute<'_> {
    /// With N registers a row.
    #[inline(always)]
    fn run<S: Simd, const N: usize>(self, simd: S) {
        let Self { columns, count, vector } = self;
        let height = vector.len();
        for first in (0..count).step_by(TOGETHER).rev() {
            let some = TOGETHER.min(count - first);
            let below = first + some;
            let mut sums = [[simd.splat_f64s(0.0); N]; TOGETHER];
            if some == TOGETHER {
                let l = tails(&columns[first * height..], height, below);
                let factors = l[0].iter().zip(l[1]).zip(l[2]).zip(l[3]);
                for (row, (((a, b), c), d)) in vector[below..].iter().zip(factors) {
                    let row = S::as_simd_f64s(&row.0).0;
                    let l = [simd.splat_f64s(*a), simd.splat_f64s(*b), simd.splat_f64s(*c), simd.splat_f64s(*d)];
                    for n in 0..N {
                        for k in 0..TOGETHER {
                            sums[k][n] = simd.mul_add_e_f64s(l[k], row[n], sums[k][n]);
                        }
                    }
                }
            } else {
                for k in 0..some {
                    let l = &columns[(first + k) * height + below..(first + k + 1) * height];
                    for (row, l) in vector[below..].iter().zip(l) {
                        let row = S::as_simd_f64s(&row.0).0;
                        for n in 0..N {
                            sums[k][n] = simd.mul_add_e_f64s(simd.splat_f64s(*l), row[n], sums[k][n]);
                        }
                    }
                }
            }
            for k in (0..some).rev() {
                let l = &columns[(first + k) * height..(first + k + 1) * height];
                let mut known = Lanes::ZERO;
                S::as_mut_simd_f64s(&mut known.0).0.copy_from_slice(&sums[k]);
                for i in k + 1..some {
                    for lane in 0..LANES {
                        known.0[lane] += l[first + i] * vector[first + i].0[lane];
                    }
                }
                let inverse = 1.0 / l[first + k];
                for lane in 0..LANES {
                    let value = &mut vector[first + k].0[lane];
                    *value = inverse * (*value - known.0[lane]);
                }
            }
        }
    }
}

/// Columns taken together, so that the vector is read and written once for all of them.
const TOGETHER: usize = 4;

/// The columns taken together, from row `below` on.
///
/// Written out, as the kernels' other arrays are: a closure given to `map` or `from_fn` is compiled without their
/// instructions, and called for each row.
#[inline(always)]
fn tails(columns: &[f64], height: usize, below: usize) -> [&[f64]; TOGETHER] {
    let (a, rest) = columns.split_at(height);
    let (b, rest) = rest.split_at(height);
    let (c, rest) = rest.split_at(height);
    [&a[below..], &b[below..], &c[below..], &rest[below..height]]
}

/// vector ← (L₁⁻¹v₁, v₂ − L₂L₁⁻¹v₁) for the columns (L₁, L₂) of a supernode.
#[inline(always)]
fn eliminate(columns: &[f64], count: usize, vector: &mut [f64]) {
    let height = vector.len();
    let whole = count - count % TOGETHER;
    for j in (0..whole).step_by(TOGETHER) {
        let l = tails(&columns[j * height..], height, j);
        for k in 0..TOGETHER {
            let solved = vector[j + k] / l[k][k];
            vector[j + k] = solved;
            for i in k + 1..TOGETHER {
                vector[j + i] -= l[k][i] * solved;
            }
        }
        let [a, b, c, d] = [vector[j], vector[j + 1], vector[j + 2], vector[j + 3]];
        let tails = l[0][4..].iter().zip(&l[1][4..]).zip(&l[2][4..]).zip(&l[3][4..]);
        for (v, (((p, q), r), s)) in vector[j + 4..].iter_mut().zip(tails) {
            *v -= (a * p + b * q) + (c * r + d * s);
        }
    }
    for j in whole..count {
        let l = &columns[j * height..(j + 1) * height];
        let solved = vector[j] / l[j];
        vector[j] = solved;
        for (v, p) in vector[j + 1..].iter_mut().zip(&l[j + 1..]) {
            *v -= solved * p;
        }
    }
}

/// v₁ ← L₁⁻ᵀ(v₁ − L₂ᵀv₂) for the columns (L₁, L₂) of a supernode.
#[inline(always)]
fn substitute(columns: &[f64], count: usize, vector: &mut [f64]) {
    let height = vector.len();
    let whole = count - count % TOGETHER;
    for j in (whole..count).rev() {
        let l = &columns[j * height + j..(j + 1) * height];
        let mut known = 0.0;
        for (p, v) in l[1..].iter().zip(&vector[j + 1..]) {
            known += p * v;
        }
        vector[j] = (vector[j] - known) / l[0];
    }
    for j in (0..whole).step_by(TOGETHER).rev() {
        let sums = products(tails(&columns[j * height..], height, j + TOGETHER), &vector[j + TOGETHER..]);
        let l = tails(&columns[j * height..], height, j);
        for k in (0..TOGETHER).rev() {
            let mut known = sums[k];
            for i in k + 1..TOGETHER {
                known += l[k][i] * vector[j + i];
            }
            vector[j + k] = (vector[j + k] - known) / l[k][k];
        }
    }
}

/// Products of columns and a vector, their sums side by side, so that none waits for the one before.
#[inline(always)]
fn products(columns: [&[f64]; TOGETHER], vector: &[f64]) -> [f64; TOGETHER] {
    let mut sums = [[0.0; LANES]; TOGETHER];
    let whole = vector.len() - vector.len() % LANES;
    for k in 0..TOGETHER {
        for (at, (p, v)) in columns[k][whole..].iter().zip(&vector[whole..]).enumerate() {
            sums[k][at] = p * v;
        }
    }
    let [a, b, c, d] = columns;
    let blocks = a.chunks_exact(LANES).zip(b.chunks_exact(LANES)).zip(c.chunks_exact(LANES)).zip(d.chunks_exact(LANES));
    for ((((a, b), c), d), v) in blocks.zip(vector.chunks_exact(LANES)) {
        for n in 0..LANES {
            sums[0][n] += a[n] * v[n];
            sums[1][n] += b[n] * v[n];
            sums[2][n] += c[n] * v[n];
            sums[3][n] += d[n] * v[n];
        }
    }
    let mut total = [0.0; TOGETHER];
    for k in 0..TOGETHER {
        let s = &sums[k];
        total[k] = ((s[0] + s[4]) + (s[1] + s[5])) + ((s[2] + s[6]) + (s[3] + s[7]));
    }
    total
}
