//! `gaitway gait compare`: how well the methods agree with people, on the same gaits and folds, beside the paper's table.

use super::super::output::{note, say, say_json, table};
use super::super::progress::Progress;
use super::super::scene::library;
use super::super::usage;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::{Gait, import, stride};
use crate::perception::comparison::{PUBLISHED, methods, variants};
use crate::perception::evaluate::{Evaluation, Grouping, Plan, evaluate_with, folds};
use crate::perception::{Method, perceiver};
use clap::{Args, ValueEnum};
use rayon::prelude::*;
use serde::Serialize;
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Endings of the files in a folder that are read.
const ENDINGS: [&str; 4] = ["amc", "bvh", "csv", "txt"];
/// Reasons for leaving files and takes out that are shown.
const REASONS_SHOWN: usize = 12;

/// Arguments of `gaitway gait compare`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait compare --data egait/ --folds subject --repeats 10\n  gaitway gait compare \
                  --data mine.glb --json\n\nThe gaits need labels: in the library, or in a gaits.csv beside the motion files \
                  (columns key, subject, perceived_label). Files of which the takes are known already by name are left out."
)]
pub(super) struct Arguments {
    /// Folder of motion files, motion file, or gait library (.glb), with labels
    #[arg(long, value_name = "DIR|LIB")]
    data: PathBuf,
    /// What is held out together
    #[arg(long, value_enum, default_value_t)]
    folds: Folds,
    /// Number of folds, for stratified and subject
    #[arg(long, value_name = "K", default_value_t = 10, value_parser = clap::value_parser!(u16).range(2..=1000))]
    k: u16,
    /// Repeats, each with folds of its own
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// Seed of the first repeat; the others follow it
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Only these methods
    #[arg(long, value_name = "NAME", value_delimiter = ',')]
    methods: Vec<String>,
    /// Also the settings that the paper and the cards of the methods leave open
    #[arg(long)]
    settings: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Folds {
    /// The same share of each emotion in every fold
    Stratified,
    /// No person in two folds
    #[default]
    Subject,
    /// Each data set in turn
    Dataset,
}

/// One row of the table.
#[derive(Debug, Serialize)]
struct Row {
    method: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    settings: Option<String>,
    /// What the paper prints, 0 to 1, on its own gaits and folds.
    published: Option<f64>,
    accuracy_mean: f64,
    accuracy_sd: f64,
    /// 95 % of what other gaits of the same number would give: Wilson's interval of the mean accuracy.
    accuracy_interval: [f64; 2],
    accuracies: Vec<f64>,
    recall: BTreeMap<&'static str, f64>,
    confusion: [[u64; 4]; 4],
    by_dataset: BTreeMap<String, f64>,
}

#[derive(Debug, Serialize)]
struct Report {
    methods: Vec<Row>,
    folds: Folds,
    fold_count: usize,
    seeds: Vec<u64>,
    gaits: usize,
    of_emotion: BTreeMap<&'static str, usize>,
    left_out: Vec<String>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let chosen = choose(arguments)?;
    let mut left_out = Vec::new();
    let all = load(&arguments.data, &mut left_out)?;
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        all.iter().filter_map(|gait| Some((gait, gait.label?))).unzip();
    if gaits.len() < all.len() {
        left_out.push(format!("{} gaits without a label", all.len() - gaits.len()));
    }
    for reason in left_out.iter().take(REASONS_SHOWN) {
        note(&format!("left out: {reason}"));
    }
    if left_out.len() > REASONS_SHOWN {
        note(&format!("left out: {} more; --json lists them", left_out.len() - REASONS_SHOWN));
    }
    if gaits.is_empty() {
        let data = arguments.data.display();
        return Err(usage(
            format!("--data {data}: no gait has a label"),
            "put a gaits.csv with the columns key, subject, perceived_label beside the motion files",
        ));
    }
    let count = usize::from(arguments.k);
    let grouping = match arguments.folds {
        Folds::Stratified => Grouping::Stratified { folds: count },
        Folds::Subject => Grouping::Subject { folds: count },
        Folds::Dataset => Grouping::Dataset,
    };
    let seeds: Vec<u64> = (0..u64::from(arguments.repeats)).map(|i| arguments.seed.wrapping_add(i)).collect();
    let fold_count =
        folds(&gaits, &emotions, grouping, arguments.seed)?.iter().max().map_or(0, |last| last + 1);
    let plan = Plan { grouping, seeds: seeds.clone() };
    let rows = compare(&chosen, &gaits, &emotions, &plan, fold_count)?;
    let of_emotion = Emotion::ALL
        .map(|emotion| (emotion.name(), emotions.iter().filter(|&&other| other == emotion).count()));
    let report = Report {
        methods: rows,
        folds: arguments.folds,
        fold_count,
        seeds,
        gaits: gaits.len(),
        of_emotion: of_emotion.into(),
        left_out,
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json { say_json(&report) } else { show(&report, grouping) }?;
    Ok(true)
}

/// A method with words for its settings where it is there more than once.
type Chosen = (Box<dyn Method>, Option<String>);

fn choose(arguments: &Arguments) -> Result<Vec<Chosen>, Error> {
    let mut all: Vec<Chosen> = methods().into_iter().map(|method| (method, None)).collect();
    if arguments.settings {
        all.extend(variants().into_iter().map(|(method, words)| (method, Some(words))));
        // each beside its own; the order of the table stays
        let order: Vec<&str> = methods().iter().map(|method| method.name()).collect();
        all.sort_by_key(|(method, _)| order.iter().position(|name| *name == method.name()));
    }
    if arguments.methods.is_empty() {
        return Ok(all);
    }
    let mut names: Vec<&str> = all.iter().map(|(method, _)| method.name()).collect();
    names.dedup();
    if let Some(unknown) = arguments.methods.iter().find(|name| !names.contains(&name.as_str())) {
        let names = names.join(", ");
        return Err(usage(format!("--methods: there is no method {unknown:?}"), format!("they are {names}")));
    }
    all.retain(|(method, _)| arguments.methods.iter().any(|name| name == method.name()));
    Ok(all)
}

fn compare(
    chosen: &[Chosen],
    gaits: &[&Gait],
    emotions: &[Emotion],
    plan: &Plan,
    fold_count: usize,
) -> Result<Vec<Row>, Error> {
    let progress = Mutex::new(Progress::new("comparing"));
    let done = AtomicUsize::new(0);
    let all = chosen.len() * plan.seeds.len() * fold_count;
    let mut rows = Vec::new();
    for (method, settings) in chosen {
        let after_fold = || {
            let share = ratio(done.fetch_add(1, Ordering::Relaxed) + 1, all);
            progress.lock().unwrap_or_else(PoisonError::into_inner).at(method.name(), share);
        };
        let found = evaluate_with(method.as_ref(), gaits, emotions, plan, &after_fold)?;
        rows.push(row(found, settings.clone()));
    }
    Ok(rows)
}

fn row(found: Evaluation, settings: Option<String>) -> Row {
    let published =
        PUBLISHED.iter().find(|(name, _)| *name == found.method).map(|(_, percent)| percent / 100.0);
    Row {
        settings,
        published,
        accuracy_mean: found.accuracy_mean,
        accuracy_sd: found.accuracy_sd,
        accuracy_interval: wilson(found.accuracy_mean, found.gaits),
        accuracies: found.accuracies,
        recall: Emotion::ALL.map(|emotion| (emotion.name(), found.recall[emotion.index()])).into(),
        confusion: found.confusion,
        by_dataset: found.by_dataset,
        method: found.method,
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
fn ratio(part: usize, whole: usize) -> f64 {
    part as f64 / whole.max(1) as f64
}

/// Wilson's 95 % interval of a share of `count`.
fn wilson(share: f64, count: usize) -> [f64; 2] {
    let z = 1.959_964_f64;
    let n = ratio(count.max(1), 1);
    let middle = (share + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt();
    // rounding must not leave the share itself outside
    [(middle - half).clamp(0.0, share), (middle + half).clamp(share, 1.0)]
}

fn show(report: &Report, grouping: Grouping) -> Result<(), Error> {
    let percent = |share: f64| format!("{:.1}", share * 100.0);
    let words = |row: &Row| {
        let name = match &row.settings {
            None => row.method.clone(),
            Some(settings) => format!("  {settings}"),
        };
        let [low, high] = row.accuracy_interval;
        let mut words = vec![
            name,
            row.published.map_or("-".to_owned(), |share| format!("{:.2}", share * 100.0)),
            percent(row.accuracy_mean),
            if row.accuracies.len() > 1 { percent(row.accuracy_sd) } else { "-".to_owned() },
            format!("{} to {}", percent(low), percent(high)),
        ];
        words.extend(
            Emotion::ALL.map(|emotion| percent(row.recall.get(emotion.name()).copied().unwrap_or(0.0))),
        );
        words
    };
    let rows: Vec<Vec<String>> = report.methods.iter().map(words).collect();
    table(&["method", "paper", "accuracy", "sd", "95 %", "happy", "angry", "sad", "neutral"], &rows);
    let counts = Emotion::ALL
        .map(|emotion| format!("{} {emotion}", report.of_emotion.get(emotion.name()).copied().unwrap_or(0)));
    say(&format!("gaits      {} ({})", report.gaits, counts.join(", ")));
    let (first, last) =
        (report.seeds.first().copied().unwrap_or(0), report.seeds.last().copied().unwrap_or(0));
    say(&format!("folds      {}; seeds {first} to {last}", grouping.describe()));
    say(
        "percent; paper: as printed, on its own gaits and folds; sd: over repeats; 95 %: for as many other gaits;",
    );
    say("happy to neutral: share of each emotion's gaits that were recognised");
    if report.methods.iter().any(|row| row.method == perceiver::NAME) {
        say(&format!("{} is ours; the others but affective-svm are reconstructions", perceiver::NAME));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
    Ok(())
}

/// The gaits of a library, a motion file, or the motion files of a folder; the best stride of each take. What is left out
/// is told with the reason.
fn load(path: &Path, left_out: &mut Vec<String>) -> Result<Vec<Gait>, Error> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb")) {
        return Ok(library(Some(path))?.gaits().to_vec());
    }
    let files = if path.is_dir() { files_in(path)? } else { vec![path.to_owned()] };
    if files.is_empty() {
        return Err(usage(
            format!("--data {}: there is no motion file in it", path.display()),
            format!("files that end in {} are read", ENDINGS.join(", ")),
        ));
    }
    let is_alone = files.len() == 1;
    let options = import::Options::default();
    let found: Vec<_> = files.par_iter().map(|file| import::import_file_with(file, &options)).collect();
    let mut names = HashSet::new();
    let mut gaits = Vec::new();
    for (file, found) in files.iter().zip(found) {
        let file = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let takes = match found {
            Ok(takes) => takes,
            Err(error) if is_alone => return Err(error.into()),
            Err(error) => {
                left_out.push(error.to_string());
                continue;
            }
        };
        let (new, known): (Vec<_>, Vec<_>) =
            takes.into_iter().partition(|take| names.insert(take.name.clone()));
        if !known.is_empty() {
            left_out.push(format!("{file}: {} takes of names that came before", known.len()));
        }
        let strides: Vec<_> = new.par_iter().map(stride::best).collect();
        for stride in strides {
            match stride {
                Ok(gait) => gaits.push(gait),
                Err(error) => left_out.push(format!("{file}: {error}")),
            }
        }
    }
    Ok(gaits)
}

/// The motion files of a folder, by name.
fn files_in(folder: &Path) -> Result<Vec<PathBuf>, Error> {
    let wrong = |source| crate::gait::Error::Read { path: folder.to_owned(), source };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(wrong)? {
        let path = entry.map_err(wrong)?.path();
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        let is_motion = ending.is_some_and(|ending| ENDINGS.contains(&ending.as_str()));
        // the index of the others
        let is_index = path.file_name().is_some_and(|name| {
            ["gaits.csv", "labels.csv", "trials.csv", "NOTICE.txt", "README.txt"]
                .iter()
                .any(|known| name == *known)
        });
        let is_licence = path.file_stem().is_some_and(|stem| stem.to_string_lossy().starts_with("LICEN"));
        if is_motion && !is_index && !is_licence && path.is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilsons_interval_is_that_of_the_textbook() {
        // 10 of 20: 0.299 to 0.701
        let [low, high] = wilson(0.5, 20);
        assert!((low - 0.2993).abs() < 1e-4 && (high - 0.7007).abs() < 1e-4, "{low} {high}");
        assert!(wilson(1.0, 10)[1] <= 1.0 && wilson(0.0, 10)[0] >= 0.0);
    }
}
