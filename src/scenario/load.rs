//! Reading and writing scenario files, the built-in scenes, and finding the line of a wrong key.

use super::error::Error;
use super::schema::{Condition, Scenario};
use super::walkable::Area;
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Largest scenario file read, bytes.
const MAX_FILE_BYTES: u64 = 64 << 20;

/// The paper's four scenes (S-25) by name.
const BUILTIN: [(&str, &str); 4] = [
    ("crossing", include_str!("../../assets/scenes/crossing.toml")),
    ("garden", include_str!("../../assets/scenes/garden.toml")),
    ("parking", include_str!("../../assets/scenes/parking.toml")),
    ("scifi", include_str!("../../assets/scenes/scifi.toml")),
];

impl Scenario {
    /// Names of the built-in scenes.
    pub fn builtin_names() -> [&'static str; 4] {
        BUILTIN.map(|(name, _)| name)
    }

    /// A built-in scene by name (case does not matter): Crossing 8 agents, Garden 4, Parking 8, Scifi 4.
    ///
    /// # Errors
    /// [`Error::UnknownScene`] lists the names there are.
    pub fn builtin(name: &str) -> Result<Self, Error> {
        match BUILTIN.iter().find(|(known, _)| known.eq_ignore_ascii_case(name)) {
            Some((known, text)) => Self::parse(text, &format!("built-in scene {known}")),
            None => {
                Err(Error::UnknownScene { name: name.to_owned(), known: Self::builtin_names().join(", ") })
            }
        }
    }

    /// Reads a scenario file and validates it.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Syntax`] or [`Error::Value`], with file and line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let read = |source| Error::Read { path: path.to_owned(), source };
        let size = std::fs::metadata(path).map_err(read)?.len();
        if size > MAX_FILE_BYTES {
            let message = format!("{size} bytes; a scenario may have up to {MAX_FILE_BYTES}");
            return Err(read(std::io::Error::other(message)));
        }
        let text = std::fs::read_to_string(path).map_err(read)?;
        Self::parse_beside(&text, &path.display().to_string(), path.parent())
    }

    /// Reads a scenario from text and validates it; `origin` names it in messages (`file` in `file:line`).
    ///
    /// # Errors
    /// [`Error::Syntax`] or [`Error::Value`], with origin and line.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Error> {
        Self::parse_beside(text, origin, None)
    }

    /// The same; a `walkable_file` is looked for in `folder` and taken over.
    fn parse_beside(text: &str, origin: &str, folder: Option<&Path>) -> Result<Self, Error> {
        let mut scenario: Self = toml::from_str(text).map_err(|error| syntax_error(&error, text, origin))?;
        if let Some(folder) = folder.filter(|_| !scenario.walkable_file.is_empty()) {
            let file = std::mem::take(&mut scenario.walkable_file);
            if !scenario.walkable_wkt.is_empty() {
                let hint = "leave one of the two out";
                let error =
                    Error::value("walkable_file", format!("{file:?}"), "left out beside walkable_wkt", hint);
                return Err(placed(error, text, origin));
            }
            let node = scenario.walkable_node.take();
            let plane = std::mem::take(&mut scenario.walkable_plane);
            let area = Area::read(&folder.join(&file), node.as_deref(), plane).map_err(|message| {
                let allowed = "a .wkt, .txt, .glb or .gltf file with a walkable area";
                placed(Error::value("walkable_file", format!("{file:?}"), allowed, message), text, origin)
            })?;
            scenario.walkable_wkt = area.to_wkt();
        }
        scenario.validate().map_err(|error| placed(error, text, origin))?;
        Ok(scenario)
    }

    /// The scenario as TOML; [`Scenario::parse`] gives it back unchanged.
    ///
    /// # Errors
    /// [`Error::Write`] when a value has no TOML form (a seed above 2^63 - 1).
    pub fn to_toml(&self) -> Result<String, Error> {
        toml::to_string(self)
            .map_err(|error| Error::Write { name: self.name.clone(), message: error.to_string() })
    }

    /// The same scenario with another number of agents; generated layouts grow with it.
    #[must_use]
    pub fn with_agents(mut self, agents: u32) -> Self {
        self.population.agents = agents;
        self
    }

    /// The same scenario with another seed.
    #[must_use]
    pub const fn with_seed(mut self, seed: u64) -> Self {
        self.seed = seed;
        self
    }

    /// The same scenario under another of the paper's three algorithms.
    #[must_use]
    pub const fn with_condition(mut self, condition: Condition) -> Self {
        self.condition = condition;
        self
    }
}

/// Line of a byte offset, from 1.
fn line_of(text: &str, offset: usize) -> usize {
    let end = offset.min(text.len());
    1 + text.as_bytes()[..end].iter().filter(|&&byte| byte == b'\n').count()
}

/// Turns the parser's error into ours: place, key, and the nearest name for a misspelt one.
fn syntax_error(error: &toml::de::Error, text: &str, origin: &str) -> Error {
    let offset = error.span().map_or(0, |span| span.start);
    let place = format!("{origin}:{}", line_of(text, offset));
    let mut message = error.message().replace('\n', " ");
    if let Some(path) = DeTable::parse(text).ok().and_then(|table| path_at(table.get_ref(), offset)) {
        message = format!("{path}: {message}");
    }
    // The parser says "unknown field `x`, expected one of `a`, `b`" (or "unknown variant"): odd pieces are names.
    let names: Vec<&str> = error.message().split('`').skip(1).step_by(2).collect();
    if error.message().starts_with("unknown ")
        && let Some((wrong, known)) = names.split_first()
        && let Some(nearest) = nearest(wrong, known)
    {
        message = format!("{message}; did you mean `{nearest}`?");
    }
    Error::Syntax { place, message }
}

/// Puts file and line to a value error by looking its key up in the text.
fn placed(error: Error, text: &str, origin: &str) -> Error {
    match error {
        Error::Value(mut bad) => {
            let table = DeTable::parse(text).ok();
            let offset = table.and_then(|table| offset_of(table.get_ref(), &bad.key));
            bad.place =
                offset.map_or_else(|| origin.to_owned(), |o| format!("{origin}:{}", line_of(text, o)));
            Error::Value(bad)
        }
        other => other,
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

/// Key path of the innermost key or value at a byte offset.
fn path_at(table: &DeTable<'_>, offset: usize) -> Option<String> {
    let holds = |span: Range<usize>| span.contains(&offset) || span.start == offset;
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        if holds(key.span()) {
            return Some(name.to_owned());
        }
        match value.get_ref() {
            DeValue::Table(inner) => {
                if let Some(rest) = path_at(inner, offset) {
                    return Some(format!("{name}.{rest}"));
                }
            }
            DeValue::Array(items) => {
                for (index, item) in items.iter().enumerate() {
                    if let DeValue::Table(inner) = item.get_ref()
                        && let Some(rest) = path_at(inner, offset)
                    {
                        return Some(format!("{name}[{index}].{rest}"));
                    }
                }
            }
            _ => {}
        }
        if !value.get_ref().is_table() && holds(value.span()) {
            return Some(name.to_owned());
        }
    }
    None
}

/// The candidate with the fewest edits, if it is near enough to be what was meant.
pub(super) fn nearest<'a>(wrong: &str, known: &[&'a str]) -> Option<&'a str> {
    let near = |candidate: &&'a str| (edit_distance(wrong, candidate), *candidate);
    let (distance, candidate) = known.iter().map(near).min()?;
    (distance <= (wrong.len().max(candidate.len()) / 2).max(1)).then_some(candidate)
}

/// Levenshtein distance over bytes of the first 64 of each word.
fn edit_distance(a: &str, b: &str) -> usize {
    let (a, b) = (&a.as_bytes()[..a.len().min(64)], &b.as_bytes()[..b.len().min(64)]);
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substituted = diagonal + usize::from(!x.eq_ignore_ascii_case(y));
            diagonal = row[j + 1];
            row[j + 1] = substituted.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
