//! Lemke's algorithm on the condensed points: pivots from piece to piece, finitely many of them.

use super::finder::{SetFinder, signs_hold};
use crate::cholesky::FactorError;
use crate::contact::interface::{Form, PosedLcp, Reduced, Work};
use crate::contact::kkt::{Condensed, Kkt};
use crate::contact::problem::ContactProblem;
use crate::contact::refine::refine;
use crate::contact::residual::{Residual, force_of_settlements};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Outcome, Progress, Watch};
use crate::contact::tolerances;
use crate::lcp::{Lcp, LcpError, LcpStatus, LemkeOptions, lemke_watched};

/// At most this many sets of pieces.
const STATES: usize = 60;

/// Lemke's algorithm, refined: where the refined solution shows a point beyond its piece, the LCP is posed anew from there.
pub(in crate::contact) struct Lemke {
    /// The unknowns of the LCP; those of the better conditioned form if `None`.
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
        let travel = largest(&reduced.at_points.displacement);
        for _ in 0..STATES {
            let posed =
                problem.interface().lcp(&problem.points, form, &reduced.at_points, &work, &solution.reaction)?;
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
                // Where nothing was let go the right-hand side is the one that the LCP was posed with.
                kkt.reduced = (solution.reaction == before).then(|| {
                    reduced.at_points.violation.clone_from(&residual.violation);
                    reduced
                });
                let Some(last) = refine(problem, load, 0.0, &mut kkt, residual, &mut solution)? else {
                    return Ok(solution.failed(Outcome::Unsolved));
                };
                residual = last;
            }
            solution.measure_gaps(&problem.points, &residual);
            if settled || signs_hold(problem, load, tolerances::RESIDUAL * travel, &solution) {
                // Pieces whose equations only rounding keeps regular have no solution. What settlements leave by rounding,
                // where nothing else acts, is none of their fault.
                let least = f64::EPSILON * force_of_settlements(problem, held_value);
                let is_solved = residual.is_solved(problem, load, &solution, least);
                return Ok(if is_solved { solution.solved() } else { solution.failed(Outcome::Unsolved) });
            }
            reduced = posed_from(problem, load, form, &solution)?;
        }
        Ok(solution.failed(Outcome::Unsolved))
    }
}

/// What a load and a solution do at the points, with violations of the pieces that the LCP begins with.
pub(in crate::contact) fn posed_from(
    problem: &ContactProblem,
    load: &[f64],
    form: Form,
    solution: &ContactSolution,
) -> Result<Reduced, FactorError> {
    let pieces = problem.interface().first_pieces(&problem.points, form);
    problem.reduced(&Residual::from(problem, load, solution, &pieces), form)
}

/// The pieces that solve an LCP, from some on if there are any, or why there are none; adds to the pivots.
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

/// A covering vector (k,): of rows whose w is a reaction, a force, else the length by which that bends the plate, so that
/// Lemke's path does not depend on units.
fn covering(problem: &ContactProblem, posed: &PosedLcp) -> Vec<f64> {
    let power_of_two = |x: f64| x.log2().round().exp2();
    let root = power_of_two(problem.scale.stiffness.sqrt());
    let of = |row: &crate::contact::interface::VertexRow| {
        let arm = power_of_two(problem.points.arm[row.point]);
        if row.w_is_a_force(&problem.points) { root * arm } else { 1.0 / (root * arm) }
    };
    posed.rows.iter().map(of).collect()
}

/// Whether an LCP ended at a basis, or what else it is.
pub(in crate::contact) fn ended(status: LcpStatus) -> Result<(), Outcome> {
    match status {
        LcpStatus::Solved => Ok(()),
        LcpStatus::Ray => Err(Outcome::NoEquilibrium),
        LcpStatus::PivotLimit => Err(Outcome::Unsolved),
        LcpStatus::Interrupted => Err(Outcome::Interrupted),
    }
}

/// What an LCP came to; `None` where its numbers are beyond the arithmetic.
pub(in crate::contact) fn in_memory<T>(solved: Result<T, LcpError>) -> Result<Option<T>, FactorError> {
    match solved {
        Ok(end) => Ok(Some(end)),
        Err(LcpError::OutOfMemory) => Err(FactorError::OutOfMemory),
        Err(_) => Ok(None),
    }
}
