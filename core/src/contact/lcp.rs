//! The linear complementarity problem of some contact points, by Lemke's algorithm.

use super::condense::PosedLcp;
use super::problem::ContactProblem;
use super::solution::{Outcome, Progress};
use crate::cholesky::FactorError;
use crate::lcp::{Lcp, LcpError, LcpStatus, LemkeOptions, lemke_watched};

impl ContactProblem {
    /// Which z are basic in the solution, from a basis on if there is one, or why there is none; adds to the pivots.
    pub(super) fn solve_lcp(
        &self,
        posed: &PosedLcp,
        basis: Option<&[bool]>,
        pivots: &mut usize,
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<Result<Vec<bool>, Outcome>, FactorError> {
        let covering = self.covering(posed);
        let options = LemkeOptions { covering: Some(&covering), ..LemkeOptions::default() };
        let mut before = 0;
        let mut tell = |step: usize, residual: f64| {
            let changing = step - std::mem::replace(&mut before, step);
            watch(Progress { step, changing, residual })
        };
        let solved = Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| lemke_watched(&lcp, &options, basis, &mut tell));
        let Some(found) = in_memory(solved)? else { return Ok(Err(Outcome::Unsolved)) };
        *pivots += found.pivots;
        Ok(ended(found.status).map(|()| found.basis))
    }

    /// A covering vector (k,) for rows of points, of which w is the reaction where z is the gap: a force and the length
    /// by which it bends the plate, so that Lemke's path does not depend on units.
    fn covering(&self, posed: &PosedLcp) -> Vec<f64> {
        let power_of_two = |x: f64| x.log2().round().exp2();
        let root = power_of_two(self.scale.stiffness.sqrt());
        let rows = posed.point.iter().zip(&posed.gap_is_z);
        rows.map(|(&i, gap_is_z)| {
            let lever = power_of_two(self.lever(i));
            if *gap_is_z { root * lever } else { 1.0 / (root * lever) }
        })
        .collect()
    }
}

/// Whether an LCP ended at a basis, or what else it is.
pub(super) fn ended(status: LcpStatus) -> Result<(), Outcome> {
    match status {
        LcpStatus::Solved => Ok(()),
        LcpStatus::Ray => Err(Outcome::NoEquilibrium),
        LcpStatus::PivotLimit => Err(Outcome::Unsolved),
        LcpStatus::Interrupted => Err(Outcome::Interrupted),
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
