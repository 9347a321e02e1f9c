//! A factor that several loads share. Its solves are batched, so that the factor is read once for all loads.
//!
//! The method of one load is an `async` function. It suspends at a solve with the shared factor and nowhere else. The
//! batch then solves for all suspended loads, and each load continues. No load waits for another thread.

use crate::cholesky::FactorError;
use crate::contact::problem::ContactProblem;
use crate::contact::system::System;
use rayon::prelude::*;
use std::future::{Future, poll_fn};
use std::pin::{Pin, pin};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll, Waker};

/// The vector that one load and the batch exchange.
#[derive(Default)]
enum Exchange {
    #[default]
    Empty,
    /// Nodal forces (3n,) for which the load waits to be solved.
    Forces(Vec<f64>),
    /// Displacements (3n,) under these forces.
    Displacements(Vec<f64>),
}

/// Access of one load to the shared factor.
#[derive(Clone, Default)]
pub(in crate::contact) struct SharedFactor(Arc<Mutex<Exchange>>);

impl SharedFactor {
    fn exchange(&self) -> MutexGuard<'_, Exchange> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The displacements (3n,) under nodal forces (3n,). Suspends the load until the batch has solved for these forces.
    pub(super) async fn solve(&self, forces: &[f64]) -> Vec<f64> {
        *self.exchange() = Exchange::Forces(forces.to_vec());
        poll_fn(|_| {
            let mut exchange = self.exchange();
            match std::mem::take(&mut *exchange) {
                Exchange::Displacements(nodal) => Poll::Ready(nodal),
                asked => {
                    *exchange = asked;
                    Poll::Pending
                }
            }
        })
        .await
    }
}

/// A load of the batch: its index, its method, and its access to the shared factor.
pub(in crate::contact) struct Batched<'a, T> {
    pub(in crate::contact) number: usize,
    pub(in crate::contact) method: Pin<Box<dyn Future<Output = T> + Send + 'a>>,
    pub(in crate::contact) factor: SharedFactor,
}

/// Runs all loads in parallel until each has ended or waits for the shared factor, and solves with the factor for those
/// that wait. Removes the loads that have ended, and returns their indices and results.
pub(in crate::contact) fn advance<T: Send>(
    problem: &ContactProblem,
    system: &System,
    loads: &mut Vec<Batched<'_, T>>,
) -> Result<Vec<(usize, T)>, FactorError> {
    let polled: Vec<_> = std::mem::take(loads)
        .into_par_iter()
        .map(|mut load| (load.method.as_mut().poll(&mut Context::from_waker(Waker::noop())), load))
        .collect();
    let (mut block, mut ended) = (Vec::new(), Vec::new());
    for (poll, load) in polled {
        let asked = std::mem::take(&mut *load.factor.exchange());
        match (poll, asked) {
            (Poll::Ready(result), _) => ended.push((load.number, result)),
            (Poll::Pending, Exchange::Forces(forces)) => {
                block.extend(problem.pattern.gather(&forces));
                loads.push(load);
            }
            (Poll::Pending, _) => unreachable!("a load suspends only with forces for the shared factor"),
        }
    }
    system.factor.solve_side_by_side(&mut block)?;
    for (load, nodal) in loads.iter().zip(block.chunks_exact(system.factor.len())) {
        let nodal = problem.pattern.scatter(nodal, problem.plate.dof_count());
        *load.factor.exchange() = Exchange::Displacements(nodal);
    }
    Ok(ended)
}

/// Runs the method of a load that shares no factor, and so never suspends.
pub(in crate::contact) fn alone<T>(method: impl Future<Output = T>) -> T {
    match pin!(method).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => result,
        Poll::Pending => unreachable!("a method suspends only at a shared factor"),
    }
}
