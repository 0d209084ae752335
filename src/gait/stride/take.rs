//! A take made ready, and where a stride of it lies.

use crate::gait::{Joint, Pose};

/// A recording made ready: repeated if cyclic, with travel.
pub(super) struct Take {
    pub(super) poses: Vec<Pose>,
    pub(super) rate: f32,
    pub(super) on_the_spot: bool,
    /// Frames of one cycle, and the mismatch that closing it took away; only if the recording is cyclic.
    pub(super) cycle: Option<(usize, f32)>,
}

/// Where a stride begins and ends, in fractional frames.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cut {
    /// The foot that begins and ends it.
    pub(super) foot: Joint,
    pub(super) from: f32,
    pub(super) to: f32,
    /// Strike of the other foot, from `from` to `to`; none where it is not known.
    pub(super) between: Option<f32>,
}

impl Cut {
    /// From one strike of the left foot to the next.
    pub(super) const fn left(from: f32, to: f32) -> Self {
        Self { foot: Joint::LeftFoot, from, to, between: None }
    }

    /// Share of the stride after which the left foot strikes, which is phase 0 of the gait.
    pub(super) fn phase_of_left_strike(&self) -> f32 {
        match (self.foot, self.between) {
            (Joint::RightFoot, Some(between)) => (between - self.from) / (self.to - self.from),
            _ => 0.0,
        }
    }
}
