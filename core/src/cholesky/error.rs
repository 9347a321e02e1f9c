//! The error type of the factorization.

use crate::dense;

/// Reasons why a factorization fails.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorError {
    /// The pivot of this column does not have the expected sign: negative where
    /// [`is_negative`](super::Matrix::is_negative) is true, otherwise positive. The structure is a mechanism, or the
    /// matrix is singular to working precision.
    NotPositiveDefinite { column: usize },
    /// The factor does not fit into memory.
    OutOfMemory,
    /// The factorization takes `bytes` of memory, but only `room` bytes are allowed. This follows from the pattern,
    /// before any number is computed.
    TooLarge { bytes: usize, room: usize },
}

impl std::fmt::Display for FactorError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NotPositiveDefinite { column } => {
                write!(f, "the pivot of column {column} is zero or of the wrong sign")
            }
            Self::OutOfMemory => write!(f, "the factor does not fit into memory"),
            Self::TooLarge { bytes, room } => {
                let [takes, free] = [bytes, room].map(|&size| size as f64 / 1e9);
                write!(f, "the factor takes {takes:.1} GB of memory, and {free:.1} GB are free")
            }
        }
    }
}

impl std::error::Error for FactorError {}

impl From<dense::OutOfMemory> for FactorError {
    fn from(_: dense::OutOfMemory) -> Self {
        Self::OutOfMemory
    }
}
