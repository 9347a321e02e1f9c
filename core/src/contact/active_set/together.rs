//! Many loads side by side: what their directions ask of one factor is solved together, so that it is read once for all.
//!
//! Each goes on as if it were alone, in parallel with the others, so that neither order nor number of threads changes a bit.

use super::newton::{Newton, Next};
use crate::cholesky::{FactorError, LANES};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::{ContactSolution, Outcome, Reference, Start};
use rayon::prelude::*;

/// Loads that are under way at once.
const AT_ONCE: usize = LANES;

/// A load under way: its number, and what it was answered.
struct UnderWay<'a> {
    number: usize,
    newton: Newton<'a>,
    answer: Option<Vec<f64>>,
}

impl ContactProblem {
    /// As [`ContactProblem::solve`], for many loads (3n,) each, beginning with the reference if there is one.
    ///
    /// There must be an active set. `watch` is asked now and then and ends it by returning false; then answers are missing.
    pub fn solve_together(
        &self,
        reference: Option<&Reference>,
        loads: &[Vec<f64>],
        held_value: &[f64],
        watch: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<ContactSolution>, FactorError> {
        let start = reference.map(Reference::start);
        let with = start.as_ref().and_then(|start| start.factored).unwrap_or(&self.base);
        let mut under_way: Vec<UnderWay> = Vec::with_capacity(AT_ONCE);
        let mut left = loads.iter().enumerate();
        let mut solved: Vec<Option<ContactSolution>> = loads.iter().map(|_| None).collect();
        loop {
            let next: Vec<(usize, &Vec<f64>)> = left.by_ref().take(AT_ONCE - under_way.len()).collect();
            let begun: Vec<(usize, Option<Newton>)> = next
                .into_par_iter()
                .map(|(number, load)| Ok((number, self.begun(load, held_value, start.as_ref())?)))
                .collect::<Result<_, FactorError>>()?;
            for (number, newton) in begun {
                match newton {
                    Some(newton) => under_way.push(UnderWay { number, newton, answer: None }),
                    None => solved[number] = Some(self.unanswered(held_value, Outcome::Unsolved)),
                }
            }
            if under_way.is_empty() && left.len() == 0 || !watch() {
                return Ok(solved.into_iter().flatten().collect());
            }
            // Each goes on until it waits for the factor again, or ends; one that does not share it goes on to the end.
            let went = under_way.into_par_iter().map(|mut load| {
                let next = load.newton.go_on(load.answer.take(), &mut |_| true);
                (load, next)
            });
            let went: Vec<_> = went.collect();
            under_way = Vec::with_capacity(AT_ONCE);
            let mut block: Vec<f64> = Vec::new();
            for (load, next) in went {
                match next? {
                    Next::Solve(vector) => {
                        block.extend(vector);
                        under_way.push(load);
                    }
                    Next::End(outcome) => solved[load.number] = Some(load.newton.ended(outcome)),
                }
            }
            with.solve_side_by_side(&mut block)?;
            for (load, answer) in under_way.iter_mut().zip(block.chunks_exact(with.factor.len())) {
                load.answer = Some(answer.to_vec());
            }
        }
    }

    fn begun<'a>(
        &'a self,
        load: &'a [f64],
        held_value: &[f64],
        start: Option<&Start<'a>>,
    ) -> Result<Option<Newton<'a>>, FactorError> {
        let referred = start.is_some();
        // Without a load the plate is at rest, exactly so only if it begins there.
        let start = start.filter(|_| load.iter().any(|&force| force != 0.0));
        let shares = self.constraints.rows.is_empty() && start.is_some() == referred;
        self.newton(load, held_value, start, shares)
    }
}
