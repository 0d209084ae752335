//! Who watches a session, and the crowd that it watches.

use super::recording::UserState;
use crate::kernels::Store;
use crate::sim::Simulation;

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
