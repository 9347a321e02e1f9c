//! The error type of contact problems.

use crate::cholesky::FactorError;
use crate::dense::OutOfMemory;
use crate::lcp::{LcpError, LcpStatus};
use std::fmt;

/// Reasons why a contact problem has no solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolveError {
    /// No reactions balance the load, or the gaps of rigid supports contradict each other.
    NoEquilibrium,
    /// The iteration limit was reached, or the contact state is numerically singular.
    Unsolved,
    /// The callback cancelled the solve.
    Cancelled,
    /// The call needs condensed contact points, but K is factored for the Newton method.
    NotCondensed,
    /// The call needs the Newton method, but the plate is condensed onto its contact points.
    Condensed,
    /// The vector `name` has the wrong length.
    Length {
        name: &'static str,
        found: usize,
        expected: usize,
    },
    /// A number of the vector `name` is out of range.
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
    /// [`SolveError::Unsolved`] for an LCP with infinite or undefined entries: its contact state is singular.
    fn from(error: LcpError) -> Self {
        match error {
            LcpError::OutOfMemory => Self::Factor(FactorError::OutOfMemory),
            _ => Self::Unsolved,
        }
    }
}

impl SolveError {
    /// `Ok` if an LCP is solved, otherwise the error for its status.
    pub(super) fn of(status: LcpStatus) -> Result<(), Self> {
        match status {
            LcpStatus::Solved => Ok(()),
            LcpStatus::Ray => Err(Self::NoEquilibrium),
            LcpStatus::PivotLimit => Err(Self::Unsolved),
            LcpStatus::Interrupted => Err(Self::Cancelled),
        }
    }

    /// Whether this load has no solution, while other loads may have one. All other errors are lack of memory, wrong
    /// arguments or cancellation.
    pub(super) fn is_of_load(self) -> bool {
        matches!(self, Self::NoEquilibrium | Self::Unsolved)
    }
}

/// Returns an error if the vector `name` has `found` entries instead of `expected`.
pub(super) fn require_length(name: &'static str, found: usize, expected: usize) -> Result<(), SolveError> {
    if found == expected { Ok(()) } else { Err(SolveError::Length { name, found, expected }) }
}

/// Returns an error if a number of the vector `name` is out of range.
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
