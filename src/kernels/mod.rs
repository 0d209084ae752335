//! The kernels, declared once: each is a WGSL file in `shaders/`, and everything else is read from it.
//!
//! `build.rs` compiles every file and writes, for a kernel `integrate`:
//! - [`KernelId::Integrate`] and its [`Kernel`] (bindings by name, access, workgroup size, SPIR-V),
//! - `integrate::Slices`, the bindings as named Rust slices, which the CPU twin takes,
//! - for every buffer name a [`BufferId`] and a field of [`Store`], the CPU's copy of all buffers,
//! - `integrate::TURNING_SPEED` and the other constants of the file, exact to the bit; `integrate::index` holds those of
//!   type `u32` as `usize`. Constants of `shaders/shared/step.wgsl` stand in `shared::step`.
//!
//! Buffers are bound by name: a variable `position` in any shader is the buffer `position`.

#![allow(unused_qualifications, reason = "the generated part names types by their full path")]

#[cfg(feature = "hot-reload")]
#[allow(missing_docs, reason = "shared with build.rs")]
pub mod compile;
pub mod layout;

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

/// A compute kernel.
#[derive(Debug)]
pub struct Kernel {
    /// Which one.
    pub id: KernelId,
    /// File stem, entry point, label, timer.
    pub name: &'static str,
    /// Invocations per workgroup.
    pub workgroup_size: [u32; 3],
    /// Bindings by number.
    pub bindings: &'static [Binding],
    /// Whether the kernel takes a level (an immediate `u32`): a kernel of several passes is dispatched once per level.
    pub has_level: bool,
    /// The code.
    pub spirv: &'static [u32],
}

/// How many invocations of a kernel a pass launches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Extent {
    /// At least this many invocations, along x.
    Invocations(u32),
    /// Three `u32` (workgroups along x, y, z) that an earlier pass wrote, from this element of a buffer of `u32`.
    Indirect(BufferId, u32),
}

/// One launch of a kernel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pass {
    /// The kernel.
    pub kernel: KernelId,
    /// Which of its levels, 0 for kernels of one pass.
    pub level: u32,
    /// How many invocations.
    pub extent: Extent,
}

/// One entry point of a draw shader.
#[derive(Debug)]
pub struct DrawEntry {
    /// Entry point.
    pub name: &'static str,
    /// The code.
    pub spirv: &'static [u32],
    /// The same for one eye a pass, where the code reads the number of the eye: needs no multiview.
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

include!(concat!(env!("OUT_DIR"), "/kernels.rs"));
