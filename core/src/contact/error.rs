//! Reasons why a contact problem has no solution.

use crate::cholesky::FactorError;
use crate::dense::OutOfMemory;
use crate::lcp::{LcpError, LcpStatus};
use std::fmt;

/// Reasons why there is no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveError {
    /// No reactions balance the load, or gaps contradict each other.
    NoEquilibrium,
    /// The iteration limit was reached, or the contact state is numerically singular.
    Unsolved,
    /// Cancelled by the callback.
    Cancelled,
    /// The points are not condensed, but the request needs it.
    NotCondensed,
    /// The points are condensed, but the request needs the Newton method.
    Condensed,
    /// A vector has the wrong length.
    Length {
        name: &'static str,
        found: usize,
        expected: usize,
    },
    /// A number is out of range.
    Value {
        name: &'static str,
        index: usize,
        allowed: &'static str,
    },
    Factor(FactorError),
}

impl fmt::Display for SolveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoEquilibrium => write!(f, "no reactions balance the load, or gaps contradict each other"),
            Self::Unsolved => write!(f, "the iteration limit was reached, or the contact state is singular"),
            Self::Cancelled => write!(f, "cancelled by the callback"),
            Self::NotCondensed => write!(f, "the points are not condensed; the method must be Lemke's algorithm"),
            Self::Condensed => write!(f, "the points are condensed; the method must be the active set"),
            Self::Length { name, found, expected } => write!(f, "{name} has length {found}; expected {expected}"),
            Self::Value { name, index, allowed } => write!(f, "{name}[{index}] must be {allowed}"),
            Self::Factor(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for SolveError {}

impl From<FactorError> for SolveError {
    fn from(error: FactorError) -> Self {
        Self::Factor(error)
    }
}

impl From<OutOfMemory> for SolveError {
    fn from(error: OutOfMemory) -> Self {
        Self::Factor(error.into())
    }
}

impl From<LcpError> for SolveError {
    /// An LCP with entries that are not finite belongs to a singular contact state.
    fn from(error: LcpError) -> Self {
        match error {
            LcpError::OutOfMemory => Self::Factor(FactorError::OutOfMemory),
            _ => Self::Unsolved,
        }
    }
}

impl SolveError {
    /// The error for the status of an LCP; `Ok` if it is solved.
    pub(super) fn of(status: LcpStatus) -> Result<(), Self> {
        match status {
            LcpStatus::Solved => Ok(()),
            LcpStatus::Ray => Err(Self::NoEquilibrium),
            LcpStatus::PivotLimit => Err(Self::Unsolved),
            LcpStatus::Interrupted => Err(Self::Cancelled),
        }
    }

    /// Whether the load is the reason, and not the memory or the caller.
    pub(super) fn is_of_load(self) -> bool {
        matches!(self, Self::NoEquilibrium | Self::Unsolved)
    }
}

/// Returns an error if a vector has the wrong length.
pub(super) fn require_length(name: &'static str, found: usize, expected: usize) -> Result<(), SolveError> {
    if found == expected { Ok(()) } else { Err(SolveError::Length { name, found, expected }) }
}

/// Returns an error if a number of a vector is out of range.
pub(super) fn require_values(
    name: &'static str,
    values: &[f64],
    allowed: &'static str,
    is_allowed: impl Fn(f64) -> bool,
) -> Result<(), SolveError> {
    match values.iter().position(|&value| !is_allowed(value)) {
        Some(index) => Err(SolveError::Value { name, index, allowed }),
        None => Ok(()),
    }
}
