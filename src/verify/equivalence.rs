//! Runs dispatches on both sides from the same inputs and compares every buffer that they write.

use crate::gpu::plan::Op;
use crate::gpu::{Device, Engine, Error};
use crate::kernels::shared::cells::index::CELL_WORDS;
use crate::kernels::shared::unsolved::index::LISTED;
use crate::kernels::{Access, BufferId, Dispatch, Extent, KernelId, Store};
use crate::reference;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The outcome of comparing one kernel.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// The kernel.
    pub kernel: KernelId,
    /// Words of 32 bits compared.
    pub compared: usize,
    /// Words with equal bits.
    pub exact: usize,
    /// Largest difference of floats; infinite where one side is not finite or an integer differs.
    pub max_error: f32,
    /// Where the first difference stands: buffer, element, word, CPU and device value.
    pub first: Option<String>,
}

/// Words of a buffer that are defined after a kernel. Those of `unsolved` stand in the order in which invocations arrive, and only
/// the kernel that wrote them reads them; but `grid_scan` empties the list, whose head is LISTED words.
fn defined(kernel: KernelId, buffer: BufferId) -> usize {
    match (buffer, kernel) {
        (BufferId::Unsolved, KernelId::GridScan) => LISTED,
        (BufferId::Unsolved, _) => 0,
        _ => usize::MAX,
    }
}

/// Sorts the lists of the cells, which agents join in the order in which their invocations arrive. A list that does not end, or
/// leads out of the crowd, stays as it is.
fn sort_lists(store: &mut Store) {
    let agents = store.next_in_cell.len();
    for head in (1..store.cells.len()).step_by(CELL_WORDS) {
        let next = |link: u32| store.next_in_cell.get((link as usize).wrapping_sub(1)).copied();
        let links = std::iter::successors(Some(store.cells[head]), |link| next(*link));
        let mut list: Vec<u32> = links.take_while(|link| *link > 0).take(agents + 1).collect();
        if list.len() > agents || list.iter().any(|link| *link as usize > agents) {
            continue;
        }
        list.sort_unstable();
        store.cells[head] = list.first().copied().unwrap_or(0);
        list.push(0);
        for pair in list.windows(2) {
            store.next_in_cell[pair[0] as usize - 1] = pair[1];
        }
    }
}

fn kernels_of(dispatches: &[Dispatch]) -> Vec<KernelId> {
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

/// Consecutive dispatches of one kernel, what they are given, and what the CPU makes of it.
#[derive(Debug, Clone)]
pub struct Expected {
    /// The kernel.
    pub kernel: KernelId,
    dispatches: Vec<Dispatch>,
    before: Store,
    after: Store,
}

impl Expected {
    /// Runs dispatches on the CPU, from one kernel to the next.
    pub fn of(store: &Store, dispatches: &[Dispatch]) -> impl Iterator<Item = Self> {
        let mut after = store.clone();
        dispatches.chunk_by(|a, b| a.kernel() == b.kernel()).filter_map(move |group| {
            let kernel = group.first()?.kernel();
            let before = after.clone();
            for dispatch in group {
                reference::run(dispatch.phase, &mut after, dispatch.immediate);
            }
            Some(Self { kernel, dispatches: group.to_vec(), before, after: after.clone() })
        })
    }

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
        let written = bindings.iter().filter(|b| b.access == Access::Write).map(|b| b.buffer);
        let writes: Vec<_> = written.collect();
        // the kernel that counts the groups need not be among the engine's
        engine.add_buffers(&self.before, &arguments_of(&self.dispatches))?;
        engine.replace(&self.before, &all)?;
        let ops: Vec<_> = self.dispatches.iter().copied().map(Op::Dispatch).collect();
        engine.run(&ops, |_, _| Vec::new(), false)?;
        let mut got = self.before.clone();
        engine.download(&mut got, &writes)?;
        tamper(&mut got, &writes);
        let mut after = Cow::Borrowed(&self.after);
        if writes.contains(&BufferId::NextInCell) {
            sort_lists(&mut got);
            sort_lists(after.to_mut());
        }
        let mut comparison = Comparison::none(self.kernel);
        for buffer in writes {
            compare(&mut comparison, buffer, after.bytes(buffer), got.bytes(buffer));
        }
        Ok(comparison)
    }
}

impl Comparison {
    /// Nothing compared yet.
    const fn none(kernel: KernelId) -> Self {
        Self { kernel, compared: 0, exact: 0, max_error: 0.0, first: None }
    }

    /// Adds another comparison of the same kernel.
    pub(super) fn merge(&mut self, new: Self) {
        self.compared += new.compared;
        self.exact += new.exact;
        self.max_error = self.max_error.max(new.max_error);
        self.first = self.first.take().or(new.first);
    }
}

/// Adds the comparison of one buffer.
fn compare(comparison: &mut Comparison, buffer: BufferId, want: &[u8], got: &[u8]) {
    let words = buffer.stride() / 4;
    let both = want.chunks_exact(4).zip(got.chunks_exact(4)).take(defined(comparison.kernel, buffer));
    for (index, (w, g)) in both.enumerate() {
        comparison.compared += 1;
        if w == g {
            comparison.exact += 1;
            continue;
        }
        let bits = |bytes: &[u8]| u32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        let (w, g) = (bits(w), bits(g));
        let (a, b) = (f32::from_bits(w), f32::from_bits(g));
        let word = index % words;
        let is_integer = word < 64 && buffer.integer_words() >> word & 1 == 1;
        let error = if is_integer { f32::INFINITY } else { (a - b).abs() };
        let error = if error.is_nan() { f32::INFINITY } else { error };
        comparison.max_error = comparison.max_error.max(error);
        if comparison.first.is_none() {
            let (element, word) = (index / words, index % words);
            let name = buffer.name();
            comparison.first =
                Some(format!("{name}[{element}].{word}: CPU {a:e} ({w:#010x}), device {b:e} ({g:#010x})"));
        }
    }
}
