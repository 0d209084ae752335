//! Recorded people as agents of a scene.

use super::error::Error;
use super::path::{Moment, Path};
use super::read::tracks::Trajectories;
use crate::ground::heading_from_ground;
use crate::kernels::Store;
use crate::kernels::layout::Stance;
use crate::library::GaitLibrary;
use crate::scenario::random::{Purpose, index};
use crate::scenario::{
    Clearance, Crowd, ExternalPerson, MAX_AGENTS, Obstacle, Route, RouteMode, Scenario, polygon,
    populate_people,
};
use crate::sim::{Simulation, measure, setup};
use glam::Vec2;

/// A person slower than this between two samples stands, m/s.
const STANDS: f64 = 0.2;
/// A person that appears faster than this appears in mid-stride, m/s.
const WALKS: f32 = 0.05;
/// Ground about the outermost positions where the recording has no walkable area, m.
const MARGIN: f32 = 2.0;
/// Least steps a second: fewer, and bodies turn in jerks.
const STEPS: f64 = 30.0;
/// Ways through a recorded place that walkers beside the recorded people take.
const WAYS: u32 = 12;
/// Shortest such way, m.
const SHORTEST_WAY: f32 = 4.0;

/// How to replay.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ReplayOptions {
    /// Standard deviation of the smoothing against tracking jitter, s; 0: through every sample.
    pub smooth: f64,
    /// Where in the recording the simulation begins, s.
    pub from: f64,
}

/// A recording on stage: one agent for each of its people, in the order of their numbers in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Replay {
    /// Of each person the paths, one for every time they are there.
    people: Vec<Vec<Path>>,
    /// Number of each person in the file.
    ids: Vec<i64>,
    first_agent: u32,
    from: f64,
}

impl Replay {
    /// The people of a recording.
    pub fn new(recording: &Trajectories, options: ReplayOptions) -> Self {
        let (mut people, mut ids): (Vec<Vec<Path>>, Vec<i64>) = (Vec::new(), Vec::new());
        for track in &recording.tracks {
            let path = Path::new(track, options.smooth);
            match people.last_mut().filter(|_| ids.last() == Some(&track.person)) {
                Some(paths) => paths.push(path),
                None => {
                    people.push(vec![path]);
                    ids.push(track.person);
                }
            }
        }
        Self { people, ids, first_agent: 0, from: options.from }
    }

    /// How many people there are.
    pub const fn len(&self) -> usize {
        self.people.len()
    }

    /// Whether the recording has no people.
    pub const fn is_empty(&self) -> bool {
        self.people.is_empty()
    }

    /// Number of a person in the file, by place.
    pub fn id(&self, person: usize) -> Option<i64> {
        self.ids.get(person).copied()
    }

    /// Index of the first person's agent; the others follow.
    pub const fn first_agent(&self) -> u32 {
        self.first_agent
    }

    /// Where a person is `time` seconds after the simulation's start; `None`: not there.
    pub fn at(&self, person: usize, time: f64) -> Option<Moment> {
        let paths = self.people.get(person)?;
        let time = time + self.from;
        // the last path that has begun, give or take a rounding
        let begun = paths.partition_point(|path| path.span().0 <= time + 1e-4);
        paths.get(begun.checked_sub(1)?)?.at(time)
    }

    /// Adds the people to a crowd, each with a gait near their own mean walking speed.
    ///
    /// # Errors
    /// When there would be more than [`MAX_AGENTS`], or an emotion in use has no gait.
    pub fn join(
        &mut self,
        scenario: &Scenario,
        library: &GaitLibrary,
        crowd: &mut Crowd,
    ) -> Result<(), crate::Error> {
        let total = crowd.agents.len() + self.people.len();
        if total > MAX_AGENTS as usize {
            return Err(Error::TooMany { found: total, most: MAX_AGENTS }.into());
        }
        self.first_agent = u32::try_from(crowd.agents.len()).unwrap_or(u32::MAX);
        let person = |paths: &Vec<Path>| {
            let start = paths.first().and_then(|path| path.at(path.span().0));
            #[allow(clippy::cast_possible_truncation, reason = "a speed")]
            let speeds = paths.iter().filter_map(|path| path.walking_speed(STANDS)).map(|speed| speed as f32);
            let speeds: Vec<f32> = speeds.collect();
            #[allow(clippy::cast_precision_loss, reason = "a handful")]
            let mean = speeds.iter().sum::<f32>() / speeds.len().max(1) as f32;
            ExternalPerson {
                position: start.map_or(Vec2::ZERO, |moment| moment.position),
                heading: start.map_or(0.0, facing),
                speed: (!speeds.is_empty()).then_some(mean),
            }
        };
        let people: Vec<ExternalPerson> = self.people.iter().map(person).collect();
        crowd.agents.extend(populate_people(scenario, library, self.first_agent, &people)?);
        Ok(())
    }

    /// Marks the people's agents as led, and places those present at the start.
    pub fn set_up(&self, store: &mut Store) {
        for (person, agent) in (self.first_agent..).take(self.people.len()).enumerate() {
            setup::set_led(store, agent);
            let Some(start) = self.at(person, 0.0) else { continue };
            let agent = agent as usize;
            let walks = start.velocity.length() > WALKS;
            store.position[agent] = start.position.to_array();
            store.velocity[agent] = start.velocity.to_array();
            let stride = store.body[agent].stride_at(start.velocity.length());
            store.heading[agent] = facing(start);
            store.stance[agent] = Stance {
                phase: store.stance[agent].phase,
                walk_weight: if walks { 1.0 } else { 0.0 },
                stride,
                ..Stance::default()
            };
        }
    }

    /// Time after a number of steps, s ([`measure::time_of`]).
    pub fn time_of(steps: u32, time_step: f32) -> f64 {
        measure::time_of(steps, time_step)
    }

    /// Sets the place of every person at the end of the next step. Call it before every single step.
    ///
    /// # Errors
    /// When the simulation's store was not [set up](Self::set_up).
    pub fn lead(&self, simulation: &mut Simulation) -> Result<(), crate::Error> {
        let time = Self::time_of(simulation.steps_done() + 1, simulation.store().step.time_step);
        for (person, agent) in (self.first_agent..).take(self.people.len()).enumerate() {
            let target = self.at(person, time).map(|moment| (moment.position, moment.velocity));
            simulation.lead(agent, target)?;
        }
        Ok(())
    }

    /// Leads and steps `count` times.
    ///
    /// # Errors
    /// As [`Simulation::step`].
    pub fn step(&self, simulation: &mut Simulation, count: u32) -> Result<(), crate::Error> {
        for _ in 0..count {
            self.lead(simulation)?;
            simulation.step(1)?;
        }
        Ok(())
    }
}

/// Heading of a person, rad: along the velocity, or as recorded while standing.
fn facing(moment: Moment) -> f32 {
    if moment.velocity.length() > WALKS {
        heading_from_ground(moment.velocity)
    } else {
        moment.heading.unwrap_or(0.0)
    }
}

impl Trajectories {
    /// A scene for the recording: its walkable area, or the ground under its positions; steps that hit its frames; and
    /// `walkers` simulated agents that follow the ways of recorded people.
    pub fn scene(&self, name: &str, walkers: u32, seed: u64) -> Scenario {
        let word = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
        let name: String = name.chars().take(64).map(word).collect();
        let mut scenario = Scenario {
            name: if name.is_empty() { "replay".to_owned() } else { name },
            seed,
            ..Scenario::default()
        };
        let positions = || self.tracks.iter().flat_map(|t| &t.samples).map(|s| s.position);
        let low = positions().fold(Vec2::MAX, Vec2::min) - MARGIN;
        let high = positions().fold(Vec2::MIN, Vec2::max) + MARGIN;
        let points = |ring: &[Vec2]| ring.iter().map(Vec2::to_array).collect();
        match self.area.as_deref() {
            Some([outer, holes @ ..]) => {
                scenario.bounds = points(outer);
                scenario.obstacles = holes
                    .iter()
                    .map(|hole| Obstacle { polygon: points(hole), low: None, high: None })
                    .collect();
            }
            _ => scenario.bounds = points(&polygon::rectangle((low + high) * 0.5, high - low, 0.0)),
        }
        // A whole number of steps a frame.
        let steps = self.frame_rate * (STEPS / self.frame_rate - 1e-9).ceil().max(1.0);
        #[allow(clippy::cast_possible_truncation, reason = "a time step")]
        let time_step = (1.0 / steps) as f32;
        scenario.navigation.time_step = time_step;
        scenario.population.agents = walkers;
        if walkers > 0 {
            scenario.routes = self.ways(&scenario, seed);
        }
        scenario
    }

    /// Straight ways between the first and last places of people, where no obstacle stands between.
    fn ways(&self, scenario: &Scenario, seed: u64) -> Vec<Route> {
        let geometry = scenario.geometry();
        let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
        let mut ways = Vec::new();
        for draw in 0..20 * WAYS {
            let Some(track) = self.tracks.get(index(seed, 0, Purpose::Start, draw, self.tracks.len())) else {
                break;
            };
            let (Some(first), Some(last)) = (track.samples.first(), track.samples.last()) else { continue };
            let (from, to) = (first.position, last.position);
            if from.distance(to) < SHORTEST_WAY || !free.passes(from, to, 1.0) {
                continue;
            }
            ways.push(Route {
                name: format!("way-{}", ways.len() + 1),
                waypoints: vec![from.to_array(), to.to_array()],
                width: 1.0,
                radius: 1.0,
                mode: RouteMode::Patrol,
                weight: 1.0,
            });
            if ways.len() >= WAYS as usize {
                break;
            }
        }
        ways
    }
}
