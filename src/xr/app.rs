//! A crowd around the user, until the session ends or the time is up: a stage with one world.

use super::outcome::Outcome;
use super::plan::Plan;
use super::recording::UserState;
use super::stage::Stage;
use super::world::Props;
use crate::kernels::Store;
use crate::scene::Scene;
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;

/// Observes a session.
pub trait Observer {
    /// Takes a line that the user should read.
    fn note(&mut self, line: &str);

    /// Takes a step that was done: the user as the crowd saw them in it, and the crowd after it.
    ///
    /// # Errors
    /// When the observer cannot go on; the session is then ended.
    fn step(&mut self, user: &UserState, crowd: &Store) -> Result<(), crate::Error> {
        let _ = (user, crowd);
        Ok(())
    }

    /// Whether what is going on is to end now: a walk, a panel, a wait. The session goes on. Asked often.
    fn is_cut(&mut self) -> bool {
        false
    }
}

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
    let props = Props::of(simulation, meshes, scene)?;
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

/// The crowd, and how often its device was lost.
pub(super) struct Crowd<'a> {
    pub(super) simulation: &'a mut Simulation,
    pub(super) device_losses: u32,
}

impl Crowd<'_> {
    /// Steps the crowd once around a user. A device that is lost for the first time is opened again, and the crowd takes the
    /// step there.
    pub(super) fn step(&mut self, user: &UserState, observer: &mut dyn Observer) -> Result<(), crate::Error> {
        match self.step_once(user) {
            Err(crate::Error::Gpu(error)) if error.is_device_lost() && self.device_losses == 0 => {
                self.device_losses += 1;
                observer.note(&format!("the crowd's device is opened again: {error}"));
                self.simulation.renew()?;
                self.step_once(user)
            }
            stepped => stepped,
        }
    }

    /// Steps the crowd once, and reads its state.
    fn step_once(&mut self, user: &UserState) -> Result<(), crate::Error> {
        let Self { simulation, .. } = self;
        simulation.set_user(user.place, user.elevation, user.velocity);
        simulation.step(1)?;
        simulation.state().map(drop)
    }
}
