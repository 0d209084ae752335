//! The kernels, declared once: each is a WGSL file in `shaders/`, and everything else is read from it.
//!
//! `build.rs` compiles every file and writes, for a kernel `integrate`:
//! - [`KernelId::Integrate`] and its [`Kernel`],
//! - for every entry point, a phase of the kernel, a [`Phase`] and its [`Entry`] (bindings by name, access, workgroup size,
//!   immediate, SPIR-V): [`Phase::Integrate`], or [`Phase::FlowSweep`] where there are several,
//! - `integrate::Slices`, the bindings as named Rust slices, which the CPU twin takes,
//! - for every buffer name a [`BufferId`] and a field of [`Store`], the CPU's copy of all buffers,
//! - `integrate::TURNING_SPEED` and the other constants of the file, exact to the bit; `integrate::index` holds those of
//!   type `u32` as `usize`. Constants of `shaders/shared/step.wgsl` stand in `shared::step`.
//!
//! Buffers are bound by name: a variable `position` in any shader is the buffer `position`.
//!
//! ```
//! use gaitway::kernels::{KernelId, Phase};
//!
//! let integrate = Phase::Integrate.entry();
//! println!("{}, {:?} invocations a workgroup", integrate.label, integrate.workgroup_size);
//! for binding in integrate.bindings {
//!     println!("  {:?} ({:?})", binding.buffer, binding.access);
//! }
//! assert_eq!(KernelId::Flow.kernel().phases.len(), 8);
//! ```

#![allow(unused_qualifications, reason = "the generated part names types by their full path")]

#[cfg(feature = "hot-reload")]
#[allow(missing_docs, reason = "shared with build.rs")]
pub mod compile;
pub mod layout;
#[cfg(feature = "vulkan")]
pub mod link;
pub mod probe;
#[cfg(feature = "vulkan")]
pub mod spirv;

/// How a kernel uses a buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Access {
    /// Uniform buffer, read.
    Uniform,
    /// Storage buffer, read.
    Read,
    /// Storage buffer, written and perhaps read.
    Write,
}

/// One binding of a kernel.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// The buffer.
    pub buffer: BufferId,
    /// Binding number in descriptor set 0.
    pub index: u32,
    /// Access.
    pub access: Access,
}

/// A compute kernel: a file of `shaders/`, with an entry point for each of its phases.
#[derive(Debug)]
pub struct Kernel {
    /// Which one.
    pub id: KernelId,
    /// File stem.
    pub name: &'static str,
    /// Its phases, in the order of the file.
    pub phases: &'static [Phase],
    /// Bindings of all phases together, by number.
    pub bindings: &'static [Binding],
}

/// The word that a phase takes beside its buffers: a `var<immediate>`.
#[derive(Debug)]
pub struct Immediate {
    /// Name of the variable.
    pub name: &'static str,
    /// Where it is a set of flags, their names and bits: the constants of the shared file that is named as the variable.
    pub flags: &'static [(&'static str, u32)],
}

impl Immediate {
    /// A value of it, as `name value`; flags by name.
    pub fn text(&self, value: u32) -> String {
        let set = self.flags.iter().filter(|(_, bit)| value & bit != 0);
        let names: Vec<&str> = set.map(|(name, _)| *name).collect();
        match (self.flags, names.as_slice()) {
            ([], _) => format!("{} {value}", self.name),
            (_, []) => format!("{} none", self.name),
            _ => format!("{} {}", self.name, names.join("+")),
        }
    }
}

/// One phase of a kernel: an entry point.
#[derive(Debug)]
pub struct Entry {
    /// Which one.
    pub phase: Phase,
    /// The kernel it belongs to.
    pub kernel: KernelId,
    /// Name of the entry point, and of the CPU twin.
    pub name: &'static str,
    /// Label and timer: `integrate`, or `flow.sweep` for a phase of several.
    pub label: &'static str,
    /// Invocations per workgroup.
    pub workgroup_size: [u32; 3],
    /// The bindings that it uses, by number.
    pub bindings: &'static [Binding],
    /// The word that it takes, if any.
    pub immediate: Option<Immediate>,
    /// The code.
    pub spirv: &'static [u32],
}

impl Phase {
    /// The kernel it belongs to.
    pub const fn kernel(self) -> KernelId {
        self.entry().kernel
    }
}

/// How many invocations a dispatch has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// At least this many invocations, along x.
    Invocations(u32),
    /// Three `u32` (workgroups along x, y, z) that an earlier dispatch wrote, from this element of a buffer of `u32`.
    Indirect(BufferId, u32),
}

/// One dispatch of a phase of a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dispatch {
    /// The phase.
    pub phase: Phase,
    /// Its immediate; 0 for phases without.
    pub immediate: u32,
    /// How many invocations.
    pub extent: Extent,
}

impl Dispatch {
    /// A dispatch of a phase without an immediate.
    pub const fn new(phase: Phase, extent: Extent) -> Self {
        Self { phase, immediate: 0, extent }
    }

    /// A dispatch of at least so many invocations.
    pub const fn of(phase: Phase, invocations: u32) -> Self {
        Self::new(phase, Extent::Invocations(invocations))
    }

    /// The same with an immediate.
    pub const fn with(self, immediate: u32) -> Self {
        Self { immediate, ..self }
    }

    /// The kernel.
    pub const fn kernel(&self) -> KernelId {
        self.phase.kernel()
    }
}

/// What shaders need of a device: the most of what any stage takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Needs {
    /// Storage buffers of a stage.
    pub storage_buffers: u32,
    /// Uniform buffers of a stage.
    pub uniform_buffers: u32,
    /// Sampled images of a stage.
    pub sampled_images: u32,
    /// All of these, and samplers.
    pub resources: u32,
    /// Bytes of a uniform buffer.
    pub uniform_range: u32,
    /// Bytes of immediates.
    pub immediates: u32,
    /// Invocations of a workgroup.
    pub invocations: u32,
    /// Bytes of memory that a workgroup shares.
    pub workgroup_memory: u32,
}

/// One thing to do.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Op {
    /// Overwrite a uniform buffer with the contents given for this place in the list.
    Set(BufferId),
    /// Take the number of the step from `step_count`, where `integrate` counts the steps, into `step`. On a device that is one
    /// word ([`BufferId::home`]), so there is nothing to do.
    CountStep,
    /// Run a kernel.
    Dispatch(Dispatch),
}

impl BufferId {
    /// The buffer that holds this one on a device, from its beginning. `step_count` is the first word of `step`: steps that are
    /// submitted together follow one another without a copy between them.
    pub const fn home(self) -> Self {
        const { assert!(std::mem::offset_of!(layout::StepUniforms, step_index) == 0) };
        match self {
            Self::StepCount => Self::Step,
            own => own,
        }
    }
}

/// One entry point of a draw shader.
#[derive(Debug)]
pub struct DrawEntry {
    /// Entry point.
    pub name: &'static str,
    /// The code.
    pub spirv: &'static [u32],
    /// The same for one eye a render pass, where the code reads the number of the eye: needs no multiview.
    pub one_eye: Option<&'static [u32]>,
}

/// What kind of thing a draw shader binds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DrawBindingKind {
    /// Uniform buffer.
    Uniform,
    /// Storage buffer, read.
    Storage,
    /// Sampled image.
    Texture,
    /// Sampler.
    Sampler,
}

/// One binding of a draw shader.
#[derive(Debug, Clone, Copy)]
pub struct DrawBinding {
    /// Name of the variable.
    pub name: &'static str,
    /// Descriptor set.
    pub group: u32,
    /// Binding number.
    pub index: u32,
    /// Kind.
    pub kind: DrawBindingKind,
}

/// A draw shader: a file of `shaders/draw/`.
#[derive(Debug)]
pub struct DrawShader {
    /// File stem.
    pub name: &'static str,
    /// Entry points.
    pub entries: &'static [DrawEntry],
    /// Bindings of all entry points together.
    pub bindings: &'static [DrawBinding],
    /// Bytes of the immediates, 0 for none.
    pub immediate_size: u32,
}

impl DrawShader {
    /// The entry point of that name.
    pub fn entry(&self, name: &str) -> Option<&DrawEntry> {
        self.entries.iter().find(|entry| entry.name == name)
    }
}

/// A module that build.rs has written, of so many words.
macro_rules! spirv {
    ($file:literal, $words:literal) => {
        &bytemuck::must_cast::<[u8; 4 * $words], [u32; $words]>(*include_bytes!(concat!(
            env!("OUT_DIR"),
            "/",
            $file,
            ".spv"
        )))
    };
}

include!(concat!(env!("OUT_DIR"), "/kernels.rs"));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_phase_is_named_and_labelled_after_its_kernel_and_binds_no_more_than_it() {
        for phase in Phase::ALL {
            let (entry, kernel) = (phase.entry(), phase.kernel().kernel());
            assert_eq!(entry.phase, phase);
            assert!(kernel.phases.contains(&phase), "{}", entry.name);
            let of_kernel = entry.label.split_once('.').map_or(entry.label, |(kernel, _)| kernel);
            assert_eq!(of_kernel, kernel.name);
            assert_eq!(entry.label.replacen('.', "_", 1), entry.name);
            for binding in entry.bindings {
                let whole = kernel.bindings.iter().find(|b| b.index == binding.index);
                assert_eq!(whole.map(|b| b.buffer), Some(binding.buffer), "{}", entry.name);
            }
        }
        assert_eq!(Phase::FlowSweep.entry().label, "flow.sweep");
        // a phase binds what it uses, not what its kernel does
        let binds = |phase: Phase, buffer| phase.entry().bindings.iter().any(|b| b.buffer == buffer);
        assert!(binds(Phase::CompactArguments, BufferId::DispatchArgs));
        assert!(!binds(Phase::CompactCount, BufferId::DispatchArgs));
    }

    #[test]
    fn an_immediate_says_what_it_is() {
        let text = |phase: Phase, value| phase.entry().immediate.as_ref().map(|i| i.text(value));
        assert_eq!(text(Phase::Skin, 3).as_deref(), Some("avatar 3"));
        let some = shared::contents::WALLS | shared::contents::GROUPS;
        assert_eq!(text(Phase::GridScatter, some).as_deref(), Some("contents walls+groups"));
        assert_eq!(text(Phase::GridScatter, 0).as_deref(), Some("contents none"));
        assert_eq!(text(Phase::Measure, 0), None);
    }

    #[test]
    fn integer_words_are_those_whose_shader_type_is_integer() {
        assert_eq!(BufferId::FlowWay.integer_words(), 1);
        assert_eq!(BufferId::Companions.integer_words(), 0b1111);
        assert_eq!(BufferId::Position.integer_words(), 0);
        // step_index, agent_count, seed, cell_count, grid_columns, grid_rows; grid_origin
        assert_eq!(BufferId::Step.integer_words() & 0xff, 0b0011_1111);
    }

    #[test]
    fn constants_are_those_of_the_shaders_to_the_bit() {
        assert_eq!(velocity_rvo::GOLDEN.map(f32::to_bits), [-0.737_368_9_f32, 0.675_490_3].map(f32::to_bits));
        assert_eq!(shared::tile::RING, shared::tile::TILE + 2, "an expression is evaluated");
        assert_eq!(shared::tile::index::RING, 10);
    }
}
