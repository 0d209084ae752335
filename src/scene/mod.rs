//! The one assembly: a scenario, gaits, avatars and recordings become a crowd that is ready to simulate, a [`Scene`];
//! drawn, it is a `Stage`.
//!
//! ```
//! use gaitway::scene::Scene;
//! use gaitway::sim::Backend;
//!
//! # fn main() -> gaitway::Result<()> {
//! let mut simulation = Scene::load("crossing")?.agents(50).seed(7).backend(Backend::Cpu).start()?;
//! simulation.step(30)?; // one second
//! for person in simulation.people()?.filter(|person| person.emotion() == gaitway::Emotion::Sad) {
//!     println!("{} at {} m walks {:.2} m/s", person.id, person.position, person.velocity.length());
//! }
//! # Ok(())
//! # }
//! ```

mod avatars;
mod builder;
mod error;
#[cfg(test)]
mod measured;
#[cfg(feature = "vulkan")]
#[allow(clippy::disallowed_methods, reason = "shows crowds, makes none")]
mod stage;

pub use builder::SceneBuilder;
pub use error::Error;
#[cfg(feature = "vulkan")]
pub use stage::{CameraChoice, CameraChoiceError, Stage, atmosphere};

use crate::export::AgentInfo;
use crate::gait::walker::EXPRESSION;
use crate::ground::world_from_ground;
use crate::kernels::Store;
use crate::replay::Replay;
use crate::scenario::{Condition, Crowd, Geometry, Scenario, User};
use crate::sim::bodies::{self, MeshBuffers};
use crate::sim::flow::{self, Ways};
use crate::sim::{AvatarSet, Backend, Islands, Simulation, setup};
use glam::Vec3;

/// A crowd that is ready to be simulated.
#[derive(Debug, Clone)]
pub struct Scene {
    /// The scenario, with all that was chosen.
    pub scenario: Scenario,
    /// Its place.
    pub geometry: Geometry,
    /// Its people at their start.
    pub crowd: Crowd,
    /// Their bodies and walks.
    pub cast: AvatarSet,
    /// Recorded people among the crowd.
    pub replay: Option<Replay>,
    /// Where it is simulated.
    pub backend: Backend,
    /// The Vulkan device, by a part of its name or by its number; none: `GAITWAY_DEVICE`, or the best.
    pub device: Option<String>,
    /// Whether the simulation's work on a GPU gives way to that of others: [`SceneBuilder::gives_way`].
    pub gives_way: bool,
    /// Whether the chosen library has no label, so that all walk as the baseline.
    pub is_unlabelled: bool,
}

/// The buffers of a crowd at its start.
pub(crate) struct Start {
    pub(crate) store: Store,
    pub(crate) ways: Ways,
}

impl Scene {
    /// Begins a scene from the name of a built-in one (`crossing`, `garden`, `parking`, `scifi`) or a scenario file.
    ///
    /// # Errors
    /// [`crate::scenario::Error`] if there is no such scene, or the file cannot be read or is wrong.
    pub fn load(name: &str) -> Result<SceneBuilder, crate::Error> {
        SceneBuilder::load(name, &[])
    }

    /// Begins a scene from a scenario.
    pub fn of(scenario: Scenario) -> SceneBuilder {
        SceneBuilder::new(scenario)
    }

    /// A scene of people placed by hand.
    pub fn of_crowd(scenario: Scenario, crowd: Crowd, cast: AvatarSet) -> Self {
        Self {
            geometry: scenario.geometry(),
            scenario,
            crowd,
            cast,
            replay: None,
            backend: Backend::default(),
            device: None,
            gives_way: false,
            is_unlabelled: false,
        }
    }

    /// The same, simulated on another backend or device.
    #[must_use]
    pub fn on(self, backend: Backend, device: Option<&str>) -> Self {
        Self { backend, device: device.map(str::to_owned), ..self }
    }

    /// The crowd in motion, without bodies to draw.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used, or a goal lies where no agent can stand ([`flow::equip`]).
    pub fn start(&self) -> Result<Simulation, crate::Error> {
        self.simulate(self.buffers()?)
    }

    /// The crowd in motion on the device of another crowd, without bodies to draw: this scene's own choice of a device is not
    /// asked. What the other one has compiled is not compiled again.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_beside(&self, other: &Simulation) -> Result<Simulation, crate::Error> {
        let start = self.buffers()?;
        Ok(self.introduce(other.beside(start.store)?, start.ways))
    }

    /// The crowd in motion among islands, on the device of those that are there. Returns it; it is the last of them.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_in<'a>(&self, islands: &'a mut Islands) -> Result<&'a mut Simulation, crate::Error> {
        let crowd = match islands.crowds().first() {
            Some(first) => self.start_beside(first)?,
            None => self.start()?,
        };
        Ok(islands.add(crowd))
    }

    /// The crowd in motion with its bodies, and their meshes.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn start_with_bodies(&self) -> Result<(Simulation, MeshBuffers), crate::Error> {
        let (start, meshes) = self.buffers_with_bodies()?;
        Ok((self.simulate(start)?, meshes))
    }

    fn simulate(&self, start: Start) -> Result<Simulation, crate::Error> {
        let Self { backend, device, gives_way, .. } = self;
        let simulation = Simulation::from_store_beside(start.store, *backend, device.as_deref(), *gives_way)?;
        Ok(self.introduce(simulation, start.ways))
    }

    /// Gives a simulation of this crowd its ways and the emotion of each person.
    pub(crate) fn introduce(&self, simulation: Simulation, ways: Ways) -> Simulation {
        let agents = self.crowd.agents.iter().chain(&self.crowd.external);
        simulation.knowing(ways, agents.map(|agent| agent.emotion).collect())
    }

    /// The buffers of the start, without bodies.
    pub(crate) fn buffers(&self) -> Result<Start, crate::Error> {
        let mut store = setup::store(&self.scenario, &self.geometry, &self.crowd, &self.cast);
        let ways = flow::equip(&mut store, &self.scenario, &self.geometry, &self.crowd)?;
        if let Some(replay) = &self.replay {
            replay.set_up(&mut store);
        }
        Ok(Start { store, ways })
    }

    /// The buffers of the start with bodies, and their meshes.
    pub(crate) fn buffers_with_bodies(&self) -> Result<(Start, MeshBuffers), crate::Error> {
        let mut start = self.buffers()?;
        let meshes = bodies::fill(&mut start.store, &self.cast, bodies::SMALLEST_STORAGE_RANGE);
        start.store.frame.individuals = self.scenario.population.individuals.unwrap_or(0.0);
        start.store.frame.expression = expression_of_faces(&self.scenario);
        Ok((start, meshes))
    }

    /// The eyes of the scene's user (world, m) and their heading, radians. A scene without a user gets an onlooker: agents
    /// look at them as at a user, and do not avoid them.
    pub fn onlooker(&mut self) -> (Vec3, f32) {
        let onlooker = User { avoided: false, ..User::default() };
        let user = *self.scenario.user.get_or_insert(onlooker);
        let geometry = &mut self.geometry;
        let at = geometry.user.unwrap_or_else(|| geometry.place_for_user(user.radius));
        geometry.user = Some(at);
        geometry.user_elevation = geometry.floors.height(at, user.elevation);
        (world_from_ground(at, geometry.user_elevation + user.eye_height), user.heading_deg.to_radians())
    }

    /// Does steps of a simulation of this scene, leading recorded people.
    ///
    /// # Errors
    /// When the simulation fails.
    pub fn step(&self, simulation: &mut Simulation, count: u32) -> Result<(), crate::Error> {
        match &self.replay {
            Some(replay) => replay.step(simulation, count),
            None => simulation.step(count),
        }
    }

    /// What is known of each agent.
    pub fn agents_info(&self) -> Vec<AgentInfo> {
        let recorded = self.replay.as_ref().map(Replay::first_agent);
        AgentInfo::of_crowd(&self.scenario, &self.crowd, &self.cast, recorded)
    }

    /// How many people there are, without robots and vehicles.
    pub fn agents(&self) -> u32 {
        u32::try_from(self.crowd.agents.len()).unwrap_or(u32::MAX)
    }

    /// Steps of the simulation in `seconds`.
    pub fn steps(&self, seconds: f64) -> u32 {
        let steps = seconds / f64::from(self.scenario.navigation.time_step);
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped; NaN gives 0")]
        let steps = steps.round().clamp(0.0, 1e9) as u32;
        steps
    }
}

/// How far the faces of a scene go: as its generated gaits do, which at [`EXPRESSION`] are those of actors. A baseline shows no
/// emotion, and faces may be kept at rest.
fn expression_of_faces(scenario: &Scenario) -> f32 {
    #[allow(clippy::cast_possible_truncation, reason = "2")]
    let of_actors = EXPRESSION as f32;
    let population = &scenario.population;
    if scenario.condition == Condition::Baseline || population.faces == Some(false) {
        return 0.0;
    }
    population.expression / of_actors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_at_rest_in_a_baseline_and_where_they_are_to_be() {
        let of = |condition, faces, expression| {
            let mut scenario = Scenario { condition, ..Scenario::default() };
            (scenario.population.faces, scenario.population.expression) = (faces, expression);
            expression_of_faces(&scenario).to_bits()
        };
        for faces in [None, Some(true)] {
            assert_eq!(
                [1.0, 2.0, 3.0].map(|x| of(Condition::EvaG, faces, x)),
                [0.5_f32, 1.0, 1.5].map(f32::to_bits)
            );
            assert_eq!(of(Condition::Baseline, faces, 2.0), 0);
        }
        assert_eq!(of(Condition::EvaG, Some(false), 2.0), 0);
    }
}
