//! What is factored: a symmetric matrix, of which no more is asked than its columns one at a time.

use super::graph::Graph;

/// Overwrites a list with the entries of a column on and below the diagonal: row and value, in no particular order.
pub type Reader<'a> = Box<dyn FnMut(usize, &mut Vec<(usize, f64)>) + Send + 'a>;

pub trait Matrix: Sync {
    fn graph(&self) -> Graph;

    /// Each thread reads by one of its own.
    fn reader(&self) -> Reader<'_>;
}
