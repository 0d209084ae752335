//! Crowds of thousands of people who look happy, angry, sad or neutral, by how they walk and where they look.
//!
//! ```
//! use gaitway::sim::Backend;
//! use gaitway::{Emotion, Scene};
//!
//! # fn main() -> gaitway::Result<()> {
//! // 60 people in the built-in crossing, on the CPU; `Backend::Auto` takes the best Vulkan device
//! let mut crowd = Scene::load("crossing")?.agents(60).seed(7).backend(Backend::Cpu).start()?;
//! crowd.step(5 * 30)?; // five seconds
//! let sad = crowd.people()?.filter(|person| person.emotion() == Emotion::Sad);
//! for person in sad {
//!     println!("{} at {} m walks {:.2} m/s", person.id, person.position, person.velocity.length());
//! }
//! # Ok(())
//! # }
//! ```
//!
//! | you want | begin at |
//! | --- | --- |
//! | a crowd, from a built-in scene or a file | [`Scene::load`] |
//! | a scene of your own, in code | [`Scenario`], [`Scene::of`] |
//! | who is where and feels what | [`Simulation::people`], [`Simulation::person`] |
//! | pictures and videos | `scene::Stage`, [`export`] |
//! | trajectories for PedPy and JuPedSim | [`export`] |
//! | to lead a robot or a tracked person | [`Simulation::lead`] |
//! | your own motion capture | [`gait::import`], [`gait::stride`], [`GaitLibrary`] |
//! | what people would see in a walk | [`perception::model::Model`] |
//! | a recorded crowd that walks again | [`replay`] |
//! | a study with people: its plan, its protocol, its analysis | [`low_level::study`] |
//! | tests, effect sizes, agreement of raters, power | [`low_level::statistics`] |
//! | a window, a headset | `view`, `xr` |
//! | what an observer would see in a crowd that walks | [`closed_loop`] |
//! | to check your device | [`verify`], [`bench`](mod@bench), [`validate`] |
//! | buffers and kernels themselves, without a promise | [`low_level`] |
//!
//! What is guaranteed: the same version, scenario and seed give the same crowd, bit for bit, on the CPU and on every Vulkan
//! device whose arithmetic is exact. [`verify`] tells whether yours is.
//!
//! # The rooms
//! ```text
//!  mocap files ─► gait ─► perception ─► library ─► avatar ─► scenario ─► sim ─► render ─► scene ─► view, xr
//!  (BVH, AMC,     strides, ratings,     GEA(e),    rig map,  who walks   one    culling,  the one
//!   C3D, npz)     speed    features     clips      retarget  where, how  step   draw      assembly
//! ```
//! A module uses what stands to its left, never what stands to its right (`tests/layers.rs`).
//! [`low_level::kernels`] is the floor under [`low_level::reference`] (CPU) and `gpu` (Vulkan).
//!
//! Frames: right-handed, y up, metres, seconds, radians. A model faces +z. The ground plane is stored as
//! `(x, z)`; only [`low_level::ground`] crosses between the two.
#![deny(missing_docs)]
// A library without the program leaves readers and writers out, and what only they use stays.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports, reason = "for the features left out"))]
// The same scenario and seed give the same crowd on every machine (clippy.toml).
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]

#[cfg(test)]
extern crate self as gaitway; // what tests share calls the library by its name

pub mod avatar;
pub mod bench;
#[doc(hidden)]
#[cfg(feature = "cli")]
#[allow(clippy::disallowed_methods, reason = "shows crowds, makes none")]
pub mod cli;
pub mod closed_loop;
#[doc(hidden)]
pub mod emotion;
pub mod error;
#[allow(clippy::disallowed_methods, reason = "writes crowds, makes none")]
pub mod export;
#[doc(hidden)]
pub mod file;
pub mod gait;
mod glb;
#[doc(hidden)]
#[cfg(feature = "vulkan")]
#[allow(unsafe_code, reason = "all calls into Vulkan live here, one SAFETY comment per block")]
pub mod gpu;
#[doc(hidden)]
pub mod ground;
mod hash;
#[doc(hidden)]
pub mod kernels;
mod keys;
mod lanes;
pub mod library;
pub mod low_level;
#[allow(clippy::disallowed_methods, reason = "judges gaits, makes no crowds")]
pub mod perception;
pub mod picture;
mod random;
#[doc(hidden)]
pub mod reference;
#[cfg(feature = "vulkan")]
#[allow(unsafe_code, reason = "records draw calls through Vulkan, one SAFETY comment per block")]
#[allow(clippy::disallowed_methods, reason = "shows crowds, makes none")]
pub mod render;
pub mod replay;
pub mod scenario;
pub mod scene;
pub mod sim;
mod spelling;
#[doc(hidden)]
#[allow(clippy::disallowed_methods, reason = "judges answers, makes no crowds")]
pub mod statistics;
#[doc(hidden)]
pub mod stop;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
#[cfg(feature = "cli")]
pub mod sweep;
mod table;
#[allow(clippy::disallowed_methods, reason = "judges crowds, makes none")]
pub mod validate;
pub mod verify;
#[cfg(feature = "view")]
#[allow(unsafe_code, reason = "makes a window's surface and swapchain, one SAFETY comment per block")]
#[allow(clippy::disallowed_methods, reason = "shows crowds, makes none")]
pub mod view;
mod wkt;
#[cfg(feature = "xr")]
#[allow(unsafe_code, reason = "calls into OpenXR with Vulkan's handles, one SAFETY comment per block")]
#[allow(clippy::disallowed_methods, reason = "shows crowds, makes none")]
pub mod xr;

pub use emotion::Emotion;
pub use error::{Error, Result};
pub use library::GaitLibrary;
pub use scenario::Scenario;
pub use scene::Scene;
pub use sim::Simulation;
