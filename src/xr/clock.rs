//! When the crowd is stepped, and whether the headset's thread still answers.

use std::time::Duration;

/// Longest the crowd may fall behind the clock, s. Time beyond that passes without steps.
const LONGEST_ARREARS: f64 = 0.25;
/// The headset's thread counts as silent after so long without a heartbeat.
const SILENCE: Duration = Duration::from_secs(2);
/// Longest the headset's thread may take to end in good order: a busy device takes its time.
const FAREWELL: Duration = Duration::from_secs(10);

/// Steps of a fixed length by the clock.
#[derive(Debug)]
pub(super) struct StepClock {
    /// Length of a step, s.
    time_step: f64,
    steps: u32,
    /// When the last step began, s.
    began: f64,
    /// Time that passed without steps, s.
    lost: f64,
}

impl StepClock {
    pub(super) fn new(time_step: f64) -> Self {
        Self { time_step, steps: 0, began: 0.0, lost: 0.0 }
    }

    /// Begins a step if one is due at `now`, s since the beginning.
    pub(super) fn begin(&mut self, now: f64) -> bool {
        let behind = now - self.lost - f64::from(self.steps) * self.time_step;
        if behind < self.time_step {
            return false;
        }
        self.lost += (behind - LONGEST_ARREARS).max(0.0);
        self.began = now;
        true
    }

    /// Ends a step. Returns when the state after it was due, s.
    pub(super) fn end(&mut self) -> f64 {
        self.steps += 1;
        self.lost + f64::from(self.steps) * self.time_step
    }

    pub(super) fn steps(&self) -> u32 {
        self.steps
    }

    pub(super) fn began(&self) -> f64 {
        self.began
    }

    pub(super) fn lost(&self) -> f64 {
        self.lost
    }
}

/// Why the headset's thread is silent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Silence {
    /// A call of the runtime is under way.
    Runtime,
    /// The thread works: the graphics device draws or compiles.
    Device,
}

/// Watches the heartbeats of the headset's thread.
#[derive(Debug, Default)]
pub(super) struct Watchdog {
    silent: Option<Silence>,
    /// When the thread was first known to have been asked to end, since the beginning.
    stopping: Option<Duration>,
}

impl Watchdog {
    /// Takes the time since the last heartbeat, and whether a call of the runtime is under way. Returns a message when the thread
    /// falls silent or answers again. Only a runtime that is being asked is said not to answer.
    pub(super) fn watch(&mut self, silence: Duration, is_calling: bool) -> Option<&'static str> {
        let now = (silence > SILENCE).then_some(if is_calling { Silence::Runtime } else { Silence::Device });
        let before = std::mem::replace(&mut self.silent, now);
        match (before, now) {
            _ if before == now => None,
            (Some(Silence::Runtime), Some(Silence::Device)) => {
                // first that the call has ended; a device that keeps the thread silent gets its message next time
                self.silent = None;
                Some("the OpenXR runtime answers again")
            }
            (_, Some(Silence::Runtime)) => {
                Some("the OpenXR runtime does not answer; the crowd goes on without it")
            }
            (_, Some(Silence::Device)) => {
                Some("the graphics device takes its time, perhaps to compile; the crowd goes on")
            }
            (Some(Silence::Runtime), None) => Some("the OpenXR runtime answers again"),
            (_, None) => Some("the graphics device draws again"),
        }
    }

    /// Whether a thread that was asked to end is given up at `now`: it has had its time and is silent.
    pub(super) fn gives_up(&mut self, now: Duration) -> bool {
        let since = *self.stopping.get_or_insert(now);
        now.saturating_sub(since) > FAREWELL && self.silent.is_some()
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sums of halves are exact")]
mod tests {
    use super::*;

    #[test]
    fn steps_are_due_by_the_clock_and_long_arrears_are_dropped() {
        let mut clock = StepClock::new(0.125);
        assert!(!clock.begin(0.0625), "not yet");
        assert!(clock.begin(0.125));
        assert_eq!((clock.end(), clock.steps(), clock.began()), (0.125, 1, 0.125));
        assert!(!clock.begin(0.1875));
        // ten seconds late: a quarter of a second is made up for, the rest passes
        assert!(clock.begin(10.125));
        assert_eq!((clock.end(), clock.lost()), (10.0, 9.75));
        assert!(clock.begin(10.125));
        assert_eq!(clock.end(), 10.125);
        assert!(!clock.begin(10.125));
        assert_eq!(clock.lost(), 9.75);
    }

    #[test]
    fn silence_is_reported_once_and_only_a_silent_thread_is_given_up() {
        let (short, long) = (Duration::from_millis(100), SILENCE + Duration::from_millis(1));
        let mut watchdog = Watchdog::default();
        assert_eq!(watchdog.watch(short, true), None);
        assert!(watchdog.watch(long, true).is_some_and(|line| line.contains("does not answer")));
        assert_eq!(watchdog.watch(long, true), None);
        assert!(watchdog.watch(short, false).is_some_and(|line| line.contains("answers again")));
        // a call that ends in work of the device
        assert!(watchdog.watch(long, true).is_some_and(|line| line.contains("does not answer")));
        assert!(watchdog.watch(long, false).is_some_and(|line| line.contains("answers again")));
        assert!(watchdog.watch(long, false).is_some_and(|line| line.contains("takes its time")));
        assert!(watchdog.watch(short, false).is_some_and(|line| line.contains("draws again")));
        let asked = Duration::from_secs(60);
        assert!(!watchdog.gives_up(asked));
        assert!(!watchdog.gives_up(asked + 2 * FAREWELL), "it still answers");
        assert!(watchdog.watch(long, true).is_some());
        assert!(watchdog.gives_up(asked + 2 * FAREWELL));
        let silent = Watchdog { silent: Some(Silence::Device), stopping: Some(asked) };
        assert!(!{ silent }.gives_up(asked + FAREWELL));
    }

    #[test]
    fn a_runtime_that_is_not_asked_is_not_said_to_be_silent() {
        let (short, long) = (Duration::from_millis(100), SILENCE + Duration::from_millis(1));
        let mut watchdog = Watchdog::default();
        let said = |line: Option<&str>, words: &str| line.is_some_and(|line| line.contains(words));
        assert!(said(watchdog.watch(long, false), "graphics device"));
        assert_eq!(watchdog.watch(long, false), None);
        assert!(said(watchdog.watch(long, true), "does not answer"), "then it is asked, and hangs");
        assert!(said(watchdog.watch(long, false), "answers again"));
        assert!(said(watchdog.watch(long, false), "graphics device"));
        assert!(said(watchdog.watch(short, false), "draws again"));
    }
}
