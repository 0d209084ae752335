//! What was found in a scene, and what of it was not taken over as it is.

use super::xml::{Source, element, line};
use roxmltree::Node;
use serde::Serialize;
use std::fmt;

/// Something of a scene that was taken over as something like it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Approximation {
    /// The file that it stands in, without its folder.
    pub file: String,
    /// Its line, from 1.
    pub line: u32,
    /// The element, such as `<VelComponent type="vel_field">`.
    pub element: String,
    /// What stands for it.
    pub instead: String,
}

impl fmt::Display for Approximation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}: {}", self.file, self.line, self.element, self.instead)
    }
}

/// What was found in a scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Report {
    /// Agents.
    pub agents: usize,
    /// Obstacles, as solid polygons.
    pub obstacles: usize,
    /// Agents whose way ends somewhere; the others walk in circles or stand.
    pub with_an_end: usize,
    /// What was taken over as something like it.
    pub approximated: Vec<Approximation>,
    /// What is not taken over, with file and line.
    pub unsupported: Vec<String>,
    /// What was read otherwise than written, or inferred.
    pub notes: Vec<String>,
}

impl Report {
    pub(super) fn unsupported(&mut self, place: &str, what: &str) {
        let line = format!("{place}: {what}");
        if !self.unsupported.contains(&line) {
            self.unsupported.push(line);
        }
    }

    pub(super) fn approximate(&mut self, source: &Source, node: &Node<'_, '_>, instead: impl Into<String>) {
        let (file, line, element) = (source.name(), line(node), element(node));
        let found = Approximation { file, line, element, instead: instead.into() };
        if !self.approximated.contains(&found) {
            self.approximated.push(found);
        }
    }

    pub(super) fn note(&mut self, note: impl Into<String>) {
        let note = note.into();
        if !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }
}
