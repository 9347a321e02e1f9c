//! Dense matrices and their factors; a failed allocation is an error, not a panic.

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt;
use faer::linalg::lu::partial_pivoting::{factor, solve};
use faer::linalg::matmul::matmul;
use faer::perm::Perm;
use faer::{Accum, Conj, Mat, MatMut, MatRef, Par};

/// Error: there is not enough memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutOfMemory;

/// Smallest order of a matrix for which dense operations use all threads.
pub const PARALLEL_ORDER: usize = 400;

pub fn parallelism(order: usize) -> Par {
    if order < PARALLEL_ORDER { Par::Seq } else { Par::rayon(0) }
}

/// An empty vector with reserved memory for `len` numbers.
pub fn room(len: usize) -> Result<Vec<f64>, OutOfMemory> {
    let mut numbers = Vec::new();
    numbers.try_reserve_exact(len).map_err(|_| OutOfMemory)?;
    Ok(numbers)
}

/// A vector of `len` zeros.
pub fn zeros(len: usize) -> Result<Vec<f64>, OutOfMemory> {
    let mut numbers = room(len)?;
    numbers.resize(len, 0.0);
    Ok(numbers)
}

/// The entries `entry(i, j)` of a matrix (rows, columns) in a row-major vector.
pub fn row_major(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> f64) -> Result<Vec<f64>, OutOfMemory> {
    let mut matrix = room(rows.checked_mul(columns).ok_or(OutOfMemory)?)?;
    (0..rows).for_each(|i| matrix.extend((0..columns).map(|j| entry(i, j))));
    Ok(matrix)
}

/// The matrix (rows, columns) with the entries `entry(i, j)`.
pub fn matrix(rows: usize, columns: usize, entry: impl FnMut(usize, usize) -> f64) -> Result<Mat<f64>, OutOfMemory> {
    let mut matrix = Mat::new();
    matrix.try_reserve(rows, columns).map_err(|_| OutOfMemory)?;
    matrix.resize_with(rows, columns, entry);
    Ok(matrix)
}

/// The matrix product left · right.
pub fn product(left: MatRef<'_, f64>, right: MatRef<'_, f64>) -> Result<Mat<f64>, OutOfMemory> {
    let mut product = matrix(left.nrows(), right.ncols(), |_, _| 0.0)?;
    let parallelism = parallelism(left.nrows().max(right.ncols()));
    matmul(product.as_mut(), Accum::Replace, left, right, 1.0, parallelism);
    Ok(product)
}

/// The factorization P A = L U of a square matrix, with partial pivoting.
pub struct Lu {
    factors: Mat<f64>,
    permutation: Perm<usize>,
    parallelism: Par,
}

impl Lu {
    /// Factors a square matrix. The matrix may be singular; then a pivot is zero.
    pub fn of(mut matrix: Mat<f64>) -> Result<Self, OutOfMemory> {
        let order = matrix.nrows();
        let parallelism = parallelism(order);
        let (mut forward, mut backward) = (vec![0; order], vec![0; order]);
        let scratch = factor::lu_in_place_scratch::<usize, f64>(order, order, parallelism, Default::default());
        let mut memory = memory(scratch)?;
        let stack = MemStack::new(&mut memory);
        factor::lu_in_place(matrix.as_mut(), &mut forward, &mut backward, parallelism, stack, Default::default());
        let permutation = Perm::new_checked(forward.into(), backward.into(), order);
        Ok(Self { factors: matrix, permutation, parallelism })
    }

    /// Whether every pivot of the LU factorization is finite and larger than `least` in magnitude.
    pub fn has_pivots_above(&self, least: f64) -> bool {
        (0..self.factors.ncols()).map(|i| self.factors[(i, i)].abs()).all(|pivot| pivot > least && pivot.is_finite())
    }

    pub fn solve_in_place(&self, right: MatMut<'_, f64>) -> Result<(), OutOfMemory> {
        let (factors, permutation) = (self.factors.as_ref(), self.permutation.as_ref());
        let scratch = solve::solve_in_place_scratch::<usize, f64>(factors.nrows(), right.ncols(), self.parallelism);
        let mut memory = memory(scratch)?;
        let stack = MemStack::new(&mut memory);
        solve::solve_in_place_with_conj(factors, factors, permutation, Conj::No, right, self.parallelism, stack);
        Ok(())
    }
}

/// The factorization A = L Lᵀ of a symmetric positive definite matrix.
pub struct Cholesky(Mat<f64>);

impl Cholesky {
    /// Factors a symmetric matrix from its lower triangle; `None` if the matrix is not positive definite.
    pub fn of(mut matrix: Mat<f64>) -> Result<Option<Self>, OutOfMemory> {
        let parallelism = parallelism(matrix.nrows());
        let scratch = llt::factor::cholesky_in_place_scratch::<f64>(matrix.nrows(), parallelism, Default::default());
        let mut memory = memory(scratch)?;
        let stack = MemStack::new(&mut memory);
        let done =
            llt::factor::cholesky_in_place(matrix.as_mut(), Default::default(), parallelism, stack, Default::default());
        Ok(done.is_ok().then_some(Self(matrix)))
    }

    /// Whether every pivot of the Cholesky factorization is larger than `least`.
    pub fn has_pivots_above(&self, least: f64) -> bool {
        (0..self.0.ncols()).all(|i| self.0[(i, i)].powi(2) > least)
    }

    pub fn solve_in_place(&self, right: MatMut<'_, f64>) {
        let mut memory = MemBuffer::new(StackReq::EMPTY);
        let parallelism = parallelism(self.0.nrows());
        llt::solve::solve_in_place(self.0.as_ref(), right, parallelism, MemStack::new(&mut memory));
    }
}

/// Allocates the scratch memory that a function of faer requires.
fn memory(of: StackReq) -> Result<MemBuffer, OutOfMemory> {
    MemBuffer::try_new(of).map_err(|_| OutOfMemory)
}
