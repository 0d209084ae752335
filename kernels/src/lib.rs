//! gaitway's kernels for the lanes of a CPU, generated from its shaders by [`wgsl_lanes`].
#![allow(unsafe_code, reason = "the one call of the generated code")]

use rayon::prelude::*;
use std::ops::Range;
use wgsl_lanes::{Isa, Words};

/// Along which axis the lanes of a kernel lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Axis {
    X,
    Y,
}

/// What a generated kernel's function looks like.
type Run = unsafe fn(&[Words<'_>], u32, Range<u32>, Range<u32>);

/// Invocations that a thread takes at a time: enough that the start of a chunk costs nothing.
const CHUNK: u32 = 128;
/// Vertices of a mesh that a thread takes at a time, for as many agents as there are lanes.
const VERTICES: u32 = 2048;
/// Pieces for each thread that work is cut into, where it is long. A thread may lose its core to another program: then the
/// others take its pieces, and wait for one at most.
const PIECES: usize = 64;

/// A buffer that a kernel takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Name of the variable in the shader.
    pub name: &'static str,
    /// Whether it is written.
    pub is_written: bool,
}

/// A phase of a kernel.
#[derive(Debug)]
pub struct Kernel {
    /// Name of the entry point.
    pub name: &'static str,
    /// How lanes lie in a dispatch.
    axis: Axis,
    /// The buffers, in the order in which [`Self::run`] takes them.
    pub bindings: &'static [Binding],
    runs: &'static [(Isa, Run)],
}

impl Kernel {
    /// The phase of that name, if lanes run it.
    pub fn of(name: &str) -> Option<&'static Self> {
        KERNELS.iter().find(|kernel| kernel.name == name)
    }

    /// Runs so many invocations along x and y, on all threads.
    ///
    /// # Panics
    /// Another number of buffers than there are bindings, or a machine without the instructions.
    pub fn run(&self, isa: Isa, buffers: &[Words<'_>], immediate: u32, [width, height]: [u32; 2]) {
        assert_eq!(buffers.len(), self.bindings.len(), "{} takes other buffers", self.name);
        assert!(isa.is_here(), "this machine has no {}", isa.name());
        let (_, run) = self.runs.iter().find(|(known, _)| *known == isa).unwrap_or(&self.runs[0]);
        let (along, other, [chunk, others]) = match self.axis {
            Axis::X => (width, height, [CHUNK, 1]),
            Axis::Y => (height, width, [isa.lanes(), VERTICES]),
        };
        let part = |number: u32, size: u32, all: u32| {
            let begin = number * size;
            begin..begin.saturating_add(size).min(all)
        };
        let chunks = along.div_ceil(chunk).max(1);
        let one = |number: u32| {
            let (others, lanes) = (part(number / chunks, others, other), part(number % chunks, chunk, along));
            // SAFETY: the machine has the instructions. The kernels are written for devices, which run all invocations of a
            // dispatch at once: none reads or writes what another writes, but by atomic operations.
            unsafe { run(buffers, immediate, others, lanes) }
        };
        match chunks * other.div_ceil(others) {
            count @ 0..2 => (0..count).for_each(one),
            count => {
                let most = (count as usize / (PIECES * rayon::current_num_threads())).max(1);
                (0..count).into_par_iter().with_max_len(most).for_each(one);
            }
        }
    }
}

#[allow(warnings, clippy::all, reason = "generated")]
mod generated {
    use super::{Axis, Binding, Kernel, Run};
    use wgsl_lanes::Isa;

    include!(concat!(env!("OUT_DIR"), "/kernels.rs"));
}

pub use generated::{KERNELS, LEFT_OUT};
