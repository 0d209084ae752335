//! One session with the headset for a sequence of worlds and panels.
//!
//! The caller's thread steps the crowd of the world that is seen, and never waits for the headset. The headset's thread
//! makes all calls of OpenXR, from the first world to the last: it draws frames, and makes the next world ready beside them. A
//! runtime that goes away is looked for again, and the same is shown again.

use super::clock::{StepClock, Watchdog};
use super::cues::FrameCount;
use super::failure::{no_thread, panicked};
use super::headset::Headset;
use super::mirror::Mirror;
use super::observer::{Crowd, Observer};
use super::outcome::Outcome;
use super::panel::Panel;
use super::panel::picture::Lettering;
use super::plan::Plan;
use super::question::{Answered, Question};
use super::shared::{CrowdSnapshot, Shared, user_at};
use super::world::{Props, World, next_number};
use crate::render::Show;
use crate::sim::Simulation;
use crate::stop;
use std::sync::Arc;
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Pause of the caller's thread while nothing is due.
const PAUSE: Duration = Duration::from_micros(500);
/// Time that the headset's thread gets to end its session when the crowd has failed.
const FAILED_FAREWELL: Duration = Duration::from_millis(500);

/// The headset's thread and its result.
pub(super) type HeadsetThread = JoinHandle<Result<Outcome, crate::Error>>;

/// A session with the headset, in which one world after the other is shown.
///
/// ```no_run
/// use gaitway::scene::Scene;
/// use gaitway::xr::{Observer, Plan, Stage, World};
///
/// # struct Printer;
/// # impl Observer for Printer {
/// #     fn note(&mut self, line: &str) {
/// #         eprintln!("{line}");
/// #     }
/// # }
/// # fn main() -> gaitway::Result<()> {
/// let mut garden = World::new(&Scene::load("garden")?.build()?)?;
/// let mut stage = Stage::open(&garden, Plan::default())?;
/// // the next one is made on another thread while people walk in the first
/// let next = std::thread::spawn(|| World::new(&Scene::load("crossing")?.build()?));
/// stage.walk(&mut garden, 45.0, &mut Printer)?;
/// let mut crossing = next.join().expect("a thread that does not panic")?;
/// stage.show(&crossing, &mut Printer)?;
/// stage.walk(&mut crossing, 45.0, &mut Printer)?;
/// println!("{}", stage.close(&mut Printer)?.ended);
/// # Ok(())
/// # }
/// ```
pub struct Stage {
    pub(super) shared: Arc<Shared>,
    /// None once it was joined.
    headset: Option<HeadsetThread>,
    mirror: Option<Arc<Mirror>>,
    watchdog: Watchdog,
    /// Number of the newest snapshot, through all worlds.
    number: u64,
    lettering: Lettering,
    sums: Sums,
}

impl std::fmt::Debug for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Stage").field("sums", &self.sums).finish_non_exhaustive()
    }
}

/// What all walks of a stage come to.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    steps: u32,
    seconds: f64,
    time_lost: f64,
    device_losses: u32,
}

/// What a walk came to.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Walked {
    /// Whether it lasted as long as it should: the session goes on, and the observer has not cut it.
    pub is_whole: bool,
    /// Steps of the crowd.
    pub steps: u32,
    /// When the last step began, s after the beginning.
    pub seconds: f64,
    /// Time that the crowd was not stepped for because its steps took too long, s.
    pub time_lost: f64,
    /// The frames meanwhile.
    pub frames: FrameCount,
}

impl Stage {
    /// Begins a session that shows a world.
    ///
    /// # Errors
    /// When the headset's thread cannot be started. [`Stage::close`] says what keeps the session from beginning.
    pub fn open(world: &World, plan: Plan) -> Result<Self, crate::Error> {
        Self::begin(&world.props, plan)
    }

    pub(super) fn begin(props: &Props, plan: Plan) -> Result<Self, crate::Error> {
        let Props { surroundings, first, time_step } = props;
        let (world, store) = (surroundings.number, first.clone());
        let first = CrowdSnapshot { store, world, number: 1, step: *time_step, due: 0.0, late: 0.0 };
        let shared = Arc::new(Shared::new(first, user_at(surroundings.start)));
        let mirror = plan.mirror.clone();
        let headset = spawn(&shared, surroundings.clone(), plan)?;
        Ok(Self {
            shared,
            headset: Some(headset),
            mirror,
            watchdog: Watchdog::default(),
            number: 1,
            lettering: Lettering::default(),
            sums: Sums::default(),
        })
    }

    /// Has a world made ready beside the frames, so that [`Stage::show`] takes less than a second. One world at a time.
    pub fn prepare(&mut self, world: &World) {
        let next = world.props.surroundings.clone();
        self.shared.cue(|cues| cues.next = Some(next));
    }

    /// Whether a world that was [prepared](Self::prepare) is ready, so that it can be seen at once.
    pub fn is_ready(&self, world: &World) -> bool {
        self.shared.report(|report| report.ready == world.props.surroundings.number)
    }

    /// Shows another world, and waits until it is seen; the user stands where it has them begin, and faces as it says. Until
    /// then the world before is seen, at rest. False: the session is over.
    ///
    /// # Errors
    /// When the observer fails.
    pub fn show(&mut self, world: &World, observer: &mut dyn Observer) -> Result<bool, crate::Error> {
        let Props { surroundings, first, time_step } = &world.props;
        let number = surroundings.number;
        self.prepare(world);
        self.number += 1;
        self.shared.set_snapshot(CrowdSnapshot {
            store: first.clone(),
            world: number,
            number: self.number,
            step: *time_step,
            due: self.shared.now(),
            late: 0.0,
        });
        self.shared.cue(|cues| cues.on_stage = number);
        let is_seen = self.wait(observer, |stage| stage.shared.report(|report| report.on_stage == number));
        self.clear();
        Ok(is_seen)
    }

    /// Covers everything with grey, 0 not at all to 1, from now on in about a third of a second; frames and crowd go on.
    pub fn fade(&mut self, to: f32) {
        self.shared.cue(|cues| (cues.fade, cues.fades_at_once) = (to.clamp(0.0, 1.0), false));
    }

    /// Covers everything with grey in the next frame.
    pub fn blank(&mut self) {
        self.shared.cue(|cues| (cues.fade, cues.fades_at_once) = (1.0, true));
    }

    /// Has the crowd of the world that is seen walk for so many seconds. A time of 0 is one without a step.
    ///
    /// # Errors
    /// When the crowd or the observer fails.
    pub fn walk(
        &mut self,
        world: &mut World,
        seconds: f64,
        observer: &mut dyn Observer,
    ) -> Result<Walked, crate::Error> {
        self.clear();
        let number = world.props.surroundings.number;
        self.step_until(world.simulation(), number, |_, now| now >= seconds, observer)
    }

    /// Has a panel stand in the room and waits for its answer. The crowd stands meanwhile; the panel stays until the next
    /// one, which stands at the same place, or until [`Stage::clear`], [`Stage::walk`] or [`Stage::show`]. None: the session is
    /// over, or the observer has cut it.
    ///
    /// # Errors
    /// When the panel cannot be shown: [`PanelError`](super::PanelError).
    pub fn ask(
        &mut self,
        panel: &Panel,
        observer: &mut dyn Observer,
    ) -> Result<Option<Answered>, crate::Error> {
        let number = self.put_up(panel)?;
        let answer = |stage: &Self| {
            let answer = stage.shared.report(|report| report.answer);
            answer.filter(|(of, _)| *of == number).map(|(_, answer)| answer)
        };
        self.wait(observer, |stage| answer(stage).is_some());
        Ok(answer(self))
    }

    /// Has a panel stand in the room, and does not wait.
    ///
    /// # Errors
    /// As [`Stage::ask`].
    pub fn tell(&mut self, panel: &Panel) -> Result<(), crate::Error> {
        self.put_up(panel).map(drop)
    }

    /// Has a panel stand in the room; its number.
    fn put_up(&mut self, panel: &Panel) -> Result<u64, crate::Error> {
        panel.check().map_err(super::Error::from)?;
        let question = Arc::new(Question {
            number: next_number(),
            targets: panel.targets().into_iter().map(|(choice, _)| choice).collect(),
            picture: self.lettering.panel(panel),
            panel: panel.clone(),
        });
        let number = question.number;
        self.shared.cue(|cues| cues.question = Some(question));
        Ok(number)
    }

    /// Takes the panel away.
    pub fn clear(&mut self) {
        self.shared.cue(|cues| cues.question = None);
    }

    /// Waits for so many seconds in which the crowd stands. False: the session is over, or the observer has cut it.
    pub fn rest(&mut self, seconds: f64, observer: &mut dyn Observer) -> bool {
        let end = self.shared.now() + seconds;
        self.wait(observer, |stage| stage.shared.now() >= end)
    }

    /// Whether the session is over: the runtime has ended it, it failed, or the program was asked to end.
    pub fn is_over(&self) -> bool {
        self.shared.stop_requested() || self.headset.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Ends the session in good order.
    ///
    /// # Errors
    /// What ended the session, if it was no good end: there is no headset (unless the plan waits for one), or ours.
    pub fn close(mut self, observer: &mut dyn Observer) -> Result<Outcome, crate::Error> {
        self.shared.request_stop();
        while self.attend(observer) {
            thread::sleep(PAUSE);
        }
        self.joined(observer)
    }

    /// The outcome of the headset's thread, which has ended or is given up.
    fn joined(mut self, observer: &mut dyn Observer) -> Result<Outcome, crate::Error> {
        self.shared.take_messages().iter().for_each(|line| observer.note(line));
        let Some(headset) = self.headset.take() else { return Ok(Outcome::default()) };
        let outcome = join(headset, self.shared.is_calling())?;
        let Sums { steps, seconds, time_lost, device_losses } = self.sums;
        Ok(Outcome { steps, seconds, time_lost, device_losses, ..outcome })
    }

    /// Looks after the headset's thread. False once it has ended, or is given up.
    pub(super) fn attend(&mut self, observer: &mut dyn Observer) -> bool {
        let now = self.shared.elapsed();
        let messages = self.shared.take_messages().into_iter();
        let of_mirror = self.mirror.as_ref().and_then(|mirror| mirror.take_message());
        messages.chain(of_mirror).for_each(|line| observer.note(&line));
        if let Some(line) = self.watchdog.watch(self.shared.silence(now), self.shared.is_calling()) {
            observer.note(line);
        }
        if stop::asked() {
            self.shared.request_stop();
        }
        let is_given_up = self.shared.stop_requested() && self.watchdog.gives_up(now);
        !is_given_up && self.headset.as_ref().is_some_and(|headset| !headset.is_finished())
    }

    /// Waits for something. False: the session is over, or the observer has cut it.
    pub(super) fn wait(&mut self, observer: &mut dyn Observer, is_there: impl Fn(&Self) -> bool) -> bool {
        while self.attend(observer) && !self.is_over() && !observer.is_cut() {
            if is_there(self) {
                return true;
            }
            thread::sleep(PAUSE);
        }
        false
    }

    /// Steps a crowd by the clock until `is_done` says so at some seconds after the beginning, or the headset's thread ends.
    pub(super) fn step_until(
        &mut self,
        simulation: &mut Simulation,
        world: u64,
        is_done: impl Fn(&Shared, f64) -> bool,
        observer: &mut dyn Observer,
    ) -> Result<Walked, crate::Error> {
        let step = f64::from(simulation.store().step.time_step);
        let (mut clock, begin) = (StepClock::new(step), self.shared.now());
        let before = self.shared.report(|report| {
            report.frames.longest_ms = 0.0;
            report.frames
        });
        let mut crowd = Crowd { simulation, device_losses: 0 };
        let mut is_whole = false;
        while self.attend(observer) && !is_whole && !observer.is_cut() {
            let now = self.shared.now() - begin;
            is_whole = is_done(&self.shared, now);
            if !is_whole && clock.begin(now) {
                self.step(&mut crowd, observer)?;
                let due = begin + clock.end();
                self.number += 1;
                self.shared.set_snapshot(CrowdSnapshot {
                    store: Arc::new(Show::snapshot(crowd.simulation.state()?)),
                    world,
                    number: self.number,
                    step,
                    due,
                    late: (self.shared.now() - due).max(0.0),
                });
            } else {
                thread::sleep(PAUSE);
            }
        }
        let frames = self.shared.report(|report| report.frames.since(before));
        self.sums.steps += clock.steps();
        self.sums.seconds += clock.began();
        self.sums.time_lost += clock.lost();
        self.sums.device_losses += crowd.device_losses;
        let (steps, seconds, time_lost) = (clock.steps(), clock.began(), clock.lost());
        Ok(Walked { is_whole, steps, seconds, time_lost, frames })
    }

    /// Steps the crowd once, around the user as they are now.
    fn step(&self, crowd: &mut Crowd<'_>, observer: &mut dyn Observer) -> Result<(), crate::Error> {
        let user = self.shared.user();
        let stepped = crowd.step(&user, observer);
        let done = stepped.and_then(|()| observer.step(&user, crowd.simulation.state()?));
        if done.is_err() {
            // the headset's thread ends its session, as far as the runtime lets it
            self.shared.request_stop();
            thread::sleep(FAILED_FAREWELL);
        }
        done
    }
}

impl Drop for Stage {
    /// A stage that was not closed asks the headset's thread to end, and does not wait for it.
    fn drop(&mut self) {
        self.shared.request_stop();
    }
}

/// Starts the headset's thread.
fn spawn(
    shared: &Arc<Shared>,
    world: Arc<super::surroundings::Surroundings>,
    plan: Plan,
) -> Result<HeadsetThread, crate::Error> {
    let shared = shared.clone();
    let thread = thread::Builder::new().name("headset".to_owned());
    thread.spawn(move || Headset::new(&shared, world, plan).run()).map_err(|error| no_thread(&error))
}

/// What came of the headset's thread. One that hangs, mostly in a call of the runtime, is left behind: only the runtime can
/// end it.
fn join(headset: HeadsetThread, is_calling: bool) -> Result<Outcome, crate::Error> {
    if !headset.is_finished() {
        let silent = if is_calling { "the OpenXR runtime" } else { "the graphics device" };
        let ended = format!("{silent} did not answer any more");
        return Ok(Outcome { hung: true, ended, ..Outcome::default() });
    }
    headset.join().unwrap_or_else(|_| Err(panicked("of the headset")))
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
