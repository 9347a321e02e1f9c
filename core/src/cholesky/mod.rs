//! Sparse Cholesky factorization by `faer`, its solves, and its trailing block.

mod entry;
mod substitution;

use crate::assembly::LowerTriangle;
pub use entry::LANES;
use entry::{Entry, Lanes};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError as PivotError, LltParams, LltRegularization};
use faer::sparse::linalg::SymbolicSupernodalParams;
use faer::sparse::linalg::cholesky::{simplicial, supernodal};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Mat, Par, Spec};
use std::sync::Arc;
use substitution::Schedule;

/// Why there is no factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorError {
    /// The pivot of this column is not positive: something can move, or the arithmetic is at its end.
    NotPositiveDefinite { column: usize },
    /// The factor does not fit into memory.
    OutOfMemory,
}

impl std::fmt::Display for FactorError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotPositiveDefinite { column } => write!(f, "the pivot of column {column} is not positive"),
            Self::OutOfMemory => write!(f, "the factor does not fit into memory"),
        }
    }
}

impl std::error::Error for FactorError {}

/// K = L Lᵀ with the columns in the order given.
pub struct Factor {
    symbolic: Arc<supernodal::SymbolicSupernodalCholesky<usize>>,
    schedule: Arc<Schedule>,
    values: Vec<f64>,
}

/// faer joins its threads in every supernode; on these matrices, whose supernodes are small, that costs more than it
/// saves (160×160 `mitc9`: 0.55 s on one thread, 1.3 s on two).
const PAR: Par = Par::Seq;

fn buffer(request: StackReq) -> Result<MemBuffer, FactorError> {
    MemBuffer::try_new(request).map_err(|_| FactorError::OutOfMemory)
}

/// Columns of the upper triangle's pattern, which the analysis reads.
fn transposed(lower: &LowerTriangle) -> (Vec<usize>, Vec<usize>) {
    let n = lower.column_start.len() - 1;
    let mut start = vec![0; n + 1];
    for &row in &lower.row {
        start[row + 1] += 1;
    }
    for j in 0..n {
        start[j + 1] += start[j];
    }
    let mut next = start.clone();
    let mut index = vec![0; lower.row.len()];
    for column in 0..n {
        for &row in &lower.row[lower.column_start[column]..lower.column_start[column + 1]] {
            index[next[row]] = column;
            next[row] += 1;
        }
    }
    (start, index)
}

/// The pattern of L.
#[derive(Clone)]
pub struct Analysis {
    symbolic: Arc<supernodal::SymbolicSupernodalCholesky<usize>>,
    schedule: Arc<Schedule>,
}

impl Analysis {
    pub fn new(matrix: &LowerTriangle) -> Result<Self, FactorError> {
        let n = matrix.column_start.len() - 1;
        let (start, index) = transposed(matrix);
        let upper = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &start, None, &index);
        let mut parents = vec![0isize; n];
        let mut counts = vec![0usize; n];
        let request = simplicial::prefactorize_symbolic_cholesky_scratch::<usize>(n, index.len())
            .or(supernodal::factorize_supernodal_symbolic_cholesky_scratch::<usize>(n));
        let mut memory = buffer(request)?;
        let stack = MemStack::new(&mut memory);
        let tree = simplicial::prefactorize_symbolic_cholesky(&mut parents, &mut counts, upper, stack);
        let symbolic = supernodal::factorize_supernodal_symbolic_cholesky(
            upper,
            tree,
            &counts,
            stack,
            SymbolicSupernodalParams::default(),
        )
        .map_err(|_| FactorError::OutOfMemory)?;
        let schedule = Arc::new(Schedule::new(&symbolic));
        Ok(Self { symbolic: Arc::new(symbolic), schedule })
    }

    pub fn factorize(&self, matrix: &LowerTriangle) -> Result<Factor, FactorError> {
        let n = matrix.column_start.len() - 1;
        let mut values = Vec::new();
        values.try_reserve_exact(self.symbolic.len_val()).map_err(|_| FactorError::OutOfMemory)?;
        values.resize(self.symbolic.len_val(), 0.0);
        let pattern = SymbolicSparseColMatRef::new_unsorted_checked(n, n, &matrix.column_start, None, &matrix.row);
        let lower = SparseColMatRef::new(pattern, &matrix.value);
        let params: Spec<LltParams, f64> = Spec::default();
        let mut memory =
            buffer(supernodal::factorize_supernodal_numeric_llt_scratch::<usize, f64>(&self.symbolic, PAR, params))?;
        supernodal::factorize_supernodal_numeric_llt(
            &mut values,
            lower,
            LltRegularization::default(),
            &self.symbolic,
            PAR,
            MemStack::new(&mut memory),
            params,
        )
        .map_err(|PivotError::NonPositivePivot { index }| FactorError::NotPositiveDefinite { column: index })?;
        Ok(Factor { symbolic: self.symbolic.clone(), schedule: self.schedule.clone(), values })
    }
}

impl Factor {
    pub fn len(&self) -> usize {
        self.symbolic.nrows()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The column whose pivot is the smallest part of its diagonal entry, and that part.
    ///
    /// Near the unit roundoff the pivot is rounding: the matrix is singular to working precision.
    pub fn weakest_pivot(&self, matrix: &LowerTriangle) -> (usize, f64) {
        let mut diagonal = vec![0.0; self.len()];
        for column in 0..self.len() {
            for at in matrix.column_start[column]..matrix.column_start[column + 1] {
                if matrix.row[at] == column {
                    diagonal[column] += matrix.value[at];
                }
            }
        }
        let mut weakest = (0, f64::INFINITY);
        for s in 0..self.symbolic.n_supernodes() {
            let node = self.view().supernode(s);
            for j in 0..node.val().ncols() {
                let part = node.val()[(j, j)].powi(2) / diagonal[node.start() + j];
                if part < weakest.1 {
                    weakest = (node.start() + j, part);
                }
            }
        }
        weakest
    }

    /// Entries stored for L.
    pub fn entries(&self) -> usize {
        self.values.len()
    }

    fn view(&self) -> supernodal::SupernodalLltRef<'_, usize, f64> {
        supernodal::SupernodalLltRef::new(&self.symbolic, &self.values)
    }

    /// Overwrites `rhs`, one vector or several one after the other, with L⁻¹ times each.
    ///
    /// Of several each has the bits that it has beside any others.
    pub fn forward(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        if rhs.len() != self.len() {
            return self.side_by_side(rhs, |lanes| self.schedule.forward(&self.values, lanes));
        }
        self.schedule.forward(&self.values, rhs);
        Ok(())
    }

    /// Overwrites `rhs`, one vector or several one after the other, with L⁻ᵀ times each.
    pub fn backward(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        if rhs.len() != self.len() {
            return self.side_by_side(rhs, |lanes| self.schedule.backward(&self.values, lanes));
        }
        self.schedule.backward(&self.values, rhs);
        Ok(())
    }

    /// Overwrites vectors one after the other with L⁻ᵀL⁻¹ times each, with the bits that it has beside any others, or alone.
    pub fn solve_side_by_side(&self, rhs: &mut [f64]) -> Result<(), FactorError> {
        self.side_by_side(rhs, |lanes| {
            self.schedule.forward(&self.values, lanes);
            self.schedule.backward(&self.values, lanes);
        })
    }

    fn side_by_side(&self, rhs: &mut [f64], solve: impl Fn(&mut [Lanes])) -> Result<(), FactorError> {
        let size = self.len().max(1);
        let mut lanes = Vec::new();
        lanes.try_reserve_exact(size).map_err(|_| FactorError::OutOfMemory)?;
        for vectors in rhs.chunks_mut(LANES * size) {
            lanes.clear();
            lanes.resize(size, Lanes::ZERO);
            for (lane, vector) in vectors.chunks_exact(size).enumerate() {
                lanes.iter_mut().zip(vector).for_each(|(row, value)| row.0[lane] = *value);
            }
            solve(&mut lanes);
            for (lane, vector) in vectors.chunks_exact_mut(size).enumerate() {
                lanes.iter().zip(vector).for_each(|(row, value)| *value = row.0[lane]);
            }
        }
        Ok(())
    }

    /// The last `size` rows and columns of L: the Cholesky factor of the Schur complement onto them.
    pub fn trailing_block(&self, size: usize) -> Mat<f64> {
        let first = self.len() - size;
        let mut block = Mat::zeros(size, size);
        for s in 0..self.symbolic.n_supernodes() {
            if self.symbolic.supernode_end()[s] <= first {
                continue;
            }
            let node = self.view().supernode(s);
            let matrix = node.val();
            for j in 0..matrix.ncols() {
                let column = node.start() + j;
                if column < first {
                    continue;
                }
                for i in j..matrix.ncols() {
                    block[(node.start() + i - first, column - first)] = matrix[(i, j)];
                }
                for (i, &row) in node.pattern().iter().enumerate() {
                    block[(row - first, column - first)] = matrix[(matrix.ncols() + i, j)];
                }
            }
        }
        block
    }
}
