//! Gaits for `compare`, `predict`, `label` and `train`: out of libraries, motion files and folders of them.

use super::super::failed;
use super::super::output::{complain, note};
use super::super::scene::library;
use crate::Error;
use crate::gait::import::labels::Labels;
use crate::gait::import::{Options, folder, import_labelled};
use crate::gait::{Gait, Recording, stride};
use crate::perception::model::Preparation;
use rayon::prelude::*;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Reasons for leaving something out that are shown.
const REASONS: usize = 10;

/// Gaits, with the file of each, and whether every file that was named could be used.
pub(in crate::cli) struct Found {
    pub(in crate::cli) gaits: Vec<(PathBuf, Gait)>,
    pub(in crate::cli) is_complete: bool,
}

/// Reads all gaits of libraries and the most regular stride of each take of motion files. Of takes of one name the first
/// is kept; gaits with joints that were not captured are left out. A note names what is left out, with the reason.
/// `preparation` is that of the model that the gaits are for.
pub(in crate::cli) fn read(paths: &[PathBuf], preparation: Preparation) -> Result<Found, Error> {
    let files = folder::motion_files(paths)?;
    let labels = Labels::beside(&files)?;
    let as_published = preparation == Preparation::AsPublished;
    let options = Options { as_published, ..Options::default() };
    let read: Vec<Result<Vec<Gait>, Error>> =
        files.par_iter().map(|path| gaits_of(path, &options, &labels)).collect();
    for line in labels.unused() {
        note(&format!("warning: {line}"));
    }
    let (mut gaits, mut missed, mut reasons) = (Vec::new(), Vec::new(), Vec::new());
    let mut names = HashSet::new();
    for (path, read) in files.into_iter().zip(read) {
        match read {
            Ok(found) => {
                for gait in found {
                    if let Err(error) = gait.check_whole() {
                        if paths.contains(&path) {
                            missed.push(error.into());
                        } else {
                            reasons.push(error.to_string());
                        }
                        continue;
                    }
                    if names.insert(gait.name.clone()) {
                        gaits.push((path.clone(), gait));
                    } else {
                        let (file, name) = (path.display(), &gait.name);
                        reasons.push(format!("{file}: {name}: a gait of this name is there"));
                    }
                }
            }
            Err(error) if paths.contains(&path) => missed.push(error),
            Err(error) => reasons.push(error.to_string()),
        }
    }
    for reason in reasons.iter().take(REASONS) {
        note(&format!("left out: {reason}"));
    }
    if reasons.len() > REASONS {
        note(&format!("left out: {} more", reasons.len() - REASONS));
    }
    let is_complete = missed.is_empty();
    let mut missed = missed.into_iter();
    // where nothing is left to go on with, the first error is that of the command
    let first = if gaits.is_empty() { missed.next() } else { None };
    missed.for_each(|error| complain(&error, false));
    first.map_or(Ok(Found { gaits, is_complete }), Err)
}

/// How gaits are prepared that are taken as they were published, or not.
pub(in crate::cli) const fn preparation(as_published: bool) -> Preparation {
    if as_published { Preparation::AsPublished } else { Preparation::Repaired }
}

/// The gaits of a library, or the most regular stride of each take of a motion file.
fn gaits_of(path: &Path, options: &Options, labels: &Labels) -> Result<Vec<Gait>, Error> {
    if super::is_glb(path) {
        if options.as_published {
            return Err(not_as_published(path));
        }
        return Ok(library(Some(path))?.gaits().to_vec());
    }
    let takes = import_labelled(path, options, labels)?;
    if options.as_published {
        let whole =
            |take: &Recording| if take.cyclic { Ok(whole(take)) } else { Err(not_as_published(path)) };
        return takes.iter().map(whole).collect();
    }
    let gaits: Result<Vec<Gait>, crate::gait::Error> = takes.iter().map(stride::best).collect();
    Ok(gaits?)
}

/// A model trained on gaits as published meets gaits prepared otherwise.
fn not_as_published(path: &Path) -> Error {
    failed(
        format!(
            "{}: not E-Gait as it was published, and only such gaits are like those of --as-published",
            path.display()
        ),
        "train the model without --as-published",
    )
}

/// A cyclic take as a gait that goes nowhere.
fn whole(take: &Recording) -> Gait {
    Gait {
        name: take.name.clone(),
        poses: take.poses.clone(),
        frame_rate: take.frame_rate,
        speed: 0.0,
        provenance: take.provenance.clone(),
        acted: take.acted.clone(),
        ratings: None,
        label: take.label,
        missing: take.missing,
    }
}
