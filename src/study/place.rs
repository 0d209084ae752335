//! Lines of keys in a TOML text, and the parser's errors in our words.

use crate::spelling::nearest;
use crate::study::error::Error;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// A TOML text and what messages call it: the `file` in `file:line`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) text: &'a str,
    pub(super) origin: &'a str,
}

impl Source<'_> {
    /// Reads a value of any type.
    ///
    /// # Errors
    /// [`Error::Syntax`] with line, key and, for a misspelt name, the nearest one.
    pub(super) fn read<T: serde::de::DeserializeOwned>(&self) -> Result<T, Error> {
        toml::from_str(self.text).map_err(|error| self.syntax_error(&error))
    }

    /// File and line of a key, as far as the text spells it out.
    pub(super) fn place(&self, key: &str) -> String {
        let table = DeTable::parse(self.text).ok();
        let offset = table.and_then(|table| offset_of(table.get_ref(), key));
        offset.map_or_else(|| self.origin.to_owned(), |offset| self.line(offset))
    }

    fn line(&self, offset: usize) -> String {
        let end = offset.min(self.text.len());
        let line = 1 + self.text.as_bytes()[..end].iter().filter(|&&byte| byte == b'\n').count();
        format!("{}:{line}", self.origin)
    }

    fn syntax_error(&self, error: &toml::de::Error) -> Error {
        let offset = error.span().map_or(0, |span| span.start);
        // The parser says "unknown field `x`, expected one of `a`, `b`" (or "unknown variant"): odd pieces are names.
        let names: Vec<&str> = error.message().split('`').skip(1).step_by(2).collect();
        let unknown = names.split_first().filter(|_| error.message().starts_with("unknown "));
        let table = DeTable::parse(self.text).ok();
        let mut found = table.as_ref().and_then(|table| path_at(table.get_ref(), offset, true));
        // Of tables that differ by kind the parser knows the beginning only: the name stands below it.
        if let (Some((path, _)), Some((wrong, _)), Some(table)) = (&found, unknown, &table) {
            let prefix = path.clone();
            let below = |(path, _): &(String, usize)| path.starts_with(&prefix);
            found = named(table.get_ref(), wrong).into_iter().find(below).or(found);
        }
        let place = self.line(found.as_ref().map_or(offset, |&(_, offset)| offset));
        let mut message = error.message().replace('\n', " ");
        if let Some((key, _)) = found {
            message = format!("{key}: {message}");
        }
        if let Some((wrong, known)) = unknown
            && let Some(nearest) = nearest(wrong, known)
        {
            message = format!("{message}; did you mean `{nearest}`?");
        }
        Error::Syntax { place, message }
    }
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
