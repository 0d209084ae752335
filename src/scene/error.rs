//! What can be wrong with the parts of a scene.

use std::path::PathBuf;

/// The parts of a scene do not fit together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A rig map is for an avatar that the scenario does not have.
    #[error("rig map {}: there is no avatar {name:?}", file.display())]
    RigMap {
        /// The rig map.
        file: PathBuf,
        /// The avatar that it names.
        name: String,
        /// The way out, with the scenario's avatars.
        hint: String,
    },
    /// An avatar is neither a generated body nor a file that is read.
    #[error("population.avatars: there is no avatar {name:?}")]
    Avatar {
        /// The avatar.
        name: String,
    },
    /// A camera is to follow an agent that does not exist.
    #[error("agent {agent}: there are {agents} agents, numbered from 0")]
    NoAgent {
        /// The agent, from 0.
        agent: u32,
        /// How many there are.
        agents: u32,
    },
}

impl Error {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::RigMap { hint, .. } => Some(hint),
            Self::Avatar { .. } => {
                Some("use \"female\", \"male\", or the path of a .glb, .gltf or .vrm file")
            }
            Self::NoAgent { .. } => Some("follow another one, or ask for more agents"),
        }
    }
}
