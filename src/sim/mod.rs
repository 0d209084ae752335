//! The simulation: one step after another, on the CPU or on Vulkan, and the animation of what a camera sees.
//!
//! ```
//! use gaitway::sim::{Backend, Simulation};
//! use gaitway::Scene;
//!
//! # fn main() -> gaitway::Result<()> {
//! let start = || -> gaitway::Result<Simulation> {
//!     Scene::load("garden")?.agents(40).seed(7).backend(Backend::Cpu).start()
//! };
//! let (mut one, mut other) = (start()?, start()?);
//! one.step(60)?;
//! other.step(20)?;
//! other.step(40)?;
//! assert!(one.people()?.eq(other.people()?)); // the same seed: equal, bit for bit
//! if let Some(person) = one.person(3)? {
//!     println!("after {:.1} s agent 3 is at {} m", one.time(), person.position);
//! }
//! # Ok(())
//! # }
//! ```
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "counts and cells are far below 2^24; the grid's limits are checked when it is laid out"
)]

mod avatar_set;
mod backend;
#[doc(hidden)]
pub mod bodies;
pub mod departures;
mod error;
#[doc(hidden)]
pub mod flow;
mod hair;
mod islands;
pub mod measure;
pub(crate) mod measured;
#[doc(hidden)]
pub mod obstacles;
mod optional;
#[doc(hidden)]
pub mod order;
mod outfits;
mod people;
mod renew;
#[doc(hidden)]
pub mod setup;
#[doc(hidden)]
pub mod snapshots;
mod ways;

pub use avatar_set::{AvatarSet, MAX_AVATARS};
pub use backend::Backend;
pub use error::Error;
pub use islands::Islands;
pub use people::Person;

#[cfg(feature = "vulkan")]
use crate::kernels::Dispatch;
use crate::kernels::layout::{Avoidance, Lead, StepUniforms};
use crate::kernels::shared::contents::UNLIKE;
use crate::kernels::{BufferId, KernelId, Op, Phase, Store};
use crate::scenario::{Crowd, Scenario};
use glam::Vec2;
#[cfg(feature = "vulkan")]
use std::sync::Arc;

#[cfg(feature = "vulkan")]
use crate::gpu::{Device, Engine};
use backend::Machine;

/// Steps that go into one submission: long enough to hide its cost, short enough for any watchdog.
const BATCH: u32 = 16;

/// What carries a crowd from one step to the next; all of it is in the state hash.
pub(crate) const STATE: [BufferId; 11] = [
    BufferId::Elevation,
    BufferId::Position,
    BufferId::Velocity,
    BufferId::Heading,
    BufferId::Stance,
    BufferId::Route,
    BufferId::StageProgress,
    BufferId::Queues,
    BufferId::Sources,
    BufferId::Waiting,
    BufferId::Failure,
];

/// What changes besides where feelings change.
pub(crate) const FELT: [BufferId; 5] =
    [BufferId::Feeling, BufferId::Heard, BufferId::GaitWeights, BufferId::Body, BufferId::Appearance];

/// A crowd in motion.
#[derive(Debug)]
pub struct Simulation {
    store: Store,
    /// Whether `store` holds the present state (the device may be ahead).
    is_current: bool,
    /// The number of steps after which the crowd was as `store` has it.
    stored_step: u32,
    /// Whether the host keeps all that a new device would need.
    is_renewable: bool,
    /// The uniforms of a step as the machine has them.
    given: Option<StepUniforms>,
    /// Whether a failure of a kernel was reported.
    has_failed: bool,
    /// Whether `store.lead` is newer than the device's.
    is_lead_newer: bool,
    machine: Machine,
    /// Why the CPU is used although Vulkan was tried.
    fallback: Option<String>,
    /// Goals that have a field each, and how the flow grid is laid.
    ways: flow::Ways,
    /// What each agent feels at the start, in the order of [`crate::Emotion::ALL`]; empty if unknown.
    emotions: Vec<[f32; 4]>,
    /// How long phases ran since [`Self::take_times`], if that is measured.
    times: Option<Vec<(Phase, f64)>>,
}

impl Simulation {
    /// A simulation of a scenario's crowd.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used, or no agent can stand at a goal ([`flow::equip`]).
    pub fn new(
        scenario: &Scenario,
        crowd: &Crowd,
        cast: &AvatarSet,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let geometry = scenario.geometry();
        let mut store = setup::store(scenario, &geometry, crowd, cast);
        let ways = flow::equip(&mut store, scenario, &geometry, crowd)?;
        let emotions = crowd.agents.iter().chain(&crowd.external).map(|agent| agent.emotion).collect();
        Ok(Self::from_store(store, backend, device)?.knowing(ways, emotions))
    }

    /// The same with the flow fields that its store was equipped with, and each agent's feelings at the start.
    pub(crate) fn knowing(self, ways: flow::Ways, emotions: Vec<[f32; 4]>) -> Self {
        Self { ways, emotions, ..self }
    }

    /// Runs operations, each [`Op::Set`] with what `contents` gives for it.
    fn run(
        &mut self,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8> + Send,
    ) -> Result<(), crate::Error> {
        self.machine.run(&mut self.store, ops, contents, self.times.as_mut())
    }

    /// A simulation of buffers filled by hand (see [`setup`]); buffers that only frames need may be empty.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn from_store(store: Store, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        Self::from_store_beside(store, backend, device, false)
    }

    /// The same with work that `gives_way` to that of others on the same GPU.
    pub(crate) fn from_store_beside(
        mut store: Store,
        backend: Backend,
        device: Option<&str>,
        gives_way: bool,
    ) -> Result<Self, crate::Error> {
        find_alike(&mut store);
        let (machine, fallback) = Machine::open(&store, backend, device, gives_way)?;
        let mut new = Self { fallback, ..Self::on(machine, store) };
        new.solve_ways()?;
        Ok(new)
    }

    /// A simulation on the device of this one, and with its kernels.
    pub(crate) fn beside(&self, mut store: Store) -> Result<Self, crate::Error> {
        find_alike(&mut store);
        let machine = self.machine.beside(&store)?;
        let mut new = Self { fallback: self.fallback.clone(), ..Self::on(machine, store) };
        new.solve_ways()?;
        Ok(new)
    }

    /// A simulation whose flow fields are not solved yet.
    fn on(machine: Machine, store: Store) -> Self {
        Self {
            stored_step: store.step.step_index,
            store,
            is_current: true,
            is_renewable: false,
            given: None,
            has_failed: false,
            is_lead_newer: false,
            machine,
            fallback: None,
            ways: flow::Ways::default(),
            emotions: Vec::new(),
            times: None,
        }
    }

    /// A simulation on a Vulkan device that is open already.
    ///
    /// # Errors
    /// When the device fails.
    #[cfg(feature = "vulkan")]
    pub fn on_device(mut store: Store, device: &Arc<Device>) -> Result<Self, crate::Error> {
        find_alike(&mut store);
        let machine = Machine::on(device, &store, &order::kernels(&store))?;
        let mut new = Self::on(machine, store);
        new.solve_ways()?;
        Ok(new)
    }

    /// A simulation on an open Vulkan device with the kernels of a step alone, for many short runs. It cannot be drawn, and has
    /// no flow fields.
    ///
    /// # Errors
    /// When the device fails.
    #[cfg(feature = "vulkan")]
    pub fn steps_on(store: Store, device: &Arc<Device>) -> Result<Self, crate::Error> {
        let mut kernels: Vec<KernelId> =
            order::step_dispatches(&store.step).iter().map(Dispatch::kernel).collect();
        kernels.sort_unstable();
        kernels.dedup();
        let machine = Machine::on(device, &store, &kernels)?;
        Ok(Self::on(machine, store))
    }

    /// What it runs on, in words.
    pub fn device(&self) -> String {
        self.machine.describe()
    }

    /// Which arithmetic its kernels are computed with: `native`, or `careful` and for what.
    ///
    /// # Errors
    /// When the device fails.
    pub fn arithmetic(&self) -> Result<String, crate::Error> {
        self.machine.arithmetic()
    }

    /// Why the CPU is used although Vulkan was tried, if so.
    pub fn fallback(&self) -> Option<&str> {
        self.fallback.as_deref()
    }

    /// The engine, if it runs on Vulkan: the renderer draws from its buffers.
    #[cfg(feature = "vulkan")]
    pub fn engine(&self) -> Option<&Engine> {
        self.machine.engine()
    }

    /// Steps done since the start.
    pub fn steps_done(&self) -> u32 {
        self.store.step.step_index
    }

    /// Seconds simulated since the start.
    pub fn time(&self) -> f64 {
        f64::from(self.steps_done()) * f64::from(self.store.step.time_step)
    }

    /// Moves the user: ground position (m), height of the floor they stand on (m) and velocity (m/s).
    pub fn set_user(&mut self, position: Vec2, elevation: f32, velocity: Vec2) {
        self.store.step.user_elevation = elevation;
        self.store.step.user_position = position.to_array();
        self.store.step.user_velocity = velocity.to_array();
    }

    /// Sets where an agent led from outside ([`setup::set_led`]) is at the end of the next step: a ground position (m) and the
    /// velocity it has there (m/s, used when it appears). `None` makes it absent.
    ///
    /// An agent without a new target stands at its last target. An agent with a path in the scenario leaves the path.
    ///
    /// # Errors
    /// [`Error::NotLed`] when there is no such agent or it walks by itself, [`Error::Lead`] for numbers that are not
    /// finite or beyond what a scene holds.
    pub fn lead(&mut self, agent: u32, target: Option<(Vec2, Vec2)>) -> Result<(), crate::Error> {
        let led = self.store.avoidance.get(agent as usize).is_some_and(Avoidance::is_led);
        let Some(place) = self.store.lead.get_mut(agent as usize).filter(|_| led) else {
            return Err(Error::NotLed { agent }.into());
        };
        let usable = |v: Vec2| v.is_finite() && v.abs().max_element() < 0.1 * crate::ground::ABSENT;
        let (position, velocity) = target.unwrap_or((Vec2::splat(crate::ground::ABSENT), Vec2::ZERO));
        if target.is_some() && !(usable(position) && usable(velocity)) {
            return Err(Error::Lead { agent, position, velocity }.into());
        }
        *place = Lead { place: position.to_array(), velocity: velocity.to_array() };
        if let Some(path) = self.store.paths.iter_mut().find(|path| path.agent == agent) {
            path.keyframes = 0; // from now on it is led by hand
        }
        self.is_lead_newer = true;
        Ok(())
    }

    /// Does `count` steps. On a Vulkan device this does not wait for them: [`Self::finish`] does, and so does whatever reads the
    /// state. An error of the device may then come from there.
    ///
    /// # Errors
    /// As of [`Self::finish`].
    pub fn step(&mut self, count: u32) -> Result<(), crate::Error> {
        if self.store.step.agent_count == 0 {
            self.store.step.step_index += count;
            return Ok(());
        }
        let every = self.store.flow_grid.every;
        if every == 0 {
            return self.walk(count);
        }
        let mut left = count;
        while left > 0 {
            let since = self.steps_done() % every;
            if since == 0 {
                self.solve_ways()?;
            }
            let some = left.min(every - since);
            self.walk(some)?;
            left -= some;
        }
        Ok(())
    }

    /// Does `count` steps with the present flow fields.
    fn walk(&mut self, count: u32) -> Result<(), crate::Error> {
        let one = self.begin_walk()?;
        let mut left = count;
        while left > 0 {
            let batch = left.min(BATCH);
            let is_new = self.begin_batch();
            self.machine.steps(&mut self.store, is_new, &one, batch, self.times.as_mut())?;
            self.end_batch(batch);
            left -= batch;
        }
        self.is_current = !self.machine.is_ahead();
        if self.is_current {
            self.stored_step = self.steps_done();
            self.check()?;
        }
        Ok(())
    }

    /// The operations of a step from now on.
    fn begin_walk(&mut self) -> Result<Vec<Op>, crate::Error> {
        if self.is_lead_newer {
            self.machine.take(&self.store, &[BufferId::Lead, BufferId::Paths])?;
            self.is_lead_newer = false;
        }
        let dispatches = order::step_dispatches(&self.store.step).into_iter().map(Op::Dispatch);
        Ok(std::iter::once(Op::CountStep).chain(dispatches).collect())
    }

    /// Whether the uniforms of the steps to come are new to the machine.
    fn begin_batch(&mut self) -> bool {
        let step = self.store.step;
        self.store.step_count[0] = step.step_index;
        self.given.replace(step) != Some(step)
    }

    /// Notes that so many steps are done since [`Self::begin_batch`]. (On the CPU the kernels have counted some of them.)
    fn end_batch(&mut self, steps: u32) {
        if let Some(given) = &mut self.given {
            given.step_index += steps;
            self.store.step = *given;
        }
    }

    /// Waits until all steps are done.
    ///
    /// # Errors
    /// When the device fails, or a kernel met values that are not finite ([`Error::Failure`] names the first agent).
    pub fn finish(&mut self) -> Result<(), crate::Error> {
        self.machine.finish()?;
        self.check()
    }

    /// Reads the sticky failure words.
    fn check(&mut self) -> Result<(), crate::Error> {
        self.machine.fetch(&mut self.store, &[BufferId::Failure])?;
        self.failure().map_or(Ok(()), |error| {
            self.has_failed = true;
            Err(error.into())
        })
    }

    /// The failure of a kernel that the store tells of.
    fn failure(&self) -> Option<Error> {
        let failed = |kernel: &KernelId| self.store.failure[*kernel as usize] != u32::MAX;
        let kernel = KernelId::ALL.into_iter().find(failed)?;
        Some(Error::Failure { kernel: kernel.kernel().name, agent: self.store.failure[kernel as usize] })
    }

    /// Measures how long each phase of the kernels of steps and frames runs, or stops measuring.
    pub fn measure_times(&mut self, is_on: bool) {
        self.times = is_on.then(Vec::new);
    }

    /// Phases that ran since this was last asked and for how long, ms: by the device's timestamps, or on the CPU by the
    /// clock. A phase stands there as often as it was launched. Empty unless [`Self::measure_times`] is on.
    pub fn take_times(&mut self) -> Vec<(Phase, f64)> {
        self.times.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// The buffers as they were last read; sizes and parameters are always right, the state may be old.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The present state; on Vulkan it is read back first if the device is ahead.
    ///
    /// # Errors
    /// As of [`Self::finish`]; a failure of a kernel is reported once.
    pub fn state(&mut self) -> Result<&Store, crate::Error> {
        if !self.is_current {
            let felt: &[BufferId] = if self.store.step.feels != 0 { &FELT } else { &[] };
            // at once: a device that is lost meanwhile leaves the state of one step
            self.machine.fetch(&mut self.store, &[&STATE, felt].concat())?;
            self.stored_step = self.steps_done();
        }
        self.is_current = true;
        match self.failure() {
            Some(error) if !std::mem::replace(&mut self.has_failed, true) => Err(error.into()),
            _ => Ok(&self.store),
        }
    }

    /// Prepares the bodies that the cameras of the store's `frame` see for drawing (`cull` to `skin`).
    ///
    /// # Errors
    /// When the device fails.
    pub fn animate(&mut self, frame: crate::kernels::layout::FrameUniforms) -> Result<(), crate::Error> {
        self.store.frame = frame;
        let dispatches = order::frame_dispatches(&frame).into_iter().map(Op::Dispatch);
        let ops: Vec<Op> = std::iter::once(Op::Set(BufferId::Frame)).chain(dispatches).collect();
        self.run(&ops, |_, _| bytemuck::bytes_of(&frame).to_vec())?;
        self.check()
    }

    /// Reads buffers back that a frame wrote (palettes, skinned vertices, ...).
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&mut self, buffers: &[BufferId]) -> Result<&Store, crate::Error> {
        self.machine.fetch(&mut self.store, buffers)?;
        Ok(&self.store)
    }
}

/// Notes whether all agents avoid others alike: then one record serves for all, where no kernel reads another.
#[allow(clippy::float_cmp, reason = "copies of the same numbers")]
fn find_alike(store: &mut Store) {
    store.step.alike = u32::from(store.avoidance.windows(2).all(|pair| pair[0] == pair[1]));
    if store.step.contents() & UNLIKE == 0 && store.step.led_count == 0 {
        store.avoidance.truncate(1);
    }
}
