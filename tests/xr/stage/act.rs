//! What the actor does with worlds.

use gaitway::kernels::Store;
use gaitway::library::GaitLibrary;
use gaitway::picture::Image;
use gaitway::scenario::User;
use gaitway::scene::Scene;
use gaitway::xr::{
    Observer, Plan, RecordedSession, Recorder, Shot, Stage, TrialLabel, UserState, World, make_way,
};
use serde_json::json;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Tells notes on standard error, and records steps where it should.
#[derive(Default)]
pub(super) struct Teller {
    pub(super) recorder: Option<Recorder<File>>,
    /// How often a headset that was lost has come back.
    backs: u32,
}

impl Observer for Teller {
    fn note(&mut self, line: &str) {
        self.backs += u32::from(line.contains("the headset is back"));
        eprintln!("{line}");
    }

    fn step(&mut self, user: &UserState, crowd: &Store) -> gaitway::Result<()> {
        if let Some(recorder) = &mut self.recorder {
            recorder.step(user, crowd).unwrap();
        }
        Ok(())
    }
}

/// A line that the other process reads.
pub(in super::super) fn tell(key: &str, value: &serde_json::Value) {
    eprintln!("{}", json!({ key: value }));
}

/// What the actor says of every picture that it sees.
pub(super) const PICTURE: &str = "a picture";

/// Of a gap between two frames no more counts as seen.
const LONGEST_SEEN: Duration = Duration::from_secs(1);

/// The newest picture of both eyes, how many there were, and the pace at which they came.
#[derive(Clone, Default)]
pub(super) struct Seen(Arc<Mutex<Pictures>>);

#[derive(Default)]
struct Pictures {
    newest: Option<Image>,
    count: u64,
    came: Option<Instant>,
    slowest: Duration,
    uncounted: Duration,
}

impl Seen {
    /// A plan of a session. Every second picture comes here, and the actor tells of it.
    pub(super) fn plan(&self, side: u32) -> Plan {
        let seen = self.clone();
        let take = move |shot: &Shot| {
            let (now, pictures) = (Instant::now(), &mut *seen.0.lock().unwrap());
            let since = pictures.came.replace(now).map(|before| now - before);
            let since = since.unwrap_or_default();
            pictures.slowest = pictures.slowest.max(since);
            pictures.uncounted += since.saturating_sub(LONGEST_SEEN);
            pictures.count += 1;
            pictures.newest = Some(shot.image.clone());
            eprintln!("{PICTURE}");
            Ok(())
        };
        Plan { eye_size: Some([side; 2]), shots: Some((2, Box::new(take))), ..Plan::default() }
    }

    pub(super) fn count(&self) -> u64 {
        self.0.lock().unwrap().count
    }

    /// The longest time between two pictures, which is that of two frames, s.
    pub(super) fn slowest(&self) -> f64 {
        self.0.lock().unwrap().slowest.as_secs_f64()
    }

    /// At most so much of the time so far was between frames too far apart to count wholly, s.
    pub(super) fn uncounted(&self) -> f64 {
        self.0.lock().unwrap().uncounted.as_secs_f64()
    }

    /// The newest picture.
    pub(super) fn newest(&self) -> Option<Image> {
        self.0.lock().unwrap().newest.clone()
    }
}

/// An empty square with a post of 0.5 m ten metres ahead of the user, and so far aside.
pub(super) fn square(aside: f32) -> Scene {
    let text =
        super::super::POST.replace("position = [0.0, -10.0]", &format!("position = [{aside:.1}, -10.0]"));
    Scene::of(toml::from_str(&text).unwrap()).build().unwrap()
}

/// One built-in scene, as `gaitway xr NAME --agents 40` has it.
fn scene(name: &str) -> Scene {
    let builder = Scene::load(name).unwrap().agents(40);
    builder.change(|scenario| scenario.put_in(User::default())).gives_way().build().unwrap()
}

fn record(scene: &Scene, world: &mut World, path: &Path, trial: u32) -> Recorder<File> {
    let library = GaitLibrary::built_in().unwrap();
    let of = RecordedSession::of(scene, &library, world.simulation().state().unwrap());
    let label = TrialLabel { study: "test".into(), participant: "k7".into(), part: "scenes".into(), trial };
    let session = RecordedSession { trial: Some(label), ..of };
    Recorder::new(make_way(path).unwrap().file, &session).unwrap()
}

/// Goes through so many worlds, each made and brought to the device while people walk in the one before.
pub(super) fn worlds(folder: &Path, count: u32) {
    let names = ["garden", "crossing", "parking", "scifi"];
    let mut teller = Teller::default();
    let mut world = World::new(&scene("scifi")).unwrap();
    let plan = Plan { eye_size: Some([320; 2]), ..Plan::default() };
    let mut stage = Stage::open(&world, plan).unwrap();
    while stage.walk(&mut world, 0.2, &mut teller).unwrap().frames.drawn == 0 {}
    for (number, name) in (1..=count).zip(names.into_iter().cycle()) {
        let make = move || {
            let scene = scene(name);
            let world = World::new(&scene).unwrap();
            (scene, world)
        };
        let (made, begin) = (std::thread::spawn(make), Instant::now());
        // frames are counted from before the next world is made until it is seen
        let mut meanwhile = gaitway::xr::FrameCount::default();
        let mut walked = |stage: &mut Stage, world: &mut World, teller: &mut Teller| {
            let frames = stage.walk(world, 0.25, teller).unwrap().frames;
            meanwhile.drawn += frames.drawn;
            meanwhile.longest_ms = meanwhile.longest_ms.max(frames.longest_ms);
        };
        while !made.is_finished() {
            walked(&mut stage, &mut world, &mut teller);
        }
        let (scene, mut next) = made.join().unwrap();
        stage.prepare(&next);
        while !stage.is_ready(&next) {
            walked(&mut stage, &mut world, &mut teller);
            assert!(begin.elapsed() < Duration::from_secs(200), "never ready");
        }
        let prepared = begin.elapsed();
        stage.fade(1.0);
        stage.walk(&mut world, 0.4, &mut teller).unwrap();
        let begin = Instant::now();
        assert!(stage.show(&next, &mut teller).unwrap());
        let seconds = begin.elapsed().as_secs_f64();
        stage.fade(0.0);
        let path: PathBuf = folder.join(format!("trial-{number}.csv"));
        teller.recorder = Some(record(&scene, &mut next, &path, number));
        let (frame_s, steps) = walk_and_see(&mut stage, &mut next, &mut teller);
        let state = next.simulation().state().unwrap();
        teller.recorder.take().unwrap().finish(state).unwrap();
        world = next;
        tell(
            "change",
            &json!({
                "scene": name, "recording": path, "seconds": seconds, "prepared_s": prepared.as_secs_f64(),
                "frames_meanwhile": meanwhile.drawn, "longest_ms": meanwhile.longest_ms,
                "frame_s": frame_s, "steps": steps,
            }),
        );
    }
    tell("outcome", &json!(stage.close(&mut teller).unwrap()));
}

/// Walks 1.5 s, and on until two pictures were seen: a software driver beside other work may need longer for them.
///
/// How long a picture took, s, and how many steps there were.
fn walk_and_see(stage: &mut Stage, world: &mut World, teller: &mut Teller) -> (f64, u32) {
    let (mut seconds, mut drawn, mut steps) = (0.0, 0, 0);
    while drawn < 2 {
        let part = if steps == 0 { 1.5 } else { 0.25 };
        let walked = stage.walk(world, part, teller).unwrap();
        assert!(walked.is_whole, "{walked:?}");
        seconds += part;
        drawn += u32::try_from(walked.frames.drawn).unwrap();
        steps += walked.steps;
        assert!(seconds < super::super::service::PATIENCE.as_secs_f64(), "{drawn} pictures in {seconds} s");
    }
    (seconds / f64::from(drawn), steps)
}

/// Waits until a picture shows the post where it should be, in degrees to the right, in the left eye.
pub(super) fn see_post(stage: &mut Stage, seen: &Seen, wanted: f32, teller: &mut Teller) {
    let (begin, count) = (Instant::now(), seen.count());
    loop {
        stage.rest(0.05, teller);
        let image = seen.newest().filter(|_| seen.count() >= count + 2);
        let found = image.as_ref().and_then(|image| super::super::post(image, 0)).map(|column| {
            let half = image.as_ref().map_or(0.0, |image| image.width as f32 / 4.0);
            ((column - half) / half * 0.7418_f32.tan()).atan().to_degrees()
        });
        if found.is_some_and(|found| (found - wanted).abs() < 0.6) {
            return;
        }
        assert!(begin.elapsed() < super::super::service::PATIENCE, "the post is at {found:?}, not {wanted}");
    }
}

/// Walks in a second world, and asks; the runtime is killed in both.
pub(super) fn lost(_: &Path) {
    let (mut teller, seen) = (Teller::default(), Seen::default());
    let first = World::new(&square(0.0)).unwrap();
    let mut stage = Stage::open(&first, seen.plan(320)).unwrap();
    see_post(&mut stage, &seen, 0.0, &mut teller);
    let mut second = World::new(&square(2.0)).unwrap();
    assert!(stage.show(&second, &mut teller).unwrap());
    let aside = (2.0_f32 + 0.0315).atan2(9.75).to_degrees();
    see_post(&mut stage, &seen, aside, &mut teller);
    eprintln!("walking in the second world");
    while teller.backs == 0 {
        assert!(stage.walk(&mut second, 0.2, &mut teller).unwrap().is_whole, "the session is over");
    }
    see_post(&mut stage, &seen, aside, &mut teller);
    eprintln!("asking");
    let panel = super::asks::likert("after two losses");
    let answered = stage.ask(&panel, &mut teller).unwrap().unwrap();
    tell("answer", &super::asks::told(&answered));
    stage.clear();
    see_post(&mut stage, &seen, aside, &mut teller);
    tell("outcome", &json!(stage.close(&mut teller).unwrap()));
}
