//! Files that exist are kept: a command that would replace one, or write into a folder with something in it, is refused
//! before it begins, unless `--force` is given.

use super::failed;
use crate::Error;
use clap::ArgMatches;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};

/// Names of the options that say where results go, of all commands.
const OUTPUTS: [&str; 10] =
    ["out", "into", "rated", "render", "record", "shot", "shots", "figures", "videos", "csv"];

/// Commands whose options have rules of their own. Recordings of a headset: a broken-off one is kept under another name, and
/// none is ever replaced. Folders of runs: what is there is kept and added to.
const OWN_RULES: [(&str, &str); 3] = [("xr", "record"), ("run", "out"), ("plan", "out")];

/// Whether `--force` was given.
static IS_FORCED: AtomicBool = AtomicBool::new(false);

/// Checks every path that a command is to write.
pub(super) fn check(found: &ArgMatches, is_forced: bool) -> Result<(), Error> {
    IS_FORCED.store(is_forced, Ordering::Relaxed);
    let (mut found, mut command) = (found, "");
    while let Some((name, deeper)) = found.subcommand() {
        (found, command) = (deeper, name);
    }
    for name in OUTPUTS.into_iter().filter(|name| !OWN_RULES.contains(&(command, *name))) {
        // an error: this command has no such option
        for path in found.try_get_many::<PathBuf>(name).ok().flatten().into_iter().flatten() {
            free(path)?;
        }
    }
    Ok(())
}

/// Checks that writing to a name loses nothing, unless `--force` is given.
pub(super) fn free(path: &Path) -> Result<(), Error> {
    if IS_FORCED.load(Ordering::Relaxed) {
        return Ok(());
    }
    let what = match std::fs::read_dir(path).map(Iterator::count) {
        Ok(0) => return Ok(()),
        Ok(_) => "is a folder with something in it",
        Err(_) if std::fs::symlink_metadata(path).is_ok() => "exists already",
        Err(_) => return Ok(()),
    };
    Err(failed(format!("{} {what}", path.display()), "choose another name, or add --force to write there"))
}

/// Makes a folder for results.
pub(super) fn make_folder(path: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(path)
        .map_err(|source| crate::export::Error::Write { path: path.to_owned(), source }.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::any::TypeId;

    /// Options and arguments that say what is read.
    const INPUTS: [&str; 16] = [
        "avatar",
        "key",
        "file",
        "files",
        "paths",
        "project",
        "responses",
        "library",
        "model",
        "train_on",
        "data",
        "skeleton",
        "homography",
        "replay",
        "check_walker",
        "rig_map",
    ];

    #[test]
    fn every_path_of_every_command_is_known_as_input_or_output() {
        let mut all = vec![super::super::command_line()];
        while let Some(command) = all.pop() {
            for argument in command.get_arguments() {
                let id = argument.get_id().as_str();
                let is_path = argument.get_value_parser().type_id() == TypeId::of::<PathBuf>();
                let is_known = OUTPUTS.contains(&id) || INPUTS.contains(&id);
                assert!(!is_path || is_known, "{} {id}: input or output?", command.get_name());
            }
            all.extend(command.get_subcommands().cloned());
        }
    }

    #[test]
    fn only_what_is_not_there_and_empty_folders_are_free() {
        let folder = tempfile::tempdir().unwrap();
        assert!(free(folder.path()).is_ok() && free(&folder.path().join("new.csv")).is_ok());
        let file = folder.path().join("old.csv");
        std::fs::write(&file, "").unwrap();
        assert!(free(&file).unwrap_err().to_string().contains("exists"));
        assert!(free(folder.path()).unwrap_err().to_string().contains("folder"));
    }
}
