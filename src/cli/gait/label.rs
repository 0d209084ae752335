//! `gaitway gait label`: a library grown by gaits that nobody rated, marked as predicted (S-17).

use super::super::output::{note, say, say_json, table};
use super::super::scene::library;
use super::super::{failed, usage};
use super::predict::model_or_default;
use super::sources;
use crate::Error;
use crate::emotion::Emotion;
use crate::gait::Gait;
use crate::library::GaitLibrary;
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Arguments of `gaitway gait label`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait label walk1.bvh walk2.bvh --library mine.glb --out grown.glb\n  gaitway gait label \
                  captures/ --library mine.glb --model model.json --least-probability 0.6 --out grown.glb\n\nA gait that comes with \
                  a label from people keeps it, unless --relabel is given."
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
    /// A model of `gaitway gait train` [default: trained on the built-in walkers]
    #[arg(long, value_name = "MODEL.json")]
    model: Option<PathBuf>,
    /// Leave out gaits whose emotion is less probable than this, 0 to 1
    #[arg(long, value_name = "P", default_value_t = 0.0)]
    least_probability: f64,
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
    added: bool,
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
    let (model, words) = model_or_default(arguments.model.as_deref())?;
    let mut gaits = library(arguments.library.as_deref())?.gaits().to_vec();
    let found = sources::read(&arguments.files, false)?;
    let mut rows = Vec::new();
    for (_, mut gait) in found.gaits {
        let row = labelled(&mut gait, &model, &words, arguments);
        if row.added {
            gaits.push(gait);
        }
        rows.push(row);
    }
    if !rows.iter().any(|row| row.added) {
        return Err(failed(
            "there is no gait to add",
            "see above what was left out, or lower --least-probability",
        ));
    }
    let grown = GaitLibrary::from_gaits(gaits)?;
    grown.save_glb(&arguments.out)?;
    let report = Report {
        model: words,
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
fn labelled(
    gait: &mut Gait,
    model: &crate::perception::model::Model,
    words: &str,
    arguments: &Arguments,
) -> Row {
    let (mut probability, mut margin, mut added) = (None, None, true);
    if gait.label.is_none() || arguments.relabel {
        let prediction = model.predict(gait);
        let p = prediction.probabilities[prediction.emotion.index()];
        (probability, margin) = (Some(p), Some(prediction.margin));
        added = p >= arguments.least_probability;
        let by = words.split([',', ':']).next().unwrap_or("a model");
        gait.set_predicted(prediction.emotion, &format!("{by} (p {p:.2}, margin {:.2})", prediction.margin));
    }
    let origin = gait.label_origin().map(crate::gait::LabelOrigin::name);
    Row { name: gait.name.clone(), label: gait.label, origin, probability, margin, added }
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
                row.margin.map_or("-".to_owned(), |margin| format!("{margin:+.2}")),
                if row.added { "added" } else { "left out: too improbable" }.to_owned(),
            ]
        })
        .collect();
    table(&["name", "label", "by", "p %", "margin", ""], &words);
    say(&format!("model      {}", report.model));
    let counts = Emotion::ALL.map(|emotion| format!("{emotion} {}", report.counts[emotion.index()]));
    say(&format!("library    {}", counts.join(", ")));
    for file in &report.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", report.wall_seconds));
    let doubtful = report.gaits.iter().filter(|row| row.added && row.margin.is_some_and(|m| m < 0.0)).count();
    if doubtful > 0 {
        note(&format!(
            "note: {doubtful} of the added gaits have a margin below 0; --least-probability leaves them out"
        ));
    }
}
