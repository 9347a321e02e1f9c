//! Solution of one load: displacements, reactions and gaps.

use super::finders::{ActiveSet, Lemke, SetFinder, posed_from, solve_together, solved_and_factored};
use super::interface::{Form, PosedLcp, Work};
use super::kkt::{Condensed, Factored, Kkt};
use super::problem::ContactProblem;
use super::refine::refine;
use super::residual::Residual;
use super::scale::largest;
use super::solution::{ContactSolution, Outcome, Watch};
use super::tolerances;
use crate::cholesky::FactorError;

impl ContactProblem {
    /// Solves for a nodal load (3n,) with the held dofs at `held_value` (3n,). A `start` gives the first contact state;
    /// the Newton method starts from its displacements and reactions, too.
    ///
    /// `form` chooses the unknowns of the LCP; `None` takes the better conditioned form.
    pub fn solve(
        &self,
        load: &[f64],
        held_value: &[f64],
        form: Option<Form>,
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError> {
        self.finder(form).find(self, load, held_value, start, watch)
    }

    /// The method for which the plate is factored.
    pub(super) fn finder(&self, form: Option<Form>) -> Box<dyn SetFinder> {
        if self.interface.is_some() { Box::new(Lemke { form }) } else { Box::new(ActiveSet) }
    }

    /// The linear equations of a fixed contact state: condensed, or with springs in the factor.
    pub(super) fn kkt(&self) -> Box<dyn Kkt + '_> {
        match self.interface {
            Some(_) => Box::new(Condensed::new(self)),
            None => Box::new(Factored::new(self, None, tolerances::newton::STIFFEST, false)),
        }
    }

    /// Solves one load for a fixed contact state. Points may violate the bounds of their pieces.
    pub fn solve_on(&self, load: &[f64], held_value: &[f64], pieces: &[u8]) -> Result<ContactSolution, FactorError> {
        self.solve_with(&mut *self.kkt(), load, held_value, pieces, None, 0.0)
    }

    /// Solves as [`ContactProblem::solve_on`] with equations that may be reused, from a `start` if given. Forces far
    /// below `least` count as rounding.
    pub(super) fn solve_with(
        &self,
        kkt: &mut dyn Kkt,
        load: &[f64],
        held_value: &[f64],
        pieces: &[u8],
        start: Option<&ContactSolution>,
        least: f64,
    ) -> Result<ContactSolution, FactorError> {
        let mut solution = self.at_rest(held_value);
        if let Some(start) = start {
            solution.displacement.clone_from(&start.displacement);
            solution.reaction.clone_from(&start.reaction);
        }
        if !kkt.prepare(pieces)? {
            return Ok(solution.failed(Outcome::Unsolved));
        }
        solution.put_on(&self.points, pieces.to_vec());
        let residual = Residual::of(self, load, &solution);
        let Some(last) = refine(self, load, least, kkt, residual, &mut solution)? else {
            return Ok(solution.failed(Outcome::Unsolved));
        };
        solution.measure_gaps(&self.points, &last);
        let is_solved = last.is_solved(self, load, &solution, least);
        Ok(if is_solved { solution.solved() } else { solution.failed(Outcome::Unsolved) })
    }

    /// Residuals of a solution: nodal forces (3n,) relative to the largest force, and distances of points from their
    /// pieces (m,), relative to the largest force (or the force that bends the plate) or to the largest travel.
    ///
    /// It calls no solver.
    pub fn violations(&self, load: &[f64], solution: &ContactSolution) -> (Vec<f64>, Vec<f64>) {
        let residual = Residual::of(self, load, solution);
        let travel = self.points.travel_from(&vec![0.0; self.points.len()], &solution.displacement);
        let bending = self.scale.stiffness * largest(&solution.displacement.hi);
        let force = largest(&solution.reaction).max(largest(load)).max(bending).max(f64::MIN_POSITIVE);
        let length = largest(&travel).max(largest(&self.points.shift)).max(f64::MIN_POSITIVE);
        let off = |i: usize| {
            let (piece, ends) = (self.points.piece(i, solution.piece[i]), self.points.ends(i, solution.piece[i]));
            let (value, axis, size) =
                if piece.holds() { (solution.reaction[i], 1, force) } else { (travel[i], 0, length) };
            let beside = match piece.holds() {
                true => residual.violation[i].abs() / length,
                false => (solution.reaction[i] - piece.force).abs() / force,
            };
            let below = ends[0].map_or(0.0, |end| (end[axis] - value) / size);
            let above = ends[1].map_or(0.0, |end| (value - end[axis]) / size);
            beside.max(below).max(above)
        };
        let points = (0..self.points.len()).map(off).collect();
        (residual.imbalance.iter().map(|f| f / force).collect(), points)
    }

    /// Solves one load and factors its contact state, for warm starts; `None` where points are condensed, where there
    /// is no solution, or where that state does not hold the plate.
    pub fn solve_and_factor(
        &self,
        load: &[f64],
        held_value: &[f64],
        watch: &mut Watch<'_>,
    ) -> Result<Option<ContactSolution>, FactorError> {
        if self.interface.is_some() { Ok(None) } else { solved_and_factored(self, load, held_value, watch) }
    }

    /// Solves many loads (3n,) as [`ContactProblem::solve`], by the Newton method. `watch` is called at intervals and
    /// cancels by returning false; then solutions are missing.
    pub fn solve_together(
        &self,
        start: Option<&ContactSolution>,
        loads: &[Vec<f64>],
        held_value: &[f64],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<ContactSolution>, FactorError> {
        solve_together(self, start, loads, held_value, watch)
    }

    /// The first LCP of [`ContactProblem::solve`] where points are condensed.
    pub fn lcp(&self, load: &[f64], held_value: &[f64], form: Option<Form>) -> Result<PosedLcp, FactorError> {
        let rest = self.at_rest(held_value);
        let form = form.unwrap_or(self.interface().better_form());
        let reduced = posed_from(self, load, form, &rest)?;
        let work = Work::of(&self.free_motions, load);
        Ok(self.interface().lcp(&self.points, form, &reduced.rhs, &work, &rest.reaction)?)
    }
}
