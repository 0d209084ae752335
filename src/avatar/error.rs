//! Why a character cannot be loaded or driven.

/// A character could not be loaded or driven.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file.
        path: std::path::PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The file cannot be used as a character.
    #[error("{name:?}: {message}")]
    Unusable {
        /// File or avatar.
        name: String,
        /// Why, with what was found and what was expected.
        message: String,
    },
    /// The file is packed in a way that is not read.
    #[error("{name:?} needs the glTF extension {extension}, which is not read")]
    Packed {
        /// File or avatar.
        name: String,
        /// The extension, as the file names it.
        extension: String,
        /// What to do; a command line where there is one.
        hint: &'static str,
    },
    /// The joints of a character were not recognised.
    #[error("character {name:?}: {message}")]
    Rig {
        /// File or avatar.
        name: String,
        /// Which joints are missing, or what is wrong with the rig map.
        message: String,
        /// A [`RigMap`](super::RigMap) to fill in, as TOML: what was found, and the file's joints as comments.
        map: String,
    },
}

impl Error {
    /// What the user can do about it, where the message does not say so itself.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Packed { hint, .. } => Some(hint),
            Self::Rig { .. } => Some(
                "fill in the rig map on standard output (`gaitway ... > rig.toml` keeps it) and give it with \
                 --rig-map rig.toml, or in the scenario: population.rig_maps = [\"rig.toml\"]",
            ),
            _ => None,
        }
    }
}
