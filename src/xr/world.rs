//! A crowd that is ready to go on stage: in motion for the crowd's thread, and to be drawn for the headset's.

use super::surroundings::Surroundings;
use crate::kernels::Store;
use crate::render::{Quality, Show};
use crate::scene::Scene;
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;
use std::sync::Arc;

/// A crowd with its place, ready for [`super::Stage`]. It can be made on any thread.
#[derive(Debug)]
pub struct World {
    simulation: Simulation,
    pub(super) props: Props,
}

/// The part of a world that the headset shows.
#[derive(Debug, Clone)]
pub(super) struct Props {
    pub(super) surroundings: Arc<Surroundings>,
    /// What frames need of the crowd's first state.
    pub(super) first: Arc<Store>,
    /// Length of a step, s.
    pub(super) time_step: f64,
}

impl World {
    /// Makes the crowd of a scene ready.
    ///
    /// # Errors
    /// As [`Scene::start_with_bodies`], and when the simulation's device fails.
    pub fn new(scene: &Scene) -> Result<Self, crate::Error> {
        let (mut simulation, meshes) = scene.start_with_bodies()?;
        let props = Props::of(&mut simulation, meshes, scene, Quality::Low)?;
        Ok(Self { simulation, props })
    }

    /// The crowd.
    pub const fn simulation(&mut self) -> &mut Simulation {
        &mut self.simulation
    }
}

impl Props {
    /// Of a simulation at its start, and its meshes.
    pub(super) fn of(
        simulation: &mut Simulation,
        meshes: MeshBuffers,
        scene: &Scene,
        quality: Quality,
    ) -> Result<Self, crate::Error> {
        simulation.make_renewable()?;
        let surroundings = Arc::new(Surroundings::of(scene, simulation.store().clone(), meshes, quality));
        let first = Arc::new(Show::snapshot(simulation.state()?));
        Ok(Self { surroundings, first, time_step: f64::from(simulation.store().step.time_step) })
    }
}

/// The number that names the surroundings of a world among all of this program.
pub(super) fn next_number() -> u64 {
    use std::sync::atomic::{AtomicU64, Ordering};
    static NUMBERS: AtomicU64 = AtomicU64::new(1);
    NUMBERS.fetch_add(1, Ordering::Relaxed)
}
