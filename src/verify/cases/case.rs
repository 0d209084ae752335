//! One case, and what cases are made with.

use crate::kernels::{Dispatch, KernelId, Store};
use crate::reference::exact::{hash_u32, unit_f32};
use crate::sim::order;
use bytemuck::Pod;

/// Inputs, and what is run on them.
#[derive(Debug, Clone)]
pub struct Case {
    /// What it is, with its size and seed.
    pub name: String,
    /// The buffers.
    pub store: Store,
    /// The dispatches, in order.
    pub dispatches: Vec<Dispatch>,
}

impl Case {
    pub(super) fn step(what: &str, size: usize, seed: u32, store: Store) -> Self {
        let dispatches = order::step_dispatches(&store.step);
        Self { name: format!("{what}, {size} agents, seed {seed}"), store, dispatches }
    }

    pub(super) fn new(
        what: &str,
        size: usize,
        seed: u32,
        store: Store,
        dispatches: fn(&Store) -> Vec<Dispatch>,
    ) -> Self {
        let dispatches = dispatches(&store);
        Self { name: format!("{what}, size {size}, seed {seed}"), store, dispatches }
    }

    /// The step after this one, on the CPU; none for a case that is no step.
    #[must_use]
    pub fn next_step(mut self) -> Option<Self> {
        let has = |kernel| self.dispatches.iter().any(|dispatch| dispatch.kernel() == kernel);
        if !(has(KernelId::AdvanceJourney) && has(KernelId::Integrate)) {
            return None;
        }
        for dispatch in &self.dispatches {
            crate::reference::run(dispatch.phase, &mut self.store, dispatch.immediate);
        }
        self.store.step.step_index += 1;
        self.dispatches = order::step_dispatches(&self.store.step);
        Some(self)
    }
}

/// An element whose words are all the same bits.
pub(super) fn filled<T: Pod>(word: u32) -> T {
    let mut element = T::zeroed();
    bytemuck::cast_slice_mut(std::slice::from_mut(&mut element)).fill(word);
    element
}

/// An element without a number in it.
pub(super) fn nan<T: Pod>() -> T {
    filled(f32::NAN.to_bits())
}

/// Random numbers of a case: number `lane` of item `index`, in [0, 1).
pub(super) fn unit(seed: u32, index: usize, lane: u32) -> f32 {
    unit_f32(hash_u32(hash_u32(seed ^ (index as u32).wrapping_mul(0x9e37_79b9)).wrapping_add(lane)))
}
