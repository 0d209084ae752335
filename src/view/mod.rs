//! The desktop window: a crowd to look at, to stop, to query and to film.
//!
//! [`run`] opens the window and gives it the crowd of a scene. Before every frame the clock steps the crowd. The renderer
//! draws it into an image of the window's size, the panel is drawn over it, and the window gets a copy.
//!
//! ```no_run
//! use gaitway::scene::Scene;
//! use gaitway::view::{self, Plan};
//!
//! # fn main() -> gaitway::Result<()> {
//! let plan = Plan { has_markers: true, seconds: Some(60.0), ..Plan::default() };
//! let outcome = view::run(plan, Scene::load("garden")?.agents(200))?;
//! println!("{} frames on {}", outcome.frames, outcome.device);
//! # Ok(())
//! # }
//! ```
//!
//! A machine without a window says so; `gaitway render` draws the same images into files.

mod camera;
mod canvas;
mod crowd;
mod error;
mod mirror;
mod outcome;
mod panel;
#[doc(hidden)]
pub mod pick;
mod plan;
mod shares;
mod surface;
mod times;
mod window;

pub use camera::{CameraMode, Rig};
pub use crowd::Picked;
pub use error::Error;
pub use mirror::{Mirrored, Source, mirror};
pub use outcome::Outcome;
pub use plan::{Choice, Plan};
pub use times::MeanTimes;
pub use window::run;
