//! `gaitway study clips`: films of scenes and single agents from the user's eyes, for a study in the browser.

use super::super::output::{note, say};
use super::super::render::{Looks, size, stage, video};
use super::opening::OpeningArguments;
use super::serve::CLIPS;
use crate::scene::CameraChoice;
use crate::study::plan::{Role, Stimulus, Trial};
use crate::study::store::{Shown, Version};
use crate::study::theatre::{Showing, Theatre};
use crate::{Error, stop};
use std::path::{Path, PathBuf};

/// Frames a second; each is a step of the simulation.
const RATE: f64 = 30.0;

/// Arguments of `gaitway study clips`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  gaitway study clips mine/ --data run1/\n  gaitway study serve mine/ --data run1/\n\nWalks are drawn by \
                  the browser and need no clips. Clips that are there are kept, so it may be interrupted and called again. Their \
                  names tell nothing about what they show."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    opening: OpeningArguments,
    /// Pixels
    #[arg(long, default_value = "960x540", value_parser = size, value_name = "WIDTHxHEIGHT")]
    size: (u32, u32),
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let store = arguments.opening.open()?;
    let version = store.current();
    let folder = arguments.opening.data.join(CLIPS);
    std::fs::create_dir_all(&folder)
        .map_err(|source| crate::study::Error::Write { path: folder.clone(), source })?;
    let all = wanted(&version, &folder);
    let missing: Vec<_> = all.iter().filter(|(path, _)| !path.is_file()).collect();
    note(&format!("note: {} clips, {} to be made", all.len(), missing.len()));
    let theatre = version.theatre()?;
    let heed = stop::heed();
    for (number, (path, shown)) in missing.iter().enumerate() {
        if stop::asked() {
            break;
        }
        note(&format!("note: clip {} of {}", number + 1, missing.len()));
        film(&theatre, &version, shown, path, arguments.size)?;
    }
    drop(heed);
    let made = all.iter().filter(|(path, _)| path.is_file()).count();
    say(&format!("clips     {made} of {} in {}", all.len(), folder.display()));
    Ok(made == all.len())
}

/// Files and contents of a version's clips, in the order of the files.
fn wanted<'v>(version: &'v Version, folder: &Path) -> Vec<(PathBuf, &'v Shown)> {
    let clips = version.stimuli.iter().filter(|(_, shown)| !matches!(shown.stimulus, Stimulus::Gait { .. }));
    let mut clips: Vec<_> = clips.map(|(name, shown)| (folder.join(format!("{name}.mp4")), shown)).collect();
    clips.sort_by(|a, b| a.0.cmp(&b.0));
    clips
}

fn film(
    theatre: &Theatre,
    version: &Version,
    shown: &Shown,
    path: &Path,
    size: (u32, u32),
) -> Result<(), Error> {
    let seconds = version.plan.trials_of(&shown.part).map_or(0.0, |step| step.shows.seconds);
    let trial = Trial {
        part: shown.part.clone(),
        position: 1,
        item: None,
        block: None,
        row: None,
        seed: shown.seed,
        role: Role::Ordinary,
    };
    let scene = theatre.scene(&Showing { trial, stimulus: Some(shown.stimulus.clone()) })?;
    let every = super::super::course::steps_per_frame(RATE, &scene)?;
    let steps = scene.steps(seconds);
    let mut stage = stage(scene, size, Looks::default())?;
    // under another name until it is whole, whatever ends it
    let partial = path.with_file_name("unfinished.mp4");
    let (written, frames) = video(&mut stage, CameraChoice::Eyes, (steps, every), &partial, RATE)?;
    if u64::from(steps / every) <= frames {
        std::fs::rename(&written, path)
            .map_err(|source| crate::study::Error::Write { path: path.to_owned(), source })?;
    }
    Ok(())
}
