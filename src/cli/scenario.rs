//! `gaitway scene new`, `check`, `show` and `schema`: a scenario of one's own, from an empty folder to one that is right.

use super::output::{complain, say, say_json, thousands};
use super::{outputs, usage};
use crate::Error;
use crate::scenario::{Scenario, Setting, json_schema, reference};
use crate::scene::Scene;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::str::FromStr as _;

/// Arguments of `gaitway scene new`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway scene new --like hall\n  gaitway scene new --like museum --out rooms.toml\n  \
                  gaitway scene check rooms.toml"
)]
pub(super) struct NewArguments {
    /// What to begin with
    #[arg(long, value_enum)]
    like: Starter,
    /// Where to write it [default: its name with .toml, here]
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

/// What a scenario can begin with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Starter {
    /// A hall with one door that everyone leaves by
    Hall,
    /// A street with shops, walked up and down
    Street,
    /// Two rooms with exhibits at which visitors stay
    Museum,
    /// A corridor with a bottleneck and two streams
    Corridor,
}

impl Starter {
    const fn name(self) -> &'static str {
        match self {
            Self::Hall => "hall",
            Self::Street => "street",
            Self::Museum => "museum",
            Self::Corridor => "corridor",
        }
    }

    const fn text(self) -> &'static str {
        match self {
            Self::Hall => include_str!("../../assets/starters/hall.toml"),
            Self::Street => include_str!("../../assets/starters/street.toml"),
            Self::Museum => include_str!("../../assets/starters/museum.toml"),
            Self::Corridor => include_str!("../../assets/starters/corridor.toml"),
        }
    }
}

/// Writes a scenario to begin with.
pub(super) fn new(arguments: &NewArguments) -> Result<bool, Error> {
    let starter = arguments.like;
    let file = arguments.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}.toml", starter.name())));
    if arguments.out.is_none() {
        outputs::free(&file)?;
    }
    let text = starter.text().replacen(&format!("{}.toml", starter.name()), &file.display().to_string(), 1);
    write(&file, &text)?;
    say(&format!("written  {}", file.display()));
    say(&format!("look     gaitway render {} --out picture.png", file.display()));
    say("keys     gaitway scene schema --format markdown");
    Ok(true)
}

/// Arguments of `gaitway scene show`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway scene show crossing\n  gaitway scene show garden --agents 200 --out own.toml"
)]
pub(super) struct ShowArguments {
    /// A built-in scene, or a scenario file
    #[arg(value_name = "SCENE|FILE.toml")]
    scene: String,
    /// How many agents; built-in places grow with them [default: as in the scenario]
    #[arg(long, value_name = "N", value_parser = super::scene::people(0))]
    agents: Option<u32>,
    /// Where to write it [default: standard output]
    #[arg(long, value_name = "FILE.toml")]
    out: Option<PathBuf>,
}

/// Prints a scenario with its generated place written out.
pub(super) fn show(arguments: &ShowArguments) -> Result<bool, Error> {
    let mut builder = Scene::load(&arguments.scene)?;
    if let Some(agents) = arguments.agents {
        builder = builder.agents(agents);
    }
    let text = builder.scenario().expanded().to_toml()?;
    print_or_write(&text, arguments.out.as_deref())
}

/// Arguments of `gaitway scene schema`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway scene schema --out scenario.schema.json\n  gaitway scene schema --format markdown\n\nEditors with \
                  Taplo (Even Better TOML) complete and explain keys of a file that begins with the line\n  #:schema \
                  ./scenario.schema.json"
)]
pub(super) struct SchemaArguments {
    /// JSON Schema (draft 2020-12), or a page of all keys
    #[arg(long, value_enum, default_value_t)]
    format: SchemaFormat,
    /// Where to write it [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum SchemaFormat {
    #[default]
    Json,
    Markdown,
}

/// Prints what a scenario file may say.
pub(super) fn schema(arguments: &SchemaArguments) -> Result<bool, Error> {
    let text = match arguments.format {
        SchemaFormat::Json => format!("{:#}\n", json_schema()),
        SchemaFormat::Markdown => reference(),
    };
    print_or_write(&text, arguments.out.as_deref())
}

/// Arguments of `gaitway scene check`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway scene check hall.toml\n  gaitway scene check *.toml --json\n\nNothing is \
                  simulated. The exit code is 1 if a file is wrong."
)]
pub(super) struct CheckArguments {
    /// Scenario files, or names of built-in scenes
    #[arg(value_name = "SCENE|FILE.toml", required = true)]
    scenes: Vec<String>,
    /// Set any key of the scenario as its file would, such as navigation.patience=1.0; may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = Setting::from_str)]
    set: Vec<Setting>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Listing {
    scenes: Vec<Checked>,
}

/// What was found in one file.
#[derive(Debug, Serialize)]
struct Checked {
    scene: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    contents: Option<Contents>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<String>,
}

/// What a scenario that is right contains.
#[derive(Debug, Serialize)]
struct Contents {
    name: String,
    agents: usize,
    /// Inside the bounds less the obstacles, m².
    walkable_area: f64,
    obstacles: usize,
    routes: usize,
    stages: usize,
    journeys: usize,
    sources: usize,
    floors: usize,
    has_user: bool,
}

impl Contents {
    /// Reads a scenario and places its people.
    fn of(scene: &str, settings: &[Setting]) -> Result<Self, Error> {
        let scene = crate::scene::SceneBuilder::load(scene, settings)?.build()?;
        // the ways, too: a goal may lie where no agent can stand
        scene.buffers()?;
        let Scenario { name, stages, journeys, sources, floors, user, .. } = scene.scenario;
        Ok(Self {
            name,
            agents: scene.crowd.agents.len(),
            walkable_area: scene.geometry.walkable_area(),
            obstacles: scene.geometry.obstacles.len(),
            routes: scene.geometry.routes.len(),
            stages: stages.len(),
            journeys: journeys.len(),
            sources: sources.len(),
            floors: floors.len(),
            has_user: user.is_some(),
        })
    }

    /// In words, without what there is none of.
    fn told(&self) -> String {
        let count = |number: usize, one: &str| {
            let words = format!("{} {one}{}", thousands(number as u64), if number == 1 { "" } else { "s" });
            (number > 0).then_some(words)
        };
        let counts = [
            count(self.obstacles, "obstacle"),
            count(self.routes, "route"),
            count(self.stages, "stage"),
            count(self.journeys, "journey"),
            count(self.sources, "source"),
            count(self.floors, "floor"),
            self.has_user.then(|| "a user".to_owned()),
        ];
        let area = format!("{:.0} m² to walk on", self.walkable_area);
        let all =
            [Some(format!("{} agents", thousands(self.agents as u64))), Some(area)].into_iter().chain(counts);
        all.flatten().collect::<Vec<_>>().join(", ")
    }
}

/// Checks scenarios.
pub(super) fn check(arguments: &CheckArguments) -> Result<bool, Error> {
    let mut scenes = Vec::new();
    for scene in &arguments.scenes {
        let (contents, error) = match Contents::of(scene, &arguments.set) {
            Ok(contents) => (Some(contents), None),
            Err(error) => {
                if !arguments.json {
                    complain(&error, false);
                }
                (None, Some(error.to_string()))
            }
        };
        if let (Some(contents), false) = (&contents, arguments.json) {
            say(&format!("{scene}: {}", contents.told()));
        }
        scenes.push(Checked { scene: scene.clone(), contents, error });
    }
    let is_right = scenes.iter().all(|scene| scene.error.is_none());
    if arguments.json {
        say_json(&Listing { scenes })?;
    }
    Ok(is_right)
}

fn print_or_write(text: &str, out: Option<&Path>) -> Result<bool, Error> {
    match out {
        Some(file) => write(file, text)?,
        None => say(text.trim_end_matches('\n')),
    }
    Ok(true)
}

fn write(file: &Path, text: &str) -> Result<(), Error> {
    if file.file_name().is_none() {
        return Err(usage(format!("--out {}: is no name of a file", file.display()), "use FILE.toml"));
    }
    let failed = |source| crate::export::Error::Write { path: file.to_owned(), source };
    Ok(crate::file::write(file, text.as_bytes()).map_err(failed)?)
}
