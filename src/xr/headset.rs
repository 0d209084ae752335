//! The headset's thread: session after session, and the frames of each.
//!
//! Any failure after the first session restarts the session on a new device, with increasing back-off. Two things end the
//! thread early: an error that waiting cannot mend and that repeats, and an error of our own, such as a full disk.

use super::input::Reading;
use super::miniature::Miniature;
use super::outcome::{Outage, Outcome};
use super::pace::{FrameTimes, Governor};
use super::plan::{Plan, Shot};
use super::recording::{UserState, numbers};
use super::rig::{Rig, Terrain};
use super::session::{Eyes, Frame, Session, blend_name};
use super::shared::Shared;
use super::shown::{Crowd, Shown};
use super::state::{Event, State};
use super::surroundings::Surroundings;
use super::views::Pose;
use super::watch::Watch;
use super::{Error, views};
use crate::picture::Image;
use crate::render::{DrawTimes, EyeImages, Hand, HandKind, Settings, Show, Target, User};
use crate::stop;
use glam::{Vec2, Vec3};
use openxr::EnvironmentBlendMode as BlendMode;
use std::thread;
use std::time::{Duration, Instant};

/// First and longest pause before a lost headset is looked for again.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(100), Duration::from_millis(800)];
/// A session that lasted for so long counts as one that went well.
const WELL: Duration = Duration::from_secs(5);
/// Attempts in a row, each shorter than that and ended by an error that waiting does not mend, before it is given up.
const FRUITLESS: u32 = 12;
/// Longest time from frame to frame, s. A runtime that hung gives display times of long ago.
const LONGEST_FRAME: f32 = 0.1;

/// Reason for the end of a session that the runtime ended in good order.
const RUNTIME_ENDED: &str = "the OpenXR runtime ended the session";

/// Reason for the end of a session that we ended.
fn our_reason() -> &'static str {
    if stop::asked() { "interrupted" } else { "the time was up" }
}

/// The headset's thread.
pub(super) struct Headset<'a> {
    shared: &'a Shared,
    world: Surroundings,
    plan: Plan,
    rig: Rig,
    times: FrameTimes,
    governor: Governor,
    outcome: Outcome,
    frames: u64,
    /// Since when no frame is seen.
    lost: Option<Instant>,
    /// When the last loss began, and the number of the crowd's snapshot then.
    outage: Option<(Instant, u64)>,
}

impl<'a> Headset<'a> {
    pub(super) fn new(shared: &'a Shared, world: Surroundings, plan: Plan) -> Self {
        Self {
            shared,
            rig: Rig::new(world.start),
            world,
            plan,
            times: FrameTimes::default(),
            governor: Governor::default(),
            outcome: Outcome { least_quality: 1.0, ..Outcome::default() },
            frames: 0,
            lost: None,
            outage: None,
        }
    }

    /// Session after session until one ends in good order.
    pub(super) fn run(mut self) -> Result<Outcome, crate::Error> {
        let (mut pause, mut fruitless) = (BACK_OFF[0], 0);
        let mut last_message = None;
        loop {
            self.shared.heartbeat();
            let (begin, sessions) = (Instant::now(), self.outcome.sessions);
            let error = match self.session() {
                Ok(ended) => {
                    ended.clone_into(&mut self.outcome.ended);
                    break;
                }
                Err(Failure::Fatal(error)) => return Err(error),
                Err(Failure::Headset(error)) => error,
            };
            give_back();
            let is_first = self.outcome.sessions == 0;
            if is_first && !(error.is_passing() && self.plan.waits) {
                return Err(error.into());
            }
            let had_one = self.outcome.sessions > sessions;
            fruitless = match (begin.elapsed() > WELL, error.is_passing()) {
                (false, false) => fruitless + 1,
                (false, true) => fruitless,
                (true, _) => 0,
            };
            if fruitless > FRUITLESS {
                return Err(error.into());
            }
            let line = error.to_string();
            if had_one {
                self.end_outage();
                self.outcome.losses.push(Outage { reason: line.clone(), ..Outage::default() });
                self.outage = Some((Instant::now(), self.shared.snapshot().number));
                self.lost.get_or_insert_with(Instant::now);
                pause = BACK_OFF[0];
            }
            if had_one || last_message.as_ref() != Some(&line) {
                self.shared.leave_message(format!("{line}; looking for it again"));
                last_message = Some(line);
            }
            if self.shared.stop_requested() {
                self.outcome.ended = format!("{} while there was no headset", our_reason());
                break;
            }
            thread::sleep(pause);
            pause = (pause * 2).min(BACK_OFF[1]);
        }
        self.end_outage();
        self.outcome.frames = self.times.summary();
        Ok(self.outcome)
    }

    /// Records the length of the last loss and the steps of the crowd meanwhile.
    fn end_outage(&mut self) {
        if let (Some((since, number)), Some(loss)) = (self.outage.take(), self.outcome.losses.last_mut()) {
            loss.seconds = since.elapsed().as_secs_f64();
            loss.steps = self.shared.snapshot().number - number;
        }
    }

    /// Runs one session, from finding the runtime to its end; returns why it ended.
    fn session(&mut self) -> Result<&'static str, Failure> {
        let runtime = (self.plan.open)()?;
        let device = runtime.device(self.plan.validation)?;
        self.shared.heartbeat();
        let session = Session::new(&runtime, &device, self.plan.eye_size)?;
        self.shared.heartbeat();
        let [width, height] = session.size();
        let settings = Settings { width, height, eyes: 2, stereo: session.stereo(), ..self.world.settings };
        let Surroundings { store, meshes, scenery, gaze, .. } = &self.world;
        let mut show = Show::on_device(&device, store, meshes, scenery, settings, session.format())?;
        show.set_gaze(gaze);
        self.outcome.runtime = Some(runtime.info().clone());
        self.outcome.device = show.device();
        self.outcome.takes_depth = session.takes_depth();
        self.report_blend(session.blend());
        self.outcome.sessions += 1;
        let mut has_requested_exit = false;
        let mut running = Running { clock: Clock::default(), miniature: Miniature::default(), show, session };
        loop {
            self.shared.heartbeat();
            for event in running.session.poll()? {
                match event {
                    Event::State(state) => {
                        self.outcome.states.push(state.name());
                        if state == State::Exiting {
                            return Ok(if has_requested_exit { our_reason() } else { RUNTIME_ENDED });
                        }
                        match state {
                            State::Ready => self.choose_rate(&running.session)?,
                            State::Focused => self.report_visible(),
                            _ => {}
                        }
                    }
                    Event::Rate(rate) => self.outcome.refresh_rate = Some(rate),
                    Event::Recentred => {}
                }
            }
            if self.shared.stop_requested() && !has_requested_exit {
                has_requested_exit = true;
                if !running.session.is_running() {
                    return Ok(our_reason());
                }
                running.session.request_exit()?;
            }
            if running.session.is_running() {
                self.frame(&mut running)?;
            } else {
                thread::sleep(Duration::from_millis(5));
            }
        }
    }

    /// Requests the refresh rate of the plan, where the runtime offers rates.
    fn choose_rate(&mut self, session: &Session) -> Result<(), Error> {
        self.outcome.refresh_rates = session.refresh_rates()?;
        if let Some(rate) =
            self.plan.refresh_rate.and_then(|wanted| nearest(&self.outcome.refresh_rates, wanted))
        {
            session.ask_refresh_rate(rate)?;
        }
        self.outcome.refresh_rate = session.refresh_rate()?;
        Ok(())
    }

    /// Reports, once, a display that one can see through.
    fn report_blend(&mut self, mode: BlendMode) {
        if mode == BlendMode::ADDITIVE && self.outcome.blend_mode != blend_name(mode) {
            let line = "the headset's display adds its light to the room's: the crowd is see-through";
            self.shared.leave_message(line.to_owned());
        }
        self.outcome.blend_mode = blend_name(mode);
    }

    /// Reports that the user sees the crowd: for the first time, or again.
    fn report_visible(&mut self) {
        self.end_outage();
        if let Some(since) = self.lost.take() {
            let seconds = since.elapsed().as_secs_f64();
            self.shared.leave_message(format!("the headset is back after {seconds:.1} s"));
        } else if !self.outcome.states.iter().rev().skip(1).any(|state| *state == State::Focused.name()) {
            self.shared.leave_message("the headset shows the crowd".to_owned());
        }
    }

    fn frame(&mut self, running: &mut Running) -> Result<(), Failure> {
        let Running { clock, show, session, .. } = running;
        let frame = session.wait()?;
        let (woke, waited, watch) = (Instant::now(), session.waited(), Watch::start());
        self.shared.heartbeat();
        let (seconds, periods) = clock.step(&frame, &mut self.times);
        let input = session.read_input(&frame)?;
        let head = session.head(&frame)?;
        if let Some(head) = head {
            self.follow(head, &input, seconds);
        }
        if !frame.wants_image {
            self.times.empty();
            return Ok(session.end(frame, None)?);
        }
        let begin = Instant::now();
        let target = session.acquire()?;
        let snapshot = self.shared.snapshot();
        show.take(&snapshot.store, snapshot.number, snapshot.due)?;
        let crowd = Crowd { now: self.shared.now(), step: self.shared.time_step, late: snapshot.late };
        let shown = clock.shown.time(frame.display.as_nanos(), &crowd);
        show.set_level_distances(self.governor.distances(self.world.level_distances));
        // as late as can be: everything but the eyes' place is ready
        let eyes = session.locate(&frame)?;
        let seen = match &eyes {
            Some(eyes) => self.draw(running, target, eyes, &input, DrawTimes { shown, seconds })?,
            None => None,
        };
        let Running { session, show, .. } = running;
        session.release()?;
        session.end(frame, eyes.as_ref())?;
        let work = begin.elapsed();
        self.times.drew(work, periods);
        let host = woke.elapsed().saturating_sub(session.waited().saturating_sub(waited));
        self.times.prepared(host, watch.ran());
        self.governor.frame(work, frame.period);
        self.outcome.least_quality = self.outcome.least_quality.min(self.governor.quality());
        if let (Some((image, user_eyes)), Some((_, shots))) = (seen, &mut self.plan.shots) {
            let faces = show.faces(&self.world.store)?;
            shots(&Shot { frame: self.frames, image, user_eyes, faces }).map_err(Failure::Fatal)?;
        }
        self.frames += 1;
        Ok(())
    }
}

impl Headset<'_> {
    /// Moves the user, and hands their state to the crowd.
    fn follow(&mut self, head: Pose, input: &Reading, seconds: f32) {
        let hand = input.hands[1].or(input.hands[0]);
        let terrain = Terrain {
            floors: &self.world.floors,
            is_free: &|place, height| self.world.is_free(place, height),
        };
        self.rig.walk(&input.walk, head, hand, seconds, &terrain);
        let place = self.rig.user(head);
        let room = self.rig.world_from_room();
        let state = UserState {
            place,
            elevation: self.rig.elevation(),
            velocity: Vec2::ZERO,
            head: Some(numbers(head.within(room))),
            hands: input.hands.map(|hand| hand.map(|hand| numbers(hand.within(room)))),
            sticks: [input.walk.stick.x, input.walk.stick.y, input.walk.turn],
        };
        self.shared.update_user(|before| {
            let velocity = (place - before.place) / seconds.max(1e-3);
            // a teleport or a recentring is no walk
            let velocity = if velocity.length() > 4.0 { Vec2::ZERO } else { velocity };
            UserState { velocity: before.velocity.lerp(velocity, 0.3), ..state }
        });
    }

    /// Draws what the eyes see. Returns a copy and the midpoint of the eyes if this frame is one of the shots.
    fn draw(
        &mut self,
        running: &mut Running,
        target: Target,
        eyes: &Eyes,
        input: &Reading,
        times: DrawTimes,
    ) -> Result<Option<(Image, Vec3)>, Failure> {
        let Running { show, session, .. } = running;
        let view = views::view(eyes.placed, self.rig.world_from_room());
        let middle: Vec3 = (view.eyes[0] + view.eyes[1]) * 0.5;
        let renderer = show.renderer();
        renderer.set_user(self.user(input));
        if let Some(corners) = session.hidden().corners(eyes.placed.map(|(_, fov)| fov)) {
            renderer.set_mask(&corners).map_err(Error::from)?;
            self.outcome.hidden_triangles = session.hidden().triangles();
        }
        let is_copied = self.plan.shots.as_ref().is_some_and(|(every, _)| self.frames.is_multiple_of(*every));
        let image = show.draw_into(&view, middle, times, &Target { is_copied, ..target })?;
        self.reflect(running, target.color)?;
        Ok(image.map(|image| (image, middle)))
    }

    /// What the frame shows of the user.
    fn user(&self, input: &Reading) -> User {
        let room = self.rig.world_from_room();
        let held = |grip: Pose| {
            let Pose { rotation: turn, position: place } = grip.within(room);
            Hand { place, turn, kind: HandKind::Controller }
        };
        User {
            hands: input.grips.map(|grip| grip.map(held)),
            joints: input.seen.map(|seen| seen.map(|seen| seen.within(room))),
            teleport: self.rig.teleport_shown(input.hands[1].or(input.hands[0])),
            vignette: self.rig.vignette() * self.plan.vignette,
        }
    }

    /// Hands a small copy of the image to the mirror. A copy that fails closes the mirror and never ends the session.
    fn reflect(&self, running: &mut Running, image: EyeImages) -> Result<(), Error> {
        let Running { show, session, miniature, .. } = running;
        let Some(mirror) = &self.plan.mirror else { return Ok(()) };
        let Some(small) = mirror.wants(session.size(), Instant::now()) else { return Ok(()) };
        match miniature.copy(show.renderer(), image.left(), small) {
            Ok(copy) => mirror.keep(copy, Instant::now()),
            // a device that is lost is the headset's matter; memory that is short is not
            Err(crate::render::Error::Gpu(error @ crate::gpu::Error::Memory { .. })) => {
                mirror.close(Some(format!("the mirror is closed: {error}")));
            }
            Err(error) => return Err(error.into()),
        }
        Ok(())
    }
}

/// The rate that is offered and nearest to the one that is wanted, Hz.
fn nearest(offered: &[f32], wanted: f32) -> Option<f32> {
    let away = |rate: &f32| (rate - wanted).abs();
    offered.iter().copied().filter(|rate| rate.is_finite()).min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// Returns memory that a session has freed to the system. The C library keeps freed memory for each thread, and runtime,
/// driver and compiler have threads of their own.
fn give_back() {
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: no requirements; what is in use stays.
    unsafe {
        libc::malloc_trim(0);
    }
}

/// The time from frame to frame.
#[derive(Debug, Default)]
struct Clock {
    display: Option<i64>,
    woke: Option<Instant>,
    shown: Shown,
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

/// What lives as long as a session, in the order in which it is dropped.
struct Running {
    clock: Clock,
    miniature: Miniature,
    show: Show,
    session: Session,
}

/// Why a session could not begin, or was lost.
enum Failure {
    /// A failure of the headset: another session may help.
    Headset(Error),
    /// A failure of our own: no session would help.
    Fatal(crate::Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Headset(error)
    }
}

impl From<crate::Error> for Failure {
    /// Vulkan's errors may come from the runtime's device, which the next session replaces. All others are ours.
    fn from(error: crate::Error) -> Self {
        match error {
            crate::Error::Gpu(error) => Self::Headset(error.into()),
            crate::Error::Render(error) => Self::Headset(error.into()),
            other => Self::Fatal(other),
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;
    use openxr as xr;

    #[test]
    fn the_nearest_rate_on_offer_is_asked_for() {
        let offered = [72.0, 80.0, 90.0, f32::NAN, 120.0];
        assert_eq!(nearest(&offered, 90.0), Some(90.0));
        assert_eq!(nearest(&offered, 1e9), Some(120.0));
        assert_eq!(nearest(&offered, 75.0), Some(72.0));
        assert_eq!(nearest(&[], 90.0), None);
    }

    #[test]
    fn display_times_that_cannot_be_are_bounded() {
        let mut clock = Clock::default();
        let mut times = FrameTimes::default();
        let mut at = |display: i64| {
            let period = Duration::from_millis(20);
            clock.step(
                &Frame { display: xr::Time::from_nanos(display), period, wants_image: true },
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
