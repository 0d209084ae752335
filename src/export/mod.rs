//! Results as files: trajectories that PedPy and JuPedSim read, pictures, videos, figures. Every file appears by rename when complete.

mod agents;
mod area;
mod atomic;
pub mod chart;
mod font;
pub mod image;
pub mod trajectory;
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
        source: rusqlite::Error,
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
