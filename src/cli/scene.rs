//! What `simulate`, `render` and `demo` have in common: which crowd, where, on which backend.

use super::output::{detail, note};
use super::preference::PreferenceArguments;
use super::usage;
use crate::Error;
use crate::gait::walker::MOST_EXPRESSION;
use crate::library::GaitLibrary;
use crate::scenario::{Condition, MAX_AGENTS, Scenario, Setting};
use crate::scene::{Scene, SceneBuilder};
use crate::sim::{Backend, Simulation};
use clap::builder::{ArgPredicate, TypedValueParser};
use clap::{Args, ValueEnum, value_parser};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Once;

/// How the joints of avatars are called.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct RigArguments {
    /// Names of the joints of an avatar whose rig is not recognised, as the error prints them; may be repeated
    #[arg(long, value_name = "FILE.toml")]
    pub(super) rig_map: Vec<PathBuf>,
}

/// Which crowd.
#[derive(Debug, Clone, Args)]
pub(super) struct SceneArguments {
    /// A built-in scene (crossing, garden, parking, scifi) or a scenario file
    #[arg(
        value_name = "SCENE|FILE.toml",
        required = false,
        required_unless_present = "list",
        default_value_if("list", ArgPredicate::IsPresent, "")
    )]
    pub(super) scene: String,
    /// List the built-in scenes and stop
    #[arg(long)]
    pub(super) list: bool,
    /// How many agents; built-in places grow with them [default: as in the scenario]
    #[arg(long, value_name = "N", value_parser = people(0))]
    pub(super) agents: Option<u32>,
    /// Seed of every random draw [default: as in the scenario]
    #[arg(long, value_name = "N", value_parser = seed)]
    pub(super) seed: Option<u64>,
    /// baseline: one neutral gait, no gaze; eva-o: gaits by emotion; eva-g: gaits and gaze [default: as in the scenario]
    #[arg(long, value_enum)]
    pub(super) condition: Option<ConditionName>,
    /// Gaits to walk with [default: the built-in library]
    #[arg(long, value_name = "LIB.glb")]
    pub(super) library: Option<PathBuf>,
    /// How strongly the built-in gaits show their emotion: 0 not at all, 1 as people do, 2 as actors do, 3 as on a stage
    /// [default: as in the scenario, 2]
    #[arg(long, value_name = "X", value_parser = expression, conflicts_with = "library")]
    pub(super) expression: Option<f64>,
    /// Set any key of the scenario as its file would, such as navigation.patience=1.0, 'walkers=[]' or obstacles.0.high=2;
    /// may be given several times
    #[arg(long, value_name = "KEY=VALUE", value_parser = Setting::from_str)]
    pub(super) set: Vec<Setting>,
    #[command(flatten)]
    pub(super) rigs: RigArguments,
    #[command(flatten)]
    pub(super) preference: PreferenceArguments,
    #[command(flatten)]
    pub(super) place: PlaceArguments,
}

/// Where to compute.
#[derive(Debug, Clone, Args)]
pub(super) struct PlaceArguments {
    /// Where to simulate; auto takes the device that is named, or else the best GPU, or else the CPU; reference is the CPU
    /// with the plain kernels, which are slower and give the same bits
    #[arg(long, value_enum, default_value_t)]
    pub(super) backend: BackendName,
    /// Vulkan device: a part of its name, or its number in `gaitway devices` [default: `GAITWAY_DEVICE`, or the best]
    #[arg(long, value_name = "NAME|NUMBER")]
    pub(super) device: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(clippy::doc_markdown, reason = "names on the command line")]
pub(super) enum ConditionName {
    Baseline,
    EvaO,
    EvaG,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(super) enum BackendName {
    #[default]
    Auto,
    Vulkan,
    Cpu,
    Reference,
}

impl PlaceArguments {
    /// The chosen backend and device.
    pub(super) fn get(&self) -> Result<(Backend, Option<&str>), Error> {
        let backend = match self.backend {
            BackendName::Auto => Backend::Auto,
            BackendName::Vulkan => Backend::Vulkan,
            BackendName::Cpu => Backend::Cpu,
            BackendName::Reference => Backend::Reference,
        };
        if backend.is_cpu() && self.device.is_some() {
            let name = if backend == Backend::Cpu { "cpu" } else { "reference" };
            return Err(usage(
                format!("--device names a Vulkan device, but --backend is {name}"),
                "leave one of them out",
            ));
        }
        Ok((backend, self.device.as_deref()))
    }

    /// A scene that is computed there.
    pub(super) fn choose(&self, builder: SceneBuilder) -> Result<SceneBuilder, Error> {
        let (backend, device) = self.get()?;
        Ok(builder.backend(backend).device(device))
    }
}

impl ConditionName {
    pub(super) const fn get(self) -> Condition {
        match self {
            Self::Baseline => Condition::Baseline,
            Self::EvaO => Condition::EvaO,
            Self::EvaG => Condition::EvaG,
        }
    }
}

impl SceneArguments {
    /// The scene of the arguments, checked; it can be changed further.
    pub(super) fn builder(&self) -> Result<SceneBuilder, Error> {
        let mut builder = SceneBuilder::load(&self.scene, &self.set)?.rig_maps(&self.rigs.rig_map);
        if let Some(agents) = self.agents {
            builder = builder.agents(agents);
        }
        if let Some(seed) = self.seed {
            builder = builder.seed(seed);
        }
        if let Some(condition) = self.condition {
            builder = builder.condition(condition.get());
        }
        if let Some(expression) = self.expression {
            #[allow(clippy::cast_possible_truncation, reason = "a setting")]
            let expression = expression as f32;
            builder = builder.change(|scenario| scenario.population.expression = expression);
        }
        builder = builder.change(|scenario| self.preference.apply(scenario));
        check_changed(builder.scenario())?;
        with_library(self.place.choose(builder)?, self.library.as_deref())
    }

    /// The scene of the arguments.
    pub(super) fn load(&self) -> Result<Scene, Error> {
        build(self.builder()?, self.library.as_deref())
    }
}

/// A scene of gaits of a library file, if one is named.
pub(super) fn with_library(builder: SceneBuilder, path: Option<&Path>) -> Result<SceneBuilder, Error> {
    Ok(match path {
        Some(path) => builder.library(GaitLibrary::load_glb(path)?),
        None => builder,
    })
}

/// Builds a scene and prints notes about it; `library` is the file of its gaits.
pub(super) fn build(builder: SceneBuilder, library: Option<&Path>) -> Result<Scene, Error> {
    let scene = builder.build()?;
    let (scenario, gaits) = (&scene.scenario, scene.cast.gait_count());
    detail(&format!(
        "scene {}: {} agents, seed {}, step {} s; {gaits} gaits to walk with",
        scenario.name, scenario.population.agents, scenario.seed, scenario.navigation.time_step,
    ));
    if let (true, Some(path)) = (scene.is_unlabelled, library) {
        let file = path.display();
        note(&format!(
            "note: none of the {gaits} gaits of {file} has a label, so all walk with one of them, as with --condition \
             baseline; for emotions label them: gaitway gait label {file} --out labelled.glb, or import them with a \
             labels.csv beside the captures (columns file, label)"
        ));
    }
    Ok(scene)
}

/// Checks a scenario that was valid before options changed it: its faults are those of the command line.
pub(super) fn check_changed(scenario: &Scenario) -> Result<(), Error> {
    scenario.validate().map_err(|error| match error {
        crate::scenario::Error::Value(bad) => {
            usage(format!("{} = {}: must be {}", bad.key, bad.value, bad.allowed), bad.hint)
        }
        other => other.into(),
    })
}

/// Reads a number of people, `least` at least.
pub(super) fn people(least: u32) -> impl TypedValueParser<Value = u32> {
    value_parser!(u32).range(i64::from(least)..=i64::from(MAX_AGENTS))
}

/// Reads a size of a crowd.
pub(super) fn size_of_crowd(text: &str) -> Result<usize, String> {
    let most = MAX_AGENTS as usize;
    let size = text.trim().parse().ok().filter(|size| *size <= most);
    size.ok_or_else(|| format!("a size is a whole number from 0 to {most}"))
}

/// Reads a seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|error| format!("{error}: a seed is a whole number from 0 to {}", u64::MAX))
}

/// The crowd of a scene in motion; prints a note when it fell back to the CPU.
pub(super) fn start(scene: &Scene) -> Result<Simulation, Error> {
    let simulation = scene.start()?;
    tell_place(&simulation);
    Ok(simulation)
}

/// Prints the device of a crowd, with `--verbose`, and a note when it runs on the CPU for want of a device: once, however many
/// crowds a command has.
pub(super) fn tell_place(simulation: &Simulation) {
    static FELL_BACK: Once = Once::new();
    detail(&format!("simulating on {}, {} threads", simulation.device(), rayon::current_num_threads()));
    if let Some(reason) = simulation.fallback() {
        FELL_BACK.call_once(|| {
            note(&format!("note: simulating on the CPU, since {reason} (`gaitway devices` says more)"));
        });
    }
}

/// Seconds of simulation, checked.
pub(super) fn check_seconds(name: &str, seconds: f64) -> Result<f64, Error> {
    if (0.0..=86_400.0).contains(&seconds) {
        return Ok(seconds);
    }
    Err(usage(format!("{name} = {seconds}: must be 0 to 86400 seconds"), "a day is the most"))
}

/// A strength of expression on the command line.
pub(super) fn expression(text: &str) -> Result<f64, String> {
    let allowed = 0.0..=MOST_EXPRESSION;
    match text.parse::<f64>() {
        Ok(value) if allowed.contains(&value) => Ok(value),
        _ => Err(format!("must be 0 to {MOST_EXPRESSION}; 1 is as people show it, 2 as actors do")),
    }
}

/// The gaits that crowds walk with: those of a file, or the built-in ones.
pub(super) fn library(path: Option<&Path>) -> Result<GaitLibrary, Error> {
    Ok(match path {
        Some(path) => GaitLibrary::load_glb(path)?,
        None => GaitLibrary::built_in()?,
    })
}
