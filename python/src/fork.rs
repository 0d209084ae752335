//! What must not be taken across a fork: threads and open devices. Workers of `multiprocessing` are forks on Linux.

use crate::error::{Fault, Result};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The process that has opened a Vulkan device; 0: none has.
static OPENED_BY: AtomicU32 = AtomicU32::new(0);

/// The threads that work is shared among, and the process that they belong to.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

/// The way out of both errors below.
const HINT: &str = "make simulations in the worker itself, or start workers with multiprocessing.get_context(\"spawn\"), or \
                    use backend=\"cpu\"";

/// Notes that this process has a Vulkan device open.
pub(crate) fn opened() {
    OPENED_BY.store(std::process::id(), Ordering::Relaxed);
}

/// Refuses to open a Vulkan device in the fork of a process that has one: drivers do not survive that.
pub(crate) fn check_may_open() -> Result<()> {
    let by = OPENED_BY.load(Ordering::Relaxed);
    if by == 0 || by == std::process::id() {
        return Ok(());
    }
    Err(Fault::failed(format!("process {by} opened a Vulkan device before it forked this one"), HINT))
}

/// Refuses to use a device that another process opened.
pub(crate) fn check_own(by: u32) -> Result<()> {
    if by == std::process::id() {
        return Ok(());
    }
    Err(Fault::failed(
        format!("the Vulkan device of this simulation belongs to process {by}, which forked this one"),
        HINT,
    ))
}

/// Does work on the threads of this process. A fork has none of its parent's, so it gets its own.
///
/// # Errors
/// When the system gives no thread.
pub(crate) fn on_threads<T: Send>(work: impl FnOnce() -> Result<T> + Send) -> Result<T> {
    pool()?.install(work)
}

fn pool() -> Result<Arc<ThreadPool>> {
    let own = std::process::id();
    let mut kept = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((process, pool)) = kept.as_ref()
        && *process == own
    {
        return Ok(pool.clone());
    }
    let pool = ThreadPoolBuilder::new().thread_name(|index| format!("gaitway {index}")).build().map_err(
        |error| Fault::failed(format!("cannot start threads: {error}"), "set RAYON_NUM_THREADS to fewer"),
    )?;
    let pool = Arc::new(pool);
    // a parent's pool is never dropped: dropping waits for threads that a fork does not have
    std::mem::forget(kept.replace((own, pool.clone())));
    Ok(pool)
}
