//! The folder of a study's data: the study file and the tables.

use super::super::failed;
use super::super::outputs::make_folder;
use crate::Error;
use crate::study::analyse::rating_sheet;
use crate::study::tables::{self, ANSWERS, Chosen, Fronts, PARTICIPANTS, Tables};
use crate::study::{FILE_NAME, Study};
use std::path::{Path, PathBuf};

/// Longest table that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
const RATINGS: &str = "ratings.csv";

/// Whose answers are wanted.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(super) struct FrontArguments {
    /// Whose answers count [default: those of people, or of simulated participants where no person took part]
    #[arg(long, value_enum)]
    front: Option<Whose>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Whose {
    /// People in a browser
    Web,
    /// People in a headset
    Headset,
    /// People in a browser and in a headset together
    People,
    /// Simulated participants
    Simulated,
}

impl FrontArguments {
    /// What the library calls it.
    pub(super) fn fronts(self) -> Option<Fronts> {
        self.front.map(|front| match front {
            Whose::Web => Fronts::Web,
            Whose::Headset => Fronts::Headset,
            Whose::People => Fronts::People,
            Whose::Simulated => Fronts::Simulated,
        })
    }

    /// The tables of the participants that are wanted.
    pub(super) fn choose(self, tables: &Tables, data: &Path) -> Result<Chosen, Error> {
        let hint = "--front web, headset, people or simulated says who counts";
        tables.choose(self.fronts()).map_err(|error| failed(format!("{}: {error}", data.display()), hint))
    }
}

/// Writes the study file and its tables into a folder; returns the files.
pub(super) fn write(folder: &Path, study: &Study, tables: &Tables) -> Result<Vec<PathBuf>, Error> {
    make_folder(folder)?;
    let (answers, people) = tables::write(tables);
    let mut texts = vec![(FILE_NAME, study.text.clone()), (ANSWERS, answers), (PARTICIPANTS, people)];
    if let Some(ratings) = rating_sheet(&study.file, tables)? {
        texts.push((RATINGS, ratings));
    }
    let mut files = Vec::new();
    for (name, text) in texts {
        let path = folder.join(name);
        write_text(&path, &text)?;
        files.push(path);
    }
    Ok(files)
}

/// Writes a text whole or not at all.
pub(super) fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    crate::file::write(path, text.as_bytes())
        .map_err(|source| crate::export::Error::Write { path: path.to_owned(), source }.into())
}

/// Reads the study file and its tables from a folder: the data of a study that was served, or tables.
pub(super) fn read(folder: &Path) -> Result<(Study, Tables), Error> {
    #[cfg(feature = "study")]
    if folder.join(crate::study::store::STORE).is_file() {
        let reading = crate::study::store::Reading::open(folder)?;
        let tables = reading.tables(None);
        if let Some(version) = reading.versions().last() {
            return Ok((version.study.clone(), tables));
        }
    }
    if !folder.join(ANSWERS).is_file() {
        let message = format!("{}: no {ANSWERS} in it", folder.display());
        return Err(failed(
            message,
            "name a folder that `gaitway study serve --data` or `study simulate --out` wrote",
        ));
    }
    let study = Study::load(folder)?;
    let text = |name: &str| {
        let path = folder.join(name);
        crate::file::read_text(&path, MOST_BYTES).map_err(|source| crate::study::Error::Read { path, source })
    };
    let tables = tables::read(&text(ANSWERS)?, &text(PARTICIPANTS)?, &folder.display().to_string())?;
    Ok((study, tables))
}
