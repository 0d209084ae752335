//! `gaitway gait predict`: the emotion that people would see in a gait (S-17).

use super::super::failed;
use super::super::output::{note, say, say_json, table};
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::library::GaitLibrary;
use crate::perception::affective_svm::AffectiveSvm;
use crate::perception::model::{Model, Prediction};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `gaitway gait predict`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait predict walk1.bvh walk2.bvh\n  gaitway gait predict captures/ --model \
                  model.json --json\n\nThe margin is the distance to the nearest other emotion as a decision value: beyond 1 clear, \
                  below 0 the votes disagree. Without a model: one trained on the built-in walkers, which are generated and not \
                  rated by anyone; train your own with `gaitway gait train`."
)]
pub(super) struct Arguments {
    /// Motion files, folders of them, gait libraries (.glb)
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// A model of `gaitway gait train` [default: trained on the built-in walkers]
    #[arg(long, value_name = "MODEL.json")]
    model: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Row {
    file: PathBuf,
    name: String,
    #[serde(flatten)]
    prediction: Prediction,
    /// The label that the gait came with.
    label: Option<Emotion>,
}

#[derive(Debug, Serialize)]
struct Report {
    model: String,
    emotions: [Emotion; 4],
    gaits: Vec<Row>,
    wall_seconds: f64,
}

/// The model of a file, or the default one; and words for it.
pub(super) fn model_or_default(path: Option<&Path>) -> Result<(Model, String), Error> {
    if let Some(path) = path {
        let model = Model::load(path)?;
        let on = model.trained_on();
        let words = format!(
            "{}: affective-svm, {} features, {}, trained on {} gaits of {}",
            path.display(),
            model.variant().name(),
            on.settings,
            on.counts.iter().sum::<usize>(),
            on.datasets.join(", ")
        );
        return Ok((model, words));
    }
    let library = GaitLibrary::built_in()?;
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        library.gaits().iter().filter_map(|gait| gait.label.map(|label| (gait, label))).unzip();
    let model = AffectiveSvm::default().model(&gaits, &emotions, 0)?;
    let words =
        format!("affective-svm, trained on the {} built-in walkers (generated, not rated)", gaits.len());
    Ok((model, words))
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let (model, words) = model_or_default(arguments.model.as_deref())?;
    let found = sources::read(&arguments.files, false)?;
    if found.gaits.is_empty() {
        return Err(failed("there is no gait in these files", "see above what was left out and why"));
    }
    let gaits: Vec<&Gait> = found.gaits.iter().map(|(_, gait)| gait).collect();
    let predictions = model.predict_all(&gaits);
    let rows = found.gaits.iter().zip(predictions).map(|((file, gait), prediction)| Row {
        file: file.clone(),
        name: gait.name.clone(),
        prediction,
        label: gait.label,
    });
    let report = Report {
        model: words,
        emotions: Emotion::ALL,
        gaits: rows.collect(),
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(found.is_complete)
}

fn print(report: &Report) {
    let labelled: Vec<&Row> = report.gaits.iter().filter(|row| row.label.is_some()).collect();
    let words: Vec<Vec<String>> = report
        .gaits
        .iter()
        .map(|row| {
            let Prediction { emotion, probabilities, margin } = row.prediction;
            let mut words = vec![row.name.clone(), emotion.name().to_owned()];
            words.extend(probabilities.map(|p| format!("{:.1}", p * 100.0)));
            words.push(format!("{margin:+.2}"));
            words.push(row.label.map_or("-", Emotion::name).to_owned());
            words
        })
        .collect();
    table(&["name", "seen as", "happy %", "angry %", "sad %", "neutral %", "margin", "label"], &words);
    say(&format!("model      {}", report.model));
    if !labelled.is_empty() {
        let right = labelled.iter().filter(|row| row.label == Some(row.prediction.emotion)).count();
        say(&format!("agreement  {right} of {} labels that the gaits came with", labelled.len()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
    if report.gaits.iter().any(|row| row.prediction.margin < 0.0) {
        note("note: where the margin is below 0 the pairwise votes disagree; do not rely on the emotion");
    }
}
