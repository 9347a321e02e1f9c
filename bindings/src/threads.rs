//! The threads that the core works on.
//!
//! A process that forked has none of its parent's threads, and waits for ever for those of a pool that it inherits, as
//! rayon's global one is. So every entry into the core goes to a pool of this very process, made at its first use.

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::process;
use std::sync::{OnceLock, mpsc};

/// As much as a process's first thread has: the core's own recursions and faer's are laid out for no less.
const STACK: usize = 8 << 20;

/// A process, and how many of its callbacks a thread is in: the threads of the pool above wait for these.
type Key = (u32, usize);

struct Pool {
    key: Key,
    threads: ThreadPool,
    next: OnceLock<Box<Pool>>,
}

/// A list that only grows, and is read without a lock, which another thread might hold while this one forks.
static POOLS: OnceLock<Box<Pool>> = OnceLock::new();

thread_local! {
    static CALLBACKS: Cell<usize> = const { Cell::new(0) };
}

fn pool() -> PyResult<&'static ThreadPool> {
    let key = (process::id(), CALLBACKS.get());
    let mut place = &POOLS;
    loop {
        match place.get() {
            Some(pool) if pool.key == key => return Ok(&pool.threads),
            Some(pool) => place = &pool.next,
            None => {
                let threads = ThreadPoolBuilder::new()
                    .stack_size(STACK)
                    .build()
                    .map_err(|error| PyOSError::new_err(format!("threads to work on cannot be started: {error}")))?;
                // Another thread may have set it first; the next round then uses its pool.
                let _ = place.set(Box::new(Pool { key, threads, next: OnceLock::new() }));
            }
        }
    }
}

/// Runs work of the core with the interpreter released.
pub fn released<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// As `released`; `work` gets a function that passes its argument to `tell` and returns whether to continue.
///
/// `tell` runs on the calling thread, since Python handles signals and windows on one thread only. An exception in it
/// ends the work and is the result.
pub fn told<N: Send, T: Send>(
    py: Python<'_>,
    mut tell: impl FnMut(Python<'_>, N) -> PyResult<()> + Send,
    work: impl FnOnce(&mut dyn FnMut(N) -> bool) -> T + Send,
) -> PyResult<T> {
    let pool = pool()?;
    let (news, heard) = mpsc::channel::<N>();
    let (answer, answered) = mpsc::channel::<()>();
    let mut output = None;
    let mut raised = None;
    let result = &mut output;
    let error = &mut raised;
    py.detach(move || {
        pool.in_place_scope(move |scope| {
            scope.spawn(move |_| {
                *result = Some(work(&mut |now| news.send(now).is_ok() && answered.recv().is_ok()));
            });
            // Without an answer the work ends, also if `tell` panics and drops the channel.
            for now in heard {
                match Python::attach(|py| in_callback(|| tell(py, now))) {
                    Ok(()) => drop(answer.send(())),
                    Err(output) => {
                        *error = Some(output);
                        break;
                    }
                }
            }
        });
    });
    match raised {
        Some(error) => Err(error),
        None => Ok(output.expect("work that did not panic has come to its end")),
    }
}

/// As `released`; `work` is given a function that says whether to go on, and which a signal makes say no.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&mut dyn FnMut() -> bool) -> T + Send) -> PyResult<T> {
    told(py, |py, (): ()| py.check_signals(), |tell| work(&mut || tell(())))
}

/// As `interruptible`, on the thread that called: work that takes no others may be over before one of them wakes up.
pub fn interruptible_alone<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&mut dyn FnMut() -> bool) -> T + Send,
) -> PyResult<T> {
    let mut raised = None;
    let error = &mut raised;
    let mut watch = move || match Python::attach(|py| py.check_signals()) {
        Ok(()) => true,
        Err(output) => {
            *error = Some(output);
            false
        }
    };
    let output = py.detach(move || work(&mut watch));
    raised.map_or(Ok(output), Err)
}

/// Runs a callback, in which calls of the core go to a pool that nobody waits in.
fn in_callback<T>(callback: impl FnOnce() -> T) -> T {
    struct Leaving;
    impl Drop for Leaving {
        fn drop(&mut self) {
            CALLBACKS.set(CALLBACKS.get() - 1);
        }
    }
    CALLBACKS.set(CALLBACKS.get() + 1);
    let _leaving = Leaving;
    callback()
}
