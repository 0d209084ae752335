//! Keys of TOML texts: the lines that they stand in, the parser's errors in our words, values that do not do.

use crate::spelling::nearest;
use std::fmt;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A value that is not allowed.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadValue {
    /// File and line, once known; empty for what did not come from a file.
    pub place: String,
    /// Key path, such as `population.scale` or `routes[2].waypoints[0]`.
    pub key: String,
    /// The value found.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
    /// The way out.
    pub hint: String,
}

impl BadValue {
    /// A value whose place is not yet known.
    pub(crate) fn new(
        key: impl Into<String>,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self {
            place: String::new(),
            key: key.into(),
            value: value.to_string(),
            allowed: allowed.into(),
            hint: hint.into(),
        }
    }
}

impl fmt::Display for BadValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "{} = {}: must be {}; {}", self.key, self.value, self.allowed, self.hint)
    }
}

/// What a parser's error means.
#[derive(Debug)]
pub(crate) struct Explained {
    /// Path of the key that is wrong, where there is one.
    pub(crate) key: Option<String>,
    /// The line it stands in, from 1.
    pub(crate) line: usize,
    /// What is wrong, with the key and, for a misspelt name, the nearest one.
    pub(crate) message: String,
}

/// Explains the parser's error about a text.
pub(crate) fn explain(error: &toml::de::Error, text: &str) -> Explained {
    let offset = error.span().map_or(0, |span| span.start);
    // The parser says "unknown field `x`, expected one of `a`, `b`" (or "unknown variant"): odd pieces are names.
    let names: Vec<&str> = error.message().split('`').skip(1).step_by(2).collect();
    let unknown = names.split_first().filter(|_| error.message().starts_with("unknown "));
    let table = DeTable::parse(text).ok();
    let mut found = table.as_ref().and_then(|table| path_at(table.get_ref(), offset, true));
    // Of tables that differ by kind the parser knows the beginning only: the name stands below it.
    if let (Some((path, _)), Some((wrong, _)), Some(table)) = (&found, unknown, &table) {
        let prefix = path.clone();
        let below = |(path, _): &(String, usize)| path.starts_with(&prefix);
        found = named(table.get_ref(), wrong).into_iter().find(below).or(found);
    }
    let line = line_of(text, found.as_ref().map_or(offset, |&(_, offset)| offset));
    let key = found.map(|(key, _)| key);
    let mut message = error.message().replace('\n', " ");
    if let Some(key) = &key {
        message = format!("{key}: {message}");
    }
    if let Some((wrong, known)) = unknown
        && let Some(nearest) = nearest(wrong, known)
    {
        message = format!("{message}; did you mean `{nearest}`?");
    }
    Explained { key, line, message }
}

/// `origin:line` of a key, as far as the text spells it out; else the origin alone.
pub(crate) fn place_of(text: &str, origin: &str, key: &str) -> String {
    let table = DeTable::parse(text).ok();
    let offset = table.and_then(|table| offset_of(table.get_ref(), key));
    offset.map_or_else(|| origin.to_owned(), |offset| format!("{origin}:{}", line_of(text, offset)))
}

/// Line of a byte offset, from 1.
fn line_of(text: &str, offset: usize) -> usize {
    let end = offset.min(text.len());
    1 + text.as_bytes()[..end].iter().filter(|&&byte| byte == b'\n').count()
}

/// Byte offset of the deepest part of `path` (`a.b[2].c`) that the document spells out.
fn offset_of(table: &DeTable<'_>, path: &str) -> Option<usize> {
    let mut found = None;
    let mut value: Option<&DeValue<'_>> = None;
    for part in path.split(['.', '[']) {
        let next = match (part.strip_suffix(']'), value) {
            (Some(index), Some(DeValue::Array(items))) => {
                index.parse().ok().and_then(|i: usize| items.get(i)).map(|item| (item.span().start, item))
            }
            (None, None) => table.get_key_value(part).map(|(key, item)| (key.span().start, item)),
            (None, Some(DeValue::Table(inner))) => {
                inner.get_key_value(part).map(|(key, item)| (key.span().start, item))
            }
            _ => None,
        };
        let Some((offset, item)) = next else { break };
        found = Some(offset);
        value = Some(item.get_ref());
    }
    found
}

/// Key path and offset of the innermost key or value at a byte offset.
fn path_at(table: &DeTable<'_>, offset: usize, is_root: bool) -> Option<(String, usize)> {
    let holds = |span: Range<usize>| span.contains(&offset) || span.start == offset;
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        let own = || Some((name.to_owned(), key.span().start));
        if holds(key.span()) {
            return own();
        }
        let inner = match value.get_ref() {
            DeValue::Table(inner) => {
                path_at(inner, offset, false).map(|(rest, at)| (format!("{name}.{rest}"), at))
            }
            DeValue::Array(items) => items.iter().enumerate().find_map(|(index, item)| {
                let DeValue::Table(inner) = item.get_ref() else { return None };
                let path = path_at(inner, offset, false)?;
                Some((format!("{name}[{index}].{}", path.0), path.1))
            }),
            _ => None,
        };
        if inner.is_some() {
            return inner;
        }
        if holds(value.span()) && !(is_root && value.get_ref().is_table()) {
            return own();
        }
    }
    None
}

/// Paths and offsets of all keys or texts of this name.
fn named(table: &DeTable<'_>, wanted: &str) -> Vec<(String, usize)> {
    let mut found = Vec::new();
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        if name == wanted {
            found.push((name.to_owned(), key.span().start));
        }
        match value.get_ref() {
            DeValue::Table(inner) => {
                found.extend(
                    named(inner, wanted).into_iter().map(|(rest, at)| (format!("{name}.{rest}"), at)),
                );
            }
            DeValue::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    if let DeValue::Table(inner) = item.get_ref() {
                        let below = named(inner, wanted).into_iter();
                        found.extend(below.map(|(rest, at)| (format!("{name}[{index}].{rest}"), at)));
                    }
                }
            }
            DeValue::String(text) if text.as_ref() == wanted => {
                found.push((name.to_owned(), value.span().start));
            }
            _ => {}
        }
    }
    found
}
