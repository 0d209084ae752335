//! A crowd around the user, until the session ends or the time is up.
//!
//! Two threads. This one steps the crowd at its fixed rate by the clock, on a device of its own, and never waits for the
//! headset. The headset's thread makes all calls of OpenXR. It waits for frames, draws the crowd's newest snapshot on the
//! runtime's device, and starts a new session when the runtime goes away. A runtime that hangs stops the frames, not the
//! crowd.

use super::clock::{StepClock, Watchdog};
use super::headset::Headset;
use super::outcome::Outcome;
use super::plan::Plan;
use super::recording::UserState;
use super::rig::Stand;
use super::shared::{CrowdSnapshot, Shared};
use super::surroundings::Surroundings;
use crate::kernels::Store;
use crate::render::Show;
use crate::scene::Scene;
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;
use crate::stop;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Pause of this thread while no step is due.
const PAUSE: Duration = Duration::from_micros(500);
/// Time that the headset's thread gets to end its session when the crowd has failed.
const FAILED_FAREWELL: Duration = Duration::from_millis(500);

/// The headset's thread and its result.
type HeadsetThread = JoinHandle<Result<Outcome, crate::Error>>;

/// Observes a session.
pub trait Observer {
    /// Takes a line that the user should read.
    fn note(&mut self, line: &str);

    /// Takes a step that was done: the user as the crowd saw them in it, and the crowd after it.
    ///
    /// # Errors
    /// When the observer cannot go on; the session is then ended.
    fn step(&mut self, user: &UserState, crowd: &Store) -> Result<(), crate::Error>;
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
    let time_step = f64::from(simulation.store().step.time_step);
    simulation.make_renewable()?;
    let world = Surroundings::of(scene, simulation.store().clone(), meshes);
    let Stand { position: place, elevation, .. } = world.start;
    let user = UserState { place, elevation, ..UserState::default() };
    let shared = Arc::new(Shared::new(time_step, Show::snapshot(simulation.state()?), user));
    let (seconds, mirror) = (plan.seconds, plan.mirror.clone());
    let headset = spawn(&shared, world, plan)?;
    let (mut clock, mut watchdog) = (StepClock::new(time_step), Watchdog::default());
    let mut crowd = Crowd { simulation, device_losses: 0 };
    while !headset.is_finished() {
        let now = shared.elapsed();
        let messages = shared.take_messages().into_iter();
        messages
            .chain(mirror.as_ref().and_then(|mirror| mirror.take_message()))
            .for_each(|line| observer.note(&line));
        if let Some(line) = watchdog.watch(shared.silence(now), shared.is_calling()) {
            observer.note(line);
        }
        if stop::asked() || seconds.is_some_and(|seconds| now.as_secs_f64() >= seconds) {
            shared.request_stop();
        }
        if shared.stop_requested() && watchdog.gives_up(now) {
            break;
        }
        if clock.begin(now.as_secs_f64()) {
            step(&mut crowd, &shared, &mut clock, observer)?;
        } else {
            thread::sleep(PAUSE);
        }
    }
    shared.take_messages().iter().for_each(|line| observer.note(line));
    let outcome = join(headset, shared.is_calling())?;
    Ok(Outcome {
        steps: clock.steps(),
        seconds: clock.began(),
        time_lost: clock.lost(),
        device_losses: crowd.device_losses,
        ..outcome
    })
}

/// Starts the headset's thread.
fn spawn(shared: &Arc<Shared>, world: Surroundings, plan: Plan) -> Result<HeadsetThread, crate::Error> {
    let shared = shared.clone();
    let thread = thread::Builder::new().name("headset".to_owned());
    thread.spawn(move || Headset::new(&shared, world, plan).run()).map_err(|error| crate::Error::Usage {
        message: format!("no thread for the headset: {error}"),
        hint: "close other programs, then try again".to_owned(),
    })
}

/// The crowd, and how often its device was lost.
struct Crowd<'a> {
    simulation: &'a mut Simulation,
    device_losses: u32,
}

impl Crowd<'_> {
    /// Steps the crowd once around a user. A device that is lost for the first time is opened again, and the crowd takes the
    /// step there.
    fn step(&mut self, user: &UserState, observer: &mut dyn Observer) -> Result<(), crate::Error> {
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

/// Steps the crowd once, around the user as they are now, and hands its snapshot to the headset's thread.
fn step(
    crowd: &mut Crowd<'_>,
    shared: &Shared,
    clock: &mut StepClock,
    observer: &mut dyn Observer,
) -> Result<(), crate::Error> {
    let user = shared.user();
    let stepped = crowd.step(&user, observer);
    let done = stepped.and_then(|()| observer.step(&user, crowd.simulation.state()?));
    if done.is_err() {
        // the headset's thread ends its session, as far as the runtime lets it
        shared.request_stop();
        thread::sleep(FAILED_FAREWELL);
        return done;
    }
    let due = clock.end();
    let store = Arc::new(Show::snapshot(crowd.simulation.state()?));
    let (number, late) = (u64::from(clock.steps()) + 1, (shared.now() - due).max(0.0));
    shared.set_snapshot(CrowdSnapshot { store, number, due, late });
    Ok(())
}

/// What came of the headset's thread. One that hangs, mostly in a call of the runtime, is left behind: only the runtime can
/// end it.
fn join(headset: HeadsetThread, is_calling: bool) -> Result<Outcome, crate::Error> {
    if !headset.is_finished() {
        let silent = if is_calling { "the OpenXR runtime" } else { "the graphics device" };
        let ended = format!("{silent} did not answer any more");
        return Ok(Outcome { hung: true, ended, ..Outcome::default() });
    }
    headset.join().unwrap_or_else(|_| {
        Err(crate::Error::Usage {
            message: "the headset's thread panicked".to_owned(),
            hint: "this is a fault of the program: report it with what stands above".to_owned(),
        })
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_panics_is_an_error_and_one_that_hangs_is_left_behind() {
        let panicked: HeadsetThread = thread::spawn(|| panic!("planted"));
        while !panicked.is_finished() {
            thread::sleep(PAUSE);
        }
        assert!(join(panicked, false).unwrap_err().to_string().contains("panicked"));
        let (release, wait) = std::sync::mpsc::channel::<()>();
        let hangs: HeadsetThread = thread::spawn(move || {
            let _ = wait.recv();
            Ok(Outcome::default())
        });
        let outcome = join(hangs, true).unwrap();
        assert!(outcome.hung && outcome.ended.contains("runtime did not answer"));
        drop(release);
    }
}
