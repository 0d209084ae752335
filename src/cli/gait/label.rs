//! `gaitway gait label`: a library grown by unrated gaits, whose labels are marked as predicted (S-17).

use super::super::output::{say, say_json, table};
use super::super::scene::library;
use super::super::{failed, usage};
use super::predict::model_or_default;
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::{Gait, LabelOrigin};
use crate::library::GaitLibrary;
use crate::perception::model::Model;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `gaitway gait label`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait label walk1.bvh walk2.bvh --library mine.glb --out grown.glb\n  gaitway gait label \
                  captures/ --library mine.glb --model model.json --least-probability 0.6 --out grown.glb\n\nA gait that comes with \
                  a label from people keeps it, unless --relabel is given. Gaits unlike those that the model has seen are left out, unless \
                  --even-unlike is given; `gaitway gait predict` shows how far off they are."
)]
pub(super) struct Arguments {
    /// Motion files, folders of them, gait libraries (.glb)
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The library to add to [default: the built-in one]
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// The library to write
    #[arg(long, value_name = "NEW.glb")]
    out: PathBuf,
    /// A model of `gaitway gait train` [default: the built-in one, trained on people]
    #[arg(long, value_name = "MODEL.json")]
    model: Option<PathBuf>,
    /// Leave out gaits whose emotion is less probable than this, 0 to 1
    #[arg(long, value_name = "P", default_value_t = 0.0)]
    least_probability: f64,
    /// Label even gaits unlike those that the model has seen
    #[arg(long)]
    even_unlike: bool,
    /// Predict also for gaits that come with a label
    #[arg(long)]
    relabel: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Row {
    name: String,
    label: Option<Emotion>,
    origin: Option<&'static str>,
    probability: Option<f64>,
    margin: Option<f64>,
    novelty: Option<f64>,
    #[serde(flatten)]
    fate: Fate,
}

/// What became of a gait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
struct Fate {
    added: bool,
    /// Left out, being unlike what the model has seen.
    is_unlike: bool,
    /// Left out, its emotion being too improbable.
    is_improbable: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    model: String,
    gaits: Vec<Row>,
    counts: [usize; 4],
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    if !(0.0..=1.0).contains(&arguments.least_probability) {
        let found = arguments.least_probability;
        return Err(usage(format!("--least-probability {found}: must be 0 to 1"), "such as 0.6"));
    }
    let (model, name) = model_or_default(arguments.model.as_deref())?;
    let mut gaits = library(arguments.library.as_deref())?.gaits().to_vec();
    let found = sources::read(&arguments.files, model.preparation())?;
    let mut rows = Vec::new();
    for (_, mut gait) in found.gaits {
        let row = labelled(&mut gait, &model, arguments);
        if row.fate.added {
            gaits.push(gait);
        }
        rows.push(row);
    }
    if !rows.iter().any(|row| row.fate.added) {
        let count = |fate: fn(&Fate) -> bool| rows.iter().filter(|row| fate(&row.fate)).count();
        let (unlike, improbable) = (count(|fate| fate.is_unlike), count(|fate| fate.is_improbable));
        return Err(failed(
            format!(
                "there is no gait to add: {unlike} unlike what the model has seen, {improbable} with too improbable an emotion"
            ),
            "--even-unlike and a lower --least-probability let them in; see above what else was left out",
        ));
    }
    let grown = GaitLibrary::from_gaits(gaits)?;
    grown.save_glb(&arguments.out)?;
    let report = Report {
        model: format!("{name}: {}", model.describe()),
        gaits: rows,
        counts: grown.counts(),
        files: vec![arguments.out.clone()],
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(found.is_complete)
}

/// Labels a gait by the model, unless people have.
fn labelled(gait: &mut Gait, model: &Model, arguments: &Arguments) -> Row {
    let mut row = Row {
        name: gait.name.clone(),
        label: gait.label,
        origin: None,
        probability: None,
        margin: None,
        novelty: None,
        fate: Fate { added: true, is_unlike: false, is_improbable: false },
    };
    if gait.label.is_none() || arguments.relabel {
        let prediction = model.predict(gait);
        let (p, margin) = (prediction.probabilities[prediction.emotion.index()], prediction.margin);
        (row.probability, row.margin, row.novelty) = (Some(p), Some(margin), prediction.novelty);
        let is_unlike = prediction.is_unlike() && !arguments.even_unlike;
        let is_improbable = !is_unlike && p < arguments.least_probability;
        row.fate = Fate { added: !is_unlike && !is_improbable, is_unlike, is_improbable };
        row.label = (!is_unlike).then_some(prediction.emotion);
        gait.set_predicted(prediction.emotion, &format!("{} (p {p:.2}, margin {margin:.2})", model.method()));
    }
    row.origin = row.label.and(gait.provenance.label_origin).map(LabelOrigin::name);
    row
}

fn print(report: &Report) {
    let words: Vec<Vec<String>> = report
        .gaits
        .iter()
        .map(|row| {
            vec![
                row.name.clone(),
                row.label.map_or("-", Emotion::name).to_owned(),
                row.origin.unwrap_or("-").to_owned(),
                row.probability.map_or("-".to_owned(), |p| format!("{:.1}", p * 100.0)),
                row.margin.map_or("-".to_owned(), |margin| format!("{margin:.2}")),
                row.novelty.map_or("-".to_owned(), |novelty| format!("{novelty:.2}")),
                match row.fate {
                    Fate { added: true, .. } => "added",
                    Fate { is_unlike: true, .. } => "left out: unlike what the model has seen",
                    Fate { .. } => "left out: too improbable",
                }
                .to_owned(),
            ]
        })
        .collect();
    table(&["name", "label", "by", "p %", "margin", "novelty", ""], &words);
    say(&format!("model      {}", report.model));
    let counts = Emotion::ALL.map(|emotion| format!("{emotion} {}", report.counts[emotion.index()]));
    say(&format!("library    {}", counts.join(", ")));
    for file in &report.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
}
