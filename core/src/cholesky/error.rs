//! Why there is no factor.

use crate::dense;

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

impl From<dense::OutOfMemory> for FactorError {
    fn from(_: dense::OutOfMemory) -> Self {
        Self::OutOfMemory
    }
}
