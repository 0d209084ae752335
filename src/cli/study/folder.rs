//! The folder of a study's data: the study file and the tables.

use super::super::failed;
use super::super::outputs::make_folder;
use crate::Error;
use crate::export::AtomicFile;
use crate::study::tables::Tables;
use crate::study::{FILE_NAME, Study};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Longest table that is read, bytes.
const MOST_BYTES: u64 = 1 << 30;
const ANSWERS: &str = "answers.csv";
const PEOPLE: &str = "participants.csv";
const RATINGS: &str = "ratings.csv";

/// Writes the study file and its tables into a folder; returns the files.
pub(super) fn write(folder: &Path, study: &Study, tables: &Tables) -> Result<Vec<PathBuf>, Error> {
    make_folder(folder)?;
    let mut texts =
        vec![(FILE_NAME, study.text.clone()), (ANSWERS, tables.answers_csv()), (PEOPLE, tables.people_csv())];
    if let Some(ratings) = &study.file.analysis.ratings {
        texts.push((RATINGS, tables.ratings_csv(&ratings.part)));
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
    let mut file = AtomicFile::create(path)?;
    file.write_all(text.as_bytes())
        .map_err(|source| crate::export::Error::Write { path: path.to_owned(), source })?;
    Ok(file.finish()?)
}

/// Reads the study file and its tables from a folder.
pub(super) fn read(folder: &Path) -> Result<(Study, Tables), Error> {
    if !folder.join(ANSWERS).is_file() {
        let message = format!("{}: no {ANSWERS} in it", folder.display());
        return Err(failed(message, "name a folder that `gaitway study simulate --out` wrote"));
    }
    let study = Study::load(folder)?;
    let text = |name: &str| {
        let path = folder.join(name);
        let text = crate::file::read_text(&path, MOST_BYTES);
        text.map(|text| (text, path.display().to_string()))
            .map_err(|source| crate::study::Error::Read { path: path.clone(), source })
    };
    let ((answers, answers_name), (people, people_name)) = (text(ANSWERS)?, text(PEOPLE)?);
    let tables = Tables::parse([&answers, &people], [&answers_name, &people_name])?;
    Ok((study, tables))
}
