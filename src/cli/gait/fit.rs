//! `gaitway gait fit`: gaits as a mean pose and a few harmonics; and the walker's classes against E-Gait's.

use crate::Error;
use crate::cli::output::{note, say, say_json, table};
use crate::cli::{scene, usage};
use crate::export::AtomicFile;
use crate::gait::fit::contrast::{Contrast, Verdict, compare};
use crate::gait::fit::{self, HarmonicGait};
use crate::gait::{Gait, import, stride};
use crate::library::GaitLibrary;
use clap::Args;
use serde::Serialize;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// E-Gait's files.
const EGAIT: [&str; 5] = ["bml.csv", "cmu.csv", "ewalk.csv", "ict.csv", "sig.csv"];

/// Differences between the walker's emotions, of 24, that should be as large as in people.
const WANTED: usize = 20;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait fit walk1.bvh --out walk1.json\n  gaitway gait fit mine.glb --harmonics 3 \
                  --out small.gwh\n  gaitway gait fit small.gwh --out back.glb\n  gaitway gait fit --check-walker \
                  egait/\n\n.json and .gwh hold mean pose and harmonics, .glb is a library for `gaitway simulate \
                  --library`. A fitted file as input is not fitted again unless --harmonics is given."
)]
pub(super) struct FitArguments {
    /// A gait library (.glb), a motion file, or fitted gaits (.json, .gwh) [default: the built-in library]
    #[arg(value_name = "FILE|LIB")]
    file: Option<PathBuf>,
    /// Harmonics of every joint coordinate, 0 to 32 [default: 4]
    #[arg(long, value_name = "N")]
    harmonics: Option<usize>,
    /// .json or .gwh (harmonics), or .glb (a library of the fitted gaits)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Compare the walker's classes with those of E-Gait's files in this folder instead
    #[arg(long, value_name = "DATA", conflicts_with_all = ["file", "harmonics", "out"])]
    check_walker: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// A fitted gait as it is listed.
#[derive(Debug, Serialize)]
struct Row {
    name: String,
    frames: usize,
    harmonics: usize,
    bytes: usize,
    rms_cm: f32,
    max_cm: f32,
    /// Where the largest error is.
    joint: &'static str,
    phase: f32,
}

#[derive(Debug, Serialize)]
struct Outcome {
    gaits: Vec<Row>,
    /// Mean over gaits.
    rms_cm: f32,
    /// Largest of any gait.
    max_cm: f32,
    file: Option<PathBuf>,
    file_bytes: Option<u64>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &FitArguments) -> Result<bool, Error> {
    if let Some(folder) = &arguments.check_walker {
        return check_walker(folder, arguments.json);
    }
    let begin = Instant::now();
    let harmonics = arguments.harmonics.unwrap_or(fit::HARMONICS);
    if harmonics > fit::MOST_HARMONICS {
        let message = format!("--harmonics {harmonics}: must be 0 to {}", fit::MOST_HARMONICS);
        return Err(usage(message, "with 4 a walk is some 3 mm off (RMS)"));
    }
    let pairs = fitted(arguments, harmonics)?;
    let (file, file_bytes) = match &arguments.out {
        None => (None, None),
        Some(path) => {
            let gaits: Vec<HarmonicGait> = pairs.iter().map(|(_, fitted)| fitted.clone()).collect();
            write(path, &gaits)?;
            (Some(path.clone()), std::fs::metadata(path).ok().map(|data| data.len()))
        }
    };
    let gaits: Vec<Row> = pairs.iter().map(|(gait, fitted)| row(gait, fitted)).collect();
    #[allow(clippy::cast_precision_loss, reason = "a number of gaits")]
    let rms_cm = gaits.iter().map(|row| row.rms_cm).sum::<f32>() / gaits.len().max(1) as f32;
    let max_cm = gaits.iter().map(|row| row.max_cm).fold(0.0, f32::max);
    let wall_seconds = begin.elapsed().as_secs_f64();
    let outcome = Outcome { gaits, rms_cm, max_cm, file, file_bytes, wall_seconds };
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
}

/// Every gait with its fit. Gaits that are fitted already stay as they are unless `--harmonics` is given.
fn fitted(arguments: &FitArguments, harmonics: usize) -> Result<Vec<(Gait, HarmonicGait)>, Error> {
    let gaits = match &arguments.file {
        Some(path) if fit::is_fitted(path) => {
            let found = fit::load(path)?;
            let back = |fitted: HarmonicGait| {
                let gait = Gait { provenance: fitted.provenance.clone(), ..fitted.to_gait(fit::FRAMES) };
                let fitted = if arguments.harmonics.is_some() { fit::fit(&gait, harmonics)? } else { fitted };
                Ok((gait, fitted))
            };
            return found.into_iter().map(back).collect();
        }
        Some(path) if !super::is_glb(path) => super::strides(path)?,
        path => scene::library(path.as_deref())?.gaits().to_vec(),
    };
    let mut pairs = Vec::with_capacity(gaits.len());
    for gait in gaits {
        let fitted = fit::fit(&gait, harmonics)?;
        if fitted.harmonics() < harmonics {
            let (name, frames, found) = (&gait.name, gait.poses.len(), fitted.harmonics());
            note(&format!("note: {name}: {frames} frames determine {found} harmonics, not {harmonics}"));
        }
        pairs.push((gait, fitted));
    }
    Ok(pairs)
}

fn row(gait: &Gait, fitted: &HarmonicGait) -> Row {
    let error = fitted.error(gait);
    Row {
        name: gait.name.clone(),
        frames: gait.poses.len(),
        harmonics: fitted.harmonics(),
        bytes: fitted.bytes(),
        rms_cm: 100.0 * error.rms,
        max_cm: 100.0 * error.largest,
        joint: error.joint.name(),
        phase: error.phase,
    }
}

fn write(path: &Path, gaits: &[HarmonicGait]) -> Result<(), Error> {
    let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
    let bytes = match ending.as_deref() {
        Some("json") => fit::to_json(gaits).into_bytes(),
        Some("gwh") => fit::to_bytes(gaits),
        Some("glb") => {
            let played = gaits.iter().map(|gait| gait.to_gait(fit::FRAMES)).collect();
            return Ok(GaitLibrary::from_gaits(played)?.save_glb(path)?);
        }
        _ => {
            let out = path.display();
            return Err(usage(
                format!("--out {out}: neither .json, .gwh nor .glb"),
                "such as --out fitted.json",
            ));
        }
    };
    let mut file = AtomicFile::create(path)?;
    let wrong = |source| crate::export::Error::Write { path: path.to_owned(), source };
    file.write_all(&bytes).map_err(wrong)?;
    Ok(file.finish()?)
}

fn print(outcome: &Outcome) {
    let rows: Vec<Vec<String>> = outcome
        .gaits
        .iter()
        .map(|row| {
            vec![
                row.name.clone(),
                row.frames.to_string(),
                row.harmonics.to_string(),
                row.bytes.to_string(),
                format!("{:.2}", row.rms_cm),
                format!("{:.2}", row.max_cm),
                format!("{} at phase {:.2}", row.joint, row.phase),
            ]
        })
        .collect();
    table(&["name", "frames", "harmonics", "bytes", "RMS cm", "max cm", "where"], &rows);
    let count = outcome.gaits.len();
    say(&format!(
        "error      RMS {:.2} cm (mean of {count} gaits), at most {:.2} cm",
        outcome.rms_cm, outcome.max_cm
    ));
    if let (Some(file), Some(bytes)) = (&outcome.file, outcome.file_bytes) {
        say(&format!("written    {} ({bytes} bytes)", file.display()));
    }
    say(&format!("wall time  {:.2} s", outcome.wall_seconds));
}

/// What is printed about the walker.
#[derive(Debug, Serialize)]
struct Check {
    contrasts: Vec<Contrast>,
    gaits: usize,
    left_out: usize,
}

/// Compares the walker's presets with E-Gait; false if a clear difference points the other way.
fn check_walker(folder: &Path, is_json: bool) -> Result<bool, Error> {
    let (mut sources, mut left_out) = (Vec::new(), 0);
    for path in EGAIT.map(|name| folder.join(name)).iter().filter(|path| path.is_file()) {
        let takes = import::import_file(path)?;
        let count = takes.len();
        let gaits: Vec<Gait> = takes.iter().filter_map(|take| stride::best(take).ok()).collect();
        left_out += count - gaits.len();
        sources.push(gaits);
    }
    if sources.is_empty() {
        let message = format!("--check-walker {}: no file of E-Gait there", folder.display());
        return Err(usage(message, format!("give the folder of {} with their gaits.csv", EGAIT.join(", "))));
    }
    let contrasts = compare(&sources)?;
    let count = |verdict| contrasts.iter().filter(|contrast| contrast.verdict == verdict).count();
    let (within, all) = (count(Verdict::Within), contrasts.len());
    let is_good = within >= WANTED && count(Verdict::Opposite) == 0;
    let check = Check { contrasts, gaits: sources.iter().map(Vec::len).sum(), left_out };
    if is_json {
        say_json(&check)?;
        return Ok(is_good);
    }
    let rows: Vec<Vec<String>> = check.contrasts.iter().map(words).collect();
    table(&["measure", "against neutral", "gaits", "E-Gait", "+-", "walker", "verdict"], &rows);
    say(&format!("{} gaits, {} left out for want of a stride", check.gaits, check.left_out));
    say("x is a ratio to the neutral mean of the same source; +- is a standard error");
    say(&format!(
        "{within} of {all} within two standard errors; at least {WANTED} and none opposite are wanted"
    ));
    Ok(is_good)
}

fn words(contrast: &Contrast) -> Vec<String> {
    let value = |value: f64| if contrast.is_ratio { format!("x {value:.3}") } else { format!("{value:+.2}") };
    let verdict = match contrast.verdict {
        Verdict::Within => "within",
        Verdict::Weaker => "weaker",
        Verdict::Stronger => "stronger",
        Verdict::Opposite => "OPPOSITE",
    };
    vec![
        contrast.measure.to_owned(),
        contrast.emotion.to_string(),
        contrast.gaits.to_string(),
        value(contrast.recorded),
        format!("{:.3}", contrast.error),
        value(contrast.walker),
        verdict.to_owned(),
    ]
}
