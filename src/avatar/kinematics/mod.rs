//! Walks as gait laboratories see them: joint angles over the stride, of a gait and of a body as drawn, beside those of
//! healthy adults, and what an emotion changes in them beside what it changes in people.
//!
//! Angles are in degrees. Flexion, forward and toe up are positive; turns are positive towards the own side.

mod angles;
mod cues;
mod drawn;
mod norm;
mod report;
mod speeds;

#[cfg(test)]
pub(crate) use angles::Side;
pub(crate) use angles::{Angle, Walk};
pub(crate) use drawn::picture;
pub(crate) use norm::NORM;
pub(crate) use report::{Report, Rms, Scalar, measure};
pub(crate) use speeds::{AtSpeed, SPEEDS, at_speed};
