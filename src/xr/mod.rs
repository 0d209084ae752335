//! The headset: an OpenXR runtime, the user in the crowd, and recovery from failures.
//!
//! [`Runtime`] is the runtime of the machine, `Session` one run of it (swapchain, spaces, frame loop), [`Rig`] the place of
//! the user's room in the world. [`run`] joins them with a crowd. All calls of OpenXR are made on a thread of their own. The
//! crowd goes on without it. A new session replaces a lost one.
//!
//! ```no_run
//! use gaitway::kernels::Store;
//! use gaitway::scene::Scene;
//! use gaitway::xr::{self, Observer, Plan, UserState};
//!
//! struct Printer;
//! impl Observer for Printer {
//!     fn note(&mut self, line: &str) {
//!         eprintln!("{line}");
//!     }
//!     fn step(&mut self, _: &UserState, _: &Store) -> gaitway::Result<()> {
//!         Ok(())
//!     }
//! }
//!
//! # fn main() -> gaitway::Result<()> {
//! let scene = Scene::load("crossing")?.build()?;
//! let (mut simulation, meshes) = scene.start_with_bodies()?;
//! let plan = Plan { seconds: Some(60.0), ..Plan::default() };
//! let outcome = xr::run(&mut simulation, meshes, &scene, plan, &mut Printer)?;
//! println!("{} frames, {}", outcome.frames.drawn, outcome.ended);
//! # Ok(())
//! # }
//! ```
//!
//! Frames: an OpenXR space is right-handed, y up, metres, as is ours; a view looks along its -z.

mod answer;
mod app;
mod asking;
mod change;
mod clock;
mod cues;
mod error;
mod failure;
mod frames;
mod handover;
mod headset;
mod hidden;
mod input;
mod joints;
mod miniature;
mod mirror;
mod next;
mod observer;
mod outcome;
mod pace;
mod panel;
mod plan;
mod question;
mod recording;
mod rig;
mod running;
mod runtime;
mod session;
mod shared;
mod shown;
mod stage;
mod state;
mod surroundings;
mod survey;
mod swapchain;
mod views;
mod watch;
mod world;

#[doc(hidden)]
pub use answer::Means;
pub use app::run;
#[doc(hidden)]
pub use cues::FrameCount;
pub use error::{Error, Loss};
pub use mirror::Mirror;
pub use observer::Observer;
pub use outcome::{Outage, Outcome};
pub use pace::{FrameSummary, Percentiles};
#[doc(hidden)]
pub use pace::{FrameTimes, Governor};
#[doc(hidden)]
pub use panel::{Choice, MOST_CELLS, MOST_CHARACTERS, Panel, PanelError};
pub use plan::{DEFAULT_VIGNETTE, Opener, Plan, Shot, Shots};
#[doc(hidden)]
pub use question::Answered;
pub use recording::{
    Recorder, Recording, RecordingError, Session as RecordedSession, TrialLabel, UserState, repair,
};
#[doc(hidden)]
pub use recording::{SessionHash, Way, hash_avatars, hash_library, hash_scenario, hash_start, make_way};
pub use rig::Rig;
#[doc(hidden)]
pub use rig::{Stand, Terrain, Walk};
pub use runtime::{Runtime, RuntimeInfo};
#[doc(hidden)]
pub use stage::{Stage, Walked};
pub use state::State;
pub use survey::{Survey, survey};
#[doc(hidden)]
pub use world::World;

/// Silences the OpenXR loader on standard error, since [`Error`] says the same in one line; `XR_LOADER_DEBUG` wins. Call it
/// while the program has one thread.
pub(crate) fn hush_loader() {
    const LEVEL: &str = "XR_LOADER_DEBUG";
    if std::env::var_os(LEVEL).is_none() {
        // SAFETY: called before the program starts a second thread, so no thread reads the environment meanwhile.
        unsafe { std::env::set_var(LEVEL, "none") }
    }
}
