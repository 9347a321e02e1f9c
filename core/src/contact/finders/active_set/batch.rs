//! Many loads at once: solves with a shared factor are batched, so that the factor is read once for all of them.
//!
//! Each load iterates independently and in parallel, so that order and number of threads change no bit.

use super::newton::{Newton, Next};
use super::start::{new_newton, system_of};
use crate::cholesky::{FactorError, LANES};
use crate::contact::backend::Augmentation;
use crate::contact::error::SolveError;
use crate::contact::load::Load;
use crate::contact::problem::ContactProblem;
use crate::contact::solution::ContactSolution;
use rayon::prelude::*;

/// Number of loads in one batch.
const AT_ONCE: usize = LANES;

/// A load of the batch: its index, its iteration, and the solution by the shared factor.
struct UnderWay<'a> {
    number: usize,
    newton: Newton<'a>,
    answer: Option<Vec<f64>>,
}

/// Solves many loads (3n,), from the solution of another load if given. `watch` is called repeatedly and cancels by
/// returning false.
pub(in crate::contact) fn solve_together(
    problem: &ContactProblem,
    augmentation: &Augmentation,
    start: Option<&ContactSolution>,
    loads: &[Vec<f64>],
    held_value: &[f64],
    watch: &mut dyn FnMut() -> bool,
) -> Result<Vec<Result<ContactSolution, SolveError>>, SolveError> {
    let with = start.and_then(|start| system_of(problem, start)).map_or(&problem.base, |system| system);
    let pattern = &problem.pattern;
    let mut under_way: Vec<UnderWay> = Vec::with_capacity(AT_ONCE);
    let mut waiting = loads.iter().enumerate();
    let mut solved: Vec<Option<Result<ContactSolution, SolveError>>> = loads.iter().map(|_| None).collect();
    loop {
        let next: Vec<(usize, &Vec<f64>)> = waiting.by_ref().take(AT_ONCE - under_way.len()).collect();
        let begun: Vec<UnderWay> = next
            .into_par_iter()
            .map(|(number, load)| {
                // Without load the plate is at rest; only a start at rest gives that exactly.
                let loaded = load.iter().any(|&force| force != 0.0);
                let shares = loaded || start.is_none();
                let load = Load { nodal: load, held_value };
                let newton = new_newton(problem, augmentation, &load, start.filter(|_| loaded), shares)?;
                Ok(UnderWay { number, newton, answer: None })
            })
            .collect::<Result<_, FactorError>>()?;
        under_way.extend(begun);
        if under_way.is_empty() && waiting.len() == 0 {
            return Ok(solved.into_iter().flatten().collect());
        }
        if !watch() {
            return Err(SolveError::Cancelled);
        }
        // Each load iterates until it needs the shared factor, or ends. A load whose contact state was factored
        // iterates to the end.
        let went = under_way.into_par_iter().map(|mut load| {
            let mut next = load.newton.go_on(load.answer.take(), &mut |_| true);
            while let Ok(Next::Settled) = next {
                next = load.newton.go_on(None, &mut |_| true);
            }
            (load, next)
        });
        let went: Vec<_> = went.collect();
        under_way = Vec::with_capacity(AT_ONCE);
        let mut block: Vec<f64> = Vec::new();
        for (load, next) in went {
            match next? {
                Next::Solve(force) => {
                    block.extend(pattern.gather(&force));
                    under_way.push(load);
                }
                Next::Settled => unreachable!("the load went on"),
                Next::End(end) => solved[load.number] = Some(load.newton.ended(end)),
            }
        }
        with.factor.solve_side_by_side(&mut block)?;
        for (load, answer) in under_way.iter_mut().zip(block.chunks_exact(with.factor.len())) {
            load.answer = Some(pattern.scatter(answer, problem.plate.dof_count()));
        }
    }
}
