//! When the feet stand, found in the gait.

use super::cycle::at_phase;
use crate::gait::{Joint, Pose};
use std::ops::Range;

/// Share of the stance in which the foot is flat.
pub(super) const FLAT: Range<f32> = 0.16..0.64;

/// Shortest stance of a walk, in cycles: below it the gait is a run.
const WALK: f32 = 0.42;

/// When a foot stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stance {
    /// Phase of the foot strike.
    pub(super) strike: f32,
    /// Length of the stance in cycles.
    pub(super) share: f32,
}

impl Stance {
    /// Cycles since the strike, 0 to 1.
    pub(super) fn since(self, phase: f32) -> f32 {
        (phase - self.strike).rem_euclid(1.0)
    }
}

/// Finds the stance of `foot`. It begins after the foot's most forward point, when the foot has come to rest on
/// the ground (its speed over the ground falls under half the walking speed), and ends at its rearmost point.
/// Neither height nor velocity thresholds are needed, so styles that drag or stamp their feet do not confuse it.
/// `travel` in metres per cycle.
pub(super) fn stance(poses: &[Pose], foot: Joint, travel: f32) -> Stance {
    let count = poses.len();
    let z = |i: usize| poses[i % count][foot as usize].z;
    let best = |better: fn(f32, f32) -> bool| {
        (1..count).fold(0, |best, i| if better(z(i), z(best)) { i } else { best })
    };
    let (front, rear) = (best(|a, b| a > b), best(|a, b| a < b));
    // Speed over the ground in metres per cycle.
    let speed = |i: usize| (z(i + 1) - z(i + count - 1)) * 0.5 * count as f32 + travel;
    let mut strike = front as f32;
    if travel > 1e-3 {
        for i in front..front + count / 6 {
            let (now, next) = (speed(i), speed(i + 1));
            if next < 0.5 * travel {
                strike = i as f32 + ((now - 0.5 * travel) / (now - next).max(1e-6)).clamp(0.0, 1.0);
                break;
            }
            strike = i as f32 + 1.0;
        }
    }
    let strike = strike / count as f32;
    let share = (rear as f32 / count as f32 - strike).rem_euclid(1.0);
    let share = if share < WALK { share.max(0.3) } else { share.clamp(0.52, 0.72) };
    Stance { strike: strike.rem_euclid(1.0), share }
}

/// Height of the gait's ankles while their feet are flat, m.
pub(super) fn ankle_height(poses: &[Pose], feet: [(Joint, Stance); 2]) -> f32 {
    let mut sum = 0.0;
    let mut count = 0.0;
    for (foot, stance) in feet {
        for k in 0..8_u8 {
            let t = FLAT.start + (FLAT.end - FLAT.start) * f32::from(k) / 8.0;
            sum += at_phase(poses, foot, stance.strike + stance.share * t).y;
            count += 1.0;
        }
    }
    sum / count
}
