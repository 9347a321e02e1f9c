//! The interface of a symmetric matrix that is factored; its columns are read one at a time.

use super::graph::Graph;

/// Function that overwrites a list with the entries (row, value) of a column on and below the diagonal, in any order.
pub type Reader<'a> = Box<dyn FnMut(usize, &mut Vec<(usize, f64)>) + Send + 'a>;

pub trait Matrix: Sync {
    fn graph(&self) -> Graph;

    /// Makes a reader of columns. Each thread makes a reader of its own.
    fn reader(&self) -> Reader<'_>;

    /// Whether the pivot of a column is negative. The result must not change between calls.
    ///
    /// In a quasi-definite matrix [[K, Gᵀ], [G, −C]], K and C positive definite, the pivots of the columns of −C are
    /// negative, in every order of elimination (Vanderbei 1995).
    fn is_negative(&self, _column: usize) -> bool {
        false
    }
}
