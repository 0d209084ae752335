//! What the crowd's thread and the headset's thread exchange.

use super::cues::{Cues, Report};
use super::recording::UserState;
use crate::kernels::Store;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Without a pose of the head for so long, the user is taken to stand.
const AWAY: Duration = Duration::from_millis(500);

/// A snapshot of the crowd.
#[derive(Clone)]
pub(super) struct CrowdSnapshot {
    /// What frames need of it. Shared, so that no thread holds the lock while a device works.
    pub(super) store: Arc<Store>,
    /// The world that it is of.
    pub(super) world: u64,
    /// Number of the snapshot, from 1 through all worlds.
    pub(super) number: u64,
    /// Length of a step, s.
    pub(super) step: f64,
    /// When it was due, s since the beginning.
    pub(super) due: f64,
    /// How long after that it was there, s.
    pub(super) late: f64,
}

/// The user as the headset's thread has last seen them.
#[derive(Debug, Clone, Copy)]
pub(super) struct SeenUser {
    pub(super) state: UserState,
    /// When the headset had a pose last.
    pub(super) seen: Option<Instant>,
}

impl SeenUser {
    /// The user as the crowd sees them at `now`. Without a recent pose they stand where they were last.
    fn at(&self, now: Instant) -> UserState {
        let Self { state, seen } = *self;
        if seen.is_some_and(|seen| now.saturating_duration_since(seen) <= AWAY) {
            return state;
        }
        UserState { place: state.place, elevation: state.elevation, ..UserState::default() }
    }
}

/// What the two threads exchange.
pub(super) struct Shared {
    snapshot: Mutex<CrowdSnapshot>,
    cues: Mutex<Cues>,
    report: Mutex<Report>,
    user: Mutex<SeenUser>,
    /// Milliseconds since the beginning at the last heartbeat.
    beat: AtomicU64,
    /// Whether a call of the runtime is under way.
    is_calling: AtomicBool,
    begin: Instant,
    stop: AtomicBool,
    messages: Mutex<Vec<String>>,
}

impl Shared {
    /// The beginning: the crowd's first state, and the user where they start.
    pub(super) fn new(first: CrowdSnapshot, user: UserState) -> Self {
        Self {
            cues: Mutex::new(Cues { on_stage: first.world, ..Cues::default() }),
            report: Mutex::new(Report { on_stage: first.world, ..Report::default() }),
            snapshot: Mutex::new(first),
            user: Mutex::new(SeenUser { state: user, seen: None }),
            beat: AtomicU64::new(0),
            is_calling: AtomicBool::new(false),
            begin: Instant::now(),
            stop: AtomicBool::new(false),
            messages: Mutex::new(Vec::new()),
        }
    }

    /// Time since the beginning.
    pub(super) fn elapsed(&self) -> Duration {
        self.begin.elapsed()
    }

    /// Seconds since the beginning.
    pub(super) fn now(&self) -> f64 {
        self.elapsed().as_secs_f64()
    }

    /// Shows that the headset's thread is alive.
    pub(super) fn heartbeat(&self) {
        let now = u64::try_from(self.elapsed().as_millis()).unwrap_or(u64::MAX);
        self.beat.store(now, Ordering::Relaxed);
    }

    /// Makes calls of the runtime, which may hang.
    pub(super) fn call<T>(&self, calls: impl FnOnce() -> T) -> T {
        self.heartbeat();
        self.is_calling.store(true, Ordering::Relaxed);
        let answer = calls();
        self.is_calling.store(false, Ordering::Relaxed);
        self.heartbeat();
        answer
    }

    /// Whether the headset's thread waits for an answer of the runtime.
    pub(super) fn is_calling(&self) -> bool {
        self.is_calling.load(Ordering::Relaxed)
    }

    /// Time since the last heartbeat at `now` since the beginning.
    pub(super) fn silence(&self, now: Duration) -> Duration {
        now.saturating_sub(Duration::from_millis(self.beat.load(Ordering::Relaxed)))
    }

    /// Leaves a message of one line for the user.
    pub(super) fn leave_message(&self, line: String) {
        lock(&self.messages).push(line);
    }

    /// The messages since the last call.
    pub(super) fn take_messages(&self) -> Vec<String> {
        std::mem::take(&mut lock(&self.messages))
    }

    /// Asks the headset's thread to end its session.
    pub(super) fn request_stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Whether the session is to end.
    pub(super) fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// The newest snapshot.
    pub(super) fn snapshot(&self) -> CrowdSnapshot {
        lock(&self.snapshot).clone()
    }

    pub(super) fn set_snapshot(&self, snapshot: CrowdSnapshot) {
        *lock(&self.snapshot) = snapshot;
    }

    /// What the headset is to show.
    pub(super) fn cues(&self) -> Cues {
        lock(&self.cues).clone()
    }

    /// Changes what the headset is to show.
    pub(super) fn cue(&self, change: impl FnOnce(&mut Cues)) {
        change(&mut lock(&self.cues));
    }

    /// How far the headset's thread is.
    pub(super) fn report<T>(&self, look: impl FnOnce(&mut Report) -> T) -> T {
        look(&mut lock(&self.report))
    }

    /// The user as the crowd sees them now.
    pub(super) fn user(&self) -> UserState {
        lock(&self.user).at(Instant::now())
    }

    /// Puts the user somewhere else.
    pub(super) fn set_user(&self, state: UserState) {
        *lock(&self.user) = SeenUser { state, seen: Some(Instant::now()) };
    }

    /// Replaces the user's state by what `update` makes of the last one; the headset has a pose now.
    pub(super) fn update_user(&self, update: impl FnOnce(&UserState) -> UserState) {
        let mut user = lock(&self.user);
        *user = SeenUser { state: update(&user.state), seen: Some(Instant::now()) };
    }
}

/// The user where a world has them begin.
pub(super) fn user_at(start: super::rig::Stand) -> UserState {
    let super::rig::Stand { position: place, elevation, .. } = start;
    UserState { place, elevation, ..UserState::default() }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    #[test]
    fn a_user_whose_headset_is_lost_stands() {
        let state = UserState {
            place: Vec2::new(3.0, 4.0),
            elevation: 2.5,
            velocity: Vec2::X,
            head: Some([1.0; 7]),
            ..UserState::default()
        };
        let seen = Instant::now();
        let user = SeenUser { state, seen: Some(seen) };
        assert_eq!(user.at(seen + AWAY), state);
        let stands = UserState { place: state.place, elevation: 2.5, ..UserState::default() };
        assert_eq!(user.at(seen + 2 * AWAY), stands);
        assert_eq!(SeenUser { seen: None, ..user }.at(seen), stands);
    }

    #[test]
    fn messages_and_heartbeats_reach_the_other_thread_once() {
        let store = Arc::new(Store::default());
        let first = CrowdSnapshot { store, world: 7, number: 1, step: 0.1, due: 0.0, late: 0.0 };
        let shared = Shared::new(first, UserState::default());
        shared.leave_message("a".to_owned());
        assert_eq!((shared.take_messages(), shared.take_messages().len()), (vec!["a".to_owned()], 0));
        let long = Duration::from_secs(3600);
        assert_eq!(shared.silence(long), long);
        std::thread::sleep(Duration::from_millis(2));
        shared.heartbeat();
        assert!(shared.silence(long) < long && shared.silence(Duration::ZERO).is_zero());
        assert!(!shared.is_calling() && shared.call(|| shared.is_calling()) && !shared.is_calling());
        assert!(!shared.stop_requested());
        shared.request_stop();
        assert!(shared.stop_requested());
    }
}
