//! The thread pools on which the core runs.
//!
//! A forked process has none of its parent's threads. If it used a pool of its parent, such as rayon's global pool, it
//! would wait for ever. Therefore every call of the core runs on a pool of the present process, which is made at its
//! first use.

use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::process;
use std::sync::{OnceLock, mpsc};

/// Stack size of a thread in bytes, as large as that of the first thread of a process. Recursions of the core and of
/// faer need it.
const STACK: usize = 8 << 20;

/// Key of a pool: the process id, and the depth of callbacks in which the calling thread is. The threads of a pool wait
/// while a callback runs, so calls of the core from the callback need another pool.
type Key = (u32, usize);

struct Pool {
    key: Key,
    threads: ThreadPool,
    next: OnceLock<Box<Pool>>,
}

/// The pools, a list that only grows. It is read without a lock, since a lock that another thread holds during a fork
/// would never be released in the child.
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
                    .map_err(|error| PyOSError::new_err(format!("threads cannot be started: {error}")))?;
                // If another thread has appended a pool first, the loop goes on and examines the pool of that thread.
                let _ = place.set(Box::new(Pool { key, threads, next: OnceLock::new() }));
            }
        }
    }
}

/// Runs `work`, which calls the core, without Python's interpreter lock.
pub fn released<T: Send>(py: Python<'_>, work: impl FnOnce() -> T + Send) -> PyResult<T> {
    let pool = pool()?;
    Ok(py.detach(|| pool.install(work)))
}

/// Runs `work` on the pool, without Python's interpreter lock. `work` gets a function that passes its argument to
/// `tell` and returns whether to continue.
///
/// `tell` runs on the calling thread, since Python handles signals and windows on one thread only. An exception in
/// `tell` ends the work and is raised.
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
            // `work` waits for an answer to each message. Without an answer it ends, also if `tell` panics, which drops
            // the channel.
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
        None => Ok(output.expect("the work ended without a panic")),
    }
}

/// Runs `work` on the pool, without Python's interpreter lock. `work` gets a function that returns false after a signal
/// such as Ctrl-C.
pub fn interruptible<T: Send>(py: Python<'_>, work: impl FnOnce(&mut dyn FnMut() -> bool) -> T + Send) -> PyResult<T> {
    told(py, |py, (): ()| py.check_signals(), |tell| work(&mut || tell(())))
}

/// Runs `work` as `interruptible` does, but on the calling thread: short work on one thread may end before another
/// thread wakes up.
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

/// Runs a Python callback. Calls of the core from the callback use another pool, whose threads do not wait.
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
