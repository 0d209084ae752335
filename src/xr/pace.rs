//! Keeping the display's rate: what the frames took, and how much may be drawn.

use serde::Serialize;
use std::time::Duration;

/// Frames that the percentiles are taken over, at most: two hours at 90 Hz.
const KEPT: usize = 650_000;

/// The record of a session's frames.
#[derive(Debug, Clone, Default)]
pub struct FrameTimes {
    /// Time from acquiring an image to handing it over, and of the device on it, ms, per drawn frame.
    work: Vec<f32>,
    /// The device's share of a frame, ms, where it is known.
    device: Vec<f32>,
    /// The host's own share of a frame by the clock, ms.
    host: Vec<f32>,
    /// Processor time of the frame's thread in it, ms.
    cpu: Vec<f32>,
    /// Time between one wake-up and the next, ms.
    wake: Vec<f32>,
    drawn: u64,
    missed: u64,
    empty: u64,
}

/// Percentiles in ms.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Percentiles {
    /// Half of the frames took no longer.
    pub p50: f32,
    /// 95 of 100.
    pub p95: f32,
    /// 99 of 100.
    pub p99: f32,
}

impl Percentiles {
    fn of(values: &[f32]) -> Self {
        let mut sorted = values.to_vec();
        sorted.sort_unstable_by(f32::total_cmp);
        let at = |percent: usize| {
            // nearest rank
            let rank = (sorted.len() * percent).div_ceil(100).max(1);
            sorted.get(rank - 1).copied().unwrap_or(0.0)
        };
        Self { p50: at(50), p95: at(95), p99: at(99) }
    }
}

/// What [`FrameTimes`] comes to.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct FrameSummary {
    /// Frames handed over with an image.
    pub drawn: u64,
    /// Frames for which the runtime wanted no image.
    pub empty: u64,
    /// Periods of the display for which no frame was ready.
    pub missed: u64,
    /// Time from acquiring an image to handing it over, and of the device on it, ms. The device draws one frame while the
    /// host prepares the next, so that frames come as fast as the slower of the two.
    pub work_ms: Percentiles,
    /// Time of the device on a frame, from the newest snapshot to the last pixel, ms; 0 where the device has no timestamps
    /// and is never waited for.
    pub device_ms: Percentiles,
    /// Time of the host in a frame from the wake-up on, ms: input, the crowd's snapshot, recording, submitting, handing over.
    /// Waits for the device and for images do not count.
    pub host_ms: Percentiles,
    /// Processor time of the frame's thread in [`FrameSummary::host_ms`], ms. The rest are the runtime's answers and waits for a
    /// processor. 0 where the system does not measure it.
    pub host_cpu_ms: Percentiles,
    /// Time between wake-ups, ms.
    pub wake_ms: Percentiles,
}

impl FrameTimes {
    /// Records what a frame with an image took: from acquiring the image to handing it over, and the device, if that is known.
    pub fn worked(&mut self, handed_over: Duration, device: Option<Duration>) {
        push(&mut self.work, handed_over + device.unwrap_or_default());
        if let Some(device) = device {
            push(&mut self.device, device);
        }
    }

    /// Records that a frame with an image was handed over, so many periods of the display after the frame before.
    pub fn drew(&mut self, periods: u64) {
        self.drawn += 1;
        self.missed += periods.saturating_sub(1);
    }

    /// Records the host's part of a frame with an image: by the clock, and in processor time of the thread.
    pub fn prepared(&mut self, host: Duration, cpu: Option<Duration>) {
        push(&mut self.host, host);
        if let Some(cpu) = cpu {
            push(&mut self.cpu, cpu);
        }
    }

    /// Records a frame for which the runtime wanted no image.
    pub fn empty(&mut self) {
        self.empty += 1;
    }

    /// Time since the wake-up before.
    pub fn woke(&mut self, since: Duration) {
        push(&mut self.wake, since);
    }

    /// Percentiles and counts.
    pub fn summary(&self) -> FrameSummary {
        FrameSummary {
            drawn: self.drawn,
            empty: self.empty,
            missed: self.missed,
            work_ms: Percentiles::of(&self.work),
            device_ms: Percentiles::of(&self.device),
            host_ms: Percentiles::of(&self.host),
            host_cpu_ms: Percentiles::of(&self.cpu),
            wake_ms: Percentiles::of(&self.wake),
        }
    }
}

fn push(values: &mut Vec<f32>, time: Duration) {
    if values.len() < KEPT {
        values.push(time.as_secs_f32() * 1e3);
    }
}

/// Share of a display period that drawing may take: the runtime's compositor wants the rest.
const BUDGET: f32 = 0.75;
/// Below this share of the budget there is room for more.
const ROOMY: f32 = 0.7;
/// Least quality: what is near stays fine.
const LEAST: f32 = 0.15;
/// Below this quality frames have fewer pixels, too.
const SHARP: f32 = 0.6;
/// Least share of the width and height of an image that is drawn.
const LEAST_RESOLUTION: f32 = 0.6;
/// Steps of that share: the image's grain changes seldom.
const RESOLUTIONS: f32 = 16.0;
/// Sides of drawn images are multiples of so many pixels, unless all of an image is drawn.
const PIXELS: f32 = 8.0;

/// Decides how much is drawn so that frames are ready in time: levels of detail come nearer, far people go and pixels become
/// fewer before a frame is dropped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Governor {
    quality: f32,
    /// Recent work, ms: quick to rise, slow to fall, so that one heavy frame counts at once.
    load: f32,
}

impl Default for Governor {
    fn default() -> Self {
        Self { quality: 1.0, load: 0.0 }
    }
}

impl Governor {
    /// Takes note of a frame's work and the display's period.
    pub fn frame(&mut self, work: Duration, period: Duration) {
        let (work, budget) = (work.as_secs_f32() * 1e3, BUDGET * period.as_secs_f32() * 1e3);
        if budget <= 0.0 || !work.is_finite() {
            return;
        }
        let rate = if work > self.load { 0.5 } else { 0.05 };
        self.load += (work - self.load) * rate;
        let over = self.load / budget;
        if over > 1.0 {
            // at most a fifth a frame: a single hitch must not empty the scene
            self.quality *= (1.0 / over).max(0.8);
        } else if over < ROOMY {
            self.quality += 0.004;
        }
        self.quality = self.quality.clamp(LEAST, 1.0);
    }

    /// How much may be drawn, 0 to 1: scales the distances of the levels of detail and of drawing at all.
    pub fn quality(&self) -> f32 {
        self.quality
    }

    /// Share of the width and height of the images that is drawn. Levels of detail and far people go first: fewer pixels are
    /// seen everywhere.
    pub fn resolution(&self) -> f32 {
        let dull = ((SHARP - self.quality) / (SHARP - LEAST)).clamp(0.0, 1.0);
        let share = 1.0 - dull * (1.0 - LEAST_RESOLUTION);
        (share * RESOLUTIONS).round() / RESOLUTIONS
    }

    /// Pixels that are drawn of an eye's image of this size.
    pub fn size(&self, full: [u32; 2]) -> [u32; 2] {
        let share = self.resolution();
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            clippy::cast_precision_loss,
            reason = "sides of images are far below 2^24"
        )]
        let drawn = |side: u32| ((side as f32 * share / PIXELS).ceil() * PIXELS) as u32;
        if share < 1.0 { full.map(|side| drawn(side).min(side)) } else { full }
    }

    /// Level distances `[first, second, farthest]`, m, for these at full quality.
    pub fn distances(&self, full: [f32; 3]) -> [f32; 3] {
        // the far ones go first: they cost the most and are seen the least
        let q = self.quality;
        [full[0] * (0.4 + 0.6 * q), full[1] * (0.3 + 0.7 * q), full[2] * (0.2 + 0.8 * q)]
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;

    const PERIOD: Duration = Duration::from_micros(11_111);

    /// Work that grows with the quality, ms.
    fn settle(mut governor: Governor, cost: f32, frames: u32) -> (Governor, u32) {
        let mut late = 0;
        for _ in 0..frames {
            let work = cost * governor.quality();
            late += u32::from(work > PERIOD.as_secs_f32() * 1e3);
            governor.frame(Duration::from_secs_f32(work * 1e-3), PERIOD);
        }
        (governor, late)
    }

    #[test]
    fn too_much_work_is_cut_within_a_few_frames_and_not_below_what_is_needed() {
        let (governor, late) = settle(Governor::default(), 30.0, 400);
        assert!(late <= 12, "{late}");
        let work = 30.0 * governor.quality();
        assert!((4.0..=8.4).contains(&work), "{work}");
    }

    #[test]
    fn with_room_to_spare_everything_is_drawn_again() {
        let (low, _) = settle(Governor::default(), 30.0, 400);
        let (high, _) = settle(low, 3.0, 600);
        assert_eq!(high.quality(), 1.0);
        assert_eq!(high.distances([10.0, 20.0, 100.0]), [10.0, 20.0, 100.0]);
    }

    #[test]
    fn pixels_go_after_far_people_and_never_all_of_them() {
        let at = |quality| Governor { quality, load: 0.0 };
        for quality in [1.0, 0.8, SHARP] {
            assert_eq!(at(quality).size([1832, 1921]), [1832, 1921]);
        }
        let mut before = 1.0;
        for percent in (15_u8..60).rev() {
            let governor = at(f32::from(percent) * 0.01);
            let (share, [width, height]) = (governor.resolution(), governor.size([1832, 1921]));
            assert!(share <= before && before - share <= 1.0 / RESOLUTIONS, "{percent} %: {share}");
            assert!(width <= 1832 && height <= 1921 && width % 8 == 0, "{percent} %: {width}x{height}");
            before = share;
        }
        assert!((before - LEAST_RESOLUTION).abs() < 0.5 / RESOLUTIONS, "{before}");
        assert_eq!(at(LEAST).size([3, 1]), [3, 1]);
    }

    #[test]
    fn one_hitch_does_not_empty_the_scene() {
        let mut governor = Governor::default();
        governor.frame(Duration::from_millis(200), PERIOD);
        assert!(governor.quality() >= 0.8);
        governor.frame(Duration::ZERO, Duration::ZERO);
        assert!(governor.quality() >= 0.8);
    }

    #[test]
    fn percentiles_are_those_of_the_textbook() {
        let mut times = FrameTimes::default();
        for ms in 1..=100 {
            let device = (ms % 2 == 0).then(|| Duration::from_millis(ms / 2));
            times.worked(Duration::from_millis(ms) - device.unwrap_or_default(), device);
            times.drew(if ms == 50 { 3 } else { 1 });
        }
        let summary = times.summary();
        assert_eq!((summary.drawn, summary.missed), (100, 2));
        assert_eq!(summary.work_ms, Percentiles { p50: 50.0, p95: 95.0, p99: 99.0 });
        assert_eq!(summary.device_ms, Percentiles { p50: 25.0, p95: 48.0, p99: 50.0 });
        assert_eq!(FrameTimes::default().summary(), FrameSummary::default());
    }
}
