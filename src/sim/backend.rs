//! What runs a simulation's kernels: lanes or the references on the CPU, or an engine on a Vulkan device. Nothing else in
//! this room tells them apart.

#[cfg(not(feature = "vulkan"))]
use super::Error;
#[cfg(feature = "vulkan")]
use super::order;
#[cfg(feature = "vulkan")]
use crate::gpu::{Device, Engine, Priority, Validation, Wanted};
use crate::kernels::{BufferId, Op, Phase, Store};
use crate::lanes::{OnCpu, among_threads};
#[cfg(feature = "vulkan")]
use std::sync::Arc;
use std::time::Instant;

/// Where to simulate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Backend {
    /// The device that is named; where none is, the best GPU, or else the CPU. A software device is taken by its name alone:
    /// it computes nothing that the CPU does not compute sooner.
    #[default]
    Auto,
    /// A Vulkan device or an error.
    Vulkan,
    /// The CPU: the shaders as code for its widest vectors, on all cores.
    Cpu,
    /// The CPU: the reference kernels, plain and about three times slower, on all cores. The bits are those of [`Self::Cpu`].
    Reference,
}

impl Backend {
    /// Whether it is the CPU by name.
    pub const fn is_cpu(self) -> bool {
        matches!(self, Self::Cpu | Self::Reference)
    }

    /// Which kernels run on the CPU.
    pub(crate) const fn on_cpu(self) -> OnCpu {
        match self {
            Self::Reference => OnCpu::Twins,
            _ => OnCpu::Lanes,
        }
    }

    /// Whether the CPU takes over when Vulkan cannot be used: not where a device is named, by `device` or by the
    /// environment variable `GAITWAY_DEVICE`.
    pub fn falls_back(self, device: Option<&str>) -> bool {
        #[cfg(feature = "vulkan")]
        let is_named = Wanted::of(device) != Wanted::Best;
        #[cfg(not(feature = "vulkan"))]
        let is_named =
            device.is_some() || std::env::var_os("GAITWAY_DEVICE").is_some_and(|name| !name.is_empty());
        self == Self::Auto && !is_named
    }

    /// Opens the Vulkan device for it; the backend is not the CPU.
    #[cfg(feature = "vulkan")]
    pub(crate) fn open(self, device: Option<&str>) -> Result<Arc<Device>, crate::gpu::Error> {
        self.open_at(device, Priority::Normal)
    }

    /// The same with work of some priority.
    #[cfg(feature = "vulkan")]
    fn open_at(self, device: Option<&str>, priority: Priority) -> Result<Arc<Device>, crate::gpu::Error> {
        let wanted = if self.falls_back(device) { Wanted::Hardware } else { Wanted::of(device) };
        Device::open_at(&wanted, Validation::from_environment()?, priority)
    }
}

/// What runs the kernels.
#[derive(Debug)]
pub(super) enum Machine {
    /// Kernels on the CPU; the store is all the memory there is.
    Cpu(OnCpu),
    /// An engine, with buffers of its own beside the store.
    #[cfg(feature = "vulkan")]
    Vulkan(Box<Engine>),
}

impl Machine {
    /// Opens what is asked for, with the buffers of `store`; and why the CPU is used although Vulkan was tried. `gives_way` to
    /// other devices on the same GPU.
    #[cfg(feature = "vulkan")]
    pub(super) fn open(
        store: &Store,
        backend: Backend,
        device: Option<&str>,
        gives_way: bool,
    ) -> Result<(Self, Option<String>), crate::Error> {
        if backend.is_cpu() {
            return Ok((Self::Cpu(backend.on_cpu()), None));
        }
        let priority = if gives_way { Priority::Low } else { Priority::Normal };
        let opened = backend
            .open_at(device, priority)
            .and_then(|device| Engine::new(&device, store, &order::kernels(store)));
        match opened {
            Ok(engine) => Ok((Self::Vulkan(Box::new(engine)), None)),
            Err(error) if backend.falls_back(device) => {
                Ok((Self::Cpu(OnCpu::Lanes), Some(error.to_string())))
            }
            Err(error) => Err(error.into()),
        }
    }

    /// Opens what is asked for: there is nothing but the CPU.
    #[cfg(not(feature = "vulkan"))]
    pub(super) fn open(
        _: &Store,
        backend: Backend,
        device: Option<&str>,
        _: bool,
    ) -> Result<(Self, Option<String>), crate::Error> {
        if backend == Backend::Vulkan || (backend == Backend::Auto && !backend.falls_back(device)) {
            return Err(Error::NoVulkan.into());
        }
        Ok((Self::Cpu(backend.on_cpu()), None))
    }

    /// On a Vulkan device that is open already, with these kernels.
    #[cfg(feature = "vulkan")]
    pub(super) fn on(
        device: &Arc<Device>,
        store: &Store,
        kernels: &[crate::kernels::KernelId],
    ) -> Result<Self, crate::Error> {
        Ok(Self::Vulkan(Box::new(Engine::new(device, store, kernels)?)))
    }

    /// The same once more, with the buffers of `store`: on a device with the kernels that are there.
    pub(super) fn beside(&self, store: &Store) -> Result<Self, crate::Error> {
        match self {
            Self::Cpu(kernels) => {
                _ = store; // the store is all the memory there is
                Ok(Self::Cpu(*kernels))
            }
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => {
                let kernels = order::kernels(store);
                if !engine.has(&kernels) {
                    return Self::on(engine.device(), store, &kernels);
                }
                Ok(Self::Vulkan(Box::new(engine.beside(store, &kernels)?)))
            }
        }
    }

    /// Opens the device again, with the buffers of `store`; on the CPU there is nothing to be lost.
    pub(super) fn renew(&mut self, store: &Store) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(_) => _ = store,
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => {
                let lost = engine.device().clone();
                *self = Self::Cpu(OnCpu::Lanes); // the lost engine goes before the new one comes
                let device = lost.reopen()?;
                drop(lost);
                *self = Self::on(&device, store, &order::kernels(store))?;
            }
        }
        Ok(())
    }

    /// Whether the state is elsewhere than in the store after a run.
    pub(super) const fn is_ahead(&self) -> bool {
        !matches!(self, Self::Cpu(_))
    }

    /// Runs operations in their order. `contents(index, buffer)` gives what the operation [`Op::Set`] number `index` writes.
    /// Adds to `times` how long each phase ran, ms: by the device's timestamps, or by the clock.
    pub(super) fn run(
        &mut self,
        store: &mut Store,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8> + Send,
        times: Option<&mut Vec<(Phase, f64)>>,
    ) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(kernels) => {
                let kernels = *kernels;
                among_threads(store, |store| run_on_cpu(kernels, store, ops, contents, times));
            }
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => {
                let ran = engine.run(ops, contents, times.is_some())?;
                if let Some(times) = times {
                    times.extend(ran.iter().map(|time| (time.dispatch.phase, time.milliseconds)));
                }
            }
        }
        Ok(())
    }

    /// Runs the operations of one step so many times. With `is_new` the store's uniforms of a step are new to the device. On a
    /// device this returns once the steps are submitted, unless their times are taken ([`Self::finish`]).
    pub(super) fn steps(
        &mut self,
        store: &mut Store,
        is_new: bool,
        ops: &[Op],
        count: u32,
        times: Option<&mut Vec<(Phase, f64)>>,
    ) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(kernels) => {
                _ = is_new; // the store is all the memory there is
                let (kernels, mut times) = (*kernels, times);
                for _ in 0..count {
                    let times = times.as_deref_mut();
                    among_threads(store, |store| run_on_cpu(kernels, store, ops, |_, _| Vec::new(), times));
                }
            }
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => {
                let sets = if is_new { news(store) } else { Vec::new() };
                if times.is_none() {
                    engine.repeat(&sets, ops, count)?;
                } else {
                    let set = sets.iter().map(|(id, _)| Op::Set(*id));
                    let all: Vec<Op> = set.chain(ops.repeat(count as usize)).collect();
                    let contents = |index: usize, _| sets[index].1.clone();
                    self.run(store, &all, contents, times)?;
                }
            }
        }
        Ok(())
    }

    /// Waits until all is done.
    pub(super) fn finish(&mut self) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(_) => {}
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.finish()?,
        }
        Ok(())
    }

    /// Brings buffers into the store.
    pub(super) fn fetch(&mut self, store: &mut Store, buffers: &[BufferId]) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(_) => _ = (store, buffers),
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.download(store, buffers)?,
        }
        Ok(())
    }

    /// Takes over buffers of the store, whose lengths are as before.
    pub(super) fn take(&mut self, store: &Store, buffers: &[BufferId]) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(_) => _ = (store, buffers),
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.upload(store, buffers)?,
        }
        Ok(())
    }

    /// Takes over buffers of the store, of any length.
    pub(super) fn replace(&mut self, store: &Store, buffers: &[BufferId]) -> Result<(), crate::Error> {
        match self {
            Self::Cpu(_) => _ = (store, buffers),
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.replace(store, buffers)?,
        }
        Ok(())
    }

    /// What it is, in words.
    pub(super) fn describe(&self) -> String {
        match self {
            Self::Cpu(kernels) => {
                let threads = rayon::current_num_threads();
                let what = kernels.name();
                format!("{what} ({threads} thread{})", if threads == 1 { "" } else { "s" })
            }
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.device().describe(),
        }
    }

    /// Which arithmetic the kernels are computed with.
    pub(super) fn arithmetic(&self) -> Result<String, crate::Error> {
        Ok(match self {
            Self::Cpu(_) => "native".to_owned(),
            #[cfg(feature = "vulkan")]
            Self::Vulkan(engine) => engine.device().arithmetic()?.to_string(),
        })
    }

    /// The engine, if there is one.
    #[cfg(feature = "vulkan")]
    pub(super) fn engine(&self) -> Option<&Engine> {
        match self {
            Self::Cpu(_) => None,
            Self::Vulkan(engine) => Some(engine),
        }
    }
}

/// The uniforms of a step, for a device.
#[cfg(feature = "vulkan")]
pub(super) fn news(store: &Store) -> Vec<(BufferId, Vec<u8>)> {
    vec![(BufferId::Step, store.bytes(BufferId::Step).to_vec())]
}

/// Runs operations on the CPU.
fn run_on_cpu(
    kernels: OnCpu,
    store: &mut Store,
    ops: &[Op],
    contents: impl Fn(usize, BufferId) -> Vec<u8>,
    mut times: Option<&mut Vec<(Phase, f64)>>,
) {
    for (index, op) in ops.iter().enumerate() {
        match *op {
            Op::Set(buffer) => store.bytes_mut(buffer).copy_from_slice(&contents(index, buffer)),
            Op::CountStep => store.step.step_index = store.step_count[0],
            Op::Dispatch(dispatch) => {
                let begin = Instant::now();
                kernels.run(&dispatch, store);
                if let Some(times) = &mut times {
                    times.push((dispatch.phase, begin.elapsed().as_secs_f64() * 1e3));
                }
            }
        }
    }
}
