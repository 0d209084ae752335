//! Reading study files, and the built-in studies.

use super::error::Error;
use super::file::StudyFile;
use crate::file;
use crate::keys::{explain, place_of};
use crate::spelling::suggestion;
use std::path::{Path, PathBuf};

/// Largest study file read, bytes.
const MAX_FILE_BYTES: u64 = 4 << 20;
/// What the file is called in a study's folder.
pub const FILE_NAME: &str = "study.toml";

/// A study that comes with the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Builtin {
    /// Its id.
    pub name: &'static str,
    /// Its file.
    pub toml: &'static str,
    /// Name of the file of its consent text, as the study file gives it.
    pub consent_name: &'static str,
    /// Its consent text, Markdown, with blanks that begin with [`BLANK`].
    pub consent: &'static str,
}

/// How a blank begins that the lab has to fill in.
pub const BLANK: &str = "TO FILL IN";

/// The studies that come with the program.
pub const BUILTIN: [Builtin; 2] = [
    Builtin {
        name: "eva-gaits",
        toml: include_str!("../../assets/studies/eva-gaits.toml"),
        consent_name: "consent.en.md",
        consent: include_str!("../../assets/studies/consent.en.md"),
    },
    Builtin {
        name: "eva-agents",
        toml: include_str!("../../assets/studies/eva-agents.toml"),
        consent_name: "consent-vr.en.md",
        consent: include_str!("../../assets/studies/consent-vr.en.md"),
    },
];

/// A study with the text that it came from, so that messages can name lines.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// What the file says.
    pub file: StudyFile,
    /// The text of the file.
    pub text: String,
    /// What messages call the file.
    pub origin: String,
    /// Where files beside the study file lie; none for a text or a built-in study.
    pub folder: Option<PathBuf>,
}

impl Study {
    /// Reads a study file, or `study.toml` in a folder. Its values are not checked: see [`check`](fn@super::check).
    ///
    /// # Errors
    /// [`Error::Read`] or [`Error::Syntax`], with file and line.
    pub fn load(path: &Path) -> Result<Self, Error> {
        let path = if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() };
        let text = file::read_text(&path, MAX_FILE_BYTES)
            .map_err(|source| Error::Read { path: path.clone(), source })?;
        let folder = path.parent().map(Path::to_owned);
        Ok(Self { folder, ..Self::parse(&text, &path.display().to_string())? })
    }

    /// Reads a study from text; `origin` names it in messages (`file` in `file:line`).
    ///
    /// # Errors
    /// [`Error::Syntax`], with origin and line.
    pub fn parse(text: &str, origin: &str) -> Result<Self, Error> {
        let file = read(text, origin)?;
        Ok(Self { file, text: text.to_owned(), origin: origin.to_owned(), folder: None })
    }

    /// A built-in study by its id: `eva-gaits` or `eva-agents`.
    ///
    /// # Errors
    /// [`Error::UnknownStudy`] lists the ids there are.
    pub fn builtin(name: &str) -> Result<Self, Error> {
        let known = BUILTIN.map(|study| study.name);
        match BUILTIN.iter().find(|study| study.name == name) {
            Some(study) => Self::parse(study.toml, &format!("built-in study {name}")),
            None => {
                let hint = suggestion(name, &known, "there are");
                Err(Error::UnknownStudy { name: name.to_owned(), hint })
            }
        }
    }

    /// File and line of a key of the study.
    pub(super) fn place(&self, key: &str) -> String {
        place_of(&self.text, &self.origin, key)
    }
}

/// Reads a value of any type; `origin` names the text in messages.
///
/// # Errors
/// [`Error::Syntax`] with line, key and, for a misspelt name, the nearest one.
pub(super) fn read<T: serde::de::DeserializeOwned>(text: &str, origin: &str) -> Result<T, Error> {
    toml::from_str(text).map_err(|error| {
        let found = explain(&error, text);
        Error::Syntax { place: format!("{origin}:{}", found.line), message: found.message }
    })
}
