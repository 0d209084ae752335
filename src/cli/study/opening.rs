//! Opening a folder of data with a study: what `serve`, `clips` and `run` begin with.

use super::super::{failed, usage};
use super::beside::{self, Beside, Gaits, study};
use crate::Error;
use crate::study::check::Severity;
use crate::study::store::{Opening, Store, Trouble};
use crate::study::{self, Study};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The study and its data.
#[derive(Debug, Clone, clap::Args)]
pub(super) struct OpeningArguments {
    /// Study file, or folder with study.toml
    #[arg(value_name = "STUDY")]
    study: String,
    /// Library of gaits to take in place of the one that the study names
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Folder of the study's data; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(super) data: PathBuf,
}

impl OpeningArguments {
    /// Opens the data. A study with errors, or with something left to fill in, is not opened.
    pub(super) fn open(&self) -> Result<Store, Error> {
        self.open_checked(&self.study()?, None)
    }

    /// The study.
    pub(super) fn study(&self) -> Result<Study, Error> {
        study(&self.study)
    }

    /// Opens the data of the study, which give rows of a range alone from now on if there is one.
    pub(super) fn open_checked(&self, study: &Study, rows: Option<Range<u32>>) -> Result<Store, Error> {
        let beside = Beside::of(study, &Gaits::of(self.library.clone()))?;
        check(study, &beside)?;
        let libraries = self.libraries(study)?;
        let opening = Opening { study: study.clone(), materials: beside.materials, libraries, rows };
        Ok(Store::open(&self.data, &opening)?)
    }

    /// Files of the libraries, each of which is there.
    fn libraries(&self, study: &Study) -> Result<BTreeMap<String, PathBuf>, Error> {
        let files = libraries(study, self.library.as_deref());
        match files.values().find(|path| !path.is_file()) {
            Some(path) => {
                let message = format!("{}: the library of gaits is not there", path.display());
                Err(usage(message, "put it beside the study file, or delete the key that names it"))
            }
            None => Ok(files),
        }
    }
}

/// Files of the libraries that a study shows, or of `instead` of them, and of the one that its crowds walk with.
pub(super) fn libraries(study: &Study, instead: Option<&Path>) -> BTreeMap<String, PathBuf> {
    let folder = study.folder.as_deref().unwrap_or(Path::new("."));
    let shown = beside::libraries(study).into_iter().map(|name| {
        let path = instead.map_or_else(|| folder.join(&name), Path::to_owned);
        (name, path)
    });
    let crowd = study.file.crowd.iter().map(|crowd| (crowd.library.clone(), folder.join(&crowd.library)));
    shown.chain(crowd).collect()
}

fn check(study: &Study, beside: &Beside) -> Result<(), Error> {
    let report = study::check(study, &beside.materials);
    let is_serious = |note: &&study::check::Note| note.severity != Severity::Warning;
    let mut serious = report.notes.iter().filter(is_serious);
    let Some(first) = serious.next() else { return Ok(()) };
    let more = serious.count();
    let hint = match more {
        0 => first.hint.clone(),
        _ => format!("`gaitway study check` lists {more} more"),
    };
    let study::check::Note { place, key, value, allowed, .. } = first;
    Err(failed(format!("{place}: {key} = {value}: must be {allowed}"), hint))
}

/// A request that a store did not meet.
#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
pub(super) fn trouble(trouble: Trouble) -> Error {
    failed(trouble.to_string(), "the folder of data is as it was")
}
