//! `gaitway gait predict`: the emotion that people would see in a gait (S-17).

use super::super::failed;
use super::super::output::{note, say, say_json, table};
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::perception::model::{Model, Prediction};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `gaitway gait predict`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait predict walk1.bvh walk2.bvh\n  gaitway gait predict captures/ --model \
                  model.json --json\n\nThe emotion is the most probable one; the margin is how much more probable it is than the \
                  next. A gait is called unlike when it is farther from the gaits that the model learned from than these are \
                  from one another (novelty above 1): then it gets no emotion. Without a model: the built-in one, \
                  phase-perceiver trained on E-Gait's 232 gaits of 92 people; assets/models/README.md says how far to \
                  trust it."
)]
pub(super) struct Arguments {
    /// Motion files, folders of them, gait libraries (.glb)
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// A model of `gaitway gait train` [default: the built-in one, trained on people]
    #[arg(long, value_name = "MODEL.json")]
    model: Option<PathBuf>,
    /// Predict an emotion even for gaits unlike those that the model has seen
    #[arg(long)]
    even_unlike: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Row {
    file: PathBuf,
    name: String,
    /// The most probable emotion; none of a gait unlike those that the model has seen.
    emotion: Option<Emotion>,
    probabilities: [f64; 4],
    margin: f64,
    /// Distance to the training gaits; above 1 is unlike them. Null: infinite, or unknown to the model.
    novelty: Option<f64>,
    is_unlike: bool,
    /// The label that the gait came with.
    label: Option<Emotion>,
}

#[derive(Debug, Serialize)]
struct Report {
    model: String,
    emotions: [Emotion; 4],
    gaits: Vec<Row>,
    /// Gaits unlike those that the model has seen.
    unlike: usize,
    wall_seconds: f64,
}

/// The model of a file, or the built-in one; and what to call it.
pub(in crate::cli) fn model_or_default(path: Option<&Path>) -> Result<(Model, String), Error> {
    match path {
        Some(path) => Ok((Model::load(path)?, path.display().to_string())),
        None => Ok((Model::built_in()?, "built in".to_owned())),
    }
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let (model, name) = model_or_default(arguments.model.as_deref())?;
    let found = sources::read(&arguments.files, model.preparation())?;
    if found.gaits.is_empty() {
        return Err(failed("there is no gait in these files", "see above what was left out and why"));
    }
    let gaits: Vec<&Gait> = found.gaits.iter().map(|(_, gait)| gait).collect();
    let predictions = model.predict_all(&gaits);
    let rows: Vec<Row> = found
        .gaits
        .iter()
        .zip(predictions)
        .map(|((file, gait), prediction)| row(file, gait, &prediction, arguments.even_unlike))
        .collect();
    let report = Report {
        model: format!("{name}: {}", model.describe()),
        emotions: Emotion::ALL,
        unlike: rows.iter().filter(|row| row.is_unlike).count(),
        gaits: rows,
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
        remarks(&report, &model, &gaits);
    }
    Ok(found.is_complete)
}

fn row(file: &Path, gait: &Gait, prediction: &Prediction, even_unlike: bool) -> Row {
    let Prediction { emotion, probabilities, margin, novelty } = *prediction;
    let is_unlike = prediction.is_unlike();
    Row {
        file: file.to_owned(),
        name: gait.name.clone(),
        emotion: (even_unlike || !is_unlike).then_some(emotion),
        probabilities,
        margin,
        novelty: novelty.filter(|novelty| novelty.is_finite()),
        is_unlike,
        label: gait.label,
    }
}

fn print(report: &Report) {
    let words: Vec<Vec<String>> = report
        .gaits
        .iter()
        .map(|row| {
            let mut words = vec![row.name.clone(), row.emotion.map_or("unlike", Emotion::name).to_owned()];
            let told = |text: String| if row.emotion.is_some() { text } else { "-".to_owned() };
            words.extend(row.probabilities.map(|p| told(format!("{:.1}", p * 100.0))));
            words.push(told(format!("{:.2}", row.margin)));
            words.push(row.novelty.map_or("-".to_owned(), |novelty| format!("{novelty:.2}")));
            words.push(row.label.map_or("-", Emotion::name).to_owned());
            words
        })
        .collect();
    table(
        &["name", "seen as", "happy %", "angry %", "sad %", "neutral %", "margin", "novelty", "label"],
        &words,
    );
    say(&format!("model      {}", report.model));
    let judged = report.gaits.iter().filter_map(|row| Some((row.emotion?, row.label?)));
    let judged: Vec<(Emotion, Emotion)> = judged.collect();
    if !judged.is_empty() {
        let right = judged.iter().filter(|(seen, label)| seen == label).count();
        say(&format!("agreement  {right} of {} labels that the gaits came with", judged.len()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
}

/// What the reader must know about these answers, on standard error.
fn remarks(report: &Report, model: &Model, gaits: &[&Gait]) {
    let silent = report.gaits.iter().filter(|row| row.emotion.is_none()).count();
    if silent > 0 {
        note(&format!(
            "note: {silent} of {} gaits are unlike what the model has seen (novelty above 1) and get no emotion. \
             --even-unlike gives them the most probable one",
            report.gaits.len()
        ));
    }
    if !model.knows_novelty() {
        note("note: this model does not know what is unlike its training gaits; train it again to find out");
    }
    let known = &model.trained_on().datasets;
    if gaits.iter().any(|gait| gait.label.is_some() && known.contains(&gait.provenance.dataset)) {
        note(
            "note: the model learned from data sets of these names; agreement with gaits that it learned from proves nothing",
        );
    }
}
