//! What `simulate`, `render` and `demo` have in common: which crowd, where, on which backend.

use super::avatars::{RigArguments, avatars_of};
use super::output::{detail, note};
use super::preference::PreferenceArguments;
use super::usage;
use crate::Error;
use crate::export::AgentInfo;
use crate::ground::world_from_ground;
use crate::kernels::Store;
use crate::library::GaitLibrary;
use crate::replay::Replay;
use crate::scenario::{
    Condition, Crowd, Geometry, MAX_AGENTS, Scenario, Setting, User, outsider_bodies, populate_from,
};
use crate::sim::{Backend, Cast, Simulation, flow, setup};
use clap::builder::{ArgPredicate, TypedValueParser};
use clap::{Args, ValueEnum, value_parser};
use glam::Vec3;
use std::path::{Path, PathBuf};
use std::str::FromStr;

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
    /// Where to simulate; auto takes the best Vulkan device, or the CPU where there is none and none is named
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
}

impl PlaceArguments {
    /// The backend and device asked for.
    pub(super) fn get(&self) -> Result<(Backend, Option<&str>), Error> {
        let backend = match self.backend {
            BackendName::Auto => Backend::Auto,
            BackendName::Vulkan => Backend::Vulkan,
            BackendName::Cpu => Backend::Cpu,
        };
        if backend == Backend::Cpu && self.device.is_some() {
            return Err(usage(
                "--device names a Vulkan device, but --backend is cpu",
                "leave one of them out",
            ));
        }
        Ok((backend, self.device.as_deref()))
    }
}

/// A crowd ready to be simulated.
#[derive(Debug)]
pub(super) struct Scene {
    pub(super) scenario: Scenario,
    pub(super) geometry: Geometry,
    pub(super) crowd: Crowd,
    pub(super) cast: Cast,
    /// Recorded people among the crowd.
    pub(super) replay: Option<Replay>,
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

impl Scene {
    /// Reads, checks and populates.
    pub(super) fn load(arguments: &SceneArguments) -> Result<Self, Error> {
        Self::load_with(arguments, |_| {})
    }

    /// The same with a last change of the scenario.
    pub(super) fn load_with(
        arguments: &SceneArguments,
        change: impl FnOnce(&mut Scenario),
    ) -> Result<Self, Error> {
        let mut scenario = scenario_of(&arguments.scene, &arguments.set)?;
        if let Some(agents) = arguments.agents {
            scenario.population.agents = agents;
        }
        if let Some(seed) = arguments.seed {
            scenario.seed = seed;
        }
        arguments.preference.apply(&mut scenario);
        check_changed(&scenario)?;
        let is_set = arguments.set.iter().any(|setting| setting.holds("condition"));
        let asked = arguments.condition.map(ConditionName::get).or(is_set.then_some(scenario.condition));
        let library = library_for(arguments.library.as_deref(), &mut scenario, asked)?;
        change(&mut scenario);
        detail(&format!(
            "scene {}: {} agents, seed {}, step {} s; {} gaits to walk with",
            scenario.name,
            scenario.population.agents,
            scenario.seed,
            scenario.navigation.time_step,
            library.gaits().len()
        ));
        let base = Path::new(&arguments.scene).parent();
        let crowd = populate_from(&scenario, &library)?;
        let cast = cast_of(&scenario, &library, base, &arguments.rigs)?;
        Ok(Self { geometry: scenario.geometry(), scenario, crowd, cast, replay: None })
    }

    /// A scene with the people of a recording among its crowd; avatar files are looked for in `base`.
    pub(super) fn with_replay(
        scenario: Scenario,
        library: &GaitLibrary,
        (base, rigs): (Option<&Path>, &RigArguments),
        mut replay: Replay,
    ) -> Result<Self, Error> {
        let mut crowd = populate_from(&scenario, library)?;
        replay.join(&scenario, library, &mut crowd)?;
        let cast = cast_of(&scenario, library, base, rigs)?;
        Ok(Self { geometry: scenario.geometry(), scenario, crowd, cast, replay: Some(replay) })
    }

    /// The eyes of the scene's user (world, m) and their heading, radians. A scene without a user gets an onlooker: agents
    /// look at them as at a user, and nobody walks round them.
    #[cfg_attr(not(feature = "vulkan"), allow(dead_code, reason = "pictures need Vulkan"))]
    pub(super) fn onlooker(&mut self) -> (Vec3, f32) {
        let onlooker = User { avoided: false, ..User::default() };
        let user = *self.scenario.user.get_or_insert(onlooker);
        let geometry = &mut self.geometry;
        let at = geometry.user.unwrap_or_else(|| geometry.place_for_user(user.radius));
        geometry.user = Some(at);
        geometry.user_elevation = geometry.floors.height(at, user.elevation);
        (world_from_ground(at, geometry.user_elevation + user.eye_height), user.heading_deg.to_radians())
    }

    /// Does steps, leading recorded people.
    pub(super) fn step(&self, simulation: &mut Simulation, count: u32) -> Result<(), Error> {
        match &self.replay {
            Some(replay) => replay.step(simulation, count),
            None => simulation.step(count),
        }
    }

    /// What is known of everyone.
    pub(super) fn agents_info(&self) -> Vec<AgentInfo> {
        let recorded = self.replay.as_ref().map(Replay::first_agent);
        AgentInfo::of_crowd(&self.scenario, &self.crowd, &self.cast, recorded)
    }

    /// How many agents there are.
    pub(super) fn agents(&self) -> u32 {
        u32::try_from(self.crowd.agents.len()).unwrap_or(u32::MAX)
    }

    /// The buffers of the start.
    pub(super) fn store(&self) -> Result<Store, Error> {
        let mut store = setup::store(&self.scenario, &self.geometry, &self.crowd, &self.cast);
        flow::equip(&mut store, &self.scenario, &self.geometry, &self.crowd)?;
        if let Some(replay) = &self.replay {
            replay.set_up(&mut store);
        }
        Ok(store)
    }

    /// Steps of `seconds`.
    pub(super) fn steps(&self, seconds: f64) -> u32 {
        let steps = seconds / f64::from(self.scenario.navigation.time_step);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped; NaN gives 0")]
        let steps = steps.round().clamp(0.0, 1e9) as u32;
        steps
    }
}

/// Checks a scenario that was valid before options changed it: what is wrong now is wrong on the command line.
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

/// A simulation where the arguments say; tells when it had to fall back to the CPU.
pub(super) fn start(store: Store, place: &PlaceArguments) -> Result<Simulation, Error> {
    let (backend, device) = place.get()?;
    let simulation = Simulation::from_store(store, backend, device)?;
    detail(&format!("simulating on {}, {} threads", simulation.device(), rayon::current_num_threads()));
    if let Some(reason) = simulation.fallback() {
        note(&format!(
            "note: simulating on the CPU, since {reason} (`gaitway devices` says what is missing)"
        ));
    }
    Ok(simulation)
}

/// Seconds of simulation, checked.
pub(super) fn check_seconds(name: &str, seconds: f64) -> Result<f64, Error> {
    if (0.0..=86_400.0).contains(&seconds) {
        return Ok(seconds);
    }
    Err(usage(format!("{name} = {seconds}: must be 0 to 86400 seconds"), "a day is the most"))
}

/// A scenario by the name of a built-in scene or of a file, with some keys set.
pub(super) fn scenario_of(name: &str, settings: &[Setting]) -> Result<Scenario, Error> {
    let path = Path::new(name);
    let is_file = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if is_file || name.contains(std::path::MAIN_SEPARATOR) {
        return Ok(Scenario::load_with(path, settings)?);
    }
    Ok(Scenario::builtin_with(name, settings)?)
}

/// The gaits that the crowd of a scenario walks with, and its condition: the one asked for, or its own. A library of
/// nothing but unlabelled gaits is walked as the baseline, unless a condition is asked for.
pub(super) fn library_for(
    path: Option<&Path>,
    scenario: &mut Scenario,
    asked: Option<Condition>,
) -> Result<GaitLibrary, Error> {
    let library = library(path)?;
    scenario.condition = asked.unwrap_or(scenario.condition);
    let has_labels = library.counts() != [0; 4] || library.gaits().is_empty();
    if let (Some(path), None, false) = (path, asked, has_labels || scenario.condition == Condition::Baseline)
    {
        scenario.condition = Condition::Baseline;
        let (file, count) = (path.display(), library.gaits().len());
        note(&format!(
            "note: none of the {count} gaits of {file} has a label, so all walk with one of them, as with --condition \
             baseline; for emotions label them: gaitway gait label {file} --out labelled.glb, or import them with a \
             labels.csv beside the captures (columns file, label)"
        ));
    }
    Ok(library)
}

/// The gaits that crowds walk with: those of a file, or the built-in ones.
pub(super) fn library(path: Option<&Path>) -> Result<GaitLibrary, Error> {
    Ok(match path {
        Some(path) => GaitLibrary::load_glb(path)?,
        None => GaitLibrary::built_in()?,
    })
}

/// Everyone who can appear in a scene, people, robots and vehicles; files are looked for in `base`.
fn cast_of(
    scenario: &Scenario,
    library: &GaitLibrary,
    base: Option<&Path>,
    rigs: &RigArguments,
) -> Result<Cast, Error> {
    let outsiders = outsider_bodies(scenario, base)?;
    Ok(Cast::new(library.gaits(), avatars_of(scenario, base, rigs)?)?.with_outsiders(outsiders))
}
