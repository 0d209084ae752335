//! The recorded motion of one agent, and the stride to judge.

use crate::emotion::Emotion;
use crate::gait::stride::{self, Stride};
use crate::gait::{Gait, Recording};
use serde::Serialize;

/// A stride that turns further than this is no straight walk, degrees.
#[doc(hidden)]
pub const MAX_TURN_DEG: f32 = 30.0;
/// A stride slower than this share of the preferred speed is no walk: the agent queues or lets others pass.
#[doc(hidden)]
pub const WALKING_SHARE: f32 = 0.5;
/// One stride in units of the unwrapped phase.
const STRIDE: u64 = 1 << 32;

/// One agent's joints, as shown, and the phase of its walk.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    /// The emotion that the agent is to show.
    pub wanted: Emotion,
    /// Preferred speed of its gait, m/s.
    pub preferred_speed: f32,
    /// World positions of the joints, m.
    pub recording: Recording,
    /// Phase at each frame, unwrapped: 2^32 is one stride, whole strides are strikes of the left foot.
    pub phase: Vec<u64>,
}

/// Why an agent has no stride to judge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Unusable {
    /// No whole stride from one strike of the left foot to the next: the recording is too short.
    NoWholeStride,
    /// It stands, or its strides are slower than [`WALKING_SHARE`] of the preferred speed.
    Slow,
    /// Its strides turn further than [`MAX_TURN_DEG`], or go sideways.
    Turning,
}

impl Unusable {
    /// All reasons.
    pub const ALL: [Self; 3] = [Self::NoWholeStride, Self::Slow, Self::Turning];

    /// Words for a report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoWholeStride => "no whole stride",
            Self::Slow => "slow",
            Self::Turning => "turning",
        }
    }
}

/// What was seen of an agent.
#[derive(Debug, Clone, PartialEq)]
pub enum Seen {
    /// The first stride that is a walk.
    Walk(Box<Gait>),
    /// None is.
    Nothing(Unusable),
}

impl Track {
    /// The first stride that is a walk; without one, what was wrong with the last.
    ///
    /// The gait has as many frames as the recording has over the stride; its speed is that over the ground; its label is
    /// the wanted emotion.
    pub fn stride(&self) -> Seen {
        #[allow(clippy::cast_precision_loss, reason = "a count of frames")]
        let end = self.recording.poses.len().saturating_sub(1) as f32;
        let mut reason = if self.is_slow(0.0, end) { Unusable::Slow } else { Unusable::NoWholeStride };
        for pair in self.strikes().windows(2) {
            match self.between(pair[0], pair[1]) {
                Ok(stride) => return Seen::Walk(Box::new(stride.gait)),
                Err(found) => reason = found,
            }
        }
        Seen::Nothing(reason)
    }

    /// When the left foot strikes, in frames.
    pub fn strikes(&self) -> Vec<f32> {
        let mut strikes = Vec::new();
        for (frame, pair) in self.phase.windows(2).enumerate() {
            // whole strides in [before, after): one at most, since a step is at most half a stride
            let next = pair[0].next_multiple_of(STRIDE);
            if next < pair[1] {
                #[allow(
                    clippy::cast_precision_loss,
                    clippy::cast_possible_truncation,
                    reason = "a share of a step, and a count of frames"
                )]
                let at = (frame as f64 + (next - pair[0]) as f64 / (pair[1] - pair[0]) as f64) as f32;
                strikes.push(at);
            }
        }
        strikes
    }

    fn between(&self, from: f32, to: f32) -> Result<Stride, Unusable> {
        // too slow or too fast for the cutter means too slow here: agents do not run at 8 m/s
        let straight = stride::between(&self.recording, [from, to], MAX_TURN_DEG);
        let stride = straight
            .map_err(|_why| if self.is_slow(from, to) { Unusable::Slow } else { Unusable::Turning })?;
        if stride.gait.speed < WALKING_SHARE * self.preferred_speed {
            Err(Unusable::Slow)
        } else {
            Ok(stride)
        }
    }

    /// Whether the root moves less between two frames than half the walk.
    fn is_slow(&self, from: f32, to: f32) -> bool {
        let root = |frame: f32| {
            let poses = &self.recording.poses;
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a frame of the recording"
            )]
            let frame = (frame.round() as usize).min(poses.len().saturating_sub(1));
            poses.get(frame).map(|pose| pose[0].with_y(0.0)).unwrap_or_default()
        };
        let seconds = (to - from) / self.recording.frame_rate;
        root(from).distance(root(to)) < WALKING_SHARE * self.preferred_speed * seconds
    }
}

#[cfg(test)]
#[allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test: a failure is a panic that prints; small positive numbers"
)]
mod tests {
    use super::*;
    use crate::gait::walker::{Sex, person};
    use crate::gait::{JOINT_COUNT, Joint};
    use glam::{Quat, Vec3};

    /// A walker along a heading, at a fraction of its speed, turning by `turn` radians a second.
    fn track(share: f32, turn: f32) -> (Gait, Track) {
        let gait = person(Emotion::Happy, Sex::Female, 3, 0).unwrap();
        let rate = 30.0;
        let stride = gait.cycle_time() / share;
        let (mut at, mut poses, mut phase) = (Vec3::new(3.0, 0.0, -7.0), Vec::new(), Vec::new());
        for frame in 0..120 {
            let seconds = frame as f32 / rate;
            let strides = f64::from(seconds / stride) + 0.4;
            let place = strides.fract() as f32 * gait.poses.len() as f32;
            let (a, b) = (place as usize % gait.poses.len(), (place as usize + 1) % gait.poses.len());
            let heading = Quat::from_rotation_y(0.7 + turn * seconds);
            let pose = std::array::from_fn(|j| {
                at + heading * gait.poses[a][j].lerp(gait.poses[b][j], place.fract())
            });
            poses.push(pose);
            phase.push((strides * STRIDE as f64) as u64);
            at += heading * Vec3::Z * (gait.speed * share / rate);
        }
        let recording = Recording::new("agent", rate, poses);
        let preferred_speed = gait.speed;
        (gait, Track { wanted: Emotion::Happy, preferred_speed, recording, phase })
    }

    #[test]
    fn a_stride_that_is_shown_is_the_gait_that_was_played() {
        for turn in [0.0, 0.2] {
            let (gait, track) = track(1.0, turn);
            let Seen::Walk(seen) = track.stride() else { panic!("no walk at {turn}") };
            assert!((seen.speed - gait.speed).abs() < 0.02, "{} {}", seen.speed, gait.speed);
            assert!((seen.cycle_time() - gait.cycle_time()).abs() < 0.01);
            let apart = |pose: &crate::gait::Pose| {
                (pose[Joint::LeftFoot as usize] - pose[Joint::RightFoot as usize]).z
            };
            let (first, want) = (apart(&seen.poses[0]), apart(&gait.poses[0]));
            assert!((first - want).abs() < 0.03, "phase 0 is the left strike: {first} {want}");
            for joint in 0..JOINT_COUNT {
                let place = |gait: &Gait| {
                    gait.poses.iter().map(|p| p[joint] - p[0]).sum::<Vec3>() / gait.poses.len() as f32
                };
                let off = place(&seen).distance(place(&gait));
                assert!(off < 0.015, "joint {joint} turn {turn}: {off} m");
            }
        }
    }

    #[test]
    fn agents_that_stand_creep_or_turn_are_counted_apart() {
        for slow in [0.3, 0.4, 0.45] {
            assert_eq!(track(slow, 0.0).1.stride(), Seen::Nothing(Unusable::Slow), "{slow}");
        }
        assert!(matches!(track(0.55, 0.0).1.stride(), Seen::Walk(_)), "half its speed is a walk");
        assert_eq!(track(1.0, 0.9).1.stride(), Seen::Nothing(Unusable::Turning));
        let (_, mut still) = track(1.0, 0.0);
        still.phase.fill(5);
        assert_eq!(still.stride(), Seen::Nothing(Unusable::NoWholeStride));
    }
}
