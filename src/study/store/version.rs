//! A study as it was when its first participant came: nothing of it changes any more.

use super::super::file::Part;
use super::super::plan::{Plan, Stimulus};
use super::super::theatre::Theatre;
use super::super::{Error, FILE_NAME, Materials, Study};
use super::secret::{hash, hash_of, hex};
use crate::file;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Largest library that is frozen, bytes.
const MOST_BYTES: u64 = 1 << 30;

/// What a folder of data is opened with.
#[derive(Debug, Clone)]
pub struct Opening {
    /// The study.
    pub study: Study,
    /// Names of gaits and texts beside it.
    pub materials: Materials,
    /// Files of the libraries, by the name that the study gives them.
    pub libraries: BTreeMap<String, PathBuf>,
    /// Rows of the longest design that this folder gives from now on; none: as before, or all.
    pub rows: Option<Range<u32>>,
}

/// A frozen version of a study.
#[derive(Debug, Clone)]
pub struct Version {
    /// What `study.version` says.
    pub number: u32,
    /// SHA-256 of study file, texts and libraries; 64 hexadecimal digits.
    pub hash: String,
    /// The study.
    pub study: Study,
    /// Names of gaits and texts beside it.
    pub materials: Materials,
    /// The plan, with secret names of stimuli.
    pub plan: Plan,
    /// Folder with the frozen study file, texts and libraries.
    pub folder: PathBuf,
    /// What participants may be shown in a browser, by its name in addresses.
    pub stimuli: HashMap<String, Shown>,
}

/// What a name in addresses shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Shown {
    /// The part.
    pub part: String,
    /// The stimulus.
    pub stimulus: Stimulus,
    /// Its seed; 0 of gaits, which have none.
    pub seed: u64,
}

/// The bytes of a version's libraries, by name.
pub(super) type Libraries = BTreeMap<String, Vec<u8>>;

impl Opening {
    /// SHA-256 of study file, texts and libraries, as the store keeps it; 64 hexadecimal digits.
    ///
    /// # Errors
    /// [`Error::Read`] for a library that cannot be read.
    pub fn hash(&self) -> Result<String, Error> {
        self.read().map(|(_, hash)| hash)
    }

    /// The libraries' bytes, and the hash of everything.
    pub(super) fn read(&self) -> Result<(Libraries, String), Error> {
        let mut libraries = Libraries::new();
        for (name, path) in &self.libraries {
            let read = file::read(path, MOST_BYTES);
            let bytes = read.map_err(|source| Error::Read { path: path.clone(), source })?;
            libraries.insert(name.clone(), bytes);
        }
        let texts = self.materials.texts.iter().flat_map(|(name, text)| [name.as_bytes(), text.as_bytes()]);
        let bytes = libraries.iter().flat_map(|(name, bytes)| [name.as_bytes(), bytes.as_slice()]);
        let pieces = std::iter::once(self.study.text.as_bytes()).chain(texts).chain(bytes);
        let hash = hex(&hash_of(pieces));
        Ok((libraries, hash))
    }
}

impl Version {
    /// A version as its texts say it.
    pub(super) fn of(
        file: &str,
        materials: Materials,
        hash: String,
        secret: u64,
        data: &Path,
    ) -> Result<Self, Error> {
        let folder = folder(data, &hash);
        let mut study = Study::parse(file, &folder.join(FILE_NAME).display().to_string())?;
        study.folder = Some(folder.clone());
        let mut plan = Plan::of(&study.file, &materials)?;
        plan.secret = secret;
        let stimuli = plan
            .shown_on_the_web()
            .into_iter()
            .map(|(part, stimulus, seed)| (plan.name(&stimulus, seed), Shown { part, stimulus, seed }))
            .collect();
        let number = study.file.study.version;
        Ok(Self { number, hash, study, materials, plan, folder, stimuli })
    }

    /// Writes the files of the version into its folder, for people and for stimuli.
    pub(super) fn freeze(&self, libraries: &Libraries) -> Result<(), Error> {
        let failed = |path: &Path, source| Error::Write { path: path.to_owned(), source };
        std::fs::create_dir_all(&self.folder).map_err(|source| failed(&self.folder, source))?;
        let texts = self.materials.texts.iter().map(|(name, text)| (name.as_str(), text.as_bytes()));
        let libraries = libraries.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice()));
        for (name, bytes) in texts.chain(libraries).chain([(FILE_NAME, self.study.text.as_bytes())]) {
            let path = self.folder.join(name);
            if let Some(parent) = path.parent() {
                std::fs::create_dir_all(parent).map_err(|source| failed(parent, source))?;
            }
            file::write(&path, bytes).map_err(|source| failed(&path, source))?;
        }
        Ok(())
    }

    /// The frozen library of gaits that a part shows; none where it shows something else, or the built-in examples.
    pub fn library(&self, part: &str) -> Option<PathBuf> {
        let name = self.study.file.parts.get(part).and_then(Part::trials)?.show.gaits.as_ref()?;
        Some(self.folder.join(name)).filter(|path| path.is_file())
    }

    /// What its trials show, with the frozen library.
    ///
    /// # Errors
    /// When the library cannot be read.
    pub fn theatre(&self) -> Result<Theatre, crate::Error> {
        Theatre::load(self.study.file.crowd.as_ref(), &self.folder)
    }

    /// The text that participants agree to, by the name of its file.
    pub fn text(&self, name: &str) -> Option<&str> {
        self.materials.texts.get(name).map(String::as_str)
    }

    /// What says which text was agreed to: its SHA-256, 64 hexadecimal digits. Empty for a text that is not there.
    pub fn text_hash(&self, name: &str) -> String {
        self.text(name).map(|text| hex(&hash(text.as_bytes()))).unwrap_or_default()
    }
}

/// Where the files of a version lie in a folder of data.
fn folder(data: &Path, hash: &str) -> PathBuf {
    data.join("materials").join(hash.get(..8).unwrap_or(hash))
}
