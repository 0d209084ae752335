//! `gaitway gait train`: a model from labelled gaits, and how well such a model agrees with people.

use super::super::output::{note, say, say_json, table};
use super::super::progress::Progress;
use super::super::{failed, usage};
use super::figures_of_folds::{self, Found};
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::perception::Method as _;
use crate::perception::affective_svm::AffectiveSvm;
use crate::perception::evaluate::{Evaluation, Grouping, Plan, evaluate_with};
use crate::perception::features::Variant;
use crate::perception::model::{HeldOut, Preparation};
use crate::perception::perceiver::PhasePerceiver;
use crate::perception::svm::{Gamma, Grid, Kernel, Scheme, Settings, Svm};
use crate::perception::trainer::Trainer;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Arguments of `gaitway gait train`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait train --data egait/ --out model.json\n  gaitway gait train --data mine.glb --method \
                  affective-svm --c 10 --folds subject --repeats 10 --out model.json\n\nThe gaits need labels: in the library, or in a \
                  table labels.csv, gaits.csv or trials.csv beside the motion files (columns file or key, subject, label). The \
                  model learns from all of them; the accuracy is that of models that did not see the gaits they were asked \
                  about. It remembers how the gaits were prepared, and what is unlike them."
)]
pub(super) struct Arguments {
    /// Folder of motion files, motion file, or gait library (.glb), with labels
    #[arg(long, value_name = "DIR|LIB", required = true)]
    data: Vec<PathBuf>,
    /// Take E-Gait's gaits as they were published: pitched, without travel (to compare with others' figures)
    #[arg(long)]
    as_published: bool,
    /// The model to write
    #[arg(long, value_name = "MODEL.json")]
    out: PathBuf,
    /// What learns [default: phase-perceiver; affective-svm where one of its settings is given]
    #[arg(long, value_enum)]
    method: Option<MethodName>,
    /// Reading of the 29 features: corrected, paper or step-code [affective-svm; default: corrected]
    #[arg(long)]
    variant: Option<Variant>,
    /// One-versus-one with votes (libsvm, the likely original) or one-versus-rest [affective-svm; default: ovr]
    #[arg(long, value_enum)]
    scheme: Option<SchemeName>,
    /// C of the machine [affective-svm; default: 1]
    #[arg(long)]
    c: Option<f64>,
    /// Gamma of the RBF kernel: auto (1/29), scale (1 / (29 variance)) or a number [affective-svm; default: scale]
    #[arg(long, value_parser = parse_gamma)]
    gamma: Option<Gamma>,
    /// Search C and gamma on inner folds [affective-svm]
    #[arg(long)]
    search: bool,
    /// Let each emotion count alike, however many of the gaits have it [affective-svm]
    #[arg(long)]
    balanced: bool,
    /// What is held out together to find the accuracy
    #[arg(long, value_enum, default_value_t)]
    folds: FoldsName,
    /// Number of folds, for stratified and subject
    #[arg(long, value_name = "K", default_value_t = 10, value_parser = clap::value_parser!(u16).range(2..=1000))]
    k: u16,
    /// Repeats, each with folds of its own
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    repeats: u16,
    /// Seed of the first repeat; the others follow it
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Folder for figures of the accuracy and confusion (SVG and PNG)
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    /// Ours: curves over phase, logistic regression
    PhasePerceiver,
    /// The paper's: 29 features, support vector machine
    AffectiveSvm,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum SchemeName {
    Ovo,
    Ovr,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum FoldsName {
    /// The same share of each emotion, people mixed
    Stratified,
    /// No person in two folds
    #[default]
    Subject,
    /// One data set each
    Dataset,
    /// Do not find the accuracy
    None,
}

fn parse_gamma(text: &str) -> Result<Gamma, String> {
    match text {
        "auto" => Ok(Gamma::Auto),
        "scale" => Ok(Gamma::Scale),
        number => match number.parse() {
            Ok(gamma) if gamma > 0.0 && f64::is_finite(gamma) => Ok(Gamma::Value(gamma)),
            _ => Err("use auto, scale or a number above 0".to_owned()),
        },
    }
}

#[derive(Debug, Serialize)]
struct Report {
    method: &'static str,
    /// Its settings as given.
    description: String,
    gaits: usize,
    counts: [usize; 4],
    people: usize,
    datasets: Vec<String>,
    /// Of affective-svm.
    support_vectors: Option<usize>,
    /// As they were found.
    settings: String,
    preparation: Preparation,
    evaluation: Option<Evaluation>,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let method = method(arguments)?;
    let preparation = sources::preparation(arguments.as_published);
    let found = sources::read(&arguments.data, preparation)?;
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        found.gaits.iter().filter_map(|(_, gait)| gait.label.map(|label| (gait, label))).unzip();
    if gaits.len() < found.gaits.len() {
        note(&format!("note: {} gaits without a label are left out", found.gaits.len() - gaits.len()));
    }
    if gaits.is_empty() {
        return Err(failed(
            "there is no gait with a label",
            "labels come from a library or from a table labels.csv beside the motion files (columns file, subject, label)",
        ));
    }
    let model = method.model(&gaits, &emotions, arguments.seed)?;
    let evaluation = evaluate(arguments, &method, &gaits, &emotions)?;
    let held_out = evaluation.as_ref().map(|found| HeldOut {
        accuracy: found.accuracy_mean,
        folds: found.grouping.describe(),
        repeats: found.seeds.len(),
    });
    let model = model.with(preparation, held_out);
    model.save(&arguments.out)?;
    let mut files = vec![arguments.out.clone()];
    if let (Some(folder), Some(found)) = (&arguments.figures, &evaluation) {
        let one = Found {
            method: &found.method,
            published: None,
            accuracy: found.accuracy_mean,
            interval: None,
            recall: found.recall,
            confusion: &found.confusion,
        };
        let note = format!("{} gaits, {}", gaits.len(), found.grouping.describe());
        files.extend(figures_of_folds::write(folder, &[one], &note)?);
    }
    let on = model.trained_on();
    let report = Report {
        method: method.name(),
        description: method.describe(),
        gaits: gaits.len(),
        counts: on.counts,
        people: on.people,
        datasets: on.datasets.clone(),
        support_vectors: model.svm().map(Svm::support_count),
        settings: on.settings.clone(),
        preparation,
        evaluation,
        files,
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(found.is_complete)
}

/// The chosen method. A setting of the machine chooses the machine.
fn method(arguments: &Arguments) -> Result<Trainer, Error> {
    let Arguments { variant, scheme, c, gamma, search, balanced, .. } = arguments;
    let given = [
        ("--variant", variant.is_some()),
        ("--scheme", scheme.is_some()),
        ("--c", c.is_some()),
        ("--gamma", gamma.is_some()),
        ("--search", *search),
        ("--balanced", *balanced),
    ];
    let setting = given.into_iter().find_map(|(name, is_given)| is_given.then_some(name));
    match (arguments.method, setting) {
        (Some(MethodName::PhasePerceiver), Some(setting)) => Err(usage(
            format!("{setting} is a setting of affective-svm, not of phase-perceiver"),
            format!("leave {setting} out, or say --method affective-svm"),
        )),
        (Some(MethodName::PhasePerceiver), None) | (None, None) => {
            Ok(Trainer::PhasePerceiver(PhasePerceiver::default()))
        }
        (Some(MethodName::AffectiveSvm), _) | (None, Some(_)) => {
            let fallback = AffectiveSvm::default();
            let settings = Settings {
                c: c.unwrap_or(fallback.settings.c),
                kernel: gamma.map_or(fallback.settings.kernel, Kernel::Rbf),
                scheme: match scheme {
                    None => fallback.settings.scheme,
                    Some(SchemeName::Ovo) => Scheme::OneVersusOne,
                    Some(SchemeName::Ovr) => Scheme::OneVersusRest,
                },
                is_balanced: *balanced,
                ..fallback.settings
            };
            let grid = search.then(Grid::default);
            let variant = variant.unwrap_or(fallback.variant);
            Ok(Trainer::AffectiveSvm(AffectiveSvm { variant, settings, grid, scaling: None }))
        }
    }
}

/// Agreement of the method with people on held-out gaits; none, with a note, if there are too few to hold out.
fn evaluate(
    arguments: &Arguments,
    method: &Trainer,
    gaits: &[&Gait],
    emotions: &[Emotion],
) -> Result<Option<Evaluation>, Error> {
    let folds = usize::from(arguments.k);
    let grouping = match arguments.folds {
        FoldsName::None => return Ok(None),
        FoldsName::Stratified => Grouping::Stratified { folds },
        FoldsName::Subject => Grouping::Subject { folds },
        FoldsName::Dataset => Grouping::Dataset,
    };
    let seeds = (0..arguments.repeats).map(|repeat| arguments.seed.wrapping_add(u64::from(repeat))).collect();
    let plan = Plan { grouping, seeds };
    let progress = Mutex::new((Progress::new("cross-validation"), 0.0));
    let all = f64::from(arguments.repeats) * f64::from(arguments.k);
    let found = evaluate_with(method, gaits, emotions, &plan, &|| {
        let mut progress = progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.1 += 1.0;
        let share = progress.1 / all;
        progress.0.at("", share.min(1.0));
    });
    match found {
        Ok(evaluation) => Ok(Some(evaluation)),
        Err(error @ crate::perception::Error::Evaluation { .. }) => {
            note(&format!("note: {error}; the model is written without an accuracy"));
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

fn print(report: &Report) {
    say(&format!("method     {}: {}", report.method, report.description));
    let counts = Emotion::ALL.map(|emotion| format!("{emotion} {}", report.counts[emotion.index()]));
    say(&format!(
        "gaits      {} ({}) of {} people in {}",
        report.gaits,
        counts.join(", "),
        report.people,
        report.datasets.join(", ")
    ));
    let vectors = report.support_vectors.map_or(String::new(), |count| format!(", {count} support vectors"));
    say(&format!("settings   {}{vectors}", report.settings));
    if let Some(found) = &report.evaluation {
        print_evaluation(found);
    }
    for file in &report.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
}

/// Accuracy, recall, confusion, data sets.
fn print_evaluation(found: &Evaluation) {
    let percent = |share: f64| format!("{:.1}", share * 100.0);
    let seeds: Vec<String> = found.seeds.iter().map(u64::to_string).collect();
    say(&format!(
        "accuracy   {} +- {} % ({}, {} repeats, seeds {})",
        percent(found.accuracy_mean),
        percent(found.accuracy_sd),
        found.grouping.describe(),
        found.seeds.len(),
        seeds.join(" ")
    ));
    let rows: Vec<Vec<String>> = Emotion::ALL
        .into_iter()
        .map(|emotion| {
            let row = found.confusion[emotion.index()];
            let mut words = vec![emotion.name().to_owned(), percent(found.recall[emotion.index()])];
            words.extend(row.map(|count| count.to_string()));
            words
        })
        .collect();
    table(&["people see", "recall %", "as happy", "angry", "sad", "neutral"], &rows);
    let sets: Vec<String> =
        found.by_dataset.iter().map(|(name, accuracy)| format!("{name} {} %", percent(*accuracy))).collect();
    say(&format!("data sets  {}", sets.join(", ")));
}
