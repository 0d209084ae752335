//! Every construct that [`wgsl_lanes`] knows, generated from `wgsl/` and run beside plain Rust: see `tests/`.
#![allow(unsafe_code, reason = "the one call of the generated code")]

use std::ops::Range;
use wgsl_lanes::{Isa, Words};

/// What a generated kernel's function looks like.
pub type Run = unsafe fn(&[Words<'_>], u32, Range<u32>, Range<u32>);
/// One kernel in all sets of instructions.
pub type Runs = &'static [(Isa, Run)];

/// Runs a kernel with each set of instructions that this machine has: what each makes of the buffers.
pub fn run(runs: Runs, buffers: &[Vec<u32>], immediate: u32, invocations: u32) -> Vec<(Isa, Vec<Vec<u32>>)> {
    run_rows(runs, buffers, immediate, [1, invocations])
}

/// The same for some invocations along the axis on which lanes do not lie, and some along that on which they do.
pub fn run_rows(
    runs: Runs,
    buffers: &[Vec<u32>],
    immediate: u32,
    [others, invocations]: [u32; 2],
) -> Vec<(Isa, Vec<Vec<u32>>)> {
    let here = runs.iter().filter(|(isa, _)| isa.is_here());
    here.map(|(isa, run)| {
        let mut made = buffers.to_vec();
        let words: Vec<Words<'_>> = made.iter_mut().map(|words| Words::write(words)).collect();
        // SAFETY: the machine has the instructions, and one thread runs all.
        unsafe { run(&words, immediate, 0..others, 0..invocations) };
        (*isa, made)
    })
    .collect()
}

#[allow(warnings, clippy::all, reason = "generated")]
mod generated {
    use super::{Run, Runs};
    use wgsl_lanes::Isa;

    include!(concat!(env!("OUT_DIR"), "/constructs.rs"));
}

pub use generated::*;
