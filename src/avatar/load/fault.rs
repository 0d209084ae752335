//! Why a file is refused.

use super::super::Error;

/// Largest file read, bytes.
pub(super) const MOST_BYTES: u64 = 512 << 20;

/// Why a file is refused, before its name is known.
pub(super) enum Fault {
    /// What is wrong, with what was found and what was expected.
    Plain(String),
    /// It is packed by an extension that is not read.
    Packed { extension: String, hint: &'static str },
    /// Its joints were not recognised: which, and a map to fill in.
    Rig { message: String, map: String },
}

impl From<String> for Fault {
    fn from(message: String) -> Self {
        Self::Plain(message)
    }
}

impl From<&str> for Fault {
    fn from(message: &str) -> Self {
        Self::Plain(message.to_owned())
    }
}

impl Fault {
    /// The error of the file of that name.
    pub(super) fn of(self, name: &str) -> Error {
        let name = name.to_owned();
        match self {
            Self::Plain(message) => Error::Unusable { name, message },
            Self::Packed { extension, hint } => Error::Packed { name, extension, hint },
            Self::Rig { message, map } => Error::Rig { name, message, map },
        }
    }
}
