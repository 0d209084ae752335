//! Small scenes for tests: a walkable area, people with their own speeds and ways, and three ways to lay them on the grid.

use super::tracks::Tracks;
use crate::Error;
use crate::avatar::{Sex, generated};
use crate::emotion::Emotion;
use crate::gait::walker;
#[cfg(feature = "vulkan")]
use crate::gpu::Device;
use crate::kernels::Store;
use crate::kernels::layout::Route;
use crate::scenario::{AgentStart, Clearance, Crowd, Obstacle, Scenario, Stop};
use crate::scene::{Scene, Start};
use crate::sim::{AvatarSet, Backend, Simulation, setup};
use glam::Vec2;
use serde::Serialize;
#[cfg(feature = "vulkan")]
use std::sync::Arc;

/// Degrees by which a scene is turned in [`Variant::Rotated`].
pub const TURN_DEG: f32 = 37.0;

/// Distances to walls are measured up to this, m.
pub const NEAR_WALL: f32 = 0.5;

/// Steps that a scene goes on after everyone has come where it ends.
const AFTER: u32 = 300;

/// How a scene lies on the grid of the neighbour search, and on the axes: results must not depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Variant {
    /// As described.
    AsIs,
    /// Turned by [`TURN_DEG`] about the origin.
    Rotated,
    /// Moved by half a cell in x and z, while the grid stays.
    Shifted,
}

impl Variant {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::AsIs, Self::Rotated, Self::Shifted];

    /// Its name in reports.
    pub const fn name(self) -> &'static str {
        match self {
            Self::AsIs => "as-is",
            Self::Rotated => "rotated",
            Self::Shifted => "shifted",
        }
    }
}

/// One person of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Walker {
    /// Start, m.
    pub position: Vec2,
    /// Free speed, m/s.
    pub speed: f32,
    /// Disc radius, m.
    pub radius: f32,
    /// Where to: points and how near one must come, m.
    pub way: Vec<(Vec2, f32)>,
    /// The point walked to first.
    pub next: usize,
    /// After the last point to the first one again; otherwise stay there.
    pub loops: bool,
    /// The others of the group that they walk with; `u32::MAX` for none.
    pub companions: [u32; 4],
}

/// A scene.
#[derive(Debug, Clone)]
pub struct Experiment {
    /// Everything but the people: bounds, obstacles, navigation, seed.
    pub scenario: Scenario,
    /// The people.
    pub walkers: Vec<Walker>,
    /// How long it runs, s.
    pub seconds: f32,
    /// Steps between two recorded frames.
    pub every: u32,
    /// It ends when everyone has come to this point of their way.
    pub until: Option<u32>,
}

/// Something broken on purpose, to see that tests notice.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Fault {
    /// Nothing.
    #[default]
    None,
    /// Everyone walks at half their speed.
    HalfSpeed,
    /// No agent walks.
    Frozen,
    /// There are no walls.
    NoWalls,
    /// No agent avoids another.
    Blind,
    /// No agent belongs to a group.
    Alone,
}

/// What all tests run on: the backend and device, a body and its gait.
#[derive(Debug)]
pub struct Equipment {
    cast: AvatarSet,
    /// What runs the kernels where there is no device.
    on_cpu: Backend,
    #[cfg(feature = "vulkan")]
    device: Option<Arc<Device>>,
    /// Why the CPU is used although Vulkan was tried.
    pub fallback: Option<String>,
    /// What is broken.
    #[doc(hidden)]
    pub fault: Fault,
}

impl Equipment {
    /// A body to walk with, and the backend; a device is opened once for all scenes.
    ///
    /// # Errors
    /// When the walker cannot be made, or a Vulkan device is demanded but cannot be used.
    pub fn new(backend: Backend, device: Option<&str>) -> Result<Self, Error> {
        let gait = walker::person(Emotion::Neutral, walker::Sex::Female, 1, 0)?;
        let cast = AvatarSet::new(&[gait], vec![generated(Sex::Female)])?;
        let on_cpu = if backend.is_cpu() { backend } else { Backend::Cpu };
        #[cfg(feature = "vulkan")]
        {
            let opened = (!backend.is_cpu()).then(|| backend.open(device));
            let (device, fallback) = match opened {
                None => (None, None),
                Some(Ok(device)) => (Some(device), None),
                Some(Err(error)) if backend.falls_back(device) => (None, Some(error.to_string())),
                Some(Err(error)) => return Err(error.into()),
            };
            Ok(Self { cast, on_cpu, device, fallback, fault: Fault::None })
        }
        #[cfg(not(feature = "vulkan"))]
        if backend == Backend::Vulkan || (backend == Backend::Auto && !backend.falls_back(device)) {
            Err(crate::sim::Error::NoVulkan.into())
        } else {
            Ok(Self { cast, on_cpu, fallback: None, fault: Fault::None })
        }
    }

    /// Whether crowds walk on a device; else on the CPU.
    pub const fn is_on_device(&self) -> bool {
        #[cfg(feature = "vulkan")]
        return self.device.is_some();
        #[cfg(not(feature = "vulkan"))]
        false
    }

    fn simulation(&self, scene: &Scene, start: Start) -> Result<Simulation, Error> {
        #[cfg(feature = "vulkan")]
        if let Some(device) = &self.device {
            let simulation = Simulation::steps_on(start.store, device)?;
            return Ok(scene.introduce(simulation, start.ways));
        }
        let simulation = Simulation::from_store(start.store, self.on_cpu, None)?;
        Ok(scene.introduce(simulation, start.ways))
    }
}

/// A run of a scene.
#[derive(Debug, Clone)]
pub struct Run {
    /// Where everyone was, in the scene's own axes.
    pub tracks: Tracks,
    /// Ways walked to their end, by person.
    pub arrivals: Vec<u32>,
    /// Positions outside the walkable area, over all recorded frames and people.
    pub outside: u32,
    /// Largest number of pairs in a frame that overlap by more than a tenth.
    pub overlapping: u32,
    /// How near the centre of anyone came to a wall, over all recorded frames, m; at most [`NEAR_WALL`].
    pub nearest_wall: f32,
    /// Hash of the last state.
    pub hash: u64,
    /// What it ran on.
    pub device: String,
}

impl Experiment {
    /// An empty scene with walls along `bounds`.
    ///
    /// # Errors
    /// When the built-in defaults are refused, which would be an error of the program.
    pub fn new(name: &str, bounds: &[[f32; 2]], seconds: f32) -> Result<Self, Error> {
        let text = format!("name = \"{name}\"\nbounds = {bounds:?}\n[population]\nagents = 0\n");
        let scenario = Scenario::parse(&text, name)?;
        Ok(Self { scenario, walkers: Vec::new(), seconds, every: 3, until: None })
    }

    /// Adds something solid.
    pub fn solid(&mut self, polygon: &[[f32; 2]]) {
        self.scenario.obstacles.push(Obstacle { polygon: polygon.to_vec(), low: None, high: None });
    }

    /// Steps of the run.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "minutes of thirty steps a second"
    )]
    pub fn steps(&self) -> u32 {
        (self.seconds / self.scenario.navigation.time_step).round() as u32
    }

    /// The simulation at its start, and the way back from its axes to the scene's own.
    ///
    /// # Errors
    /// When the device cannot be used.
    pub fn start(&self, equipment: &Equipment, variant: Variant) -> Result<(Simulation, Frame), Error> {
        let mut frame = Frame::default();
        if variant == Variant::Rotated {
            frame.turn = Vec2::from_angle(TURN_DEG.to_radians());
        }
        let mut scene = self.scene(frame, equipment);
        let mut start = scene.buffers()?;
        if variant == Variant::Shifted {
            // the same grid under everything moved by half of one of its cells
            let (cell, origin) = (start.store.step.cell_size, start.store.step.grid_origin);
            frame.shift = Vec2::splat(0.5 * cell);
            scene = self.scene(frame, equipment);
            start = scene.buffers()?;
            let step = &mut start.store.step;
            step.grid_origin = origin;
            step.grid_columns += 1;
            step.grid_rows += 1;
            step.cell_count = step.grid_columns * step.grid_rows;
            let polygons: Vec<Vec<[f32; 2]>> =
                scene.geometry.outlines().map(|o| o.iter().map(Vec2::to_array).collect()).collect();
            setup::set_obstacles(&mut start.store, &polygons);
            setup::scratch(&mut start.store);
        }
        equipment.fault.apply(&mut start.store);
        Ok((equipment.simulation(&scene, start)?, frame))
    }

    /// The place and its people, turned and moved.
    fn scene(&self, frame: Frame, equipment: &Equipment) -> Scene {
        let mut scenario = self.scenario.clone();
        let obstacles = scenario.obstacles.iter_mut().map(|obstacle| &mut obstacle.polygon);
        for point in std::iter::once(&mut scenario.bounds).chain(obstacles).flatten() {
            *point = frame.there((*point).into()).to_array();
        }
        let mut crowd = Crowd::default();
        for (index, walker) in self.walkers.iter().enumerate() {
            let first = crowd.stages.len();
            let points = walker.way.iter();
            crowd.stages.extend(points.map(|&(p, radius)| Stop::waypoint(frame.there(p), radius)));
            crowd.agents.push(start_of(walker, frame, index, first));
        }
        Scene::of_crowd(scenario, crowd, equipment.cast.clone())
    }

    /// Runs it to its end, or until everyone has `left`.
    ///
    /// # Errors
    /// When the device fails or a kernel meets a value that is not finite.
    pub fn run(&self, equipment: &Equipment, variant: Variant) -> Result<Run, Error> {
        let (mut simulation, frame) = self.start(equipment, variant)?;
        let geometry = self.scenario.geometry();
        let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
        let mut tracks =
            Tracks::new(1.0 / (f64::from(self.scenario.navigation.time_step) * f64::from(self.every)));
        let (mut outside, mut overlapping, mut nearest_wall) = (0, 0, NEAR_WALL);
        let mut steps = self.steps();
        let mut done = 0;
        loop {
            let store = simulation.state()?;
            let agents = store.step.agent_count as usize;
            let there = |p: &[f32; 2]| {
                let point = Vec2::from_array(*p);
                (!crate::ground::is_absent(*p)).then(|| frame.back(point))
            };
            let positions: Vec<Option<Vec2>> = store.position[..agents].iter().map(there).collect();
            outside += positions.iter().flatten().map(|p| u32::from(!free.walkable(*p))).sum::<u32>();
            for place in positions.iter().flatten() {
                nearest_wall = free.distance(*place, *place, nearest_wall);
            }
            overlapping = overlapping.max(crate::sim::measure::measures(store).overlapping_pairs);
            tracks.push(&positions);
            let has_come = |route: &Route, point: u32| route.next >= point || route.arrivals > 0;
            let all_came =
                self.until.is_some_and(|point| store.route[..agents].iter().all(|r| has_come(r, point)));
            if all_came {
                // the last ones walk on a little
                steps = steps.min(done + AFTER);
            }
            if done >= steps {
                let arrivals = store.route[..agents].iter().map(|route| route.arrivals).collect();
                let hash = crate::sim::measure::state_hash(store);
                let device = simulation.device();
                return Ok(Run { tracks, arrivals, outside, overlapping, nearest_wall, hash, device });
            }
            let count = self.every.min(steps - done);
            simulation.step(count)?;
            done += count;
        }
    }
}

/// Where a scene lies: turned, then moved.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    turn: Vec2,
    shift: Vec2,
}

impl Default for Frame {
    fn default() -> Self {
        Self { turn: Vec2::X, shift: Vec2::ZERO }
    }
}

impl Frame {
    /// From the scene's axes to those of the simulation.
    pub fn there(self, point: Vec2) -> Vec2 {
        self.turn.rotate(point) + self.shift
    }

    /// From the axes of the simulation to the scene's.
    pub fn back(self, point: Vec2) -> Vec2 {
        Vec2::new(self.turn.x, -self.turn.y).rotate(point - self.shift)
    }
}

fn start_of(walker: &Walker, frame: Frame, index: usize, first: usize) -> AgentStart {
    let towards = walker.way.get(walker.next).map_or(walker.position, |point| point.0);
    let direction = frame.turn.rotate((towards - walker.position).normalize_or(Vec2::Y));
    #[allow(clippy::cast_possible_truncation, reason = "thousands of people")]
    let number = |value: usize| value as u32;
    AgentStart {
        velocity: direction * walker.speed,
        heading: direction.x.atan2(direction.y),
        radius: walker.radius,
        phase: crate::reference::exact::hash_u32(number(index)),
        route_start: number(first),
        route_length: number(walker.way.len()),
        waypoint: number(walker.next),
        speed: Some(walker.speed),
        loops: walker.loops,
        companions: walker.companions,
        ..AgentStart::at(frame.there(walker.position))
    }
}

impl Fault {
    fn apply(self, store: &mut Store) {
        let slowed = match self {
            Self::None => return,
            Self::HalfSpeed => 0.5,
            Self::Frozen => 0.0,
            Self::NoWalls => {
                setup::set_obstacles(store, &[]);
                return;
            }
            Self::Alone => {
                store.companions.iter_mut().for_each(|companions| *companions = [u32::MAX; 4]);
                return;
            }
            Self::Blind => {
                store.avoidance.iter_mut().for_each(|own| own.neighbour_cap = 0.0);
                return;
            }
        };
        for body in &mut store.body {
            body.max_speed = (body.max_speed * slowed).max(1e-3);
            body.preferred_speed *= slowed;
        }
    }
}
