//! Whole folders: which files, and all of them at once.

use super::labels::{self, Labels};
use super::{EXTENSIONS, Error, Options, import_labelled, list, text};
use crate::gait::Recording;
use rayon::prelude::*;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Most files of one import.
#[doc(hidden)]
pub const MAX_FILES: usize = 1_000_000;
/// Folders within folders.
const MAX_DEPTH: usize = 32;

/// What became of one file.
#[derive(Debug)]
pub struct Outcome<T> {
    /// The file.
    pub path: PathBuf,
    /// What it gave, or why it gave nothing.
    pub result: Result<T, crate::Error>,
}

/// A file of a folder that is not read.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Unread {
    /// The file.
    pub file: PathBuf,
    /// Why.
    pub reason: String,
}

/// What is in folders.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Search {
    /// The motion files.
    pub motion: Vec<PathBuf>,
    /// The others, but for those that belong to motion files (skeletons, index files) and hidden ones.
    pub unread: Vec<Unread>,
}

/// The motion files that `paths` name; see [`search`].
///
/// # Errors
/// As [`search`].
#[doc(hidden)]
pub fn motion_files(paths: &[PathBuf]) -> Result<Vec<PathBuf>, Error> {
    Ok(search(paths)?.motion)
}

/// The files that `paths` name: files as they are, folders with all that is in them, by extension.
///
/// Sorted by path within each folder, in the order of `paths`; a file that is named twice counts once. Skeletons
/// (`.asf`), tables of labels (`labels.csv`, ...) and names that begin with a dot are no motion files. Symbolic links to
/// folders are not followed.
///
/// # Errors
/// [`Error::Read`] if a folder cannot be listed, [`Error::Syntax`] if there are more than [`MAX_FILES`].
pub fn search(paths: &[PathBuf]) -> Result<Search, Error> {
    let mut found = Search::default();
    for path in paths {
        if path.is_dir() {
            walk(path, 0, &mut found)?;
        } else {
            found.motion.push(path.clone());
        }
    }
    let mut seen = std::collections::HashSet::new();
    found.motion.retain(|path| seen.insert(path.clone()));
    found.unread.retain(|unread| seen.insert(unread.file.clone()));
    Ok(found)
}

fn walk(folder: &Path, depth: usize, found: &mut Search) -> Result<(), Error> {
    let failed = |source| Error::Read { path: folder.to_owned(), source };
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        entries.push((entry.path(), entry.file_type().map_err(failed)?));
    }
    entries.sort_by(|a, b| a.0.cmp(&b.0));
    for (path, kind) in entries {
        let name =
            path.file_name().map(|name| name.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
        if name.starts_with('.') {
            continue;
        }
        if kind.is_dir() {
            if depth < MAX_DEPTH {
                walk(&path, depth + 1, found)?;
            } else {
                let reason = format!("{MAX_DEPTH} folders deep; import it by name");
                found.unread.push(Unread { file: path, reason });
            }
        } else if path.is_file() {
            if found.motion.len() + found.unread.len() == MAX_FILES {
                let message = format!("more than {MAX_FILES} files; import the folders in it one by one");
                return Err(text::syntax(&folder.display().to_string(), 0, message));
            }
            if is_motion(&name) {
                found.motion.push(path);
            } else if let Some(reason) = why_unread(&name) {
                found.unread.push(Unread { file: path, reason });
            }
        }
    }
    Ok(())
}

/// Why a file that is no motion is not read; `None` for what is read beside motion files.
fn why_unread(name: &str) -> Option<String> {
    let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
    match ending {
        "asf" => None,
        _ if labels::is_table(name) => None,
        "txt" => Some("a note by its name".to_owned()),
        "h5" | "hdf5" => Some("HDF5 is not read; turn it into .npz".to_owned()),
        "fbx" => Some("FBX is not read; export it as BVH".to_owned()),
        "glb" => Some("a gait library or model, no capture".to_owned()),
        "" => Some("no ending that tells a format".to_owned()),
        other => Some(format!("unknown ending .{other}")),
    }
}

fn is_motion(name: &str) -> bool {
    !labels::is_table(name)
        && name.rsplit_once('.').is_some_and(|(stem, ending)| {
            // Notes and licences are text files, but no takes.
            let is_note = ending == "txt"
                && ["license", "licence", "notice", "readme"].iter().any(|w| stem.starts_with(w));
            EXTENSIONS.contains(&ending) && !is_note
        })
}

/// Imports many files in parallel and makes something of the takes of each; the outcomes are in the order of `files`.
///
/// `labels` are those of [`Labels::beside`] the files; `make` gets the takes of one file; `done` receives the number of
/// files done so far, from any thread.
pub fn import_files<T: Send>(
    files: &[PathBuf],
    options: &Options,
    labels: &Labels,
    make: impl Fn(&Path, Vec<Recording>) -> Result<T, crate::Error> + Sync,
    done: impl Fn(usize) + Sync,
) -> Vec<Outcome<T>> {
    let count = std::sync::atomic::AtomicUsize::new(0);
    let one = |path: &PathBuf| {
        let takes = import_labelled(path, options, labels).map_err(crate::Error::from);
        let result = takes.and_then(|takes| make(path, takes));
        done(count.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1);
        Outcome { path: path.clone(), result }
    };
    files.par_iter().map(one).collect()
}

/// What can be imported, for messages.
#[doc(hidden)]
pub fn known_extensions() -> String {
    list(&EXTENSIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_searched_in_order_and_only_for_motion() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir_all(at("b/deep")).unwrap();
        std::fs::create_dir_all(at(".git")).unwrap();
        for name in [
            "z.BVH",
            "b/deep/1.c3d",
            "b/2.npz",
            "a.amc",
            "a.asf",
            "labels.csv",
            "Gaits.TSV",
            "x.csv",
            "README.txt",
            ".hidden.bvh",
            ".git/y.bvh",
            "picture.png",
            "NOTICE.txt",
            "walk.txt",
        ] {
            std::fs::write(at(name), "").unwrap();
        }
        let found = motion_files(&[at("x.csv"), folder.path().to_owned()]).unwrap();
        let names: Vec<String> =
            found.iter().map(|p| p.strip_prefix(folder.path()).unwrap().display().to_string()).collect();
        assert_eq!(names, ["x.csv", "a.amc", "b/2.npz", "b/deep/1.c3d", "walk.txt", "z.BVH"]);
        let unread = search(&[folder.path().to_owned()]).unwrap().unread;
        let unread: Vec<String> = unread
            .iter()
            .map(|u| format!("{}: {}", u.file.file_name().unwrap().to_string_lossy(), u.reason))
            .collect();
        assert_eq!(
            unread,
            [
                "NOTICE.txt: a note by its name",
                "README.txt: a note by its name",
                "picture.png: unknown ending .png"
            ]
        );
        assert!(
            motion_files(&[at("nowhere")]).unwrap().len() == 1,
            "a file that is not there fails when it is read"
        );
    }

    #[test]
    fn outcomes_keep_the_order_of_the_files() {
        let folder = tempfile::tempdir().unwrap();
        let files: Vec<PathBuf> = (0..40).map(|i| folder.path().join(format!("{i}.bvh"))).collect();
        let done = std::sync::atomic::AtomicUsize::new(0);
        let outcomes = import_files(
            &files,
            &Options::default(),
            &Labels::default(),
            |_, takes| Ok(takes.len()),
            |_| {
                done.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
            },
        );
        assert!(
            outcomes
                .iter()
                .zip(&files)
                .all(|(outcome, file)| outcome.path == *file && outcome.result.is_err())
        );
        assert_eq!(done.into_inner(), 40);
    }
}
