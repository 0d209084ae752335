//! How long a thread ran, apart from the clock on the wall.

use std::time::{Duration, Instant};

/// Processor time of the calling thread so far; none where the system does not tell.
///
/// Between two readings it grows by what the thread did: not by what it waited for, and not while other threads had its
/// processor.
fn thread_time() -> Option<Duration> {
    #[cfg(target_os = "linux")]
    {
        let mut time = libc::timespec { tv_sec: 0, tv_nsec: 0 };
        // SAFETY: the clock is written to a place that is ours.
        let result = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
        let (seconds, nanoseconds) = (u64::try_from(time.tv_sec).ok()?, u32::try_from(time.tv_nsec).ok()?);
        (result == 0).then(|| Duration::new(seconds, nanoseconds))
    }
    #[cfg(not(target_os = "linux"))]
    None
}

/// Tells what a thread did from what it waited for.
pub(crate) struct Watch {
    begin: Instant,
    ran: Option<Duration>,
}

impl Watch {
    pub(crate) fn start() -> Self {
        Self { ran: thread_time(), begin: Instant::now() }
    }

    /// Processor time of this thread since then; none where the system does not tell.
    pub(crate) fn ran(&self) -> Option<Duration> {
        thread_time().zip(self.ran).map(|(now, before)| now.saturating_sub(before))
    }

    /// The rest of the time since then.
    pub(crate) fn idle(&self) -> Duration {
        let ran = self.ran().unwrap_or_default();
        self.begin.elapsed().saturating_sub(ran)
    }
}

#[cfg(all(test, target_os = "linux"))]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn work_counts_and_sleep_does_not() {
        let watch = Watch::start();
        std::thread::sleep(Duration::from_millis(40));
        let slept = watch.ran().unwrap();
        assert!(slept < Duration::from_millis(20), "{slept:?}");
        assert!(watch.idle() > Duration::from_millis(20));
        let (begin, clock) = (thread_time().unwrap(), Instant::now());
        while thread_time().unwrap() - begin < Duration::from_millis(5) {
            assert!(clock.elapsed() < Duration::from_secs(20), "work is not counted");
        }
        assert!(clock.elapsed() >= Duration::from_millis(4));
    }
}
