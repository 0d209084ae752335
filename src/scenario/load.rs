//! Reading and writing scenario files, and the built-in scenes.

use super::builtin;
use super::error::Error;
use super::file::{Condition, Layout, Scenario};
use super::place::Area;
use super::setting::Setting;
use crate::file;
use crate::keys::{Explained, explain, place_of};
use crate::spelling::nearest;
use std::borrow::Cow;
use std::path::Path;

/// Largest scenario file read, bytes.
const MAX_FILE_BYTES: u64 = 64 << 20;

impl Scenario {
    /// Names of the built-in scenes.
    pub fn builtin_names() -> [&'static str; 4] {
        builtin::BUILTIN.each_ref().map(|scene| scene.name)
    }

    /// A built-in scene by name (case does not matter): Crossing 8 agents, Garden 4, Parking 8, Scifi 4.
    ///
    /// # Errors
    /// [`Error::UnknownScene`] lists the names there are.
    pub fn builtin(name: &str) -> Result<Self, Error> {
        Self::builtin_with(name, &[])
    }

    /// [`Scenario::builtin`] with other values for some keys of its file.
    ///
    /// # Errors
    /// As [`Scenario::builtin`] and [`Scenario::load_with`].
    pub fn builtin_with(name: &str, settings: &[Setting]) -> Result<Self, Error> {
        let scene = builtin_scene(name)?;
        let origin = format!("built-in scene {}", scene.name);
        Source { text: scene.toml, origin: &origin, settings }.read(None)
    }

    /// The text of a built-in scene's file.
    ///
    /// # Errors
    /// As [`Scenario::builtin`].
    pub(crate) fn builtin_text(name: &str) -> Result<&'static str, Error> {
        Ok(builtin_scene(name)?.toml)
    }

    /// Reads a scenario file and validates it.
    ///
    /// # Errors
    /// [`Error::Read`], [`Error::Syntax`] or [`Error::Value`], with file and line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        Self::load_with(path, &[])
    }

    /// [`Scenario::load`] with other values for some keys, as if the file had them.
    ///
    /// # Errors
    /// As [`Scenario::load`]; [`Error::Setting`] for a value that has no place in the file.
    pub fn load_with(path: &Path, settings: &[Setting]) -> Result<Self, Error> {
        let read = |source| Error::Read { path: path.to_owned(), source };
        let text = file::read_text(path, MAX_FILE_BYTES).map_err(read)?;
        Source { text: &text, origin: &path.display().to_string(), settings }.read(path.parent())
    }

    /// Reads a scenario from text and validates it; `origin` names it in messages (`file` in `file:line`).
    ///
    /// # Errors
    /// [`Error::Syntax`] or [`Error::Value`], with origin and line.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Error> {
        Self::parse_with(text, origin, &[])
    }

    /// [`Scenario::parse`] with other values for some keys, as if the text had them.
    ///
    /// # Errors
    /// As [`Scenario::parse`]; [`Error::Setting`] for a value that has no place in the text.
    pub fn parse_with(text: &str, origin: &str, settings: &[Setting]) -> Result<Self, Error> {
        Source { text, origin, settings }.read(None)
    }

    /// [`Scenario::parse_with`]; a `walkable_file` is looked for in `folder`.
    ///
    /// # Errors
    /// As [`Scenario::load_with`].
    pub(crate) fn parse_beside(
        text: &str,
        origin: &str,
        settings: &[Setting],
        folder: Option<&Path>,
    ) -> Result<Self, Error> {
        Source { text, origin, settings }.read(folder)
    }

    /// Takes the area of a `walkable_file` over, which is looked for in `folder`, or else that of the place's model where the
    /// scenario has no area of its own.
    fn find_area(&mut self, folder: Option<&Path>) -> Result<(), Error> {
        let Some(folder) = folder else { return Ok(()) };
        let has_own =
            !self.bounds.is_empty() || !self.walkable_wkt.is_empty() || self.layout != Layout::Custom;
        let is_of_place = self.walkable_file.is_empty();
        let (key, file) = match &self.environment.glb {
            _ if !is_of_place => ("walkable_file", std::mem::take(&mut self.walkable_file)),
            Some(model) if !has_own => ("environment.glb", model.clone()),
            _ => return Ok(()),
        };
        let wrong = |allowed: &str, hint: String| Error::value(key, format!("{file:?}"), allowed, hint);
        if !self.walkable_wkt.is_empty() {
            return Err(wrong("left out beside walkable_wkt", "leave one of the two out".to_owned()));
        }
        let node = self.walkable_node.take();
        let plane = std::mem::take(&mut self.walkable_plane);
        let path = folder.join(&file);
        let read = if is_of_place {
            Area::of_place(&path, node.as_deref())
        } else {
            Area::read(&path, node.as_deref(), plane)
        };
        let area = read.map_err(|error| {
            wrong("a .wkt, .txt, .glb or .gltf file with a walkable area", error.to_string())
        })?;
        self.walkable_wkt = area.to_wkt();
        Ok(())
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

/// The built-in scene of a name.
fn builtin_scene(name: &str) -> Result<&'static builtin::Builtin, Error> {
    builtin::BUILTIN.iter().find(|scene| scene.name.eq_ignore_ascii_case(name)).ok_or_else(|| {
        let known = Scenario::builtin_names();
        Error::UnknownScene { name: name.to_owned(), nearest: nearest(name, &known), known: known.join(", ") }
    })
}

/// The text of a scenario, and what is set besides.
struct Source<'a> {
    text: &'a str,
    /// What messages call it: the `file` in `file:line`.
    origin: &'a str,
    settings: &'a [Setting],
}

impl Source<'_> {
    /// Reads and validates the scenario; a `walkable_file` is looked for in `folder`.
    fn read(&self, folder: Option<&Path>) -> Result<Scenario, Error> {
        let text = self.edited()?;
        let mut scenario: Scenario =
            toml::from_str(&text).map_err(|error| self.syntax_error(&error, &text))?;
        scenario.find_area(folder).and_then(|()| scenario.validate()).map_err(|error| self.placed(error))?;
        Ok(scenario)
    }

    /// The text with everything set.
    fn edited(&self) -> Result<Cow<'_, str>, Error> {
        if self.settings.is_empty() {
            return Ok(self.text.into());
        }
        let mut table = toml::from_str(self.text).map_err(|error| self.syntax_error(&error, self.text))?;
        for setting in self.settings {
            let failed = |reason| Error::Setting { setting: setting.to_string(), reason };
            setting.apply(&mut table).map_err(failed)?;
        }
        toml::to_string(&table)
            .map(Cow::from)
            .map_err(|error| Error::Write { name: self.origin.to_owned(), message: error.to_string() })
    }

    /// Where a key stands: what sets it, or file and line as far as the text spells the key out.
    fn place(&self, key: &str) -> String {
        if let Some(setting) = self.settings.iter().rev().find(|setting| setting.holds(key)) {
            return format!("--set {setting}");
        }
        place_of(self.text, self.origin, key)
    }

    /// Turns the parser's error about `text` into ours: place, key, and the nearest name for a misspelt one.
    fn syntax_error(&self, error: &toml::de::Error, text: &str) -> Error {
        let Explained { key, line, message } = explain(error, text);
        let place = match &key {
            Some(key) if !self.settings.is_empty() => self.place(key),
            _ if !std::ptr::eq(text, self.text) => self.origin.to_owned(),
            _ => format!("{}:{line}", self.origin),
        };
        Error::Syntax { place, message }
    }

    /// Puts its place to a value error.
    fn placed(&self, error: Error) -> Error {
        match error {
            Error::Value(mut bad) => {
                bad.place = self.place(&bad.key);
                Error::Value(bad)
            }
            other => other,
        }
    }
}
