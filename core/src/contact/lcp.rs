//! The linear complementarity problem of some contact points, by Lemke's algorithm.

use super::problem::ContactProblem;
use super::solution::{Outcome, Progress};
use crate::cholesky::FactorError;
use crate::lcp::{Lcp, LcpError, LcpStatus, LemkeOptions, lemke_watched};

/// What is asked: M row-major, q, the point of every row, whether its unknown is the gap, and a basis to begin with.
pub(super) struct Asked<'a> {
    pub(super) matrix: &'a [f64],
    pub(super) q: &'a [f64],
    pub(super) points: &'a [usize],
    pub(super) gap_is_z: &'a [bool],
    pub(super) basis: Option<&'a [bool]>,
}

impl ContactProblem {
    /// Which z are basic in the solution, or why there is none; adds to the pivots.
    pub(super) fn solve_lcp(
        &self,
        asked: &Asked,
        pivots: &mut usize,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Result<Vec<bool>, Outcome>, FactorError> {
        let covering = self.covering(asked.points, asked.gap_is_z);
        let options = LemkeOptions { covering: Some(&covering), ..LemkeOptions::default() };
        let mut before = 0;
        let mut tell = |step: usize, residual: f64| {
            let changing = step - std::mem::replace(&mut before, step);
            watch(Progress { step, changing, residual })
        };
        let solved =
            Lcp::new(asked.matrix, asked.q).and_then(|lcp| lemke_watched(&lcp, &options, asked.basis, &mut tell));
        let Some(found) = in_memory(solved)? else { return Ok(Err(Outcome::Unsolved)) };
        *pivots += found.pivots;
        Ok(match found.status {
            LcpStatus::Solved => Ok(found.basis),
            LcpStatus::Ray => Err(Outcome::NoEquilibrium),
            LcpStatus::PivotLimit => Err(Outcome::Unsolved),
            LcpStatus::Interrupted => Err(Outcome::Interrupted),
        })
    }

    /// A covering vector (k,) for rows of the points, of which w is the reaction where z is the gap: a force and the length
    /// by which it bends the plate, so that Lemke's path does not depend on units.
    pub(super) fn covering(&self, points: &[usize], gap_is_z: &[bool]) -> Vec<f64> {
        let power_of_two = |x: f64| x.log2().round().exp2();
        let root = power_of_two(self.scale.stiffness.sqrt());
        let rows = points.iter().zip(gap_is_z);
        rows.map(|(&i, gap_is_z)| {
            let lever = power_of_two(self.lever(i));
            if *gap_is_z { root * lever } else { 1.0 / (root * lever) }
        })
        .collect()
    }
}

/// What an LCP came to; `None` where its numbers are beyond the arithmetic.
pub(super) fn in_memory<T>(solved: Result<T, LcpError>) -> Result<Option<T>, FactorError> {
    match solved {
        Ok(found) => Ok(Some(found)),
        Err(LcpError::OutOfMemory) => Err(FactorError::OutOfMemory),
        Err(_) => Ok(None),
    }
}
