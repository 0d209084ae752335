//! Ranges of what a stride is.

use std::f32::consts::{PI, TAU};

/// A stride that turns further than this is refused, degrees.
#[doc(hidden)]
pub const MAX_TURN_DEG: f32 = 20.0;

/// A stride that turns further than this is called curved in [`Gait::provenance`], degrees.
#[doc(hidden)]
pub const CURVED_DEG: f32 = 10.0;

/// Body and travel may point this far apart; beyond, it is walking sideways or backwards, degrees.
pub(super) const MAX_CRAB_DEG: f32 = 35.0;

/// Duration of a stride, s.
pub(super) const STRIDE_S: std::ops::RangeInclusive<f32> = 0.5..=3.5;

/// Speed of a stride, m/s.
pub(super) const SPEED: std::ops::RangeInclusive<f32> = 0.15..=8.0;

/// The other foot strikes within this share of the stride.
pub(super) const OTHER_FOOT: std::ops::RangeInclusive<f32> = 0.25..=0.75;

/// Gaits keep the recording's rate up to this, Hz.
pub(super) const MAX_RATE: f32 = 60.0;

/// Times a cyclic recording is repeated to look for strikes; the strides of the second repetition are taken.
#[doc(hidden)]
pub const REPEATS: usize = 4;

/// An angle in (-pi, pi].
pub(super) fn wrap(angle: f32) -> f32 {
    let turned = angle.rem_euclid(TAU);
    if turned > PI { turned - TAU } else { turned }
}
