//! Failures: of the headset, against which another session may help, and of our own.

use super::error::Error;

/// Why a session could not begin, or was lost.
pub(super) enum Failure {
    /// A failure of the headset: another session may help.
    Headset(Error),
    /// A failure of our own: no session would help.
    Fatal(crate::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Headset(error)
    }
}

impl From<crate::Error> for Failure {
    /// Vulkan's errors may come from the runtime's device, which the next session replaces. All others are ours.
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Gpu(error) => Self::Headset(error.into()),
            crate::Error::Render(error) => Self::Headset(error.into()),
            other => Self::Fatal(other),
        }
    }
}

/// The system has no thread for us.
pub(super) fn no_thread(error: &std::io::Error) -> crate::Error {
    crate::Error::Usage {
        message: format!("no thread for the headset: {error}"),
        hint: "close other programs, then try again".to_owned(),
    }
}

/// A thread has panicked.
pub(super) fn panicked(which: &str) -> crate::Error {
    crate::Error::Usage {
        message: format!("the thread {which} panicked"),
        hint: "this is a fault of the program: report it with what stands above".to_owned(),
    }
}
