//! `gaitway study replay`: recordings of trials, done again and compared.

use super::super::output::{say, say_json, warn};
use super::super::recorded::{self, Replayed};
use super::super::{failed, scene};
use crate::Error;
use crate::study::headset::Showing;
use crate::study::plan::Stimulus;
use crate::study::store::{RECORDINGS, Reading, Version};
use crate::study::theatre::Theatre;
use crate::xr::RecordedSession;
use serde::Serialize;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::{Path, PathBuf};

/// Arguments of `gaitway study replay`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study replay run1/\n  gaitway study replay run1/ run1/recordings/K7Q0.../scenes-3.csv\n\n\
                  The data say what a trial showed: scene, condition, seed, gaits and bodies. A recording that was made under \
                  others is refused. The crowd of one that fits must be that of the session bit for bit, on any device."
)]
pub(super) struct Arguments {
    /// Folder of the study's data
    #[arg(value_name = "DIR")]
    data: PathBuf,
    /// Recordings [default: all of the data]
    #[arg(value_name = "FILE.csv")]
    files: Vec<PathBuf>,
    /// As if it had been shown under this condition: such a recording is refused
    #[arg(long, value_name = "CONDITION")]
    condition: Option<String>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct One {
    file: PathBuf,
    #[serde(flatten)]
    replayed: Replayed,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let reading = Reading::open(&arguments.data)?;
    let files = if arguments.files.is_empty() { all(&arguments.data)? } else { arguments.files.clone() };
    if files.is_empty() && !arguments.json {
        say("there are no recordings");
    }
    let mut theatres = BTreeMap::new();
    let (mut done, mut is_good) = (Vec::new(), true);
    for file in files {
        match one(arguments, &reading, &mut theatres, &file) {
            Ok(replayed) => {
                is_good &= replayed.is_good();
                if !arguments.json {
                    print(&file, &replayed);
                }
                done.push(One { file, replayed });
            }
            // the others are replayed all the same
            Err(error) => {
                is_good = false;
                warn(&format!("refused: {error}"));
            }
        }
    }
    if arguments.json {
        say_json(&done)?;
    }
    Ok(is_good)
}

/// Replays one recording.
fn one(
    arguments: &Arguments,
    reading: &Reading,
    theatres: &mut BTreeMap<u32, Theatre>,
    file: &Path,
) -> Result<Replayed, Error> {
    let found = recorded::read(file)?;
    let (showing, version) = trial(reading, file, &found)?;
    let showing = match &arguments.condition {
        Some(condition) => under(showing, condition),
        None => showing,
    };
    let theatre = match theatres.entry(version.number) {
        Entry::Occupied(known) => known.into_mut(),
        Entry::Vacant(new) => new.insert(version.theatre()?),
    };
    let scene = theatre.scene(&showing)?;
    let mut simulation = scene::start(&scene)?;
    let session = RecordedSession::of(&scene, &theatre.library, simulation.state()?);
    recorded::replay(file, found, &session, &mut simulation)
}

/// All recordings of a folder of data, in the order of their names.
fn all(data: &Path) -> Result<Vec<PathBuf>, Error> {
    let mut files = Vec::new();
    let folder = data.join(RECORDINGS);
    let list = |folder: &Path| -> Result<Vec<PathBuf>, Error> {
        let read = std::fs::read_dir(folder).and_then(|entries| {
            entries.map(|entry| entry.map(|entry| entry.path())).collect::<std::io::Result<Vec<_>>>()
        });
        read.map_err(|source| crate::study::Error::Read { path: folder.to_owned(), source }.into())
    };
    if folder.is_dir() {
        for person in list(&folder)?.into_iter().filter(|path| path.is_dir()) {
            files.extend(
                list(&person)?.into_iter().filter(|file| file.extension().is_some_and(|is| is == "csv")),
            );
        }
    }
    files.sort();
    Ok(files)
}

/// What the trial of a recording showed, as the data say it.
fn trial(
    reading: &Reading,
    file: &Path,
    found: &crate::xr::Recording,
) -> Result<(Showing, std::sync::Arc<Version>), Error> {
    let name = file.display();
    let label = found.session.trial.as_ref().ok_or_else(|| {
        let hint = "replay it with `gaitway xr SCENE --replay FILE`";
        failed(format!("{name}: it is of no trial of a study"), hint)
    })?;
    reading.showing(&label.participant, &label.part, label.trial).ok_or_else(|| {
        let message = format!(
            "{name}: the data have no participant {} with a trial {} of {}",
            label.participant, label.trial, label.part
        );
        failed(message, "name the folder of data that it was recorded into")
    })
}

/// The same trial under another condition.
fn under(showing: Showing, condition: &str) -> Showing {
    let condition = condition.to_owned();
    let stimulus = showing.stimulus.map(|stimulus| match stimulus {
        Stimulus::Scene { scene, .. } => Stimulus::Scene { scene, condition },
        Stimulus::Agent { emotion, body, .. } => Stimulus::Agent { emotion, body, condition },
        Stimulus::Gait { gait } => Stimulus::Gait { gait },
    });
    Showing { stimulus, ..showing }
}

fn print(file: &Path, replayed: &Replayed) {
    let Replayed { steps, compared_steps, .. } = replayed;
    let what = match (replayed.equal, replayed.differs_after, &replayed.recorded_hash) {
        (_, Some(after), _) => format!("DIFFERS after {after} steps"),
        (Some(true), None, Some(_)) => "equal".to_owned(),
        (Some(true), None, None) => format!("equal up to step {compared_steps}; it broke off"),
        _ => "nothing to compare with".to_owned(),
    };
    say(&format!("{}  {steps} steps  {what}", file.display()));
}
