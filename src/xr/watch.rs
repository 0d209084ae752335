//! How long a thread ran and how long it waited.

use crate::gpu::instance::AroundSubmission;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Processor time of the calling thread so far; none where the system does not measure it. It does not grow while the
/// thread waits or while other threads have its processor.
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

/// The time that a thread has spent waiting for a device.
#[derive(Debug, Clone, Default)]
pub(super) struct DeviceWaits {
    nanoseconds: Arc<AtomicU64>,
}

impl DeviceWaits {
    /// Adds the waits of a device's submissions: from handing over to the end, without what the thread did.
    pub(super) fn around_submission(&self) -> AroundSubmission {
        let sum = self.nanoseconds.clone();
        Box::new(move |submit| {
            let watch = Watch::start();
            submit();
            sum.fetch_add(u64::try_from(watch.idle().as_nanos()).unwrap_or(0), Ordering::Relaxed);
        })
    }

    /// The sum of all waits so far.
    pub(super) fn sum(&self) -> Duration {
        Duration::from_nanos(self.nanoseconds.load(Ordering::Relaxed))
    }
}

/// Measures the time that a thread runs and waits.
pub(super) struct Watch {
    begin: Instant,
    ran: Option<Duration>,
}

impl Watch {
    pub(super) fn start() -> Self {
        Self { ran: thread_time(), begin: Instant::now() }
    }

    /// Processor time of this thread since the start; none where the system does not measure it.
    pub(super) fn ran(&self) -> Option<Duration> {
        thread_time().zip(self.ran).map(|(now, before)| now.saturating_sub(before))
    }

    /// The rest of the time since the start.
    pub(super) fn idle(&self) -> Duration {
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

    #[test]
    fn waits_around_submissions_add_up() {
        let waits = DeviceWaits::default();
        let around = waits.around_submission();
        let mut submissions = 0;
        for _ in 0..2 {
            around(&mut || {
                submissions += 1;
                std::thread::sleep(Duration::from_millis(15));
            });
        }
        assert_eq!(submissions, 2);
        assert!(waits.sum() > Duration::from_millis(15), "{:?}", waits.sum());
    }
}
