//! Many loads side by side: what their descents ask of one factor is solved together, so that it is read once for all.
//!
//! A descent waits at its desk for K̃⁻¹ times a vector; those that have it go on in parallel until they wait again. Each is
//! computed as if it were alone, so that neither order nor number of threads changes a bit.

use super::{Reference, Start};
use crate::cholesky::{Factor, FactorError, LANES};
use crate::contact::problem::ContactProblem;
use crate::contact::solution::ContactSolution;
use rayon::prelude::*;
use std::future::{Future, poll_fn};
use std::mem::replace;
use std::pin::{Pin, pin};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

/// Descents that are under way at once.
const SEATS: usize = LANES;

/// Where one descent asks and is answered.
#[derive(Default)]
pub(super) struct Desk(Mutex<Letter>);

#[derive(Default)]
enum Letter {
    #[default]
    None,
    Asked(Vec<f64>),
    Solved(Vec<f64>),
}

impl Desk {
    fn letter(&self) -> MutexGuard<'_, Letter> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// K̃⁻¹ times a vector in elimination order.
    pub(super) async fn solve(&self, vector: Vec<f64>) -> Vec<f64> {
        *self.letter() = Letter::Asked(vector);
        poll_fn(|_| {
            let mut letter = self.letter();
            match replace(&mut *letter, Letter::None) {
                Letter::Solved(solved) => Poll::Ready(solved),
                waiting => {
                    *letter = waiting;
                    Poll::Pending
                }
            }
        })
        .await
    }

    fn asked(&self) -> Option<Vec<f64>> {
        match replace(&mut *self.letter(), Letter::None) {
            Letter::Asked(vector) => Some(vector),
            _ => None,
        }
    }
}

/// The end of what waits for no one.
pub(super) fn at_once<T>(work: impl Future<Output = T>) -> T {
    match pin!(work).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(done) => done,
        Poll::Pending => unreachable!("only at a desk is there waiting"),
    }
}

type Solved = Result<ContactSolution, FactorError>;

/// A descent, the number of its load, and its answer once it has one.
struct Seat<'a> {
    load: usize,
    descent: Pin<Box<dyn Future<Output = Solved> + Send + 'a>>,
    solved: Option<Solved>,
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
        let desks: Vec<Desk> = (0..SEATS).map(|_| Desk::default()).collect();
        let mut seats: Vec<Option<Seat>> = desks.iter().map(|_| None).collect();
        let mut left = loads.iter().enumerate();
        let mut solved: Vec<Option<ContactSolution>> = loads.iter().map(|_| None).collect();
        loop {
            for (seat, desk) in seats.iter_mut().zip(&desks).filter(|(seat, _)| seat.is_none()) {
                *seat = left.next().map(|(number, load)| self.seat(number, load, held_value, start.as_ref(), desk));
            }
            if seats.iter().all(Option::is_none) || !watch() {
                return Ok(solved.into_iter().flatten().collect());
            }
            seats.par_iter_mut().flatten().for_each(Seat::go_on);
            for seat in &mut seats {
                if let Some(Seat { load, solved: Some(answer), .. }) = seat.take_if(|seat| seat.solved.is_some()) {
                    solved[load] = Some(answer?);
                }
            }
            answer(factor, &desks)?;
        }
    }

    fn seat<'a>(
        &'a self,
        number: usize,
        load: &'a [f64],
        held_value: &'a [f64],
        start: Option<&'a Start<'a>>,
        desk: &'a Desk,
    ) -> Seat<'a> {
        let referred = start.is_some();
        // Without a load the plate is at rest, exactly so only if it begins there.
        let start = start.filter(|_| load.iter().any(|&force| force != 0.0));
        let shared = self.constraints.rows.is_empty() && start.is_some() == referred;
        let desk = shared.then_some(desk);
        let descent = async move { self.descend(load, held_value, start, desk, &mut |_| true).await };
        Seat { load: number, descent: Box::pin(descent), solved: None }
    }
}

impl Seat<'_> {
    fn go_on(&mut self) {
        if let Poll::Ready(solved) = self.descent.as_mut().poll(&mut Context::from_waker(Waker::noop())) {
            self.solved = Some(solved);
        }
    }
}

/// Answers all that ask.
fn answer(factor: &Factor, desks: &[Desk]) -> Result<(), FactorError> {
    let (asking, vectors): (Vec<&Desk>, Vec<Vec<f64>>) =
        desks.iter().filter_map(|desk| Some((desk, desk.asked()?))).unzip();
    let mut block = vectors.concat();
    factor.solve_side_by_side(&mut block)?;
    for (desk, solved) in asking.iter().zip(block.chunks_exact(factor.len())) {
        *desk.letter() = Letter::Solved(solved.to_vec());
    }
    Ok(())
}
