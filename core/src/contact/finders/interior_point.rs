//! Primal–dual interior point method on the sparse K for any number of points (Clarabel: Goulart & Chen 2024).
//!
//! The convex quadratic program has displacements and travels along pieces as unknowns; its multipliers are the
//! reactions. Its solution has about eight digits. The problem's own method starts from its contact state and refines.

use super::finder::SetFinder;
use super::program::Program;
use crate::assembly::Numbering;
use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Outcome, Progress, Watch};
use crate::contact::tolerances;
use clarabel::solver::implementations::default::{DefaultInfo, DefaultSolution};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT, ZeroConeT,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// Iterative refinement steps: with Clarabel's default of 10 the last iterations end before a proof of infeasibility is
/// sharp.
const REFINEMENTS: u32 = 50;

/// Interior point method, followed by the problem's own method from its contact state.
pub(in crate::contact) struct InteriorPoint;

impl SetFinder for InteriorPoint {
    fn find(
        &self,
        problem: &ContactProblem,
        load: &[f64],
        held_value: &[f64],
        _start: Option<&ContactSolution>,
        watch: &mut Watch<'_>,
    ) -> Result<ContactSolution, FactorError> {
        let near = interior_point(problem, load, held_value, watch);
        if near.outcome != Outcome::Solved {
            return Ok(near);
        }
        let mut solution = problem.finder(None).find(problem, load, held_value, Some(&near), watch)?;
        solution.iterations += near.iterations;
        Ok(solution)
    }
}

/// Displacements and reactions to eight digits, and the contact state; no gaps.
///
/// [`Outcome::NoEquilibrium`] needs a verified proof: a motion without resistance on which the load works, or forces at
/// points that balance each other and contradict the gaps.
fn interior_point(
    problem: &ContactProblem,
    load: &[f64],
    held_value: &[f64],
    watch: &mut Watch<'_>,
) -> ContactSolution {
    let ContactProblem { plate, points, held, .. } = problem;
    let numbering = Numbering::new(plate, &[], held, &vec![false; held.len()]);
    let mut solution = problem.at_rest(held_value);
    let program = Program::pose(problem, &numbering, load, &solution);
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
    let Some((end, interrupted)) = solved(&program, &cones, settings, watch) else {
        return solution.failed(Outcome::Unsolved);
    };
    solution.iterations = end.iterations as usize;
    if interrupted {
        return solution.failed(Outcome::Interrupted);
    }
    let no_equilibrium = match end.status {
        SolverStatus::PrimalInfeasible => program.gaps_contradict(&end.z),
        SolverStatus::DualInfeasible => program.moves_freely(&end.x),
        _ => false,
    };
    if no_equilibrium {
        return solution.failed(Outcome::NoEquilibrium);
    }
    let is_infeasible = matches!(end.status, SolverStatus::PrimalInfeasible | SolverStatus::DualInfeasible)
        || matches!(end.status, SolverStatus::AlmostPrimalInfeasible | SolverStatus::AlmostDualInfeasible);
    if is_infeasible || end.x.iter().chain(&end.z).any(|value| !value.is_finite()) {
        return solution.failed(Outcome::Unsolved);
    }
    for (column, &dof) in numbering.dof.iter().enumerate() {
        solution.displacement.hi[dof] = program.displacement_unit[column] * end.x[column];
    }
    solution.displacement.follow(plate.bodies());
    solution.reaction = program.row_of.iter().map(|&row| program.force_unit[row] * end.z[row]).collect();
    let travel = points.travel_from(&points.shift, &solution.displacement);
    solution.piece = program.pieces(points, &travel, &solution.reaction, &end.z);
    ContactSolution { outcome: Outcome::Solved, ..solution }
}

/// Solves in a thread of its own, since clarabel's callback outlives the borrow; returns whether it was cancelled,
/// `None` if clarabel rejects the problem.
fn solved(
    program: &Program,
    cones: &[SupportedConeT<f64>],
    settings: DefaultSettings<f64>,
    watch: &mut Watch<'_>,
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
