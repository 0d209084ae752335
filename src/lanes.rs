//! The kernels on the CPU, side by side: what `gaitway_kernels` has of the shaders, for the widest vectors of this machine.
//! The others run as their twins. Both give the same bits.

use crate::kernels::{BufferId, Dispatch, Extent, KernelId, Phase, Store};
use crate::reference;
use gaitway_kernels::Kernel;
use std::sync::OnceLock;
use wgsl_lanes::{Isa, Words};

/// A phase that lanes run.
struct Lane {
    kernel: &'static Kernel,
    buffers: Vec<BufferId>,
}

/// The widest vectors of this machine.
pub(crate) fn best() -> Isa {
    static BEST: OnceLock<Isa> = OnceLock::new();
    *BEST.get_or_init(Isa::best)
}

/// Which kernels run on the CPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OnCpu {
    /// Those of the shaders, by the widest vectors that there are; where lanes have none, the twin.
    Lanes,
    /// The twins.
    Twins,
}

impl OnCpu {
    /// Runs a dispatch.
    pub(crate) fn run(self, dispatch: &Dispatch, store: &mut Store) {
        if self == Self::Twins || !run_on(best(), dispatch, store) {
            reference::run(dispatch.phase, store, dispatch.immediate);
        }
    }

    /// What computes, in words.
    pub(crate) fn name(self) -> &'static str {
        match (self, best()) {
            (Self::Twins, _) => "CPU reference",
            (Self::Lanes, Isa::Portable) => "CPU",
            (Self::Lanes, Isa::Neon) => "CPU with NEON",
            (Self::Lanes, Isa::Avx2) => "CPU with AVX2",
            (Self::Lanes, Isa::Avx512) => "CPU with AVX-512",
        }
    }
}

/// Agents from which on kernels are shared among threads: for fewer it is not worth a wait for another thread.
const SHARED: u32 = 257;

/// Does work on one of the threads that kernels are shared among. There a kernel's parts are taken at once; from elsewhere each
/// kernel wakes a thread, and is woken when that is done. A step at most: a thread that waits for others may take the work of
/// another crowd meanwhile, and goes on when that is done.
pub(crate) fn among_threads<T: Send>(store: &mut Store, work: impl FnOnce(&mut Store) -> T + Send) -> T {
    if store.step.agent_count < SHARED { work(store) } else { rayon::scope(|_| work(store)) }
}

/// Runs a dispatch by vectors of a kind. Whether lanes run its kernel at all.
pub(crate) fn run_on(isa: Isa, dispatch: &Dispatch, store: &mut Store) -> bool {
    let Some(lane) = lane(dispatch.phase) else { return false };
    let extent = match dispatch.extent {
        Extent::Invocations(count) => [count, 1],
        Extent::Indirect(buffer, element) => {
            let groups: &[u32] = bytemuck::cast_slice(store.bytes(buffer));
            let [x, y, z] = [0, 1, 2].map(|axis| groups[element as usize + axis]);
            debug_assert!(z <= 1, "{:?} has {z} layers", dispatch.phase);
            [x * dispatch.phase.entry().workgroup_size[0], y * z]
        }
    };
    let all = store.words();
    let buffers: Vec<Words<'_>> = lane.buffers.iter().map(|id| all[*id as usize]).collect();
    lane.kernel.run(isa, &buffers, dispatch.immediate, extent);
    true
}

/// Whether lanes run a kernel.
pub(crate) fn has(kernel: KernelId) -> bool {
    kernel.kernel().phases.iter().all(|phase| lane(*phase).is_some())
}

fn lane(phase: Phase) -> Option<&'static Lane> {
    static LANES: OnceLock<Vec<Option<Lane>>> = OnceLock::new();
    let all = LANES.get_or_init(|| Phase::ALL.iter().map(|phase| find(*phase)).collect());
    all[phase as usize].as_ref()
}

fn find(phase: Phase) -> Option<Lane> {
    let is_there = |phase: &Phase| Kernel::of(phase.entry().name).is_some();
    if !phase.kernel().kernel().phases.iter().all(is_there) {
        return None; // the twin of a kernel may do in one phase what the shader does in two
    }
    let kernel = Kernel::of(phase.entry().name)?;
    let buffer = |name: &str| BufferId::ALL.into_iter().find(|id| id.name() == name);
    let buffers: Option<Vec<BufferId>> = kernel.bindings.iter().map(|binding| buffer(binding.name)).collect();
    Some(Lane { kernel, buffers: buffers? })
}
