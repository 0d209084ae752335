//! The crowd in the window: stepped by the clock, drawn, queried, timed, filmed.

use super::pick::{self, Pillar, Ray};
use super::times::Times;
use super::{Choice, Plan};
use crate::export::video::Video;
use crate::gpu::Device;
use crate::ground::world_from_ground;
use crate::kernels::Store;
use crate::kernels::layout::Stage;
use crate::kernels::shared::stages;
use crate::picture::Image;
use crate::render::camera::View;
use crate::render::{Markers, Settings, Show, Target};
use crate::scenario::{EnvironmentMesh, Gaze, GazeMode, Shares};
use crate::scene::{Scene, SceneBuilder, Start, atmosphere};
use crate::sim::bodies::MeshBuffers;
use crate::sim::snapshots::make_room;
use crate::sim::{Person, Simulation};
use glam::{Vec2, Vec3};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Longest the crowd may fall behind the clock before it lets time pass, s at the speed of the clock.
const LONGEST_ARREARS: f64 = 0.25;
/// Longest that stepping may keep a frame waiting.
const LONGEST_STEPPING: Duration = Duration::from_millis(80);
/// Frames a second of simulated time in videos.
pub(super) const FILM_RATE: f64 = 30.0;
/// Most frames that one is repeated for in a video: the crowd ran faster than could be drawn.
const MOST_REPEATED: u64 = 30;
/// An agent that was picked, as it is now.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Picked {
    /// Number of the agent.
    pub id: u32,
    /// The emotion felt most.
    pub emotion: &'static str,
    /// Weights of happy, angry, sad and neutral.
    pub weights: [f32; 4],
    /// Ground position (x, z), m.
    pub position: [f32; 2],
    /// Height of the floor stood on, m.
    pub elevation: f32,
    /// Speed, m/s.
    pub speed: f32,
    /// The speed it would like, m/s.
    pub preferred_speed: f32,
    /// Heading about +y, degrees; 0 faces +z.
    pub heading_deg: f32,
    /// Share of the walk in its posture: 0 stands, 1 walks.
    pub walking: f32,
    /// Stage of the way it is on, from 1, and how many there are.
    pub stage: [u32; 2],
    /// What that stage is.
    pub stage_kind: &'static str,
    /// Where it is (x, z), m.
    pub goal: [f32; 2],
    /// How often the whole way was walked.
    pub rounds: u32,
}

impl Picked {
    /// A person with what the buffers say of its way.
    fn of(store: &Store, person: &Person) -> Option<Self> {
        let i = person.id as usize;
        let walking = store.stance.get(i)?.walk_weight;
        let route = *store.route.get(i)?;
        let length = route.length().max(1);
        let at = route.next.min(length - 1);
        let Stage { place: [x, z], kind, .. } =
            store.stages.get((route.first + at) as usize).copied().unwrap_or_default();
        let rounds = route.arrivals;
        Some(Self {
            id: person.id,
            emotion: person.emotion().name(),
            weights: person.emotions,
            position: person.position.to_array(),
            elevation: person.elevation,
            speed: person.velocity.length(),
            preferred_speed: store.body.get(i)?.preferred_speed,
            heading_deg: person.heading.to_degrees(),
            walking,
            stage: [at + 1, length],
            stage_kind: kind_name(kind),
            goal: [x, z],
            rounds,
        })
    }
}

fn kind_name(kind: f32) -> &'static str {
    let known = [
        (stages::WAYPOINT, "waypoint"),
        (stages::GOAL, "goal"),
        (stages::WAITING, "waiting area"),
        (stages::QUEUE, "queue"),
        (stages::EXIT, "exit"),
    ];
    known.into_iter().find(|(value, _)| (value - kind).abs() < 0.5).map_or("place", |(_, name)| name)
}

/// A video that is being made.
struct Film {
    video: Video,
    /// Time of the crowd at its beginning, s.
    begin: f64,
}

/// The crowd in the window.
pub(super) struct Company {
    /// What the crowd is cast from, again and again.
    builder: SceneBuilder,
    scene: Scene,
    /// The eyes of the scene's user, or of an onlooker, m.
    user_eyes: Vec3,
    simulation: Simulation,
    show: Show,
    device: Arc<Device>,
    scenery: EnvironmentMesh,
    settings: Settings,
    gaze: Gaze,
    height: f32,
    arrears: f64,
    /// Time of the crowd that is shown, s: up to a step ago, so that it is there to be shown.
    shown: f64,
    film: Option<Film>,
    /// Times of the kernels of steps, and of frames.
    pub(super) times: [Times; 2],
}

impl Company {
    /// Puts the crowd of a scene on stage; `builder` makes others like it.
    pub(super) fn new(
        device: &Arc<Device>,
        (builder, mut scene): (SceneBuilder, Scene),
        plan: &Plan,
        [width, height]: [u32; 2],
    ) -> Result<Self, crate::Error> {
        let (user_eyes, _) = scene.onlooker();
        let settings = Settings {
            atmosphere: atmosphere(scene.scenario.layout),
            markers: plan.has_markers.then(Markers::default),
            quality: plan.quality,
            ..Settings::sized(width, height)
        };
        let scenery = scene.geometry.scenery_of(settings.quality.finish());
        let gaze = scene.scenario.gaze;
        let (start, meshes) = scene.buffers_with_bodies()?;
        let looks = Looks { scenery: &scenery, settings, gaze: &gaze };
        let Staged { simulation, show, height } = stage(&scene, start, &meshes, device, &looks)?;
        let mut company = Self {
            builder,
            scene,
            user_eyes,
            simulation,
            show,
            device: device.clone(),
            scenery,
            settings,
            gaze,
            height,
            arrears: 0.0,
            shown: 0.0,
            film: None,
            times: Default::default(),
        };
        company.measure();
        Ok(company)
    }

    /// The scene as it is cast now.
    pub(super) const fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The eyes of the scene's user, or of an onlooker, m.
    pub(super) const fn user_eyes(&self) -> Vec3 {
        self.user_eyes
    }

    /// Other feelings in the same places: the crowd goes on where the one before was.
    pub(super) fn recast(&mut self, choice: &Choice) -> Result<(), crate::Error> {
        let [happy, angry, sad, neutral] = choice.shares;
        let emotions = Shares { happy, angry, sad, neutral };
        let builder = self.builder.clone().condition(choice.condition);
        let scene = builder.change(|scenario| scenario.population.emotions = emotions).build()?;
        let (mut start, meshes) = scene.buffers_with_bodies()?;
        carry_on(self.simulation.state()?, &mut start.store);
        let looks = Looks { scenery: &self.scenery, settings: self.settings, gaze: &self.gaze };
        let made = stage(&scene, start, &meshes, &self.device, &looks)?;
        (self.simulation, self.show, self.height) = (made.simulation, made.show, made.height);
        self.scene = scene;
        self.measure();
        Ok(())
    }

    fn measure(&mut self) {
        self.simulation.measure_times(true);
        self.show.measure_times(true);
    }

    pub(super) fn set_gaze_mode(&mut self, mode: GazeMode) {
        self.gaze.mode = mode;
        self.show.set_gaze(&self.gaze);
    }

    pub(super) fn set_markers(&mut self, are_wanted: bool) {
        self.settings.markers = are_wanted.then(Markers::default);
        self.show.renderer().set_markers(self.settings.markers);
    }

    pub(super) fn resize(&mut self, [width, height]: [u32; 2]) -> Result<(), crate::Error> {
        if [self.settings.width, self.settings.height] != [width, height] {
            self.show.renderer().resize(width, height)?;
            (self.settings.width, self.settings.height) = (width, height);
        }
        Ok(())
    }

    /// Lets `seconds` of the wall's clock pass at `speed` times its rate; how many steps that were.
    pub(super) fn pass(&mut self, seconds: f64, speed: f64) -> Result<u32, crate::Error> {
        let time_step = f64::from(self.simulation.store().step.time_step);
        self.arrears = (self.arrears + seconds * speed).min((LONGEST_ARREARS * speed).max(time_step));
        let begin = Instant::now();
        let mut steps = 0;
        while self.arrears >= time_step && begin.elapsed() < LONGEST_STEPPING {
            self.scene.step(&mut self.simulation, 1)?;
            self.arrears -= time_step;
            steps += 1;
        }
        self.shown = self.simulation.time() + self.arrears - time_step;
        self.record_steps(begin, steps);
        Ok(steps)
    }

    /// Does one step, whatever the clock says.
    pub(super) fn step_once(&mut self) -> Result<(), crate::Error> {
        self.arrears = 0.0;
        let begin = Instant::now();
        self.scene.step(&mut self.simulation, 1)?;
        self.shown = self.simulation.time();
        self.record_steps(begin, 1);
        Ok(())
    }

    /// Records how long steps took.
    fn record_steps(&mut self, begin: Instant, steps: u32) {
        let measured = self.simulation.take_times();
        self.times[0].take(&measured, steps, begin.elapsed());
    }

    /// Draws the crowd into an image of the window's size; returns the copy that `target` asks for.
    pub(super) fn draw(
        &mut self,
        view: &View,
        user_eyes: Vec3,
        target: &Target,
    ) -> Result<Option<Image>, crate::Error> {
        let target = Target { is_copied: target.is_copied || self.film.is_some(), ..*target };
        let begin = Instant::now();
        let image = self.show.draw_between(&mut self.simulation, view, user_eyes, self.shown, &target)?;
        // a crowd on the CPU is animated by the show, on the device that draws
        let mut measured = self.simulation.take_times();
        measured.extend(self.show.take_times());
        self.times[1].take(&measured, 1, begin.elapsed());
        if let (Some(film), Some(image)) = (&mut self.film, &image) {
            let since = (self.simulation.time() - film.begin) * FILM_RATE;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a count of pictures")]
            let due = since as u64 + 1;
            let missing = due.saturating_sub(film.video.frames()).min(MOST_REPEATED);
            for _ in 0..missing {
                film.video.push(image).map_err(crate::export::Error::from)?;
            }
        }
        Ok(image)
    }

    /// Begins a video of what is seen.
    pub(super) fn begin_film(&mut self, path: &Path) -> Result<(), crate::Error> {
        let Settings { width, height, .. } = self.settings;
        let video = Video::create(path, width, height, FILM_RATE).map_err(crate::export::Error::from)?;
        self.film = Some(Film { video, begin: self.simulation.time() });
        Ok(())
    }

    /// Ends the video, if one is being made; its file and number of frames.
    pub(super) fn end_film(&mut self) -> Result<Option<(PathBuf, u64)>, crate::Error> {
        let Some(film) = self.film.take() else { return Ok(None) };
        let frames = film.video.frames();
        Ok(Some((film.video.finish().map_err(crate::export::Error::from)?, frames)))
    }

    pub(super) const fn is_filmed(&self) -> bool {
        self.film.is_some()
    }

    /// Who stands under a ray, before the scenery hides them.
    pub(super) fn pick(&mut self, ray: &Ray) -> Result<Option<u32>, crate::Error> {
        let height = self.height;
        let store = self.simulation.state()?;
        let agents = store.step.agent_count as usize;
        let people = store.position.iter().take(agents).enumerate().map(|(i, position)| Pillar {
            position: *position,
            foot: store.elevation.get(i).copied().unwrap_or(0.0),
            radius: store.body.get(i).map_or(0.3, |body| body.radius),
            height,
        });
        let found = pick::first(ray, people, pick::wall(ray, &self.scenery));
        Ok(found.and_then(|(number, _)| u32::try_from(number).ok()))
    }

    /// An agent as it is now, unless it is not there.
    pub(super) fn picked(&mut self, agent: u32) -> Result<Option<Picked>, crate::Error> {
        let Some(person) = self.simulation.person(agent)? else { return Ok(None) };
        Ok(Picked::of(self.simulation.store(), &person))
    }

    /// Where an agent stands and how tall it is at most, m.
    pub(super) fn place(person: &Picked) -> Vec3 {
        world_from_ground(Vec2::from_array(person.position), person.elevation)
    }

    pub(super) const fn height(&self) -> f32 {
        self.height
    }

    pub(super) fn time(&self) -> f64 {
        self.simulation.time()
    }

    pub(super) fn steps(&self) -> u32 {
        self.simulation.steps_done()
    }

    pub(super) fn agents(&self) -> u32 {
        self.simulation.store().step.agent_count
    }

    pub(super) fn devices(&self) -> (String, String) {
        (self.show.device(), self.simulation.device())
    }
}

/// How a crowd is drawn.
struct Looks<'a> {
    scenery: &'a EnvironmentMesh,
    settings: Settings,
    gaze: &'a Gaze,
}

/// A crowd on stage.
struct Staged {
    simulation: Simulation,
    show: Show,
    height: f32,
}

/// Puts a crowd on stage.
fn stage(
    scene: &Scene,
    mut start: Start,
    meshes: &MeshBuffers,
    device: &Arc<Device>,
    looks: &Looks<'_>,
) -> Result<Staged, crate::Error> {
    let height = start.store.frame.agent_height;
    make_room(&mut start.store);
    let simulation = if scene.backend.is_cpu() {
        Simulation::from_store(start.store, scene.backend, None)?
    } else {
        Simulation::on_device(start.store, device)?
    };
    let mut simulation = scene.introduce(simulation, start.ways);
    let mut show = Show::with_device(&mut simulation, meshes, looks.scenery, looks.settings, device)?;
    show.set_gaze(looks.gaze);
    Ok(Staged { simulation, show, height })
}

/// Gives a crowd the places and ways of another one of as many people.
fn carry_on(before: &Store, after: &mut Store) {
    if before.step.agent_count != after.step.agent_count || before.stages != after.stages {
        return;
    }
    after.step.step_index = before.step.step_index;
    macro_rules! copy {
        ($($field:ident),*) => {
            $(if before.$field.len() == after.$field.len() { after.$field.clone_from(&before.$field); })*
        };
    }
    copy!(
        elevation,
        position,
        velocity,
        heading,
        stance,
        route,
        stage_progress,
        queues,
        sources,
        waiting,
        lead,
        paths
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::layout::{Body, Route, Stance};
    use crate::kernels::shared::stages::GOAL;

    fn store() -> Store {
        let mut store = Store {
            position: vec![[1.0, 2.0], [crate::ground::ABSENT; 2]],
            velocity: vec![[3.0, 4.0]; 2],
            heading: vec![std::f32::consts::FRAC_PI_2; 2],
            stance: vec![Stance { walk_weight: 1.0, stride: 1.4, ..Stance::default() }; 2],
            route: vec![Route { arrivals: 3, ..Route::new(1, 2, true, 1) }; 2],
            body: vec![
                Body {
                    radius: 0.3,
                    max_speed: 2.0,
                    preferred_speed: 1.5,
                    walk_ratio: 0.4,
                    ..Body::default()
                };
                2
            ],
            stages: [0.0, 4.0, 8.0].map(|x| Stage { kind: GOAL, ..Stage::waypoint([x, 0.5], 0.0) }).to_vec(),
            ..Store::default()
        };
        store.step.agent_count = 2;
        store
    }

    #[test]
    fn a_person_is_described_with_emotion_speed_and_goal() {
        let emotions = [[0.1, 0.4, 0.4, 0.1]; 2];
        let of = |id| Picked::of(&store(), &Person::of(&store(), &emotions, id)?);
        let person = of(0).unwrap();
        assert_eq!((person.emotion, person.stage, person.stage_kind), ("angry", [2, 2], "goal"));
        assert!((person.speed - 5.0).abs() < 1e-6 && (person.heading_deg - 90.0).abs() < 1e-4);
        assert_eq!((person.goal, person.rounds), ([8.0, 0.5], 3));
        assert_eq!(of(1), None, "absent");
        assert_eq!(of(2), None, "no agent");
    }

    #[test]
    fn a_new_cast_goes_on_where_the_old_one_was_unless_it_is_of_other_people() {
        let mut before = store();
        before.step.step_index = 90;
        let mut after = Store { position: vec![[0.0; 2]; 2], ..store() };
        carry_on(&before, &mut after);
        assert_eq!((after.step.step_index, &after.position), (90, &before.position));
        let mut other = store();
        other.step.agent_count = 1;
        carry_on(&before, &mut other);
        assert_eq!(other.step.step_index, 0);
    }
}
