//! Runs dispatches on a device and compares what they write with what the twins make of the same.

use super::equivalence::{Comparison, Expected};
use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, Error};
use crate::kernels::{BufferId, Dispatch, Extent, KernelId, Store};
use std::collections::BTreeSet;
use std::sync::Arc;

pub(super) fn kernels_of(dispatches: &[Dispatch]) -> Vec<KernelId> {
    let set: BTreeSet<_> = dispatches.iter().map(Dispatch::kernel).collect();
    set.into_iter().collect()
}

/// Where group counts stand.
fn arguments_of(dispatches: &[Dispatch]) -> Vec<BufferId> {
    let buffers = dispatches.iter().filter_map(|dispatch| match dispatch.extent {
        Extent::Indirect(buffer, _) => Some(buffer),
        Extent::Invocations(_) => None,
    });
    let set: BTreeSet<_> = buffers.collect();
    set.into_iter().collect()
}

/// Runs `dispatches` on the device and on the CPU, both from `store`, and compares after every kernel what it wrote.
///
/// Each kernel starts from the CPU's state, so a difference is charged to the kernel that made it. Consecutive dispatches
/// of one kernel are compared after the last.
///
/// # Errors
/// When the device fails.
pub fn compare_dispatches(
    device: &Arc<Device>,
    store: &Store,
    dispatches: &[Dispatch],
) -> Result<Vec<Comparison>, Error> {
    compare_with(device, store, dispatches, |_, _| ())
}

/// The same, but one bit of what the device gave back is changed for every kernel: the test of the comparison itself.
///
/// # Errors
/// When the device fails.
#[doc(hidden)]
pub fn compare_tampered(
    device: &Arc<Device>,
    store: &Store,
    dispatches: &[Dispatch],
) -> Result<Vec<Comparison>, Error> {
    compare_with(device, store, dispatches, |gpu, writes| {
        if let Some(byte) = writes.first().and_then(|buffer| gpu.bytes_mut(*buffer).first_mut()) {
            *byte ^= 1;
        }
    })
}

fn compare_with(
    device: &Arc<Device>,
    store: &Store,
    dispatches: &[Dispatch],
    tamper: impl Fn(&mut Store, &[BufferId]),
) -> Result<Vec<Comparison>, Error> {
    let mut engine = Engine::new(device, store, &kernels_of(dispatches))?;
    let mut found: Vec<Comparison> = Vec::new();
    for expected in Expected::of(store, dispatches) {
        let new = expected.compare(&mut engine, &tamper)?;
        match found.iter_mut().find(|old| old.kernel == new.kernel) {
            Some(old) => old.merge(new),
            None => found.push(new),
        }
    }
    Ok(found)
}

impl Expected {
    /// An engine for the kernel alone.
    ///
    /// # Errors
    /// When the device fails.
    pub fn engine(&self, device: &Arc<Device>) -> Result<Engine, Error> {
        Engine::new(device, &self.before, &[self.kernel])
    }

    /// Runs the dispatches on an engine that has the kernel, and compares every buffer that they write. `tamper` may change what
    /// the device gave back.
    ///
    /// # Errors
    /// When the device fails.
    pub fn compare(
        &self,
        engine: &mut Engine,
        tamper: impl Fn(&mut Store, &[BufferId]),
    ) -> Result<Comparison, Error> {
        let bindings = self.kernel.kernel().bindings;
        let all: Vec<_> = bindings.iter().map(|b| b.buffer).collect();
        let writes = self.writes();
        // the kernel that counts the groups need not be among the engine's
        engine.add_buffers(&self.before, &arguments_of(&self.dispatches))?;
        engine.replace(&self.before, &all)?;
        let ops: Vec<_> = self.dispatches.iter().copied().map(Op::Dispatch).collect();
        engine.run(&ops, |_, _| Vec::new(), false)?;
        let mut got = self.before.clone();
        engine.download(&mut got, &writes)?;
        tamper(&mut got, &writes);
        Ok(self.against(&mut got))
    }
}
