//! `gaitway gait compare`: how well the methods agree with people, on the same gaits and folds, beside the paper's table.

use super::super::output::{note, say, say_json, table};
use super::super::progress::Progress;
use super::super::{failed, usage};
use super::figures_of_folds::{self, Found};
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::perception::comparison::{PUBLISHED, methods, variants};
use crate::perception::evaluate::{Evaluation, Grouping, Plan, evaluate_with, folds};
use crate::perception::{Method, perceiver};
use crate::spelling::suggestion;
use crate::statistics::share_interval;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Arguments of `gaitway gait compare`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait compare --data egait/ --folds subject --repeats 10\n  gaitway gait compare \
                  --data mine.glb --json\n\nThe gaits need labels: in the library, or in a gaits.csv beside the motion files \
                  (columns key, subject, perceived_label). Of takes of one name the first is kept. \
                  affective-svm answers by its decision, as in the paper; a model of `gaitway gait train` tells its most \
                  probable emotion, which can differ."
)]
pub(super) struct Arguments {
    /// Folder of motion files, motion file, or gait library (.glb), with labels
    #[arg(long, value_name = "DIR|LIB")]
    data: PathBuf,
    /// Take E-Gait's gaits as they were published: pitched, without travel (to compare with others' figures)
    #[arg(long)]
    as_published: bool,
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
    /// Folder for figures of the accuracies and confusions (SVG and PNG)
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
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
    /// Gaits that were left out because they have no label.
    unlabelled: usize,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let chosen = choose(arguments)?;
    let found =
        sources::read(std::slice::from_ref(&arguments.data), sources::preparation(arguments.as_published))?;
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        found.gaits.iter().filter_map(|(_, gait)| Some((gait, gait.label?))).unzip();
    let unlabelled = found.gaits.len() - gaits.len();
    if unlabelled > 0 {
        note(&format!("left out: {unlabelled} of {} gaits, which have no label", found.gaits.len()));
    }
    if gaits.is_empty() {
        let data = arguments.data.display();
        return Err(failed(
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
    let files = match &arguments.figures {
        Some(folder) => draw(folder, &rows, gaits.len(), grouping)?,
        None => Vec::new(),
    };
    let report = Report {
        methods: rows,
        files,
        folds: arguments.folds,
        fold_count,
        seeds,
        gaits: gaits.len(),
        of_emotion: of_emotion.into(),
        unlabelled,
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json { say_json(&report) } else { show(&report, grouping) }?;
    Ok(found.is_complete)
}

/// The figures of the methods as they are by default.
fn draw(folder: &Path, rows: &[Row], gaits: usize, grouping: Grouping) -> Result<Vec<PathBuf>, Error> {
    let found: Vec<Found<'_>> = rows
        .iter()
        .filter(|row| row.settings.is_none())
        .map(|row| Found {
            method: &row.method,
            published: row.published,
            accuracy: row.accuracy_mean,
            interval: Some(row.accuracy_interval),
            recall: Emotion::ALL.map(|emotion| row.recall.get(emotion.name()).copied().unwrap_or(0.0)),
            confusion: &row.confusion,
        })
        .collect();
    figures_of_folds::write(folder, &found, &format!("{gaits} gaits, {}", grouping.describe()))
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
        let hint = suggestion(unknown, &names, "they are");
        return Err(usage(format!("--methods: there is no method {unknown:?}"), hint));
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
        accuracy_interval: share_interval(found.accuracy_mean, found.gaits as u64),
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
    for file in &report.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
    Ok(())
}
