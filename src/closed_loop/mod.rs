//! The closed loop: which emotions a classifier sees in the crowd as drawn.
//!
//! ```text
//!  simulation ─► palettes of every frame ─► joints ─► one stride each ─► 29 features ─► classifier ─► wanted against seen
//! ```
//! [`record()`] runs the kernels of a frame for every agent at the rate of the steps. It takes the 16 joints of every body from
//! its palette: positions in the world as drawn, after retargeting, avoidance, phase, blending and gaze. [`Track::stride`] cuts
//! the first stride that is a walk, exactly as strides of motion capture are cut ([`crate::gait::stride`]). So the classifier
//! gets the same input of our agents as of recorded people. [`features()`] runs the kernel `gait_features`. The loop reads
//! neither clips of the library nor labels.
//!
//! Agents that do not walk during the recording are counted apart, with the reason ([`Unusable`]).
//!
//! ```
//! use gaitway::Scene;
//! use gaitway::closed_loop::{Recorder, Score, Seen, record};
//! use gaitway::perception::model::Model;
//! use gaitway::sim::Backend;
//!
//! # fn main() -> gaitway::Result<()> {
//! let scene = Scene::load("crossing")?.agents(30).backend(Backend::Cpu).build()?;
//! let (mut crowd, _) = scene.start_with_bodies()?;
//! let watched = Recorder::of(&scene.scenario, 30, 75); // steps before it, and of it
//! let tracks = record(&mut crowd, &scene.cast, &watched, &mut |_| ())?;
//! let model = Model::built_in()?;
//! let answers = tracks.iter().filter_map(|track| match track.stride() {
//!     Seen::Walk(gait) => Some((track.wanted, model.predict(&gait).emotion)),
//!     Seen::Nothing(_) => None,
//! });
//! let score = Score::of(answers);
//! println!("{:.0} % of {} walks are seen as wanted", 100.0 * score.accuracy, score.n);
//! # Ok(())
//! # }
//! ```

mod features;
mod practice;
mod record;
mod score;
mod speeds;
mod track;

pub use features::features;
pub use practice::{practice_alone, practice_in_crowd};
pub use record::{Recorder, record};
pub use score::{HUMANS, Score, wilson};
pub(crate) use speeds::strides_at;
pub use track::{MAX_TURN_DEG, Seen, Track, Unusable, WALKING_SHARE};
