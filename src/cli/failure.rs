//! How a command fails: exit codes, and errors of the program itself.

use crate::Error;

/// Exit code: it went wrong while doing.
pub(super) const WENT_WRONG: u8 = 1;

/// Exit code: the command line is wrong.
pub(super) const WRONG_COMMAND_LINE: u8 = 2;

/// An error of the command line's own: what is not possible, and what to do instead.
pub(super) fn usage(message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Usage { message: message.into(), hint: hint.into() }
}

/// An error of a command during its work, and the way out.
pub(super) fn failed(message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Failed { message: message.into(), hint: hint.into() }
}
