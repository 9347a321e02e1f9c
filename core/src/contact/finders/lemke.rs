//! Lemke's algorithm on the condensed points. It finds the contact state by finitely many pivots.

use super::feasibility::beyond_rounding;
use crate::cholesky::FactorError;
use crate::contact::error::SolveError;
use crate::contact::interface::{Form, Interface, LcpTemplate, ReducedLoad, VertexRow, Work};
use crate::contact::kkt::{Condensed, Kkt};
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::refine::refine;
use crate::contact::residual::{Residual, force_of_settlements};
use crate::contact::scale::largest;
use crate::contact::solution::{ContactSolution, Progress, Watch};
use crate::contact::tolerances;
use crate::lcp::{Lcp, LemkeOptions, lemke_watched};

/// Largest number of LCPs that are posed for one load. The solution on the contact state of each LCP is refined.
const STATES: usize = 60;

/// Solves one load by Lemke's algorithm and refines the solution. If a point of the refined solution is beyond a bound
/// of its piece of the law, a new LCP is posed from this solution.
pub(in crate::contact) fn by_lemke(
    problem: &ContactProblem,
    interface: &Interface,
    form: Form,
    &Load { nodal: load, held_value }: &Load,
    start: Option<&ContactSolution>,
    watch: &mut Watch<'_>,
) -> Result<ContactSolution, SolveError> {
    let mut first = start.map(|start| start.piece.clone());
    let template = problem.lcp_template(form)?;
    let mut kkt = Condensed::new(problem, interface);
    let mut solution = problem.at_rest(held_value);
    let work = Work::of(&interface.free_motions, load);
    let mut residual = Residual::default();
    let mut reduced = posed_from(problem, interface, load, form, &solution)?;
    let travel = largest(&reduced.rhs.displacement);
    for _ in 0..STATES {
        let q = template.balanced_q(interface, &problem.points, &reduced.rhs, &work, &solution.reaction)?;
        let pieces = pieces_of(problem, template, &q, first.take(), &mut solution.pivots, watch)?;
        let settled = solution.corrections > 0 && pieces == solution.piece;
        if !settled {
            if !kkt.prepare(&pieces)? {
                return Err(SolveError::Unsolved);
            }
            let before = solution.reaction.clone();
            solution.put_on(&problem.points, pieces);
            residual = Residual::of(problem, load, &solution);
            // If the new contact state changed no reaction, the right-hand side of the LCP also serves for the first
            // correction of the refinement.
            kkt.reduced = (solution.reaction == before).then(|| {
                reduced.rhs.violation.clone_from(&residual.violation);
                reduced
            });
            residual = refine(problem, load, 0.0, &mut kkt, residual, &mut solution)?.ok_or(SolveError::Unsolved)?;
        }
        solution.measure_gaps(&problem.points, &residual);
        if settled || beyond_rounding(problem, load, tolerances::RESIDUAL * travel, &solution).is_empty() {
            // Refuses a solution with a large residual: the equations of its contact state are singular, and only
            // rounding made their solution possible. Without load, the residual is relative to the rounding of the
            // forces that settlements cause.
            let least = f64::EPSILON * force_of_settlements(problem, held_value);
            return solution.require_solved(problem, load, &residual, least);
        }
        reduced = posed_from(problem, interface, load, form, &solution)?;
    }
    Err(SolveError::Unsolved)
}

/// The residual of `solution` under a load, condensed onto the contact points: the right-hand side of the LCP for the
/// remaining change of the solution. Violations are distances to the first pieces of the laws, on which the LCP starts.
pub(in crate::contact) fn posed_from(
    problem: &ContactProblem,
    interface: &Interface,
    load: &[f64],
    form: Form,
    solution: &ContactSolution,
) -> Result<ReducedLoad, FactorError> {
    let pieces = interface.first_pieces(&problem.points, form);
    problem.reduced(interface, &Residual::from(problem, load, solution, &pieces), form)
}

/// The contact state (m,) that solves the LCP with the vector `q`. If a contact state `from` is given, pivoting starts
/// at its basis. The number of pivots is added to `pivots`.
pub(in crate::contact) fn pieces_of(
    problem: &ContactProblem,
    template: &LcpTemplate,
    q: &[f64],
    from: Option<Vec<u8>>,
    pivots: &mut usize,
    watch: &mut Watch<'_>,
) -> Result<Vec<u8>, SolveError> {
    let LcpTemplate { matrix, vertices, .. } = template;
    if q.is_empty() {
        return Ok(vertices.pieces(&[]));
    }
    let covering = covering(problem, &vertices.rows);
    let options = LemkeOptions { covering: Some(&covering), ..LemkeOptions::default() };
    let basis = from.map(|pieces| vertices.basis(&pieces));
    let mut before = 0;
    let mut tell = |step: usize, residual: f64| {
        let changing = step - std::mem::replace(&mut before, step);
        watch(Progress { step, changing, residual })
    };
    let lcp = Lcp::new(matrix, q)?;
    let end = lemke_watched(&lcp, &options, basis.as_deref(), &mut tell)?;
    *pivots += end.pivots;
    SolveError::of(end.status)?;
    Ok(vertices.pieces(&end.basis))
}

/// Covering vector d (k,): a force for each row whose w is a force, otherwise the deflection of the plate under this
/// force. The path of Lemke's algorithm then does not depend on units.
fn covering(problem: &ContactProblem, rows: &[VertexRow]) -> Vec<f64> {
    let power_of_two = |x: f64| x.log2().round().exp2();
    let root = power_of_two(problem.scale.stiffness.sqrt());
    let of = |row: &VertexRow| {
        let arm = power_of_two(problem.points.arm[row.point]);
        if row.w_is_a_force(&problem.points) { root * arm } else { 1.0 / (root * arm) }
    };
    rows.iter().map(of).collect()
}
