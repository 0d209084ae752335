//! A crowd around the user, until they have had enough or the time is up.
//!
//! Two threads. This one steps the crowd at its fixed rate by the clock, on a device of its own, and never waits for the
//! headset. The other one has everything of OpenXR: it waits for frames, draws the crowd's latest moment on the runtime's
//! device, and begins anew when the runtime goes away. A runtime that hangs therefore stops the pictures, not the crowd.

use super::pace::{FrameSummary, FrameTimes, Governor};
use super::recording::{Moment, numbers};
use super::rig::Rig;
use super::runtime::Runtime;
use super::session::{Event, Frame, Session, State};
use super::{Error, views};
use crate::gpu::Validation;
use crate::kernels::Store;
use crate::picture::Image;
use crate::render::{Settings, Show};
use crate::scenario::EnvironmentMesh;
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;
use glam::{Vec2, Vec3};
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Longest the crowd may fall behind the clock before it lets time pass.
const LONGEST_ARREARS: f64 = 0.25;
/// Without a sign of life from the headset's thread for so long, the user is told.
const SILENCE: Duration = Duration::from_secs(2);
/// First and longest pause before a lost headset is looked for again.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(100), Duration::from_millis(800)];
/// Longest the headset's thread may take to end in good order.
const FAREWELL: Duration = Duration::from_secs(3);
/// Steps of time longer than this, or negative, are not believed: a runtime that hung gives display times of long ago.
const LONGEST_FRAME: f32 = 0.1;

/// Takes the number of a frame and its picture.
pub type Shots = Box<dyn FnMut(u64, &Image) -> Result<(), crate::Error> + Send>;

/// Finds the runtime; called anew after every loss.
pub type Opener = Box<dyn Fn() -> Result<Runtime, Error> + Send>;

/// How long, how large, what to keep.
pub struct Plan {
    /// Time until the session is ended, s; none: until the runtime ends it.
    pub seconds: Option<f64>,
    /// Pixels of one eye; none: as the runtime recommends.
    pub eye_size: Option<[u32; 2]>,
    /// Whether to wait for a runtime or headset that is not there yet.
    pub waits: bool,
    /// Who gets pictures of both eyes (left beside right), and every how many frames.
    pub shots: Option<(u64, Shots)>,
    /// Vulkan's validation on the headset's device.
    pub validation: Validation,
    /// Finds the runtime.
    pub open: Opener,
}

impl std::fmt::Debug for Plan {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Plan")
            .field("seconds", &self.seconds)
            .field("eye_size", &self.eye_size)
            .finish_non_exhaustive()
    }
}

impl Default for Plan {
    fn default() -> Self {
        Self {
            seconds: None,
            eye_size: None,
            waits: false,
            shots: None,
            validation: Validation::from_environment(),
            open: Box::new(Runtime::open),
        }
    }
}

/// What the headset shows.
pub struct World {
    /// The crowd at its start, with bodies filled in.
    pub store: Store,
    /// The bodies' meshes.
    pub meshes: MeshBuffers,
    /// The scenery.
    pub scenery: EnvironmentMesh,
    /// Light and quality; size and number of eyes follow the headset.
    pub settings: Settings,
    /// How agents gaze.
    pub gaze: crate::scenario::Gaze,
    /// Levels of detail end here, and the crowd, m.
    pub level_distances: [f32; 3],
    /// Where the user begins, and their heading about +y, radians.
    pub start: (Vec2, f32),
    /// Whether the user may be moved to a place by stick or teleport.
    pub is_free: Box<dyn Fn(Vec2) -> bool + Send>,
}

impl std::fmt::Debug for World {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("World").field("start", &self.start).finish_non_exhaustive()
    }
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// Runtime and headset, of the last session.
    pub runtime: Option<super::RuntimeInfo>,
    /// The device that drew.
    pub device: String,
    /// Frames of all sessions.
    pub frames: FrameSummary,
    /// Sessions that were begun.
    pub sessions: u32,
    /// Why sessions were lost, one line each.
    pub losses: Vec<String>,
    /// States that sessions went through, in order.
    pub states: Vec<&'static str>,
    /// Least quality that the governor went down to, 0 to 1.
    pub least_quality: f32,
    /// Steps of the crowd.
    pub steps: u32,
    /// Seconds of the crowd that were let pass because stepping it took too long.
    pub time_lost: f64,
    /// Whether the runtime did not answer any more at the end.
    pub hung: bool,
}

/// What the two threads tell each other.
struct Shared {
    /// The crowd's latest moment and how many there were.
    moment: Mutex<(Store, u64)>,
    /// The user at present.
    user: Mutex<Moment>,
    /// Milliseconds since the beginning at the last sign of life.
    beat: AtomicU64,
    begin: Instant,
    stop: AtomicBool,
    notes: Mutex<Vec<String>>,
}

impl Shared {
    fn live(&self) {
        self.beat
            .store(u64::try_from(self.begin.elapsed().as_millis()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    fn note(&self, line: String) {
        lock(&self.notes).push(line);
    }

    fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Who is told what happens.
pub trait Observer {
    /// One line that the user should know.
    fn note(&mut self, line: &str);

    /// The user as the crowd will see them in the step that comes.
    ///
    /// # Errors
    /// When the observer cannot go on; the session is then ended.
    fn step(&mut self, user: &Moment) -> Result<(), crate::Error>;
}

/// Shows a crowd on the headset.
///
/// # Errors
/// When there is no headset at the beginning (unless the plan waits for one), or the crowd fails.
pub fn run(
    simulation: &mut Simulation,
    world: World,
    plan: Plan,
    observer: &mut dyn Observer,
) -> Result<Outcome, crate::Error> {
    let time_step = f64::from(simulation.store().step.time_step);
    let start = Moment { place: world.start.0, ..Moment::default() };
    let shared = Arc::new(Shared {
        moment: Mutex::new((Show::moment(simulation.state()?), 0)),
        user: Mutex::new(start),
        beat: AtomicU64::new(0),
        begin: Instant::now(),
        stop: AtomicBool::new(false),
        notes: Mutex::new(Vec::new()),
    });
    let seconds = plan.seconds;
    let headset = {
        let shared = shared.clone();
        thread::Builder::new()
            .name("headset".to_owned())
            .spawn(move || Headset::new(&shared, world, plan).run())
            .map_err(|error| crate::Error::Usage {
                message: format!("no thread for the headset: {error}"),
                hint: "close other programs, then try again".to_owned(),
            })?
    };
    let (mut steps, mut passed, mut is_silent) = (0_u32, 0.0, false);
    let mut stopped_at = None;
    while !headset.is_finished() {
        let now = shared.begin.elapsed();
        for line in std::mem::take(&mut *lock(&shared.notes)) {
            observer.note(&line);
        }
        let silence = now.saturating_sub(Duration::from_millis(shared.beat.load(Ordering::Relaxed)));
        if (silence > SILENCE) != is_silent {
            is_silent = !is_silent;
            observer.note(if is_silent {
                "the OpenXR runtime does not answer; the crowd goes on without it"
            } else {
                "the OpenXR runtime answers again"
            });
        }
        if seconds.is_some_and(|seconds| now.as_secs_f64() >= seconds) {
            shared.stop.store(true, Ordering::Relaxed);
        }
        if shared.stops() {
            let since = *stopped_at.get_or_insert(now);
            if now.saturating_sub(since) > FAREWELL && is_silent {
                break;
            }
        }
        let behind = now.as_secs_f64() - passed - f64::from(steps) * time_step;
        if behind < time_step {
            thread::sleep(Duration::from_micros(500));
            continue;
        }
        passed += (behind - LONGEST_ARREARS).max(0.0);
        let user = *lock(&shared.user);
        let done = observer.step(&user).and_then(|()| {
            simulation.set_user(user.place, user.velocity);
            simulation.step(1)
        });
        if done.is_err() {
            // the headset's thread ends its session, as far as the runtime lets it
            shared.stop.store(true, Ordering::Relaxed);
            thread::sleep(FAREWELL / 6);
            done?;
        }
        steps += 1;
        let moment = Show::moment(simulation.state()?);
        let mut latest = lock(&shared.moment);
        *latest = (moment, latest.1 + 1);
    }
    for line in std::mem::take(&mut *lock(&shared.notes)) {
        observer.note(&line);
    }
    let outcome = if headset.is_finished() {
        match headset.join() {
            Ok(outcome) => outcome?,
            Err(_) => {
                Outcome { losses: vec!["the headset's thread panicked".to_owned()], ..Outcome::default() }
            }
        }
    } else {
        // it hangs in a call of the runtime, which nobody can end but the runtime
        Outcome { hung: true, ..Outcome::default() }
    };
    Ok(Outcome { steps, time_lost: passed, ..outcome })
}

/// The headset's thread.
struct Headset<'a> {
    shared: &'a Shared,
    world: World,
    plan: Plan,
    rig: Rig,
    times: FrameTimes,
    governor: Governor,
    outcome: Outcome,
    frames: u64,
}

impl<'a> Headset<'a> {
    fn new(shared: &'a Shared, world: World, plan: Plan) -> Self {
        Self {
            shared,
            rig: Rig::new(world.start.0, world.start.1),
            world,
            plan,
            times: FrameTimes::default(),
            governor: Governor::default(),
            outcome: Outcome { least_quality: 1.0, ..Outcome::default() },
            frames: 0,
        }
    }

    /// Session after session until one ends in good order.
    fn run(mut self) -> Result<Outcome, crate::Error> {
        let mut pause = BACK_OFF[0];
        let mut was_told = false;
        loop {
            self.shared.live();
            let sessions = self.outcome.sessions;
            match self.session() {
                Ok(()) => break,
                Err(Failure::Fatal(error)) => return Err(error),
                Err(Failure::Headset(error)) => {
                    let first = self.outcome.sessions == 0;
                    if !error.is_passing() || (first && !self.plan.waits) {
                        return Err(error.into());
                    }
                    if self.outcome.sessions > sessions || !was_told {
                        self.shared.note(format!("{error}; looking for it again"));
                        was_told = true;
                        if !first {
                            self.outcome.losses.push(error.to_string());
                        }
                        pause = BACK_OFF[0];
                    }
                }
            }
            if self.shared.stops() {
                break;
            }
            thread::sleep(pause);
            pause = (pause * 2).min(BACK_OFF[1]);
        }
        self.outcome.frames = self.times.summary();
        Ok(self.outcome)
    }

    /// One session, from finding the runtime to its end.
    fn session(&mut self) -> Result<(), Failure> {
        let runtime = (self.plan.open)()?;
        let device = runtime.device(self.plan.validation)?;
        let mut session = Session::new(&runtime, &device, self.plan.eye_size)?;
        let [width, height] = session.size();
        let settings = Settings { width, height, eyes: 2, ..self.world.settings };
        let World { store, meshes, scenery, gaze, .. } = &self.world;
        let mut show = Show::on_device(&device, store, meshes, scenery, settings, session.format())
            .map_err(Failure::Fatal)?;
        show.set_gaze(gaze);
        self.outcome.runtime = Some(runtime.info().clone());
        self.outcome.device = show.device();
        self.outcome.sessions += 1;
        let mut asked = false;
        let mut clock = Clock::default();
        loop {
            self.shared.live();
            for event in session.poll()? {
                match event {
                    Event::State(state) => {
                        self.outcome.states.push(state.name());
                        if state == State::Exiting {
                            return Ok(());
                        }
                    }
                    Event::Recentred => {}
                }
            }
            if self.shared.stops() && !asked {
                asked = true;
                if !session.is_running() {
                    return Ok(());
                }
                session.request_exit()?;
            }
            if session.is_running() {
                self.frame(&mut session, &mut show, &mut clock)?;
            } else {
                thread::sleep(Duration::from_millis(5));
            }
        }
    }

    fn frame(&mut self, session: &mut Session, show: &mut Show, clock: &mut Clock) -> Result<(), Failure> {
        let frame = session.wait()?;
        self.shared.live();
        let (seconds, periods) = clock.step(&frame, &mut self.times);
        let input = session.read_input(&frame)?;
        let head = session.head(&frame)?;
        if let Some(head) = head {
            let hand = input.hands[1].or(input.hands[0]);
            self.rig.walk(&input.walk, head, hand, seconds, &self.world.is_free);
            let place = self.rig.user(head);
            let room = self.rig.world_from_room();
            let mut user = lock(&self.shared.user);
            let velocity = (place - user.place) / seconds.max(1e-3);
            // a teleport or a recentring is no walk
            let velocity = if velocity.length() > 4.0 { Vec2::ZERO } else { velocity };
            *user = Moment {
                place,
                velocity: user.velocity.lerp(velocity, 0.3),
                head: Some(numbers(head.within(room))),
                hands: input.hands.map(|hand| hand.map(|hand| numbers(hand.within(room)))),
                sticks: [input.walk.stick.x, input.walk.stick.y, input.walk.turn],
            };
        }
        if !frame.wants_picture {
            self.times.empty();
            return Ok(session.end(frame, None)?);
        }
        let begin = Instant::now();
        let target = session.acquire()?;
        {
            let latest = lock(&self.shared.moment);
            show.take(&latest.0, latest.1).map_err(Failure::Fatal)?;
        }
        show.set_level_distances(self.governor.distances(self.world.level_distances));
        // as late as can be: everything but the eyes' place is ready
        let eyes = session.locate(&frame)?;
        let picture = match &eyes {
            None => None,
            Some(eyes) => {
                let view = views::view(eyes.placed, self.rig.world_from_room());
                let middle: Vec3 = (view.eyes[0] + view.eyes[1]) * 0.5;
                let shot =
                    self.plan.shots.as_ref().is_some_and(|(every, _)| self.frames.is_multiple_of(*every));
                show.draw_into(&view, middle, seconds, (target.image, target.view), shot)
                    .map_err(Failure::Fatal)?
            }
        };
        session.release()?;
        session.end(frame, eyes.as_ref())?;
        let work = begin.elapsed();
        self.times.drew(work, periods);
        self.governor.frame(work, frame.period);
        self.outcome.least_quality = self.outcome.least_quality.min(self.governor.quality());
        if let (Some(image), Some((_, shots))) = (picture, &mut self.plan.shots) {
            shots(self.frames, &image).map_err(Failure::Fatal)?;
        }
        self.frames += 1;
        Ok(())
    }
}

/// The time from frame to frame, as far as it can be believed.
#[derive(Debug, Default)]
struct Clock {
    display: Option<i64>,
    woke: Option<Instant>,
}

impl Clock {
    /// Seconds since the frame before, for motion; and periods of the display since then.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "short times in nanoseconds"
    )]
    fn step(&mut self, frame: &Frame, times: &mut FrameTimes) -> (f32, u64) {
        let now = Instant::now();
        if let Some(before) = self.woke.replace(now) {
            times.woke(now - before);
        }
        let display = frame.display.as_nanos();
        let since = self.display.replace(display).map_or(0, |before| display - before);
        let period = i64::try_from(frame.period.as_nanos()).unwrap_or(0).max(1);
        let periods = u64::try_from((since + period / 2) / period).unwrap_or(0).min(1_000);
        ((since as f32 * 1e-9).clamp(0.0, LONGEST_FRAME), periods)
    }
}

/// Why a session ended.
enum Failure {
    /// The headset's doing: another session may help.
    Headset(Error),
    /// Ours: no session would help.
    Fatal(crate::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Headset(error)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;
    use openxr as xr;

    #[test]
    fn display_times_that_cannot_be_are_not_believed() {
        let mut clock = Clock::default();
        let mut times = FrameTimes::default();
        let mut at = |display: i64| {
            let period = Duration::from_millis(20);
            clock.step(
                &Frame { display: xr::Time::from_nanos(display), period, wants_picture: true },
                &mut times,
            )
        };
        assert_eq!(at(1_000_000_000), (0.0, 0));
        let (seconds, periods) = at(1_020_000_000);
        assert!((seconds - 0.02).abs() < 1e-6 && periods == 1);
        // the service hung: into the past, then three seconds on
        assert_eq!(at(500_000_000).0, 0.0);
        assert_eq!(at(3_500_000_000), (LONGEST_FRAME, 150));
    }
}
