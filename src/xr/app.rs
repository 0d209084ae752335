//! A crowd around the user, until the session ends or the time is up: a stage with one world.

use super::observer::Observer;
use super::outcome::Outcome;
use super::plan::Plan;
use super::stage::Stage;
use super::world::Props;
use crate::scene::Scene;
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;

/// Shows the crowd of a scene on the headset. The simulation and its meshes are those of [`Scene::start_with_bodies`], at
/// its start.
///
/// # Errors
/// When there is no headset at the beginning (unless the plan waits for one), or the crowd fails.
pub fn run(
    simulation: &mut Simulation,
    meshes: MeshBuffers,
    scene: &Scene,
    plan: Plan,
    observer: &mut dyn Observer,
) -> Result<Outcome, crate::Error> {
    let seconds = plan.seconds;
    let props = Props::of(simulation, meshes, scene, plan.quality)?;
    let mut stage = Stage::begin(&props, plan)?;
    let number = props.surroundings.number;
    // the crowd goes on until the headset's thread has ended
    let is_done = |shared: &super::shared::Shared, now: f64| {
        if seconds.is_some_and(|seconds| now >= seconds) {
            shared.request_stop();
        }
        false
    };
    stage.step_until(simulation, number, is_done, observer)?;
    stage.close(observer)
}
