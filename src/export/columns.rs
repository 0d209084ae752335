//! Columns and metadata of our Parquet files, for those that write them and those that read them.

use std::path::{Path, PathBuf};

/// Number of the frame, from 0: frames are `1 / FRAME_RATE` apart.
pub(crate) const FRAME: &str = "frame";
/// Number of the agent, from 1, as in the databases.
pub(crate) const ID: &str = "id";
/// Place to the right, m.
pub(crate) const X: &str = "x";
/// Place up the page, m: our -z.
pub(crate) const Y: &str = "y";
/// Heading about the vertical as our own frame has it, rad, to 1/1024: 0 faces -y of the page, a quarter
/// of a turn faces x.
pub(crate) const HEADING: &str = "heading_rad";
/// Velocity to the right, m/s, to 1/1024 m/s; null where it is not known.
pub(crate) const VX: &str = "vx";
/// Velocity up the page, the same.
pub(crate) const VY: &str = "vy";
/// False for robots and vehicles.
pub(crate) const IS_PERSON: &str = "is_person";
/// Weights of the emotions, to 1/1024; null where they stay what the table of agents says.
pub(crate) const EMOTIONS: [&str; 4] = ["happy", "angry", "sad", "neutral"];

/// Metadata: the version of gaitway that wrote the file.
pub(crate) const VERSION_KEY: &str = "gaitway.version";
/// Metadata: frames a second.
pub(crate) const FRAME_RATE_KEY: &str = "gaitway.frame_rate";
/// Metadata: the walkable area in the plane of x and y, as well-known text.
pub(crate) const AREA_KEY: &str = "gaitway.walkable_area";

/// Where the table of agents stands beside a file of trajectories: `agents.parquet` beside `trajectories.parquet`, and
/// `NAME.agents.parquet` beside `NAME.parquet`.
pub(crate) fn agents_path(trajectories: &Path) -> PathBuf {
    match trajectories.file_stem().and_then(|stem| stem.to_str()) {
        Some("trajectories") | None => trajectories.with_file_name("agents.parquet"),
        Some(stem) => trajectories.with_file_name(format!("{stem}.agents.parquet")),
    }
}
