//! `gaitway gait ratings`: raw responses of raters to means, labels, correlations, agreement and a labelled library.

use super::videos::read_key;
use crate::Error;
use crate::cli::output::{note, say, say_json, table};
use crate::cli::scene::library;
use crate::cli::usage;
use crate::emotion::Emotion;
use crate::export::AtomicFile;
use crate::export::chart::{self, Bar, Bars, EMOTION_COLORS, Matrix, Scale, Series};
use crate::library::GaitLibrary;
use crate::perception::ratings::{self, Analysis, Fault, Options};
use crate::statistics::agreement::Correlation;
use crate::table::cell;
use clap::Args;
use serde::Serialize;
use std::collections::HashSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Most names in one remark.
const NAMED: usize = 5;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway gait ratings study.csv\n  gaitway gait ratings study.csv --library mine.glb \
                  --key videos-key.csv --out labelled.glb --figures figures/\n\nThe sheet has a header and one row per participant and \
                  video: participant, video, happy, angry, sad, neutral (1 strongly disagree to 5 strongly agree), and \
                  optionally gender and age. A video is a gait's name, or its number with --key."
)]
pub(super) struct RatingsArguments {
    /// Raw responses (CSV)
    #[arg(value_name = "RESPONSES.csv")]
    responses: PathBuf,
    /// The library whose gaits were rated; other videos are then errors
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Which gait each video shows: the table that `gaitway gait show --videos` wrote [default: a video is a gait's name]
    #[arg(long, value_name = "KEY.csv")]
    key: Option<PathBuf>,
    /// Library with the ratings and labels to write
    #[arg(long, value_name = "LABELLED.glb", requires = "library")]
    out: Option<PathBuf>,
    /// A gait looks like an emotion if its mean rating is above this
    #[arg(long, default_value_t = ratings::THETA)]
    theta: f64,
    /// Name videos with fewer responses
    #[arg(long, default_value_t = ratings::FEWEST_RESPONSES, value_name = "N")]
    min_responses: usize,
    /// Leave rows out that cannot be used, and list them
    #[arg(long)]
    skip_bad: bool,
    /// Table of means to write
    #[arg(long, value_name = "MEANS.csv")]
    csv: Option<PathBuf>,
    /// Folder for figures (SVG and PNG)
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What is printed.
#[derive(Debug, Serialize)]
struct Outcome {
    #[serde(flatten)]
    analysis: Analysis,
    min_responses: usize,
    /// Videos with fewer responses than that.
    short: Vec<String>,
    /// Labels that hang on a tie or on the threshold itself.
    warnings: Vec<String>,
    left_out: Vec<Fault>,
    /// Gaits of the library without ratings.
    unrated: Vec<String>,
    files: Vec<PathBuf>,
    wall_seconds: f64,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &RatingsArguments) -> Result<bool, Error> {
    let begin = Instant::now();
    if !(1.0..=5.0).contains(&arguments.theta) {
        let message = format!("--theta {}: must be 1 to 5", arguments.theta);
        return Err(usage(message, "the paper takes 3.5"));
    }
    let rated = arguments.library.as_ref().map(|path| library(Some(path))).transpose()?;
    let key = arguments.key.as_deref().map(read_key).transpose()?;
    let names: Option<HashSet<String>> = match &key {
        Some(key) => Some(key.keys().cloned().collect()),
        None => rated.as_ref().map(|library| library.gaits().iter().map(|gait| gait.name.clone()).collect()),
    };
    let options = Options { videos: names.as_ref(), skip_bad: arguments.skip_bad };
    let mut sheet = ratings::read(&arguments.responses, &options)?;
    if let Some(key) = &key {
        for response in &mut sheet.responses {
            if let Some(gait) = key.get(&response.video) {
                response.video.clone_from(gait);
            }
        }
    }
    let analysis = ratings::analyse(&sheet.responses, arguments.theta);
    let mut files = Vec::new();
    let unrated = match rated {
        None => Vec::new(),
        Some(rated) => {
            files.extend(arguments.out.clone());
            label(&rated, &analysis, arguments.out.as_deref())?
        }
    };
    if let Some(path) = &arguments.csv {
        write_means(&analysis, path)?;
        files.push(path.clone());
    }
    if let Some(folder) = &arguments.figures {
        files.extend(chart::write(folder, "correlations", &correlations(&analysis.over_videos))?);
        files.extend(chart::write(folder, "labels", &labels(&analysis))?);
    }
    let short = analysis.short_of(arguments.min_responses).iter().map(|video| video.name.clone()).collect();
    let warnings = analysis.warnings();
    let min_responses = arguments.min_responses;
    let left_out = sheet.left_out;
    let wall_seconds = begin.elapsed().as_secs_f64();
    let outcome =
        Outcome { analysis, min_responses, short, warnings, left_out, unrated, files, wall_seconds };
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome, &arguments.responses);
    }
    Ok(true)
}

/// Writes ratings and labels into the gaits of a library, and the library if there is a file for it; returns the gaits without
/// ratings.
pub(in crate::cli) fn label(
    rated: &GaitLibrary,
    analysis: &Analysis,
    out: Option<&Path>,
) -> Result<Vec<String>, Error> {
    let mut gaits = rated.gaits().to_vec();
    let unrated = ratings::apply(analysis, &mut gaits);
    if let Some(out) = out {
        GaitLibrary::from_gaits(gaits)?.save_glb(out)?;
    }
    Ok(unrated)
}

fn print(outcome: &Outcome, sheet: &Path) {
    let analysis = &outcome.analysis;
    let rows: Vec<Vec<String>> = analysis
        .videos
        .iter()
        .map(|video| {
            let means = video.mean.iter().map(|mean| format!("{mean:.2}"));
            let margin = video.label.map_or("-".into(), |label| format!("{:.2}", video.margin(label)));
            let label = video.label.map_or("-", Emotion::name).to_owned();
            let name = std::iter::once(video.name.clone());
            name.chain([video.responses.to_string()]).chain(means).chain([label, margin]).collect()
        })
        .collect();
    table(&["video", "n", "happy", "angry", "sad", "neutral", "label", "margin"], &rows);
    say("");
    print_labels(analysis);
    say("");
    print_questions(analysis);
    say("");
    let who = &analysis.demographics;
    let genders = who.genders.iter().map(|(gender, count)| format!("{count} {gender}"));
    let genders =
        genders.chain((who.gender_unreported > 0).then(|| format!("{} not said", who.gender_unreported)));
    let age = who.mean_age.map_or(String::new(), |age| format!(", mean age {age:.1}"));
    say(&format!(
        "raters     {} ({}{age}), {} responses to {} videos",
        who.participants,
        genders.collect::<Vec<_>>().join(", "),
        analysis.responses,
        analysis.videos.len()
    ));
    remarks(outcome, sheet);
    for file in &outcome.files {
        say(&format!("written    {}", file.display()));
    }
    say(&format!("wall time  {:.2} s", outcome.wall_seconds));
}

fn print_labels(analysis: &Analysis) {
    let found = &analysis.distribution;
    let rows: Vec<Vec<String>> = Emotion::ALL
        .into_iter()
        .map(|emotion| {
            let share = format!("{:.2} %", 100.0 * found.share(emotion));
            vec![emotion.to_string(), found.counts[emotion.index()].to_string(), share]
        })
        .collect();
    table(&["label", "gaits", "share"], &rows);
    let all = found.labelled + found.dropped;
    let theta = analysis.theta;
    say(&format!(
        "n = {} of {all} gaits; {} are above theta = {theta} for no emotion and have no label",
        found.labelled, found.dropped
    ));
}

/// Correlations and agreement, one row per question.
fn print_questions(analysis: &Analysis) {
    let word = |value: f64, digits: usize| {
        if value.is_finite() { format!("{value:.digits$}") } else { "-".to_owned() }
    };
    for (over, found) in [("gaits", &analysis.over_videos), ("responses", &analysis.over_responses)] {
        let rows: Vec<Vec<String>> = Emotion::ALL
            .into_iter()
            .map(|emotion| {
                let row = found.r[emotion.index()].iter().map(|&r| word(r, 3));
                std::iter::once(emotion.to_string()).chain(row).collect()
            })
            .collect();
        let head = format!("r over {} {over}", found.rows);
        table(&[&head, "happy", "angry", "sad", "neutral"], &rows);
        say("");
    }
    let rows: Vec<Vec<String>> = Emotion::ALL
        .into_iter()
        .zip(&analysis.agreement)
        .map(|(emotion, found)| {
            let values = [found.icc_single, found.icc_mean, found.alpha_ordinal, found.alpha_interval];
            std::iter::once(emotion.to_string()).chain(values.map(|value| word(value, 3))).collect()
        })
        .collect();
    let raters = word(analysis.agreement[0].raters, 1);
    let mean = format!("ICC(1,k), k = {raters}");
    table(&["agreement", "ICC(1,1)", &mean, "alpha, ordinal", "alpha, interval"], &rows);
}

/// What the user should know about the data, on standard error.
fn remarks(outcome: &Outcome, sheet: &Path) {
    for fault in &outcome.left_out {
        note(&format!("left out: {}:{}: {}", sheet.display(), fault.line, fault.message));
    }
    for warning in &outcome.warnings {
        note(&format!("warning: {warning}"));
    }
    if !outcome.short.is_empty() {
        let (count, fewest) = (outcome.short.len(), outcome.min_responses);
        note(&format!("warning: {count} videos have fewer than {fewest} responses: {}", few(&outcome.short)));
    }
    if !outcome.unrated.is_empty() {
        let count = outcome.unrated.len();
        note(&format!(
            "note: {count} gaits of the library were not rated and stay as they are: {}",
            few(&outcome.unrated)
        ));
    }
}

/// The first names of a list.
fn few(names: &[String]) -> String {
    let more = names.len().saturating_sub(NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    names.iter().take(NAMED).cloned().collect::<Vec<_>>().join(", ") + &more
}

/// One row per video: n, means, standard deviations, label, margin.
fn write_means(analysis: &Analysis, path: &Path) -> Result<(), Error> {
    let wrong = |source| crate::export::Error::Write { path: path.to_owned(), source };
    let mut file = AtomicFile::create(path)?;
    let mut write = || -> std::io::Result<()> {
        write!(file, "video,responses")?;
        for what in ["mean", "sd"] {
            for emotion in Emotion::ALL {
                write!(file, ",{what}_{emotion}")?;
            }
        }
        writeln!(file, ",label,margin")?;
        for video in &analysis.videos {
            write!(file, "{},{}", cell(&video.name), video.responses)?;
            for value in video.mean.iter().chain(&video.deviation) {
                write!(file, ",{value:.6}")?;
            }
            match video.label {
                Some(label) => writeln!(file, ",{label},{:.6}", video.margin(label))?,
                None => writeln!(file, ",,")?,
            }
        }
        Ok(())
    };
    write().map_err(wrong)?;
    Ok(file.finish()?)
}

fn names() -> Vec<String> {
    Emotion::ALL.map(|emotion| emotion.to_string()).to_vec()
}

/// The paper's table of correlations between the four questions, as a figure.
fn correlations(found: &Correlation) -> Matrix {
    Matrix {
        title: "Correlation of the four ratings".to_owned(),
        row_name: String::new(),
        column_name: String::new(),
        rows: names(),
        columns: names(),
        values: found.r.iter().map(|row| row.to_vec()).collect(),
        notes: Vec::new(),
        decimals: 3,
        unit: String::new(),
        scale: Scale::Diverging(1.0),
        note: format!("Pearson's r over the mean ratings of {} gaits", found.rows),
    }
}

/// The paper's figure of label shares.
fn labels(analysis: &Analysis) -> Bars {
    let found = &analysis.distribution;
    let bar = |emotion: Emotion| {
        let percent = 100.0 * found.share(emotion);
        let text = format!("{} = {percent:.2} %", found.counts[emotion.index()]);
        Bar { value: percent, interval: None, text }
    };
    let all = found.labelled + found.dropped;
    Bars {
        title: "Perceived emotions".to_owned(),
        axis: "share of labelled gaits, %".to_owned(),
        groups: names(),
        series: vec![Series {
            name: String::new(),
            bars: Emotion::ALL.map(bar).to_vec(),
            colors: EMOTION_COLORS.to_vec(),
        }],
        line: None,
        decimals: 2,
        note: format!("n = {} of {all} gaits, theta = {}", found.labelled, analysis.theta),
    }
}
