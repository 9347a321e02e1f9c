//! The Newton method for many loads at once: solves with a shared factor are batched.
//!
//! The iteration of a load does not depend on the other loads. So the order of the loads and the number of threads
//! change no bit of a solution.

use super::newton::{Start, newton, system_of};
use crate::cholesky::LANES;
use crate::contact::backend::Augmentation;
use crate::contact::error::SolveError;
use crate::contact::kkt::{Batched, SharedFactor, advance};
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::ContactSolution;

/// Solves many loads (3n,). The iterations start from `start`, the solution of another load, if it is given. `watch` is
/// called repeatedly and cancels by returning false.
pub(in crate::contact) fn solve_together(
    problem: &ContactProblem,
    augmentation: &Augmentation,
    start: Option<&ContactSolution>,
    loads: &[Vec<f64>],
    held_value: &[f64],
    watch: &mut dyn FnMut() -> bool,
) -> Result<Vec<Result<ContactSolution, SolveError>>, SolveError> {
    let system = start.and_then(|start| system_of(problem, start)).map_or(&problem.base, |system| system);
    let mut waiting = loads.iter().enumerate().map(|(number, nodal)| {
        // The solution without load is the plate at rest. Only an iteration that starts at rest gives it without
        // rounding.
        let is_loaded = nodal.iter().any(|&force| force != 0.0);
        let solution = start.filter(|_| is_loaded);
        let factor = SharedFactor::default();
        let shared = (is_loaded || start.is_none()).then(|| factor.clone());
        let load = Load { nodal, held_value };
        let start = Start { problem, augmentation, load, solution, shared };
        let method = Box::pin(async { newton(start, &mut |_| true).await.map(|(solution, _)| solution) });
        Batched { number, method, factor }
    });
    let mut solved: Vec<Option<Result<ContactSolution, SolveError>>> = loads.iter().map(|_| None).collect();
    let mut under_way = Vec::with_capacity(LANES);
    loop {
        under_way.extend(waiting.by_ref().take(LANES - under_way.len()));
        if under_way.is_empty() {
            return Ok(solved.into_iter().flatten().collect());
        }
        if !watch() {
            return Err(SolveError::Cancelled);
        }
        for (number, result) in advance(problem, system, &mut under_way)? {
            solved[number] = match result {
                Err(error) if !error.is_of_load() => return Err(error),
                result => Some(result),
            };
        }
    }
}
