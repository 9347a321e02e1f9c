//! A symmetric matrix to be factored, given by its columns one at a time.

use super::graph::Graph;

/// Overwrites a list with the entries of a column on and below the diagonal: row and value, in no particular order.
pub type Reader<'a> = Box<dyn FnMut(usize, &mut Vec<(usize, f64)>) + Send + 'a>;

pub trait Matrix: Sync {
    fn graph(&self) -> Graph;

    /// Each thread reads by one of its own.
    fn reader(&self) -> Reader<'_>;

    /// Whether the pivot of a column is negative; always the same answer.
    ///
    /// In a quasi-definite matrix [[K, Gᵀ], [G, −C]], K and C positive definite, these are the columns of −C, in any order of
    /// elimination (Vanderbei 1995).
    fn is_negative(&self, _column: usize) -> bool {
        false
    }
}
