//! Whether a stride is walking. The feet pass each other in turns. The swinging foot is lifted over the standing one. The ground
//! passes evenly under the standing foot, about as fast as the body goes.
//!
//! The middle half of each step is measured, from a strike of one foot to the next of the other: the first foot stands then,
//! the other swings. All measures are in the body's own frame, so that travel, treadmills and data centred on the root are
//! judged alike. Ranges are ours: of the 606 strides of CMU, Bandai-Namco and 100STYLE the least step is 0.21 m, the least
//! lift 0.04 m, the ground passes at 0.52 to 0.99 of the walking speed, at most 2.4 times as fast under one foot as under
//! the other, and deviates by at most 0.42 of its mean.

use super::filter::{derivative, frames, low_pass};
use super::refusal::Refusal;
use super::take::{Cut, Take};
use super::walk::{FEET, FOOT_CUTOFF_HZ};
use crate::gait::{Joint, Pose};
use glam::Vec3;
use std::ops::RangeInclusive;

/// The part of a step in which one foot stands and the other swings.
const MIDDLE: [f32; 2] = [0.25, 0.75];
/// A foot strikes at least this far in front of the other, m.
pub(super) const LEAST_STEP: f32 = 0.02;
/// The swinging foot is at least this far above the standing one, m, mean of both feet (a camera that rolls lifts one).
pub(super) const LEAST_LIFT: f32 = 0.005;
/// The ground passes under the standing feet at this share of the walking speed, mean of both feet.
pub(super) const UNDERFOOT: RangeInclusive<f32> = 0.4..=1.6;
/// The ground passes under one foot at this many times its speed under the other.
pub(super) const EQUAL: RangeInclusive<f32> = 0.33..=3.0;
/// The speed of the ground under a standing foot deviates from its mean by at most this share, mean of both feet.
pub(super) const MOST_UNSTEADY: f32 = 0.8;

/// What the feet do in one stride; left foot first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// How far each foot is in front of the other where it strikes, m.
    pub step: [f32; 2],
    /// Speed of the ground under each foot while it stands: backwards, against the body, m/s.
    pub ground: [f32; 2],
    /// Standard deviation of that speed while the foot stands, m/s.
    pub deviation: [f32; 2],
    /// How far each foot, swinging, is above the other, standing, m.
    pub lift: [f32; 2],
    /// Speed over the stride, m/s.
    pub speed: f32,
    /// Share of the stride in which neither foot is near the ground: running.
    pub flight: f32,
}

/// Both feet this far above where they stand are off the ground, m.
const OFF_GROUND: f32 = 0.08;
/// A flight shorter than this share of the stride is the roll of an ankle.
pub(super) const LEAST_FLIGHT: f32 = 0.05;

/// Where the feet of a take are, seen from the root; left foot first, `[frame]`.
pub(super) struct Feet {
    /// In front of the root, m, smoothed.
    reach: [Vec<f32>; 2],
    /// Its change, m/s.
    forward: [Vec<f32>; 2],
    /// Height, m.
    height: [Vec<f32>; 2],
}

impl Feet {
    /// The feet of a take whose body faces `facing`.
    pub(super) fn of(take: &Take, facing: &[Vec3]) -> Self {
        let reach = FEET.map(|foot| {
            let in_front = |(pose, facing): (&Pose, &Vec3)| {
                (pose[foot as usize] - pose[Joint::Root as usize]).dot(*facing)
            };
            let reach: Vec<f32> = take.poses.iter().zip(facing).map(in_front).collect();
            low_pass(&reach, take.rate, FOOT_CUTOFF_HZ)
        });
        let forward = reach.each_ref().map(|reach| derivative(reach, take.rate));
        let height = FEET.map(|foot| take.poses.iter().map(|pose| pose[foot as usize].y).collect());
        Self { reach, forward, height }
    }

    /// What the feet do over a stride at `speed`, m/s, in which the other foot strikes at frame `between`.
    pub(super) fn support(&self, cut: &Cut, between: f32, speed: f32) -> Support {
        let first = usize::from(cut.foot == Joint::RightFoot);
        let mut support = Support {
            step: [0.0; 2],
            ground: [0.0; 2],
            deviation: [0.0; 2],
            lift: [0.0; 2],
            speed,
            flight: 0.0,
        };
        let mut level = [0.0; 2];
        for (standing, from, to) in [(first, cut.from, between), (1 - first, between, cut.to)] {
            let swinging = 1 - standing;
            let middle = from + (to - from) * MIDDLE[0]..from + (to - from) * MIDDLE[1];
            let mean = |signal: &[f32]| mean_over(signal, &middle);
            let at_strike = |side: usize| mean_over(&self.reach[side], &(from..from));
            level[standing] = mean(&self.height[standing]);
            support.step[standing] = at_strike(standing) - at_strike(swinging);
            support.ground[standing] = -mean(&self.forward[standing]);
            support.deviation[standing] = deviation_over(&self.forward[standing], &middle);
            support.lift[swinging] = mean(&self.height[swinging]) - level[standing];
        }
        let stride = frames(cut.from)..frames(cut.to).min(self.height[0].len());
        let off_ground = |&frame: &usize| {
            [0, 1].iter().all(|&side: &usize| self.height[side][frame] > level[side] + OFF_GROUND)
        };
        support.flight = stride.clone().filter(off_ground).count() as f32 / stride.len().max(1) as f32;
        support
    }
}

/// Standard deviation of a signal over the same frames as [`mean_over`].
fn deviation_over(signal: &[f32], span: &std::ops::Range<f32>) -> f32 {
    let mean = mean_over(signal, span);
    let squares: Vec<f32> = signal.iter().map(|value| (value - mean).powi(2)).collect();
    mean_over(&squares, span).sqrt()
}

/// Mean of a signal from one fractional frame to another, over the whole frames nearest to them.
fn mean_over(signal: &[f32], span: &std::ops::Range<f32>) -> f32 {
    let last = signal.len().saturating_sub(1);
    let (from, to) = (frames(span.start.round()).min(last), frames(span.end.round()).min(last));
    let part = signal.get(from..=to).unwrap_or_default();
    part.iter().sum::<f32>() / part.len().max(1) as f32
}

impl Support {
    /// Whether neither foot is on the ground for a part of the stride.
    pub fn is_running(&self) -> bool {
        self.flight >= LEAST_FLIGHT
    }

    /// Deviation of the ground's speed under a standing foot, in shares of that speed, mean of both feet.
    pub fn unsteadiness(&self) -> f32 {
        f32::midpoint(self.deviation[0] / self.ground[0].abs(), self.deviation[1] / self.ground[1].abs())
    }

    /// Whether this is walking (or running).
    pub(super) fn check(self) -> Result<(), Refusal> {
        let mean = |values: [f32; 2]| f32::midpoint(values[0], values[1]);
        if self.step[0].min(self.step[1]) < LEAST_STEP {
            return Err(Refusal::Steps(self));
        }
        if mean(self.lift) < LEAST_LIFT {
            return Err(Refusal::Lift(self));
        }
        if !UNDERFOOT.contains(&(mean(self.ground) / self.speed)) {
            return Err(Refusal::Underfoot(self));
        }
        if !EQUAL.contains(&(self.ground[0] / self.ground[1])) {
            return Err(Refusal::Unequal(self));
        }
        if self.unsteadiness() > MOST_UNSTEADY {
            return Err(Refusal::Unsteady(self));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_measure_alone_refuses_what_is_no_walk() {
        let walk = Support {
            step: [0.6, 0.62],
            ground: [1.2, 1.18],
            deviation: [0.2, 0.2],
            lift: [0.05, 0.04],
            speed: 1.2,
            flight: 0.0,
        };
        assert!(walk.check().is_ok() && !walk.is_running());
        let refused = |support: Support, words: &str| {
            let why = support.check().unwrap_err();
            assert!(why.is_no_walk() && why.to_string().contains(words), "{why} should say {words}");
        };
        refused(Support { step: [0.6, 0.01], ..walk }, "the feet do not pass each other");
        refused(Support { step: [-0.1, 0.6], ..walk }, "-0.10 m in front of the right");
        refused(Support { lift: [-0.04, 0.04], ..walk }, "not walking forwards");
        // skating: the standing foot goes along; marching: the ground passes and the body does not
        refused(Support { ground: [0.3, 0.3], ..walk }, "the body goes at 1.20 m/s; a mean of 0.4 to 1.6");
        refused(Support { speed: 0.6, ..walk }, "but the body goes at 0.60 m/s");
        // a scooter: one foot pushes and the other stands on it
        refused(
            Support { ground: [1.8, 0.5], ..walk },
            "1.80 m/s under the left foot and at 0.50 m/s under the right",
        );
        refused(Support { ground: [0.5, 1.8], ..walk }, "a ratio of 0.33 to 3 is needed");
        refused(Support { deviation: [1.0, 1.1], ..walk }, "deviates by 0.88 of its mean; up to 0.8 is used");
        let run = Support { flight: 0.06, ..walk };
        assert!(run.check().is_ok() && run.is_running());
    }
}
