//! Contact points of every kind, in any number, by a primal–dual interior point method on the sparse K (Clarabel: Goulart
//! & Chen 2024).
//!
//! The problem is posed as it stands: min ½uᵀKu − fᵀu + Σ ½k t² subject to r·u ≤ d at rigid points, r·u − t ≤ d at elastic
//! ones, and equations at two-sided ones. The multipliers are the reactions. Its answer is good to about eight digits:
//! enough for the contact set, from which [`ContactProblem::solve_by_interior_point`] goes on with refined figures.

mod program;

use super::problem::{Constraints, ContactProblem};
use super::solution::{ContactSolution, Outcome, Progress};
use super::start::Start;
use crate::assembly::Numbering;
use crate::cholesky::FactorError;
use crate::contact::tolerances;
use crate::plate::Plate;
use crate::residual::{Displacement, Springs};
use clarabel::solver::implementations::default::{DefaultInfo, DefaultSolution};
use clarabel::solver::{
    DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, SupportedConeT, ZeroConeT,
};
use program::Program;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

/// What the interior point method found; NaN and all open unless solved.
#[derive(Clone, Debug)]
pub struct InteriorPoint {
    pub outcome: Outcome,
    /// Over all dofs.
    pub displacement: Vec<f64>,
    /// Force of every contact point, against its row.
    pub reaction: Vec<f64>,
    /// Points whose reaction outweighs their gap.
    pub closed: Vec<bool>,
    pub iterations: usize,
}

/// So little added needs refinement for as long as each step leaves less than the one before: Clarabel's own 10 steps, each
/// to a fifth, end the last iterations before a proof of infeasibility is sharp.
const REFINEMENTS: u32 = 50;

/// Solves for one load with the held dofs at `held_value` (both over all dofs); `constraints` has every contact point.
///
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
) -> InteriorPoint {
    let numbering = Numbering::new(plate, held, &vec![false; held.len()]);
    let mut displacement = Displacement::zeros(held.len());
    for dof in (0..held.len()).filter(|&dof| held[dof]) {
        displacement.hi[dof] = held_value[dof];
    }
    let program = Program::pose(plate, springs, &numbering, constraints, load, &displacement);
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
        return unsolved(held.len(), constraints, Outcome::Unsolved, 0);
    };
    let iterations = found.iterations as usize;
    if interrupted {
        return unsolved(held.len(), constraints, Outcome::Interrupted, iterations);
    }
    let no_equilibrium = match found.status {
        SolverStatus::PrimalInfeasible => program.gaps_contradict(&found.z),
        SolverStatus::DualInfeasible => program.moves_freely(&found.x),
        _ => false,
    };
    if no_equilibrium {
        return unsolved(held.len(), constraints, Outcome::NoEquilibrium, iterations);
    }
    let is_infeasible = matches!(found.status, SolverStatus::PrimalInfeasible | SolverStatus::DualInfeasible)
        || matches!(found.status, SolverStatus::AlmostPrimalInfeasible | SolverStatus::AlmostDualInfeasible);
    if is_infeasible || found.x.iter().chain(&found.z).any(|value| !value.is_finite()) {
        return unsolved(held.len(), constraints, Outcome::Unsolved, iterations);
    }
    for (column, &dof) in numbering.dof.iter().enumerate() {
        displacement.hi[dof] = program.displacement_unit[column] * found.x[column];
    }
    InteriorPoint {
        outcome: Outcome::Solved,
        displacement: displacement.hi,
        reaction: program.row_of.iter().map(|&row| program.force_unit[row] * found.z[row]).collect(),
        closed: program.closed(&found.x, &found.z, &found.s),
        iterations,
    }
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

fn unsolved(dofs: usize, constraints: &Constraints, outcome: Outcome, iterations: usize) -> InteriorPoint {
    let m = constraints.rows.len();
    let (displacement, reaction) = (vec![f64::NAN; dofs], vec![f64::NAN; m]);
    InteriorPoint { outcome, displacement, reaction, closed: vec![false; m], iterations }
}

impl InteriorPoint {
    fn as_start(&self) -> Start<'_> {
        Start {
            displacement: &self.displacement,
            reaction: &self.reaction,
            closed: &self.closed,
            factored: None,
            balanced: None,
        }
    }
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
        let start = interior_point(&self.plate, &self.springs, &self.held, held_value, &all, load, watch);
        let mut solution = match start.outcome {
            Outcome::Solved => self.solve_from(load, held_value, &start.as_start(), watch)?,
            outcome => self.at_rest(held_value).failed(outcome),
        };
        solution.iterations += start.iterations;
        Ok(solution)
    }
}
