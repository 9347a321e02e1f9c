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

/// A load under way: its number, what it asked for and was answered, and its solution once it has one.
struct UnderWay<'a> {
    number: usize,
    newton: Newton<'a>,
    asked: Option<Vec<f64>>,
    answer: Option<Vec<f64>>,
    ended: Option<Result<Outcome, FactorError>>,
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
        let factor = &start.as_ref().and_then(|start| start.factored).unwrap_or(&self.base).factor;
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
                    Some(newton) => under_way.push(UnderWay { number, newton, asked: None, answer: None, ended: None }),
                    None => solved[number] = Some(self.at_rest(held_value).failed(Outcome::Unsolved)),
                }
            }
            if under_way.is_empty() && left.len() == 0 || !watch() {
                return Ok(solved.into_iter().flatten().collect());
            }
            under_way.par_iter_mut().for_each(UnderWay::go_on);
            let (ended, waiting): (Vec<_>, _) = under_way.into_iter().partition(|load| load.ended.is_some());
            under_way = waiting;
            for UnderWay { number, newton, ended, .. } in ended {
                if let Some(outcome) = ended {
                    solved[number] = Some(newton.ended(outcome?));
                }
            }
            let mut block: Vec<f64> = under_way.iter_mut().filter_map(|load| load.asked.take()).flatten().collect();
            factor.solve_side_by_side(&mut block)?;
            for (load, answer) in under_way.iter_mut().zip(block.chunks_exact(factor.len())) {
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

impl UnderWay<'_> {
    /// Goes on until it waits for the factor again, or ends; one that does not share it goes on to the end.
    fn go_on(&mut self) {
        match self.newton.go_on(self.answer.take(), &mut |_| true) {
            Ok(Next::Solve(vector)) => self.asked = Some(vector),
            Ok(Next::End(outcome)) => self.ended = Some(Ok(outcome)),
            Err(error) => self.ended = Some(Err(error)),
        }
    }
}
