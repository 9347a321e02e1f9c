//! From a load to displacements, reactions and gaps.

use super::finders::{ActiveSet, InteriorPoint, Lemke, SetFinder, posed_from, solve_together, solved_and_factored};
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
    /// Displacements, reactions and gaps under a nodal load with the held dofs at `held_value`, both over all dofs, beginning
    /// with a solution's pieces, and in an active set with its displacement and reactions, if there is one.
    ///
    /// `form` chooses the unknowns of the LCP; the better conditioned one if `None`.
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

    /// The method that the plate is factored for.
    pub(super) fn finder(&self, form: Option<Form>) -> Box<dyn SetFinder> {
        if self.interface.is_some() { Box::new(Lemke { form }) } else { Box::new(ActiveSet) }
    }

    /// The equations of given pieces: condensed, or with springs in the factor.
    pub(super) fn kkt(&self) -> Box<dyn Kkt + '_> {
        match self.interface {
            Some(_) => Box::new(Condensed::new(self)),
            None => Box::new(Factored::new(self, None, tolerances::newton::STIFFEST, false)),
        }
    }

    /// The same under one load, by an interior point method, from whose pieces the exact ones are sought.
    pub fn solve_by_interior_point(
        &self,
        load: &[f64],
        held_value: &[f64],
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError> {
        InteriorPoint.find(self, load, held_value, None, watch)
    }

    /// Displacements, reactions and gaps under one load on pieces that are given, beyond whose ends points may be.
    pub fn solve_on(&self, load: &[f64], held_value: &[f64], pieces: &[u8]) -> Result<ContactSolution, FactorError> {
        self.solve_with(&mut *self.kkt(), load, held_value, pieces, None, 0.0)
    }

    /// As [`ContactProblem::solve_on`], with equations that have solved others before, from another solution if there is one;
    /// forces far below `least` are rounding.
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

    /// What a solution leaves of the conditions: nodal forces out of balance (3n,), and by how much points are off their
    /// pieces (m,), beyond an end or beside the line, each over the largest force, or what bends the plate, or travel.
    ///
    /// It asks no solver.
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

    /// Solves one load and factors its pieces, for others to begin with; `None` where points are condensed, there is no
    /// solution, or its pieces do not hold the plate.
    pub fn solve_and_factor(
        &self,
        load: &[f64],
        held_value: &[f64],
        watch: &mut Watch<'_>,
    ) -> Result<Option<ContactSolution>, FactorError> {
        if self.interface.is_some() { Ok(None) } else { solved_and_factored(self, load, held_value, watch) }
    }

    /// As [`ContactProblem::solve`], for many loads (3n,) each, by an active set. `watch` is asked now and then and ends it
    /// by returning false; then answers are missing.
    pub fn solve_together(
        &self,
        start: Option<&ContactSolution>,
        loads: &[Vec<f64>],
        held_value: &[f64],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<ContactSolution>, FactorError> {
        solve_together(self, start, loads, held_value, watch)
    }

    /// The LCP that [`ContactProblem::solve`] poses first; points are condensed.
    pub fn lcp(&self, load: &[f64], held_value: &[f64], form: Option<Form>) -> Result<PosedLcp, FactorError> {
        let rest = self.at_rest(held_value);
        let form = form.unwrap_or(self.interface().better_form());
        let reduced = posed_from(self, load, form, &rest)?;
        let work = Work::of(&self.free_motions, load);
        Ok(self.interface().lcp(&self.points, form, &reduced.at_points, &work, &rest.reaction)?)
    }
}
