//! What can be chosen before a crowd starts.

use super::Scene;
use super::avatars::avatars_of;
use crate::gait::Gait;
use crate::gait::walker::EXPRESSION;
use crate::library::GaitLibrary;
use crate::replay::Replay;
use crate::scenario::{Condition, Scenario, Setting, external_bodies, place_model, populate_from};
use crate::sim::{AvatarSet, Backend, Simulation};
use std::path::{Path, PathBuf};

/// A scene that is being put together: each method changes one choice, [`Self::build`] or [`Self::start`] makes it.
///
/// ```no_run
/// use gaitway::library::GaitLibrary;
/// use gaitway::scenario::Condition;
/// use gaitway::scene::Scene;
///
/// # fn main() -> gaitway::Result<()> {
/// let library = GaitLibrary::load_glb("mine.glb")?;
/// let scene = Scene::load("hall.toml")?
///     .agents(500)
///     .condition(Condition::EvaG)
///     .library(library)
///     .change(|scenario| scenario.navigation.patience = 1.0)
///     .build()?;
/// assert_eq!(scene.agents(), 500);
/// # Ok(())
/// # }
/// ```
#[derive(Debug, Clone)]
pub struct SceneBuilder {
    scenario: Scenario,
    folder: Option<PathBuf>,
    condition: Option<Condition>,
    library: Option<GaitLibrary>,
    rig_maps: Vec<PathBuf>,
    replay: Option<Replay>,
    backend: Backend,
    device: Option<String>,
    gives_way: bool,
}

impl SceneBuilder {
    pub(super) fn new(scenario: Scenario) -> Self {
        Self {
            scenario,
            folder: None,
            condition: None,
            library: None,
            rig_maps: Vec::new(),
            replay: None,
            backend: Backend::default(),
            device: None,
            gives_way: false,
        }
    }

    /// As [`Scene::load`], with some keys of the scenario set.
    ///
    /// # Errors
    /// As [`Scene::load`], or if a key does not exist or its value is wrong.
    pub fn load(name: &str, settings: &[Setting]) -> Result<Self, crate::Error> {
        let path = Path::new(name);
        let is_file = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        let scenario = if is_file || name.contains(std::path::MAIN_SEPARATOR) {
            Scenario::load_with(path, settings)?
        } else {
            Scenario::builtin_with(name, settings)?
        };
        Ok(Self::of_settings(scenario, settings).folder(path.parent()))
    }

    /// The same from a text, which messages call `origin`; files that it names are looked for in `folder`.
    pub(crate) fn parse(
        text: &str,
        origin: &str,
        settings: &[Setting],
        folder: Option<&Path>,
    ) -> Result<Self, crate::Error> {
        let scenario = Scenario::parse_beside(text, origin, settings, folder)?;
        Ok(Self::of_settings(scenario, settings).folder(folder))
    }

    /// A scene of a scenario that has these settings.
    fn of_settings(scenario: Scenario, settings: &[Setting]) -> Self {
        let is_set = settings.iter().any(|setting| setting.holds("condition"));
        Self { condition: is_set.then_some(scenario.condition), ..Self::new(scenario) }
    }

    /// The scenario as it stands.
    pub const fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// The gaits that will be walked with: the library's, or the built-in ones.
    ///
    /// # Errors
    /// When the built-in gaits cannot be read.
    pub fn gaits(&self) -> Result<Vec<Gait>, crate::Error> {
        Ok(self.walked()?.gaits().to_vec())
    }

    /// The chosen library, or the built-in people, as expressive as the scenario says.
    #[allow(clippy::float_cmp, reason = "asks whether anything was set")]
    fn walked(&self) -> Result<GaitLibrary, crate::Error> {
        let expression = f64::from(self.scenario.population.expression);
        Ok(match &self.library {
            Some(library) => library.clone(),
            None if expression == EXPRESSION => GaitLibrary::built_in()?,
            None => GaitLibrary::expressed(expression)?,
        })
    }

    /// How many people; built-in places grow with them.
    #[must_use]
    pub const fn agents(mut self, agents: u32) -> Self {
        self.scenario.population.agents = agents;
        self
    }

    /// The seed of every random draw.
    #[must_use]
    pub const fn seed(mut self, seed: u64) -> Self {
        self.scenario.seed = seed;
        self
    }

    /// Which of the paper's three algorithms moves the agents.
    #[must_use]
    pub const fn condition(mut self, condition: Condition) -> Self {
        self.condition = Some(condition);
        self
    }

    /// The gaits to walk with, instead of the built-in ones.
    #[must_use]
    pub fn library(mut self, library: GaitLibrary) -> Self {
        self.library = Some(library);
        self
    }

    /// The folder in which avatar files are looked for, instead of the scenario's own.
    #[must_use]
    pub fn folder(mut self, folder: Option<&Path>) -> Self {
        self.folder = folder.map(Path::to_owned);
        self
    }

    /// Files that name the joints of avatars whose rig is not recognised.
    #[must_use]
    pub fn rig_maps(mut self, files: &[PathBuf]) -> Self {
        self.rig_maps = files.to_vec();
        self
    }

    /// Recorded people among the crowd.
    #[must_use]
    pub fn replay(mut self, replay: Replay) -> Self {
        self.replay = Some(replay);
        self
    }

    /// Any other change of the scenario.
    #[must_use]
    pub fn change(mut self, change: impl FnOnce(&mut Scenario)) -> Self {
        change(&mut self.scenario);
        self
    }

    /// Where to simulate.
    #[must_use]
    pub const fn backend(mut self, backend: Backend) -> Self {
        self.backend = backend;
        self
    }

    /// The Vulkan device, by a part of its name or by its number.
    #[must_use]
    pub fn device(mut self, device: Option<&str>) -> Self {
        self.device = device.map(str::to_owned);
        self
    }

    /// Lets the simulation's work on a GPU give way to that of others, such as the frames of a headset: it has a lower priority
    /// where the driver has priorities.
    #[must_use]
    pub const fn gives_way(mut self) -> Self {
        self.gives_way = true;
        self
    }

    /// The scene, checked and populated.
    ///
    /// A library of nothing but unlabelled gaits is walked as the baseline, unless a condition is chosen.
    ///
    /// # Errors
    /// [`crate::scenario::Error`] with key, value and range for what is wrong in the scenario or does not fit its place;
    /// [`super::Error`] for avatars and rig maps that do not exist; when a gait cannot drive an avatar.
    pub fn build(self) -> Result<Scene, crate::Error> {
        self.scenario.validate()?;
        let is_own = self.library.is_some();
        let library = self.walked()?;
        let Self { mut scenario, folder, condition, rig_maps, mut replay, .. } = self;
        let (backend, device, gives_way) = (self.backend, self.device, self.gives_way);
        scenario.condition = condition.unwrap_or(scenario.condition);
        let has_labels = library.counts() != [0; 4] || library.gaits().is_empty();
        let is_unlabelled =
            is_own && condition.is_none() && !has_labels && scenario.condition != Condition::Baseline;
        if is_unlabelled {
            scenario.condition = Condition::Baseline;
        }
        // a baseline has one gait for all, and the people of a library are themselves
        let is_varied = !is_own && scenario.condition != Condition::Baseline;
        scenario.population.individuals.get_or_insert(if is_varied { 1.0 } else { 0.0 });
        let mut crowd = populate_from(&scenario, &library)?;
        if let Some(replay) = &mut replay {
            replay.join(&scenario, &library, &mut crowd)?;
        }
        let folder = folder.as_deref();
        let outsiders = external_bodies(&scenario, folder)?;
        let avatars = avatars_of(&scenario, folder, &rig_maps)?;
        let cast = AvatarSet::new(library.gaits(), avatars)?.with_outsiders(outsiders);
        let mut geometry = scenario.geometry();
        geometry.place = place_model(&scenario, folder)?;
        Ok(Scene { scenario, geometry, crowd, cast, replay, backend, device, gives_way, is_unlabelled })
    }

    /// The crowd in motion.
    ///
    /// # Errors
    /// As [`Self::build`] and [`Scene::start`].
    pub fn start(self) -> Result<Simulation, crate::Error> {
        self.build()?.start()
    }
}
