//! Recorded people on stage.

use super::reading::file;
use gaitway::emotion::Emotion;
use gaitway::export::{AgentInfo, Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
use gaitway::ground::is_absent;
use gaitway::library::GaitLibrary;
use gaitway::replay::{Options, Replay, ReplayOptions, Trajectories, read};
use gaitway::scenario::{Crowd, Scenario, Shares, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, setup};
use glam::Vec2;
use std::path::Path;

pub(crate) struct Stage {
    pub(crate) scenario: Scenario,
    pub(crate) crowd: Crowd,
    pub(crate) replay: Replay,
    pub(crate) cast: AvatarSet,
}

impl Stage {
    pub(crate) fn new(recording: &Trajectories, walkers: u32, from: f64) -> Self {
        let library = GaitLibrary::built_in().unwrap();
        let mut scenario = recording.scene("test", walkers, 7);
        scenario.population.avatars = vec!["female".to_owned()];
        scenario.population.scale = [1.0, 1.0];
        scenario.population.emotions = Shares { neutral: 1.0, ..Shares::default() };
        let mut crowd = populate_from(&scenario, &library).unwrap();
        let mut replay = Replay::new(recording, ReplayOptions { from, ..ReplayOptions::default() });
        replay.join(&scenario, &library, &mut crowd).unwrap();
        let avatars = vec![gaitway::avatar::generated(gaitway::avatar::Sex::Female)];
        let cast = AvatarSet::new(library.gaits(), avatars).unwrap();
        Self { scenario, crowd, replay, cast }
    }

    pub(crate) fn start(&self, backend: Backend) -> Option<Simulation> {
        let mut store = setup::store(&self.scenario, &self.scenario.geometry(), &self.crowd, &self.cast);
        self.replay.set_up(&mut store);
        crate::common::gpu::on_device(Simulation::from_store(store, backend, None))
    }

    pub(crate) fn time(&self, step: u32) -> f64 {
        Replay::time_of(step, self.scenario.navigation.time_step)
    }

    /// Greatest distance of a person from the recorded place. Exactly the recorded people are present.
    pub(crate) fn drift(&self, simulation: &mut Simulation) -> f32 {
        let time = self.time(simulation.steps_done());
        let store = simulation.state().unwrap();
        let first = self.replay.first_agent() as usize;
        let off = |person: usize| {
            let here = store.position[first + person];
            let there = self.replay.at(person, time);
            assert_eq!(there.is_none(), is_absent(here), "person {person} at {time} s");
            there.map_or(0.0, |there| there.position.distance(Vec2::from_array(here)))
        };
        (0..self.replay.len()).map(off).fold(0.0, f32::max)
    }
}

/// Four people at 10 frames a second: one all the time, one who comes late, one who leaves early and comes back, one who
/// stands.
pub(crate) fn recording(folder: &Path) -> Trajectories {
    let mut text = String::from("# framerate: 10\n# x/m\n");
    for frame in 0..=100 {
        let t = 0.1 * f64::from(frame);
        text += &format!("1 {frame} {} {}\n", 1.3 * t, 0.5 * (0.8 * t).sin());
        if frame >= 37 {
            text += &format!("2 {frame} {} 3\n", 8.0 - 0.7 * t);
        }
        if !(20..60).contains(&frame) {
            text += &format!("3 {frame} 4 {}\n", -2.0 - 1.6 * t);
        }
        text += &format!("4 {frame} 6 -3\n");
    }
    read(&file(folder, "four.txt", &text), &Options::default()).unwrap()
}

#[test]
fn everyone_is_where_the_recording_says_at_every_step_on_both_backends() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::new(&recording(folder.path()), 0, 0.0);
    let mut hashes = Vec::new();
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let Some(mut simulation) = stage.start(backend) else { continue };
        assert!(stage.drift(&mut simulation) < 1e-6, "and before the first step, too");
        let mut worst = 0_f32;
        for _ in 0..300 {
            stage.replay.step(&mut simulation, 1).unwrap();
            worst = worst.max(stage.drift(&mut simulation));
        }
        println!("{backend:?}: at most {worst:e} m beside the recording");
        assert!(worst < 1e-5, "{worst} m");
        hashes.push(gaitway::sim::measure::state_hash(simulation.state().unwrap()));
        stage.replay.step(&mut simulation, 5).unwrap();
        assert!(simulation.state().unwrap().position.iter().all(|p| is_absent(*p)), "all gone at the end");
    }
    assert!(hashes.windows(2).all(|two| two[0] == two[1]));
}

#[test]
fn gaits_fit_the_speed_and_feet_do_not_slide() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::new(&recording(folder.path()), 0, 0.0);
    let mut simulation = stage.start(Backend::Cpu).unwrap();
    // All are neutral: of those gaits each has one as near to their own speed as there is, or nearly.
    let library = GaitLibrary::built_in().unwrap();
    let of = |id: &u32| library.gaits()[*id as usize].speed;
    let speeds = || library.gaits_for(Emotion::Neutral).iter().map(of);
    let (slowest, fastest) = (speeds().fold(f32::MAX, f32::min), speeds().fold(0.0, f32::max));
    for (person, speed) in [(0, 1.32_f32), (1, 0.7), (2, 1.6)] {
        let (own, nearest) = (of(&stage.crowd.agents[person].gaits[0]), speed.clamp(slowest, fastest));
        println!("person {person} walks {speed} m/s with a gait of {own}; the nearest is {nearest}");
        assert!((own - nearest).abs() < 0.3, "three standard deviations of the choice");
    }
    for _ in 0..90 {
        let before = simulation.state().unwrap().clone();
        stage.replay.step(&mut simulation, 1).unwrap();
        let after = simulation.state().unwrap();
        for person in 0..4 {
            if is_absent(before.position[person]) || is_absent(after.position[person]) {
                continue;
            }
            let way = Vec2::from(before.position[person]).distance(Vec2::from(after.position[person]));
            let strides = f64::from(after.stance[person].phase.wrapping_sub(before.stance[person].phase))
                / 4_294_967_296.0;
            let walked = strides * f64::from(after.stance[person].stride);
            assert!(
                (walked - f64::from(way)).abs() < 1e-5,
                "person {person}: {strides} strides over {way} m"
            );
        }
        assert!(after.stance[3].walk_weight < 1e-6, "who stands does not walk on the spot");
    }
    let state = simulation.state().unwrap();
    let (heading, stance) = (state.heading[0], state.stance[0]);
    assert!((heading - std::f32::consts::FRAC_PI_2).abs() < 0.5, "faces +x, where it goes: {}", heading);
    assert!(stance.walk_weight > 0.99);
}

#[test]
fn the_middle_of_a_recording_can_be_the_start() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::new(&recording(folder.path()), 0, 7.5);
    let mut simulation = stage.start(Backend::Cpu).unwrap();
    let there = |s: &mut Simulation| s.state().unwrap().position.iter().filter(|p| !is_absent(**p)).count();
    assert_eq!(there(&mut simulation), 4);
    assert!(stage.drift(&mut simulation) < 1e-6);
    stage.replay.step(&mut simulation, 75).unwrap();
    assert!(stage.drift(&mut simulation) < 1e-5);
}

#[test]
fn simulated_walkers_make_way_for_recorded_people() {
    let folder = tempfile::tempdir().unwrap();
    let stage = Stage::new(&recording(folder.path()), 12, 0.0);
    assert_eq!((stage.crowd.agents.len(), stage.replay.first_agent()), (16, 12));
    let mut simulation = stage.start(Backend::Cpu).unwrap();
    let mut hit = 0;
    for step in 0..300 {
        stage.replay.step(&mut simulation, 1).unwrap();
        assert!(stage.drift(&mut simulation) < 1e-5, "recorded people do not give way");
        let store = simulation.state().unwrap();
        let led: Vec<Vec2> = store.position[12..].iter().map(|p| Vec2::from(*p)).collect();
        for walker in &store.position[..12] {
            let nearest = led.iter().map(|p| p.distance(Vec2::from(*walker))).fold(f32::MAX, f32::min);
            hit += u32::from(step > 30 && nearest < 0.4);
        }
    }
    assert!(hit < 10, "{hit} times a walker was within 0.4 m of a recorded person");
}

#[test]
fn what_a_simulation_wrote_is_walked_again_and_written_again_in_every_format() {
    let library = GaitLibrary::built_in().unwrap();
    let scenario = Scenario::builtin("garden").unwrap().with_agents(12);
    let crowd = populate_from(&scenario, &library).unwrap();
    let avatars = || {
        use gaitway::avatar::{Sex, generated};
        vec![generated(Sex::Female), generated(Sex::Male)]
    };
    let cast = AvatarSet::new(library.gaits(), avatars()).unwrap();
    let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let mut frames: Vec<(Vec<Vec2>, Vec<f32>)> = Vec::new();
    for step in 0..=90 {
        if step > 0 {
            simulation.step(1).unwrap();
        }
        if step % 3 == 0 {
            let store = simulation.state().unwrap();
            let positions = store.position[..12].iter().map(|p| Vec2::from(*p)).collect();
            frames.push((positions, store.heading[..12].to_vec()));
        }
    }
    let walkable = Walkable::from(&scenario.geometry());
    for name in ["run.sqlite", "run.parquet", "run.txt", "run.csv"] {
        let path = folder.path().join(name);
        let format = TrajectoryFormat::from_path(&path).unwrap();
        let agents = AgentInfo::of_crowd(&scenario, &crowd, &cast, None);
        let mut writer = TrajectoryWriter::create(&path, format, 10.0, &walkable, agents).unwrap();
        for (positions, headings) in &frames {
            writer.frame(&Frame { positions, headings, ..Frame::default() }).unwrap();
        }
        writer.finish().unwrap();
        let found = read(&path, &Options::default()).unwrap();
        assert_eq!((found.tracks.len(), found.report.samples), (12, 12 * 31), "{name}");
        assert!((found.frame_rate - 10.0).abs() < 1e-6, "{name}: {}", found.frame_rate);
        let stage = Stage::new(&found, 0, 0.0);
        let mut again = stage.start(Backend::Cpu).unwrap();
        let mut worst = 0_f32;
        for (number, (positions, _)) in frames.iter().enumerate() {
            if number > 0 {
                stage.replay.step(&mut again, 3).unwrap();
            }
            let store = again.state().unwrap();
            let off = store.position.iter().zip(positions).map(|(a, b)| Vec2::from(*a).distance(*b));
            worst = off.fold(worst, f32::max);
        }
        println!("{name}: at most {worst:e} m beside the simulation that wrote it");
        assert!(worst < 1e-3, "{name}: {worst} m");
    }
}

#[test]
fn people_feel_what_the_scene_says() {
    let folder = tempfile::tempdir().unwrap();
    let recording = recording(folder.path());
    let library = GaitLibrary::built_in().unwrap();
    let mut scenario = recording.scene("test", 0, 1);
    scenario.population.emotions = Shares { sad: 1.0, ..Shares::default() };
    let mut crowd = Crowd::default();
    Replay::new(&recording, ReplayOptions::default()).join(&scenario, &library, &mut crowd).unwrap();
    assert_eq!(crowd.agents.len(), 4);
    assert!(crowd.agents.iter().all(|agent| agent.emotion == Emotion::Sad.weights()));
}
