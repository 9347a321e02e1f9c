//! Where a descent begins: at an answer to another load.

use crate::contact::problem::Factored;
use crate::contact::solution::ContactSolution;

/// Where to begin: displacements over all dofs, reactions and states in the caller's order, and a factor, if not the
/// problem's own.
pub(super) struct Start<'a> {
    pub displacement: &'a [f64],
    pub reaction: &'a [f64],
    pub closed: &'a [bool],
    pub factored: Option<&'a Factored>,
    pub balanced: Option<Balanced<'a>>,
}

/// The load that a start is the solution of, the low-order part of its displacement, and how far the points overlap in it.
#[derive(Clone, Copy)]
pub(super) struct Balanced<'a> {
    pub load: &'a [f64],
    pub low: &'a [f64],
    pub overlap: &'a [f64],
}

/// One load's solution and the factor of its contact set, for loads not unlike it to begin with.
pub struct Reference {
    pub solution: ContactSolution,
    pub(super) factored: Factored,
    pub(super) load: Vec<f64>,
    pub(super) overlap: Vec<f64>,
}

impl Reference {
    pub(super) fn start(&self) -> Start<'_> {
        Start {
            displacement: &self.solution.displacement.hi,
            reaction: &self.solution.reaction,
            closed: &self.solution.closed,
            factored: Some(&self.factored),
            balanced: Some(Balanced { load: &self.load, low: &self.solution.displacement.lo, overlap: &self.overlap }),
        }
    }
}
