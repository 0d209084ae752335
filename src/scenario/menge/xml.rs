//! Files, and attributes of elements, with errors that say where.

use crate::file;
use crate::scenario::error::Error;
use roxmltree::{Document, Node, ParsingOptions};
use std::path::{Path, PathBuf};

/// Largest file read, bytes.
const MAX_BYTES: u64 = 64 << 20;
/// Most elements of a file.
const MAX_NODES: u32 = 2_000_000;

/// A text file.
#[derive(Debug)]
pub(super) struct Source {
    pub(super) path: PathBuf,
    pub(super) text: String,
}

impl Source {
    pub(super) fn read(path: &Path) -> Result<Self, Error> {
        let read = |source| Error::Read { path: path.to_owned(), source };
        let bytes = file::read(path, MAX_BYTES).map_err(read)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let at = error.utf8_error().valid_up_to();
            let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
            let message = "not UTF-8 from here on; save the file as UTF-8".to_owned();
            Error::Syntax { place: format!("{}:{line}", path.display()), message }
        })?;
        // a byte order mark says nothing in UTF-8
        let text = text.strip_prefix('\u{feff}').unwrap_or(&text).to_owned();
        Ok(Self { path: path.to_owned(), text })
    }

    pub(super) fn parse(&self) -> Result<Document<'_>, Error> {
        let options =
            ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
        Document::parse_with_options(&self.text, options).map_err(|error| Error::Syntax {
            place: format!("{}:{}", self.path.display(), error.pos().row),
            message: error.to_string(),
        })
    }

    /// The same for a line of a text that is no XML.
    pub(super) fn wrong_line(&self, line: usize, message: impl Into<String>) -> Error {
        Error::Syntax { place: format!("{}:{line}", self.path.display()), message: message.into() }
    }
}

impl Source {
    /// The file's name, without its folder.
    pub(super) fn name(&self) -> String {
        self.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    }
}

/// The line that an element begins in.
pub(super) fn line(node: &Node<'_, '_>) -> u32 {
    node.document().text_pos_at(node.range().start).row
}

/// `file:line` of an element, with the file's name alone.
pub(super) fn place(source: &Source, node: &Node<'_, '_>) -> String {
    format!("{}:{}", source.name(), line(node))
}

/// An element as it is written, with its type alone.
pub(super) fn element(node: &Node<'_, '_>) -> String {
    match node.attribute("type") {
        Some(kind) => format!("<{} type={kind:?}>", tag(node)),
        None => format!("<{}>", tag(node)),
    }
}

pub(super) fn wrong(source: &Source, node: &Node<'_, '_>, message: impl Into<String>) -> Error {
    Error::Syntax { place: format!("{}:{}", source.path.display(), line(node)), message: message.into() }
}

/// A finite number, if the attribute is there.
pub(super) fn maybe(source: &Source, node: &Node<'_, '_>, name: &str) -> Result<Option<f32>, Error> {
    let Some(text) = node.attribute(name) else { return Ok(None) };
    match text.trim().parse::<f32>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(wrong(source, node, format!("{name}={text:?} of <{}> is not a finite number", tag(node)))),
    }
}

/// A finite number that must be there.
pub(super) fn need(source: &Source, node: &Node<'_, '_>, name: &str) -> Result<f32, Error> {
    maybe(source, node, name)?
        .ok_or_else(|| wrong(source, node, format!("<{}> has no attribute {name}", tag(node))))
}

/// A count of at most `most`.
pub(super) fn count(source: &Source, node: &Node<'_, '_>, name: &str, most: u32) -> Result<u32, Error> {
    let text = node.attribute(name).unwrap_or("");
    match text.trim().parse::<u32>() {
        Ok(value) if value <= most => Ok(value),
        _ => Err(wrong(source, node, format!("{name}={text:?} of <{}> is not 0 to {most}", tag(node)))),
    }
}

pub(super) fn tag<'a>(node: &Node<'a, '_>) -> &'a str {
    node.tag_name().name()
}

/// The elements within an element.
pub(super) fn children<'a, 'input>(
    node: &Node<'a, 'input>,
) -> impl Iterator<Item = Node<'a, 'input>> + use<'a, 'input> {
    node.children().filter(Node::is_element)
}

/// The attribute `type`.
pub(super) fn kind<'a>(node: &Node<'a, '_>) -> &'a str {
    node.attribute("type").unwrap_or("")
}
