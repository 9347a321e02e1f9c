//! Contact points of every kind, in any number, by a primal–dual interior point method on the sparse K (Clarabel: Goulart
//! & Chen 2024).
//!
//! The problem is posed as it stands: min ½uᵀKu − fᵀu + Σ ½k t² subject to r·u ≤ d at rigid points, r·u − t ≤ d at elastic
//! ones, and equations at two-sided ones. The multipliers are the reactions. Its answer is good to about eight digits:
//! enough for the contact set, from which [`ContactProblem::solve_by_interior_point`] goes on with refined figures.

mod program;

use super::points::Constraints;
use super::problem::ContactProblem;
use super::solution::{ContactSolution, Outcome, Progress, Start, held_at};
use crate::assembly::Numbering;
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::plate::Plate;
use crate::rows::Springs;
use clarabel::solver::implementations::default::{DefaultInfo, DefaultSolution};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT, ZeroConeT,
};
use program::Program;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// So little added needs refinement for as long as each step leaves less than the one before: Clarabel's own 10 steps, each
/// to a fifth, end the last iterations before a proof of infeasibility is sharp.
const REFINEMENTS: u32 = 50;

/// Solves for one load with the held dofs at `held_value` (both over all dofs); `constraints` has every contact point.
///
/// Points are closed whose reaction outweighs their gap; no gaps are told.
/// [`Outcome::NoEquilibrium`] is returned on a proof that was checked: either a motion that no support resists and on
/// which the load works, or forces at rigid points that balance each other and that their gaps cannot do without.
pub fn interior_point(
    plate: &Plate,
    springs: &Springs,
    held: &[bool],
    held_value: &[f64],
    constraints: &Constraints,
    load: &[f64],
    watch: &mut dyn FnMut(Progress) -> bool,
) -> ContactSolution {
    let numbering = Numbering::new(plate, held, &vec![false; held.len()]);
    let m = constraints.rows.len();
    let displacement = held_at(held, held_value);
    let program = Program::pose(plate, springs, &numbering, constraints, load, &displacement);
    let mut solution = ContactSolution {
        displacement,
        reaction: vec![0.0; m],
        gap: vec![f64::NAN; m],
        closed: vec![false; m],
        ..Default::default()
    };
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: 0.0,
        tol_gap_rel: tolerances::interior_point::GAP,
        tol_feas: tolerances::interior_point::GAP,
        tol_infeas_rel: tolerances::interior_point::GAP,
        max_threads: 1,
        static_regularization_constant: tolerances::interior_point::REGULARIZATION,
        iterative_refinement_max_iter: REFINEMENTS,
        iterative_refinement_stop_ratio: tolerances::interior_point::REFINING,
        ..DefaultSettings::default()
    };
    let cones = [ZeroConeT(program.equations), NonnegativeConeT(program.right.len() - program.equations)];
    let Some((found, interrupted)) = solved(&program, &cones, settings, watch) else {
        return solution.failed(Outcome::Unsolved);
    };
    solution.iterations = found.iterations as usize;
    if interrupted {
        return solution.failed(Outcome::Interrupted);
    }
    let no_equilibrium = match found.status {
        SolverStatus::PrimalInfeasible => program.gaps_contradict(&found.z),
        SolverStatus::DualInfeasible => program.moves_freely(&found.x),
        _ => false,
    };
    if no_equilibrium {
        return solution.failed(Outcome::NoEquilibrium);
    }
    let is_infeasible = matches!(found.status, SolverStatus::PrimalInfeasible | SolverStatus::DualInfeasible)
        || matches!(found.status, SolverStatus::AlmostPrimalInfeasible | SolverStatus::AlmostDualInfeasible);
    if is_infeasible || found.x.iter().chain(&found.z).any(|value| !value.is_finite()) {
        return solution.failed(Outcome::Unsolved);
    }
    for (column, &dof) in numbering.dof.iter().enumerate() {
        solution.displacement.hi[dof] = program.displacement_unit[column] * found.x[column];
    }
    solution.reaction = program.row_of.iter().map(|&row| program.force_unit[row] * found.z[row]).collect();
    solution.closed = program.closed(&found.x, &found.z, &found.s);
    ContactSolution { outcome: Outcome::Solved, ..solution }
}

/// Solves in a thread of its own, since clarabel keeps whom it tells of its iterations, and whether it was interrupted;
/// `None` if it does not take the problem.
fn solved(
    program: &Program,
    cones: &[SupportedConeT<f64>],
    settings: DefaultSettings<f64>,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Option<(DefaultSolution<f64>, bool)> {
    let Program { quadratic, linear, rows, right, .. } = program;
    let mut solver = DefaultSolver::new(quadratic, linear, rows, right, cones, settings).ok()?;
    let stopped = Arc::new(AtomicBool::new(false));
    let (news, heard) = mpsc::channel();
    let seen = stopped.clone();
    solver.set_termination_callback(move |info: &DefaultInfo<f64>| {
        let step = info.iterations as usize;
        let told = news.send(Progress { step, changing: 0, residual: info.res_primal.max(info.res_dual) });
        told.is_err() || seen.load(Ordering::Relaxed)
    });
    let solution = std::thread::scope(|scope| {
        let solving = scope.spawn(move || {
            solver.solve();
            solver.unset_termination_callback();
            solver.solution
        });
        for now in heard {
            if !watch(now) {
                stopped.store(true, Ordering::Relaxed);
            }
        }
        solving.join().ok()
    })?;
    Some((solution, stopped.load(Ordering::Relaxed)))
}

impl ContactProblem {
    /// As [`ContactProblem::solve`], with the contact set of an interior point method to begin with.
    ///
    /// Where that set is right Lemke's algorithm makes no pivot, or the active set no step but refinements; where it is
    /// nearly right, a few.
    pub fn solve_by_interior_point(
        &self,
        load: &[f64],
        held_value: &[f64],
        watch: &mut dyn FnMut(Progress) -> bool,
    ) -> Result<ContactSolution, FactorError> {
        let all = self.all_constraints();
        let found = interior_point(&self.plate, &self.springs, &self.held, held_value, &all, load, watch);
        let start = Start { solution: &found, factored: None, reference: None };
        let mut solution = match found.outcome {
            Outcome::Solved => self.solve_from(load, held_value, None, Some(&start), watch)?,
            outcome => self.unanswered(held_value, outcome),
        };
        solution.iterations += found.iterations;
        Ok(solution)
    }
}
