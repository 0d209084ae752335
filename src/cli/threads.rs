//! The threads that work is shared among: as many as there are cores, or fewer where the system gives no more.

use rayon::{ThreadBuilder, ThreadPoolBuilder};
use std::sync::mpsc;
use std::thread;

/// Starts them. Threads are made before the pool takes them, since a pool that cannot make one fails as a whole.
pub(super) fn start() {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|text| text.parse().ok());
    let wanted = asked.filter(|&count: &usize| count > 0);
    let wanted = wanted.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from));
    let workers: Vec<_> = (0..wanted).map_while(|_| worker()).collect();
    let pool = if workers.is_empty() {
        ThreadPoolBuilder::new().num_threads(1).use_current_thread()
    } else {
        ThreadPoolBuilder::new().num_threads(workers.len())
    };
    let mut workers = workers.into_iter();
    let pool = pool.spawn_handler(move |work| {
        let gone = || std::io::Error::other("a thread has ended");
        workers.next().and_then(|worker| worker.send(work).ok()).ok_or_else(gone)
    });
    // fails only where there is a pool already, which then does the work
    let _ = pool.build_global();
}

/// A thread that waits for work.
fn worker() -> Option<mpsc::Sender<ThreadBuilder>> {
    let (give, take) = mpsc::channel::<ThreadBuilder>();
    let work = move || {
        if let Ok(work) = take.recv() {
            work.run();
        }
    };
    thread::Builder::new().name("worker".to_owned()).spawn(work).ok().map(|_| give)
}
