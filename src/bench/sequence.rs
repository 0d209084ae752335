//! Kernels in the order of a step, a frame or a case, run again and again, each timed.

use super::crowds::{EYE_HEIGHT, SPACING, dressed, plain};
#[cfg(feature = "vulkan")]
use crate::gpu::{Engine, plan::Op};
#[cfg(feature = "vulkan")]
use crate::kernels::BufferId;
use crate::kernels::layout::Teleport;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::{Dispatch, KernelId, Phase, Store};
use crate::lanes::{OnCpu, among_threads};
use crate::scenario::Gaze;
use crate::sim::setup::{self, join};
use crate::sim::{Backend, bodies, order};
use crate::verify::cases::crossing::crossing;
use crate::verify::cases::feelings::feelings;
use crate::verify::cases::journeys::journeys;
use crate::verify::cases::{arithmetic, between, flow, functions, gaits, hidden};
use std::time::Instant;

/// Kernels that not every step has.
pub(super) const EXTRAS: [KernelId; 5] = [
    KernelId::EmotionApply,
    KernelId::EmotionUpdate,
    KernelId::FollowPaths,
    KernelId::EmotionGather,
    KernelId::LeadAgents,
];

/// Passes that are run again and again, each kernel timed.
#[derive(Debug)]
pub struct Sequence {
    pub(super) name: Option<&'static str>,
    pub(super) agents: usize,
    store: Store,
    dispatches: Vec<Dispatch>,
    on_cpu: OnCpu,
    #[cfg(feature = "vulkan")]
    engine: Option<Engine>,
}

impl Sequence {
    /// The kernels of a simulation step of the crossing.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn step(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        Self::step_with(None, agents, backend, device)
    }

    /// The kernels of a step of that crowd.
    pub(super) fn walk(
        store: Store,
        agents: usize,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let dispatches = order::step_dispatches(&store.step);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// The same with what `kernel` needs.
    fn step_with(
        kernel: Option<KernelId>,
        agents: usize,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let mut store = plain(crossing(agents, SPACING));
        store.step.measured = u32::from(kernel == Some(KernelId::Measure));
        if kernel == Some(KernelId::GroupCohesion) {
            for first in (0..u32::try_from(agents).unwrap_or(0).saturating_sub(2)).step_by(3) {
                join(&mut store, &[first, first + 1, first + 2]);
            }
        }
        if kernel == Some(KernelId::React) {
            store.reaction = vec![1; agents];
            store.step.reaction_steps = u32::MAX;
        }
        if kernel == Some(KernelId::Elevate) {
            store.floors = vec![[0.0, 0.0, 1.0, 0.0]; FLOOR_STRIDE]; // everyone is on it
            store.step.floor_count = 1;
        }
        if kernel == Some(KernelId::LeadAgents) {
            (0..store.step.agent_count).for_each(|agent| setup::set_led(&mut store, agent));
            store.step.alike = 0;
        }
        if kernel == Some(KernelId::Teleport) {
            store.teleport_of.fill(0);
            (store.teleports, store.step.teleport_count) = (vec![Teleport::default()], 1);
        }
        let dispatches = order::step_dispatches(&store.step);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// Kernels of a step that the plain crossing does without.
    pub(super) const ALTERNATIVES: [KernelId; 3] =
        [KernelId::ClipToWalls, KernelId::Unjam, KernelId::VelocityRvo];

    /// A step of the crossing with one of [`Self::ALTERNATIVES`]; beside every sixteenth agent stands
    /// a post where the kernel looks at obstacles.
    fn alternative(
        kernel: KernelId,
        agents: usize,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let mut store = plain(crossing(agents, SPACING));
        if let Some(model) = order::MODELS.into_iter().find(|model| order::velocity_kernel(*model) == kernel)
        {
            store.step.model = model;
        }
        if kernel == KernelId::Unjam {
            store.step.patience = 1.0;
        }
        if kernel == KernelId::ClipToWalls || kernel == KernelId::Unjam {
            let post = |at: &[f32; 2]| {
                let [x, z] = [at[0] + 0.5, at[1] + 0.5];
                vec![[x, z], [x + 0.1, z], [x + 0.1, z + 0.1]]
            };
            let posts: Vec<_> = store.position.iter().step_by(16).take(10_000).map(post).collect();
            setup::set_obstacles(&mut store, &posts);
        }
        let dispatches = order::step_dispatches(&store.step);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// The kernels that prepare a frame of all agents in the crossing, from the middle of it.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn picture(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        Self::picture_from(agents, None, backend, device)
    }

    /// The same with far bodies from a distance on, m.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub(super) fn picture_from(
        agents: usize,
        far_distance: Option<f32>,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let mut store = in_view(agents)?;
        let [.., far] = &mut store.frame.level_distance;
        *far = far_distance.unwrap_or(0.0);
        let dispatches = order::frame_dispatches(&store.frame);
        Self::new(Some("picture"), agents, store, dispatches, (backend, device))
    }

    /// Vertices that the kernel `skin` moved in the last run.
    ///
    /// # Errors
    /// When the device fails.
    pub(super) fn skinned_vertices(&mut self) -> Result<usize, crate::Error> {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            engine.download(&mut self.store, &[BufferId::DispatchArgs])?;
        }
        let near_of_avatars = self.store.dispatch_args.chunks(3).skip(1).map(|words| words[1] as usize);
        let levels = self.store.frame.level_count.max(1) as usize;
        let finest = self.store.mesh_table.iter().step_by(levels).map(|mesh| mesh.vertex_count as usize);
        Ok(near_of_avatars.zip(finest).map(|(near, vertices)| near * vertices).sum())
    }

    /// The kernels of a picture of people who are all seen from afar, and have no pose.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn far(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let mut far = Self::picture_from(agents, Some(f32::MIN_POSITIVE), backend, device)?;
        let [near, next, farthest, _] = &mut far.store.frame.level_distance;
        (*near, *next, *farthest) = (0.0, 0.0, f32::MAX);
        Ok(far)
    }

    /// Two fields over so many cells, with walls and a crowd on them.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn flow(cells: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let store = flow::fields(cells, 0);
        let dispatches = flow::dispatches(&store);
        Self::new(None, cells, store, dispatches, (backend, device))
    }

    /// A step with everything that a crowd need not have: feelings that change, agents that are led.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn extras(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let store = feelings(agents, 1);
        let dispatches = order::step_dispatches(&store.step);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// The kernels that show what lies between two moments.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn between(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let store = between::between(agents, 1);
        let dispatches = between::dispatches(&store);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// The kernels that leave out hidden people.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn hidden(agents: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let store = hidden::hidden(agents, 0);
        let dispatches = hidden::dispatches(&store);
        Self::new(None, agents, store, dispatches, (backend, device))
    }

    /// The expressive features of so many gaits of about 35 frames.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn features(count: usize, backend: Backend, device: Option<&str>) -> Result<Self, crate::Error> {
        let store = gaits::gaits(count, 0);
        let dispatches = gaits::dispatches(&store);
        Self::new(None, count, store, dispatches, (backend, device))
    }

    /// The probes of the arithmetic and of the functions made of it.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn probe(
        kernel: KernelId,
        cases: usize,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        let case = if kernel == KernelId::Arithmetic { arithmetic(cases) } else { functions(cases) };
        Self::new(None, cases, case.store, case.dispatches, (backend, device))
    }

    /// The sequence that a kernel is part of.
    ///
    /// # Errors
    /// When a Vulkan device is demanded but cannot be used.
    pub fn with(
        kernel: KernelId,
        agents: usize,
        backend: Backend,
        device: Option<&str>,
    ) -> Result<Self, crate::Error> {
        if matches!(kernel, KernelId::Arithmetic | KernelId::Numerics) {
            return Self::probe(kernel, agents, backend, device);
        }
        if kernel == KernelId::PoseFar {
            return Self::far(agents, backend, device);
        }
        if kernel == KernelId::GaitFeatures {
            return Self::features(agents, backend, device);
        }
        if matches!(kernel, KernelId::KeepSnapshot | KernelId::Interpolate) {
            return Self::between(agents, backend, device);
        }
        if matches!(kernel, KernelId::Occlude | KernelId::OcclusionCompact) {
            return Self::hidden(agents, backend, device);
        }
        if matches!(kernel, KernelId::Flow | KernelId::FlowDensity) {
            return Self::flow(agents, backend, device);
        }
        if matches!(kernel, KernelId::Spawn | KernelId::Queue) {
            let store = journeys(agents, 1);
            let dispatches = order::step_dispatches(&store.step);
            return Self::new(None, agents, store, dispatches, (backend, device));
        }
        if EXTRAS.contains(&kernel) {
            return Self::extras(agents, backend, device);
        }
        if Self::ALTERNATIVES.contains(&kernel) {
            return Self::alternative(kernel, agents, backend, device);
        }
        let mut all = crate::kernels::layout::StepUniforms {
            group_count: 1,
            floor_count: 1,
            reaction_steps: 1,
            measured: 1,
            ..Default::default()
        };
        (all.led_count, all.teleport_count, all.queue_count, all.source_count) = (1, 1, 1, 1);
        let step = order::step_dispatches(&all);
        if step.iter().any(|dispatch| dispatch.kernel() == kernel) {
            Self::step_with(Some(kernel), agents, backend, device)
        } else {
            Self::picture(agents, backend, device)
        }
    }

    #[cfg_attr(not(feature = "vulkan"), allow(unused_variables, reason = "there is no device to choose"))]
    fn new(
        name: Option<&'static str>,
        agents: usize,
        store: Store,
        dispatches: Vec<Dispatch>,
        (backend, device): (Backend, Option<&str>),
    ) -> Result<Self, crate::Error> {
        #[cfg(feature = "vulkan")]
        let engine = match backend {
            Backend::Cpu | Backend::Reference => None,
            Backend::Auto | Backend::Vulkan => {
                let mut kernels: Vec<KernelId> = dispatches.iter().map(Dispatch::kernel).collect();
                kernels.dedup();
                let engine = backend.open(device).and_then(|device| Engine::new(&device, &store, &kernels));
                match engine {
                    Ok(engine) => Some(engine),
                    Err(_) if backend.falls_back(device) => None,
                    Err(error) => return Err(error.into()),
                }
            }
        };
        Ok(Self {
            name,
            agents,
            store,
            dispatches,
            on_cpu: backend.on_cpu(),
            #[cfg(feature = "vulkan")]
            engine,
        })
    }

    /// Runs all dispatches once; the time of each phase, ms.
    ///
    /// # Errors
    /// When the device fails.
    pub fn run(&mut self) -> Result<Vec<(Phase, f64)>, crate::Error> {
        self.store.step.step_index = self.store.step.step_index.wrapping_add(1);
        self.store.frame.frame_index = self.store.frame.frame_index.wrapping_add(1);
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut self.engine {
            let mut ops: Vec<Op> = [BufferId::Step, BufferId::Frame]
                .into_iter()
                .filter(|id| engine.buffer(*id).is_some())
                .map(Op::Set)
                .collect();
            ops.extend(self.dispatches.iter().copied().map(Op::Dispatch));
            let store = &self.store;
            let times = engine.run(&ops, |_, buffer| store.bytes(buffer).to_vec(), true)?;
            return Ok(summed(times.into_iter().map(|time| (time.dispatch.phase, time.milliseconds))));
        }
        let (on_cpu, dispatches) = (self.on_cpu, &self.dispatches);
        let timed = |store: &mut Store, dispatch: &Dispatch| {
            let begin = Instant::now();
            on_cpu.run(dispatch, store);
            (dispatch.phase, begin.elapsed().as_secs_f64() * 1e3)
        };
        let run = |store: &mut Store| -> Vec<_> {
            dispatches.iter().map(|dispatch| timed(store, dispatch)).collect()
        };
        Ok(summed(among_threads(&mut self.store, run)))
    }
}

/// One time per phase: the sum over its dispatches.
fn summed(times: impl IntoIterator<Item = (Phase, f64)>) -> Vec<(Phase, f64)> {
    let mut sums: Vec<(Phase, f64)> = Vec::new();
    for (phase, time) in times {
        match sums.iter_mut().find(|(known, _)| *known == phase) {
            Some((_, sum)) => *sum += time,
            None => sums.push((phase, time)),
        }
    }
    sums
}

/// The crossing with bodies, of which everyone is in view.
fn in_view(agents: usize) -> Result<Store, crate::Error> {
    let (mut store, _) = dressed(agents)?;
    let middle = store.step.wrap * 0.5;
    store.frame.planes = [[0.0, 0.0, 0.0, 1.0]; 12];
    store.frame.user_eyes = [middle, EYE_HEIGHT, middle, 0.0];
    store.frame.camera = store.frame.user_eyes;
    store.frame.frame_time = 1.0 / 72.0;
    bodies::set_gaze(&mut store.frame, &Gaze::default());
    Ok(store)
}
