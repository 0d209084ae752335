//! Runs dispatches by a kernel's twin and by lanes from the same inputs, and compares every buffer that they write.

use crate::hash::Hash;
use crate::kernels::shared::cells::index::CELL_WORDS;
use crate::kernels::shared::unsolved::index::LISTED;
use crate::kernels::{Access, BufferId, Dispatch, KernelId, Store};
use crate::{lanes, reference};
use std::borrow::Cow;
use wgsl_lanes::Isa;

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
    /// Where the first difference stands: buffer, element, word, the twin's value and the other.
    pub first: Option<String>,
    /// Hash of all words of the other side: two sides that differ from the twin in the same way have the same.
    digest: Hash,
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

/// Consecutive dispatches of one kernel, what they are given, and what the CPU makes of it.
#[derive(Debug, Clone)]
pub struct Expected {
    /// The kernel.
    pub kernel: KernelId,
    pub(super) dispatches: Vec<Dispatch>,
    pub(super) before: Store,
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

    /// The same by lanes, for each set of instructions that this machine has; nothing where lanes have no such kernel.
    pub fn by_lanes(&self) -> Vec<(Isa, Comparison)> {
        let one = |isa: Isa| {
            let mut got = self.before.clone();
            let is_run = self.dispatches.iter().all(|dispatch| lanes::run_on(isa, dispatch, &mut got));
            is_run.then(|| (isa, self.against(&mut got)))
        };
        Isa::ALL.into_iter().filter(|isa| isa.is_here()).filter_map(one).collect()
    }

    /// What the kernel writes.
    pub(super) fn writes(&self) -> Vec<BufferId> {
        let bindings = self.kernel.kernel().bindings.iter();
        bindings.filter(|binding| binding.access == Access::Write).map(|binding| binding.buffer).collect()
    }

    /// Compares what another side made with what the twin made.
    pub(super) fn against(&self, got: &mut Store) -> Comparison {
        let writes = self.writes();
        let mut after = Cow::Borrowed(&self.after);
        if writes.contains(&BufferId::NextInCell) {
            sort_lists(got);
            sort_lists(after.to_mut());
        }
        let mut comparison = Comparison::none(self.kernel);
        for buffer in writes {
            compare(&mut comparison, buffer, after.bytes(buffer), got.bytes(buffer));
        }
        comparison
    }
}

impl Comparison {
    /// Nothing compared yet.
    pub(super) fn none(kernel: KernelId) -> Self {
        Self { kernel, compared: 0, exact: 0, max_error: 0.0, first: None, digest: Hash::default() }
    }

    /// Hash of the other side's words.
    pub(super) fn digest(&self) -> u64 {
        self.digest.value()
    }

    /// Adds another comparison of the same kernel.
    pub(super) fn merge(&mut self, new: Self) {
        self.compared += new.compared;
        self.exact += new.exact;
        self.max_error = self.max_error.max(new.max_error);
        self.first = self.first.take().or(new.first);
        self.digest.add(&new.digest.value().to_le_bytes());
    }
}

/// Adds the comparison of one buffer.
fn compare(comparison: &mut Comparison, buffer: BufferId, want: &[u8], got: &[u8]) {
    let words = buffer.stride() / 4;
    comparison.digest.add(&got[..got.len().min(defined(comparison.kernel, buffer).saturating_mul(4))]);
    let both = want.chunks_exact(4).zip(got.chunks_exact(4)).take(defined(comparison.kernel, buffer));
    for (index, (w, g)) in both.enumerate() {
        comparison.compared += 1;
        if w == g {
            comparison.exact += 1;
            continue;
        }
        let (w, g) = (bits(w), bits(g));
        let (a, b) = (f32::from_bits(w), f32::from_bits(g));
        let word = index % words;
        let is_integer = word < 64 && buffer.integer_words() >> word & 1 == 1;
        let error = if is_integer { f32::INFINITY } else { (a - b).abs() };
        let error = if error.is_nan() { f32::INFINITY } else { error };
        comparison.max_error = comparison.max_error.max(error);
        if comparison.first.is_none() {
            comparison.first = Some(difference(buffer, index, w, g));
        }
    }
}

/// The bits of a word.
fn bits(bytes: &[u8]) -> u32 {
    u32::from_ne_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

/// Two words of a buffer that differ: buffer, element, word, the twin's value and the other.
fn difference(buffer: BufferId, index: usize, twin: u32, here: u32) -> String {
    let words = buffer.stride() / 4;
    let (name, element, word) = (buffer.name(), index / words, index % words);
    let (a, b) = (f32::from_bits(twin), f32::from_bits(here));
    format!("{name}[{element}].{word}: twin {a:e} ({twin:#010x}), here {b:e} ({here:#010x})")
}

/// Where the contents of a buffer first differ from the twin's, if they do.
pub(super) fn first_difference(buffer: BufferId, twin: &[u8], here: &[u8]) -> Option<String> {
    let words = twin.chunks_exact(4).zip(here.chunks_exact(4)).map(|(twin, here)| [bits(twin), bits(here)]);
    let (index, [twin, here]) = words.enumerate().find(|(_, [twin, here])| twin != here)?;
    Some(difference(buffer, index, twin, here))
}
