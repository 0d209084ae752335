//! Results as files: trajectories that PedPy and JuPedSim read, images, videos, figures. Every file appears by rename when
//! complete.
//!
//! ```
//! use gaitway::Scene;
//! use gaitway::export::{Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
//! use gaitway::sim::Backend;
//! use glam::Vec2;
//!
//! # fn main() -> gaitway::Result<()> {
//! # let path = std::env::temp_dir().join(format!("gaitway-example-{}.sqlite", std::process::id()));
//! let scene = Scene::load("crossing")?.agents(40).backend(Backend::Cpu).build()?;
//! let (ground, agents) = (Walkable::from(&scene.geometry), scene.agents_info());
//! let mut file = TrajectoryWriter::create(&path, TrajectoryFormat::Sqlite, 10.0, &ground, agents)?;
//! let mut crowd = scene.start()?;
//! for _ in 0..20 {
//!     let people = crowd.people()?.map(|person| (person.position, person.heading));
//!     let (positions, headings): (Vec<Vec2>, Vec<f32>) = people.unzip();
//!     file.frame(&Frame { positions: &positions, headings: &headings, ..Frame::default() })?;
//!     crowd.step(3)?; // a tenth of a second
//! }
//! file.finish()?;
//! # std::fs::remove_file(path).expect("written above");
//! # Ok(())
//! # }
//! ```

mod agents;
#[cfg(feature = "parquet")]
mod agents_parquet;
mod area;
mod atomic;
pub mod chart;
pub(crate) mod columns;
#[doc(hidden)]
pub mod figure;
pub mod image;
#[cfg(feature = "parquet")]
mod long_file;
#[cfg(feature = "parquet")]
mod parquet_chunk;
#[cfg(feature = "parquet")]
mod parquet_encode;
#[cfg(feature = "parquet")]
mod parquet_table;
mod plane;
#[cfg_attr(not(feature = "charts"), path = "without_charts.rs")]
mod raster;
#[cfg(feature = "parquet")]
mod rounded;
mod svg;
pub mod trajectory;
#[cfg(feature = "parquet")]
mod trajectory_block;
#[cfg_attr(not(feature = "parquet"), path = "without_parquet.rs")]
mod trajectory_parquet;
#[cfg(feature = "parquet")]
mod trajectory_rows;
#[cfg_attr(not(feature = "sqlite"), path = "without_sqlite.rs")]
mod trajectory_sqlite;
pub mod video;

pub use agents::{AgentInfo, AgentKind};
pub use area::Ground;
pub use atomic::AtomicFile;
pub use trajectory::{Frame, TrajectoryFormat, TrajectoryWriter, Walkable};

use std::path::PathBuf;

/// A result could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file system refused.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The trajectory database refused.
    #[error("cannot write {path:?}: {source}")]
    Sqlite {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The Parquet file could not be encoded or written.
    #[error("cannot write {path:?}: {source}")]
    Parquet {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A picture or video could not be written.
    #[error(transparent)]
    Picture(#[from] image::Error),
    /// What was to be written does not fit the format.
    #[error("{path:?}: {message}")]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What does not fit, with the value found, what is allowed, and the way out.
        message: String,
    },
}
