//! Crowds that somebody else recorded or simulated, walked again with bodies, gaits and emotions.
//!
//! ```text
//!  file ──► read ──► Trajectories ──► Path ──► Replay ──► sim
//!           formats   people, gaps    smooth    who walks   led step by step
//! ```
//! Every person is an agent that is led ([`crate::sim::Simulation::lead`]): at the end of each step it is where the
//! recording says. Body, stride and heading follow from how it moves, as for everyone else; walkers make way for it.

mod crowd;
mod error;
mod path;
pub mod read;

pub use crowd::{Replay, ReplayOptions};
pub use error::Error;
pub use path::{Moment, Path};
pub use read::tracks::{Report, Sample, Track, Trajectories};
pub use read::{Column, Columns, Format, Options, Pixels, name_of_unit, read};
