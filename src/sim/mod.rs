//! The simulation: one step after another, on the CPU or on Vulkan, and the animation of what a camera sees.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "counts and cells are far below 2^24; the grid's limits are checked when it is laid out"
)]

mod avatar_set;
pub mod bodies;
pub mod departures;
mod error;
pub mod flow;
pub mod measure;
pub mod obstacles;
mod optional;
pub mod order;
mod people;
pub mod setup;
#[cfg(feature = "vulkan")]
pub mod snapshots;
mod ways;

pub use avatar_set::{AvatarSet, MAX_AVATARS};
pub use error::Error;
pub use people::Person;

use crate::kernels::shared::step::LED;
use crate::kernels::{BufferId, Dispatch, KernelId, Phase, Store};
use crate::reference;
use crate::scenario::{Crowd, Scenario};
use glam::Vec2;
#[cfg(feature = "vulkan")]
use std::sync::Arc;

#[cfg(feature = "vulkan")]
use crate::gpu::{Device, Engine, Validation, plan::Op};

/// Steps that go into one submission: long enough to hide its cost, short enough for any watchdog.
#[cfg(feature = "vulkan")]
const BATCH: u32 = 16;

/// What carries a crowd from one step to the next; all of it is in the state hash.
#[cfg(feature = "vulkan")]
pub(crate) const STATE: [BufferId; 11] = [
    BufferId::Elevation,
    BufferId::Position,
    BufferId::Velocity,
    BufferId::Stance,
    BufferId::Phase,
    BufferId::Route,
    BufferId::StageProgress,
    BufferId::Queues,
    BufferId::Sources,
    BufferId::Waiting,
    BufferId::Failure,
];

/// What changes besides where feelings change.
#[cfg(feature = "vulkan")]
pub(crate) const FELT: [BufferId; 5] =
    [BufferId::Feeling, BufferId::Heard, BufferId::GaitWeights, BufferId::Body, BufferId::Appearance];

/// Where to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Backend {
    /// The best Vulkan device; without one, the CPU, unless a device is named.
    #[default]
    Auto,
    /// A Vulkan device or an error.
    Vulkan,
    /// The CPU: the reference kernels, on all cores.
    Cpu,
}

impl Backend {
    /// Whether the CPU takes over when Vulkan cannot be used: not where a device is named, by `device` or by the
    /// environment variable `GAITWAY_DEVICE`.
    pub fn falls_back(self, device: Option<&str>) -> bool {
        #[cfg(feature = "vulkan")]
        let is_named = crate::gpu::Wanted::of(device) != crate::gpu::Wanted::Best;
        #[cfg(not(feature = "vulkan"))]
        let is_named =
            device.is_some() || std::env::var_os("GAITWAY_DEVICE").is_some_and(|name| !name.is_empty());
        self == Self::Auto && !is_named
    }
}

/// A crowd in motion.
#[derive(Debug)]
pub struct Simulation {
    store: Store,
    /// Whether `store` holds the present state (the device may be ahead).
    is_current: bool,
    /// Whether `store.lead` is newer than the device's.
    is_led_anew: bool,
    #[cfg(feature = "vulkan")]
    engine: Option<Engine>,
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
    /// When a Vulkan device is demanded but cannot be used, or a goal lies where nobody can stand ([`flow::equip`]).
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
        let emotions = crowd.agents.iter().chain(&crowd.outsiders).map(|agent| agent.emotion).collect();
        Ok(Self::from_store(store, backend, device)?.knowing(ways, emotions))
    }

    /// The same, which knows the ways that its store was equipped with, and what each agent feels at the start.
    pub(crate) fn knowing(self, ways: flow::Ways, emotions: Vec<[f32; 4]>) -> Self {
        Self { ways, emotions, ..self }
    }

    /// Runs dispatches on whichever backend there is, and reads buffers back.
    fn run(&mut self, dispatches: &[Dispatch], read: &[BufferId]) -> Result<(), crate::Error> {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            let ops: Vec<Op> = dispatches.iter().copied().map(Op::Dispatch).collect();
            engine.run(&ops, |_, _| Vec::new(), false)?;
            engine.download(&mut self.store, read)?;
            return Ok(());
        }
        let _ = read;
        run_on_cpu(&mut self.store, dispatches);
        Ok(())
    }

    /// A simulation of buffers filled by hand (see [`setup`]); buffers that only pictures need may be empty.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn from_store(
        mut store: Store,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        find_alike(&mut store);
        #[cfg(feature = "vulkan")]
        if backend != Backend::Cpu {
            let opened = Validation::from_environment()
                .and_then(|validation| Device::open(device, validation))
                .and_then(|device| Engine::new(&device, &store, &kernels(&store)));
            let (engine, fallback) = match opened {
                Ok(engine) => (Some(engine), None),
                Err(error) if backend.falls_back(device) => (None, Some(error.to_string())),
                Err(error) => return Err(error.into()),
            };
            let mut new = Self { engine, fallback, ..Self::unsolved(store) };
            new.solve_ways()?;
            return Ok(new);
        }
        #[cfg(not(feature = "vulkan"))]
        if backend == Backend::Vulkan || (backend == Backend::Auto && !backend.falls_back(device)) {
            return Err(Error::NoVulkan.into());
        }
        let mut new = Self::unsolved(store);
        new.solve_ways()?;
        Ok(new)
    }

    /// A simulation on the CPU whose ways are not found yet.
    fn unsolved(store: Store) -> Self {
        Self {
            store,
            is_current: true,
            is_led_anew: false,
            #[cfg(feature = "vulkan")]
            engine: None,
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
    #[cfg(feature = "view")]
    pub(crate) fn on_device(mut store: Store, device: &Arc<Device>) -> Result<Self, crate::Error> {
        find_alike(&mut store);
        let engine = Engine::new(device, &store, &kernels(&store))?;
        let mut new = Self { engine: Some(engine), ..Self::unsolved(store) };
        new.solve_ways()?;
        Ok(new)
    }

    /// A simulation on a Vulkan device that is open already, with the kernels of a step alone: for many short runs. It
    /// cannot be drawn, and has no ways to goals.
    ///
    /// # Errors
    /// When the device fails.
    #[cfg(feature = "vulkan")]
    pub fn steps_on(store: Store, device: &Arc<Device>) -> Result<Self, crate::Error> {
        let mut kernels: Vec<KernelId> =
            order::step_dispatches(&store.step).iter().map(Dispatch::kernel).collect();
        kernels.sort_unstable();
        kernels.dedup();
        let engine = Engine::new(device, &store, &kernels)?;
        Ok(Self { engine: Some(engine), ..Self::unsolved(store) })
    }

    /// What it runs on, in words.
    pub fn device(&self) -> String {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &self.engine {
            return engine.device().describe();
        }
        let threads = rayon::current_num_threads();
        format!("CPU reference ({threads} thread{})", if threads == 1 { "" } else { "s" })
    }

    /// Why the CPU is used although Vulkan was tried, if so.
    pub fn fallback(&self) -> Option<&str> {
        self.fallback.as_deref()
    }

    /// The engine, if it runs on Vulkan: the renderer draws from its buffers.
    #[cfg(feature = "vulkan")]
    pub fn engine(&self) -> Option<&Engine> {
        self.engine.as_ref()
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

    /// Tells where an agent that is led from outside ([`setup::set_led`]) is to be at the end of the next step: a ground
    /// position (m) and the velocity it has there (m/s, used when it appears); or `None`: it is not there.
    ///
    /// An agent that is told nothing new stands where it was led to last; one with a path in the scenario leaves it.
    ///
    /// # Errors
    /// [`Error::NotLed`] when there is no such agent or it walks by itself, [`Error::Lead`] for numbers that are not
    /// finite or beyond what a scene holds.
    pub fn lead(&mut self, agent: u32, target: Option<(Vec2, Vec2)>) -> Result<(), crate::Error> {
        let led = self.store.avoidance.get(agent as usize).is_some_and(|m| m[3] >= LED);
        let Some(place) = self.store.lead.get_mut(agent as usize).filter(|_| led) else {
            return Err(Error::NotLed { agent }.into());
        };
        let usable = |v: Vec2| v.is_finite() && v.abs().max_element() < 0.1 * crate::ground::ABSENT;
        let (position, velocity) = target.unwrap_or((Vec2::splat(crate::ground::ABSENT), Vec2::ZERO));
        if target.is_some() && !(usable(position) && usable(velocity)) {
            return Err(Error::Lead { agent, position, velocity }.into());
        }
        *place = [position.x, position.y, velocity.x, velocity.y];
        if let Some(path) = self.store.paths.iter_mut().find(|path| path[0] == agent) {
            path[2] = 0; // it goes where it is told from now on
        }
        self.is_led_anew = true;
        Ok(())
    }

    /// Does `count` steps.
    ///
    /// # Errors
    /// When the device fails, or a kernel met values that are not finite ([`Error::Failure`] names the first agent).
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

    /// Does `count` steps with the ways as they are.
    fn walk(&mut self, count: u32) -> Result<(), crate::Error> {
        let dispatches = order::step_dispatches(&self.store.step);
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            if self.is_led_anew {
                engine.upload(&self.store, &[BufferId::Lead, BufferId::Paths])?;
                self.is_led_anew = false;
            }
            let mut left = count;
            while left > 0 {
                let batch = left.min(BATCH);
                let one = std::iter::once(Op::Set(BufferId::Step))
                    .chain(dispatches.iter().copied().map(Op::Dispatch));
                let one: Vec<Op> = one.collect();
                let ops = one.repeat(batch as usize);
                let first = self.store.step;
                let contents = |index: usize, _| {
                    let mut step = first;
                    step.step_index += (index / one.len()) as u32;
                    bytemuck::bytes_of(&step).to_vec()
                };
                let times = engine.run(&ops, contents, self.times.is_some())?;
                if let Some(all) = &mut self.times {
                    all.extend(times.iter().map(|time| (time.dispatch.phase, time.milliseconds)));
                }
                self.store.step.step_index += batch;
                left -= batch;
            }
            self.is_current = false;
            return self.check_on_device();
        }
        for _ in 0..count {
            self.run_on_cpu(&dispatches);
            self.store.step.step_index += 1;
        }
        self.check()
    }

    #[cfg(feature = "vulkan")]
    fn check_on_device(&mut self) -> Result<(), crate::Error> {
        if let Some(engine) = &mut self.engine {
            engine.download(&mut self.store, &[BufferId::Failure])?;
        }
        self.check()
    }

    /// Reads the sticky failure words.
    fn check(&self) -> Result<(), crate::Error> {
        for kernel in KernelId::ALL {
            let agent = self.store.failure[kernel as usize];
            if agent != u32::MAX {
                return Err(Error::Failure { kernel: kernel.kernel().name, agent }.into());
            }
        }
        Ok(())
    }

    /// Measures how long each phase of the kernels of steps and pictures runs, or stops measuring.
    pub fn measure_times(&mut self, is_on: bool) {
        self.times = is_on.then(Vec::new);
    }

    /// Phases that ran since this was last asked and for how long, ms: by the device's timestamps, or on the CPU by the
    /// clock. A phase stands there as often as it was launched. Empty unless [`Self::measure_times`] is on.
    pub fn take_times(&mut self) -> Vec<(Phase, f64)> {
        self.times.as_mut().map(std::mem::take).unwrap_or_default()
    }

    /// Runs dispatches of a step or a picture on the reference kernels.
    fn run_on_cpu(&mut self, dispatches: &[Dispatch]) {
        let Some(times) = &mut self.times else { return run_on_cpu(&mut self.store, dispatches) };
        for dispatch in dispatches {
            let begin = std::time::Instant::now();
            run_on_cpu(&mut self.store, &[*dispatch]);
            times.push((dispatch.phase, begin.elapsed().as_secs_f64() * 1e3));
        }
    }

    /// The buffers as they were last read; sizes and parameters are always right, the state may be old.
    pub fn store(&self) -> &Store {
        &self.store
    }

    /// The present state; on Vulkan it is read back first if the device is ahead.
    ///
    /// # Errors
    /// When the device fails.
    pub fn state(&mut self) -> Result<&Store, crate::Error> {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = self.engine.as_mut().filter(|_| !self.is_current) {
            engine.download(&mut self.store, &STATE)?;
            if self.store.step.feels != 0 {
                engine.download(&mut self.store, &FELT)?;
            }
        }
        self.is_current = true;
        Ok(&self.store)
    }

    /// Prepares the bodies of everyone a camera sees for drawing (`cull` to `skin`). The store's `frame` says for whom.
    ///
    /// # Errors
    /// When the device fails.
    pub fn animate(&mut self, frame: crate::kernels::layout::FrameUniforms) -> Result<(), crate::Error> {
        self.store.frame = frame;
        let dispatches = order::frame_dispatches(&frame);
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            let ops: Vec<Op> = std::iter::once(Op::Set(BufferId::Frame))
                .chain(dispatches.iter().copied().map(Op::Dispatch))
                .collect();
            let times = engine.run(&ops, |_, _| bytemuck::bytes_of(&frame).to_vec(), self.times.is_some())?;
            if let Some(all) = &mut self.times {
                all.extend(times.iter().map(|time| (time.dispatch.phase, time.milliseconds)));
            }
            return self.check_on_device();
        }
        self.run_on_cpu(&dispatches);
        self.check()
    }

    /// Reads buffers back that a picture made (palettes, skinned vertices, ...).
    ///
    /// # Errors
    /// When the device fails.
    pub fn read(&mut self, buffers: &[BufferId]) -> Result<&Store, crate::Error> {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            engine.download(&mut self.store, buffers)?;
        }
        let _ = buffers;
        Ok(&self.store)
    }
}

/// Whether all have the same manners.
#[allow(clippy::float_cmp, reason = "copies of the same numbers")]
fn find_alike(store: &mut Store) {
    store.step.alike = u32::from(store.avoidance.windows(2).all(|pair| pair[0] == pair[1]));
}

/// The kernels of a crowd's steps and pictures.
#[cfg(feature = "vulkan")]
fn kernels(store: &Store) -> Vec<KernelId> {
    let model = order::velocity_kernel(store.step.model);
    let others = order::MODELS.map(order::velocity_kernel).filter(|kernel| *kernel != model);
    let others: Vec<KernelId> = others.chain([KernelId::Numerics, KernelId::GaitFeatures]).collect();
    let has_moments = !store.snapshots.is_empty();
    let is_wanted = |kernel: &KernelId| {
        !others.contains(kernel)
            && (has_moments || !matches!(kernel, KernelId::KeepSnapshot | KernelId::Interpolate))
    };
    KernelId::ALL.into_iter().filter(is_wanted).collect()
}

/// Runs dispatches on the reference kernels.
fn run_on_cpu(store: &mut Store, dispatches: &[Dispatch]) {
    for dispatch in dispatches {
        reference::run(dispatch.phase, store, dispatch.immediate);
    }
}
