//! Crowds recorded or simulated elsewhere, walked again with bodies, gaits and emotions.
//!
//! ```text
//!  file ──► read ──► Trajectories ──► Path ──► Replay ──► sim
//!           formats   people, gaps    smooth    who walks   led step by step
//! ```
//! Every person is a led agent ([`crate::sim::Simulation::lead`]): at the end of each step it is where the recording says.
//! Body, stride and heading follow from its motion, as for all agents. Simulated walkers make way for it.
//!
//! ```
//! use gaitway::Scene;
//! use gaitway::replay::{Options, Replay, ReplayOptions, read};
//! use gaitway::sim::Backend;
//!
//! # fn main() -> gaitway::Result<()> {
//! # let path = std::env::temp_dir().join(format!("gaitway-example-{}.csv", std::process::id()));
//! # let rows = (0..50_u8).flat_map(|frame| [(frame, 1, 1.0), (frame, 2, 2.0)]);
//! # let rows = rows.map(|(frame, person, z)| format!("{person},{frame},{:.2},{z}\n", f32::from(frame) * 0.12));
//! # std::fs::write(&path, format!("id,frame,x,y\n{}", rows.collect::<String>())).expect("a folder for files");
//! let recording = read(&path, &Options { frame_rate: Some(10.0), ..Options::default() })?;
//! let replay = Replay::new(&recording, ReplayOptions::default());
//! let walkers = 5; // simulated, among the recorded people
//! let place = recording.scene("street", walkers, 7);
//! let scene = Scene::of(place).replay(replay).backend(Backend::Cpu).build()?;
//! let mut crowd = scene.start()?;
//! scene.step(&mut crowd, 30)?; // leads the recorded people
//! println!("{} people", crowd.people()?.count());
//! # std::fs::remove_file(path).expect("written above");
//! # Ok(())
//! # }
//! ```

mod crowd;
mod error;
mod path;
pub mod read;

pub use crowd::{Replay, ReplayOptions};
pub use error::Error;
pub use path::{Moment, Path};
pub use read::tracks::{Report, Sample, Track, Trajectories};
pub use read::{Column, Columns, ColumnsError, Format, Options, Pixels, name_of_unit, read};
