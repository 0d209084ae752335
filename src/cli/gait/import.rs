//! `gaitway gait import`: motion files and whole folders in, one gait library out, and a reason for all that is left out.

use super::super::output::{note, say, say_json, table};
use super::super::progress::Progress;
use super::super::{failed, usage};
use super::{Row, table_of_gaits};
use crate::Error;
use crate::gait::import::labels::Labels;
use crate::gait::import::{JointMap, Options, folder};
use crate::gait::stride::{self, Survey};
use crate::gait::{Gait, Joint, Recording};
use crate::library::GaitLibrary;
use clap::Args;
use serde::Serialize;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Instant;

/// Up to so many takes, what the importer inferred is said for each.
const FEW_TAKES: usize = 3;
/// Up to so many files that are not read are listed one by one.
const FEW_UNREAD: usize = 20;
/// Up to so many gaits are listed one by one.
const FEW_GAITS: usize = 40;

/// Arguments of `gaitway gait import`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait import walk1.bvh walk2.c3d --out mine.glb\n  gaitway gait import \
                  captures/ --all --resample 60 --out captures.glb\n  gaitway gait import odd.bvh --joint-map \
                  odd.toml\n\nA joint map names our 16 joints as the files do:\n  like = \"Mixamo\"\n  head = \
                  \"Skull\"\n  left_hand = \"LWRA + LWRB\"\n\nReads .bvh, .amc with its .asf, .c3d, .trc, .npz, .npy, .csv, \
                  .tsv, .txt. What is no walking is refused, with the measure. A capture of the legs alone walks with the upper \
                  body of the norm; what judges gaits refuses it. A table labels.csv beside the files (columns file, subject, \
                  sex, style, label) names who walked, how, and the emotion that people saw: happy, angry, sad or neutral. The \
                  folder of the files is their data set."
)]
pub(super) struct Arguments {
    /// Motion files, and folders that are searched for them
    #[arg(required = true, value_name = "FILE|FOLDER")]
    paths: Vec<PathBuf>,
    /// Gait library to write
    #[arg(long, value_name = "LIB.glb")]
    out: Option<PathBuf>,
    /// Frames per second, whatever the files say: corrects a wrong header
    #[arg(long, value_name = "HZ")]
    rate: Option<f32>,
    /// Metres per unit of length, for files where it cannot be inferred
    #[arg(long, value_name = "METRES")]
    unit: Option<f32>,
    /// Names of the joints: a TOML file, or a rig such as Mixamo
    #[arg(long, value_name = "MAP.toml|RIG")]
    joint_map: Option<String>,
    /// Skeleton of the .amc files, where it does not stand beside them
    #[arg(long, value_name = "FILE.asf")]
    skeleton: Option<PathBuf>,
    /// Bring every take to this frame rate
    #[arg(long, value_name = "HZ")]
    resample: Option<f32>,
    /// Every stride, not only the most regular one of each take
    #[arg(long)]
    all: bool,
    /// Say what was inferred, found and refused in each take, also where nothing is taken
    #[arg(long)]
    report: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// One take and what became of it.
#[derive(Debug, Serialize)]
struct Take {
    file: PathBuf,
    name: String,
    frames: usize,
    rate_hz: f32,
    /// Strikes found, left and right.
    strikes: [usize; 2],
    /// Usable strides that do not overlap.
    strides: usize,
    /// Strides of either foot that were refused, with the reason.
    refused: Vec<String>,
    on_the_spot: bool,
    running: bool,
    /// Joints that were not captured.
    missing: Vec<&'static str>,
    curved: usize,
    taken: usize,
    /// What the importer inferred and repaired.
    report: Vec<String>,
    #[serde(skip)]
    gaits: Vec<Gait>,
    /// Why nothing was taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

/// A file or take that gave no gait.
#[derive(Debug, Serialize)]
struct LeftOut {
    file: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    take: Option<String>,
    reason: String,
}

#[derive(Debug, Serialize)]
struct Listing {
    gaits: Vec<Row>,
    takes: Vec<Take>,
    left_out: Vec<LeftOut>,
    /// Files of the folders that are not read.
    unread: Vec<folder::Unread>,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let options = options(arguments)?;
    let folder::Search { motion: files, unread } = folder::search(&arguments.paths)?;
    if files.is_empty() {
        say_unread(&unread);
        let hint = format!("motion files end in {}", folder::known_extensions());
        return Err(failed("there is no motion file in the folders named", hint));
    }
    let labels = Labels::beside(&files)?;
    let progress = Mutex::new(Progress::new("importing"));
    let done = |count: usize| {
        if let Ok(mut progress) = progress.lock() {
            progress.at(&format!("{count} of {} files", files.len()), count as f64 / files.len() as f64);
        }
    };
    let make = |path: &Path, takes: Vec<Recording>| {
        Ok(takes.into_iter().map(|take| examine(path, take, arguments.all)).collect::<Vec<_>>())
    };
    let outcomes = folder::import_files(&files, &options, &labels, make, done);
    drop(progress);
    for line in labels.unused() {
        note(&format!("warning: {line}"));
    }

    let (mut takes, mut left_out, mut missed) = (Vec::new(), Vec::new(), 0);
    for outcome in outcomes {
        match outcome.result {
            Ok(found) => takes.extend(found),
            Err(error) => {
                // A file that was named must be read; one found in a folder may be left out.
                missed += usize::from(arguments.paths.contains(&outcome.path));
                left_out.push(LeftOut { file: outcome.path, take: None, reason: error.to_string() });
            }
        }
    }
    for take in &takes {
        if let Some(reason) = &take.reason {
            missed += usize::from(arguments.paths.contains(&take.file));
            left_out.push(LeftOut {
                file: take.file.clone(),
                take: Some(take.name.clone()),
                reason: reason.clone(),
            });
        }
    }
    let gaits = unique_names(&mut takes);
    let mut listing = Listing {
        gaits: gaits.iter().map(Row::of).collect(),
        takes,
        left_out,
        unread,
        files: Vec::new(),
        wall_seconds: 0.0,
    };
    if gaits.is_empty() {
        listing.wall_seconds = begin.elapsed().as_secs_f64();
        show(&listing, arguments)?;
        return Err(nothing(&listing));
    }
    if let Some(out) = &arguments.out {
        GaitLibrary::from_gaits(gaits)?.save_glb(out)?;
        listing.files.push(out.clone());
    }
    listing.wall_seconds = begin.elapsed().as_secs_f64();
    show(&listing, arguments)?;
    if missed > 0 {
        let message = format!("{missed} of the files named, or takes of them, were left out");
        return Err(failed(message, "see the reasons above"));
    }
    Ok(true)
}

/// The error that there is no gait, with the last reason, which [`say_reasons`] leaves out.
fn nothing(listing: &Listing) -> Error {
    let reason = listing.left_out.last().map_or("there is no gait in what is named", |left| &left.reason);
    let hint = if listing.takes.is_empty() {
        format!("motion files end in {}", folder::known_extensions())
    } else {
        "`--report` shows what was inferred of each take".to_owned()
    };
    failed(reason, hint)
}

fn show(listing: &Listing, arguments: &Arguments) -> Result<(), Error> {
    if arguments.json {
        say_reasons(listing);
        say_json(listing)?;
    } else {
        print(listing, arguments);
    }
    Ok(())
}

fn options(arguments: &Arguments) -> Result<Options, Error> {
    let joint_map = match &arguments.joint_map {
        None => None,
        Some(name) => match JointMap::named(name) {
            Some(map) => Some(map),
            None if Path::new(name).extension().is_some() || Path::new(name).exists() => {
                Some(JointMap::load(Path::new(name))?)
            }
            None => {
                let known = JointMap::known().join(", ");
                return Err(usage(
                    format!("--joint-map {name}: neither a file nor a rig that is known"),
                    format!("known are {known}; or name a TOML file"),
                ));
            }
        },
    };
    Ok(Options {
        skeleton: arguments.skeleton.clone(),
        metres_per_unit: arguments.unit,
        frame_rate: arguments.rate,
        joint_map,
        resample: arguments.resample,
        as_published: false,
    })
}

/// What was found in a take: strikes, strides, what the feet do in the one taken, and what was refused.
fn findings(survey: &Survey, strides: usize) -> Vec<String> {
    let [left, right] = survey.strikes.each_ref().map(Vec::len);
    let rules = survey.by_height.map(|by_height| if by_height { "lowest foot" } else { "furthest reach" });
    let mut lines = vec![
        format!("strikes: {left} of the left foot (by {}), {right} of the right (by {})", rules[0], rules[1]),
        format!("strides: {strides} that do not overlap, of {} from either foot", survey.strides.len()),
    ];
    if let Some(support) = survey.best().and_then(|stride| stride.support) {
        let both = |what: &str, [left, right]: [f32; 2], unit: &str| {
            format!("{what} {left:.2} {unit} (left) and {right:.2} {unit} (right)")
        };
        let kind = if support.is_running() { "running" } else { "walking" };
        lines.push(format!(
            "{kind}: {:.2} m/s, {}, {}, {}, {:.0} % in flight",
            support.speed,
            both("steps of", support.step, "m"),
            both("feet lifted by", support.lift, "m"),
            both("ground under them goes back at", support.ground, "m/s"),
            100.0 * support.flight
        ));
    }
    lines.extend(
        survey.reasons().iter().map(|(count, why)| format!("refused: {count} strides, because: {why}")),
    );
    lines
}

/// Strikes and strides of one take.
fn examine(path: &Path, mut recording: Recording, all: bool) -> Take {
    let (survey, reason) = match stride::survey(&recording) {
        Ok(survey) if survey.strides.is_empty() => {
            let reason = survey.none_found(&recording).to_string();
            (survey, Some(reason))
        }
        Ok(survey) => (survey, None),
        Err(error) => (Survey::default(), Some(error.to_string())),
    };
    let apart = survey.apart();
    recording.report.extend(findings(&survey, apart.len()));
    let curved = apart.iter().filter(|stride| stride.is_curved()).count();
    let strides = apart.len();
    let gaits: Vec<Gait> = if all {
        apart.into_iter().map(|stride| stride.gait).collect()
    } else {
        survey.best().map(|stride| stride.gait.clone()).into_iter().collect()
    };
    // Of a cycle that is repeated, one repetition counts.
    let repeats = if recording.cyclic { stride::REPEATS } else { 1 };
    Take {
        file: path.to_owned(),
        frames: recording.poses.len(),
        rate_hz: recording.frame_rate,
        strikes: survey.strikes.each_ref().map(|times| times.len() / repeats),
        strides,
        refused: survey
            .refused
            .iter()
            .map(|refused| format!("at {:.2} s, {}: {}", refused.begin, refused.foot.name(), refused.why))
            .collect(),
        on_the_spot: survey.on_the_spot,
        running: survey.best().and_then(|stride| stride.support).is_some_and(|support| support.is_running()),
        missing: recording.missing.iter().map(Joint::name).collect(),
        curved,
        taken: gaits.len(),
        name: recording.name,
        report: recording.report,
        gaits,
        reason,
    }
}

/// All gaits in order, under unique names: the folder precedes a name that occurs in several files, and a number follows
/// names that are still equal.
fn unique_names(takes: &mut [Take]) -> Vec<Gait> {
    let mut files_of: HashMap<String, HashSet<PathBuf>> = HashMap::new();
    for take in takes.iter() {
        files_of.entry(take.name.clone()).or_default().insert(take.file.clone());
    }
    let mut taken: HashSet<String> = HashSet::new();
    let mut gaits = Vec::new();
    for take in takes {
        let several = files_of.get(&take.name).is_some_and(|files| files.len() > 1);
        let folder =
            take.file.parent().and_then(Path::file_name).map(|name| name.to_string_lossy().into_owned());
        for mut gait in std::mem::take(&mut take.gaits) {
            if let (true, Some(folder)) = (several, &folder) {
                gait.name = format!("{folder}/{}", gait.name);
            }
            let plain = gait.name.clone();
            let mut number = 1;
            while !taken.insert(gait.name.clone()) {
                number += 1;
                gait.name = format!("{plain} ({number})");
            }
            gaits.push(gait);
        }
    }
    gaits
}

/// The reasons, and what the importer has to warn of, on standard error.
fn say_reasons(listing: &Listing) {
    let said = listing.left_out.len().saturating_sub(usize::from(listing.gaits.is_empty()));
    for left in &listing.left_out[..said] {
        // Messages begin with the file or the take already where they come from the importer.
        note(&format!("left out: {}", left.reason));
    }
    say_unread(&listing.unread);
}

/// Files of the folders that are not read, on standard error.
fn say_unread(unread: &[folder::Unread]) {
    for unread in unread.iter().take(FEW_UNREAD) {
        note(&format!("not read: {}: {}", unread.file.display(), unread.reason));
    }
    if unread.len() > FEW_UNREAD {
        note(&format!("not read: {} more files; --json lists them all", unread.len() - FEW_UNREAD));
    }
}

fn print(listing: &Listing, arguments: &Arguments) {
    let is_few = listing.takes.len() <= FEW_TAKES;
    for take in &listing.takes {
        for line in &take.report {
            if is_few || arguments.report || line.starts_with("warning") {
                note(&format!("{}: {line}", take.name));
            }
        }
    }
    say_reasons(listing);
    if !listing.takes.is_empty() {
        let rows: Vec<Vec<String>> = listing.takes.iter().map(words).collect();
        let head =
            ["take", "frames", "Hz", "strikes", "strides", "refused", "taken", "m/s", "remarks", "file"];
        table(&head, &with_speeds(rows, listing));
        say("");
    }
    if (1..=FEW_GAITS).contains(&listing.gaits.len()) {
        table_of_gaits(&listing.gaits);
        say("");
    }
    let empty = listing.takes.iter().filter(|take| take.reason.is_some()).count();
    let failed = listing.left_out.len() - empty;
    say(&format!(
        "{} gaits of {} takes; {empty} takes and {failed} files left out, {} files not read",
        listing.gaits.len(),
        listing.takes.len(),
        listing.unread.len()
    ));
    for file in &listing.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", listing.wall_seconds));
}

fn words(take: &Take) -> Vec<String> {
    let mut remarks = Vec::new();
    if take.on_the_spot {
        remarks.push("on the spot".to_owned());
    }
    if take.running {
        remarks.push("running".to_owned());
    }
    if !take.missing.is_empty() {
        remarks.push(format!("{} joints missing", take.missing.len()));
    }
    if take.curved > 0 {
        remarks.push(format!("{} curved", take.curved));
    }
    if take.report.iter().any(|line| line.contains("joints swapped")) {
        remarks.push("sides swapped".to_owned());
    }
    if take.report.iter().any(|line| line.starts_with("warning")) {
        remarks.push("see warnings".to_owned());
    }
    if remarks.is_empty() {
        remarks.push("-".to_owned());
    }
    let file = take.file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    vec![
        take.name.clone(),
        take.frames.to_string(),
        format!("{:.1}", take.rate_hz),
        format!("{}+{}", take.strikes[0], take.strikes[1]),
        take.strides.to_string(),
        take.refused.len().to_string(),
        take.taken.to_string(),
        String::new(),
        remarks.join(", "),
        file,
    ]
}

/// Fills in the mean speed of the gaits taken of each take.
fn with_speeds(mut rows: Vec<Vec<String>>, listing: &Listing) -> Vec<Vec<String>> {
    let mut gaits = listing.gaits.iter();
    for (row, take) in rows.iter_mut().zip(&listing.takes) {
        let speeds: Vec<f32> = gaits.by_ref().take(take.taken).map(|gait| gait.v_des).collect();
        if let Some(cell) = row.get_mut(7) {
            *cell = match speeds.len() {
                0 => "-".to_owned(),
                count => format!("{:.2}", speeds.iter().sum::<f32>() / count as f32),
            };
        }
    }
    rows
}
