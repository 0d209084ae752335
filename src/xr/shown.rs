//! The time of the crowd that a frame shows.
//!
//! Frames come at the display's rate and steps at their own. The crowd is shown as it was a step ago, and a little more
//! where steps take their time, so that a frame lies between two snapshots. It advances by the
//! display's times, which are regular, not by those at which this thread happens to wake up.

/// How fast the shown time follows when display and clock drift apart, 1/s.
const FOLLOW: f64 = 2.0;
/// Farther apart than this they have nothing to do with each other any more, s.
const LOST: f64 = 0.5;
/// Slack for a thread that wakes up late, s.
const SLACK: f64 = 0.002;
/// How fast the delay for late steps goes back, s/s.
const RECOVER: f64 = 0.05;

/// The state of the crowd's clock when a frame is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Crowd {
    /// The clock of its snapshots now, s.
    pub(super) now: f64,
    /// Length of a step, s.
    pub(super) step: f64,
    /// Delay of the newest snapshot after it was due, s.
    pub(super) late: f64,
}

/// The time that frames show.
#[derive(Debug, Default)]
pub(super) struct Shown {
    /// Display time and what it showed, s.
    last: Option<(f64, f64)>,
    /// Display time less what it shows, s.
    offset: f64,
    /// How late steps are at times, s.
    late: f64,
}

impl Shown {
    /// The time of the crowd that the frame of a display time (ns) shows, s. It never goes back.
    #[allow(clippy::cast_precision_loss, reason = "microseconds are enough, for a century")]
    pub(super) fn time(&mut self, display_ns: i64, crowd: &Crowd) -> f64 {
        let display = display_ns as f64 * 1e-9;
        let since = self.last.map_or(0.0, |(before, _)| (display - before).clamp(0.0, LOST));
        self.late = crowd.late.min(LOST).max(self.late - RECOVER * since);
        let wanted = display - (crowd.now - crowd.step - self.late - SLACK);
        if self.last.is_none() || (wanted - self.offset).abs() > LOST {
            self.offset = wanted;
        } else {
            self.offset += (wanted - self.offset) * (FOLLOW * since).min(1.0);
        }
        let shown = display - self.offset;
        let shown = self.last.map_or(shown, |(_, before)| shown.max(before));
        self.last = Some((display, shown));
        shown
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "made-up times")]
mod tests {
    use super::*;
    use crate::sim::snapshots::Snapshots;

    /// Seconds of a display at `rate` Hz with steps of `step` s that are there after `late` s; the thread wakes up to
    /// `jitter` s late. How far apart frames were of which none moved less than it should by half, and the worst delay.
    fn run(rate: f64, step: f64, late: f64, jitter: f64) -> (usize, f64) {
        let (mut shown, mut snapshots) = (Shown::default(), Snapshots::default());
        let (mut taken, mut before, mut still, mut worst) = (0, f64::NAN, 0, 0.0_f64);
        for frame in 0..(4.0 * rate) as u32 {
            let display = 1000.0 + f64::from(frame) / rate;
            let random = f64::from(frame.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 24);
            let now = 0.5 + f64::from(frame) / rate + jitter * random;
            let newest = ((now - late) / step).floor();
            if newest as u32 != taken {
                taken = newest as u32;
                snapshots.keep(newest * step);
            }
            let time = shown.time((display * 1e9) as i64, &Crowd { now, step, late });
            let between = snapshots.at(time, 1);
            let previous = newest * step - step;
            let seen = previous + f64::from(between.share) * step;
            assert!(seen <= newest * step + 1e-9);
            if f64::from(frame) > rate {
                still += usize::from(seen - before < 0.5 / rate);
                worst = worst.max(now - seen);
            }
            before = seen;
        }
        (still, worst)
    }

    #[test]
    fn people_move_in_every_frame_of_a_fast_display_and_are_shown_a_step_late() {
        for rate in [72.0, 90.0, 120.0, 144.0] {
            let (still, worst) = run(rate, 1.0 / 30.0, 0.004, 0.002);
            assert_eq!(still, 0, "{rate} Hz");
            assert!(worst < 1.0 / 30.0 + 0.015, "{rate} Hz: {worst} s");
        }
    }

    #[test]
    fn display_times_that_jump_or_go_back_do_not_turn_the_crowd_back() {
        let mut shown = Shown::default();
        let mut at = |display: f64, now: f64| {
            shown.time((display * 1e9) as i64, &Crowd { now, step: 0.03, late: 0.0 })
        };
        let first = at(100.0, 1.0);
        assert!((first - (1.0 - 0.03 - SLACK)).abs() < 1e-9);
        // a service that hung: display times of long ago, then of now
        let mut before = first;
        for (display, now) in [(97.0, 4.0), (97.1, 4.1), (104.2, 4.2), (104.3, 4.3)] {
            let time = at(display, now);
            assert!(time >= before && time <= now, "{time}");
            before = time;
        }
        assert!((before - 4.3).abs() < 0.1);
    }
}
