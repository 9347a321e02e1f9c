//! Lemke's algorithm on the condensed points: finitely many pivots from piece to piece.

use super::finder::{SetFinder, signs_are_feasible};
use crate::cholesky::FactorError;
use crate::contact::interface::{Form, PosedLcp, ReducedLoad, Work};
use crate::contact::kkt::{Condensed, Kkt};
use crate::contact::problem::ContactProblem;
use crate::contact::refine::refine;
use crate::contact::residual::{Residual, force_of_settlements};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Outcome, Progress, Watch};
use crate::contact::tolerances;
use crate::lcp::{Lcp, LcpError, LcpStatus, LemkeOptions, lemke_watched};

/// Largest number of contact states.
const STATES: usize = 60;

/// Lemke's algorithm with refinement: where the refined solution violates a bound, the LCP is posed again from there.
pub(in crate::contact) struct Lemke {
    /// The unknowns of the LCP; `None` takes the better conditioned form.
    pub(in crate::contact) form: Option<Form>,
}

impl SetFinder for Lemke {
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError> {
        let form = self.form.unwrap_or(problem.interface().better_form());
        let mut first = start.map(|start| start.piece.clone());
        let mut kkt = Condensed::new(problem);
        let mut solution = problem.at_rest(held_value);
        let work = Work::of(&problem.free_motions, load);
        let mut residual = Residual::default();
        let mut reduced = posed_from(problem, load, form, &solution)?;
        let travel = largest(&reduced.rhs.displacement);
        for _ in 0..STATES {
            let posed = problem.interface().lcp(&problem.points, form, &reduced.rhs, &work, &solution.reaction)?;
            let pieces = match pieces_of(problem, &posed, first.take(), &mut solution.pivots, watch)? {
                Ok(pieces) => pieces,
                Err(outcome) => return Ok(solution.failed(outcome)),
            };
            let settled = solution.corrections > 0 && pieces == solution.piece;
            if !settled {
                if !kkt.prepare(&pieces)? {
                    return Ok(solution.failed(Outcome::Unsolved));
                }
                let before = solution.reaction.clone();
                solution.put_on(&problem.points, pieces);
                residual = Residual::of(problem, load, &solution);
                // If no reaction changed, the right-hand side is that of the LCP.
                kkt.reduced = (solution.reaction == before).then(|| {
                    reduced.rhs.violation.clone_from(&residual.violation);
                    reduced
                });
                let Some(last) = refine(problem, load, 0.0, &mut kkt, residual, &mut solution)? else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                residual = last;
            }
            solution.measure_gaps(&problem.points, &residual);
            if settled || signs_are_feasible(problem, load, tolerances::RESIDUAL * travel, &solution) {
                // A contact state that only rounding keeps regular has no solution. Where no load acts, the rounding of
                // settlements is the reference.
                let least = f64::EPSILON * force_of_settlements(problem, held_value);
                let is_solved = residual.is_solved(problem, load, &solution, least);
                return Ok(if is_solved { solution.solved() } else { solution.failed(Outcome::Unsolved) });
            }
            reduced = posed_from(problem, load, form, &solution)?;
        }
        Ok(solution.failed(Outcome::Unsolved))
    }
}

/// The right-hand side of the LCP for a load and a solution, with violations relative to the first pieces.
pub(in crate::contact) fn posed_from(
    problem: &ContactProblem,
    load: &[f64],
    form: Form,
    solution: &ContactSolution,
) -> Result<ReducedLoad, FactorError> {
    let pieces = problem.interface().first_pieces(&problem.points, form);
    problem.reduced(&Residual::from(problem, load, solution, &pieces), form)
}

/// The contact state that solves an LCP, from a given one if any, or the reason why there is none; adds to the number
/// of pivots.
pub(in crate::contact) fn pieces_of(
    problem: &ContactProblem,
    posed: &PosedLcp,
    from: Option<Vec<u8>>,
    pivots: &mut usize,
    watch: &mut Watch<'_>,
) -> Result<Result<Vec<u8>, Outcome>, FactorError> {
    if posed.rows.is_empty() {
        return Ok(Ok(posed.pieces(&[])));
    }
    let covering = covering(problem, posed);
    let options = LemkeOptions { covering: Some(&covering), ..LemkeOptions::default() };
    let basis = from.map(|pieces| posed.basis(&pieces));
    let mut before = 0;
    let mut tell = |step: usize, residual: f64| {
        let changing = step - std::mem::replace(&mut before, step);
        watch(Progress { step, changing, residual })
    };
    let solved =
        Lcp::new(&posed.matrix, &posed.q).and_then(|lcp| lemke_watched(&lcp, &options, basis.as_deref(), &mut tell));
    let Some(end) = in_memory(solved)? else { return Ok(Err(Outcome::Unsolved)) };
    *pivots += end.pivots;
    Ok(ended(end.status).map(|()| posed.pieces(&end.basis)))
}

/// Covering vector (k,): a force for rows whose w is a force, otherwise the length by which that force bends the plate.
/// Lemke's path is then independent of units.
fn covering(problem: &ContactProblem, posed: &PosedLcp) -> Vec<f64> {
    let power_of_two = |x: f64| x.log2().round().exp2();
    let root = power_of_two(problem.scale.stiffness.sqrt());
    let of = |row: &crate::contact::interface::VertexRow| {
        let arm = power_of_two(problem.points.arm[row.point]);
        if row.w_is_a_force(&problem.points) { root * arm } else { 1.0 / (root * arm) }
    };
    posed.rows.iter().map(of).collect()
}

/// Converts the status of an LCP to an outcome.
pub(in crate::contact) fn ended(status: LcpStatus) -> Result<(), Outcome> {
    match status {
        LcpStatus::Solved => Ok(()),
        LcpStatus::Ray => Err(Outcome::NoEquilibrium),
        LcpStatus::PivotLimit => Err(Outcome::Unsolved),
        LcpStatus::Interrupted => Err(Outcome::Interrupted),
    }
}

/// The result of an LCP; `None` where it is numerically singular.
pub(in crate::contact) fn in_memory<T>(solved: Result<T, LcpError>) -> Result<Option<T>, FactorError> {
    match solved {
        Ok(end) => Ok(Some(end)),
        Err(LcpError::OutOfMemory) => Err(FactorError::OutOfMemory),
        Err(_) => Ok(None),
    }
}
