//! A crowd around the user, until they have had enough or the time is up.
//!
//! Two threads. This one steps the crowd at its fixed rate by the clock, on a device of its own, and never waits for the
//! headset. The other one has everything of OpenXR: it waits for frames, draws the crowd's latest moment on the runtime's
//! device, and begins anew when the runtime goes away. A runtime that hangs therefore stops the pictures, not the crowd.

use super::Error;
use super::headset::Headset;
use super::mirror::Mirror;
use super::pace::FrameSummary;
use super::recording::Moment;
use super::rig::Stand;
use super::runtime::Runtime;
use crate::gpu::Validation;
use crate::kernels::Store;
use crate::picture::Image;
use crate::render::{Face, Settings, Show};
use crate::scenario::{Clearance, EnvironmentMesh, Floors};
use crate::scene::{Scene, atmosphere};
use crate::sim::Simulation;
use crate::sim::bodies::MeshBuffers;
use crate::sim::snapshots::make_room;
use crate::stop;
use glam::Vec2;
use serde::Serialize;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Texels a side of the shadow map: a headset draws twice.
const SHADOW_SIZE: u32 = 1024;
/// Longest the crowd may fall behind the clock before it lets time pass.
const LONGEST_ARREARS: f64 = 0.25;
/// Without a sign of life from the headset's thread for so long, the user is told.
const SILENCE: Duration = Duration::from_secs(2);
/// Without a pose of the head for so long, the user is taken to stand.
const AWAY: Duration = Duration::from_millis(500);
/// Longest the headset's thread may take to end in good order: a device that is busy with something else takes its time.
const FAREWELL: Duration = Duration::from_secs(10);
/// What it gets for that when the crowd has failed.
const FAILED_FAREWELL: Duration = Duration::from_millis(500);

/// How far the edge of the view is darkened while a stick moves the user, unless told otherwise.
pub const DEFAULT_VIGNETTE: f32 = 0.7;

/// What a frame showed.
#[derive(Debug)]
pub struct Shot {
    /// Its number.
    pub frame: u64,
    /// Both eyes, left beside right.
    pub image: Image,
    /// Midpoint of the user's eyes in the world, m.
    pub user_eyes: glam::Vec3,
    /// Where those who were drawn looked.
    pub faces: Vec<Face>,
}

/// Takes what a frame showed.
pub type Shots = Box<dyn FnMut(&Shot) -> Result<(), crate::Error> + Send>;

/// Finds the runtime; called anew after every loss.
pub type Opener = Box<dyn Fn() -> Result<Runtime, Error> + Send>;

/// How long, how large, what to keep.
pub struct Plan {
    /// Time until the session is ended, s; none: until the runtime ends it.
    pub seconds: Option<f64>,
    /// Pixels of one eye; none: as the runtime recommends.
    pub eye_size: Option<[u32; 2]>,
    /// Refresh rate of the display to ask for, Hz: the nearest that is offered; none: the runtime's.
    pub refresh_rate: Option<f32>,
    /// How far the edge of the view is darkened while a stick moves the user, 0 not at all to 1.
    pub vignette: f32,
    /// Whether to wait for a runtime or headset that is not there yet.
    pub waits: bool,
    /// Who is told what frames show, and every how many frames.
    pub shots: Option<(u64, Shots)>,
    /// Where copies of what the user sees go.
    pub mirror: Option<Arc<Mirror>>,
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
            refresh_rate: None,
            vignette: DEFAULT_VIGNETTE,
            waits: false,
            shots: None,
            mirror: None,
            // an unknown name is told by whoever begins the program
            validation: Validation::from_environment().unwrap_or_default(),
            open: Box::new(Runtime::open),
        }
    }
}

/// What the headset shows, and where its user may go.
pub(super) struct Surroundings {
    /// The crowd at its start, with bodies filled in.
    pub(super) store: Store,
    /// The bodies' meshes.
    pub(super) meshes: MeshBuffers,
    /// The scenery.
    pub(super) scenery: EnvironmentMesh,
    /// Light and quality; size and number of eyes follow the headset.
    pub(super) settings: Settings,
    /// How agents gaze.
    pub(super) gaze: crate::scenario::Gaze,
    /// Levels of detail end here, and the crowd, m.
    pub(super) level_distances: [f32; 3],
    /// Where the user begins.
    pub(super) start: Stand,
    /// What the user may stand on.
    pub(super) floors: Floors,
    /// Where the user may be moved to by stick or teleport.
    free: Clearance,
    /// Radius of the user, m.
    radius: f32,
}

impl Surroundings {
    fn of(scene: &Scene, mut store: Store, meshes: MeshBuffers) -> Self {
        let geometry = &scene.geometry;
        let user = scene.scenario.user.unwrap_or_default();
        let [near, middle, far, ..] = store.frame.level_distance;
        make_room(&mut store);
        Self {
            store,
            meshes,
            scenery: geometry.scenery(),
            settings: Settings {
                atmosphere: atmosphere(scene.scenario.layout),
                shadow_size: SHADOW_SIZE,
                ..Settings::default()
            },
            gaze: scene.scenario.gaze,
            level_distances: [near, middle, far],
            start: Stand {
                position: geometry.user.unwrap_or_default(),
                elevation: geometry.user_elevation,
                heading: user.heading_deg.to_radians(),
            },
            floors: geometry.floors.clone(),
            free: Clearance::new(&geometry.bounds, &geometry.obstacles),
            radius: user.radius,
        }
    }

    /// Whether the user may be moved to a place, on a floor of some height, m.
    pub(super) fn is_free(&self, place: Vec2, height: f32) -> bool {
        self.free.admits(place, self.radius) && self.floors.admits(place, self.radius, height)
    }
}

/// A time without pictures.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outage {
    /// Why the session was lost, in one line.
    pub reason: String,
    /// Until the user saw the crowd again, or the next loss, or the end, s.
    pub seconds: f64,
    /// Steps that the crowd did meanwhile.
    pub steps: u64,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// Runtime and headset, of the last session.
    pub runtime: Option<super::RuntimeInfo>,
    /// The device that drew.
    pub device: String,
    /// Refresh rate of the display, Hz, where the runtime tells.
    pub refresh_rate: Option<f32>,
    /// Those that can be asked for, Hz.
    pub refresh_rates: Vec<f32>,
    /// Whether the runtime takes the depth of pictures.
    pub takes_depth: bool,
    /// Triangles of the pictures that the lenses hide and nothing is drawn in, left and right.
    pub hidden_triangles: [usize; 2],
    /// Frames of all sessions.
    pub frames: FrameSummary,
    /// Sessions that were begun.
    pub sessions: u32,
    /// The sessions that were lost.
    pub losses: Vec<Outage>,
    /// States that sessions went through, in order.
    pub states: Vec<&'static str>,
    /// Least quality that the governor went down to, 0 to 1.
    pub least_quality: f32,
    /// Steps of the crowd.
    pub steps: u32,
    /// When the last of them was begun, s after the crowd set off.
    pub seconds: f64,
    /// Seconds of the crowd that were let pass because stepping it took too long.
    pub time_lost: f64,
    /// Pictures that a mirror showed.
    pub mirrored: u64,
    /// Why it ended, in one line.
    pub ended: String,
    /// Whether the runtime did not answer any more at the end.
    pub hung: bool,
}

/// A moment of the crowd.
#[derive(Clone)]
pub(super) struct Latest {
    /// What pictures need of it. Shared, so that nobody holds the lock while a device works.
    pub(super) store: Arc<Store>,
    /// Which one, from 1.
    pub(super) number: u64,
    /// When it was due, s since the beginning.
    pub(super) due: f64,
    /// How long after that it was there, s.
    pub(super) late: f64,
}

/// What the two threads tell each other.
pub(super) struct Shared {
    /// The crowd's latest moment.
    pub(super) moment: Mutex<Latest>,
    /// Length of a step, s.
    pub(super) time_step: f64,
    /// The user when the headset was found last, and when that was.
    pub(super) user: Mutex<(Moment, Option<Instant>)>,
    /// Milliseconds since the beginning at the last sign of life.
    beat: AtomicU64,
    begin: Instant,
    stop: AtomicBool,
    notes: Mutex<Vec<String>>,
}

impl Shared {
    /// Gives a sign of life.
    pub(super) fn live(&self) {
        self.beat
            .store(u64::try_from(self.begin.elapsed().as_millis()).unwrap_or(u64::MAX), Ordering::Relaxed);
    }

    /// Tells the user something, in one line.
    pub(super) fn note(&self, line: String) {
        lock(&self.notes).push(line);
    }

    /// Seconds since the beginning.
    pub(super) fn now(&self) -> f64 {
        self.begin.elapsed().as_secs_f64()
    }

    /// Whether the session is to end.
    pub(super) fn stops(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}

pub(super) fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The user as the crowd sees them at `now`: who has not been heard of for a while stands where they were last.
fn present((user, seen): &(Moment, Option<Instant>), now: Instant) -> Moment {
    let is_here = seen.is_some_and(|seen| now.saturating_duration_since(seen) <= AWAY);
    if is_here { *user } else { Moment { place: user.place, elevation: user.elevation, ..Moment::default() } }
}

/// Who is told what happens.
pub trait Observer {
    /// One line that the user should know.
    fn note(&mut self, line: &str);

    /// A step that was done: the user as the crowd saw them in it, and the crowd after it.
    ///
    /// # Errors
    /// When the observer cannot go on; the session is then ended.
    fn step(&mut self, user: &Moment, crowd: &Store) -> Result<(), crate::Error>;
}

/// Shows the crowd of a scene on the headset: the simulation and its meshes are those of
/// [`Scene::start_with_bodies`], at its start.
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
    let start = Moment { place, elevation, ..Moment::default() };
    let first = Arc::new(Show::snapshot(simulation.state()?));
    let shared = Arc::new(Shared {
        moment: Mutex::new(Latest { store: first, number: 1, due: 0.0, late: 0.0 }),
        time_step,
        user: Mutex::new((start, None)),
        beat: AtomicU64::new(0),
        begin: Instant::now(),
        stop: AtomicBool::new(false),
        notes: Mutex::new(Vec::new()),
    });
    let (seconds, mirror) = (plan.seconds, plan.mirror.clone());
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
    let (mut steps, mut begun, mut passed, mut is_silent) = (0_u32, 0.0, 0.0, false);
    let hung = || "the OpenXR runtime did not answer any more".to_owned();
    let mut stopped_at = None;
    while !headset.is_finished() {
        let now = shared.begin.elapsed();
        for line in std::mem::take(&mut *lock(&shared.notes)) {
            observer.note(&line);
        }
        if let Some(line) = mirror.as_ref().and_then(|mirror| mirror.said()) {
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
        if stop::asked() || seconds.is_some_and(|seconds| now.as_secs_f64() >= seconds) {
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
        begun = now.as_secs_f64();
        let user = present(&lock(&shared.user), Instant::now());
        simulation.set_user(user.place, user.elevation, user.velocity);
        let done = simulation.step(1).and_then(|()| observer.step(&user, simulation.state()?));
        if done.is_err() {
            // the headset's thread ends its session, as far as the runtime lets it
            shared.stop.store(true, Ordering::Relaxed);
            thread::sleep(FAILED_FAREWELL);
            done?;
        }
        steps += 1;
        let store = Arc::new(Show::snapshot(simulation.state()?));
        let due = passed + f64::from(steps) * time_step;
        let late = (shared.now() - due).max(0.0);
        *lock(&shared.moment) = Latest { store, number: u64::from(steps) + 1, due, late };
    }
    for line in std::mem::take(&mut *lock(&shared.notes)) {
        observer.note(&line);
    }
    let outcome = if headset.is_finished() {
        match headset.join() {
            Ok(outcome) => outcome?,
            Err(_) => {
                return Err(crate::Error::Usage {
                    message: "the headset's thread panicked".to_owned(),
                    hint: "this is a fault of the program: report it with what stands above".to_owned(),
                });
            }
        }
    } else {
        // it hangs in a call of the runtime, which nobody can end but the runtime
        Outcome { hung: true, ended: hung(), ..Outcome::default() }
    };
    Ok(Outcome { steps, seconds: begun, time_lost: passed, ..outcome })
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "copies")]
mod tests {
    use super::*;

    #[test]
    fn a_user_whose_headset_is_lost_stands() {
        let user = Moment {
            place: Vec2::new(3.0, 4.0),
            elevation: 2.5,
            velocity: Vec2::X,
            head: Some([1.0; 7]),
            ..Moment::default()
        };
        let seen = Instant::now();
        assert_eq!(present(&(user, Some(seen)), seen + AWAY), user);
        let stands = Moment { place: user.place, elevation: 2.5, ..Moment::default() };
        assert_eq!(present(&(user, Some(seen)), seen + 2 * AWAY), stands);
        assert_eq!(present(&(user, None), seen), stands);
    }
}
