//! The headset's thread: session after session, and the frames of each.
//!
//! Any failure after the first session restarts the session on a new device, with increasing back-off. Two things end the
//! thread early: an error that waiting cannot mend and that repeats, and an error of our own, such as a full disk.

use super::answer::Answering;
use super::asking::Asking;
use super::failure::Failure;
use super::next::Venue;
use super::outcome::{Outage, Outcome};
use super::pace::{FrameTimes, Governor};
use super::plan::Plan;
use super::rig::Rig;
use super::running::Running;
use super::session::{Session, blend_name};
use super::shared::Shared;
use super::state::{Event, State};
use super::surroundings::Surroundings;
use super::{Error, views};
use crate::stop;
use openxr::EnvironmentBlendMode as BlendMode;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

/// First and longest pause before a lost headset is looked for again.
const BACK_OFF: [Duration; 2] = [Duration::from_millis(100), Duration::from_millis(800)];
/// A session that lasted for so long counts as one that went well.
const WELL: Duration = Duration::from_secs(5);
/// Attempts in a row, each shorter than that and ended by an error that waiting does not mend, before it is given up.
const FRUITLESS: u32 = 12;

/// Reason for the end of a session that the runtime ended in good order.
const RUNTIME_ENDED: &str = "the OpenXR runtime ended the session";

/// Reason for the end of a session that we ended.
fn our_reason() -> &'static str {
    if stop::asked() { "interrupted" } else { "the time was up" }
}

/// The headset's thread.
pub(super) struct Headset<'a> {
    pub(super) shared: &'a Shared,
    /// What is seen.
    pub(super) world: Arc<Surroundings>,
    pub(super) plan: Plan,
    pub(super) rig: Rig,
    /// Whether the user is to stand where the world has them begin from the next frame with a head on.
    pub(super) recentres: bool,
    /// How far everything is covered with grey.
    pub(super) fade: f32,
    /// The panel that stands in the room.
    pub(super) asking: Option<Asking>,
    pub(super) answering: Answering,
    pub(super) times: FrameTimes,
    pub(super) governor: Governor,
    pub(super) outcome: Outcome,
    /// Frames that were handed over with an image.
    pub(super) frames: u64,
    /// Since when no frame is seen.
    lost: Option<Instant>,
    /// When the last loss began, and the number of the crowd's snapshot then.
    outage: Option<(Instant, u64)>,
}

impl<'a> Headset<'a> {
    pub(super) fn new(shared: &'a Shared, world: Arc<Surroundings>, plan: Plan) -> Self {
        Self {
            shared,
            rig: Rig::new(world.start),
            world,
            plan,
            recentres: false,
            fade: 0.0,
            asking: None,
            answering: Answering::default(),
            times: FrameTimes::default(),
            governor: Governor::default(),
            outcome: Outcome { least_quality: 1.0, least_resolution: 1.0, ..Outcome::default() },
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
            loss.steps = self.shared.snapshot().number.saturating_sub(number);
        }
    }

    /// Runs one session, from finding the runtime to its end; returns why it ended.
    fn session(&mut self) -> Result<&'static str, Failure> {
        let shared = self.shared;
        let runtime = shared.call(|| (self.plan.open)())?;
        let device = shared.call(|| runtime.device(self.plan.validation))?;
        let mut session = shared.call(|| Session::new(&runtime, &device, self.plan.eye_size))?;
        self.outcome.runtime = Some(runtime.info().clone());
        self.adopt();
        let venue = Venue::of(&device, &mut session);
        let show = venue.show(&self.world, &views::at_start(self.rig.world_from_room()))?;
        self.outcome.device = show.device();
        self.outcome.takes_depth = session.takes_depth();
        self.report_blend(session.blend());
        let mut running = Running::new(show, session, venue);
        self.outcome.sessions += 1;
        let ended = self.run_frames(&mut running);
        // the device is done with all frames before the runtime is asked to take its images back
        let Running { show, miniature, next, venue, session, .. } = running;
        drop((show, miniature, next, venue));
        shared.call(|| drop((session, device, runtime)));
        ended
    }

    /// Runs the frames of a session; returns why it ended.
    fn run_frames(&mut self, running: &mut Running) -> Result<&'static str, Failure> {
        let shared = self.shared;
        let mut has_requested_exit = false;
        loop {
            for event in shared.call(|| running.session.poll())? {
                match event {
                    Event::State(state) => {
                        self.outcome.states.push(state.name());
                        if state == State::Exiting {
                            return Ok(if has_requested_exit { our_reason() } else { RUNTIME_ENDED });
                        }
                        match state {
                            State::Ready => shared.call(|| self.choose_rate(&running.session))?,
                            State::Focused => self.report_visible(),
                            _ => {}
                        }
                    }
                    Event::Rate(rate) => self.outcome.refresh_rate = Some(rate),
                    Event::Recentred => self.forget_place(),
                }
            }
            if shared.stop_requested() && !has_requested_exit {
                has_requested_exit = true;
                if !running.session.is_running() {
                    return Ok(our_reason());
                }
                shared.call(|| running.session.request_exit())?;
            }
            if running.session.is_running() {
                self.frame(running)?;
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

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "copies of the same numbers")]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_rate_on_offer_is_asked_for() {
        let offered = [72.0, 80.0, 90.0, f32::NAN, 120.0];
        assert_eq!(nearest(&offered, 90.0), Some(90.0));
        assert_eq!(nearest(&offered, 1e9), Some(120.0));
        assert_eq!(nearest(&offered, 75.0), Some(72.0));
        assert_eq!(nearest(&[], 90.0), None);
    }
}
