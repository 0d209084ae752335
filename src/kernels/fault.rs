//! What is wrong with a shader, and where.

use std::fmt;

/// One fault of a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Fault {
    /// `file:line:column`; the file, or the kernel's name, where no line is to blame.
    pub place: String,
    /// What is wrong there.
    pub message: String,
}

/// A shader that does not compile.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// At least one.
    pub faults: Vec<Fault>,
}

impl Error {
    /// One fault.
    pub fn at(place: impl fmt::Display, message: impl fmt::Display) -> Self {
        Self { faults: vec![Fault { place: place.to_string(), message: message.to_string() }] }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.message)
    }
}

/// One line a fault.
impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
        f.write_str(&lines.join("\n"))
    }
}

impl std::error::Error for Error {}
