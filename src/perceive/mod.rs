//! The closed loop: which emotion the crowd that is shown really shows.
//!
//! ```text
//!  simulation ─► palettes of every frame ─► joints ─► one stride each ─► 29 features ─► classifier ─► wanted against seen
//! ```
//! [`record()`] runs the frame passes for everyone at the rate of the steps and takes the 16 joints of every body from its
//! palette: positions in the world as drawn, after retargeting, avoidance, phase, blending and gaze. [`Track::stride`] cuts
//! the first stride that is a walk, exactly as strides of motion capture are cut ([`crate::gait::stride`]), so that the
//! classifier gets of our people what it gets of recorded ones. [`features()`] runs the kernel `gait_features`. Nothing of
//! the library's clips, and no label, is looked at on the way.
//!
//! People who do not walk during the recording are counted apart, with the reason ([`Unusable`]).

mod features;
mod practice;
mod record;
mod score;
mod track;

pub use features::features;
pub use practice::{practice_alone, practice_in_crowd};
pub use record::{Recorder, record};
pub use score::{HUMANS, Score, wilson};
pub use track::{MAX_TURN_DEG, Seen, Track, Unusable, WALKING_SHARE};
