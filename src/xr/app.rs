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
    let world = Surroundings::of(scene, simulation.store().clone(), meshes);
    let Stand { position: place, elevation, .. } = world.start;
    let user = UserState { place, elevation, ..UserState::default() };
    let shared = Arc::new(Shared::new(time_step, Show::snapshot(simulation.state()?), user));
    let (seconds, mirror) = (plan.seconds, plan.mirror.clone());
    let headset = spawn(&shared, world, plan)?;
    let (mut clock, mut watchdog) = (StepClock::new(time_step), Watchdog::default());
    while !headset.is_finished() {
        let now = shared.elapsed();
        let messages = shared.take_messages().into_iter();
        messages
            .chain(mirror.as_ref().and_then(|mirror| mirror.take_message()))
            .for_each(|line| observer.note(&line));
        if let Some(line) = watchdog.watch(shared.silence(now)) {
            observer.note(line);
        }
        if stop::asked() || seconds.is_some_and(|seconds| now.as_secs_f64() >= seconds) {
            shared.request_stop();
        }
        if shared.stop_requested() && watchdog.gives_up(now) {
            break;
        }
        if clock.begin(now.as_secs_f64()) {
            step(simulation, &shared, &mut clock, observer)?;
        } else {
            thread::sleep(PAUSE);
        }
    }
    shared.take_messages().iter().for_each(|line| observer.note(line));
    let outcome = join(headset)?;
    Ok(Outcome { steps: clock.steps(), seconds: clock.began(), time_lost: clock.lost(), ..outcome })
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

/// Steps the crowd once, around the user as they are now, and hands its snapshot to the headset's thread.
fn step(
    simulation: &mut Simulation,
    shared: &Shared,
    clock: &mut StepClock,
    observer: &mut dyn Observer,
) -> Result<(), crate::Error> {
    let user = shared.user();
    simulation.set_user(user.place, user.elevation, user.velocity);
    let done = simulation.step(1).and_then(|()| observer.step(&user, simulation.state()?));
    if done.is_err() {
        // the headset's thread ends its session, as far as the runtime lets it
        shared.request_stop();
        thread::sleep(FAILED_FAREWELL);
        return done;
    }
    let due = clock.end();
    let store = Arc::new(Show::snapshot(simulation.state()?));
    let (number, late) = (u64::from(clock.steps()) + 1, (shared.now() - due).max(0.0));
    shared.set_snapshot(CrowdSnapshot { store, number, due, late });
    Ok(())
}

/// What came of the headset's thread. One that hangs in a call of the runtime is left behind: only the runtime can end it.
fn join(headset: HeadsetThread) -> Result<Outcome, crate::Error> {
    if !headset.is_finished() {
        let ended = "the OpenXR runtime did not answer any more".to_owned();
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
        assert!(join(panicked).unwrap_err().to_string().contains("panicked"));
        let (release, wait) = std::sync::mpsc::channel::<()>();
        let hangs: HeadsetThread = thread::spawn(move || {
            let _ = wait.recv();
            Ok(Outcome::default())
        });
        let outcome = join(hangs).unwrap();
        assert!(outcome.hung && outcome.ended.contains("did not answer"));
        drop(release);
    }
}
