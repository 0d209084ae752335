//! Gaits for `predict`, `label` and `train`: out of libraries, motion files and folders of them.

use super::super::output::{complain, note};
use super::super::scene::library;
use super::super::usage;
use crate::Error;
use crate::gait::{Gait, import, stride};
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Endings of the motion files that are looked for in folders.
const ENDINGS: [&str; 5] = ["amc", "bvh", "csv", "tsv", "txt"];
/// Files that describe others.
const INDEX_FILES: [&str; 3] = ["gaits.csv", "labels.csv", "trials.csv"];
/// Folders within folders within folders ... are looked into so far.
const DEPTH: usize = 4;
/// Reasons for leaving something out that are shown.
const REASONS: usize = 10;

/// Gaits, with the file of each, and whether every file that was named could be used.
pub(in crate::cli) struct Found {
    pub(in crate::cli) gaits: Vec<(PathBuf, Gait)>,
    pub(in crate::cli) is_complete: bool,
}

/// Reads all gaits of libraries and the most regular stride of each take of motion files. Of takes of one name the first
/// is kept. What is left out is said, with the reason.
pub(in crate::cli) fn read(paths: &[PathBuf]) -> Result<Found, Error> {
    let mut files = Vec::new();
    for path in paths {
        match path.is_dir() {
            true => search(path, DEPTH, &mut files)?,
            false => files.push((path.clone(), true)),
        }
    }
    let read: Vec<Result<Vec<Gait>, Error>> = files.par_iter().map(|(path, _)| gaits_of(path)).collect();
    let (mut gaits, mut is_complete, mut reasons) = (Vec::new(), true, Vec::new());
    let mut names = HashSet::new();
    for ((path, is_named), read) in files.into_iter().zip(read) {
        match read {
            Ok(found) => {
                for gait in found {
                    if names.insert(gait.name.clone()) {
                        gaits.push((path.clone(), gait));
                    } else {
                        reasons.push(format!(
                            "{}: {}: a gait of this name is there",
                            path.display(),
                            gait.name
                        ));
                    }
                }
            }
            Err(error) if is_named => {
                complain(&error);
                is_complete = false;
            }
            Err(error) => reasons.push(error.to_string()),
        }
    }
    for reason in reasons.iter().take(REASONS) {
        note(&format!("left out: {reason}"));
    }
    if reasons.len() > REASONS {
        note(&format!("left out: {} more", reasons.len() - REASONS));
    }
    Ok(Found { gaits, is_complete })
}

/// Motion files of a folder and those in it, by name.
fn search(folder: &Path, depth: usize, files: &mut Vec<(PathBuf, bool)>) -> Result<(), Error> {
    let unreadable = |error: std::io::Error| {
        usage(format!("cannot read the folder {}: {error}", folder.display()), "check its name and rights")
    };
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        entries.push(entry.map_err(unreadable)?.path());
    }
    entries.sort();
    for path in entries {
        let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
        let is_index = path.file_name().is_some_and(|name| INDEX_FILES.iter().any(|index| name == *index));
        // a link to a folder above would go round and round
        if path.is_dir() && !path.is_symlink() && depth > 0 {
            search(&path, depth - 1, files)?;
        } else if ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str())) && !is_index {
            files.push((path, false));
        }
    }
    Ok(())
}

/// The gaits of a library, or the most regular stride of each take of a motion file.
fn gaits_of(path: &Path) -> Result<Vec<Gait>, Error> {
    if super::is_glb(path) {
        return Ok(library(Some(path))?.gaits().to_vec());
    }
    let takes = import::import_file(path)?;
    let gaits: Result<Vec<Gait>, crate::gait::Error> = takes.iter().map(stride::best).collect();
    Ok(gaits?)
}
