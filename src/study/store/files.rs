//! Names of the files in a folder of data.

/// Name of the store.
pub const STORE: &str = "study.sqlite";
/// Name of the folder with what participants did in a headset, in a folder for each code.
pub const RECORDINGS: &str = "recordings";
/// Name of the file of the platform's ids.
pub const LINKS: &str = "links.sqlite";
