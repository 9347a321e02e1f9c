//! Why there is no factor.

use crate::dense;

/// Why there is no factor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FactorError {
    /// The pivot of this column is not positive, or not negative where [`is_negative`](super::Matrix::is_negative) says that
    /// it is: something can move, or the arithmetic is at its end.
    NotPositiveDefinite { column: usize },
    /// The factor does not fit into memory.
    OutOfMemory,
    /// Factoring takes more bytes than there is room for; known before there are any numbers.
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
