//! `gaitway gait`: gaits out of motion files, tables and sheets of them, generated ones.

mod blend;
mod compare;
mod figures_of_folds;
mod fit;
mod import;
mod label;
mod listing;
mod measure;
mod predict;
pub(super) mod ratings;
pub(super) mod sources;
mod train;
mod videos;

pub(super) use predict::model_or_default;

use super::output::note;
use super::outputs::free;
use super::scene::{self, library, seed};
use super::{figures, usage};
use crate::Error;
use crate::emotion::Emotion;
use crate::export::image::write_png;
use crate::gait::LabelOrigin;
use crate::gait::walker::{EXPRESSION, STYLE_FIELDS, WalkerStyle, walk};
use crate::library::GaitLibrary;
use crate::spelling::suggestion;
use clap::{Args, Subcommand};
use listing::{Row, SexName, is_glb, list, strides, table_of_gaits, write_csv};
use std::path::PathBuf;
use std::time::Instant;

/// Most gaits of a sheet.
const SHEET_ROWS: usize = 32;

/// Arguments of `gaitway gait`.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Compare the methods of perception on labelled gaits
    Compare(compare::Arguments),
    /// Find the strides in motion files and folders of them (.bvh, .amc, .c3d, .trc, .npz, .csv, ...)
    Import(import::Arguments),
    /// Add gaits to a library, labelled by a model and marked as predicted
    Label(label::Arguments),
    /// Measure joint angles of walks as drawn, beside those of healthy adults
    Measure(measure::Arguments),
    /// Predict the emotion that people would see in gaits
    Predict(predict::Arguments),
    /// List the gaits of a file or library
    Show(ShowArguments),
    /// Train a model on labelled gaits
    Train(train::Arguments),
    /// Generate a gait
    Walk(WalkArguments),
    /// Blend gaits into a mixture of emotions
    Blend(blend::BlendArguments),
    /// Turn the responses of raters into means, labels and a labelled library
    Ratings(ratings::RatingsArguments),
    /// Fit gaits with a few harmonics; compare the walker with E-Gait
    Fit(fit::FitArguments),
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait show --out sheet.png\n  gaitway gait show mine.glb --videos videos/ --seed 7\n  gaitway \
                        gait show walk1.bvh --out walk1.png\n\nWithout a file: the built-in library."
)]
struct ShowArguments {
    /// A gait library (.glb) or motion file
    #[arg(value_name = "FILE|LIB")]
    file: Option<PathBuf>,
    /// Sheet of stick figures
    #[arg(long, value_name = "SHEET.png")]
    out: Option<PathBuf>,
    /// Folder for a video of each gait from the front, as raters see them: numbered in a random order; DIR-key.csv maps
    /// numbers to gaits
    #[arg(long, value_name = "DIR")]
    videos: Option<PathBuf>,
    /// Seed of the order of the videos
    #[arg(long, default_value_t = 1, value_parser = seed, requires = "videos")]
    seed: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait walk --emotion sad --sex female --out sad.csv\n  gaitway gait walk \
                        --emotion happy --speed 1.5 --set bounce=0.04 --out happy.glb\n\n--set takes any style field; a \
                        wrong name lists them."
)]
struct WalkArguments {
    /// happy, angry, sad or neutral
    #[arg(long)]
    emotion: Emotion,
    /// The body to show
    #[arg(long, value_enum, default_value_t)]
    sex: SexName,
    /// How strongly it shows: 0 neutral, 1 as people do, 2 as actors do, 3 as on a stage
    #[arg(long, value_name = "X", value_parser = scene::expression, default_value_t = EXPRESSION)]
    expression: f64,
    /// Walking speed, m/s
    #[arg(long)]
    speed: Option<f64>,
    /// A style field
    #[arg(long, value_name = "FIELD=VALUE")]
    set: Vec<String>,
    /// Vary the style into an individual
    #[arg(long)]
    seed: Option<u64>,
    /// Which individual
    #[arg(long, default_value_t = 0, requires = "seed")]
    index: u32,
    /// .csv (joint positions of three strides over the ground) or .glb (library of one gait)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    match &arguments.command {
        Command::Compare(arguments) => compare::run(arguments),
        Command::Import(arguments) => import::run(arguments),
        Command::Label(arguments) => label::run(arguments),
        Command::Measure(arguments) => measure::run(arguments),
        Command::Predict(arguments) => predict::run(arguments),
        Command::Show(arguments) => show(arguments),
        Command::Train(arguments) => train::run(arguments),
        Command::Walk(arguments) => generate(arguments),
        Command::Blend(arguments) => blend::run(arguments),
        Command::Ratings(arguments) => ratings::run(arguments),
        Command::Fit(arguments) => fit::run(arguments),
    }
}

fn show(arguments: &ShowArguments) -> Result<bool, Error> {
    let begin = Instant::now();
    if let Some(folder) = &arguments.videos {
        free(&videos::key_of(folder))?; // raters may have the videos of the one that is there
    }
    let gaits = match &arguments.file {
        None => library(None)?.gaits().to_vec(),
        Some(path) if is_glb(path) => library(Some(path))?.gaits().to_vec(),
        Some(path) => strides(path)?,
    };
    let mut files = Vec::new();
    if let Some(out) = &arguments.out {
        if gaits.len() > SHEET_ROWS {
            note(&format!("note: the sheet shows the first {SHEET_ROWS} of {} gaits", gaits.len()));
        }
        let shown = &gaits[..gaits.len().min(SHEET_ROWS)];
        write_png(out, &figures::sheet(shown)?).map_err(crate::export::Error::from)?;
        files.push(out.clone());
    }
    if let Some(folder) = &arguments.videos {
        files.extend(videos::write(folder, &gaits, arguments.seed)?);
    }
    list(&gaits, files, begin, arguments.json)?;
    Ok(true)
}

fn generate(arguments: &WalkArguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let sex = arguments.sex.sex();
    let mut style = WalkerStyle::expressed(arguments.emotion, sex, arguments.expression);
    if let Some(seed) = arguments.seed {
        style = style.vary(seed, arguments.index);
    }
    if let Some(speed) = arguments.speed {
        // a stride changes with the root of the speed, as people do it (Grieve 1968): so does the cycle
        style.cycle_time *= (style.speed / speed.max(1e-3)).sqrt();
        style.speed = speed;
    }
    for assignment in &arguments.set {
        assign(&mut style, assignment)?;
    }
    let name = arguments.out.file_stem().map_or("gait".into(), |stem| stem.to_string_lossy());
    let ways_out = "leave out the --speed or --set that does not fit";
    let mut gait = walk(&style, &name).map_err(|error| usage(error.to_string(), ways_out))?;
    gait.label = Some(arguments.emotion);
    gait.provenance.sex = Some(sex);
    gait.provenance.label_origin = Some(LabelOrigin::Generated);
    match arguments.out.extension().and_then(|ending| ending.to_str()) {
        Some("csv") => write_csv(&gait, &arguments.out)?,
        Some("glb") => GaitLibrary::from_gaits(vec![gait.clone()])?.save_glb(&arguments.out)?,
        _ => {
            let out = arguments.out.display();
            return Err(usage(format!("--out {out}: neither .csv nor .glb"), "such as --out sad.csv"));
        }
    }
    list(&[gait], vec![arguments.out.clone()], begin, false)?;
    Ok(true)
}

/// Sets a style field from `name=value`.
fn assign(style: &mut WalkerStyle, text: &str) -> Result<(), Error> {
    let names: Vec<&str> = STYLE_FIELDS.iter().map(|field| field.name).collect();
    let Some((name, value)) = text.split_once('=') else {
        return Err(usage(format!("--set {text}: no value"), "such as --set bounce=0.04"));
    };
    let Some(field) = STYLE_FIELDS.iter().find(|field| field.name == name) else {
        return Err(usage(
            format!("--set {text}: no style field {name:?}"),
            suggestion(name, &names, "the fields are"),
        ));
    };
    match value.parse::<f64>() {
        Ok(value) if (field.range[0]..=field.range[1]).contains(&value) => {
            (field.set)(style, value);
            Ok(())
        }
        _ => {
            let [low, high] = field.range;
            Err(usage(
                format!("--set {text}: must be {low} to {high}"),
                "see the ranges in the documentation of WalkerStyle",
            ))
        }
    }
}
