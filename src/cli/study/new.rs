//! `gaitway study new`: the files of a study, to be filled in.

use super::super::output::{say, say_json};
use super::super::outputs::make_folder;
use super::super::scene::library;
use super::super::usage;
use super::beside::{libraries, texts};
use super::folder::write_text;
use crate::Error;
use crate::library::{DEFAULT_SEED, GaitLibrary};
use crate::study::check::Severity;
use crate::study::{BUILTIN, FILE_NAME, Study, check};
use serde::Serialize;
use std::path::PathBuf;

/// Emotions times sexes of generated gaits.
const CLASSES: u32 = 8;

/// Arguments of `gaitway study new`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  gaitway study new eva-gaits --out mine/\n  gaitway study check mine/\n\nThe built-in studies: \
                  eva-gaits (raters judge how walkers feel), eva-agents (people walk among crowds in four scenes)."
)]
pub(super) struct Arguments {
    /// Built-in study to begin with
    #[arg(value_name = "STUDY")]
    study: String,
    /// Library of the gaits that raters are to judge [default: the built-in one]
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    /// Number of gaits to generate as that library, of all emotions and both sexes alike
    #[arg(long, value_name = "N", conflicts_with = "library", value_parser = clap::value_parser!(u32).range(8..=10_000))]
    gaits: Option<u32>,
    /// Folder to write
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Outcome {
    files: Vec<PathBuf>,
    /// Key paths that the lab has to fill in.
    missing: Vec<String>,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let Some(builtin) = BUILTIN.iter().find(|study| study.name == arguments.study) else {
        let error =
            Study::builtin(&arguments.study).err().map_or_else(String::new, |error| error.to_string());
        return Err(usage(error, "`gaitway study new --help` says what they are"));
    };
    let study = Study::builtin(builtin.name)?;
    let gaits = match arguments.gaits {
        Some(count) => generated(count)?,
        None => library(arguments.library.as_deref())?,
    };
    let names = gaits.gaits().iter().map(|gait| gait.name.clone()).collect::<Vec<_>>();
    let mut materials = texts(&study)?;
    for name in libraries(&study) {
        materials = materials.with_gaits(&name, names.clone());
    }
    let report = check(&study, &materials);
    let is_missing = |note: &&check::Note| note.severity == Severity::Missing;
    let missing: Vec<String> = report.notes.iter().filter(is_missing).map(|note| note.key.clone()).collect();
    make_folder(&arguments.out)?;
    let readme = readme(&study, &missing);
    let texts = [(FILE_NAME, builtin.toml), (builtin.consent_name, builtin.consent), ("README.md", &readme)];
    let mut files = Vec::new();
    for (name, text) in texts {
        let path = arguments.out.join(name);
        write_text(&path, text)?;
        files.push(path);
    }
    let crowd = study.file.crowd.iter().map(|crowd| crowd.library.clone());
    for name in libraries(&study).into_iter().chain(crowd) {
        let path = arguments.out.join(name);
        gaits.save_glb(&path)?;
        files.push(path);
    }
    let outcome = Outcome { files, missing };
    if arguments.json {
        say_json(&outcome)?;
        return Ok(true);
    }
    for file in &outcome.files {
        say(&format!("written  {}", file.display()));
    }
    say(&format!("to fill in: {}", outcome.missing.join(", ")));
    Ok(true)
}

/// So many generated gaits: the first individuals of each emotion and sex, whose numbers differ by one at most.
fn generated(count: u32) -> Result<GaitLibrary, Error> {
    let per_class = count.div_ceil(CLASSES);
    let all = GaitLibrary::generated(DEFAULT_SEED, per_class)?;
    let count = usize::try_from(count).unwrap_or(usize::MAX);
    let per_class = usize::try_from(per_class).unwrap_or(usize::MAX);
    let mut places: Vec<usize> = (0..all.gaits().len()).collect();
    places.sort_by_key(|place| (place % per_class, *place));
    places.truncate(count);
    places.sort_unstable();
    Ok(GaitLibrary::from_gaits(places.into_iter().map(|place| all.gaits()[place].clone()).collect())?)
}

/// What the folder is and what to do with it.
fn readme(study: &Study, missing: &[String]) -> String {
    let language = study.file.study.languages.first().map_or("en", String::as_str);
    let title = study.file.study.title.find(language, &[]);
    let list: String = missing.iter().map(|key| format!("- `{key}`\n")).collect();
    format!(
        "# {title}\n\nThe study `{}`, version {}.\n\nTo fill in before people take part:\n\n{list}\nThen:\n\n```sh\ngaitway \
         study check .       # errors, what is missing, how long it takes, how many people it needs\ngaitway study simulate \
         . --drop 0.3 --seed 1 --out run/    # the same study with simulated participants\ngaitway study analyse run/  \
         # the planned tests\n```\n",
        study.file.study.id, study.file.study.version
    )
}
